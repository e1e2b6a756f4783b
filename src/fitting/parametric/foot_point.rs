//! Parameter correction: the foot of a contact, `(P - Q) . Q_u = (P - Q) . Q_v = 0`, by Newton's method from its last place.
//!
//! ```text
//! [ Q_u.Q_u - d.Q_uu   Q_u.Q_v - d.Q_uv ] [du]   [ d.Q_u ]
//! [ Q_u.Q_v - d.Q_uv   Q_v.Q_v - d.Q_vv ] [dv] = [ d.Q_v ]          d = P - Q
//! ```
//!
//! Where that matrix is not positive definite the terms in d are left out (Gauss-Newton). No step is longer than a tenth
//! of the domain, and no foot leaves the domain by more than that. J. Hoschek, *Computer Aided Geometric Design* 5 (1988) 27.

use super::cells::Cells;
use super::parallel;
use super::patch_contacts::PatchContacts;
use super::vector::{Vector, dot, minus};
use palpate_numeric::bspline::Knots;

/// Most Newton steps. From the foot on the surface of the last step, three reach rounding.
const STEPS: usize = 4;
/// Share of the domain that is the longest step, and the farthest that a foot may leave the domain by.
const REACH: f64 = 0.1;

/// A full Newton step below this is the last one: the next would be about its square.
const LAST: f64 = 1e-7;

/// The feet of the contacts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Feet {
    /// (u, v) of every contact; not wrapped in closed directions.
    pub places: Vec<[f64; 2]>,
}

impl Feet {
    /// The feet on the surface with coefficients `c`, found from these.
    pub(super) fn moved(&self, cells: &Cells, contacts: &PatchContacts, c: &[Vector]) -> Feet {
        let limits = [0, 1].map(|k| limits(&cells.knots()[k]));
        let place = |r: usize| {
            let (mut at, point) = (self.places[r], contacts.points[r]);
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

/// The step, and whether it is a full Newton step rather than a Gauss-Newton step.
fn newton(cells: &Cells, c: &[Vector], at: [f64; 2], point: Vector) -> ([f64; 2], bool) {
    let jet = cells.jet::<2>(&cells.row(at[0], at[1], 2), c);
    let [qu, qv] = [jet[1][0], jet[0][1]];
    let d = minus(point, jet[0][0]);
    let (gu, gv) = (dot(d, qu), dot(d, qv));
    let first = [dot(qu, qu), dot(qu, qv), dot(qv, qv)];
    let full = [first[0] - dot(d, jet[2][0]), first[1] - dot(d, jet[1][1]), first[2] - dot(d, jet[0][2])];
    let determinant = |m: &[f64; 3]| m[0] * m[2] - m[1] * m[1];
    // a tenth of the metric determinant: nearer to the evolute full steps are far too long
    let own = full[0] > 0.0 && determinant(&full) > 0.1 * determinant(&first);
    let m = if own { full } else { first };
    let det = determinant(&m);
    let step = if det > 0.0 { [(m[2] * gu - m[1] * gv) / det, (m[0] * gv - m[1] * gu) / det] } else { [0.0; 2] };
    (step, own)
}
