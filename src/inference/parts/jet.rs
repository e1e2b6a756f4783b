//! The surface about a point to fourth order, from its neighbours' positions and normals.
//!
//! ```text
//! z = sum_{a+b<=4} c_ab x^a y^b / (a! b!)             15 unknowns, from the rows of `jet_neighbourhood.rs` over u_z and u_n
//! c_3 ~ N(0, bend_3^2 C_3), c_4 ~ N(3 Sym(H^2 H), bend_4^2 C_4)     so that cov c holds noise and what these orders leave open
//! ```
//!
//! `C_3` and `C_4` are the covariances of derivatives of a random field without preferred direction; the mean of `c_4` is that of
//! a surface whose second derivatives H come from constant curvatures. F. Cazals and M. Pouget, *Estimating
//! differential quantities using polynomial fitting of osculating jets*, 2005, without normals and prior.

use super::jet_neighbourhood::{FACTORIAL, Near, Neighbourhood, POWERS, Sums, UNKNOWNS};
use super::local::Noise;
use palpate_numeric::linalg::small::{Square, cholesky, inverse, solve};
use palpate_numeric::vector::Vector;

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

/// What the fifth order moves second derivatives by at a distance r from the middle, where derivatives grow so: `FIFTH h^2 r |c_5|`. In
/// the middle of an even disc it is nothing. Projecting x^5 on lower orders over a disc gives 0.037; this is twice as much, as above.
const FIFTH: f64 = 0.075;

/// What is assumed of every neighbourhood.
#[derive(Clone, Copy, Debug)]
pub(super) struct Law {
    /// Neighbours.
    pub(super) size: usize,
    pub(super) noise: Noise,
    /// Mean square of a third and of a fourth derivative.
    pub(super) bend: [f64; 2],
    /// Components of a point's own bend against which that counts.
    pub(super) belief: f64,
}

/// The surface about one point.
#[derive(Clone, Debug)]
pub(super) struct Jet {
    /// The point's normal is the third.
    pub(super) axes: [Vector; 3],
    /// The distance h of the farthest neighbour.
    length: f64,
    solved: Solved,
    /// Residual sums over their degrees of freedom, and these: heights, normals.
    pub(super) variance: [f64; 2],
    pub(super) freedom: [f64; 2],
    /// Mean squares of third and fourth derivatives, with their uncertainty.
    pub(super) bend: [f64; 2],
    /// Sizes of fifth and sixth derivatives over h, where derivatives grow from the fourth on as they did from the second to the fourth.
    beyond: [f64; 2],
}

/// What a jet says of one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct JetDerivatives {
    pub(super) slopes: [f64; 2],
    /// Along x twice, along both, along y twice.
    pub(super) second: [f64; 3],
    pub(super) covariance: Square<3>,
    /// What higher orders may move a second derivative by.
    pub(super) left_out: f64,
}

impl Neighbourhood {
    /// The jet of a neighbourhood; `None` where it leaves second derivatives open.
    pub(super) fn jet(&self, law: &Law) -> Option<Jet> {
        let unit = |k: usize| self.length.powi(k as i32);
        let precision = [law.noise.distance, law.noise.normal].map(|noise| 1.0 / (noise * noise));
        let weighted = self.sums.weighted(precision);
        let whole: [f64; 2] = std::array::from_fn(|k| law.bend[k] * unit(k + 2) * unit(k + 2));
        // the same matrix serves both: only the mean of the fourth derivatives is another
        let lower = factor(&weighted.0, &whole)?;
        let start = evenly_bent(&solve(&lower, right_side(&weighted.1, &whole, &[0.0; 5])));
        let first = solve(&lower, right_side(&weighted.1, &whole, &start));
        let moments = moments(&first, &covariance_of_higher(&lower), &start);
        let own: [f64; 2] = std::array::from_fn(|k| {
            let count = 4.0 + k as f64;
            (law.belief * whole[k] + count * moments[k]) / (law.belief + count)
        });
        let lower = factor(&weighted.0, &own)?;
        let last = Solved {
            c: solve(&lower, right_side(&weighted.1, &own, &evenly_bent(&first))),
            covariance: inverse(&lower),
        };
        let (variance, freedom) = last.misfit(&self.near, &self.sums, precision);
        let bend = std::array::from_fn(|k| moments[k] / (unit(k + 2) * unit(k + 2)));
        let beyond = last.beyond();
        Some(Jet { axes: self.axes, length: self.length, solved: last, variance, freedom, bend, beyond })
    }
}

impl Jet {
    /// Derivatives of the surface at a place in the point's axes, lengths over h; the result is in the cloud's units.
    pub(super) fn at(&self, place: [f64; 2]) -> JetDerivatives {
        let [x, y] = place;
        let over = |a: usize, b: usize| x.powi(a as i32) * y.powi(b as i32) / (FACTORIAL[a] * FACTORIAL[b]);
        // derivatives of a polynomial are polynomials of the coefficients that follow
        let basis: [f64; 10] = std::array::from_fn(|k| over(POWERS[k][0], POWERS[k][1]));
        let value = |p: usize, q: usize, count: usize| -> f64 {
            (0..count).map(|k| basis[k] * self.solved.c[number(POWERS[k][0] + p, POWERS[k][1] + q)]).sum()
        };
        let [per, square] = [1.0 / self.length, 1.0 / (self.length * self.length)];
        let second = [[2, 0], [1, 1], [0, 2]];
        let covariance = |[p, q]: [usize; 2], [r, s]: [usize; 2]| -> f64 {
            let row = |k: usize| &self.solved.covariance[number(POWERS[k][0] + p, POWERS[k][1] + q)];
            let with =
                |k: usize| (0..6).map(|l| basis[l] * row(k)[number(POWERS[l][0] + r, POWERS[l][1] + s)]).sum::<f64>();
            (0..6).map(|k| basis[k] * with(k)).sum()
        };
        JetDerivatives {
            slopes: [value(1, 0, 10), value(0, 1, 10)],
            second: second.map(|[p, q]| per * value(p, q, 6)),
            covariance: second.map(|one| second.map(|two| square * covariance(one, two))),
            left_out: self.left_out(place),
        }
    }

    /// Variance of a second derivative in the middle, the mean of the three.
    pub(super) fn variance_of_second(&self) -> f64 {
        (3..6).map(|k| self.solved.covariance[k][k]).sum::<f64>() / (3.0 * self.length * self.length)
    }

    /// What higher orders may move a second derivative by at a place.
    pub(super) fn left_out(&self, [x, y]: [f64; 2]) -> f64 {
        let [fifth, sixth] = self.beyond;
        (SIXTH * sixth).hypot(FIFTH * x.hypot(y) * fifth) / self.length
    }
}

/// Place of `c_ab` among the unknowns.
fn number(a: usize, b: usize) -> usize {
    (a + b) * (a + b + 1) / 2 + b
}

#[derive(Clone, Debug)]
struct Solved {
    c: [f64; UNKNOWNS],
    covariance: Square<UNKNOWNS>,
}

/// Inverses of the prior's mean squares of third and fourth derivatives, over h.
fn precision(prior: &[f64; 2]) -> [f64; 2] {
    prior.map(|p| 1.0 / p.max(f64::MIN_POSITIVE))
}

/// Cholesky factor of the normal matrix with the prior.
fn factor(matrix: &Square<UNKNOWNS>, prior: &[f64; 2]) -> Option<Square<UNKNOWNS>> {
    let mut matrix = *matrix;
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
fn right_side(right: &[f64; UNKNOWNS], prior: &[f64; 2], mean: &[f64; 5]) -> [f64; UNKNOWNS] {
    let mut right = *right;
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

/// Orders from the third on: the last unknowns.
const HIGHER: usize = 9;

/// Their covariance, by the end of the factor alone: what stands before it is integrated out.
fn covariance_of_higher(lower: &Square<UNKNOWNS>) -> Square<HIGHER> {
    const FIRST: usize = UNKNOWNS - HIGHER;
    inverse(&std::array::from_fn(|i| std::array::from_fn(|j| lower[FIRST + i][FIRST + j])))
}

/// Mean squares of third derivatives, and of fourth about `mean`, by their prior's measure.
fn moments(c: &[f64; UNKNOWNS], covariance: &Square<HIGHER>, mean: &[f64; 5]) -> [f64; 2] {
    let moment = |i: usize, j: usize, a: f64, b: f64| a * b + covariance[i][j];
    let (mut third, mut fourth) = (0.0, 0.0);
    for i in 0..4 {
        third += (0..4).map(|j| THIRD[i][j] * moment(i, j, c[6 + i], c[6 + j])).sum::<f64>();
    }
    let off: [f64; 5] = std::array::from_fn(|i| c[10 + i] - mean[i]);
    for i in 0..5 {
        fourth += (0..5).map(|j| FOURTH[i][j] * moment(4 + i, 4 + j, off[i], off[j])).sum::<f64>();
    }
    [third / 4.0, fourth / 5.0]
}

impl Solved {
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
    fn misfit(&self, near: &[Near], sums: &Sums, precision: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let (mut squares, mut freedom) = ([0.0; 2], [0.0; 2]);
        let surfaces = self.polynomials();
        for one in near {
            let [x, y] = one.place;
            let left: [f64; 3] = std::array::from_fn(|k| {
                let of_y = |a: usize| (0..5 - a).rev().fold(0.0, |sum, b| sum * y + surfaces[k][a][b]);
                one.seen[k] - (0..5).rev().fold(0.0, |sum, a| sum * x + of_y(a))
            });
            squares[0] += one.weight[0] * left[0] * left[0];
            squares[1] += one.weight[1] * (left[1] * left[1] + left[2] * left[2]);
            freedom[0] += one.share;
            freedom[1] += 2.0 * one.share;
        }
        for k in 0..2 {
            let products = self.covariance.iter().zip(&sums.matrix[k]).flat_map(|(c, b)| c.iter().zip(b));
            freedom[k] = (freedom[k] - precision[k] * products.map(|(c, b)| c * b).sum::<f64>()).max(1.0);
        }
        (std::array::from_fn(|k| squares[k] / freedom[k]), freedom)
    }

    /// Sizes of fifth and sixth derivatives: the ratio of the fourth to the second is that of the sixth to the fourth.
    fn beyond(&self) -> [f64; 2] {
        let size = |from: usize, to: usize| -> f64 {
            (from..to).map(|i| multiplicity(POWERS[i][0], POWERS[i][1]) * self.c[i] * self.c[i]).sum()
        };
        // a flat place has no scale of its own: there the fourth order is all that is known
        let (second, fourth) = (size(3, 6), size(10, 15));
        if fourth <= 0.0 {
            return [0.0; 2];
        }
        let sixth = fourth / (second + fourth).sqrt();
        [(fourth.sqrt() * sixth).sqrt(), sixth]
    }
}

/// Places of a derivative in the symmetric tensor of its order.
fn multiplicity(a: usize, b: usize) -> f64 {
    FACTORIAL[a + b] / (FACTORIAL[a] * FACTORIAL[b])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::jet_neighbourhood::Touched;
    use crate::parts::tuning::PartsTuning;
    use palpate_geometry::neighbours::Neighbours;

    /// Coefficients of `x^a y^b / (a! b!)` beside the plane.
    const SURFACE: [f64; UNKNOWNS] = [0.0, 0.0, 0.0, 0.4, 0.1, -0.2, 0.3, -0.1, 0.2, 0.15, 0.5, -0.2, 0.3, 0.1, -0.4];

    /// Value of its derivative of order p in x and q in y.
    fn derivative(p: i32, q: i32, x: f64, y: f64) -> f64 {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        let of = |(c, [a, b]): (f64, [usize; 2])| {
            let [a, b] = [a as i32 - p, b as i32 - q];
            if a < 0 || b < 0 { 0.0 } else { c * x.powi(a) * y.powi(b) / (factorial(a) * factorial(b)) }
        };
        SURFACE.into_iter().zip(POWERS).map(of).sum()
    }

    /// The jet in the middle of a surface of fourth order, known to `noise`, and the distance of its farthest neighbour.
    fn jet(noise: f64) -> (Jet, f64) {
        let place = |k: usize| (0.08 * ((k % 15) as f64 - 7.0), 0.08 * ((k / 15) as f64 - 7.0));
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..225)
            .map(place)
            .map(|(x, y)| {
                let [zx, zy] = [derivative(1, 0, x, y), derivative(0, 1, x, y)];
                let length = (1.0 + zx * zx + zy * zy).sqrt();
                ([x, y, derivative(0, 0, x, y)], [-zx / length, -zy / length, 1.0 / length])
            })
            .unzip();
        let tree = Neighbours::new(&points);
        let touched = Touched { points: &points, normals: &normals, tree: &tree, measured: true };
        let near = Neighbourhood::of(&touched, 112, 150).unwrap();
        let belief = PartsTuning::default().jet_belief;
        let law = Law { size: 150, noise: Noise { distance: noise, normal: noise }, bend: [1.0; 2], belief };
        (near.jet(&law).unwrap(), near.length)
    }

    #[test]
    fn a_surface_of_fourth_order_is_known_off_the_middle_too() {
        let (jet, length) = jet(1e-7);
        for place in [[0.0, 0.0], [0.3, -0.2], [-0.1, 0.4]] {
            // in the cloud's axes and lengths
            let [x, y] = [0, 1].map(|k| length * (0..2).map(|a| jet.axes[a][k] * place[a]).sum::<f64>());
            let at = jet.at(place);
            let slopes = [0, 1].map(|k| (0..2).map(|a| jet.axes[a][k] * at.slopes[a]).sum::<f64>());
            let truth = [derivative(1, 0, x, y), derivative(0, 1, x, y)];
            assert!((0..2).all(|k| (slopes[k] - truth[k]).abs() < 1e-6), "{slopes:?} {truth:?}");
            let [xx, xy, yy] = at.second;
            let hesse = [[xx, xy], [xy, yy]];
            let turned = |k: usize, l: usize| -> f64 {
                (0..2)
                    .flat_map(|a| (0..2).map(move |b| (a, b)))
                    .map(|(a, b)| jet.axes[a][k] * hesse[a][b] * jet.axes[b][l])
                    .sum()
            };
            for (p, q, found) in [(2, 0, turned(0, 0)), (1, 1, turned(0, 1)), (0, 2, turned(1, 1))] {
                assert!((found - derivative(p, q, x, y)).abs() < 1e-5, "{p} {q}: {found}");
            }
        }
    }

    /// Farther from the middle less is known, and more is left out.
    #[test]
    fn the_variance_in_the_middle_is_that_of_its_place() {
        let (jet, _) = jet(0.01);
        let of = |place: [f64; 2]| (0..3).map(|k| jet.at(place).covariance[k][k]).sum::<f64>() / 3.0;
        assert!((of([0.0; 2]) / jet.variance_of_second() - 1.0).abs() < 1e-12);
        assert!(of([0.5, 0.0]) > 1.2 * of([0.0; 2]));
        assert!(jet.left_out([0.5, 0.0]) > 1.2 * jet.left_out([0.0; 2]));
    }
}
