//! Uncertainty of position, normal, S and R of a parametric surface point by point, by the delta method.
//!
//! ```text
//! position   n . dQ
//! normal     t_k . dn = (dQ_u . (Q_v x t_k) + dQ_v . (t_k x Q_u)) / |Q_u x Q_v|,  t_1, t_2 tangents of length 1
//! u^2 = g' A^-1 g,   A the Gauss-Newton matrix at the noise sds
//! ```

use super::fit_data::FitData;
use super::gradient::shape_gradient;
use super::vector::Vector;
use palpate_geometry::shape::PointSds;
use palpate_numeric::bspline::linspace;
use palpate_numeric::vector::{cross, dot, norm, scaled, unit};

/// Unknowns times points beyond which no point is asked.
const MOST_WORK: usize = 2_000_000;

/// Derivatives that a functional may depend on: Q, Q_u, Q_v, Q_uu, Q_uv, Q_vv.
const ORDERS: [(usize, usize); 6] = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];

/// Standard uncertainties at `points` places each way of (u, v), the second direction running fastest, input units; `None`
/// at a place without a tangent plane. Nothing where there are too many unknowns to ask.
pub(super) fn pointwise(fit: &FitData, points: usize) -> Option<Vec<Option<PointSds>>> {
    let unknowns = 3 * fit.cells.shape().coefficients();
    if unknowns.saturating_mul(points * points) > MOST_WORK {
        return None;
    }
    let [u, v] = [0, 1].map(|k| {
        let [lo, hi] = fit.cells.knots()[k].domain();
        linspace(lo, hi, points)
    });
    let scale = fit.frame.scale;
    let places = u.iter().flat_map(|u| v.iter().map(move |v| (*u, *v)));
    Some(places.map(|(u, v)| at(fit, unknowns, u, v).map(|sds| sds.scaled(scale))).collect())
}

fn at(fit: &FitData, unknowns: usize, u: f64, v: f64) -> Option<PointSds> {
    let here = fit.surface.at(u, v).derivatives;
    let area = cross(here.u, here.v);
    let jacobian = norm(area);
    let n = unit(area);
    if !n.iter().all(|v| v.is_finite()) {
        return None;
    }
    let sd = |by: [Vector; 6]| standard_deviation(fit, unknowns, [u, v], &by);
    let first = unit(here.u);
    let tilts = [first, cross(n, first)].map(|t| {
        let by = |a, b| scaled(1.0 / jacobian, cross(a, b));
        sd([[0.0; 3], by(here.v, t), by(t, here.u), [0.0; 3], [0.0; 3], [0.0; 3]])
    });
    let shape = shape_gradient(&here).map(|both| {
        let by = |g: [f64; 15]| -> [Vector; 6] {
            std::array::from_fn(|k| if k == 0 { [0.0; 3] } else { std::array::from_fn(|d| g[3 * (k - 1) + d]) })
        };
        [sd(by(both.0)), sd(by(both.1))]
    });
    Some(PointSds {
        position: sd([n, [0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]]),
        normal: dot([tilts[0], tilts[1], 0.0], [tilts[0], tilts[1], 0.0]).sqrt(),
        shape_index: shape.map(|s| s[0]),
        curvedness: shape.map(|s| s[1]),
    })
}

/// Of a functional with these derivatives by Q and its derivatives at a place.
fn standard_deviation(fit: &FitData, unknowns: usize, [u, v]: [f64; 2], by: &[Vector; 6]) -> f64 {
    let mut gradient = vec![0.0; unknowns];
    let (mut alive, mut products) = (Vec::new(), vec![0.0; fit.cells.local()]);
    let row = fit.cells.row(u, v, 2);
    fit.cells.alive(&row, &mut alive);
    for (order, by) in ORDERS.into_iter().zip(by).filter(|(_, by)| **by != [0.0; 3]) {
        row.products(order, &mut products);
        for (coefficient, product) in alive.iter().zip(&products) {
            (0..3).for_each(|d| gradient[3 * coefficient + d] += by[d] * product);
        }
    }
    let mut solved = gradient.clone();
    fit.solver.factor.solve(&mut solved);
    gradient.iter().zip(&solved).map(|(a, b)| a * b).sum::<f64>().max(0.0).sqrt()
}
