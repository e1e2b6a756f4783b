//! Why a cloud cannot be cut into parts, with what would help.

use palpate_geometry::contact::{ContactError, counted};

/// A cloud that has no parts to tell.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartsError {
    /// The contacts themselves are faulty.
    #[error(transparent)]
    Contacts(#[from] ContactError),
    /// Too few contacts.
    #[error(
        "{} cannot be cut into parts: each part is judged by the neighbourhoods of its contacts, which takes at least {needed}; \
         touch more densely, or describe the whole by one surface",
        counted(*contacts, "contact")
    )]
    TooFew {
        /// Those that are there.
        contacts: usize,
        /// Those that it takes.
        needed: usize,
    },
    /// All contacts lie in one place, or so far apart that their distances overflow.
    #[error("the contacts have no extent: they lie in one place, or their distances overflow")]
    NoExtent,
    /// Neighbouring normals have nothing to do with each other.
    #[error(
        "neighbouring normals point all ways, so they are no normals of a surface; leave them out, and they are estimated from the positions"
    )]
    Normals,
    /// The contacts lie on no surface.
    #[error(
        "the contacts fill a volume, as leaves or random places do: around each of them their number grows with the power {power:.1} of the \
         distance, on surfaces with 2, so that there is nothing to cut"
    )]
    Volume {
        /// That power, at most 3.
        power: f64,
    },
    /// An option is out of its range.
    #[error("{option} = {value}: {expected}")]
    Option {
        /// Its name.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
}
