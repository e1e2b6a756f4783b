//! Decimal digits that an answer has at least, without knowing the truth.
//!
//! ```text
//! |dc_u|    <= bound of the functional c_u                                                       bounds.rs
//! |dS| <= |g'dc| of S's gradient + rounding of the derivatives that S is made of    R likewise, relative
//! ```
//!
//! Guaranteed digits are `-log10` of the worst bound.

use crate::fit::certificate::backward::Backward;
use crate::fit::certificate::bounds::{Bound, PLACING, maximum};
use crate::fit::solved::Solved;
use palpate_geometry::shape::{EightPoints, GridGradients, ShapeMaps};
use palpate_numeric::bspline::{BasisRow, MAX_DEGREE};
use palpate_numeric::simd::{CellGradients, Isa, OfKinds, POINTS, PointLanes, PointShapes, functional_bounds};

/// Unit roundoff 2^-53.
const UNIT: f64 = PLACING;
/// Orders in x and in y of S_x, S_y, S_xx, S_xy, S_yy.
const ORDERS: [[usize; 2]; 5] = [[1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];

/// Decimal digits of the coefficients, of S and of R, from the condition and the backward error.
pub(crate) fn guaranteed_digits(
    solved: &Solved,
    maps: &ShapeMaps,
    gradients: &GridGradients,
    backward: &Backward,
) -> [f64; 3] {
    let c = &solved.fitted.solution.coefficients;
    let Some(bound) = Bound::new(solved, backward) else { return [0.0; 3] };
    let (origin, scale) = (solved.origin_height(), solved.patch.frame.scale);
    // of those that data hold, which the bound is of: others may be far larger and wrong, and would make the share small
    let held = c.iter().zip(&bound.inverse).filter(|(_, d)| **d > 0.0);
    let largest = held.fold(0.0_f64, |m, (v, _)| m.max((origin / scale + v).abs()));
    let coefficients = bound.of_coefficients();
    let [shape_index, curvedness] = at_points(solved, maps, gradients, &bound);
    [if largest > 0.0 { coefficients / largest } else { 0.0 }, shape_index, curvedness].map(digits)
}

/// `-log10` of a bound and one last rounding, between 0 and 15.95. NaN guarantees none.
fn digits(bound: f64) -> f64 {
    if bound.is_nan() { 0.0 } else { (-(bound + UNIT).log10()).max(0.0) }
}

/// The worst bounds on `|dS|` and `|dR| / R` over the supported points of the shape grid, up to eight of a row at once.
fn at_points(solved: &Solved, maps: &ShapeMaps, gradients: &GridGradients, bound: &Bound) -> [f64; 2] {
    let terms = bound.terms();
    let isa = Isa::for_work(maps.grid.len());
    let (columns, width) = (solved.surface.coefficients().ncols(), solved.options.degree[0] + 1);
    let mut worst = [0.0; 2];
    gradients.visit(&solved.surface, &maps.rows, |eight| {
        let runs: [usize; MAX_DEGREE + 1] = std::array::from_fn(|a| (eight.first[0] + a) * columns + eight.first[1]);
        let gradients = CellGradients { runs: &runs[..width], entries: eight.entries };
        let PointShapes { roundings, sizes, .. } = eight.shapes;
        let mut found = functional_bounds(isa, &terms, &gradients, roundings, sizes);
        if may_be_umbilic(eight, bound.moved) {
            add_kinks(eight, gradients.runs, &maps.rows, bound, &mut found[0]);
        }
        if exceeds(&found, worst) {
            let [i, start] = eight.at;
            worst = raised(worst, &found, eight.count, |l| maps.shape_index_at(i, start + l).is_some());
        }
    });
    worst
}

/// Whether a bound is above the worst so far. Few rows of the grid have one, and only for those is it looked up where S is
/// defined and supported.
fn exceeds(found: &OfKinds, worst: [f64; 2]) -> bool {
    let mut any = false;
    for (found, worst) in found.iter().zip(worst) {
        for bound in found {
            let is_below = *bound <= worst;
            any |= !is_below;
        }
    }
    any
}

/// The worst bounds after those of the first `count` points that count; NaN is the worst of all.
fn raised(mut worst: [f64; 2], found: &OfKinds, count: usize, counts: impl Fn(usize) -> bool) -> [f64; 2] {
    for l in (0..count).filter(|l| counts(*l)) {
        (0..2).for_each(|k| worst[k] = maximum(worst[k], found[k][l]));
    }
    worst
}

/// Whether the gap `k1 - k2` of any of the eight points is no larger than rounding and errors of at most
/// `moved |D_k(N M)|_2` can make it.
fn may_be_umbilic(eight: &EightPoints, moved: f64) -> bool {
    let PointShapes { difference, bend, opening, .. } = eight.shapes;
    let [of_second, of_first] = eight.spans.map(|span| moved * span);
    let mut any = false;
    for l in 0..POINTS {
        let is_apart = difference[l] > opening[l] + (of_second + bend[l] * of_first);
        any |= !is_apart;
    }
    any
}

/// At an umbilic S has a kink, which its gradient does not show: a gap smaller than its own error may be as large as that
/// error.
#[cold]
fn add_kinks(
    eight: &EightPoints,
    runs: &[usize],
    [along_x, along_y]: &[Vec<BasisRow>; 2],
    bound: &Bound,
    of_s: &mut PointLanes,
) {
    let PointShapes { difference, bend, opening, sizes, .. } = eight.shapes;
    let [i, start] = eight.at;
    for l in 0..eight.count {
        let off = |k: usize| bound.moved * spread(bound, runs, [&along_x[i], &along_y[start + l]], ORDERS[k]);
        let moved = 2.0 * (off(2) + 2.0 * off(3) + off(4)) + 4.0 * bend[l] * (off(0) + off(1));
        let gap = opening[l] + moved;
        let is_apart = difference[l] > gap;
        if !is_apart {
            of_s[l] += std::f64::consts::FRAC_2_PI * gap / (2.0 * sizes[1][l]);
        }
    }
}

/// `|D g|_2` of the derivative of these orders in x and y at one point.
fn spread(bound: &Bound, runs: &[usize], [bx, by]: [&BasisRow; 2], [i, j]: [usize; 2]) -> f64 {
    let mut spread = 0.0;
    for (n, &start) in bx.derivative(i).iter().zip(runs) {
        for (m, d) in by.derivative(j).iter().zip(&bound.inverse[start..]) {
            spread += (n * m * d).powi(2);
        }
    }
    spread.sqrt()
}
