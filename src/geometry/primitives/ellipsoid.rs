//! The ellipsoid `(q1/a)^2 + (q2/b)^2 + (q3/c)^2 = 1`.
//!
//! ```text
//! foot      x_i = a_i^2 q_i / (a_i^2 + t),  F(t) = sum (a_i q_i / (a_i^2 + t))^2 - 1 = 0,  the largest root t > -min a^2
//! d         = |q - x| sign(t)                           g = (x_i / a_i^2) / w,  w = sqrt(sum x_i^2 / a_i^4)
//! W         = P diag(1/a^2) P / w                        shape operator at x, P = 1 - g g'
//! H         = W (1 + d W)^-1                             Hessian of the distance
//! dd/da_i   = -x_i^2 / (a_i^3 w) = -h_i(x)               dg/da_i = -(1 + d W)^-1 P grad h_i
//! ```
//!
//! F falls from infinity to -1 on that side, so that the root is one and safe to find. D. Eberly, *Distance from a point to an ellipse, an
//! ellipsoid, or a hyperellipsoid*, 2013.

use super::{DistanceJet, Primitive, square};
use palpate_numeric::vector::{Vector, dot, minus, norm};

/// An ellipsoid by its half axes, the three sizes, along the first, second and third axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriaxialEllipsoid {
    /// Half axes.
    pub half_axes: [f64; 3],
}

/// Steps to the root: near the surface three are enough, and each halves what is left at least.
const STEPS: usize = 100;

/// A step below this share of the root's distance from the pole is the last: the next would be its square.
const LAST: f64 = 1e-9;

impl TriaxialEllipsoid {
    /// Nearest point of the surface and the root t.
    ///
    /// Newton's steps go by `1 / |v| = 1` with `v_k = a_k q_k / (a_k^2 + t)`, which is nearly a line in t: J. More and D. Sorensen, *SIAM
    /// J. Sci. Stat. Comput.* 4 (1983) 553.
    fn foot(&self, q: Vector) -> (Vector, f64) {
        let squares = self.half_axes.map(|a| a * a);
        let least = squares[0].min(squares[1]).min(squares[2]);
        let heavy = [0, 1, 2].map(|k| self.half_axes[k] * q[k]);
        // on the least axis alone F reaches zero no farther down than this, and no farther up than with all of q on the largest
        let (mut lo, mut hi) = (-least, norm(heavy) - least);
        let mut t = hi.min(0.0);
        for _ in 0..STEPS {
            let over = squares.map(|square| 1.0 / (square + t));
            let each = [0, 1, 2].map(|k| (heavy[k] * over[k]).powi(2));
            let square: f64 = each.iter().sum();
            if square > 1.0 {
                lo = t;
            } else {
                hi = t;
            }
            let newton = t + (square.sqrt() - 1.0) * square / dot(each, over);
            let next = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
            let step = (next - t).abs();
            if next.is_nan() || step <= f64::EPSILON * least.max(next.abs()) {
                break;
            }
            t = next;
            if next == newton && step <= LAST * (t + least) {
                break;
            }
        }
        let mut x = [0, 1, 2].map(|k| squares[k] * q[k] / (squares[k] + t).max(f64::MIN_POSITIVE));
        if t + least <= 1e-9 * least {
            // within the plane of the two longer axes the foot lies to either side of it
            let shortest = self.shortest();
            let others = (0..3).filter(|k| *k != shortest).map(|k| (x[k] / self.half_axes[k]).powi(2)).sum::<f64>();
            x[shortest] = (self.half_axes[shortest] * (1.0 - others).max(0.0).sqrt()).copysign(q[shortest]);
        }
        (self.onto(x), t)
    }

    fn shortest(&self) -> usize {
        (0..3).fold(0, |k, j| if self.half_axes[j] < self.half_axes[k] { j } else { k })
    }

    /// A point near the surface moved onto it towards the middle; the end of the shortest half axis where it is the middle itself.
    fn onto(&self, x: Vector) -> Vector {
        let size = (0..3).map(|k| (x[k] / self.half_axes[k]).powi(2)).sum::<f64>().sqrt();
        if size > 0.0 && size.is_finite() {
            return x.map(|v| v / size);
        }
        let shortest = self.shortest();
        let mut end = [0.0; 3];
        end[shortest] = self.half_axes[shortest];
        end
    }

    /// Gradient of the equation at a point of the surface, halved, and its length.
    fn slope(&self, x: Vector) -> (Vector, f64) {
        let half = [0, 1, 2].map(|k| x[k] / (self.half_axes[k] * self.half_axes[k]));
        (half, norm(half))
    }

    /// Shape operator at a point of the surface, towards the inside.
    fn shape_operator(&self, normal: Vector, steepness: f64) -> [Vector; 3] {
        let inverse = self.half_axes.map(|a| 1.0 / (a * a));
        let along_normal: f64 = (0..3).map(|k| normal[k] * normal[k] * inverse[k]).sum();
        square(|i, j| {
            let plain = if i == j { inverse[i] } else { 0.0 };
            (plain - normal[i] * normal[j] * (inverse[i] + inverse[j] - along_normal)) / steepness
        })
    }
}

/// The inverse of a symmetric matrix.
fn inverse(m: &[Vector; 3]) -> [Vector; 3] {
    let minor = |i: usize, j: usize| {
        let ([a, b], [c, d]) = ([(i + 1) % 3, (i + 2) % 3], [(j + 1) % 3, (j + 2) % 3]);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
    square(|i, j| minor(j, i) / determinant)
}

fn product(m: &[Vector; 3], v: Vector) -> Vector {
    [0, 1, 2].map(|i| dot(m[i], v))
}

impl Primitive for TriaxialEllipsoid {
    fn distance(&self, q: Vector) -> (f64, Vector) {
        let (x, t) = self.foot(q);
        let (half, steepness) = self.slope(x);
        let normal = half.map(|v| v / steepness);
        (norm(minus(q, x)).copysign(t), normal)
    }

    fn jet(&self, q: Vector) -> DistanceJet {
        let (x, t) = self.foot(q);
        let (half, steepness) = self.slope(x);
        let normal = half.map(|v| v / steepness);
        let distance = norm(minus(q, x)).copysign(t);
        let operator = self.shape_operator(normal, steepness);
        let spread = inverse(&square(|i, j| f64::from(u8::from(i == j)) + distance * operator[i][j]));
        let by_size = [0, 1, 2].map(|k| -x[k] * x[k] / (self.half_axes[k].powi(3) * steepness));
        // h_k = x_k^2 / (a_k^3 w): its gradient along the surface, carried from the foot to the place
        let gradient_by_size = [0, 1, 2].map(|k| {
            let mut slope =
                [0, 1, 2].map(|i| by_size[k] * half[i] / (self.half_axes[i].powi(2) * steepness * steepness));
            slope[k] += 2.0 * x[k] / (self.half_axes[k].powi(3) * steepness);
            let level = dot(slope, normal);
            let tangential = [0, 1, 2].map(|i| slope[i] - level * normal[i]);
            product(&spread, tangential).map(|v| -v)
        });
        let hessian = square(|i, j| (0..3).map(|l| operator[i][l] * spread[l][j]).sum());
        DistanceJet { distance, gradient: normal, hessian, by_size, gradient_by_size }
    }

    fn curvatures(&self, q: Vector) -> [f64; 2] {
        let (x, _) = self.foot(q);
        let (half, steepness) = self.slope(x);
        let operator = self.shape_operator(half.map(|v| v / steepness), steepness);
        // the third eigenvalue is zero, along the normal
        let trace = operator[0][0] + operator[1][1] + operator[2][2];
        let second: f64 = [(0, 1), (1, 2), (2, 0)]
            .into_iter()
            .map(|(i, j)| operator[i][i] * operator[j][j] - operator[i][j] * operator[j][i])
            .sum();
        let gap = (0.25 * trace * trace - second).max(0.0).sqrt();
        [-(0.5 * trace - gap), -(0.5 * trace + gap)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EGG: TriaxialEllipsoid = TriaxialEllipsoid { half_axes: [3.0, 2.0, 1.2] };

    fn places() -> impl Iterator<Item = Vector> {
        (0..40).map(f64::from).map(|k| [3.5 * (1.3 * k).sin(), 2.4 * (0.7 * k).cos(), 1.6 * (2.1 * k + 1.0).sin()])
    }

    #[test]
    fn the_foot_lies_on_the_surface_below_the_place() {
        for q in places().chain([[0.0, 0.1, 0.0], [0.0; 3], [3.0, 0.0, 0.0], [0.5, 0.0, 0.0]]) {
            let (d, n) = EGG.distance(q);
            let x = [0, 1, 2].map(|k| q[k] - d * n[k]);
            let on = (0..3).map(|k| (x[k] / EGG.half_axes[k]).powi(2)).sum::<f64>();
            assert!((on - 1.0).abs() < 1e-9, "{q:?}: {on}");
            // no point of the surface is nearer
            for other in places().map(|p| EGG.onto(p)) {
                assert!(norm(minus(q, other)) >= d.abs() - 1e-9, "{q:?}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        const STEP_OF_DIFFERENCES: f64 = 1e-5;
        for q in places().filter(|q| EGG.distance(*q).0 > -0.4) {
            let jet = EGG.jet(q);
            for k in 0..3 {
                let beside = |by: f64| {
                    let mut q = q;
                    q[k] += by;
                    EGG.distance(q)
                };
                let (ahead, behind) = (beside(STEP_OF_DIFFERENCES), beside(-STEP_OF_DIFFERENCES));
                assert!(((ahead.0 - behind.0) / (2.0 * STEP_OF_DIFFERENCES) - jet.gradient[k]).abs() < 1e-7, "{q:?}");
                for i in 0..3 {
                    assert!(
                        ((ahead.1[i] - behind.1[i]) / (2.0 * STEP_OF_DIFFERENCES) - jet.hessian[i][k]).abs() < 1e-5,
                        "{q:?}"
                    );
                }
                let sized = |by: f64| {
                    let mut egg = EGG;
                    egg.half_axes[k] += by;
                    egg.distance(q)
                };
                let (ahead, behind) = (sized(STEP_OF_DIFFERENCES), sized(-STEP_OF_DIFFERENCES));
                assert!(((ahead.0 - behind.0) / (2.0 * STEP_OF_DIFFERENCES) - jet.by_size[k]).abs() < 1e-7, "{q:?}");
                for i in 0..3 {
                    let difference = (ahead.1[i] - behind.1[i]) / (2.0 * STEP_OF_DIFFERENCES);
                    assert!((difference - jet.gradient_by_size[k][i]).abs() < 1e-5, "{q:?}");
                }
            }
        }
    }

    #[test]
    fn curvatures_at_the_ends_of_the_axes_are_known() {
        let [a, b, c] = EGG.half_axes;
        let at = |q: Vector| EGG.curvatures(q).map(|k| -k);
        let close =
            |found: [f64; 2], expected: [f64; 2]| found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-12);
        assert!(close(at([a, 0.0, 0.0]), [a / (b * b), a / (c * c)]));
        assert!(close(at([0.0, 0.0, c]), [c / (a * a), c / (b * b)]));
    }
}
