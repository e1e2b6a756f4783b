//! What the fingers touch: a body with its apex at the origin, seen from outside or from inside, then posed.
//!
//! ```text
//! convex   z = body(x, y)         concave   z = -body(x, y): the same body seen from inside, lowest at the origin
//! ```
//!
//! Every point has an exact height (no cancellation at any radius), unit normal towards the free side, principal
//! curvatures, S and R. A surface is met from above: the contact over (x, y) is the uppermost point of the body (for
//! a concave surface, of its mirror image, downwards).

mod body;
mod cylinder;
mod ellipsoid;
mod gaussian;
mod geometry;
mod imported;
mod local;
mod monkey_saddle;
mod paraboloid;
mod plane;
mod pose;
mod quadric;
mod ray;
mod saddle;
mod sinusoid;
mod solid;
mod solids;
mod sphere;
mod superquadric;
mod torus;
mod union;

pub use body::Body;
pub use cylinder::Cylinder;
pub use ellipsoid::Ellipsoid;
pub use gaussian::GaussianBump;
pub use imported::ImportedSurface;
#[doc(hidden)]
pub use local::Local;
pub use monkey_saddle::MonkeySaddle;
pub use paraboloid::Paraboloid;
pub use pose::Pose;
pub use saddle::Saddle;
pub use sinusoid::Sinusoid;
pub use solid::SolidShape;
pub use solids::Solid;
pub use solids::Solids;
pub use sphere::Sphere;
pub use superquadric::Superquadric;
pub use torus::Torus;
pub use union::Union;

use crate::scene::error::SceneError;
use palpate_numeric::vector::{Vector, scaled};

/// What the fingers touch: a body with its apex at the origin and its free side upwards, then mirrored and posed where
/// that is asked for.
///
/// # Errors
/// The constructors take any numbers. [`Surface::check`], which [`World::compile`](crate::scene::World::compile) calls,
/// names the first that is out of range, as a scene file would.
///
/// ```
/// # use palpate_world::facade as palpate;
/// use palpate::scene::Surface;
///
/// // a groove at 45 degrees: the cylinder seen from inside
/// let groove = Surface::cylinder(10.0).turned(45.0).concave();
/// let lowest = groove.at(0.0, 0.0).unwrap();
/// assert_eq!(lowest.local.shape_index(), Some(-0.5));
///
/// let wrong = Surface::torus(2.0, 3.0).check().unwrap_err();
/// assert!(wrong.to_string().contains("the tube is thinner than the ring is wide"));
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Surface {
    /// Its shape, apex at the body's origin.
    pub body: Body,
    /// Mirrored, z to -z, before it is posed.
    pub concave: bool,
    /// Rotation and offset.
    pub pose: Pose,
}

/// A point of a surface with all that is true there.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The point, input units.
    pub point: [f64; 3],
    /// Normal and curvatures there.
    pub local: Local,
}

impl Surface {
    /// A convex body at the origin, rotated by `axis_deg` about z.
    pub fn new(body: Body, axis_deg: f64) -> Surface {
        Surface { body, concave: false, pose: Pose::new(axis_deg, [0.0; 3], [0.0; 3]) }
    }

    /// Checks that every number of the surface is in its range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), SceneError> {
        self.body.geometry().check()
    }

    /// The same body seen from inside: mirrored, z to -z, before it is posed.
    pub fn concave(mut self) -> Surface {
        self.concave = true;
        self
    }

    /// The same body rotated by `axis_deg` about z, degrees from +x towards +y; a cylinder's generators point there.
    pub fn turned(self, axis_deg: f64) -> Surface {
        self.posed(axis_deg, [0.0; 3], [0.0; 3])
    }

    /// The same body in another place: rotated by `axis_deg` about its own z axis, then by `rotation_deg` about the fixed
    /// axes x, y, z in that order, degrees, then moved by `offset`, input units. It replaces what was asked for before.
    pub fn posed(self, axis_deg: f64, rotation_deg: [f64; 3], offset: [f64; 3]) -> Surface {
        Surface { pose: Pose::new(axis_deg, rotation_deg, offset), ..self }
    }

    /// Height over (x, y), input units; `None` where the surface does not reach.
    #[inline]
    pub fn height(&self, x: f64, y: f64) -> Option<f64> {
        if self.pose.upright() {
            let body = self.pose.to_body([x, y, 0.0]);
            let height = self.body.height(body[0], body[1])?;
            Some(self.pose.lift() + if self.concave { -height } else { height })
        } else {
            self.tilted_height(x, y)
        }
    }

    fn tilted_height(&self, x: f64, y: f64) -> Option<f64> {
        self.hit([x, y, 0.0], [0.0, 0.0, 1.0])
    }

    /// Parameter of the uppermost point along `o + t d`, d pointing to the free side.
    pub(crate) fn hit(&self, o: Vector, d: Vector) -> Option<f64> {
        let origin = self.pose.to_body(o);
        let direction = self.pose.direction_to_body(d);
        if self.concave {
            // the mirrored line, run in the opposite direction
            let mirrored = [-direction[0], -direction[1], direction[2]];
            self.body.geometry().hit([origin[0], origin[1], -origin[2]], mirrored).map(|t| -t)
        } else {
            self.body.geometry().hit(origin, direction)
        }
    }

    /// Normal and curvatures at a point of the surface; `None` where there are none.
    #[inline]
    pub fn local(&self, point: [f64; 3]) -> Option<Local> {
        let mut body = self.pose.to_body(point);
        if self.concave {
            body[2] = -body[2];
        }
        let mut local = self.body.local(body)?;
        if self.concave {
            local = Local {
                normal: [-local.normal[0], -local.normal[1], local.normal[2]],
                k1: -local.k2,
                k2: -local.k1,
                difference: local.difference,
            };
        }
        local.normal = self.pose.direction_to_world(local.normal);
        Some(local)
    }

    /// The point over (x, y) with its truth; `None` where the surface does not reach or has no normal.
    #[inline]
    pub fn at(&self, x: f64, y: f64) -> Option<SurfacePoint> {
        let point = [x, y, self.height(x, y)?];
        Some(SurfacePoint { point, local: self.local(point)? })
    }

    /// The point at `across` (length along a cylinder, degrees round a torus) and `angle_deg` round it from its top;
    /// `None` for bodies that fingers cannot go round.
    pub fn around(&self, across: f64, angle_deg: f64) -> Option<SurfacePoint> {
        let mut body = self.body.geometry().around(across, angle_deg.to_radians())?;
        if self.concave {
            body[2] = -body[2];
        }
        let point = self.pose.to_world(body);
        Some(SurfacePoint { point, local: self.local(point)? })
    }

    /// Points `spacing` apart all over a body of solids, those that `eye` sees where there is one; `None` for other bodies.
    pub(crate) fn scan(&self, spacing: f64, eye: Option<Vector>) -> Option<Vec<SurfacePoint>> {
        if self.concave {
            return None;
        }
        let mut points = self.body.geometry().scan(spacing, eye.map(|eye| self.pose.to_body(eye)))?;
        for found in &mut points {
            found.point = self.pose.to_world(found.point);
            found.local.normal = self.pose.direction_to_world(found.local.normal);
        }
        Some(points)
    }

    /// The face of a body of solids that a point of it lies on, and the kinds of all its faces.
    pub(crate) fn face_at(&self, point: Vector) -> Option<usize> {
        match &self.body {
            Body::Solids(solids) => solids.face_at(self.pose.to_body(point)),
            _ => None,
        }
    }

    /// The point of a cylinder or torus nearest to `point`; `None` for other bodies, and where many are as near.
    pub(crate) fn nearest_around(&self, point: Vector) -> Option<SurfacePoint> {
        let mut body = self.pose.to_body(point);
        if self.concave {
            body[2] = -body[2];
        }
        let [across, angle] = self.body.geometry().nearest(body)?;
        self.around(across, angle.to_degrees())
    }

    /// The label of an imported surface, here or in a union: scenes with one are an inverse crime and say so.
    pub fn inverse_crime(&self) -> Option<&str> {
        match &self.body {
            Body::Imported(surface) if surface.is_fit() => Some(surface.label()),
            Body::Union(union) => union.parts.iter().find_map(Surface::inverse_crime),
            _ => None,
        }
    }

    /// The smallest size that would reach (x, y), for bodies with one: `(name, needed)`.
    pub(crate) fn needed(&self, x: f64, y: f64) -> Option<(&'static str, f64)> {
        if !self.pose.upright() {
            return None;
        }
        let body = self.pose.to_body([x, y, 0.0]);
        self.body.geometry().needed(body[0], body[1])
    }
}

impl SurfacePoint {
    /// The centre of a spherical tip of this radius that touches here.
    pub(crate) fn tip_centre(&self, radius: f64) -> Vector {
        let reach = scaled(radius, self.local.normal);
        [self.point[0] + reach[0], self.point[1] + reach[1], self.point[2] + reach[2]]
    }
}
