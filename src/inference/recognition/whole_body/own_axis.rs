//! The axis of a primitive in space, and its sizes, each with its interval over the draws of its kind.
//!
//! ```text
//! cylinder, cone, torus     what it is turned about
//! ellipsoid                 the longest of its half axes
//! within                    the angle that so large a share of the draws keep to it
//! ```

use palpate_numeric::vector::{Vector, cross, dot, norm};

use crate::bodies::{DrawnBase, spread};
use crate::primitives::placed::{PartKind, Primitive};
use crate::recognition::Remark;

/// The axis of a primitive, where its kind has one.
pub(super) fn axis_of(primitive: &Primitive) -> Option<Vector> {
    match primitive.kind {
        PartKind::Cylinder | PartKind::Cone | PartKind::Torus => Some(primitive.axes[2]),
        PartKind::Ellipsoid => {
            let longest = (0..3).max_by(|a, b| primitive.sizes[*a].total_cmp(&primitive.sizes[*b]));
            longest.map(|k| primitive.axes[k])
        }
        PartKind::Plane | PartKind::Sphere | PartKind::Patch => None,
    }
}

/// The likeliest primitive, the draws of its kind, and the level and unit in which they are told.
pub(super) struct DrawnPrimitive<'a> {
    pub(super) likeliest: &'a Primitive,
    pub(super) draws: &'a [DrawnBase],
    pub(super) level: f64,
    /// Length of a unit.
    pub(super) scale: f64,
    /// Whether it is the base of a free surface, whose axis is that of its symmetry.
    pub(super) is_free: bool,
}

impl DrawnPrimitive<'_> {
    fn own(&self) -> impl Iterator<Item = &DrawnBase> {
        self.draws.iter().filter(|d| d.primitive.kind == self.likeliest.kind)
    }

    /// Angle, degrees, that the axes of so large a share of the draws keep within.
    pub(super) fn axis_within(&self, axis: Vector) -> f64 {
        let own = |p: &Primitive| if self.is_free { p.axes[2] } else { axis_of(p).unwrap_or(p.axes[2]) };
        let angle = |d: &DrawnBase| {
            let drawn = own(&d.primitive);
            norm(cross(drawn, axis)).atan2(dot(drawn, axis).abs())
        };
        let mut angles: Vec<f64> = self.own().map(angle).collect();
        angles.sort_by(f64::total_cmp);
        let number = ((self.level * angles.len() as f64) as usize).min(angles.len().saturating_sub(1));
        angles.get(number).map_or(90.0, |a| a.to_degrees())
    }

    /// A number of the likeliest primitive, with its interval over the draws of that kind.
    fn bounded(&self, of: impl Fn(&Primitive) -> f64) -> [f64; 3] {
        let values: Vec<(f64, f64)> = self.own().map(|d| (of(&d.primitive), d.share)).collect();
        let value = of(self.likeliest);
        let [lo, hi] = spread(&values, self.level).map_or([value; 2], |s| s.interval);
        [value.clamp(lo, hi), lo, hi]
    }

    /// Radius, or another of the lengths that fix the likeliest primitive, with its interval.
    pub(super) fn length(&self, number: usize) -> [f64; 3] {
        self.bounded(|p| p.sizes[number] * self.scale)
    }

    /// Sizes of a primitive that has more than one, in words.
    pub(super) fn sizes(&self) -> Option<Remark> {
        match self.likeliest.kind {
            PartKind::Cone => {
                let half_angle_deg = self.bounded(|p| p.sizes[1].abs().to_degrees());
                Some(Remark::ConeIs { half_angle_deg })
            }
            PartKind::Torus => {
                let [ring, tube] = [0, 1].map(|k| self.length(k));
                Some(Remark::RingIs { ring, tube })
            }
            PartKind::Ellipsoid => {
                let longest = |p: &Primitive, number: usize| {
                    let mut sizes = p.sizes;
                    sizes.sort_by(|a, b| b.total_cmp(a));
                    sizes[number] * self.scale
                };
                let half_axes = [0, 1, 2].map(|k| self.bounded(|p| longest(p, k)));
                Some(Remark::EllipsoidIs { half_axes })
            }
            PartKind::Plane | PartKind::Sphere | PartKind::Cylinder | PartKind::Patch => None,
        }
    }
}
