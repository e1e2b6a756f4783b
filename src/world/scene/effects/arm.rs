//! A serial arm of revolute joints by Denavit and Hartenberg:
//!
//! ```text
//! T_i = Rz(q_i + theta_i) Tz(d_i) Tx(a_i) Rx(alpha_i)        pose = T_base T_1 ... T_n
//! J = [z_i x (p - o_i)]        q <- q + J' (J J' + lambda I)^-1 (target - p)
//! ```
//!
//! J. Denavit, R. S. Hartenberg, *J. Appl. Mech.* 22 (1955) 215. The inverse is found by damped least squares
//! (Y. Nakamura, H. Hanafusa, *J. Dyn. Sys. Meas. Control* 108 (1986) 163) from the last solution, then from a lattice
//! of starts.

use crate::scene::rotation::{Matrix, product, rotated, sin_cos_deg};
use palpate_numeric::vector::{Vector, along, cross, dot, norm};

/// One joint and the link behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Link {
    /// Length along the link's x axis, input units.
    pub a: f64,
    /// Twist about the link's x axis, degrees.
    pub alpha_deg: f64,
    /// Offset along the joint's axis, input units.
    pub d: f64,
    /// Joint angle at encoder zero, degrees.
    pub theta_deg: f64,
}

/// Joints from the base to the tip's centre.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Arm {
    /// Where the base stands, upright, input units.
    pub base: [f64; 3],
    /// Links in order, at least one.
    pub links: Vec<Link>,
}

/// Where the arm ends, and the rotation of its last link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    pub point: Vector,
    pub rotation: Matrix,
}

impl Arm {
    /// Three joints (waist, shoulder, elbow) at four patch sides from a patch of this side and centre.
    pub(crate) fn beside(side: f64, centre: [f64; 3]) -> Arm {
        let base = [centre[0] - 4.0 * side, centre[1], centre[2]];
        let waist = Link { alpha_deg: 90.0, d: 2.0 * side, ..Link::default() };
        let segment = Link { a: 3.0 * side, ..Link::default() };
        Arm { base, links: vec![waist, segment, segment] }
    }

    /// Sum of all lengths: nothing beyond is reached.
    pub(crate) fn span(&self) -> f64 {
        self.links.iter().map(|link| link.a.hypot(link.d)).sum()
    }

    /// Pose of the tip's centre for joint angles in radians; `axes` gets each joint's origin and axis.
    pub(crate) fn forward(&self, joints: &[f64], mut axes: Option<&mut Vec<(Vector, Vector)>>) -> Pose {
        let mut pose = Pose { point: self.base, rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };
        for (link, angle) in self.links.iter().zip(joints) {
            let axis = [pose.rotation[0][2], pose.rotation[1][2], pose.rotation[2][2]];
            if let Some(axes) = axes.as_deref_mut() {
                axes.push((pose.point, axis));
            }
            let (s, c) = (angle + link.theta_deg.to_radians()).sin_cos();
            let (sa, ca) = sin_cos_deg(link.alpha_deg);
            pose.point = along(pose.point, 1.0, rotated(&pose.rotation, [link.a * c, link.a * s, link.d]));
            pose.rotation = product(&pose.rotation, &[[c, -s * ca, s * sa], [s, c * ca, -c * sa], [0.0, sa, ca]]);
        }
        pose
    }

    /// Joint angles that put the tip's centre at `target`; otherwise the distance that is left.
    pub(crate) fn inverse(&self, target: Vector, start: Option<&[f64]>) -> Result<Vec<f64>, f64> {
        let mut nearest = f64::INFINITY;
        let lattice = (0..3_usize.pow(self.links.len().min(4) as u32)).map(|code| self.lattice_start(code));
        for from in start.map(<[f64]>::to_vec).into_iter().chain(lattice) {
            let (joints, miss) = self.descend(target, from);
            if miss <= 1e-12 * self.span() {
                return Ok(joints);
            }
            nearest = nearest.min(miss);
        }
        Err(nearest)
    }

    /// Three angles a joint for the first four joints; never straight, where the Jacobian is singular.
    fn lattice_start(&self, mut code: usize) -> Vec<f64> {
        let mut joints = vec![0.4; self.links.len()];
        for joint in joints.iter_mut().take(4) {
            *joint = 0.4 + 2.1 * (code % 3) as f64;
            code /= 3;
        }
        joints
    }

    fn descend(&self, target: Vector, mut joints: Vec<f64>) -> (Vec<f64>, f64) {
        let span = self.span();
        let mut lambda = 1e-3;
        let mut miss = norm(along(target, -1.0, self.forward(&joints, None).point));
        for _ in 0..200 {
            let mut axes = Vec::with_capacity(joints.len());
            let pose = self.forward(&joints, Some(&mut axes));
            let error = along(target, -1.0, pose.point);
            let columns: Vec<Vector> =
                axes.iter().map(|(origin, axis)| cross(*axis, along(pose.point, -1.0, *origin))).collect();
            let Some(force) = damped(&columns, error, lambda * span * span) else { break };
            let trial: Vec<f64> = joints.iter().zip(&columns).map(|(q, column)| q + dot(*column, force)).collect();
            let left = norm(along(target, -1.0, self.forward(&trial, None).point));
            if left < miss {
                (joints, miss) = (trial, left);
                lambda = (lambda * 0.1).max(1e-30);
            } else if lambda > 1e3 || miss <= 1e-14 * span {
                break;
            } else {
                lambda = (lambda * 10.0).max(1e-12);
            }
        }
        (joints, miss)
    }
}

/// `(J J' + lambda I)^-1 e` by Cramer's rule; `None` when singular.
fn damped(columns: &[Vector], error: Vector, lambda: f64) -> Option<Vector> {
    let entry =
        |i: usize, j: usize| columns.iter().map(|c| c[i] * c[j]).sum::<f64>() + if i == j { lambda } else { 0.0 };
    let rows = [0, 1, 2].map(|i| [entry(i, 0), entry(i, 1), entry(i, 2)]);
    let (m, n, o) = (cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1]));
    let determinant = dot(rows[0], m);
    (determinant != 0.0 && determinant.is_finite())
        .then(|| [0, 1, 2].map(|k| (m[k] * error[0] + n[k] * error[1] + o[k] * error[2]) / determinant))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_undoes_forward() {
        let arm = Arm::beside(8.0, [0.0; 3]);
        let mut last: Option<Vec<f64>> = None;
        for target in [[-4.0, -4.0, -2.0], [4.0, 4.0, -2.0], [0.0, 0.0, 0.0], [4.0, -4.0, 1.0]] {
            let joints = arm.inverse(target, last.as_deref()).unwrap();
            let reached = arm.forward(&joints, None).point;
            assert!(norm(along(reached, -1.0, target)) < 1e-12 * arm.span());
            last = Some(joints);
        }
        let miss = arm.inverse([100.0, 0.0, 0.0], None).unwrap_err();
        // the shoulder is 16 above the base; stretched the arm ends 48 from it
        let expected = (132.0_f64.powi(2) + 16.0_f64.powi(2)).sqrt() - 48.0;
        assert!((miss - expected).abs() < 1e-6 * expected, "{miss} {expected}");
    }
}
