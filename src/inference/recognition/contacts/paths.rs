//! Whether places lie along paths: their neighbours stand in a row.
//!
//! ```text
//! squares of a place's nearest places along their principal axes: first >= second        second / first > 0.1 where they lie around it
//! ```
//!
//! Places along one ring or two rows lie on many surfaces; places all over a short pipe look like a ring from its end, and lie on few.

use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::linalg::small::eigen;
use palpate_numeric::statistics::median;
use palpate_numeric::vector::{Vector, minus};

/// Places that are asked for of every one, itself among them.
const ASKED: usize = 8;

/// Second square over the first, below which neighbours stand in a row: they are three times as long as wide.
const IN_A_ROW: f64 = 0.1;

/// Whether most places stand in rows with their neighbours.
pub(crate) fn along_paths(places: &[Vector]) -> bool {
    let tree = Neighbours::new(places);
    let ratios: Vec<f64> = places.iter().filter_map(|place| ratio(&tree, places, *place)).collect();
    median(ratios).is_none_or(|ratio| ratio < IN_A_ROW)
}

/// Second square over the first; `None` of places that are one.
fn ratio(tree: &Neighbours, places: &[Vector], place: Vector) -> Option<f64> {
    let near: Vec<Vector> = tree.nearest(place, ASKED).iter().map(|(_, i)| minus(places[*i as usize], place)).collect();
    let count = near.len() as f64;
    let mean = [0, 1, 2].map(|k| near.iter().map(|d| d[k]).sum::<f64>() / count);
    let square = |i: usize, j: usize| near.iter().map(|d| (d[i] - mean[i]) * (d[j] - mean[j])).sum::<f64>();
    let (squares, _) = eigen(&[0, 1, 2].map(|i| [0, 1, 2].map(|j| square(i, j))));
    let [_, second, first] = squares;
    (first > 0.0).then_some(second / first)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places on a pipe of radius 1, as high as given, in turns of the golden angle.
    fn pipe(height: f64) -> Vec<Vector> {
        let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        let place = |k: usize| {
            let (sin, cos) = (golden * k as f64).sin_cos();
            [cos, sin, height * (k as f64 / 119.0 - 0.5)]
        };
        (0..120).map(place).collect()
    }

    #[test]
    fn a_ring_and_two_rows_are_paths_and_a_short_pipe_is_none() {
        let rows: Vec<Vector> = (0..40).map(|k| [0.1 * f64::from(k / 2), f64::from(k % 2) * 3.0, 0.0]).collect();
        assert!(along_paths(&pipe(0.0)) && along_paths(&pipe(0.01)) && along_paths(&rows));
        assert!(!along_paths(&pipe(1.0)));
    }
}
