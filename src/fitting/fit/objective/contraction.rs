//! How slowly Gauss-Newton can come to rest on normal rows: a bound that is proven, not one that is watched.
//!
//! ```text
//! step   E'E s = E'r        second derivative   H = E'E - D,   D = sum over sites of G'(J'J + n . d2n^) G
//! c* - c = (I - M)^-1 s,    M = (E'E)^-1 D      symmetric under E'E, so    |E (c* - c)| <= |E s| / (1 - rho)
//! rho E'E - D = sum of G'U'(rho I - K)U G       positive definite: no eigenvalue of M is above rho
//! K = U'^-1 (J'J + n . d2n^) U^-1               2 x 2, zero where the measured normal is the fitted one
//! ```
//!
//! G gives a site's slopes, `J'J = U'U` as in the rows. Where no K has an eigenvalue above rho, nothing more needs a proof. Else
//! a Cholesky factor is one, of the matrix less what rounding can add to it. What the steps have shown is no bound: a
//! direction that shrinks slowly may have hardly been taken.

use crate::fit::linear::equations::data_normal_matrix;
use crate::fit::objective::fitted::Iteration;
use crate::fit::objective::gauss_newton::{Minimum, NormalProblem};
use crate::observation::{linearise_normals, normal_curving};
use palpate_numeric::linalg::{RowWeights, SiteWeights, Sites, StencilMatrix};
use palpate_numeric::solve::Cholesky;

/// `rho = 1 - 2^-k` is tried for k from 1 to this: each trial is a normal matrix and its factor. Errors that may be four
/// thousand times as large as the step leave no digit worth a promise in problems that need it.
const TRIALS: i32 = 12;
/// Roundings of a diagonal entry, per unknown, that a factor may have taken for positive.
const ROUNDINGS: f64 = 8.0;

/// The last step over the largest coefficient, times the square of what it may be enlarged by, below which D is the same all the
/// way to the minimum: with h such a product times the change of M with the coefficients, the bound is off by a share h/2
/// (Kantorovich's theorem on Newton's method). Steps that come to rest are a billionth of this.
const NEAR: f64 = 1e-4;

/// U and K of one site.
struct Curving {
    index: usize,
    weights: SiteWeights,
    /// Eigenvalues of K, the larger one first.
    values: [f64; 2],
    /// Unit eigenvector of the first.
    vector: [f64; 2],
}

impl NormalProblem<'_> {
    /// What the repetition makes of errors of one linearised problem, its rounding or a step not taken. Coefficients without
    /// data are held still.
    pub(super) fn iteration(&self, minimum: &Minimum) -> Iteration {
        let (mut most, mut least) = (0.0_f64, 0.0_f64);
        self.each_curving(&minimum.solution.coefficients, |site| {
            (most, least) = (most.max(site.values[0]), least.min(site.values[1]));
        });
        let rho = if most <= 0.5 {
            Some(most)
        } else {
            let shares = (1..=TRIALS).map(|k| 1.0 - 0.5_f64.powi(k));
            shares.into_iter().find(|&rho| rho >= most || self.is_above(minimum, rho))
        };
        let enlarged = rho.map_or(f64::INFINITY, |rho| 1.0 / (1.0 - rho));
        let is_near = minimum.moved * enlarged * enlarged <= NEAR;
        let enlarged = if is_near { enlarged } else { f64::INFINITY };
        let turned = (enlarged - 1.0).max(least / (least - 1.0));
        Iteration { enlarged, turned, left: enlarged * minimum.last_step() }
    }

    /// Calls `visit` for all normals that count, with the curving of their rows at these coefficients.
    fn each_curving(&self, c: &[f64], mut visit: impl FnMut(Curving)) {
        self.each_site(c, |index, [_, p, q]| {
            let w = self.measured.normal_weight[index] / self.sds.slope;
            if w != 0.0 {
                let normal = self.measured.normals[index];
                let (u, _) = linearise_normals(normal, p, q);
                let (values, vector) = eigen(normal_curving(normal, p, q, &u));
                let weights = SiteWeights { z: 0.0, a: w * u.a, b: w * u.b, d: w * u.d };
                visit(Curving { index, weights, values, vector });
            }
        });
    }

    /// Whether `rho E'E - D` has a Cholesky factor with room for rounding.
    fn is_above(&self, minimum: &Minimum, rho: f64) -> bool {
        let Minimum { equations, solution, .. } = minimum;
        let root = rho.sqrt();
        let mut above: Vec<SiteWeights> = (0..self.sites.len())
            .map(|r| SiteWeights { z: root * equations.row_weights.at(r).z, ..SiteWeights::default() })
            .collect();
        let mut below = vec![SiteWeights::default(); above.len()];
        self.each_curving(&solution.coefficients, |site| {
            let z = above[site.index].z;
            above[site.index] = SiteWeights { z, ..site.part(site.values.map(|k| (rho - k).max(0.0))) };
            below[site.index] = site.part(site.values.map(|k| (k - rho).max(0.0)));
        });
        let mut matrix = data_normal_matrix(self.sites, &RowWeights::PerSite(above));
        if let Some(rough) = &self.roughness {
            matrix.add_scaled(rho * rough.lambda, &rough.penalty);
        }
        let rounding = ROUNDINGS * f64::EPSILON * matrix.order() as f64;
        let sizes = matrix.diagonal();
        let of_below = data_normal_matrix(self.sites, &RowWeights::PerSite(below));
        let shifts: Vec<f64> = sizes.iter().zip(of_below.diagonal()).map(|(a, b)| rounding * (a + b)).collect();
        matrix.add_scaled(-1.0, &of_below);
        hold(&mut matrix, &shifts, |u| solution.is_free(u));
        Cholesky::plan(matrix.shape()).is_ok_and(|mut cholesky| cholesky.factor(&matrix).is_ok())
    }
}

/// Takes the shifts from the diagonal; rows and columns of held unknowns become those of the identity.
fn hold(matrix: &mut StencilMatrix, shifts: &[f64], is_held: impl Fn(usize) -> bool) {
    let mut changes = Vec::new();
    matrix.for_each_lower(|row, column, position| {
        if is_held(row) || is_held(column) {
            changes.push((position, if row == column { 1.0 } else { 0.0 }));
        } else if row == column {
            changes.push((position, matrix.values()[position] - shifts[row]));
        }
    });
    changes.into_iter().for_each(|(position, value)| matrix.values_mut()[position] = value);
}

/// Eigenvalues of `[a b; b d]`, the larger first, and its unit eigenvector.
fn eigen([a, b, d]: [f64; 3]) -> ([f64; 2], [f64; 2]) {
    let (middle, half) = (0.5 * (a + d), 0.5 * (a - d));
    let apart = half.hypot(b);
    // of the two ways to write the vector, the one without cancellation
    let (x, y) = if half >= 0.0 { (half + apart, b) } else { (b, apart - half) };
    let length = x.hypot(y);
    let vector = if length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] };
    ([middle + apart, middle - apart], vector)
}

impl Curving {
    /// Rows whose squares are `U'(k1 e e' + k2 f f')U`, e and f the eigenvectors of K, both k at least zero.
    fn part(&self, [k1, k2]: [f64; 2]) -> SiteWeights {
        let [x, y] = self.vector;
        // the triangle V with V'V that matrix; k1 k2 is its determinant
        let first = (k1 * x * x + k2 * y * y).sqrt();
        let (second, last) =
            if first > 0.0 { ((k1 - k2) * x * y / first, (k1 * k2).sqrt() / first) } else { (0.0, k1.max(k2).sqrt()) };
        let SiteWeights { a, b, d, .. } = self.weights;
        SiteWeights { z: 0.0, a: first * a, b: first * b + second * d, d: last * d }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;
    use crate::fit::noise::sds::RowSds;
    use crate::fit::objective::budget::Budget;
    use crate::fit::{Fit, FitOptions, Method, NormalSigma, Objective, fit_contacts};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::Lcg;

    const SIGMA: f64 = 0.05;

    /// A bowl whose normals are off by this many degrees.
    fn bowl(off_deg: f64) -> Fit {
        let lcg = &mut Lcg::new(3);
        let (mut columns, mut normals) = ([vec![], vec![], vec![]], [vec![], vec![], vec![]]);
        for _ in 0..40 {
            let [x, y] = [0, 1].map(|_| 2.0 * lcg.uniform() - 1.0);
            let z = x * x + 0.4 * y * y;
            [x, y, z].into_iter().zip(&mut columns).for_each(|(v, column)| column.push(v));
            let turn = off_deg.to_radians();
            let n = [-2.0 * x + turn * lcg.normal(), -0.8 * y + turn * lcg.normal(), 1.0];
            let length = n.iter().map(|v| v * v).sum::<f64>().sqrt();
            n.into_iter().zip(&mut normals).for_each(|(v, column)| column.push(v / length));
        }
        let objective = Objective::Normals(NormalSigma::Known { z: 1.0, normal_deg: SIGMA.to_degrees() });
        let options =
            FitOptions { degree: [3, 2], objective, domain: Some([-1.0, 1.0, -1.0, 1.0]), ..FitOptions::default() };
        let ([x, y, z], [nx, ny, nz]) = (columns, normals);
        fit_contacts(&Contacts::from_positions(x, y, z).with_normals(nx, ny, nz), &options).unwrap()
    }

    /// Steps from places beside the minimum, in the norm of the rows: what the worst direction leaves after many steps is
    /// below the bound, and not by more than trials are apart.
    #[test]
    fn no_direction_shrinks_more_slowly_than_the_bound_says() {
        for (off_deg, is_tried) in [(0.0, false), (5.0, false), (25.0, true), (45.0, true)] {
            let fit = bowl(off_deg);
            let solved = &fit.solved;
            let spare = RefCell::new(None);
            let (sites, measured) = (solved.data.sites(&solved.patch), solved.data.measured());
            let sds = RowSds { z: 1.0 / solved.patch.frame.scale, slope: SIGMA };
            let problem = NormalProblem {
                sites: &sites,
                measured: &measured,
                sds,
                roughness: None,
                method: Method::Auto,
                budget: &Budget::new(usize::MAX),
                spare: &spare,
            };
            let least = solved.fitted.solution.coefficients.clone();
            let rows = |v: &[f64]| solved.fitted.equations.row_squares(v).iter().sum::<f64>().sqrt();
            let iteration = solved.fitted.iteration;
            let rho = 1.0 - 1.0 / iteration.enlarged;
            let lcg = &mut Lcg::new(9);
            let mut away: Vec<f64> = least.iter().map(|_| lcg.normal()).collect();
            let mut left = 0.0;
            for _ in 0..60 {
                let size = 1e-5 / rows(&away);
                let from: Vec<f64> = least.iter().zip(&away).map(|(c, d)| c + size * d).collect();
                let solution = crate::fit::linear::solve(&problem.linearised(&from), Method::Auto).unwrap();
                away = solution.coefficients.iter().zip(&least).map(|(a, b)| a - b).collect();
                left = rows(&away) / 1e-5;
                assert!(left <= rho.max(iteration.turned) + 1e-3, "{off_deg}: {left} for {rho}");
            }
            assert_eq!(is_tried, iteration.enlarged >= 2.0, "{off_deg}: {iteration:?}");
            assert!(!is_tried || rho == 0.5 || 1.0 - left <= 2.0 * (1.0 - rho), "{off_deg}: {left} for {rho}");
        }
    }

    /// The two matrices of squares differ by `rho U'U - U'KU`.
    #[test]
    fn parts_add_up_to_the_whole() {
        let (normal, p, q, rho) = ([0.48, -0.6, 0.64], 0.9, -2.0, 2.0);
        let (u, _) = linearise_normals(normal, p, q);
        let k = normal_curving(normal, p, q, &u);
        let (values, vector) = eigen(k);
        let site = Curving { index: 0, weights: u, values, vector };
        let square = |w: SiteWeights| [w.a * w.a, w.a * w.b, w.b * w.b + w.d * w.d];
        let above = square(site.part(values.map(|k| (rho - k).max(0.0))));
        let below = square(site.part(values.map(|k| (k - rho).max(0.0))));
        assert!(values[0] > rho && values[1] < rho, "both parts are there: {values:?}");
        // U'(rho I - K)U, entry by entry
        let (a, b, d) = (u.a, u.b, u.d);
        let [k11, k12, k22] = [rho - k[0], -k[1], rho - k[2]];
        let whole = [a * a * k11, a * (b * k11 + d * k12), b * b * k11 + 2.0 * b * d * k12 + d * d * k22];
        for ((above, below), whole) in above.iter().zip(below).zip(whole) {
            assert!((above - below - whole).abs() < 1e-14, "{above} {below} {whole}");
        }
    }
}
