//! What a caller may say to a recognition; everything else is taken from the data.

use crate::bodies::Tuning;
use palpate_numeric::vector::Vector;

/// Options of [`Recognition::of`](super::Recognition::of). The defaults serve a user who names nothing.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RecognitionOptions {
    /// Level of the intervals.
    pub level: f64,
    /// Points of the map in the two directions of the chart.
    pub grid: [usize; 2],
    /// Fraction of each side of the map that is cut at every edge, 0 to below 1/2; means are taken over what is left.
    #[cfg_attr(feature = "serde", serde(default))]
    pub inset: f64,
    /// Seed of the posterior draws.
    pub seed: u64,
    /// Whether the normals may serve as data; without them they are not even looked at.
    pub use_normals: bool,
    /// Where the sensor stood: the free side of the surface is the side that it sees. Input coordinates.
    pub viewpoint: Option<[f64; 3]>,
    /// Direction of the free side, for contacts without normals. Input axes.
    pub up: Option<[f64; 3]>,
    /// Known sd of the contacts' errors in x and in y, input units and axes; 0 where they err alike in all directions.
    pub sigma_xy: f64,
    /// What decides how hypotheses are judged.
    #[cfg_attr(feature = "serde", serde(default))]
    pub tuning: Tuning,
}

impl Default for RecognitionOptions {
    fn default() -> RecognitionOptions {
        RecognitionOptions {
            level: 0.95,
            grid: [8, 8],
            inset: 0.0,
            seed: 1,
            use_normals: true,
            viewpoint: None,
            up: None,
            sigma_xy: 0.0,
            tuning: Tuning::default(),
        }
    }
}

impl RecognitionOptions {
    /// The same options with intervals of another level, between 0 and 1.
    pub fn with_level(self, level: f64) -> RecognitionOptions {
        RecognitionOptions { level, ..self }
    }

    /// The same options with a map of another size.
    pub fn with_grid(self, grid: [usize; 2]) -> RecognitionOptions {
        RecognitionOptions { grid, ..self }
    }

    /// The same options with this fraction of each side of the map cut at every edge.
    pub fn with_inset(self, inset: f64) -> RecognitionOptions {
        RecognitionOptions { inset, ..self }
    }

    /// The same options with another seed of the posterior draws.
    pub fn with_seed(self, seed: u64) -> RecognitionOptions {
        RecognitionOptions { seed, ..self }
    }

    /// The same options, but normals are used or ignored.
    pub fn with_normals_used(self, use_normals: bool) -> RecognitionOptions {
        RecognitionOptions { use_normals, ..self }
    }

    /// The same options with the sensor's place, which lies on the free side.
    pub fn with_viewpoint(self, viewpoint: [f64; 3]) -> RecognitionOptions {
        RecognitionOptions { viewpoint: Some(viewpoint), ..self }
    }

    /// The same options with the direction of the free side.
    pub fn with_up(self, up: [f64; 3]) -> RecognitionOptions {
        RecognitionOptions { up: Some(up), ..self }
    }

    /// The same options with a known sd of the errors in x and in y, input units.
    pub fn with_sigma_xy(self, sigma_xy: f64) -> RecognitionOptions {
        RecognitionOptions { sigma_xy, ..self }
    }
}

/// Places that a caller asks about.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RequestedPlaces<'a> {
    /// Where S and R are averaged, input coordinates; `None` is where contacts support the surface.
    pub(super) means: Option<&'a [Vector]>,
    /// Where touches are predicted, x and y of the input.
    pub(super) touches: &'a [[f64; 2]],
}
