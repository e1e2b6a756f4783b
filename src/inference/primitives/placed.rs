//! The five exact primitives of [`palpate_geometry::primitives`], placed in the cloud, and how least squares moves them.
//!
//! ```text
//! q = B'(p - o), B = [e1 e2 a]
//! ```
//!
//! A primitive moves by `tau` along its own axes and turns by `omega` about e1 and e2, in which case `dq = -tau - omega x q`.
//! What a size does to d and to its gradient is known in closed form, and so is the Hessian of d, which is all that the rows
//! of positions and normals need.

use palpate_geometry::primitives::{self, Cone, Cylinder, DistanceJet, Plane, Sphere, Torus, TriaxialEllipsoid};
use palpate_numeric::vector::{Vector, along, axes_along, cross, dot, minus, reject, unit};

/// What a part is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum PartKind {
    /// A plane.
    Plane,
    /// A ball, from outside or from inside.
    Sphere,
    /// A round bar or bore.
    Cylinder,
    /// A cone or a piece of one.
    Cone,
    /// A ring, or a rounded edge that runs round.
    Torus,
    /// A smooth surface that is none of these.
    Patch,
    /// An ellipsoid; parts have none.
    Ellipsoid,
}

impl PartKind {
    /// The exact primitives, those with fewer unknowns first.
    pub const EXACT: [PartKind; 5] =
        [PartKind::Plane, PartKind::Sphere, PartKind::Cylinder, PartKind::Cone, PartKind::Torus];

    /// What a whole body is compared with.
    pub(crate) const BODIES: [PartKind; 6] =
        [PartKind::Plane, PartKind::Sphere, PartKind::Cylinder, PartKind::Cone, PartKind::Torus, PartKind::Ellipsoid];

    /// The word used in every output.
    pub fn name(self) -> &'static str {
        match self {
            PartKind::Plane => "plane",
            PartKind::Sphere => "sphere",
            PartKind::Cylinder => "cylinder",
            PartKind::Cone => "cone",
            PartKind::Torus => "torus",
            PartKind::Patch => "patch",
            PartKind::Ellipsoid => "ellipsoid",
        }
    }

    /// Which of `tau1 tau2 tau3 omega1 omega2 size1 size2 size3 omega3` are unknown.
    pub(crate) fn free(self) -> &'static [usize] {
        match self {
            PartKind::Plane => &free::PLANE,
            PartKind::Sphere => &free::SPHERE,
            PartKind::Cylinder => &free::CYLINDER,
            PartKind::Cone => &free::CONE,
            PartKind::Torus => &free::TORUS,
            PartKind::Patch => &[],
            PartKind::Ellipsoid => &free::ELLIPSOID,
        }
    }
}

/// Unknowns of every form, as arrays whose length is known where a loop over them is compiled.
pub(super) mod free {
    pub(crate) const PLANE: [usize; 3] = [2, 3, 4];
    pub(crate) const SPHERE: [usize; 4] = [0, 1, 2, 5];
    pub(crate) const CYLINDER: [usize; 5] = [0, 1, 3, 4, 5];
    pub(crate) const CONE: [usize; 6] = [0, 1, 3, 4, 5, 6];
    pub(crate) const TORUS: [usize; 7] = [0, 1, 2, 3, 4, 5, 6];
    pub(crate) const ELLIPSOID: [usize; 9] = [0, 1, 2, 3, 4, 5, 6, 7, 8];
}

/// Most unknowns of a primitive.
pub(crate) const MOST_UNKNOWNS: usize = 9;

/// A primitive in the cloud's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Primitive {
    pub(crate) kind: PartKind,
    /// A point of the plane or of the axis; the centre of sphere and torus.
    pub(crate) origin: Vector,
    /// e1, e2 and the axis a (of a plane its normal).
    pub(crate) axes: [Vector; 3],
    /// Radius (of the torus the ring's), and half angle of the cone or radius of the tube; three half axes of an ellipsoid.
    pub(crate) sizes: [f64; 3],
    /// 1 where the free side is that of growing d, else -1.
    pub(crate) side: f64,
}

impl Primitive {
    /// The point in the primitive's own axes.
    #[inline]
    pub(crate) fn own(&self, p: Vector) -> Vector {
        let offset = minus(p, self.origin);
        self.axes.map(|axis| dot(axis, offset))
    }

    /// A direction of the primitive's own axes in the cloud's.
    pub(crate) fn out(&self, v: Vector) -> Vector {
        let [e1, e2, a] = self.axes;
        along(along(e1.map(|c| c * v[0]), v[1], e2), v[2], a)
    }

    /// Signed distance towards the free side, and the unit normal to it.
    pub(crate) fn nearest(&self, p: Vector) -> (f64, Vector) {
        let q = self.own(p);
        let (distance, gradient) = self.distance(q);
        (self.side * distance, self.out(gradient.map(|g| self.side * g)))
    }

    /// Asks the primitive in its own axes.
    fn own_form<A>(&self, ask: impl FnOnce(&dyn primitives::Primitive) -> A) -> A {
        let [one, two, _] = self.sizes;
        match self.kind {
            PartKind::Plane | PartKind::Patch => ask(&Plane),
            PartKind::Sphere => ask(&Sphere { radius: one }),
            PartKind::Cylinder => ask(&Cylinder { radius: one }),
            PartKind::Cone => ask(&Cone { radius: one, half_angle: two }),
            PartKind::Torus => ask(&Torus { ring: one, tube: two }),
            PartKind::Ellipsoid => ask(&TriaxialEllipsoid { half_axes: self.sizes }),
        }
    }

    /// Distance and gradient in the own axes.
    pub(crate) fn distance(&self, q: Vector) -> (f64, Vector) {
        self.own_form(|form| form.distance(q))
    }

    /// Everything at a point of the own axes.
    pub(crate) fn at(&self, q: Vector) -> DistanceJet {
        self.own_form(|form| form.jet(q))
    }

    /// The primitive after a step `tau1 tau2 tau3 omega1 omega2 size1 size2 size3 omega3`.
    pub(crate) fn moved(&self, step: &[f64; MOST_UNKNOWNS]) -> Primitive {
        let origin = (0..3).fold(self.origin, |o, k| along(o, step[k], self.axes[k]));
        let level = along(self.axes[0].map(|e| e * step[3]), step[4], self.axes[1]);
        let omega = if step[8] == 0.0 { level } else { along(level, step[8], self.axes[2]) };
        let axis = unit(along(self.axes[2], 1.0, cross(omega, self.axes[2])));
        let first = unit(reject(along(self.axes[0], 1.0, cross(omega, self.axes[0])), axis));
        let sizes = [self.sizes[0] + step[5], self.sizes[1] + step[6], self.sizes[2] + step[7]];
        Primitive { origin, axes: [first, cross(axis, first), axis], sizes, ..*self }
    }

    /// The same primitive with its origin where the axis (of a plane: the plane) is nearest to `centre`, so that turning
    /// moves the points least.
    pub(crate) fn about(&self, centre: Vector) -> Primitive {
        let q = self.own(centre);
        let mut same = *self;
        match self.kind {
            PartKind::Plane => same.origin = along(centre, -q[2], self.axes[2]),
            PartKind::Cylinder => same.origin = along(self.origin, q[2], self.axes[2]),
            PartKind::Cone => {
                same.origin = along(self.origin, q[2], self.axes[2]);
                same.sizes[0] += q[2] * self.sizes[1].tan();
            }
            PartKind::Sphere | PartKind::Torus | PartKind::Patch | PartKind::Ellipsoid => {}
        }
        same
    }

    /// The ring that has the curvatures of this one beside `p` and the tube where this one has its axis: to second order a saddle is of both,
    /// and a piece of a groove that is fitted by the wrong one goes on with no other. `None` outside of the inner half.
    ///
    /// ```text
    /// c1 = o + R e       nearest middle of the tube          c2 = c1 - R / (n . e) n       where the normal meets the axis
    /// o' = c1,  a' = a x e,  R' = |c1 - c2|,  r' = R' - r
    /// ```
    pub(crate) fn dual_ring(&self, p: Vector) -> Option<Primitive> {
        let [ring, tube, _] = self.sizes;
        let radial = unit(reject(minus(p, self.origin), self.axes[2]));
        let middle = along(self.origin, ring, radial);
        let inwards = -dot(unit(minus(p, middle)), radial);
        let wide = ring / inwards;
        let is_saddle = self.kind == PartKind::Torus && inwards > 0.0 && wide > tube && wide.is_finite();
        let sizes = [wide, wide - tube, 0.0];
        let axes = axes_along(cross(self.axes[2], radial));
        is_saddle.then_some(Primitive { origin: middle, axes, sizes, side: -self.side, ..*self })
    }

    /// Principal curvatures `k1 >= k2` at a point, the normal towards the free side.
    pub(crate) fn curvatures(&self, p: Vector) -> [f64; 2] {
        let q = self.own(p);
        let [a, b] = self.own_form(|form| form.curvatures(q));
        let (a, b) = (self.side * a, self.side * b);
        [a.max(b), a.min(b)]
    }

    /// Whether the sizes are those of a body, and not so large against `extent` that a simpler kind is as good.
    pub(crate) fn is_sound(&self, extent: f64) -> bool {
        /// Sizes beyond this many extents bend the surface by less than a thousandth of its width.
        const FAR: f64 = 100.0;
        let [one, two, three] = self.sizes;
        let size = |v: f64| v > 0.0 && v < FAR * extent;
        let finite = self.origin.iter().chain(self.axes.iter().flatten()).all(|v| v.is_finite());
        finite
            && match self.kind {
                PartKind::Plane | PartKind::Patch => true,
                PartKind::Sphere | PartKind::Cylinder => size(one),
                PartKind::Cone => one.is_finite() && two.abs() < 1.55 && one.abs() < FAR * extent,
                // a tube far wider than its ring is a ball in disguise
                PartKind::Torus => size(one) && size(two) && one > 0.2 * two,
                // a longer one is a bar, a flatter one a plate
                PartKind::Ellipsoid => {
                    let (least, most) = (one.min(two).min(three), one.max(two).max(three));
                    least > 0.0 && most < 10.0 * least && most < FAR * extent
                }
            }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_saddle_is_of_two_rings_of_the_same_curvatures() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let groove = Primitive { kind: PartKind::Torus, origin: [0.0; 3], axes, sizes: [10.0, 1.5, 0.0], side: -1.0 };
        let at = |turn: f64| {
            [(10.0 - 1.5 * turn.cos()) * turn.cos(), (10.0 - 1.5 * turn.cos()) * turn.sin(), 1.5 * turn.sin()]
        };
        for place in [at(0.0), at(0.5)] {
            let dual = groove.dual_ring(place).unwrap();
            assert!(dual.is_sound(10.0) && dual.sizes[1] > 5.0);
            let [(d, n), (e, m)] = [groove.nearest(place), dual.nearest(place)];
            assert!(d.abs() < 1e-12 && e.abs() < 1e-12 && dot(n, m) > 1.0 - 1e-12, "{dual:?}");
            let [one, two] = [groove.curvatures(place), dual.curvatures(place)];
            assert!((0..2).all(|k| (one[k] - two[k]).abs() < 1e-12), "{one:?} {two:?}");
        }
        let again = groove.dual_ring(at(0.0)).unwrap().dual_ring(at(0.0)).unwrap();
        assert!((0..2).all(|k| (again.sizes[k] - groove.sizes[k]).abs() < 1e-9), "{again:?}");
        // outside of the tube's middle the surface is a dome, and no other ring is as near
        assert_eq!(groove.dual_ring([11.5, 0.0, 0.0]), None);
    }
}
