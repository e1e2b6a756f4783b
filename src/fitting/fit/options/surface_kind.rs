//! The kinds of surface that a fit may have, with their words.
//!
//! ```text
//! height  z = S(x, y)          parametric  Q(u, v)          auto  whichever the contacts call for
//! ```

use super::words::listed;

/// Which kind of surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum SurfaceKind {
    /// `z = S(x, y)`.
    #[default]
    Height,
    /// `Q(u, v)`.
    Parametric,
    /// Whichever the contacts call for.
    Auto,
}

words! {
    SurfaceKind { "height" => Height, "parametric" => Parametric, "auto" => Auto }
}
