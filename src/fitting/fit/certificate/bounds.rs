//! How far linear functionals of the coefficients can be off.
//!
//! ```text
//! |D^-1 dc| <= 10 w (kappa + kappa^2 |r| / (|E D| |D^-1 c|)) |D^-1 c|       w backward error, D the columns' inverse norms
//! |g'dc|    <= |D g| |D^-1 dc|
//! |g'dc|    <= v (sqrt(g'A^-1 g) | |E||c| + |r| + |b| |_2 + |A^-1 g|' |E|'|r|)     A = E'E, where A^-1 is at hand;
//!                                                                                     v = w / (1 - 10 w kappa)
//! ```
//!
//! Normal rows are solved by repetition, which makes `x = (I - M)^-1 dc` of what one linear problem is off by. With
//! `|E x| <= e |E dc|` and `|E (x - dc)| <= f |E dc|` from `objective/contraction.rs` the first bound is e times as
//! large, and the third has, in place of that norm,
//!
//! ```text
//! e | |E||c| + |r| + |b| |_2 + f (t'|A^-1|t)^(1/2) + l / v       t = |E|'|r|,  l the steps not taken, |g'x| <= sqrt(g'A^-1 g) |E x|
//! ```
//!
//! Under a roughness penalty `A = E'E + lambda P`, and t has `lambda |P||c|`. P is rounded itself, `|dP| <= k u |P|`, k the roundings of
//! an entry: with `h = k u + w` the first line has the smaller of `10 h kappa^2 |D^-1 c|` and `10 h n^(1/2) | |D^-1 A^-1| lambda |P||c| |`
//! beside it, and in the third one t has `k u lambda |P||c| / v`, too. With gaps the first has `10 kappa |E_F dc_F|` (`linear/minimum_roughness.rs`). The factor 10 allows
//! for the condition estimator's underestimate. The third line is the same perturbation of the augmented system,
//! `dc = E^+ (db - dE c) + A^-1 dE'r`, in the direction g instead of the worst direction. On small problems it guarantees about
//! two digits more; the factor v allows for the second order. The smaller bound is used.

use crate::fit::certificate::backward::Backward;
use crate::fit::linear::solution::BEYOND_CHOLESKY;
use crate::fit::objective::fitted::Iteration;
use crate::fit::options::method::MethodUsed;
use crate::fit::solved::Solved;
use crate::observation::roundings;
use palpate_numeric::linalg::inverse_norm1_estimate;
use palpate_numeric::simd::{BoundTerms, DirectedTerms};

/// Hager's and Higham's estimate is a lower bound, nearly always within a factor 3; two of them are multiplied.
const ESTIMATOR: f64 = 10.0;
/// Unit roundoff 2^-53. Placing data and knots in the patch frame rounds each of them: no backward error is below this.
pub(super) const PLACING: f64 = 0.5 * f64::EPSILON;
/// Unknowns up to which A^-1 is written out, at n^3 multiplications; the fit itself takes g n^2.
const INVERTED: usize = 100;
/// Condition up to which A^-1 has enough digits for a bound, by Cholesky of the normal matrix and by R of the rows.
const INVERTIBLE: [f64; 2] = [1e6, 1e12];

/// What bounds a linear functional of the coefficients.
pub(super) struct Bound {
    /// D over its largest entry; zero for unsupported coefficients.
    pub inverse: Vec<f64>,
    /// The bound on `|D^-1 dc|` times D's largest entry, or another with which `moved |D g|` bounds every functional g.
    pub moved: f64,
    /// Whether the bound by `moved` can be the smaller one.
    is_plain: bool,
    directed: Option<Directed>,
}

/// What the bound in one direction g needs.
struct Directed {
    /// A^-1, row by row, and `|E|'|r|` after it.
    inverse: Vec<f64>,
    order: usize,
    /// The norm in the bound, with what an iteration adds to it.
    rows: f64,
    backward: f64,
    remaining: f64,
}

impl Bound {
    /// `None` when no coefficient is held by data, or nothing is known of the condition.
    pub(super) fn new(solved: &Solved, backward: &Backward) -> Option<Bound> {
        let (solution, condition) = (&solved.fitted.solution, solved.condition());
        let c = &solution.coefficients;
        let inverse = |norm: f64| if norm > 0.0 { 1.0 / norm.sqrt() } else { 0.0 };
        let mut inverse: Vec<f64> = backward.columns.iter().map(|column| inverse(column.norm)).collect();
        solution.unsupported.iter().for_each(|&u| inverse[u] = 0.0);
        let largest = inverse.iter().fold(0.0_f64, |m, d| m.max(*d));
        // a factor made of rounding has no condition that could be estimated
        let is_rounding = solution.method == MethodUsed::Cholesky && condition > BEYOND_CHOLESKY;
        if largest == 0.0 || is_rounding {
            return None;
        }
        let scaled = c.iter().zip(&inverse).filter(|(_, d)| **d > 0.0).map(|(c, d)| c / d * largest);
        let size = scaled.fold(0.0_f64, |s, v| s + v * v).sqrt();
        let held = inverse.iter().filter(|d| **d > 0.0).count() as f64;
        let error = backward.error.max(PLACING);
        let residual = largest * backward.residual;
        let Iteration { enlarged, left, .. } = solved.fitted.iteration;
        if !enlarged.is_finite() || !left.is_finite() {
            return None;
        }
        // what the iteration for gaps has left
        let unsettled = solution.unsettled;
        let remaining = if unsettled > 0.0 { unsettled.max(PLACING) } else { 0.0 };
        // the rows of free coefficients are rounded too, and these may be far larger than the others
        let rows = if solution.unsupported.is_empty() { 0.0 } else { largest * backward.rows };
        let size = size.max(rows);
        let moved =
            ESTIMATOR * solution.enlarged * error * (condition * size + condition * condition * residual / held.sqrt());
        inverse.iter_mut().for_each(|d| *d /= largest);
        // P is rounded itself, and no residual shows it: unlike the rows' rounding it counts with the condition of P
        let whole = backward.rough_share * condition * condition * size;
        let rough =
            ESTIMATOR * (rounding_of_roughness(solved) + error) * whole.min(largest * by_entries(solved, backward));
        let moved = moved + remaining * size + rough + ESTIMATOR * condition * largest * solution.filled;
        let moved = enlarged * moved + ESTIMATOR * condition * largest * left;
        let directed = Directed::new(solved, backward, remaining);
        // no functional is off by more than this; a NaN compares as false, which keeps the plain bound
        let most = directed.as_ref().map_or(f64::INFINITY, |directed| directed.most(&inverse));
        let is_lower = most <= moved;
        let moved = if is_lower { most } else { moved };
        Some(Bound { inverse, moved, is_plain: !is_lower, directed })
    }
}

impl Directed {
    /// `None` where A^-1 is too expensive, too inaccurate, or not the inverse of E'E.
    fn new(solved: &Solved, backward: &Backward, remaining: f64) -> Option<Directed> {
        let (equations, solution) = (&solved.fitted.equations, &solved.fitted.solution);
        let condition = solved.condition();
        let order = equations.unknowns();
        let whole = solution.unsupported.is_empty() && solution.pinned.is_none();
        let invertible = INVERTIBLE[usize::from(solution.method != MethodUsed::Cholesky)];
        if order > INVERTED || !whole || solution.rank < order || condition > invertible {
            return None;
        }
        let mut inverse = vec![0.0; order * order + order];
        let (matrix, sizes) = inverse.split_at_mut(order * order);
        solution.factor.write_inverse(matrix);
        let largest = solution.coefficients.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let error = backward.error.max(PLACING);
        let second_order = 1.0 - ESTIMATOR * error * condition;
        let weight = error / second_order;
        sizes.iter_mut().zip(&backward.columns).for_each(|(size, column)| *size = column.size);
        let of_roughness = rounding_of_roughness(solved) / weight;
        sizes.iter_mut().zip(&backward.roughness).for_each(|(size, rough)| *size += of_roughness * rough);
        let Iteration { enlarged, turned, left } = solved.fitted.iteration;
        let beside = if turned > 0.0 { turned * length(matrix, sizes) } else { 0.0 };
        (second_order > 0.5).then_some(Directed {
            inverse,
            order,
            rows: enlarged * backward.rows + beside + left / weight,
            backward: weight,
            remaining: remaining * largest,
        })
    }

    /// `most |D g|` is no less than the bound of any g: `|A^-1 g| <= s |D g|` with the row sums s of `|A^-1| D^-1`, and
    /// `g'A^-1 g <= |D g|^2 max_u s_u / D_u`. NaN where D has zeros.
    fn most(&self, inverse: &[f64]) -> f64 {
        let (matrix, sizes) = self.parts();
        let norms: Vec<f64> = inverse.iter().map(|d| 1.0 / d).collect();
        let (mut largest, mut weighted, mut length) = (0.0_f64, 0.0, 0.0);
        for (u, row) in matrix.chunks_exact(self.order).enumerate() {
            let sum = row.iter().zip(&norms).fold(0.0, |sum, (a, norm)| sum + a.abs() * norm);
            largest = largest.max(sum * norms[u]);
            weighted += sum * sizes[u];
            length += norms[u] * norms[u];
        }
        self.backward * (largest.sqrt() * self.rows + weighted) + self.remaining * length.sqrt()
    }

    /// A^-1, and `|E|'|r|`.
    fn parts(&self) -> (&[f64], &[f64]) {
        self.inverse.split_at(self.order * self.order)
    }
}

impl Bound {
    /// The terms for the kernel that bounds many functionals at once.
    pub(super) fn terms(&self) -> BoundTerms<'_> {
        let directed = self.directed.as_ref().map(|d| {
            let (matrix, weights) = d.parts();
            DirectedTerms { matrix, weights, rows: d.rows, backward: d.backward, settled: d.remaining }
        });
        let moved = if self.is_plain { self.moved } else { f64::INFINITY };
        BoundTerms { scales: &self.inverse, moved, directed }
    }

    /// The worst bound of a coefficient, `g = e_u`.
    pub(super) fn of_coefficients(&self) -> f64 {
        let plain = self.inverse.iter().map(|d| self.moved * d);
        let Some(directed) = &self.directed else { return plain.fold(0.0, maximum) };
        let (matrix, sizes) = directed.parts();
        let along = matrix.chunks_exact(directed.order).enumerate().map(|(u, row)| {
            let weighted: f64 = row.iter().zip(sizes).map(|(a, t)| a.abs() * t).sum();
            directed.backward * (row[u].max(0.0).sqrt() * directed.rows + weighted) + directed.remaining
        });
        plain.zip(along).map(|(plain, along)| plain.min(along)).fold(0.0, maximum)
    }
}

/// What an entry of P is rounded by, as a share of it.
fn rounding_of_roughness(solved: &Solved) -> f64 {
    PLACING * roundings(solved.options.degree)
}

/// `n^(1/2) | |D^-1 A^-1| lambda |P||c| |`, the largest row: no less than what `|D^-1 dc|_2` is for changes of P by a share of its
/// entries, over that share. The norm is estimated as that of the condition is. 0 without roughness.
fn by_entries(solved: &Solved, backward: &Backward) -> f64 {
    let Backward { columns, roughness, .. } = backward;
    if roughness.is_empty() {
        return 0.0;
    }
    let solution = &solved.fitted.solution;
    let norms: Vec<f64> = columns.iter().map(|column| column.norm.sqrt()).collect();
    let through = |first: &[f64], last: &[f64], v: &mut [f64]| {
        v.iter_mut().zip(first).for_each(|(v, s)| *v *= s);
        solution.clear_free(v);
        solution.factor.solve(v);
        solution.clear_free(v);
        v.iter_mut().zip(last).for_each(|(v, s)| *v *= s);
    };
    let estimate =
        inverse_norm1_estimate(norms.len(), |v| through(&norms, roughness, v), |v| through(roughness, &norms, v));
    (norms.len() as f64).sqrt() * estimate
}

/// `(t'|A^-1|t)^(1/2)`: no less than `|E A^-1 w|` for any `|w| <= t`.
fn length(inverse: &[f64], t: &[f64]) -> f64 {
    let rows = inverse.chunks_exact(t.len().max(1)).zip(t);
    rows.map(|(row, t_u)| t_u * row.iter().zip(t).map(|(a, t)| a.abs() * t).sum::<f64>()).sum::<f64>().sqrt()
}

/// The larger one, or NaN if there is one.
pub(super) fn maximum(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::certificate::backward::backward;
    use crate::fit::{Fit, FitOptions, Objective, SlopeWeights, fit_contacts};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::Lcg;
    use palpate_numeric::linalg::Sites;

    fn dish(noise: f64, degree: usize) -> Fit {
        let lcg = &mut Lcg::new(7);
        let place = |k: usize, step: f64| (k as f64 * step).fract();
        let (x, y): (Vec<f64>, Vec<f64>) = (0..60).map(|k| (place(k, 0.754_877_666), place(k, 0.569_840_291))).unzip();
        let mut noisy = |value: f64| value + noise * lcg.normal();
        let z = x.iter().zip(&y).map(|(x, y)| noisy(x * x - 0.5 * x * y)).collect();
        let zx = x.iter().zip(&y).map(|(x, y)| noisy(2.0 * x - 0.5 * y)).collect();
        let zy = x.iter().map(|x| noisy(-0.5 * x)).collect();
        let objective = Objective::Slopes(SlopeWeights::Tangent);
        let options = FitOptions { degree: [degree; 2], objective, ..FitOptions::default() };
        fit_contacts(&Contacts::from_positions(x, y, z).with_slopes(zx, zy), &options).unwrap()
    }

    /// Where the plain bound is left out, no functional would have taken it.
    #[test]
    fn the_plain_bound_is_left_out_only_where_it_is_the_larger() {
        let mut left_out = 0;
        for (noise, degree) in [(0.0, 2), (1e-3, 2), (0.3, 2), (1e-3, 3), (0.3, 4)] {
            let fit = dish(noise, degree);
            let bound = Bound::new(&fit.solved, &backward(&fit.solved)).unwrap();
            let directed = bound.directed.as_ref().unwrap();
            let (matrix, sizes) = directed.parts();
            left_out += usize::from(!bound.is_plain);
            let lcg = &mut Lcg::new(11);
            for _ in 0..200 {
                let g: Vec<f64> = sizes.iter().map(|_| lcg.normal()).collect();
                let times = |row: &[f64]| row.iter().zip(&g).map(|(a, v)| a * v).sum::<f64>();
                let products: Vec<f64> = matrix.chunks_exact(g.len()).map(times).collect();
                let form = times(&products).max(0.0);
                let weighted: f64 = products.iter().zip(sizes).map(|(p, t)| p.abs() * t).sum();
                let length: f64 = g.iter().map(|v| v.abs()).sum();
                let own = directed.backward * (form.sqrt() * directed.rows + weighted) + directed.remaining * length;
                let size = g.iter().zip(&bound.inverse).map(|(v, d)| (v * d).powi(2)).sum::<f64>().sqrt();
                assert!(own <= directed.most(&bound.inverse) * size * (1.0 + 1e-12));
                assert!(bound.is_plain || own <= bound.moved * size * (1.0 + 1e-12), "{noise} {degree}");
            }
        }
        assert!(left_out > 0);
    }

    /// Norms of the columns from the factor's equilibration and from the rows.
    #[test]
    fn the_factor_has_the_norms_of_the_columns() {
        for degree in [2, 3, 5] {
            let fit = dish(0.01, degree);
            let (equations, solution) = (fit.equations(), fit.solution());
            let shape = equations.sites.shape();
            let mut squares = vec![0.0; shape.unknowns()];
            equations.sites.visit(|site| {
                let m = equations.row_weights.at(site.index);
                for (a, (n, dn)) in site.x.iter().zip(site.dx).enumerate() {
                    for (b, (v, dv)) in site.y.iter().zip(site.dy).enumerate() {
                        let rows = [m.z * n * v, m.a * dn * v + m.b * n * dv, m.d * n * dv];
                        squares[(site.first[0] + a) * shape.basis[1] + site.first[1] + b] +=
                            rows.iter().map(|row| row * row).sum::<f64>();
                    }
                }
            });
            let found = backward(&fit.solved).columns;
            assert!(solution.column_scales(equations).is_some());
            for (column, square) in found.iter().zip(squares) {
                assert!((column.norm / square - 1.0).abs() < 1e-13, "{} {square}", column.norm);
            }
        }
    }
}
