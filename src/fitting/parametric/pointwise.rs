//! Uncertainty of position, normal, S and R of a parametric surface point by point: `A`, the Gauss-Newton matrix at the noise
//! sds, tells the covariance of the coefficients.
//!
//! ```text
//! u^2 = g' A^-1 g
//! ```

use super::fit_data::FitData;
use palpate_geometry::shape::{ByJet, PointSds, Uncertain, point_sds};
use palpate_geometry::surface::{Jet, Surface};
use palpate_numeric::bspline::linspace;

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
    let [u, v] = fit.surface.domain().map(|[lo, hi]| linspace(lo, hi, points));
    let places = u.iter().flat_map(|u| v.iter().map(move |v| [*u, *v]));
    Some(places.map(|at| point_sds(fit, at).map(|sds| sds.scaled(fit.frame.scale))).collect())
}

impl Uncertain for FitData {
    fn jet(&self, at: [f64; 2]) -> Jet {
        self.surface.jet(at)
    }

    fn functional_sd(&self, [u, v]: [f64; 2], by: &ByJet) -> Option<f64> {
        let mut gradient = vec![0.0; 3 * self.cells.shape().coefficients()];
        let (mut alive, mut products) = (Vec::new(), vec![0.0; self.cells.local()]);
        let row = self.cells.row(u, v, 2);
        self.cells.alive(&row, &mut alive);
        for (order, by) in ORDERS.into_iter().zip(by).filter(|(_, by)| **by != [0.0; 3]) {
            row.products(order, &mut products);
            for (coefficient, product) in alive.iter().zip(&products) {
                (0..3).for_each(|d| gradient[3 * coefficient + d] += by[d] * product);
            }
        }
        Some(self.standard_uncertainty(&gradient))
    }
}

impl FitData {
    /// Of `g'c` with this gradient by the coefficients, patch units.
    pub(super) fn standard_uncertainty(&self, gradient: &[f64]) -> f64 {
        let mut solved = gradient.to_vec();
        self.solver.factor.solve(&mut solved);
        gradient.iter().zip(&solved).map(|(a, b)| a * b).sum::<f64>().max(0.0).sqrt()
    }
}
