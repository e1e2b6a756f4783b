//! The neighbours of a point in its own axes, and the sums over them that a fit of its jet takes.
//!
//! ```text
//! z = sum_{a+b<=4} c_ab x^a y^b / (a! b!)             axes: the point's own normal is z; lengths over h
//! rows: heights n_z h, slopes n_z^2                   weight (1 - r^4/h^4)^2, h the distance of the farthest neighbour
//! ```
//!
//! Rows are for noises of one: a matrix is made of moments of x and y, heights and slopes apart, so that other noises are two factors.
//! The weights vanish at the farthest neighbour and where a neighbour's normal leaves the hemisphere, so that the answer is
//! continuous in the points.

use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::linalg::small::Square;
use palpate_numeric::vector::{Vector, axes_along, dot, minus};

/// Unknowns up to fourth order.
pub(super) const UNKNOWNS: usize = 15;
/// Powers of x and y that go with each.
pub(super) const POWERS: [[usize; 2]; UNKNOWNS] = [
    [0, 0],
    [1, 0],
    [0, 1],
    [2, 0],
    [1, 1],
    [0, 2],
    [3, 0],
    [2, 1],
    [1, 2],
    [0, 3],
    [4, 0],
    [3, 1],
    [2, 2],
    [1, 3],
    [0, 4],
];
pub(super) const FACTORIAL: [f64; 5] = [1.0, 1.0, 2.0, 6.0, 24.0];

/// Cosines between a neighbour's normal and the point's: below the first it is another side of the body, from the sum on it
/// counts wholly. Between, an edge is let go gradually.
const TURNED: [f64; 2] = [0.2, 0.3];

/// What jets are fitted to.
pub(super) struct Touched<'a> {
    pub(super) points: &'a [Vector],
    pub(super) normals: &'a [Vector],
    pub(super) tree: &'a Neighbours<'a>,
    /// Normals are measurements; estimated ones give axes only.
    pub(super) measured: bool,
}

/// A neighbour in the point's axes, lengths over h.
pub(super) struct Near {
    pub(super) number: u32,
    pub(super) place: [f64; 2],
    /// Height, slopes.
    pub(super) seen: [f64; 3],
    /// Of the height, of the slopes, for noises of one.
    pub(super) weight: [f64; 2],
    /// The part of the weight that is no noise.
    pub(super) share: f64,
}

/// A point's neighbours.
pub(super) struct Neighbourhood {
    /// The point's normal is the third.
    pub(super) axes: [Vector; 3],
    /// The distance h of the farthest neighbour.
    pub(super) length: f64,
    pub(super) near: Vec<Near>,
    pub(super) sums: Sums,
}

impl Neighbourhood {
    /// So many neighbours of point `i`; `None` where they are in its own place.
    pub(super) fn of(touched: &Touched, i: usize, size: usize) -> Option<Neighbourhood> {
        let axes = axes_along(touched.normals[i]);
        let found = touched.tree.nearest_unordered(touched.points[i], size + 1);
        let far = found.iter().map(|(square, _)| *square).fold(0.0, f64::max);
        let length = far.sqrt();
        if length.is_nan() || length <= 0.0 {
            return None;
        }
        let mut near = Vec::with_capacity(found.len());
        near.extend(found.iter().filter_map(|&(square, j)| neighbour(touched, (i, j), &axes, (square / far, length))));
        let sums = Sums::of(&near);
        Some(Neighbourhood { axes, length, near, sums })
    }
}

fn neighbour(
    touched: &Touched,
    (i, number): (usize, u32),
    axes: &[Vector; 3],
    (square, length): (f64, f64),
) -> Option<Near> {
    let j = number as usize;
    let offset = minus(touched.points[j], touched.points[i]);
    let [x, y, z] = axes.map(|axis| dot(axis, offset) / length);
    let [nx, ny, nz] = axes.map(|axis| dot(axis, touched.normals[j]));
    let turned = ((nz - TURNED[0]) / TURNED[1]).clamp(0.0, 1.0);
    let share = (1.0 - square * square).max(0.0).powi(2) * turned * turned * (3.0 - 2.0 * turned);
    if share.is_nan() || share <= 0.0 {
        return None;
    }
    let of_height = nz * length;
    let of_slope = if touched.measured { nz * nz } else { 0.0 };
    Some(Near {
        number,
        place: [x, y],
        seen: [z, -nx / nz, -ny / nz],
        weight: [share * of_height * of_height, share * of_slope * of_slope],
        share,
    })
}

fn powers<const N: usize>(x: f64) -> [f64; N] {
    let mut all = [1.0; N];
    (1..N).for_each(|k| all[k] = all[k - 1] * x);
    all
}

/// Normal equations: of heights and of slopes.
pub(super) struct Sums {
    pub(super) matrix: [Square<UNKNOWNS>; 2],
    pub(super) right: [[f64; UNKNOWNS]; 2],
}

impl Sums {
    fn of(near: &[Near]) -> Sums {
        let (mut heights, mut slopes) = ([[0.0; 9]; 9], [[0.0; 9]; 9]);
        let mut seen = [[[0.0; 5]; 5]; 3];
        for one in near {
            let [of_height, of_slope] = one.weight;
            let (x, y): ([f64; 9], [f64; 9]) = (powers(one.place[0]), powers(one.place[1]));
            for a in 0..9 {
                let (h, s) = (of_height * x[a], of_slope * x[a]);
                (0..9 - a).for_each(|b| heights[a][b] += h * y[b]);
                (0..7_usize.saturating_sub(a)).for_each(|b| slopes[a][b] += s * y[b]);
            }
            for (k, sum) in seen.iter_mut().enumerate() {
                let value = one.weight[usize::from(k > 0)] * one.seen[k];
                for a in 0..5 {
                    (0..5 - a).for_each(|b| sum[a][b] += value * x[a] * y[b]);
                }
            }
        }
        Sums::assembled(&heights, &slopes, &seen)
    }

    fn assembled(heights: &[[f64; 9]; 9], slopes: &[[f64; 9]; 9], seen: &[[[f64; 5]; 5]; 3]) -> Sums {
        let mut sums = Sums { matrix: [[[0.0; UNKNOWNS]; UNKNOWNS]; 2], right: [[0.0; UNKNOWNS]; 2] };
        let over = |a: usize, b: usize| 1.0 / (FACTORIAL[a] * FACTORIAL[b]);
        for (i, [a, b]) in POWERS.into_iter().enumerate() {
            sums.right[0][i] = over(a, b) * seen[0][a][b];
            sums.right[1][i] += if a > 0 { over(a - 1, b) * seen[1][a - 1][b] } else { 0.0 };
            sums.right[1][i] += if b > 0 { over(a, b - 1) * seen[2][a][b - 1] } else { 0.0 };
            for (j, [c, d]) in POWERS.into_iter().enumerate() {
                sums.matrix[0][i][j] = over(a, b) * over(c, d) * heights[a + c][b + d];
                if a > 0 && c > 0 {
                    sums.matrix[1][i][j] += over(a - 1, b) * over(c - 1, d) * slopes[a + c - 2][b + d];
                }
                if b > 0 && d > 0 {
                    sums.matrix[1][i][j] += over(a, b - 1) * over(c, d - 1) * slopes[a + c][b + d - 2];
                }
            }
        }
        sums
    }

    /// Both for these precisions of heights and of slopes: the lower triangle of the matrix, and the right side.
    pub(super) fn weighted(&self, precision: [f64; 2]) -> (Square<UNKNOWNS>, [f64; UNKNOWNS]) {
        let [height, slope] = precision;
        let mut matrix = [[0.0; UNKNOWNS]; UNKNOWNS];
        for (i, row) in matrix.iter_mut().enumerate() {
            (0..=i).for_each(|j| row[j] = height * self.matrix[0][i][j] + slope * self.matrix[1][i][j]);
        }
        (matrix, std::array::from_fn(|i| height * self.right[0][i] + slope * self.right[1][i]))
    }
}
