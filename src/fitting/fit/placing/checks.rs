//! What a height field asks of the places of its contacts: inside the given domain, and not all on one line.

use crate::fit::{FitError, FitOptions, OutsideDomain};
use palpate_geometry::contact::Contacts;

/// The first contact outside a given domain, as an error.
///
/// # Errors
/// [`FitError::Outside`].
pub(super) fn check_inside(contacts: &Contacts, options: &FitOptions) -> Result<(), FitError> {
    let Some(domain) = options.domain.filter(|_| options.outside == OutsideDomain::Refuse) else { return Ok(()) };
    for index in 0..contacts.len() {
        let (x, y) = (contacts.x[index], contacts.y[index]);
        if x < domain[0] || x > domain[1] || y < domain[2] || y > domain[3] {
            return Err(FitError::Outside { index, x, y, domain });
        }
    }
    Ok(())
}

/// Contacts span a patch unless x and y are correlated to within rounding.
///
/// # Errors
/// [`FitError::Collinear`].
pub(super) fn check_not_collinear(contacts: &Contacts) -> Result<(), FitError> {
    let n = contacts.len() as f64;
    let [mx, my] = [&contacts.x, &contacts.y].map(|v| v.iter().map(|a| a / n).sum::<f64>());
    let (hx, hy) = contacts
        .x
        .iter()
        .zip(&contacts.y)
        .fold((0.0_f64, 0.0_f64), |(hx, hy), (x, y)| (hx.max((x - mx).abs()), hy.max((y - my).abs())));
    if hx == 0.0 || hy == 0.0 {
        return Err(FitError::Collinear { contacts: contacts.len() });
    }
    // each axis is divided by its own extent: a patch with sides of 1e6 : 1 is allowed, a diagonal line is not
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in contacts.x.iter().zip(&contacts.y) {
        let (u, v) = ((x - mx) / hx, (y - my) / hy);
        (xx, xy, yy) = (xx + u * u, xy + u * v, yy + v * v);
    }
    let correlation = xy / (xx * yy).sqrt();
    if 1.0 - correlation.abs() < 1e-14 { Err(FitError::Collinear { contacts: contacts.len() }) } else { Ok(()) }
}
