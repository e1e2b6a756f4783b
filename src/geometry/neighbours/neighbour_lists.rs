//! The nearest neighbours of every point, found once for all that asks for them.

use palpate_numeric::threads;
use palpate_numeric::vector::{Vector, minus, norm};

use super::tree::Neighbours;

/// Points that one thread looks at.
const TASK: usize = 256;

/// Of every point the `N` nearest others, nearest first. Where there are fewer, a point is its own last neighbours.
#[derive(Clone, Debug)]
pub struct NeighbourLists<const N: usize> {
    lists: Vec<[u32; N]>,
}

impl<const N: usize> NeighbourLists<N> {
    /// One query of a tree for each point.
    pub fn new(points: &[Vector]) -> NeighbourLists<N> {
        let tree = Neighbours::new(points);
        let of = |i: usize| -> [u32; N] {
            let found = tree.nearest(points[i], N + 1);
            let others = found.iter().map(|(_, j)| *j).filter(|j| *j as usize != i);
            let mut list = [i as u32; N];
            list.iter_mut().zip(others).for_each(|(place, j)| *place = j);
            list
        };
        NeighbourLists { lists: threads::map(points.len(), TASK, of) }
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
}
