//! The axis of a primitive in space, and its sizes, each with its interval over the draws of its kind.
//!
//! ```text
//! cylinder, cone, torus     what it is turned about
//! ellipsoid                 the longest of its half axes
//! within                    the angle that so large a share of the draws keep to it
//! ```

use palpate_numeric::vector::{Vector, cross, dot, norm};

use super::answer::BodyAnswer;
use crate::bodies::{DrawnBase, drawn, spread};
use crate::primitives::placed::{PartKind, Primitive};
use crate::recognition::Remark;

/// What tells how a primitive lies and how large it is.
pub(super) struct OwnAxis {
    /// `None` of a plane or sphere.
    pub(super) axis: Option<Vector>,
    /// Degrees.
    pub(super) within_deg: Option<f64>,
    /// Sizes of what has more than one.
    pub(super) sizes: Option<Remark>,
}

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

impl BodyAnswer<'_> {
    /// Of one kind among all.
    pub(super) fn own_axis(&self, kind: PartKind) -> Option<OwnAxis> {
        let posterior = self.posterior.reweighed(|other| f64::from(u8::from(other == kind)))?;
        let likeliest = posterior.likeliest(kind)?;
        let draws = drawn(&posterior, &self.options.tuning, self.options.seed);
        let axis = axis_of(&likeliest);
        let within_deg = axis.map(|axis| self.axis_within(axis, &draws, &likeliest));
        Some(OwnAxis { axis, within_deg, sizes: self.sizes(&likeliest, &draws) })
    }

    /// Angle, degrees, that the axes of so large a share of the draws keep within.
    pub(super) fn axis_within(&self, axis: Vector, draws: &[DrawnBase], likeliest: &Primitive) -> f64 {
        // of a free surface that has a symmetry the base's own
        let own = |p: &Primitive| if self.posterior.is_free { p.axes[2] } else { axis_of(p).unwrap_or(p.axes[2]) };
        let angle = |d: &DrawnBase| {
            let drawn = own(&d.primitive);
            norm(cross(drawn, axis)).atan2(dot(drawn, axis).abs())
        };
        let mut angles: Vec<f64> = draws.iter().filter(|d| d.primitive.kind == likeliest.kind).map(angle).collect();
        angles.sort_by(f64::total_cmp);
        let number = ((self.options.level * angles.len() as f64) as usize).min(angles.len().saturating_sub(1));
        angles.get(number).map_or(90.0, |a| a.to_degrees())
    }

    /// A number of the likeliest primitive, with its interval over the draws of that kind.
    fn bounded(&self, likeliest: &Primitive, draws: &[DrawnBase], of: impl Fn(&Primitive) -> f64) -> [f64; 3] {
        let own = draws.iter().filter(|d| d.primitive.kind == likeliest.kind);
        let values: Vec<(f64, f64)> = own.map(|d| (of(&d.primitive), d.share)).collect();
        let value = of(likeliest);
        let [lo, hi] = spread(&values, self.options.level).map_or([value; 2], |s| s.interval);
        [value.clamp(lo, hi), lo, hi]
    }

    /// Radius, or another of the lengths that fix the likeliest primitive, with its interval.
    pub(super) fn length(&self, likeliest: &Primitive, draws: &[DrawnBase], number: usize) -> [f64; 3] {
        self.bounded(likeliest, draws, |p| p.sizes[number] * self.sample.frame.scale)
    }

    /// Sizes of a primitive that has more than one, in words.
    pub(super) fn sizes(&self, likeliest: &Primitive, draws: &[DrawnBase]) -> Option<Remark> {
        match likeliest.kind {
            PartKind::Cone => {
                let half_angle_deg = self.bounded(likeliest, draws, |p| p.sizes[1].abs().to_degrees());
                Some(Remark::ConeIs { half_angle_deg })
            }
            PartKind::Torus => {
                let [ring, tube] = [0, 1].map(|k| self.length(likeliest, draws, k));
                Some(Remark::RingIs { ring, tube })
            }
            PartKind::Ellipsoid => {
                let longest = |p: &Primitive, number: usize| {
                    let mut sizes = p.sizes;
                    sizes.sort_by(|a, b| b.total_cmp(a));
                    sizes[number] * self.sample.frame.scale
                };
                let half_axes = [0, 1, 2].map(|k| self.bounded(likeliest, draws, |p| longest(p, k)));
                Some(Remark::EllipsoidIs { half_axes })
            }
            PartKind::Plane | PartKind::Sphere | PartKind::Cylinder | PartKind::Patch => None,
        }
    }
}
