//! Step 2 of the paper: the patch, which is a frame with knots, and the data in it.
//!
//! ```text
//! p = A (P - origin) / scale        scale = half the domain's larger side, so that presets of weights mean what they say
//! ```

pub(super) mod axes;
mod checks;
mod data;
pub(super) mod sites;

use crate::fit::{FitError, FitOptions, FrameChoice, Objective, Robust, SlopeWeights};
use crate::observation::Data;
use checks::{check_inside, check_not_collinear};
use palpate_geometry::contact::{Contacts, Frame, Grid, Orientation, Rounding};
use palpate_numeric::bspline::Knots;

/// Contacts in the patch frame, checked for what a height field can hold.
///
/// # Errors
/// What the contacts' places and normals can have wrong, and the options' knots and domain.
pub(super) fn place_contacts(contacts: &Contacts, options: &FitOptions) -> Result<(Patch, Data), FitError> {
    contacts.check()?;
    place_contacts_over(contacts, choose_axes(contacts, options)?, options)
}

/// The same over axes that are given.
///
/// # Errors
/// Those of [`place_contacts`].
pub(super) fn place_contacts_over(
    contacts: &Contacts,
    axes: [[f64; 3]; 3],
    options: &FitOptions,
) -> Result<(Patch, Data), FitError> {
    contacts.check()?;
    let rotated = rotate(contacts, &axes);
    // without height rows the mean height is set to zero, and that has to be the zero of the user's z
    let origin_z = if has_height_rows(contacts, options) { mid_range(&rotated.z) } else { 0.0 };
    let mut patch = Patch::around([&rotated.x, &rotated.y], origin_z, axes, options)?;
    if options.robust != Robust::None {
        patch.rounding = patch.rounded_by(&Rounding::of_contacts(contacts));
    }
    check_inside(&rotated, options)?;
    check_not_collinear(&rotated)?;
    let data = Data::scattered(shift(rotated, &patch.frame), &patch);
    Ok((patch, data))
}

/// A grid with its patch; its axes are always kept.
///
/// # Errors
/// What the grid's axes can have wrong, and the options' knots and domain.
pub(super) fn place_grid(grid: &Grid, options: &FitOptions) -> Result<(Patch, Data), FitError> {
    grid.check()?;
    if grid.x.len() < 2 || grid.y.len() < 2 {
        return Err(FitError::Collinear { contacts: grid.len() });
    }
    let ends = |axis: &[f64]| [axis[0], axis[axis.len() - 1]];
    let ([x0, x1], [y0, y1]) = (ends(&grid.x), ends(&grid.y));
    if let Some(domain) = options.domain {
        for (x, y) in [(x0, y0), (x1, y1)] {
            if x < domain[0] || x > domain[1] || y < domain[2] || y > domain[3] {
                return Err(FitError::Outside { index: 0, x, y, domain });
            }
        }
    }
    let finite: Vec<f64> = grid.z.iter().copied().filter(|z| z.is_finite()).collect();
    let mut patch = Patch::around([&[x0, x1], &[y0, y1]], mid_range(&finite), Frame::IDENTITY.axes, options)?;
    if options.robust != Robust::None {
        patch.rounding = patch.rounded_by(&Rounding::of_grid(grid));
    }
    let (origin, scale) = (patch.frame.origin[2], patch.frame.scale);
    Ok((patch, Data::Gridded { grid: grid.clone(), origin, scale }))
}

fn has_height_rows(contacts: &Contacts, options: &FitOptions) -> bool {
    let weighted = !matches!(options.objective, Objective::Slopes(SlopeWeights::Explicit([0.0, ..])));
    weighted && contacts.weights.z.as_ref().is_none_or(|weights| weights.iter().any(|w| *w != 0.0))
}

/// The input's axes, or the patch's own where they are asked for and a height field over the input's would be steep or
/// would fold. A domain or knots that are given lie along the input's axes, which are then kept however steep.
fn choose_axes(contacts: &Contacts, options: &FitOptions) -> Result<[[f64; 3]; 3], FitError> {
    let asked = options.frame == Some(FrameChoice::Auto) && options.domain.is_none() && options.knots.is_none();
    let steep = || asked && axes::steepness(contacts).is_some_and(|cosine| cosine < axes::STEEP);
    let Orientation::Normals { nz, .. } = &contacts.orientation else {
        return Ok(if steep() { axes::local_axes(contacts) } else { Frame::IDENTITY.axes });
    };
    if nz.iter().all(|n| *n < 0.0) && options.frame.is_none() {
        return Err(FitError::Inward { contacts: nz.len() });
    }
    if options.frame == Some(FrameChoice::Keep) || (nz.iter().all(|n| *n > 0.0) && !steep()) {
        return Ok(Frame::IDENTITY.axes);
    }
    Ok(axes::local_axes(contacts))
}

fn rotate(contacts: &Contacts, axes: &[[f64; 3]; 3]) -> Contacts {
    if *axes == Frame::IDENTITY.axes {
        return contacts.clone();
    }
    let frame = Frame { axes: *axes, ..Frame::IDENTITY };
    let mut rotated = contacts.clone();
    for r in 0..contacts.len() {
        [rotated.x[r], rotated.y[r], rotated.z[r]] = frame.rotate([contacts.x[r], contacts.y[r], contacts.z[r]]);
    }
    if let Orientation::Normals { nx, ny, nz } = &mut rotated.orientation {
        for r in 0..nx.len() {
            [nx[r], ny[r], nz[r]] = frame.rotate([nx[r], ny[r], nz[r]]);
        }
    }
    rotated
}

/// Rotated contacts moved to the patch's origin and divided by its scale, with normals of length one.
fn shift(mut contacts: Contacts, frame: &Frame) -> Contacts {
    let rotation = Frame { axes: frame.axes, ..Frame::IDENTITY };
    let centre = if frame.keeps_axes() { frame.origin } else { rotation.rotate(frame.origin) };
    for (column, origin) in [(&mut contacts.x, centre[0]), (&mut contacts.y, centre[1]), (&mut contacts.z, centre[2])] {
        column.iter_mut().for_each(|v| *v = (*v - origin) / frame.scale);
    }
    if !matches!(contacts.orientation, Orientation::Normals { .. }) {
        return contacts;
    }
    for r in 0..contacts.len() {
        if let Some(n) = contacts.unit_normal(r)
            && let Orientation::Normals { nx, ny, nz } = &mut contacts.orientation
        {
            [nx[r], ny[r], nz[r]] = n;
        }
    }
    contacts
}

/// Where the patch is: its frame and its knots, in patch coordinates and in input units.
#[derive(Clone, Debug)]
pub struct Patch {
    /// The frame.
    pub frame: Frame,
    /// Knots in patch coordinates.
    pub knots: [Knots; 2],
    /// Knots in input units along the frame's axes; where axes are kept, in the input's own x and y.
    pub input_knots: [Knots; 2],
    /// Larger side of the domain, input units.
    pub side: f64,
    /// Standard deviations by which heights, in patch coordinates, and normals were rounded where they were written: robust scales are not
    /// smaller. 0 where no robust loss asks.
    pub rounding: [f64; 2],
}

impl Patch {
    /// The patch of data with these x and y along `axes`, its heights measured from `origin_z`.
    ///
    /// # Errors
    /// [`FitError::Knots`], [`FitError::Domain`], [`FitError::Collinear`].
    pub fn around(
        [x, y]: [&[f64]; 2],
        origin_z: f64,
        axes: [[f64; 3]; 3],
        options: &FitOptions,
    ) -> Result<Patch, FitError> {
        let input_knots = match &options.knots {
            Some([kx, ky]) => [
                Knots::new(options.degree[0], kx.clone()).map_err(|source| FitError::Knots { axis: "x", source })?,
                Knots::new(options.degree[1], ky.clone()).map_err(|source| FitError::Knots { axis: "y", source })?,
            ],
            None => uniform_knots(x, y, options)?,
        };
        let [dx, dy] = [input_knots[0].domain(), input_knots[1].domain()];
        let side = (dx[1] - dx[0]).max(dy[1] - dy[0]);
        let scale = 0.5 * side;
        let centre = [0.5 * dx[0] + 0.5 * dx[1], 0.5 * dy[0] + 0.5 * dy[1], origin_z];
        let map = |k: &Knots, o: f64, axis| k.mapped(o, scale).map_err(|source| FitError::Knots { axis, source });
        let knots = [map(&input_knots[0], centre[0], "x")?, map(&input_knots[1], centre[1], "y")?];
        let rotation = Frame { axes, ..Frame::IDENTITY };
        let origin = if rotation.keeps_axes() { centre } else { rotation.rotate_back(centre) };
        Ok(Patch { frame: Frame { origin, axes, scale }, knots, input_knots, side, rounding: [0.0; 2] })
    }

    fn rounded_by(&self, written: &Rounding) -> [f64; 2] {
        let up = self.frame.axes[2];
        let square: f64 = up.iter().zip(written.position).map(|(along, sd)| (along * sd).powi(2)).sum();
        [square.sqrt() / self.frame.scale, written.normal]
    }
}

fn uniform_knots(x: &[f64], y: &[f64], options: &FitOptions) -> Result<[Knots; 2], FitError> {
    let [x0, x1, y0, y1] = options.domain.unwrap_or_else(|| {
        let ((x0, x1), (y0, y1)) = (extent(x), extent(y));
        [x0, x1, y0, y1]
    });
    for (axis, k) in [("x", 0), ("y", 1)] {
        // a wrong degree or number of segments is reported as such, also where the domain is wrong too
        Knots::uniform(options.degree[k], options.segments[k], 0.0, 1.0)
            .map_err(|source| FitError::Knots { axis, source })?;
    }
    if !(x0 < x1 && y0 < y1 && (x1 - x0).is_finite() && (y1 - y0).is_finite()) {
        return Err(if options.domain.is_some() {
            FitError::Domain { domain: [x0, x1, y0, y1] }
        } else {
            FitError::Collinear { contacts: x.len() }
        });
    }
    let make = |axis, k: usize, lo, hi| {
        Knots::uniform(options.degree[k], options.segments[k], lo, hi)
            .map_err(|source| FitError::Knots { axis, source })
    };
    Ok([make("x", 0, x0, x1)?, make("y", 1, y0, y1)?])
}

/// Mid-range of the heights, halfway between the lowest and the highest: the origin of z in the patch.
pub(super) fn mid_range(z: &[f64]) -> f64 {
    let (lo, hi) = extent(z);
    if lo <= hi { 0.5 * lo + 0.5 * hi } else { 0.0 }
}

/// Least and largest value. Eight running extents side by side, because one alone waits for its own last result.
fn extent(values: &[f64]) -> (f64, f64) {
    let (mut lo, mut hi) = ([f64::INFINITY; 8], [f64::NEG_INFINITY; 8]);
    let (eights, rest) = values.as_chunks::<8>();
    for eight in eights {
        for (k, v) in eight.iter().enumerate() {
            (lo[k], hi[k]) = (lo[k].min(*v), hi[k].max(*v));
        }
    }
    let ends = lo.into_iter().zip(hi).chain(rest.iter().map(|v| (*v, *v)));
    ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), (a, b)| (lo.min(a), hi.max(b)))
}
