//! The fitted surface: `S(x, y) = sum_ij c_ij N_i(x) M_j(y)`, its derivatives, tangents and unit normal.
//!
//! Paper Eq. 5. A height field is the map `Q(x, y) = (x, y, S(x, y))`; curvature is written for any Q
//! ([`crate::curvature::Derivatives`]), so a [`Parametric`] surface, which may be vertical or closed, is a second type beside it.
//! What asks neither which of the two it has before it takes a [`Surface`].

mod height_field;
mod jet;
mod parametric;
mod rows;
#[cfg(feature = "serde")]
mod saved;

pub use height_field::{HeightCoefficients, HeightField, SurfacePoint};
pub use jet::{AlongAxes, Heights, Jet, Surface};
pub use parametric::{Parametric, ParametricPoint};
pub use rows::CurvatureGrid;
pub use rows::pieces_of;
