//! The angle of a joint, and how well it is known.
//!
//! ```text
//! phi = mean over places m where the parts meet of +- angle(n_a(m), n_b(m))
//! u^2 = g_a' V_a g_a + g_b' V_b g_b          g: derivatives of phi by the unknowns of either part (`delta_method.rs`), V: their covariances (`exact.rs`)
//! ```
//!
//! The covariances count what neighbours share.

use super::delta_method::standard_uncertainties;
use super::exact::Exact;
use crate::primitives::placed::Primitive;
use palpate_numeric::vector::{Vector, cross, dot, minus, norm};

/// A place where two parts meet, and the step from a contact of the first to one of the second.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeetingPlace {
    pub(super) place: Vector,
    pub(super) across: Vector,
}

/// The angle from one normal to the other, positive where the body stands out across the step from the one's contact to the other's.
pub(super) fn turn_at(one: Vector, two: Vector, across: Vector) -> f64 {
    let angle = norm(cross(one, two)).atan2(dot(one, two));
    if dot(minus(two, one), across) < 0.0 { -angle } else { angle }
}

/// Standard uncertainty of the mean turn at these places, radians; `None` where a part is no primitive, or its contacts leave an unknown
/// open. At an edge noise may reverse the sign of a turn, but not its size, and `is_smooth` says where signs count.
pub(super) fn u_of_angle(meetings: &[MeetingPlace], both: [Option<&Exact>; 2], is_smooth: bool) -> Option<f64> {
    let [one, two] = [both[0]?, both[1]?];
    let [a, b] = [one, two].map(|end| end.descended.primitive);
    let mean = |a: &Primitive, b: &Primitive| {
        let turn = |m: &MeetingPlace| turn_at(a.nearest(m.place).1, b.nearest(m.place).1, m.across);
        let of = |turn: f64| if is_smooth { turn } else { turn.abs() };
        [meetings.iter().map(|m| of(turn(m))).sum::<f64>() / meetings.len() as f64]
    };
    let [of_one] = standard_uncertainties(&a, &one.covariance()?, |moved| mean(moved, &b));
    let [of_two] = standard_uncertainties(&b, &two.covariance()?, |moved| mean(&a, moved));
    Some(of_one.hypot(of_two))
}

#[cfg(test)]
mod tests {
    use crate::parts::{Parts, PartsOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::{Vector, along, unit};

    /// The joint of two faces that lean by 30 degrees, places and normals being off by so much.
    fn roof(noise: f64) -> (f64, f64) {
        let draws = EffectDraws::new(17, "roof");
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let contact = |k: u64| -> (Vector, Vector) {
            let [s, y] = [k % 20, k / 20 % 20].map(|i| 0.5 * i as f64 + 0.25);
            let (place, normal) =
                if k < 400 { ([-s, y, 0.0], [0.0, 0.0, 1.0]) } else { ([s * cos, y, -s * sin], [sin, 0.0, cos]) };
            let mut off = [0.0; 4];
            draws.gaussians(0, k, 4, &mut off);
            let leaning = [0, 1, 2].map(|axis| normal[axis] + noise * off[axis + 1]);
            (along(place, noise * off[0], normal), unit(leaning))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..800).map(contact).unzip();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let found = Parts::of(&contacts, &PartsOptions::default()).unwrap();
        assert_eq!(found.joints.len(), 1);
        (found.joints[0].angle_deg - 30.0, found.joints[0].u_angle_deg.unwrap())
    }

    #[test]
    fn an_angle_is_known_as_well_as_both_faces_are() {
        let (off, u) = roof(0.03);
        // 400 places over 10 and as many normals leave a face some 0.03 degrees
        assert!(off.abs() < 3.0 * u && (0.01..0.2).contains(&u), "{off} {u}");
        let (off, u) = roof(0.0);
        assert!(off.abs() < 1e-6 && u < 1e-6, "{off} {u}");
    }
}
