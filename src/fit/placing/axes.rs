//! The local frame: z along the mean normal, y along the sweep (or the first principal direction), x = y cross z.

use crate::contact::Contacts;
use crate::vector::{cross, dot, norm, reject, unit};

/// Rows are the patch's x, y, z axes. The sweep direction is the sum over the fingers of the vectors from first to last
/// station; without stations it is the first principal direction of the contacts across the mean normal.
pub(super) fn local_axes(contacts: &Contacts) -> [[f64; 3]; 3] {
    let z = mean_normal(contacts);
    let direction = sweep_direction(contacts).unwrap_or_else(|| principal_direction(contacts, z));
    let across = reject(direction, z);
    let y = unit(if norm(across) > 1e-6 * norm(direction) { across } else { principal_direction(contacts, z) });
    let y = unit(reject(y, z));
    [cross(y, z), y, z]
}

fn mean_normal(contacts: &Contacts) -> [f64; 3] {
    let sum = (0..contacts.len())
        .filter_map(|r| contacts.unit_normal(r))
        .fold([0.0; 3], |s, n| [0, 1, 2].map(|k| s[k] + n[k]));
    // normals from all sides of a body cancel: then no direction is better than the input's own z
    if norm(sum) > 1e-9 * contacts.len() as f64 { unit(sum) } else { [0.0, 0.0, 1.0] }
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
