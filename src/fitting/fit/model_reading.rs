//! S and R of the same points as another kind of surface has them. Rooms above the fit provide it; the shape counts it.
//!
//! ```text
//! total interval = hull of [mean - k u_noise, mean + k u_noise] and of the other reading
//! ```

use palpate_geometry::curvature::ShapeClass;

/// Intervals of S and R over the fit's points, from surfaces of other kinds.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// The likeliest kind, as part of a sentence.
    pub name: &'static str,
    /// Interval of S at the level of the options; `None` on a plane.
    pub shape_index: Option<[f64; 2]>,
    /// Interval of R, input units.
    pub curvedness: [f64; 2],
    /// Sd of errors that neighbouring contacts share, and the distance over which they fade, input units.
    pub shared: Option<[f64; 2]>,
    /// Seed of the draws behind it; `None` without draws.
    pub seed: Option<u64>,
    /// Probability of every class.
    pub classes: Vec<(ShapeClass, f64)>,
}

impl Reading {
    /// The hull of two readings; their classes are equally likely. It is named after the first.
    pub fn or(self, other: Reading) -> Reading {
        let hull = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let share = |list: &[(ShapeClass, f64)], class| list.iter().find(|(c, _)| *c == class).map_or(0.0, |(_, p)| *p);
        let all = ShapeClass::CURVED.into_iter().chain([ShapeClass::Plane]);
        let both = all.map(|class| (class, 0.5 * (share(&self.classes, class) + share(&other.classes, class))));
        Reading {
            name: self.name,
            shape_index: self
                .shape_index
                .zip(other.shape_index)
                .map(|(a, b)| hull(a, b))
                .or(self.shape_index)
                .or(other.shape_index),
            curvedness: hull(self.curvedness, other.curvedness),
            shared: self.shared.or(other.shared),
            seed: self.seed.or(other.seed),
            classes: both.collect(),
        }
    }
}

/// Whether another kind of surface was asked, and what it said.
#[derive(Clone, Debug, PartialEq)]
pub enum ModelReading {
    /// It was not; intervals count noise alone.
    NotAsked,
    /// It was, and cannot say; intervals count noise alone.
    Unknown {
        /// Why.
        why: String,
    },
    /// It was, and intervals cover what it says.
    Found(Reading),
}

impl ModelReading {
    /// What it said.
    pub fn found(&self) -> Option<&Reading> {
        match self {
            ModelReading::Found(reading) => Some(reading),
            ModelReading::NotAsked | ModelReading::Unknown { .. } => None,
        }
    }
}
