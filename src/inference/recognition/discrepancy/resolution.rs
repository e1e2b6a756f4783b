//! How finely a displacement may vary over the chart.
//!
//! ```text
//! coarse    5 x 5 segments,  81 coefficients,   smooth processes of lengths 1 and 2 half sides of the chart's box
//! fine      8 x 8 segments, 144 coefficients,   and of length 1/2
//! ```
//!
//! The fine one is asked where a displaced surface is the likeliest, and taken where its evidence is ahead: it follows a wave of more than
//! a length and the top of a bump, and costs one more look of the search. Taken at once it widens what simple shapes may be.

/// Segments of the splines and lengths of the processes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum DepartureResolution {
    #[default]
    Coarse,
    Fine,
}

impl DepartureResolution {
    /// Segments each way. Three are too few for a sum of bumps that is touched with little noise: what they cannot follow is
    /// then taken for shared errors.
    pub(super) fn segments(self) -> usize {
        match self {
            DepartureResolution::Coarse => 5,
            DepartureResolution::Fine => 8,
        }
    }

    /// Whether a smooth process of this length, in half sides of the chart's box, is one of those that are asked.
    pub(super) fn holds(self, length: f64) -> bool {
        self == DepartureResolution::Fine || length >= 1.0
    }
}
