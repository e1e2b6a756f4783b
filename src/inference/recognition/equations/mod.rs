//! What was measured, as linear equations about fitted surfaces.
//!
//! ```text
//! y + J x + Z z = e        y: residuals, x: steps of the kind's parameters, z: weights of the displacement's columns, e: errors
//! ```
//!
//! `rows.rs` makes y, J and Z, `moved.rs` changes them where they stand about a displaced surface, and `reduced.rs` eliminates z.

mod linearisation_point;
mod reduced;
mod rows;

pub(crate) use linearisation_point::{Moved, slopes};
pub(crate) use reduced::{Columns, Grams, Reduced, joint, reduced, reduced_in_cells};
pub(crate) use rows::{Rows, column_of, first_of_displacement};
