//! The first step of a fit by itself, for a clock: contacts moved into their patch, and the equations written down.

use std::hint::black_box;

use palpate_geometry::contact::Contacts;

use super::{Equations, FitError, FitOptions, placing};

/// Places the contacts in their patch and throws the answer away.
///
/// # Errors
/// As [`super::fit_contacts`].
pub fn place(contacts: &Contacts, options: &FitOptions) -> Result<(), FitError> {
    options.check()?;
    black_box(placing::place_contacts(contacts, options)?);
    Ok(())
}

/// Writes the normal equations down and throws them away.
pub fn write_down(equations: &Equations) {
    black_box((equations.normal_matrix(), equations.right_side()));
}
