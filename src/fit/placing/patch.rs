//! The patch: its frame, and the knots in patch coordinates and in input units.
//!
//! ```text
//! p = A (P - origin) / scale        scale = half the domain's larger side, so that presets of weights mean what they say
//! ```

use crate::bspline::Knots;
use crate::contact::Frame;
use crate::fit::{FitError, FitOptions};

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
        Ok(Patch { frame: Frame { origin, axes, scale }, knots, input_knots, side })
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
pub(crate) fn mid_range(z: &[f64]) -> f64 {
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
