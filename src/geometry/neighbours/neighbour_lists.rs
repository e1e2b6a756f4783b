//! The nearest neighbours of every point, found once for all that asks for them.
//!
//! ```text
//! leaf of the tree, p its middle point, r the distance of p from its N-th neighbour
//! the N neighbours of another point q of the leaf are within r + |q - p| of q, and so within r + 2 |q - p| of p
//! ```
//!
//! So one search about the middle finds what all points of a leaf choose from.

use palpate_numeric::threads;
use palpate_numeric::vector::{Vector, along, dot, minus, norm};

use super::tree::Neighbours;

/// Leaves that one thread looks at.
const TASK: usize = 32;

/// Leaves after which what was found is put in its place, so that it is not held twice.
const ROUND: usize = 4096;

/// Distance of a leaf's points from its middle over that of the middle's neighbours, beyond which each is searched for by itself: then few
/// of what is found about the middle are neighbours of a point.
const WIDE: f64 = 2.0;

/// Factor by which a bound is widened: distances are rounded by less.
const ROUNDING: f64 = 1.0 + 1e-12;

/// Of every point the `N` nearest others, nearest first. Where there are fewer, a point is its own last neighbours.
#[derive(Clone, Debug)]
pub struct NeighbourLists<const N: usize> {
    lists: Vec<[u32; N]>,
}

impl<const N: usize> NeighbourLists<N> {
    /// By a tree of the points.
    pub fn new(points: &[Vector]) -> NeighbourLists<N> {
        let tree = Neighbours::new(points);
        let mut lists = vec![[0; N]; points.len()];
        for leaves in tree.leaves().chunks(ROUND) {
            let found = threads::map(leaves.len(), TASK, |leaf| of_leaf(&tree, leaves[leaf]));
            found.into_iter().flatten().for_each(|(number, list)| lists[number as usize] = list);
        }
        NeighbourLists { lists }
    }

    /// The neighbours of point `i`.
    pub fn of(&self, i: usize) -> &[u32] {
        &self.lists[i]
    }

    /// Distance of every point from the nearest other one; 0 where there is none.
    pub fn nearest_distances<'a>(&'a self, points: &'a [Vector]) -> impl Iterator<Item = f64> + 'a {
        self.lists.iter().zip(points).map(|(list, p)| norm(minus(points[list[0] as usize], *p)))
    }
}

/// The lists of the points of one leaf.
fn of_leaf<const N: usize>(tree: &Neighbours, leaf: &[(Vector, u32)]) -> Vec<(u32, [u32; N])> {
    let mean = leaf.iter().fold([0.0; 3], |sum, (p, _)| along(sum, 1.0 / leaf.len() as f64, *p));
    let distance = |p: Vector, q: Vector| norm(minus(p, q));
    let Some((middle, _)) = leaf.iter().min_by(|a, b| distance(a.0, mean).total_cmp(&distance(b.0, mean))) else {
        return Vec::new();
    };
    let about = tree.nearest(*middle, N + 1);
    let reach = about.last().map_or(0.0, |(square, _)| square.sqrt());
    let spread = leaf.iter().map(|(p, _)| distance(*p, *middle)).fold(0.0, f64::max);
    // a leaf that is wide beside its neighbourhoods, as where few lie far apart, has little in common
    if about.len() <= N || spread.is_nan() || spread > WIDE * reach {
        return leaf.iter().map(|(p, number)| (*number, others(*number, numbers(tree.nearest(*p, N + 1))))).collect();
    }
    let candidates = tree.within(*middle, (reach + 2.0 * spread) * ROUNDING);
    let mut near = Vec::with_capacity(candidates.len());
    let of = |(place, number): &(Vector, u32)| {
        let farthest = ((reach + distance(*place, *middle)) * ROUNDING).powi(2);
        near.clear();
        near.extend(candidates.iter().filter_map(|(p, j)| {
            let offset = minus(*p, *place);
            let square = dot(offset, offset);
            // one number orders by the distance, whose bits grow with it, and then by the point
            (square <= farthest).then_some(u128::from(square.to_bits()) << u32::BITS | u128::from(*j))
        }));
        near.select_nth_unstable(N);
        near.truncate(N + 1);
        near.sort_unstable();
        (*number, others(*number, near.iter().map(|key| *key as u32)))
    };
    leaf.iter().map(of).collect()
}

/// The first neighbours that are not the point itself.
fn others<const N: usize>(number: u32, near: impl Iterator<Item = u32>) -> [u32; N] {
    let mut list = [number; N];
    list.iter_mut().zip(near.filter(|j| *j != number)).for_each(|(place, j)| *place = j);
    list
}

/// Of neighbours their numbers alone.
fn numbers(near: Vec<(f64, u32)>) -> impl Iterator<Item = u32> {
    near.into_iter().map(|(_, number)| number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn others_come_nearest_first_and_copies_are_others() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0; 3], [3.0, 0.0, 0.0]];
        let lists = NeighbourLists::<3>::new(&points);
        assert_eq!([0, 1, 2, 3].map(|i| lists.of(i).to_vec()), [[2, 1, 3], [0, 2, 3], [0, 1, 3], [1, 0, 2]]);
        assert_eq!(lists.nearest_distances(&points).collect::<Vec<f64>>(), [0.0, 1.0, 0.0, 2.0]);
        let alone = NeighbourLists::<2>::new(&points[..1]);
        assert_eq!((alone.of(0), alone.nearest_distances(&points[..1]).next()), (&[0, 0][..], Some(0.0)));
    }

    /// Places that tie, copies, dense lines, a patch, and one place far from all others.
    #[test]
    fn the_lists_are_those_of_a_search_for_each_point() {
        let of = |i: usize| match i % 5 {
            0 => [(i % 30) as f64, (i / 150) as f64, 0.0],
            1 => [(i as f64 * 0.754_877).fract(), (i as f64 * 0.569_840).fract(), 0.0],
            2 => [40.0, i as f64 * 1e-3, 1.0],
            3 => [(i % 7) as f64, 2.0, (i % 3) as f64],
            _ => [(i as f64 * 0.37).sin(), (i as f64 * 1.71).cos(), (i as f64 * 0.11).sin() * 3.0],
        };
        let points: Vec<Vector> = (0..4000).map(of).chain([[1e6, 0.0, -3.0]]).collect();
        let (tree, lists) = (Neighbours::new(&points), NeighbourLists::<20>::new(&points));
        for (i, p) in points.iter().enumerate() {
            assert_eq!(*lists.of(i), others::<20>(i as u32, numbers(tree.nearest(*p, 21))), "point {i}");
        }
    }
}
