//! A surface of either kind over a grid of its own directions.

use std::borrow::Cow;

use crate::io::{AnySurface, SavedSurface};
use palpate_geometry::shape::{ParametricMaps, ShapeGrid, ShapeMaps, parametric_maps, uv_grid};
use palpate_geometry::surface::Surface;
use palpate_numeric::bspline::Knots;

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

/// S, R and their like over (x, y) or over (u, v).
pub(super) enum Maps<'a> {
    Height(Cow<'a, ShapeMaps>),
    Parametric(Cow<'a, ParametricMaps>),
}

impl<'a> Maps<'a> {
    /// Of a surface where data support it; `unsupported` are coefficients of a height field without data.
    pub(super) fn over(surface: &AnySurface, shown: ShownGrid, unsupported: &[usize]) -> Maps<'a> {
        match surface {
            AnySurface::Height(surface) => {
                let grid = ShapeGrid::over(surface.domain(), shown.points, shown.inset);
                Maps::Height(Cow::Owned(surface.shape_maps(grid, unsupported)))
            }
            AnySurface::Parametric(surface, support) => {
                let grid = uv_grid(surface.knots().each_ref(), shown.points, shown.inset);
                Maps::Parametric(Cow::Owned(parametric_maps(surface, grid, support)))
            }
            AnySurface::Hierarchical(surface) => {
                let grid = ShapeGrid::over(surface.domain(), shown.points, shown.inset);
                Maps::Height(Cow::Owned(ShapeMaps::of_heights(&**surface, grid)))
            }
        }
    }

    /// The same maps.
    pub(super) fn borrowed(&self) -> Maps<'_> {
        match self {
            Maps::Height(maps) => Maps::Height(Cow::Borrowed(maps)),
            Maps::Parametric(maps) => Maps::Parametric(Cow::Borrowed(maps)),
        }
    }

    /// The maps with z as the height, whichever directions they run along.
    pub(super) fn flat(&self) -> Cow<'_, ShapeMaps> {
        match self {
            Maps::Height(maps) => Cow::Borrowed(maps),
            Maps::Parametric(maps) => Cow::Owned(maps.flat()),
        }
    }
}

impl AnySurface {
    /// The surface as a map into space; a height field along its own axes.
    pub(super) fn map(&self) -> &dyn Surface {
        match self {
            AnySurface::Height(surface) => surface,
            AnySurface::Parametric(surface, _) => surface,
            AnySurface::Hierarchical(surface) => &**surface,
        }
    }

    /// Knots in both directions; of a hierarchy those of its base grid.
    pub(super) fn knots(&self) -> [&Knots; 2] {
        match self {
            AnySurface::Height(surface) => surface.knots().each_ref(),
            AnySurface::Parametric(surface, _) => surface.knots().each_ref(),
            AnySurface::Hierarchical(surface) => surface.space().mesh().levels().at(0).map(|level| level.knots()),
        }
    }

    /// As it is saved; `unsupported` are coefficients of a height field without data.
    pub(super) fn saved_form(&self, unsupported: &[usize]) -> SavedSurface {
        match self {
            AnySurface::Height(surface) => SavedSurface::of(surface, unsupported),
            AnySurface::Parametric(surface, support) => SavedSurface::of_parametric(surface, support),
            AnySurface::Hierarchical(surface) => SavedSurface::of_hierarchical(surface),
        }
    }
}
