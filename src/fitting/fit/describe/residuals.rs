//! Root mean square residuals of heights, slopes and normals, unweighted.

use crate::fit::solved::Solved;
use crate::observation::angular_residual_squared;
use palpate_numeric::linalg::visit_values;

/// Root mean square residuals of the rows whose weight is not zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rms {
    /// Heights, input units.
    pub z: Option<f64>,
    /// Slopes in x; `None` also where a normal has no slope.
    pub zx: Option<f64>,
    /// Slopes in y.
    pub zy: Option<f64>,
    /// Normals: rms angle, degrees.
    pub normal_deg: Option<f64>,
}

/// Residuals of the final surface.
pub(crate) fn rms(solved: &Solved) -> Rms {
    let sites = &solved.fitted.equations.sites;
    let readings = solved.fitted.moved.as_ref().map_or(&solved.data, |moved| &moved.data).readings();
    let (mut sums, mut counts) = ([0.0; 4], [0usize; 4]);
    visit_values(sites, &solved.fitted.solution.coefficients, |r, [s, p, q]| {
        let measured = readings.at(r);
        let mut add = |k: usize, square: f64| {
            sums[k] += square;
            counts[k] += 1;
        };
        if measured.z_weight != 0.0 {
            add(0, (measured.z - s).powi(2));
        }
        if measured.normal_weight != 0.0 {
            let n = measured.normal;
            add(1, (-n[0] / n[2] - p).powi(2));
            add(2, (-n[1] / n[2] - q).powi(2));
            add(3, angular_residual_squared(n, p, q));
        }
    });
    let root = |k: usize| {
        let mean = sums[k] / counts[k] as f64;
        (counts[k] > 0 && mean.is_finite()).then(|| mean.sqrt())
    };
    Rms {
        z: root(0).map(|v| v * solved.patch.frame.scale),
        zx: root(1),
        zy: root(2),
        normal_deg: root(3).map(f64::to_degrees),
    }
}
