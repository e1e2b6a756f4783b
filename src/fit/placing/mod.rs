//! Step 2 of the paper: data in the patch frame, `p = A (P - origin)/scale`, and where they stand under the spline.
//!
//! One length scales all three axes: half the larger side of the domain, so that presets mean what they say.

pub(super) mod axes;

use crate::bspline::Knots;
use crate::contact::{Contacts, Frame, Grid, Orientation};
use crate::fit::{FitError, FitOptions, FrameChoice, Objective, OutsideDomain, SlopeWeights};
use crate::linalg::{Site, Sites, TensorShape};
use crate::observation::{GridSites, ScatteredSites};

/// Sites of a fit; scattered and gridded data stay what they are.
#[derive(Clone, Debug)]
pub enum Observed {
    /// Contacts wherever they fell.
    Scattered(ScatteredSites),
    /// Data on the product of two axes.
    Gridded(GridSites),
}

impl Observed {
    /// Knots in x and y.
    pub fn knots(&self) -> [Knots; 2] {
        match self {
            Observed::Scattered(sites) => sites.knots().clone(),
            Observed::Gridded(sites) => sites.axes().clone().map(|axis| axis.knots),
        }
    }
}

impl Sites for Observed {
    fn shape(&self) -> TensorShape {
        match self {
            Observed::Scattered(sites) => sites.shape(),
            Observed::Gridded(sites) => sites.shape(),
        }
    }

    fn len(&self) -> usize {
        match self {
            Observed::Scattered(sites) => sites.len(),
            Observed::Gridded(sites) => sites.len(),
        }
    }

    fn visit(&self, f: impl FnMut(&Site)) {
        match self {
            Observed::Scattered(sites) => sites.visit(f),
            Observed::Gridded(sites) => sites.visit(f),
        }
    }

    fn visit_cells(&self, f: impl FnMut([usize; 2], &[u32], &[f64])) -> bool {
        match self {
            Observed::Scattered(sites) => sites.visit_cells(f),
            Observed::Gridded(sites) => sites.visit_cells(f),
        }
    }
}

/// Where the patch is: frame, knots in patch coordinates, and the same knots in the frame's unscaled coordinates.
#[derive(Clone, Debug)]
pub struct Patch {
    /// The frame.
    pub frame: Frame,
    /// Knots in patch coordinates.
    pub knots: [Knots; 2],
    /// Knots as the user knows them: input units, from the input's origin when axes are kept.
    pub input_knots: [Knots; 2],
    /// Larger side of the domain, input units.
    pub side: f64,
}

/// Contacts in the patch frame, checked for what a height field can hold.
pub fn place_contacts(contacts: &Contacts, options: &FitOptions) -> Result<(Patch, Contacts), FitError> {
    contacts.check()?;
    let axes = choose_axes(contacts, options)?;
    let turned = turn(contacts, &axes);
    // without height rows the mean height is zero in the user's frame too
    let height = if heights_count(contacts, options) { middle(&turned.z) } else { 0.0 };
    let patch = lay_out(&turned.x, &turned.y, height, axes, options)?;
    check_inside(&turned, options)?;
    check_not_collinear(&turned)?;
    let local = shift(turned, &patch.frame);
    Ok((patch, local))
}

/// The patch of a grid: axes are always kept.
pub fn place_grid(grid: &Grid, options: &FitOptions) -> Result<Patch, FitError> {
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
    lay_out(&[x0, x1], &[y0, y1], middle(&finite), Frame::IDENTITY.axes, options)
}

fn heights_count(contacts: &Contacts, options: &FitOptions) -> bool {
    let block = !matches!(options.objective, Objective::Slopes(SlopeWeights::Explicit([0.0, ..])));
    block && contacts.weights.z.as_ref().is_none_or(|weights| weights.iter().any(|w| *w != 0.0))
}

/// Mean height: "z measured from the patch".
fn middle(z: &[f64]) -> f64 {
    let (lo, hi) = extent(z);
    if lo <= hi { 0.5 * lo + 0.5 * hi } else { 0.0 }
}

/// Eight extents side by side, which do not wait for one another.
fn extent(values: &[f64]) -> (f64, f64) {
    let (mut lo, mut hi) = ([f64::INFINITY; 8], [f64::NEG_INFINITY; 8]);
    let (eights, rest) = values.as_chunks::<8>();
    for eight in eights {
        for (lane, v) in eight.iter().enumerate() {
            (lo[lane], hi[lane]) = (lo[lane].min(*v), hi[lane].max(*v));
        }
    }
    let ends = lo.into_iter().zip(hi).chain(rest.iter().map(|v| (*v, *v)));
    ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), (a, b)| (lo.min(a), hi.max(b)))
}

fn choose_axes(contacts: &Contacts, options: &FitOptions) -> Result<[[f64; 3]; 3], FitError> {
    let Orientation::Normals { nz, .. } = &contacts.orientation else { return Ok(Frame::IDENTITY.axes) };
    if nz.iter().all(|n| *n < 0.0) && options.frame.is_none() {
        return Err(FitError::Inward { contacts: nz.len() });
    }
    if options.frame == Some(FrameChoice::Keep) || nz.iter().all(|n| *n > 0.0) {
        return Ok(Frame::IDENTITY.axes);
    }
    Ok(crate::fit::placing::axes::local_axes(contacts))
}

fn turn(contacts: &Contacts, axes: &[[f64; 3]; 3]) -> Contacts {
    if *axes == Frame::IDENTITY.axes {
        return contacts.clone();
    }
    let frame = Frame { axes: *axes, ..Frame::IDENTITY };
    let mut turned = contacts.clone();
    for r in 0..contacts.len() {
        [turned.x[r], turned.y[r], turned.z[r]] = frame.rotate([contacts.x[r], contacts.y[r], contacts.z[r]]);
    }
    if let Orientation::Normals { nx, ny, nz } = &mut turned.orientation {
        for r in 0..nx.len() {
            [nx[r], ny[r], nz[r]] = frame.rotate([nx[r], ny[r], nz[r]]);
        }
    }
    turned
}

fn lay_out(x: &[f64], y: &[f64], z_middle: f64, axes: [[f64; 3]; 3], options: &FitOptions) -> Result<Patch, FitError> {
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
    let centre = [0.5 * dx[0] + 0.5 * dx[1], 0.5 * dy[0] + 0.5 * dy[1], z_middle];
    let map = |k: &Knots, o: f64, axis| k.mapped(o, scale).map_err(|source| FitError::Knots { axis, source });
    let knots = [map(&input_knots[0], centre[0], "x")?, map(&input_knots[1], centre[1], "y")?];
    let unturned = Frame { axes, ..Frame::IDENTITY };
    let origin = if unturned.keeps_axes() { centre } else { unturned.rotate_back(centre) };
    Ok(Patch { frame: Frame { origin, axes, scale }, knots, input_knots, side })
}

fn uniform_knots(x: &[f64], y: &[f64], options: &FitOptions) -> Result<[Knots; 2], FitError> {
    let [x0, x1, y0, y1] = options.domain.unwrap_or_else(|| {
        let ((x0, x1), (y0, y1)) = (extent(x), extent(y));
        [x0, x1, y0, y1]
    });
    for (axis, k) in [("x", 0), ("y", 1)] {
        // degree and segments are faults of their own, also where the domain is one
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

fn check_inside(contacts: &Contacts, options: &FitOptions) -> Result<(), FitError> {
    let Some(domain) = options.domain.filter(|_| options.outside == OutsideDomain::Refuse) else { return Ok(()) };
    for index in 0..contacts.len() {
        let (x, y) = (contacts.x[index], contacts.y[index]);
        if x < domain[0] || x > domain[1] || y < domain[2] || y > domain[3] {
            return Err(FitError::Outside { index, x, y, domain });
        }
    }
    Ok(())
}

/// Contacts span a patch when the smaller principal spread is not rounding of the larger.
fn check_not_collinear(contacts: &Contacts) -> Result<(), FitError> {
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
    // each axis by its own extent: an aspect of 1e6 : 1 is a patch, a diagonal line is none
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in contacts.x.iter().zip(&contacts.y) {
        let (u, v) = ((x - mx) / hx, (y - my) / hy);
        (xx, xy, yy) = (xx + u * u, xy + u * v, yy + v * v);
    }
    let correlation = xy / (xx * yy).sqrt();
    if 1.0 - correlation.abs() < 1e-14 { Err(FitError::Collinear { contacts: contacts.len() }) } else { Ok(()) }
}

fn shift(mut contacts: Contacts, frame: &Frame) -> Contacts {
    let unturned = Frame { axes: frame.axes, ..Frame::IDENTITY };
    let centre = if frame.keeps_axes() { frame.origin } else { unturned.rotate(frame.origin) };
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
