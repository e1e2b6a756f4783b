//! Unit normals on one side: those of length 0 are set aside, the others agree with their neighbours on the same sheet.
//!
//! ```text
//! h = (p_j - p_i) . m  m: mean of n_i and sign(n_i . n_j) n_j; on one sheet the third order of the step, between two their distance
//! beside one another   |n_i . n_j| > 0.7, and |h| at most 4 times the median of those whose signs agree
//! signs of a file      few of these contradict each other: a contact is turned that most of its own contradict
//!                      many: pieces of contacts beside one another are made one, with the sign of most of its normals in the file
//! signs at random      spanning tree over the 8 nearest neighbours, least weight 1 - |m . n_j| first;  n_j <- sign(m . n_j) n_j
//!                      m = n_i - 2 (n_i . e) e,  e: direction of the step p_j - p_i
//! ```
//!
//! The two walls of a thin pipe face opposite ways and lie nearer to each other than their contacts. Across an edge the normals are at
//! right angles and tell nothing of each other. Last, the viewpoint says the side of the whole, where one is given.
//!
//! H. Hoppe et al., *Surface reconstruction from unorganized points*, SIGGRAPH 1992, section 3.3; mirrored steps: S. Koenig and S. Gumhold,
//! *Consistent propagation of normal orientations in point clouds*, VMV 2009.

use std::collections::{BinaryHeap, VecDeque};

use palpate_numeric::statistics::{ENOUGH_FOR_RANKS, evenly_among, median};
use palpate_numeric::threads;
use palpate_numeric::vector::{Vector, along, dot, minus, norm, scaled};

use super::neighbour_lists::NeighbourLists;

/// Neighbours of a contact in the graph.
const NEAREST: usize = 8;

/// Normals that all lie within this cosine of their mean agree with each other already.
const AGREED: f64 = 0.2;

/// Cosine from which on two normals are thought to belong to one smooth piece: 45 degrees.
const PARALLEL: f64 = 0.7;

/// Median distances of steps from the mean tangent plane beyond which a step leads to another sheet: of gaussian errors 0.7 %.
const OFF_THE_SHEET: f64 = 4.0;

/// Share of the median step below which such a distance tells nothing: that of a sheet which bends differently from place to place.
const TOLD_APART: f64 = 0.02;

/// Share of contradictions among contacts beside one another up to which the file's signs are those of a surface, with a few slips: 5 % of
/// signs at random make as many.
const SLIPS: f64 = 0.1;

/// Share of nearest neighbours that are parallel, and mean |cosine| between them: below both the normals are no normals of a surface. Random
/// directions have 0.3 and 0.5, the faces of a block with many edges more of the first, few contacts of a ball more of the second.
const CONSISTENT: [f64; 2] = [0.5, 0.7];

/// Share of the file's own signs below which a note says that they are mixed.
const MAJORITY: f64 = 0.6;

/// Contacts that one thread looks at.
const TASK: usize = 256;

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

/// Orients unit normals of a file, zero where unknown, at their points.
pub fn oriented(points: &[Vector], normals: Vec<Vector>, viewpoint: Option<Vector>) -> Oriented {
    with_signs(points, normals, viewpoint, |normals| {
        point_one_way(normals) || made_to_agree(points, normals, &NeighbourLists::<NEAREST>::new(points))
    })
}

/// The same where neighbours are known: of each at least eight.
pub fn oriented_among<const N: usize>(
    points: &[Vector],
    normals: Vec<Vector>,
    viewpoint: Option<Vector>,
    near: &NeighbourLists<N>,
) -> Oriented {
    with_signs(points, normals, viewpoint, |normals| point_one_way(normals) || made_to_agree(points, normals, near))
}

/// Orients unit normals whose signs mean nothing.
pub fn oriented_anew<const N: usize>(
    points: &[Vector],
    normals: Vec<Vector>,
    viewpoint: Option<Vector>,
    near: &NeighbourLists<N>,
) -> Oriented {
    with_signs(points, normals, viewpoint, |normals| {
        spread_signs(points, normals, near);
        neighbours_parallel(points, normals, near)
    })
}

/// Whether normals all lie beside their mean, so that none contradicts another.
fn point_one_way(normals: &[Vector]) -> bool {
    let mean = mean_of(normals);
    normals.iter().all(|n| *n == [0.0; 3] || dot(*n, mean) > AGREED * norm(mean))
}

/// Turns normals where their neighbours say so, and says whether they are those of a surface.
fn made_to_agree<const N: usize>(points: &[Vector], normals: &mut [Vector], near: &NeighbourLists<N>) -> bool {
    correct_signs(points, normals, near);
    neighbours_parallel(points, normals, near)
}

/// `correct` makes normals agree, and says whether they are those of a surface.
fn with_signs(
    points: &[Vector],
    mut normals: Vec<Vector>,
    viewpoint: Option<Vector>,
    correct: impl FnOnce(&mut [Vector]) -> bool,
) -> Oriented {
    let of_length_zero = normals.iter().filter(|n| **n == [0.0; 3]).count();
    let known = normals.len() - of_length_zero;
    if known == 0 {
        return Oriented { normals, of_length_zero, ..Oriented::default() };
    }
    let before = normals.clone();
    let consistent = correct(&mut normals);
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

/// Turns the normals that contradict those beside them.
fn correct_signs<const N: usize>(points: &[Vector], normals: &mut [Vector], near: &NeighbourLists<N>) {
    let beside = Beside::new(points, normals, near);
    let links = || (0..points.len()).flat_map(|i| beside.of(i).map(move |j| (i, j)));
    let against = links().filter(|&(i, j)| dot(normals[i], normals[j]) < 0.0).count();
    if against == 0 {
        return;
    }
    if against as f64 <= SLIPS * links().count() as f64 {
        let is_slip = |i: usize| {
            let against = beside.of(i).filter(|j| dot(normals[i], normals[*j]) < 0.0).count();
            2 * against > beside.of(i).count()
        };
        let slips: Vec<usize> = (0..points.len()).filter(|i| is_slip(*i)).collect();
        slips.into_iter().for_each(|i| normals[i] = scaled(-1.0, normals[i]));
        return;
    }
    let mut visited = vec![false; points.len()];
    for root in 0..points.len() {
        let piece = piece_from(root, &beside, normals, &mut visited);
        let against = piece.iter().filter(|(_, is_turned)| *is_turned).count();
        let minority = 2 * against <= piece.len();
        let turned = piece.iter().filter(|(_, is_turned)| *is_turned == minority);
        turned.for_each(|(i, _)| normals[*i as usize] = scaled(-1.0, normals[*i as usize]));
    }
}

/// Which of its nearest contacts lie beside each on its sheet.
struct Beside<'a, const N: usize> {
    near: &'a NeighbourLists<N>,
    /// A bit for each neighbour.
    are: Vec<u8>,
}

impl<'a, const N: usize> Beside<'a, N> {
    fn new(points: &[Vector], normals: &[Vector], near: &'a NeighbourLists<N>) -> Beside<'a, N> {
        let steps = |i: usize| (0..NEAREST).map(move |k| SheetStep::between(points, normals, i, near.of(i)[k]));
        let some: Vec<SheetStep> = evenly_among(points.len(), ENOUGH_FOR_RANKS).flat_map(steps).flatten().collect();
        let agreeing = some.iter().filter(|step| step.agrees);
        let off = median(agreeing.map(|step| step.off).collect::<Vec<f64>>()).unwrap_or(f64::INFINITY);
        let length = median(some.iter().map(|step| step.length).collect::<Vec<f64>>()).unwrap_or(0.0);
        let most = OFF_THE_SHEET * off.max(TOLD_APART * length);
        let is_beside = |step: Option<SheetStep>| u8::from(step.is_some_and(|step| step.off <= most));
        let are = threads::map(points.len(), TASK, |i| {
            steps(i).enumerate().fold(0, |bits, (k, step)| bits | is_beside(step) << k)
        });
        Beside { near, are }
    }

    fn of(&self, i: usize) -> impl Iterator<Item = usize> + use<'_, 'a, N> {
        let near = self.near.of(i)[..NEAREST].iter().enumerate();
        near.filter(move |(k, _)| self.are[i] >> k & 1 == 1).map(|(_, j)| *j as usize)
    }
}

/// From a contact to one whose normal is parallel.
struct SheetStep {
    agrees: bool,
    length: f64,
    /// How far it leaves the mean tangent plane.
    off: f64,
}

impl SheetStep {
    fn between(points: &[Vector], normals: &[Vector], i: usize, to: u32) -> Option<SheetStep> {
        let j = to as usize;
        let cosine = dot(normals[i], normals[j]);
        let step = minus(points[j], points[i]);
        let mean = along(normals[i], cosine.signum(), normals[j]);
        let off = dot(step, mean).abs() / norm(mean);
        (j != i && cosine.abs() > PARALLEL).then(|| SheetStep { agrees: cosine > 0.0, length: norm(step), off })
    }
}

/// Contacts that hang together with one, and whether each has to be turned to agree with it; empty where it is known already.
fn piece_from<const N: usize>(
    root: usize,
    beside: &Beside<N>,
    normals: &[Vector],
    visited: &mut [bool],
) -> Vec<(u32, bool)> {
    if std::mem::replace(&mut visited[root], true) {
        return Vec::new();
    }
    let mut piece = vec![(root as u32, false)];
    let mut queue = VecDeque::from(piece.clone());
    while let Some((i, is_turned)) = queue.pop_front() {
        for j in beside.of(i as usize) {
            if !std::mem::replace(&mut visited[j], true) {
                let turned = is_turned != (dot(normals[i as usize], normals[j]) < 0.0);
                piece.push((j as u32, turned));
                queue.push_back((j as u32, turned));
            }
        }
    }
    piece
}

/// Carries signs along the tree.
fn spread_signs<const N: usize>(points: &[Vector], normals: &mut [Vector], near: &NeighbourLists<N>) {
    let mut visited: Vec<bool> = normals.iter().map(|n| *n == [0.0; 3]).collect();
    for root in 0..points.len() {
        if visited[root] {
            continue;
        }
        visited[root] = true;
        // largest |cosine| first; the bits of a positive number are ordered as the number is
        let mut heap: BinaryHeap<(u64, u32, u32)> = BinaryHeap::new();
        reach(near.of(root), points, normals, root, &visited, &mut heap);
        while let Some((_, from, to)) = heap.pop() {
            let (from, to) = (from as usize, to as usize);
            if visited[to] {
                continue;
            }
            visited[to] = true;
            if dot(carried(points, normals, from, to), normals[to]) < 0.0 {
                normals[to] = scaled(-1.0, normals[to]);
            }
            reach(near.of(to), points, normals, to, &visited, &mut heap);
        }
    }
}

/// The normal that a contact's own leads to at another: its mirror image in the plane halfway between the two, as on a circle through both.
/// On a flat sheet that is the normal itself; beyond an edge it is that of the other face, and across a thin wall it is turned about.
fn carried(points: &[Vector], normals: &[Vector], from: usize, to: usize) -> Vector {
    let step = minus(points[to], points[from]);
    let square = dot(step, step);
    if square > 0.0 { along(normals[from], -2.0 * dot(normals[from], step) / square, step) } else { normals[from] }
}

/// Whether contacts and their nearest neighbours are parallel as on a surface. The tree's own edges are no measure of it: they are chosen
/// for being parallel.
fn neighbours_parallel<const N: usize>(points: &[Vector], normals: &[Vector], near: &NeighbourLists<N>) -> bool {
    let known = |i: usize| normals[i] != [0.0; 3];
    let at = |i: usize| {
        let j = near.of(i)[0] as usize;
        (i != j && known(i) && known(j)).then(|| dot(normals[i], normals[j]).abs())
    };
    let cosines: Vec<f64> = evenly_among(points.len(), ENOUGH_FOR_RANKS).filter_map(at).collect();
    let parallel = cosines.iter().filter(|cosine| **cosine > PARALLEL).count() as f64;
    let [share, mean] = CONSISTENT.map(|least| least * cosines.len() as f64);
    parallel >= share || cosines.iter().sum::<f64>() > mean
}

fn reach(
    near: &[u32],
    points: &[Vector],
    normals: &[Vector],
    from: usize,
    visited: &[bool],
    heap: &mut BinaryHeap<(u64, u32, u32)>,
) {
    for &to in &near[..NEAREST] {
        if !visited[to as usize] {
            let cosine = dot(carried(points, normals, from, to as usize), normals[to as usize]).abs();
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

    /// Two walls nearer to each other than their contacts: each faces its own way, and a slip is found on either.
    #[test]
    fn the_walls_of_a_pipe_face_opposite_ways() {
        let wall = |radius: f64, side: f64| {
            (0..900).map(move |k| {
                let (turn, h) = (f64::from(k % 30) * 0.2094, f64::from(k / 30) * 0.2);
                let outwards = [turn.cos(), turn.sin(), 0.0];
                ([radius * outwards[0], radius * outwards[1], h], scaled(side, outwards))
            })
        };
        let (points, truth): (Vec<Vector>, Vec<Vector>) = wall(1.0, 1.0).chain(wall(0.85, -1.0)).unzip();
        assert_eq!(oriented(&points, truth.clone(), None).flipped, 0);
        let mut given = truth.clone();
        for i in [37, 501, 1203] {
            given[i] = scaled(-1.0, given[i]);
        }
        let found = oriented(&points, given, None);
        assert_eq!((found.flipped, found.normals == truth), (3, true));
    }
}
