//! Parameter correction: the foot of a contact, `(P - Q) . Q_u = (P - Q) . Q_v = 0`, by Newton from where it was.
//!
//! ```text
//! [ Q_u.Q_u - d.Q_uu   Q_u.Q_v - d.Q_uv ] [du]   [ d.Q_u ]
//! [ Q_u.Q_v - d.Q_uv   Q_v.Q_v - d.Q_vv ] [dv] = [ d.Q_v ]          d = P - Q
//! ```
//!
//! Where that matrix is not positive definite the terms in d are left out (Gauss-Newton). A step is cut to a tenth of
//! the domain, and a foot stays within a tenth of it. J. Hoschek, *Computer Aided Geometric Design* 5 (1988) 27.

use super::cells::Cells;
use super::parallel;
use super::touches::Touches;
use super::vector::{Vector, dot, minus};
use crate::bspline::Knots;

/// Newton steps: from a foot of the surface one step before, three reach rounding.
const STEPS: usize = 4;
/// Share of the domain that a step may cross, and that a foot may leave it by.
const REACH: f64 = 0.1;

/// A full Newton step below this is the last: the next one would be of its square.
const LAST: f64 = 1e-7;

/// Where the contacts stand.
#[derive(Clone, Debug, PartialEq)]
pub struct Feet {
    /// (u, v) of every contact; not wrapped in closed directions.
    pub places: Vec<[f64; 2]>,
}

impl Feet {
    /// The feet on the surface `c`, from these.
    pub fn moved(&self, cells: &Cells, touches: &Touches, c: &[Vector]) -> Feet {
        let limits = [0, 1].map(|k| limits(&cells.knots()[k]));
        let place = |r: usize| {
            let (mut at, point) = (self.places[r], touches.points[r]);
            for _ in 0..STEPS {
                let (step, full) = newton(cells, c, at, point);
                let mut size = 0.0_f64;
                for k in 0..2 {
                    let [lo, hi, reach] = limits[k];
                    let next = (at[k] + step[k].clamp(-reach, reach)).clamp(lo, hi);
                    size = size.max((next - at[k]).abs());
                    at[k] = next;
                }
                if size < if full { LAST } else { 1e-13 } {
                    break;
                }
            }
            at
        };
        Feet { places: parallel::map(self.places.len(), place) }
    }
}

/// Lower limit, upper limit, longest step.
fn limits(knots: &Knots) -> [f64; 3] {
    let [lo, hi] = knots.domain();
    let reach = REACH * (hi - lo);
    if knots.is_closed() { [f64::NEG_INFINITY, f64::INFINITY, reach] } else { [lo - reach, hi + reach, reach] }
}

/// The step, and whether it is Newton's own.
fn newton(cells: &Cells, c: &[Vector], at: [f64; 2], point: Vector) -> ([f64; 2], bool) {
    let jet = cells.jet::<2>(&cells.row(at[0], at[1], 2), c);
    let [qu, qv] = [jet[1][0], jet[0][1]];
    let d = minus(point, jet[0][0]);
    let (gu, gv) = (dot(d, qu), dot(d, qv));
    let first = [dot(qu, qu), dot(qu, qv), dot(qv, qv)];
    let full = [first[0] - dot(d, jet[2][0]), first[1] - dot(d, jet[1][1]), first[2] - dot(d, jet[0][2])];
    let determinant = |m: &[f64; 3]| m[0] * m[2] - m[1] * m[1];
    // a tenth of the metric determinant: nearer to the evolute the full matrix throws feet about
    let own = full[0] > 0.0 && determinant(&full) > 0.1 * determinant(&first);
    let m = if own { full } else { first };
    let det = determinant(&m);
    let step = if det > 0.0 { [(m[2] * gu - m[1] * gv) / det, (m[0] * gv - m[1] * gu) / det] } else { [0.0; 2] };
    (step, own)
}
