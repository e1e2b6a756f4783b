//! The local frame: z along the mean normal, y along the sweep (or the first principal direction), x = y cross z.
//!
//! ```text
//! with normals         z = mean of the unit normals
//! positions alone      z = the direction across which the contacts spread least, on the side of the input's z
//! steepness            cosine of the angle between that z and the input's: 1 lies flat, 0 stands upright
//! ```

use faer::{Mat, Side};

use palpate_geometry::contact::{Contacts, Orientation};
use palpate_numeric::vector::{along, cross, dot, minus, norm, reject, unit};

/// A patch that leans by more than 45 degrees is steep over the input's axes: its mean slope there is above 1, so that errors
/// of x and y enter the heights more than whole. A saddle that leans by 60 degrees has S wrong by 0.15 under a cubic over the
/// input's axes, and by 0.001 over its own. Patches that lean less keep the input's axes, in which users know their way.
pub const STEEP: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Positions alone tell a direction where they spread across it by less than this share of their spread along the patch.
/// A deep groove over its own x and y spreads more along z than across its walls, and it does not stand.
const SHEET: f64 = 0.2;

/// Mean unit normals shorter than this come from all round a body and tell no direction.
const SHORT: f64 = 0.3;

/// Cosine of the angle between the patch's own z and the input's; `None` where the contacts do not tell.
pub fn steepness(contacts: &Contacts) -> Option<f64> {
    match contacts.orientation {
        Orientation::Normals { .. } => {
            let sum = sum_of_normals(contacts);
            (norm(sum) > SHORT * contacts.len() as f64).then(|| unit(sum)[2])
        }
        // slopes are over x and y by what they are
        Orientation::Slopes { .. } => None,
        Orientation::None => narrowest(contacts).map(|z| z[2].abs()),
    }
}

/// Rows are the patch's x, y, z axes. The sweep direction is the sum over the fingers of the vectors from first to last
/// station; without stations it is the first principal direction of the contacts across the mean normal.
pub(super) fn local_axes(contacts: &Contacts) -> [[f64; 3]; 3] {
    let z = patch_normal(contacts);
    let direction = sweep_direction(contacts).unwrap_or_else(|| principal_direction(contacts, z));
    let across = reject(direction, z);
    let y = unit(if norm(across) > 1e-6 * norm(direction) { across } else { principal_direction(contacts, z) });
    let y = unit(reject(y, z));
    [cross(y, z), y, z]
}

/// Normals from all sides of a body cancel; no direction is then better than the input's own z.
fn patch_normal(contacts: &Contacts) -> [f64; 3] {
    let up = [0.0, 0.0, 1.0];
    if matches!(contacts.orientation, Orientation::None) {
        return narrowest(contacts).unwrap_or(up);
    }
    let sum = sum_of_normals(contacts);
    if norm(sum) > 1e-9 * contacts.len() as f64 { unit(sum) } else { up }
}

fn sum_of_normals(contacts: &Contacts) -> [f64; 3] {
    let normals = (0..contacts.len()).filter_map(|r| contacts.unit_normal(r));
    normals.fold([0.0; 3], |s, n| [0, 1, 2].map(|k| s[k] + n[k]))
}

/// Direction of least spread, on the side of the input's z, where the contacts lie about a plane across it.
fn narrowest(contacts: &Contacts) -> Option<[f64; 3]> {
    let points = || (0..contacts.len()).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]);
    let (first, count) = (points().next()?, contacts.len() as f64);
    let mean = points().fold([0.0; 3], |m, p| along(m, 1.0 / count, minus(p, first)));
    let largest = points().map(|p| norm(minus(minus(p, first), mean))).fold(0.0, f64::max);
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let mut covariance = Mat::<f64>::zeros(3, 3);
    for p in points() {
        let d = minus(minus(p, first), mean).map(|v| v / largest);
        (0..3).for_each(|i| (0..=i).for_each(|j| covariance[(i, j)] += d[i] * d[j] / count));
    }
    let eigen = covariance.self_adjoint_eigen(Side::Lower).ok()?;
    let [least, middle] = [0, 1].map(|k| eigen.S()[k].max(0.0).sqrt());
    let side = 1.0_f64.copysign(eigen.U()[(2, 0)]);
    (least < SHEET * middle).then(|| [0, 1, 2].map(|i| side * eigen.U()[(i, 0)]))
}

fn sweep_direction(contacts: &Contacts) -> Option<[f64; 3]> {
    let (fingers, stations) = (contacts.finger.as_ref()?, contacts.station.as_ref()?);
    let mut sum = [0.0; 3];
    let mut numbers: Vec<u32> = fingers.clone();
    numbers.sort_unstable();
    numbers.dedup();
    for finger in numbers {
        let of_finger = || (0..fingers.len()).filter(|&r| fingers[r] == finger);
        let first = of_finger().min_by_key(|&r| stations[r])?;
        let last = of_finger().max_by_key(|&r| stations[r])?;
        let d = [
            contacts.x[last] - contacts.x[first],
            contacts.y[last] - contacts.y[first],
            contacts.z[last] - contacts.z[first],
        ];
        sum = [0, 1, 2].map(|k| sum[k] + d[k]);
    }
    (norm(sum) > 0.0).then_some(sum)
}

/// Largest spread of the contacts perpendicular to `z`, by the 2 x 2 covariance in that plane; its sign is fixed by
/// making the component of largest magnitude positive.
fn principal_direction(contacts: &Contacts, z: [f64; 3]) -> [f64; 3] {
    let seed = if z[1].abs() < 0.9 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
    let v = unit(reject(seed, z));
    let u = cross(v, z);
    let n = contacts.len() as f64;
    let point = |r: usize| [contacts.x[r], contacts.y[r], contacts.z[r]];
    let mean = (0..contacts.len()).fold([0.0; 3], |m, r| [0, 1, 2].map(|k| m[k] + point(r)[k] / n));
    let (mut uu, mut uv, mut vv) = (0.0, 0.0, 0.0);
    for r in 0..contacts.len() {
        let p = point(r);
        let d = [0, 1, 2].map(|k| p[k] - mean[k]);
        let (a, b) = (dot(d, u), dot(d, v));
        (uu, uv, vv) = (uu + a * a, uv + a * b, vv + b * b);
    }
    let angle = 0.5 * (2.0 * uv).atan2(uu - vv);
    let direction = [0, 1, 2].map(|k| angle.cos() * u[k] + angle.sin() * v[k]);
    let largest = direction.iter().fold(0.0_f64, |m, w| if w.abs() > m.abs() { *w } else { m });
    direction.map(|w| w * 1.0_f64.copysign(largest))
}
