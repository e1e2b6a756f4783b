//! Unit normals on one side: those of length 0 are set aside, the others agree with their neighbours.
//!
//! ```text
//! spanning tree over the 8 nearest neighbours, least weight 1 - |n_i . n_j| first;  along it n_j <- sign(n_i . n_j) n_j
//! the sign of the whole: the viewpoint's side where one is given, else the side of most of the file's own signs
//! ```
//!
//! H. Hoppe et al., *Surface reconstruction from unorganized points*, SIGGRAPH 1992, section 3.3.

use std::collections::BinaryHeap;

use palpate_numeric::vector::{Vector, along, dot, minus, norm, scaled};

use super::tree::Neighbours;

/// Neighbours of a contact in the graph.
const NEAREST: usize = 8;

/// Normals that all lie within this cosine of their mean agree with each other already.
const AGREED: f64 = 0.2;

/// Mean |cosine| of neighbours below which the normals are no normals of a surface. Random directions have 0.5.
const CONSISTENT: f64 = 0.7;

/// Share of the file's own signs below which a note says that they are mixed.
const MAJORITY: f64 = 0.6;

/// Oriented normals with what was done to them.
#[derive(Clone, Debug, Default)]
pub struct Oriented {
    /// Unit normals; zero where there is none.
    pub normals: Vec<Vector>,
    pub of_length_zero: usize,
    pub flipped: usize,
    /// Share of the signs that agreed with the side taken.
    pub(super) majority: f64,
    /// Whether neighbours agree at all.
    pub consistent: bool,
}

impl Oriented {
    /// Share of the file's own signs that agreed with the side taken, where it is too small to tell which side is free.
    pub fn undecided(&self) -> Option<f64> {
        (self.consistent && self.majority < MAJORITY).then_some(self.majority)
    }
}

/// Orients unit normals, zero where unknown, at their points.
pub fn oriented(points: &[Vector], mut normals: Vec<Vector>, viewpoint: Option<Vector>) -> Oriented {
    let of_length_zero = normals.iter().filter(|n| **n == [0.0; 3]).count();
    let known = normals.len() - of_length_zero;
    if known == 0 {
        return Oriented { normals, of_length_zero, ..Oriented::default() };
    }
    let before = normals.clone();
    let mean = mean_of(&normals);
    let agreed = normals.iter().all(|n| *n == [0.0; 3] || dot(*n, mean) > AGREED * norm(mean));
    let consistent = agreed || spread_signs(points, &mut normals);
    let kept = normals.iter().zip(&before).filter(|(new, old)| **new != [0.0; 3] && new == old).count();
    let facing = viewpoint.map(|eye| points.iter().zip(&normals).map(|(p, n)| dot(*n, minus(eye, *p))).sum::<f64>());
    let reversed = facing.map_or(2 * kept < known, |sum| sum < 0.0);
    if reversed {
        normals.iter_mut().for_each(|n| *n = scaled(-1.0, *n));
    }
    let kept = if reversed { known - kept } else { kept };
    // a viewpoint decides the side, whatever the file's signs are
    let majority = if viewpoint.is_some() { 1.0 } else { kept as f64 / known as f64 };
    Oriented { normals, of_length_zero, flipped: known - kept, majority, consistent }
}

/// Carries signs along the tree; whether neighbours are parallel enough for that to mean anything.
fn spread_signs(points: &[Vector], normals: &mut [Vector]) -> bool {
    let tree = Neighbours::new(points);
    let mut visited: Vec<bool> = normals.iter().map(|n| *n == [0.0; 3]).collect();
    let consistent = neighbours_parallel(&tree, points, normals);
    for root in 0..points.len() {
        if visited[root] {
            continue;
        }
        visited[root] = true;
        // largest |cosine| first; the bits of a positive number are ordered as the number is
        let mut heap: BinaryHeap<(u64, u32, u32)> = BinaryHeap::new();
        reach(&tree, points, normals, root, &visited, &mut heap);
        while let Some((_, from, to)) = heap.pop() {
            let (from, to) = (from as usize, to as usize);
            if visited[to] {
                continue;
            }
            visited[to] = true;
            if dot(normals[from], normals[to]) < 0.0 {
                normals[to] = scaled(-1.0, normals[to]);
            }
            reach(&tree, points, normals, to, &visited, &mut heap);
        }
    }
    consistent
}

/// Whether the mean |cosine| between contacts and their nearest neighbour is that of a surface. The tree's own edges
/// are no measure of it: they are chosen for being parallel.
fn neighbours_parallel(tree: &Neighbours, points: &[Vector], normals: &[Vector]) -> bool {
    let known = |i: usize| normals[i] != [0.0; 3];
    let pairs = (0..points.len()).filter(|&i| known(i)).filter_map(|i| Some((i, tree.nearest_other(i)?.1)));
    let cosines = pairs.filter(|&(_, j)| known(j)).map(|(i, j)| dot(normals[i], normals[j]).abs());
    let (sum, count) = cosines.fold((0.0, 0_usize), |(sum, count), c| (sum + c, count + 1));
    count == 0 || sum > CONSISTENT * count as f64
}

fn reach(
    tree: &Neighbours,
    points: &[Vector],
    normals: &[Vector],
    from: usize,
    visited: &[bool],
    heap: &mut BinaryHeap<(u64, u32, u32)>,
) {
    for (_, to) in tree.nearest(points[from], NEAREST + 1) {
        if !visited[to as usize] {
            let cosine = dot(normals[from], normals[to as usize]).abs();
            heap.push((cosine.to_bits(), from as u32, to));
        }
    }
}

/// Mean of the normals that are known; a normal of length 0 is not.
pub fn mean_of(normals: &[Vector]) -> Vector {
    let known = normals.iter().filter(|n| **n != [0.0; 3]).count().max(1) as f64;
    normals.iter().fold([0.0; 3], |sum, n| along(sum, 1.0 / known, *n))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::vector::unit;

    #[test]
    fn directions_at_random_are_no_normals() {
        let points: Vec<Vector> = (0..400).map(|i| [(i % 20) as f64, (i / 20) as f64, 0.0]).collect();
        let angle = |i: usize| (i as f64 * 2.399_963, (i as f64 * 0.618_034).fract() * 2.0 - 1.0);
        let random = (0..400).map(angle).map(|(a, z)| {
            let across = (1.0 - z * z).sqrt();
            [across * a.cos(), across * a.sin(), z]
        });
        assert!(!oriented(&points, random.collect(), None).consistent);
    }

    #[test]
    fn mixed_signs_are_made_one_and_zeros_counted() {
        let points: Vec<Vector> = (0..400).map(|i| [(i % 20) as f64 / 20.0, (i / 20) as f64 / 20.0, 0.0]).collect();
        let truth: Vec<Vector> = points.iter().map(|p| unit([p[0] - 0.5, p[1] - 0.5, 0.4])).collect();
        let mut given = truth.clone();
        for i in (0..400).step_by(4) {
            given[i] = scaled(-1.0, given[i]);
        }
        given[77] = [0.0; 3];
        let found = oriented(&points, given, None);
        assert_eq!((found.of_length_zero, found.flipped, found.consistent), (1, 100, true));
        assert!(found.normals.iter().zip(&truth).enumerate().all(|(i, (a, b))| i == 77 || a == b));
        let seen = oriented(&points, truth.clone(), Some([0.5, 0.5, -9.0]));
        assert_eq!(seen.normals[3], scaled(-1.0, truth[3]));
    }
}
