//! Digits that an answer is promised to have, before anyone knows the truth.
//!
//! ```text
//! |dc_u|    <= bound of the functional c_u                                                       bounds.rs
//! |dS| <= |g'dc| of S's gradient + rounding of the derivatives that S is made of    R likewise, relative
//! ```
//!
//! Promised digits are `-log10` of the worst bound.

use super::Fit;
use super::backward::Backward;
use super::bounds::{Bound, Functionals, PLACING};
use crate::bspline::BasisRow;
use crate::shape::{ShapeGradient, ShapeGrid, by_coefficients, shape_gradient};
use crate::surface::HeightField;

/// Unit roundoff 2^-53.
const UNIT: f64 = PLACING;
/// Derivatives are sums over the tensor basis; each term is rounded about this often.
const TERM: f64 = 8.0 * UNIT;
/// Orders of the five derivatives in x and in y.
const ORDERS: [(usize, usize); 5] = [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];

/// Decimal digits promised for a fit, as an exact solution of the written problem would have them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Promise {
    /// Of the coefficients in the input's frame, relative to the largest.
    pub coefficients: f64,
    /// Of S at the worst supported grid point, absolute.
    pub shape_index: f64,
    /// Of R at the worst supported grid point, relative.
    pub curvedness: f64,
}

/// Digits from the condition and the backward error.
pub fn promise(fit: &Fit, condition: f64, backward: &Backward) -> Promise {
    let c = &fit.fitted.solution.coefficients;
    let Some(bound) = Bound::new(fit, condition, backward) else { return Promise::default() };
    let frame = fit.frame();
    let origin = if frame.keeps_axes() { frame.origin[2] } else { frame.turn(frame.origin)[2] };
    let largest = c.iter().fold(0.0_f64, |m, v| m.max((origin / frame.scale + v).abs()));
    let mut worst = Functionals::new(&bound);
    let [of_coefficient, of_shape_index, of_curvedness] = [0, 1, 2];
    (0..c.len()).for_each(|u| worst.add(of_coefficient, &[(u, 1.0)], 0.0, 1.0));
    at_points(fit, &bound, &mut worst, [of_shape_index, of_curvedness]);
    let [coefficients, shape_index, curvedness] = worst.finish();
    Promise {
        coefficients: digits(if largest > 0.0 { coefficients / largest } else { 0.0 }),
        shape_index: digits(shape_index),
        curvedness: digits(curvedness),
    }
}

/// `-log10` of a bound and one last rounding, between 0 and 15.95. NaN promises nothing.
fn digits(bound: f64) -> f64 {
    if bound.is_nan() { 0.0 } else { (-(bound + UNIT).log10()).max(0.0) }
}

/// Bounds on `|dS|` and `|dR| / R` at every supported point of the shape grid.
fn at_points<'a>(fit: &Fit, bound: &'a Bound, worst: &mut Functionals<'a>, of: [usize; 2]) {
    let surface = fit.surface();
    let domain = [surface.knots()[0].domain(), surface.knots()[1].domain()];
    let grid = ShapeGrid::over(domain, fit.options().grid, fit.options().inset);
    let [along_x, along_y] =
        grid.rows(surface.knots()).map(|rows| rows.into_iter().map(Along::new).collect::<Vec<_>>());
    let maps = &fit.shape().maps;
    let mut space = Vec::new();
    for (i, bx) in along_x.iter().enumerate() {
        for (j, by) in along_y.iter().enumerate() {
            if maps.shape_index_at(i, j).is_some() {
                at_point(surface, [bx, by], bound, worst, of, &mut space);
            }
        }
    }
}

/// The basis functions at one coordinate of the grid, and the 2-norms of their values and derivatives.
struct Along {
    row: BasisRow,
    lengths: [f64; 3],
}

impl Along {
    fn new(row: BasisRow) -> Along {
        let length = |k: usize| row.derivative(k).iter().map(|v| v * v).sum::<f64>().sqrt();
        Along { lengths: [0, 1, 2].map(length), row }
    }
}

/// Bounds at one point; `space` for a gradient by the coefficients alive there.
fn at_point<'a>(
    surface: &HeightField,
    along: [&Along; 2],
    bound: &'a Bound,
    worst: &mut Functionals<'a>,
    of: [usize; 2],
    space: &mut Vec<(usize, f64)>,
) {
    let [bx, by] = along.map(|axis| &axis.row);
    let columns = surface.coefficients().ncols();
    let gradient = shape_gradient(&surface.with_rows(bx, by));
    let curvedness = gradient.size();
    if !curvedness.is_finite() || (gradient.shape_index == [0.0; 5] && curvedness > 0.0) {
        // curvatures whose squares overflow or vanish: the gradient is not there to be relied on
        return of.into_iter().for_each(|k| worst.unknown(k));
    }
    let terms = term_sizes(surface, bx, by);
    let kinks = [kink(&gradient, surface, along, bound, &terms), 0.0];
    let sizes = [1.0, curvedness];
    for (k, by_point) in [&gradient.shape_index, &gradient.curvedness].into_iter().enumerate() {
        space.clear();
        by_coefficients(by_point, bx, by, |a, b, g| space.push(((bx.first + a) * columns + by.first + b, g)));
        let rounding: f64 = (0..5).map(|k| by_point[k].abs() * TERM * terms[k]).sum();
        worst.add(of[k], space, rounding + kinks[k] + TERM * sizes[k], sizes[k]);
    }
}

/// `sum |c_ij| |N_i^(k)| |M_j^(l)|` for the five derivatives: what their rounding is relative to.
fn term_sizes(surface: &HeightField, bx: &BasisRow, by: &BasisRow) -> [f64; 5] {
    let mut sizes = [0.0; 5];
    for a in 0..bx.derivative(0).len() {
        let mut along = [0.0; 3];
        for b in 0..by.derivative(0).len() {
            let c = surface.coefficients()[[bx.first + a, by.first + b]].abs();
            (0..3).for_each(|l| along[l] += c * by.derivative(l)[b].abs());
        }
        let [n, dn, ddn] = [0, 1, 2].map(|k| bx.derivative(k)[a].abs());
        let terms = [dn * along[0], n * along[1], ddn * along[0], dn * along[1], n * along[2]];
        (0..5).for_each(|k| sizes[k] += terms[k]);
    }
    sizes
}

/// At an umbilic S has a kink that its gradient does not see: a gap within its own error opens by as much.
fn kink(gradient: &ShapeGradient, surface: &HeightField, along: [&Along; 2], bound: &Bound, terms: &[f64; 5]) -> f64 {
    let bend = 0.5 * (gradient.sum.abs() + gradient.difference);
    let opens = |off: [f64; 5]| 2.0 * (off[2] + 2.0 * off[3] + off[4]) + 4.0 * bend * (off[0] + off[1]);
    // most points are far from umbilic: the derivatives' errors are bounded by norms before they are worked out
    let at_most = opens(std::array::from_fn(|k| {
        let (i, j) = ORDERS[k];
        bound.moved * along[0].lengths[i] * along[1].lengths[j] + TERM * terms[k]
    }));
    if gradient.difference > at_most {
        return 0.0;
    }
    let ([bx, by], columns) = (along.map(|axis| &axis.row), surface.coefficients().ncols());
    let gap = opens(std::array::from_fn(|k| {
        let (i, j) = ORDERS[k];
        let mut spread = 0.0;
        for (a, n) in bx.derivative(i).iter().enumerate() {
            for (b, m) in by.derivative(j).iter().enumerate() {
                spread += (n * m * bound.inverse[(bx.first + a) * columns + by.first + b]).powi(2);
            }
        }
        bound.moved * spread.sqrt() + TERM * terms[k]
    }));
    if gradient.difference > gap { 0.0 } else { std::f64::consts::FRAC_2_PI * gap / (2.0 * gradient.size()) }
}
