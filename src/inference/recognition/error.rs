//! Why a recognition refuses to answer, with what would help.

use palpate_geometry::contact::{ContactError, counted};

/// Data or options from which no shape is recognised.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecognitionError {
    /// The contacts themselves are faulty.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// An option lies outside of its range.
    #[error("{option} is {value}; {expected}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// What was given.
        value: String,
        /// What is taken.
        expected: &'static str,
    },
    /// Too few contacts to tell curvature from noise.
    #[error("{} {kind} normals cannot tell a shape, which takes at least {needed}", counted(*found, "contact"))]
    TooFew {
        /// Contacts that can be used.
        found: usize,
        /// Contacts needed.
        needed: usize,
        /// `with` or `without`.
        kind: &'static str,
    },
    /// All contacts lie on one line, or at one place.
    #[error(
        "the contacts lie {}: a shape needs contacts beside the line", narrow(*across, *along)
    )]
    Collinear {
        /// Root mean square spread across the line, input units.
        across: f64,
        /// Root mean square spread along the line, input units.
        along: f64,
    },
    /// Places without normals, all of them on one ring, ellipse or pair of lines.
    #[error(
        "the contacts lie on a ring, in two rows or on a narrow strip, and without normals they do not tell how the surface bends: touch it beside them, too, \
         or give the normals"
    )]
    OnConic,
    /// The contacts do not form one sheet: several surfaces, a closed body or a scene with background.
    #[error(
        "the contacts are not one sheet of a simple shape: the best surface misses them by {misfit:.0} % of their relief and {outliers:.0} % lie far off it. \
         Take one part of it, or describe it as a closed body or as several parts"
    )]
    NotOneSheet {
        /// Root mean square misfit of the best surface in percent of the relief.
        misfit: f64,
        /// Share of contacts far off the best surface, percent.
        outliers: f64,
    },
    /// The contacts go around more than half a body, as the normals tell, or the surface through positions that have none.
    #[error("{}. Take one side of it, or describe it as a closed body", around(*mean_length, *measured))]
    AllAround {
        /// Length of the mean unit normal.
        mean_length: f64,
        /// Whether the normals were given; otherwise they are those of the surface through the positions.
        measured: bool,
    },
    /// Several surfaces explain the contacts clearly better than one.
    #[error("the contacts show several things: {}", listed(things, percent))]
    SeveralThings {
        /// All of them in words, with their radius.
        things: Vec<String>,
        /// Their share of the contacts, percent.
        percent: Vec<f64>,
        /// Root mean square scatter of the contacts about them, input units.
        misfit: f64,
    },
    /// The normals agree with the places once their columns are exchanged or reversed.
    #[error(
        "the normals contradict the places, and agree with them where nx, ny, nz are read as {order}: the columns seem to be exchanged"
    )]
    NormalsExchanged {
        /// The order that agrees, as `nz, ny, nx`.
        order: String,
    },
    /// A number left the range of the arithmetic.
    #[error("the {step} failed: {what}")]
    Arithmetic {
        /// Step of the procedure.
        step: &'static str,
        /// What went wrong.
        what: &'static str,
    },
}

/// Things with their shares; of many the largest.
pub(super) fn listed(things: &[String], percent: &[f64]) -> String {
    const LISTED: usize = 4;
    let each = |(number, (thing, share)): (usize, (&String, &f64))| {
        let of_them = if number == 0 { " of them" } else { "" };
        format!("{thing} ({share:.0} %{of_them})")
    };
    let mut all: Vec<String> = things.iter().zip(percent).enumerate().map(each).collect();
    if all.len() > LISTED {
        let more = all.len() - LISTED + 1;
        all.truncate(LISTED - 1);
        all.push(format!("{more} more"));
    }
    let last = all.pop().unwrap_or_default();
    if all.is_empty() { last } else { format!("{} and {last}", all.join(", ")) }
}

/// That contacts go around a body, and what tells.
fn around(mean_length: f64, measured: bool) -> String {
    let what = "the contacts go around more than half a body";
    if measured {
        format!("the normals point all ways (the mean of the unit normals has length {mean_length:.2}): {what}")
    } else {
        format!("{what} (the mean of the unit normals of the surface through them has length {mean_length:.2})")
    }
}

/// How near to one line the contacts lie.
fn narrow(across: f64, along: f64) -> String {
    match across / along {
        share if share > 0.0 => format!("on one line (their spread across it is {share:.1e} of that along it)"),
        _ if along > 0.0 => "on one line".into(),
        _ => "at one place".into(),
    }
}
