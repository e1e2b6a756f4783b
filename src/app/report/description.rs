//! A surface described, whatever kind of surface it is.
//!
//! ```text
//! a fit, or a saved surface   ->   Description: document, maps as CSV and NPZ, picture
//! ```

use std::borrow::Cow;
use std::cell::OnceCell;
use std::io::Write;
use std::path::Path;

use ndarray::Array2;

use crate::io::{AnySurface, PointUncertainty, SupportMap, UNCERTAINTY_POINTS, UncertaintyMap};
use palpate_geometry::contact::Frame;
use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::shape::ShapeGrid;
use palpate_world::scene::Truth;

use super::describe::{height, recognised};
use super::document::{FitDocument, MeasurePart};
use super::height_view::{adaptive_view, height_view};
use super::maps::{arrays_of, points_of, write_maps_csv, write_maps_npz};
use super::parametric::write_parametric_maps_csv;
use super::parametric_view::{contacts_on_feet, parametric_view};
use super::recognised_view::recognised_view;
use super::subject::Source;
use super::surface_maps::{Maps, ShownGrid};
use super::surface_view::SurfaceView;
use super::table::significant;
use super::uncertainty;
use super::words::{flat_r, named, small_maps};

/// Fewest picture cells per side, so that a coarse grid still shows the surface, and most, so that a browser opens it.
pub(super) const PICTURE_CELLS: [usize; 2] = [48, 100];

/// How the remark on imported surfaces begins.
pub(super) const INVERSE_CRIME: &str = "inverse crime";

/// A surface in words, numbers and pictures.
pub(crate) struct Description<'a> {
    pub(super) document: FitDocument,
    pub(super) surface: Cow<'a, AnySurface>,
    /// The frame along whose axes a height field stands.
    pub(super) frame: Frame,
    /// Points of the shape grid per direction.
    pub(super) grid: [usize; 2],
    /// Coefficients without data.
    pub(super) unsupported: Cow<'a, [usize]>,
    pub(super) source: Source<'a>,
    /// Support and uncertainty point by point, once they were asked for.
    pub(super) pointwise: OnceCell<(Option<SupportMap>, Option<UncertaintyMap>)>,
}

impl Description<'_> {
    /// All that is known, as JSON has it.
    pub(crate) fn document(&self) -> &FitDocument {
        &self.document
    }

    /// The document as it is saved: with the support and the uncertainty point by point, which takes a moment to compute.
    pub(crate) fn saved(&self) -> FitDocument {
        let mut document = self.document.clone();
        if !matches!(self.source, Source::Saved(_)) {
            let (support_map, uncertainty) = self.pointwise();
            (document.surface.support_map, document.uncertainty) = (support_map.clone(), uncertainty.clone());
        }
        document
    }

    fn saved_uncertainty(&self) -> Option<&UncertaintyMap> {
        if matches!(self.source, Source::Saved(_)) {
            self.document.uncertainty.as_ref()
        } else {
            self.pointwise().1.as_ref()
        }
    }

    /// Support and uncertainty point by point; computed on first access.
    fn pointwise(&self) -> &(Option<SupportMap>, Option<UncertaintyMap>) {
        self.pointwise.get_or_init(|| {
            let mut shape = self.document.shape.clone();
            let (support_map, sds) = match self.source {
                Source::Saved(_) => (None, Vec::new()),
                Source::Height { fit, bare, .. } => {
                    let sds = if bare { None } else { fit.pointwise(UNCERTAINTY_POINTS) };
                    let map = SupportMap::of(self.surface.map().domain(), fit.supported());
                    (map, sds.into_iter().flatten().map(Some).collect())
                }
                Source::Adaptive { answer, .. } => return answer.pointwise(&shape),
                Source::Parametric { fit, bare, .. } => {
                    (None, if bare { None } else { fit.pointwise(UNCERTAINTY_POINTS) }.unwrap_or_default())
                }
                Source::Recognised { found, input } => {
                    // the draws have counted every kind of surface already
                    (shape.shape_index.u_model, shape.curvedness.u_model) = (None, None);
                    recognised::support_and_sds(found, &self.surface, input)
                }
            };
            (support_map, uncertainty::map(uncertainty::places(self.surface.knots()), &sds, &shape))
        })
    }

    /// Maps over the shape grid.
    fn maps(&self) -> Maps<'_> {
        match &self.source {
            Source::Saved(maps) => maps.borrowed(),
            Source::Height { fit, bare: true, .. } => Maps::Height(Cow::Borrowed(&fit.bare_shape().maps)),
            Source::Height { fit, .. } => Maps::Height(Cow::Borrowed(&fit.shape().maps)),
            Source::Adaptive { answer, .. } => Maps::Height(Cow::Borrowed(&answer.shape.maps)),
            Source::Parametric { fit, .. } => Maps::Parametric(Cow::Borrowed(&fit.shape().maps)),
            Source::Recognised { found, .. } => recognised::maps(found, &self.surface, self.grid),
        }
    }

    /// Maps over the whole domain, fine enough to look at.
    fn picture_maps(&self) -> Maps<'_> {
        let [least, most] = PICTURE_CELLS;
        self.maps_over(self.grid.map(|n| n.clamp(least, most)))
    }

    /// Maps over the whole domain at so many points each way.
    fn maps_over(&self, points: [usize; 2]) -> Maps<'_> {
        match self.source {
            Source::Recognised { found, .. } => return recognised::maps(found, &self.surface, points),
            Source::Adaptive { answer, .. } => return Maps::Height(Cow::Owned(answer.maps_over(points))),
            _ => {}
        }
        let mut maps = Maps::over(&self.surface, ShownGrid { points, inset: 0.0, again: false }, &self.unsupported);
        if let (Maps::Height(maps), Source::Height { fit, input, .. }) = (&mut maps, &self.source) {
            height::leave_out_beyond(fit, input, maps.to_mut());
        }
        maps
    }

    /// `maps.csv`: the surface and its shape over the grid.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn write_maps_csv(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let maps = self.maps();
        let uncertainty = self.uncertainty_over(&maps);
        match &maps {
            Maps::Height(maps) => write_maps_csv(maps, &self.frame, &uncertainty, out),
            Maps::Parametric(maps) => write_parametric_maps_csv(maps, &uncertainty, out),
        }
    }

    /// `maps.npz`: the same as arrays, indexed by the grid's two directions.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn write_maps_npz(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let (grid, arrays) = self.map_arrays(None);
        write_maps_npz([&grid.x, &grid.y], &arrays, out)
    }

    /// The grid and the arrays of `maps.npz`, over another number of points where one is given.
    pub(crate) fn map_arrays(&self, points: Option<[usize; 2]>) -> (ShapeGrid, Vec<(&'static str, Array2<f64>)>) {
        let maps = points.map_or_else(|| self.maps(), |points| self.maps_over(points));
        let points = match &maps {
            Maps::Height(_) if self.frame.keeps_axes() => None,
            Maps::Height(maps) => Some(points_of(maps, &self.frame)),
            Maps::Parametric(maps) => Some(maps.points.clone()),
        };
        let (flat, uncertainty) = (maps.flat(), self.uncertainty_over(&maps));
        (flat.grid.clone(), arrays_of(&flat, points.as_ref(), &uncertainty))
    }

    /// Standard uncertainties at the supported points of the maps.
    fn uncertainty_over(&self, maps: &Maps) -> Array2<PointUncertainty> {
        let flat = maps.flat();
        let saved = match self.source {
            Source::Adaptive { .. } => None,
            _ => self.saved_uncertainty(),
        };
        let at = |place: [f64; 2]| match self.source {
            Source::Adaptive { answer, .. } => answer.uncertainty_at(place),
            _ => saved.map_or(PointUncertainty::default(), |known| known.at(place)),
        };
        Array2::from_shape_fn(flat.supported.dim(), |(i, j)| match flat.supported[[i, j]] {
            true => at([flat.grid.x[i], flat.grid.y[j]]).rounded(),
            false => PointUncertainty::default(),
        })
    }

    /// S and R over the grid in characters, where they differ from place to place.
    pub(crate) fn small_maps(&self) -> String {
        small_maps(&self.maps().flat())
    }

    /// What `report.html` and the pictures draw.
    pub(super) fn view(&self) -> SurfaceView {
        let maps = self.picture_maps();
        let fitted = match self.source {
            Source::Height { fit, input, bare } => Some((fit, input, !bare)),
            _ => None,
        };
        let mut view = match (&maps, &*self.surface) {
            (Maps::Height(maps), AnySurface::Height(surface)) => height_view(surface, &self.frame, maps, fitted),
            (Maps::Height(maps), AnySurface::Hierarchical(surface)) => {
                let fitted = match self.source {
                    Source::Adaptive { answer, input } => Some((answer, input)),
                    _ => None,
                };
                adaptive_view(surface, maps, self.saved_uncertainty(), fitted)
            }
            (Maps::Parametric(maps), AnySurface::Parametric(surface, _)) => parametric_view(surface, maps),
            // maps are of their surface's kind
            _ => SurfaceView::default(),
        };
        match (&self.source, &*self.surface) {
            (Source::Recognised { found, input }, _) => recognised_view(found, input, &mut view),
            (Source::Parametric { fit, input, .. }, AnySurface::Parametric(surface, _)) => {
                view.contacts = Some(contacts_on_feet(surface, input, &fit.feet()));
            }
            _ => {}
        }
        view
    }
}

/// What every output says of contacts that were made on an imported surface.
pub(crate) fn inverse_crime_remark(truth: &Truth) -> Option<String> {
    let label = truth.inverse_crime()?;
    Some(format!("{INVERSE_CRIME}: the surface is imported from {label}, of the same kind as the fit"))
}

/// What pages and pictures draw: the view, flat where the answer is a plane.
pub(super) fn shown_view(description: &Description) -> SurfaceView {
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
