//! A height field as a page shows it.
//!
//! ```text
//! Q = A' (x, y, S(x, y))       residual = z - S(x, y), along the frame's z axis       net: Greville abscissae, coefficients
//! ```

use crate::io::{Input, PointUncertainty, UncertaintyMap};
use palpate_fitting::fit::Fit;
use palpate_geometry::contact::Frame;
use palpate_geometry::shape::ShapeMaps;
use palpate_geometry::surface::{HeightField, Heights};
use palpate_hierarchical::field::HierarchicalField;

use super::adaptive_answer::AdaptiveAnswer;
use super::surface_view::{ContactsView, Standing, SurfaceView, Vector, between};

/// Uncertainties of a map where no fit is at hand.
const NOT_SAVED: &str = "not saved with the surface";
const DECLINED: &str = "declined (--bare)";
const TOO_LONG: &str = "not computed point by point: the contacts leave nothing to tell noise from, or they are so many that \
     it would take longer than the fit";
const FROM_NOISE_AND_SMOOTHING: &str = "from noise, and from what smoothing takes away";
const NOISE_ALONE: &str = "from noise alone, if this kind of surface is right";

/// Points a side at which uncertainties are asked for; the coarser grid where the finer one would take too long.
const SIDES: [usize; 2] = [25, 7];

/// The view of a height field along the axes of `frame`; `fitted` is its fit, where there is one, with its input and whether
/// its uncertainties are wanted.
pub(super) fn height_view(
    surface: &HeightField,
    frame: &Frame,
    maps: &ShapeMaps,
    fitted: Option<(&Fit, &Input, bool)>,
) -> SurfaceView {
    let back = |p: Vector| if frame.keeps_axes() { p } else { frame.rotate_back(p) };
    let knots = surface.knots();
    let [gx, gy] = [knots[0].greville(), knots[1].greville()];
    let net = surface.coefficients().indexed_iter().map(|((i, j), c)| back([gx[i], gy[j], *c]));
    let (uncertainty, uncertainty_words) = uncertainty(maps, fitted);
    SurfaceView {
        uncertainty,
        uncertainty_words,
        net: ([gx.len(), gy.len()], net.collect()),
        contacts: fitted.map(|(_, input, _)| contacts(surface, frame, input, &|_| false)),
        ..bare_view(frame, maps)
    }
}

/// The view of a surface with knots where the contacts asked for them, with what is known of its uncertainty, and the contacts of its
/// fit with those that were left out.
pub(super) fn adaptive_view(
    surface: &HierarchicalField,
    maps: &ShapeMaps,
    known: Option<&UncertaintyMap>,
    fitted: Option<(&AdaptiveAnswer, &Input)>,
) -> SurfaceView {
    let of = |pick: fn(&PointUncertainty) -> Option<f64>| -> Option<Vec<f64>> {
        let at = |((i, j), supported): ((usize, usize), &bool)| {
            let value = known.filter(|_| *supported).and_then(|map| pick(&map.at([maps.grid.x[i], maps.grid.y[j]])));
            value.unwrap_or(f64::NAN)
        };
        known.map(|_| maps.supported.indexed_iter().map(at).collect())
    };
    let [s, r] = [of(|u| u.shape_index), of(|u| u.curvedness)];
    let standing = |(answer, input): (&AdaptiveAnswer, &Input)| {
        contacts(surface, &Frame::IDENTITY, input, &|contact| answer.left_out(contact))
    };
    SurfaceView {
        uncertainty: s.zip(r).map(|(s, r)| [s, r]),
        uncertainty_words: if known.is_some() { FROM_NOISE_AND_SMOOTHING } else { DECLINED },
        contacts: fitted.map(standing),
        ..bare_view(&Frame::IDENTITY, maps)
    }
}

/// The maps alone.
fn bare_view(frame: &Frame, maps: &ShapeMaps) -> SurfaceView {
    let back = |p: Vector| if frame.keeps_axes() { p } else { frame.rotate_back(p) };
    let (grid, points) = (&maps.grid, &maps.points);
    let at = |(i, j): (usize, usize)| back([grid.x[i], grid.y[j], points[[i, j]].z]);
    let places = || maps.supported.indexed_iter().map(|(at, _)| at);
    let value = |v: Option<f64>| v.unwrap_or(f64::NAN);
    SurfaceView {
        axes: ["x", "y"],
        places: [grid.x.clone(), grid.y.clone()],
        points: points.indexed_iter().map(|(place, _)| at(place)).collect(),
        normals: points.iter().map(|p| back(p.normal())).collect(),
        shape_index: places().map(|(i, j)| value(maps.shape_index_at(i, j))).collect(),
        curvedness: places().map(|(i, j)| value(maps.curvedness_at(i, j))).collect(),
        ..SurfaceView::default()
    }
}

fn contacts(surface: &dyn Heights, frame: &Frame, input: &Input, left_out: &dyn Fn(usize) -> bool) -> ContactsView {
    let measured = if frame.keeps_axes() { "along z" } else { "along the patch's own z axis" };
    ContactsView::new(input, measured, |number, point| {
        let [x, y, z] = if frame.keeps_axes() { point } else { frame.rotate(point) };
        let height = surface.height_at(x, y).z;
        let foot = [x, y, height];
        let foot = if frame.keeps_axes() { foot } else { frame.rotate_back(foot) };
        Standing { place: [x, y], foot, residual: z - height, left_out: left_out(number) }
    })
}

type Uncertainty = (Option<[Vec<f64>; 2]>, &'static str);

fn uncertainty(maps: &ShapeMaps, fitted: Option<(&Fit, &Input, bool)>) -> Uncertainty {
    let Some((fit, _, wanted)) = fitted else { return (None, NOT_SAVED) };
    if !wanted {
        return (None, DECLINED);
    }
    let coarse = SIDES.into_iter().find_map(|side| Some((side, fit.pointwise(side)?)));
    let Some((side, coarse)) = coarse else { return (None, TOO_LONG) };
    let (n, m) = maps.supported.dim();
    let share = |k: usize, count: usize| if count < 2 { 0.5 } else { k as f64 / (count - 1) as f64 };
    let of = |values: Vec<f64>| {
        let at = |((i, j), supported): ((usize, usize), &bool)| {
            if *supported { between(&values, [side; 2], [share(i, n), share(j, m)]) } else { f64::NAN }
        };
        maps.supported.indexed_iter().map(at).collect()
    };
    let s = of(coarse.iter().map(|sds| sds.shape_index.unwrap_or(f64::NAN)).collect());
    let r = of(coarse.iter().map(|sds| sds.curvedness.unwrap_or(f64::NAN)).collect());
    (Some([s, r]), NOISE_ALONE)
}
