//! What a description of a surface consists of, whatever kind of surface it is, and what the kinds have in common.
//!
//! ```text
//! a fit, or a saved surface   ->   Description: document, maps as CSV and NPZ, picture
//! ```

use std::borrow::Cow;
use std::io::Write;
use std::path::Path;

use crate::io::Input;
use palpate_fitting::fit::Statistic;
use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::shape::{ShapeMaps, Spread, radius_of};
use palpate_world::scene::Truth;

use super::document::{ChosenPart, FitDocument, LackOfFitPart, MeasurePart, Shares, SpreadPart};
use super::maps::write_maps_npz;
use super::surface_view::SurfaceView;
use super::table::significant;
use super::words::{flat_r, named, small_maps};

/// Fewest picture cells per side, so that a coarse grid still shows the surface, and most, so that a browser opens it.
pub(super) const PICTURE_CELLS: [usize; 2] = [48, 100];

/// How the remark on imported surfaces begins.
pub(super) const INVERSE_CRIME: &str = "inverse crime";

/// A surface in words, numbers and pictures.
pub(crate) trait Description {
    /// All that is known, as JSON has it.
    fn document(&self) -> &FitDocument;

    /// The document as it is saved: with the support and the uncertainty point by point, which takes a moment to compute.
    fn saved(&self) -> FitDocument {
        self.document().clone()
    }

    /// `maps.csv`: the surface and its shape over the grid.
    ///
    /// # Errors
    /// What the system says.
    fn write_maps_csv(&self, out: &mut dyn Write) -> std::io::Result<()>;

    /// S, R and their like over the grid, indexed by its two directions.
    fn flat_maps(&self) -> Cow<'_, ShapeMaps>;

    /// `maps.npz`: the same as arrays.
    ///
    /// # Errors
    /// What the system says.
    fn write_maps_npz(&self, out: &mut dyn Write) -> std::io::Result<()> {
        write_maps_npz(&self.flat_maps(), out)
    }

    /// S and R over the grid in characters, where they differ from place to place.
    fn small_maps(&self) -> String {
        small_maps(&self.flat_maps())
    }

    /// What `report.html` and the pictures draw.
    fn view(&self) -> SurfaceView;
}

/// What is known of a fit besides the fit itself.
#[derive(Clone, Debug)]
pub(crate) struct Subject<'a> {
    /// The data.
    pub input: &'a Input,
    /// Unit of all lengths, where the user named it.
    pub unit: Option<String>,
    /// What is true, in a simulated world.
    pub truth: Option<&'a Truth>,
    /// Whether certificate, uncertainties and intervals were declined.
    pub bare: bool,
    /// Remarks of the reader.
    pub notes: Vec<String>,
    /// Kind of surface and why, where that was a question.
    pub chosen: Option<ChosenPart>,
    /// What the surface leaves unsaid, where that was tested.
    pub lack_of_fit: Option<LackOfFitPart>,
}

/// Points of the shape grid over which a saved surface is described.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShownGrid {
    /// Points per direction.
    pub points: [usize; 2],
    /// Fraction of each side that is cut at every edge.
    pub inset: f64,
    /// Whether the grid is another one than the saved one, so that the shape is taken again.
    pub again: bool,
}

impl Subject<'_> {
    /// The remarks, and that on what was declined.
    pub(super) fn remarks(&self) -> impl Iterator<Item = String> {
        let declined = "certificate, uncertainties, intervals and direction were declined (--bare)";
        self.notes.iter().cloned().chain(self.bare.then(|| declined.to_string()))
    }
}

/// What every output says of contacts that were made on an imported surface.
pub(crate) fn inverse_crime_remark(truth: &Truth) -> Option<String> {
    let label = truth.inverse_crime()?;
    Some(format!("{INVERSE_CRIME}: the surface is imported from {label}, of the same kind as the fit"))
}

/// What pages and pictures draw: the view, flat where the answer is a plane.
pub(super) fn shown_view(description: &dyn Description) -> SurfaceView {
    let (view, shape) = (description.view(), &description.document().shape);
    if shape.class.as_deref() != Some(ShapeClass::Plane.name()) {
        return view;
    }
    view.flattened(shape.curvedness.interval.map_or(0.0, |[_, most]| most))
}

/// One line for the top of a picture.
pub(super) fn headline(name: &str, document: &FitDocument) -> String {
    let shape = &document.shape;
    // a path is known by its last part
    let name = Path::new(name).file_name().and_then(|name| name.to_str()).unwrap_or(name);
    let mean = |letter: &str, part: &MeasurePart| part.mean.map(|v| format!(", {letter} = {}", significant(v, 4)));
    let numbers = match (flat_r(shape), &shape.class_by_area) {
        (Some(r), _) => format!(", R {r}"),
        // means over several shapes are those of none
        (None, Some(_)) => String::new(),
        (None, None) => [mean("S", &shape.shape_index), mean("R", &shape.curvedness)].into_iter().flatten().collect(),
    };
    let crime = document.fit.notes.iter().any(|note| note.starts_with(INVERSE_CRIME));
    let warning = if crime { format!(" ({INVERSE_CRIME})") } else { String::new() };
    format!("{name}: {}{numbers}{warning}", named(shape))
}

/// Share of the patch that the commonest class must have for the class to be said.
const SHARE_OF_CLASS: f64 = 0.5;

/// Variation of S over the patch from which on its mean may describe no part of it: two classes.
const VARIED: f64 = 0.25;

/// Share of the patch from which on a class that stands beside others is named.
const NAMED: f64 = 0.1;

/// Where S varies so much that the class of its mean is not the commonest one, or that no class has half of the patch:
/// the class is taken back and what there is said instead. `shape_index` runs over the supported points of the map.
pub(super) fn take_back_class(document: &mut FitDocument, shape_index: impl Iterator<Item = f64>) {
    let shape = &mut document.shape;
    if !shape.shape_index.sd.is_some_and(|sd| sd > VARIED) {
        return;
    }
    let mut counts: Vec<(ShapeClass, usize)> = ShapeClass::CURVED.into_iter().map(|class| (class, 0)).collect();
    for s in shape_index {
        let class = ShapeClass::of_shape_index(s);
        counts.iter_mut().filter(|(c, _)| *c == class).for_each(|(_, n)| *n += 1);
    }
    counts.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
    let all = counts.iter().map(|(_, n)| n).sum::<usize>().max(1) as f64;
    let (commonest, most) = counts[0];
    if shape.class.as_deref() == Some(commonest.name()) && most as f64 >= SHARE_OF_CLASS * all {
        return;
    }
    let by_area = counts.iter().map(|(class, n)| (*class, *n as f64 / all)).filter(|(_, share)| *share >= NAMED);
    shape.class_by_area = shares(&by_area.collect::<Vec<_>>());
    (shape.class, shape.class_probability, shape.radius, shape.radius_interval) = (None, None, None, None);
    shape.radii = None;
}

/// Probabilities of the classes; `None` of a plane.
pub(super) fn shares(list: &[(ShapeClass, f64)]) -> Option<Shares> {
    (!list.is_empty()).then(|| Shares(list.iter().map(|(c, p)| (c.name().to_string(), *p)).collect()))
}

/// A mean with its uncertainty; `level` is that of the interval.
pub(super) fn measure(statistic: &Statistic, level: f64) -> MeasurePart {
    let interval = statistic.interval.map(|i| [i.lo, i.hi]);
    MeasurePart {
        mean: statistic.mean,
        sd: statistic.sd,
        u: statistic.u,
        interval,
        u_noise: statistic.u_noise,
        u_model: statistic.u_model,
        level: interval.map(|_| level),
        coverage_factor: statistic.coverage_factor,
        dof: statistic.dof.filter(|dof| dof.is_finite()),
    }
}

pub(super) fn spread_part(spread: Spread) -> SpreadPart {
    SpreadPart { mean: spread.mean, sd: spread.sd }
}

/// Mean and spread of S, R, k1 and k2 over another grid than the saved one.
pub(super) struct Again {
    pub(super) grid: [usize; 2],
    pub(super) spreads: [Spread; 4],
}

/// Puts the shape over another grid into the document. The covariance is not saved, so everything that came from it
/// becomes undefined. Whether the patch is a plane was decided with the covariance, and stays.
pub(super) fn take_again(document: &mut FitDocument, again: &Again) {
    let [s, r, k1, k2] = again.spreads;
    let plane = document.shape.class.as_deref() == Some(ShapeClass::Plane.name());
    let class = s.mean.filter(|_| !plane).map(ShapeClass::of_shape_index);
    let measure = |spread: Spread| MeasurePart { mean: spread.mean, sd: spread.sd, ..MeasurePart::default() };
    let shape = &mut document.shape;
    shape.grid = again.grid;
    shape.shape_index = if plane { MeasurePart::default() } else { measure(s) };
    shape.curvedness = measure(r);
    if !plane {
        shape.class = class.map(|c| c.name().to_string());
    }
    shape.class_probability = None;
    (shape.covariance, shape.intervals) = (None, None);
    (shape.radius_interval, shape.radii) = (None, None);
    shape.radius = class.zip(r.mean).and_then(|(class, mean)| radius_of(class, mean));
    (shape.k1, shape.k2) = (spread_part(k1), spread_part(k2));
    shape.support = s.count as f64 / (again.grid[0] * again.grid[1]) as f64;
    document.truth = None;
    // a CAD file never had any
    if document.contacts > 0 {
        document.fit.notes.push("shape taken again over another grid: its uncertainty is not saved".into());
    }
}
