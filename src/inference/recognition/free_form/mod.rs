//! What is asked beyond a recognition: a spline where no simple shape fits, doubt about named models, surfaces to save.
//!
//! ```text
//! shown = the simple shape, or a flexible height field where misfit > 1/4 of the relief, with a pattern
//! ```
//!
//! `model_selection.rs` makes this choice, with `cross_validated_spline.rs` for the field and `principal_axes.rs` for the axes it lies over.
//! `named_model_uncertainty.rs` recognises what a named model was fitted to, so that its interval counts other kinds of surface. `spline.rs` makes of a recognised surface
//! one that can be saved, and `pointwise.rs` gives its uncertainty point by point.

mod cross_validated_spline;
mod line_detail;
mod model_selection;
mod named_model_uncertainty;
mod pointwise;
mod principal_axes;
mod short_waves;
mod spline;

pub(crate) use cross_validated_spline::FieldChoice;
pub use cross_validated_spline::{FieldForm, Flexible, flexible};
pub use model_selection::{FieldRequest, Shown, shown};
pub(crate) use named_model_uncertainty::leaves_much_unsaid;
pub use pointwise::Pointwise;
pub use principal_axes::own_axes;
pub(super) use short_waves::beside_short_waves;
pub use spline::RecognisedSpline;
