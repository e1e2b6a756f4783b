//! What is wrong with a world, with the numbers that contradict each other. Everything is checked before anything is
//! simulated.

/// A world that cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A number is outside its range.
    #[error("{key} = {value}: {expected}")]
    Range {
        /// Key as in a scene file.
        key: String,
        /// Its value.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// A list is empty or has the wrong content.
    #[error("{key}: {expected}")]
    List {
        /// Key as in a scene file.
        key: String,
        /// What would be right.
        expected: &'static str,
    },
    /// An effect stands twice.
    #[error("effect {effect} stands twice; each effect can be applied once")]
    Twice {
        /// Its name.
        effect: &'static str,
    },
    /// Two keys contradict each other.
    #[error("{first} and {second} contradict each other: {why}")]
    Clash {
        /// One key with its value.
        first: String,
        /// The other with its value.
        second: String,
        /// Why not both.
        why: String,
    },
    /// A finger cannot touch the surface where it should.
    #[error(
        "finger {finger}, station {station} at ({x}, {y}) does not reach the {kind}{hint}; {reachable} of {total} sites are reachable \
         (sweep.unreachable = \"skip\" keeps those)"
    )]
    Unreachable {
        /// Finger, counted from 0.
        finger: u32,
        /// Station, counted from 0.
        station: u32,
        /// Where it should touch.
        x: f64,
        /// Where it should touch.
        y: f64,
        /// Kind of the surface.
        kind: &'static str,
        /// What size would do, where that can be said.
        hint: String,
        /// Sites within reach.
        reachable: usize,
        /// Sites of the sweep.
        total: usize,
    },
    /// An indentation would pass the tip's centre.
    #[error(
        "indentation {depth} at force {force} exceeds sweep.tip_radius = {tip_radius}; raise effects.indentation.modulus = {modulus} or lower the force"
    )]
    Indentation {
        /// Depth at the largest force.
        depth: f64,
        /// That force.
        force: f64,
        /// Radius of the tip.
        tip_radius: f64,
        /// Contact modulus.
        modulus: f64,
    },
    /// The arm does not reach a site.
    #[error(
        "the arm of effects.encoder cannot reach finger {finger}, station {station}: it ends {miss} away; its links span {span}, the site is {distance} from its base"
    )]
    Arm {
        /// Finger, counted from 0.
        finger: u32,
        /// Station, counted from 0.
        station: u32,
        /// Distance left.
        miss: f64,
        /// Sum of the links' lengths.
        span: f64,
        /// Distance from the base to the tip's centre.
        distance: f64,
    },
}

impl SceneError {
    pub(crate) fn range(key: impl Into<String>, value: f64, expected: &'static str) -> SceneError {
        SceneError::Range { key: key.into(), value, expected }
    }
}

/// `value` is finite and not negative.
pub(super) fn not_negative(key: &str, value: f64) -> Result<(), SceneError> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(SceneError::range(key, value, "a finite number, zero or more, is needed"))
}

/// `value` is finite and greater than zero.
pub(super) fn positive(key: &str, value: f64) -> Result<(), SceneError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(SceneError::range(key, value, "a finite number greater than zero is needed"))
}

/// `value` is a finite number.
pub(super) fn finite(key: &str, value: f64) -> Result<(), SceneError> {
    if value.is_finite() { Ok(()) } else { Err(SceneError::range(key, value, "a finite number is needed")) }
}

/// `value` is a probability.
pub(super) fn probability(key: &str, value: f64) -> Result<(), SceneError> {
    if (0.0..=1.0).contains(&value) {
        return Ok(());
    }
    Err(SceneError::range(key, value, "a probability, 0 to 1, is needed"))
}

/// Every one of `values` is finite and greater than zero.
pub(super) fn all_positive(key: &str, values: &[f64]) -> Result<(), SceneError> {
    values.iter().try_for_each(|value| positive(key, *value))
}

/// Radii of either sign; an infinite one means no curvature in that direction.
pub(super) fn all_not_zero(key: &str, values: &[f64]) -> Result<(), SceneError> {
    match values.iter().find(|value| **value == 0.0 || value.is_nan()) {
        Some(value) => Err(SceneError::range(key, *value, "a radius of curvature other than zero is needed")),
        None => Ok(()),
    }
}
