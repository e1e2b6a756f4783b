//! The surface about a point to fourth order, from its neighbours' positions and normals.
//!
//! ```text
//! z = sum_{a+b<=4} c_ab x^a y^b / (a! b!)             axes: the point's own normal is z; 15 unknowns
//! rows: heights / u_z, slopes n_z^2 / u_n             weight (1 - r^4/h^4)^2, h the distance of the farthest neighbour
//! c_3 ~ N(0, bend_3^2 C_3), c_4 ~ N(3 Sym(H^2 H), bend_4^2 C_4)     so that cov c holds noise and what these orders leave open
//! ```
//!
//! The weights vanish at the farthest neighbour and where a neighbour's normal leaves the hemisphere, so that the answer is
//! continuous in the points. `C_3` and `C_4` are the covariances of derivatives of a random field without preferred direction; the mean of `c_4` is that of
//! a surface whose second derivatives H come from constant curvatures. F. Cazals and M. Pouget, *Estimating
//! differential quantities using polynomial fitting of osculating jets*, 2005, without normals and prior.

use super::local::Noise;
use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::linalg::small::{Square, cholesky, inverse, solve};
use palpate_numeric::vector::{Vector, axes_along, dot, minus};

/// Unknowns up to fourth order.
const UNKNOWNS: usize = 15;
/// Powers of x and y that go with each.
const POWERS: [[usize; 2]; UNKNOWNS] = [
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
const FACTORIAL: [f64; 5] = [1.0, 1.0, 2.0, 6.0, 24.0];

/// Cosines between a neighbour's normal and the point's: below the first it is another side of the body, from the sum on it
/// counts wholly. Between, an edge is let go gradually.
const TURNED: [f64; 2] = [0.2, 0.3];

/// Components of a point's own bend against which those of the whole cloud count: they differ from place to place.
const BELIEF: f64 = 10.0;

/// Inverse of `C_3`: the means of `k_x^a k_y^b` over the directions of k are 5/16 and 1/16, and the tensor's mean square is 1.
const THIRD: Square<4> = [[4.0, 0.0, -4.0, 0.0], [0.0, 20.0, 0.0, -4.0], [-4.0, 0.0, 20.0, 0.0], [0.0, -4.0, 0.0, 4.0]];
/// Inverse of `C_4`, of 35/128, 5/128 and 3/128.
const FOURTH: Square<5> = [
    [5.0, 0.0, -10.0, 0.0, 1.0],
    [0.0, 40.0, 0.0, -24.0, 0.0],
    [-10.0, 0.0, 76.0, 0.0, -10.0],
    [0.0, -24.0, 0.0, 40.0, 0.0],
    [1.0, 0.0, -10.0, 0.0, 5.0],
];

/// What the sixth order moves second derivatives by, where derivatives grow from the fourth to the sixth as they did from the
/// second to the fourth: `SIXTH h^4 |c_4|^2 / |c_2|`. Projecting r^6 on lower orders over a disc gives 0.0044 for a sphere; this is
/// twice as much, since the disc is never even.
const SIXTH: f64 = 0.009;

/// What jets are fitted to.
pub(super) struct Touched<'a> {
    pub(super) points: &'a [Vector],
    pub(super) normals: &'a [Vector],
    pub(super) tree: &'a Neighbours<'a>,
    /// Normals are measurements; estimated ones give axes only.
    pub(super) measured: bool,
}

/// What is assumed of every neighbourhood.
#[derive(Clone, Copy, Debug)]
pub(super) struct Law {
    /// Neighbours.
    pub(super) size: usize,
    pub(super) noise: Noise,
    /// Mean square of a third and of a fourth derivative.
    pub(super) bend: [f64; 2],
}

/// The surface at one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet {
    /// The point's normal is the third.
    pub(super) axes: [Vector; 3],
    /// Height, slopes, second derivatives.
    pub(super) low: [f64; 6],
    pub(super) covariance: Square<6>,
    /// Residual sums over their degrees of freedom, and these: heights, normals.
    pub(super) variance: [f64; 2],
    pub(super) freedom: [f64; 2],
    /// Mean squares of third and fourth derivatives, with their uncertainty.
    pub(super) bend: [f64; 2],
    /// What the sixth order may move a second derivative by.
    pub(super) sixth: f64,
}

/// A neighbour in the point's axes, lengths over h.
struct Near {
    x: [f64; 9],
    y: [f64; 9],
    /// Height, slopes.
    seen: [f64; 3],
    /// Of the height, of the slopes.
    weight: [f64; 2],
    /// The part of the weight that is no noise.
    share: f64,
}

/// The jet at point `i`; `None` where the neighbours leave its second derivatives open.
pub(super) fn jet(touched: &Touched, i: usize, law: &Law) -> Option<Jet> {
    let axes = axes_along(touched.normals[i]);
    let found = touched.tree.nearest(touched.points[i], law.size + 1);
    let far = found.last()?.0;
    let length = far.sqrt();
    if length.is_nan() || length <= 0.0 {
        return None;
    }
    let near: Vec<Near> = found
        .iter()
        .filter_map(|&(square, j)| neighbour(touched, (i, j as usize), &axes, (square / far, length), law))
        .collect();
    let sums = Sums::of(&near);
    let unit = [1.0, length, length * length, length.powi(3)];
    let prior = |bend: &[f64; 2]| [bend[0] * unit[2] * unit[2], bend[1] * unit[3] * unit[3]];
    // the same matrix serves both: only the mean of the fourth derivatives is another
    let lower = factor(&sums, &prior(&law.bend))?;
    let start = evenly_bent(&solve(&lower, right_side(&sums, &prior(&law.bend), &[0.0; 5])));
    let first = Solved { c: solve(&lower, right_side(&sums, &prior(&law.bend), &start)), covariance: inverse(&lower) };
    let moments = first.moments(&start);
    let own: [f64; 2] = std::array::from_fn(|k| {
        let whole = law.bend[k] * unit[k + 2] * unit[k + 2];
        let count = 4.0 + k as f64;
        (BELIEF * whole + count * moments[k]) / (BELIEF + count)
    });
    let last = Solved::of(&sums, &own, &evenly_bent(&first.c))?;
    let (variance, freedom) = last.misfit(&near, &sums, &law.noise);
    let bend = std::array::from_fn(|k| moments[k] / (unit[k + 2] * unit[k + 2]));
    Some(last.jet(axes, length, bend, (variance, freedom)))
}

fn neighbour(
    touched: &Touched,
    (i, j): (usize, usize),
    axes: &[Vector; 3],
    (square, length): (f64, f64),
    law: &Law,
) -> Option<Near> {
    let offset = minus(touched.points[j], touched.points[i]);
    let [x, y, z] = axes.map(|axis| dot(axis, offset) / length);
    let [nx, ny, nz] = axes.map(|axis| dot(axis, touched.normals[j]));
    let turned = ((nz - TURNED[0]) / TURNED[1]).clamp(0.0, 1.0);
    let share = (1.0 - square * square).max(0.0).powi(2) * turned * turned * (3.0 - 2.0 * turned);
    if share.is_nan() || share <= 0.0 {
        return None;
    }
    let of_height = nz * length / law.noise.distance;
    let of_slope = if touched.measured { nz * nz / law.noise.normal } else { 0.0 };
    Some(Near {
        x: powers(x),
        y: powers(y),
        seen: [z, -nx / nz, -ny / nz],
        weight: [share * of_height * of_height, share * of_slope * of_slope],
        share,
    })
}

fn powers(x: f64) -> [f64; 9] {
    let mut all = [1.0; 9];
    (1..9).for_each(|k| all[k] = all[k - 1] * x);
    all
}

/// Normal equations: of heights and of slopes, whose matrices are made of moments of x and y.
struct Sums {
    height: Square<UNKNOWNS>,
    slope: Square<UNKNOWNS>,
    right: [f64; UNKNOWNS],
}

impl Sums {
    fn of(near: &[Near]) -> Sums {
        let (mut heights, mut slopes) = ([[0.0; 9]; 9], [[0.0; 9]; 9]);
        let mut seen = [[[0.0; 5]; 5]; 3];
        for one in near {
            let [of_height, of_slope] = one.weight;
            for a in 0..9 {
                let (h, s) = (of_height * one.x[a], of_slope * one.x[a]);
                (0..9 - a).for_each(|b| heights[a][b] += h * one.y[b]);
                (0..7_usize.saturating_sub(a)).for_each(|b| slopes[a][b] += s * one.y[b]);
            }
            for (k, sum) in seen.iter_mut().enumerate() {
                let value = one.weight[usize::from(k > 0)] * one.seen[k];
                for a in 0..5 {
                    (0..5 - a).for_each(|b| sum[a][b] += value * one.x[a] * one.y[b]);
                }
            }
        }
        Sums::assembled(&heights, &slopes, &seen)
    }

    fn assembled(heights: &[[f64; 9]; 9], slopes: &[[f64; 9]; 9], seen: &[[[f64; 5]; 5]; 3]) -> Sums {
        let mut sums =
            Sums { height: [[0.0; UNKNOWNS]; UNKNOWNS], slope: [[0.0; UNKNOWNS]; UNKNOWNS], right: [0.0; UNKNOWNS] };
        let over = |a: usize, b: usize| 1.0 / (FACTORIAL[a] * FACTORIAL[b]);
        for (i, [a, b]) in POWERS.into_iter().enumerate() {
            sums.right[i] = over(a, b) * seen[0][a][b];
            sums.right[i] += if a > 0 { over(a - 1, b) * seen[1][a - 1][b] } else { 0.0 };
            sums.right[i] += if b > 0 { over(a, b - 1) * seen[2][a][b - 1] } else { 0.0 };
            for (j, [c, d]) in POWERS.into_iter().enumerate() {
                sums.height[i][j] = over(a, b) * over(c, d) * heights[a + c][b + d];
                if a > 0 && c > 0 {
                    sums.slope[i][j] += over(a - 1, b) * over(c - 1, d) * slopes[a + c - 2][b + d];
                }
                if b > 0 && d > 0 {
                    sums.slope[i][j] += over(a, b - 1) * over(c, d - 1) * slopes[a + c][b + d - 2];
                }
            }
        }
        sums
    }
}

struct Solved {
    c: [f64; UNKNOWNS],
    covariance: Square<UNKNOWNS>,
}

/// Inverses of the prior's mean squares of third and fourth derivatives, over h.
fn precision(prior: &[f64; 2]) -> [f64; 2] {
    prior.map(|p| 1.0 / p.max(f64::MIN_POSITIVE))
}

/// Cholesky factor of the normal matrix with the prior.
fn factor(sums: &Sums, prior: &[f64; 2]) -> Option<Square<UNKNOWNS>> {
    let mut matrix = sums.height;
    for (row, slopes) in matrix.iter_mut().zip(&sums.slope) {
        row.iter_mut().zip(slopes).for_each(|(a, b)| *a += b);
    }
    let [third, fourth] = precision(prior);
    for i in 0..4 {
        (0..4).for_each(|j| matrix[6 + i][6 + j] += third * THIRD[i][j]);
    }
    for i in 0..5 {
        (0..5).for_each(|j| matrix[10 + i][10 + j] += fourth * FOURTH[i][j]);
    }
    cholesky(&matrix)
}

/// Right side where the fourth derivatives have this mean.
fn right_side(sums: &Sums, prior: &[f64; 2], mean: &[f64; 5]) -> [f64; UNKNOWNS] {
    let mut right = sums.right;
    let [_, fourth] = precision(prior);
    for i in 0..5 {
        right[10 + i] += fourth * (0..5).map(|j| FOURTH[i][j] * mean[j]).sum::<f64>();
    }
    right
}

/// Fourth derivatives of a surface of constant curvatures with the second ones of `c`: `3 Sym(H^2 H)`.
fn evenly_bent(c: &[f64; UNKNOWNS]) -> [f64; 5] {
    let [a, b, d] = [c[3], c[4], c[5]];
    let [g, e, f] = [a * a + b * b, b * (a + d), b * b + d * d];
    [3.0 * g * a, 1.5 * (g * b + e * a), 0.5 * (g * d + f * a + 4.0 * e * b), 1.5 * (f * b + e * d), 3.0 * f * d]
}

impl Solved {
    /// `prior`: mean squares of third and fourth derivatives, over h; `mean`: of the fourth.
    fn of(sums: &Sums, prior: &[f64; 2], mean: &[f64; 5]) -> Option<Solved> {
        let lower = factor(sums, prior)?;
        Some(Solved { c: solve(&lower, right_side(sums, prior, mean)), covariance: inverse(&lower) })
    }

    /// Mean squares of third derivatives, and of fourth about `mean`, by their prior's measure.
    fn moments(&self, mean: &[f64; 5]) -> [f64; 2] {
        let moment = |i: usize, j: usize, a: f64, b: f64| a * b + self.covariance[i][j];
        let (mut third, mut fourth) = (0.0, 0.0);
        for i in 0..4 {
            third += (0..4).map(|j| THIRD[i][j] * moment(6 + i, 6 + j, self.c[6 + i], self.c[6 + j])).sum::<f64>();
        }
        let off: [f64; 5] = std::array::from_fn(|i| self.c[10 + i] - mean[i]);
        for i in 0..5 {
            fourth += (0..5).map(|j| FOURTH[i][j] * moment(10 + i, 10 + j, off[i], off[j])).sum::<f64>();
        }
        [third / 4.0, fourth / 5.0]
    }

    /// Coefficients of `x^a y^b` in the height and in the two slopes.
    fn polynomials(&self) -> [[[f64; 5]; 5]; 3] {
        let mut all = [[[0.0; 5]; 5]; 3];
        for (c, [a, b]) in self.c.iter().zip(POWERS) {
            all[0][a][b] = c / (FACTORIAL[a] * FACTORIAL[b]);
            if a > 0 {
                all[1][a - 1][b] = c / (FACTORIAL[a - 1] * FACTORIAL[b]);
            }
            if b > 0 {
                all[2][a][b - 1] = c / (FACTORIAL[a] * FACTORIAL[b - 1]);
            }
        }
        all
    }

    /// Residual sums over their degrees of freedom, in the cloud's units, and these degrees.
    fn misfit(&self, near: &[Near], sums: &Sums, noise: &Noise) -> ([f64; 2], [f64; 2]) {
        let (mut squares, mut freedom) = ([0.0; 2], [0.0; 2]);
        let surfaces = self.polynomials();
        for one in near {
            let left: [f64; 3] = std::array::from_fn(|k| {
                let at: f64 =
                    (0..5).map(|a| one.x[a] * (0..5).map(|b| surfaces[k][a][b] * one.y[b]).sum::<f64>()).sum();
                one.seen[k] - at
            });
            squares[0] += one.weight[0] * left[0] * left[0];
            squares[1] += one.weight[1] * (left[1] * left[1] + left[2] * left[2]);
            freedom[0] += one.share;
            freedom[1] += 2.0 * one.share;
        }
        let trace = |block: &Square<UNKNOWNS>| -> f64 {
            self.covariance.iter().zip(block).flat_map(|(c, b)| c.iter().zip(b)).map(|(c, b)| c * b).sum()
        };
        freedom[0] = (freedom[0] - trace(&sums.height)).max(1.0);
        freedom[1] = (freedom[1] - trace(&sums.slope)).max(1.0);
        let scale = [noise.distance, noise.normal];
        (std::array::from_fn(|k| squares[k] / freedom[k] * scale[k] * scale[k]), freedom)
    }

    /// Back in the cloud's units.
    fn jet(&self, axes: [Vector; 3], length: f64, bend: [f64; 2], fit: ([f64; 2], [f64; 2])) -> Jet {
        let unit = |k: usize| [length, 1.0, 1.0, 1.0 / length, 1.0 / length, 1.0 / length][k];
        let covariance = std::array::from_fn(|i| std::array::from_fn(|j| self.covariance[i][j] * unit(i) * unit(j)));
        let low = std::array::from_fn(|i| self.c[i] * unit(i));
        let size = |from: usize, to: usize| -> f64 {
            (from..to).map(|i| multiplicity(POWERS[i][0], POWERS[i][1]) * self.c[i] * self.c[i]).sum()
        };
        // a flat place has no scale of its own: there the fourth order is all that is known
        let (second, fourth) = (size(3, 6), size(10, 15));
        let sixth = if fourth > 0.0 { SIXTH * fourth / (second + fourth).sqrt() / length } else { 0.0 };
        Jet { axes, low, covariance, variance: fit.0, freedom: fit.1, bend, sixth }
    }
}

/// Places of a derivative in the symmetric tensor of its order.
fn multiplicity(a: usize, b: usize) -> f64 {
    FACTORIAL[a + b] / (FACTORIAL[a] * FACTORIAL[b])
}
