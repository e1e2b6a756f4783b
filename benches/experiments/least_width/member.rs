//! A member of a family in its pose, and what is seen of it over a place.
//!
//! ```text
//! P = matrix p + offset            p on the upright body, or on its mirror image z to -z
//! over (x, y): z <- z - (height of p over the body's tangent plane)/(its change along the vertical), until it stands
//! ```

use palpate::scene::Surface;
use palpate_world::scene::surface::Local;

use super::kinds::Kind;

type Vector = [f64; 3];
type Matrix = [Vector; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn times(m: &Matrix, v: Vector) -> Vector {
    m.map(|row| dot(row, v))
}

fn back(m: &Matrix, v: Vector) -> Vector {
    [0, 1, 2].map(|k| m[0][k] * v[0] + m[1][k] * v[1] + m[2][k] * v[2])
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| back(b, row))
}

#[derive(Clone, Debug)]
pub(crate) struct Member {
    pub(crate) kind: Kind,
    pub(crate) sizes: Vec<f64>,
    pub(crate) concave: bool,
    matrix: Matrix,
    offset: Vector,
}

/// Height, normal, S and R over one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    pub(crate) z: f64,
    pub(crate) normal: Vector,
    pub(crate) shape: [Option<f64>; 2],
}

impl Member {
    pub(crate) fn upright(kind: Kind, sizes: Vec<f64>) -> Member {
        let matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Member { kind, sizes, concave: false, matrix, offset: [0.0; 3] }
    }

    /// The member after a rotation about the origin by the vector `turn` (radians), then a shift. O. Rodrigues, *J. Math. Pures Appl.* 5
    /// (1840) 380.
    pub(crate) fn moved(&self, turn: Vector, shift: Vector) -> Member {
        let angle = dot(turn, turn).sqrt();
        let (a, b) = if angle < 1e-4 {
            (1.0 - angle * angle / 6.0, 0.5)
        } else {
            (angle.sin() / angle, (1.0 - angle.cos()) / (angle * angle))
        };
        let [i, j, k] = turn;
        let cross = [[0.0, -k, j], [k, 0.0, -i], [-j, i, 0.0]];
        let square = product(&cross, &cross);
        let unit = |r: usize, c: usize| f64::from(u8::from(r == c));
        let rotation = [0, 1, 2].map(|r| [0, 1, 2].map(|c| unit(r, c) + a * cross[r][c] + b * square[r][c]));
        let turned = times(&rotation, self.offset);
        let offset = [0, 1, 2].map(|d| turned[d] + shift[d]);
        Member { matrix: product(&rotation, &self.matrix), offset, ..self.clone() }
    }

    /// What is seen over a place, sought from a height near it; `None` where the upper side of the body does not reach.
    pub(crate) fn seen(&self, place: [f64; 2], near: f64) -> Option<Seen> {
        self.seen_of(&self.kind.body(&self.sizes), place, near)
    }

    /// The same with the body at hand.
    pub(crate) fn seen_of(&self, body: &Surface, [x, y]: [f64; 2], near: f64) -> Option<Seen> {
        let sign = if self.concave { -1.0 } else { 1.0 };
        let mirrored = |v: Vector| [v[0], v[1], sign * v[2]];
        let up = mirrored(back(&self.matrix, [0.0, 0.0, 1.0]));
        let mut z = near;
        for _ in 0..30 {
            let p = mirrored(back(&self.matrix, [0, 1, 2].map(|d| [x, y, z][d] - self.offset[d])));
            let found = body.at(p[0], p[1])?;
            let normal = found.local.normal;
            let step = -normal[2] * (p[2] - found.point[2]) / dot(normal, up);
            z += step;
            if !z.is_finite() {
                return None;
            }
            if step.abs() < 1e-12 * (1.0 + z.abs()) {
                return self.told(&found.local, z);
            }
        }
        None
    }

    fn told(&self, local: &Local, z: f64) -> Option<Seen> {
        let n = local.normal;
        // a body seen from inside: normals are mirrored to point to the free side again, and S changes its sign
        let (inner, sign) = if self.concave { ([-n[0], -n[1], n[2]], -1.0) } else { (n, 1.0) };
        let normal = times(&self.matrix, inner);
        let shape = [local.shape_index().map(|s| sign * s), Some(local.curvedness())];
        (normal[2] > 0.0).then_some(Seen { z, normal, shape })
    }

    /// The surface of a scene that the member is.
    pub(crate) fn surface(&self) -> Surface {
        let m = &self.matrix;
        // Rz Ry Rx
        let about_y = (-m[2][0]).clamp(-1.0, 1.0).asin();
        let angles = [m[2][1].atan2(m[2][2]), about_y, m[1][0].atan2(m[0][0])];
        let posed = self.kind.body(&self.sizes).posed(0.0, angles.map(f64::to_degrees), self.offset);
        if self.concave { posed.concave() } else { posed }
    }
}
