//! A smooth departure: a Gaussian process with a squared exponential kernel, held by the displacement's own splines.
//!
//! ```text
//! cov(f(p), f(q)) = g s^2 exp(-|p - q|^2/(2 l^2))            l: half sides of the chart's box, p and q in the chart
//! K_u = Q L Q'  over the Greville sites of u,   F_u = B_u^-1 Q L^(1/2)   B_u the basis at the sites;  v alike
//! c = (F_u o F_v) z,   z ~ N(0, 1)                           coefficients of the spline through such a process, o Kronecker
//! weights of the rough columns = what c is but for terms of second degree, which the surface's own parameters hold
//!
//! free      as above
//! drawn     F_u o 1 and 1 o F_v                              varies along one side alone
//! turned    angular order 0 and 1 about the middle           rotational_process.rs
//! ```
//!
//! A spline whose third derivatives cost expects every surface to bend as abruptly as its prior allows. What bodies show over
//! a patch is mostly smooth in all its derivatives, and a process that is so has fewer ways to bend: where it fits as well, the
//! evidence is ahead by 3 to 45 (bumps of 27 to 200 contacts), and the interval is half to a third as wide. Where a surface has
//! creases, the rough spline stays ahead.
//!
//! Many bodies are profiles: drawn along a line, as a panel or a corrugated sheet, or turned about an axis, as a dent, a bump or a
//! lens (about an axis that lies along the patch, as a bottle: drawn, too). A process that has this symmetry has fewer ways still,
//! and shows itself by some ten more of log evidence where it holds: of bumps of 27 contacts 75 instead of 35 of 100 have the right
//! class (`benches/runs/coverage.md`). C. E. Rasmussen, C. K. I. Williams, *Gaussian Processes for Machine Learning*, MIT Press
//! 2006, sections 4.2 and 5.4.

use faer::Mat;

use crate::dense;
use crate::recognition::kinds::ConstantCurvature;
use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg;

use super::resolution::DepartureResolution;
use super::rotational_process;

/// Lengths of the kernel, half sides of the chart's box; with 4 nothing changes.
const LENGTHS: [f64; 3] = [1.0, 2.0, 0.5];

/// Share of the largest variance below which a direction of the process is left out: at the sizes that are tried, rounding.
const ROUNDING: f64 = 1e-12;

/// How a process varies over the chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// In every direction.
    Free,
    /// Along one side alone: a profile that is drawn along the other, as an extruded bar's, or turned about an axis of that direction.
    Drawn(usize),
    /// With the distance from the middle alone, but for a shift of the middle.
    Turned,
}

/// Forms that are tried.
const FORMS: [Form; 4] = [Form::Free, Form::Drawn(0), Form::Drawn(1), Form::Turned];

/// All forms with all lengths; `None` where this resolution does not hold the length.
pub(crate) fn all(resolution: DepartureResolution) -> impl Iterator<Item = Option<(Form, f64)>> {
    let held = move |form| LENGTHS.map(|length| resolution.holds(length).then_some((form, length)));
    FORMS.into_iter().flat_map(held)
}

/// Whether the process of this number may vary in every direction.
pub(crate) fn is_free(process: usize) -> bool {
    process < LENGTHS.len()
}

/// Weights of the rough columns for independent standard gaussians: the process without its part of second degree. `None` where a
/// factor does not exist.
pub(crate) fn weights(
    surface: &ConstantCurvature,
    knots: &[Knots; 2],
    rough: &Mat<f64>,
    (form, length): (Form, f64),
) -> Option<Mat<f64>> {
    let sides = knots.each_ref().map(Knots::domain).map(|[lo, hi]| 0.5 * (hi - lo));
    let length = length * sides[0].max(sides[1]);
    let coefficients = match form {
        Form::Free => product([side(&knots[0], length)?, side(&knots[1], length)?]),
        Form::Drawn(0) => product([side(&knots[0], length)?, even(&knots[1])]),
        Form::Drawn(_) => product([even(&knots[0]), side(&knots[1], length)?]),
        Form::Turned => turned(surface, knots, length)?,
    };
    // rough columns are orthogonal to each other and to all terms of second degree
    let mut weights = linalg::product(rough.transpose(), coefficients.as_ref());
    for i in 0..rough.ncols() {
        let square: f64 = rough.col_as_slice(i).iter().map(|c| c * c).sum();
        (0..weights.ncols()).for_each(|j| weights[(i, j)] /= square);
    }
    Some(weights)
}

/// Coefficients of all products of one direction along u and one along v, but for those that vary least.
fn product([(of_u, u), (of_v, v)]: [(Vec<f64>, Mat<f64>); 2]) -> Mat<f64> {
    let largest = of_u.iter().copied().fold(0.0, f64::max) * of_v.iter().copied().fold(0.0, f64::max);
    let pairs = (0..of_u.len()).flat_map(|i| (0..of_v.len()).map(move |j| (i, j)));
    let kept: Vec<(usize, usize)> = pairs.filter(|&(i, j)| of_u[i] * of_v[j] > ROUNDING * largest).collect();
    let across = v.nrows();
    Mat::from_fn(u.nrows() * across, kept.len(), |row, k| {
        let (i, j) = kept[k];
        u[(row / across, i)] * v[(row % across, j)]
    })
}

/// The one direction of a process that does not vary along this side.
fn even(knots: &Knots) -> (Vec<f64>, Mat<f64>) {
    (vec![1.0], Mat::from_fn(knots.n_basis(), 1, |_, _| 1.0))
}

/// Coefficients of the splines that take the turned process' values at the Greville sites, one a column.
fn turned(surface: &ConstantCurvature, knots: &[Knots; 2], length: f64) -> Option<Mat<f64>> {
    splines_through(knots, &rotational_process::values(surface, knots, length))
}

/// Coefficients of the splines that take these values at the Greville sites of u (rows) and v (columns), one spline a column.
pub(super) fn splines_through(knots: &[Knots; 2], values: &[Mat<f64>]) -> Option<Mat<f64>> {
    let across = knots[1].n_basis();
    let (of_u, count) = (knots[0].n_basis(), values.len());
    // all terms side by side: one factor serves them all
    let beside = Mat::from_fn(of_u, count * across, |i, j| values[j / across][(i, j % across)]);
    let along_u = interpolated(&knots[0], &beside)?;
    let turned = Mat::from_fn(across, count * of_u, |j, i| along_u[(i % of_u, (i / of_u) * across + j)]);
    let splines = interpolated(&knots[1], &turned)?;
    Some(Mat::from_fn(of_u * across, count, |row, c| splines[(row % across, c * of_u + row / across)]))
}

/// Variances of the process along one side and the coefficients of their directions, each times its standard deviation.
fn side(knots: &Knots, length: f64) -> Option<(Vec<f64>, Mat<f64>)> {
    let sites = knots.greville();
    let n = sites.len();
    let kernel = Mat::from_fn(n, n, |i, j| (-0.5 * ((sites[i] - sites[j]) / length).powi(2)).exp());
    let eigen = linalg::eigen(kernel.as_ref())?;
    let values = Mat::from_fn(n, n, |i, j| eigen.vectors[(i, j)] * eigen.values[j].max(0.0).sqrt());
    Some((eigen.values, interpolated(knots, &values)?))
}

/// Coefficients of the splines that take these values at the Greville sites, one spline a column.
fn interpolated(knots: &Knots, values: &Mat<f64>) -> Option<Mat<f64>> {
    let sites = knots.greville();
    let n = sites.len();
    let mut basis = Mat::<f64>::zeros(n, n);
    for (i, site) in sites.iter().enumerate() {
        let mut row = vec![0.0; knots.degree() + 1];
        let first = knots.derivatives(*site, 0, &mut row);
        row.iter().enumerate().for_each(|(k, b)| basis[(i, first + k)] = *b);
    }
    let lower = dense::cholesky(&linalg::product(basis.transpose(), basis.as_ref()))?;
    let mut out = linalg::product(basis.transpose(), values.as_ref());
    (0..out.ncols()).for_each(|j| dense::solve(&lower, out.col_as_slice_mut(j)));
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splines_through_the_sites_have_the_covariance_of_the_kernel_between_them() {
        let knots = Knots::uniform(4, 5, -1.3, 0.9).unwrap();
        let length = 1.1;
        let (_, factor) = side(&knots, length).unwrap();
        let value = |t: f64, k: usize| {
            let mut row = [0.0; 5];
            let first = knots.derivatives(t, 0, &mut row);
            row.iter().enumerate().map(|(a, b)| b * factor[(first + a, k)]).sum::<f64>()
        };
        for (s, t) in [(-1.3, 0.9), (-0.4, -0.31), (0.0, 0.77), (0.5, 0.5)] {
            let found: f64 = (0..factor.ncols()).map(|k| value(s, k) * value(t, k)).sum();
            let expected = (-0.5 * ((s - t) / length).powi(2)).exp();
            assert!((found - expected).abs() < 2e-4, "{s}, {t}: {found} for {expected}");
        }
    }
}
