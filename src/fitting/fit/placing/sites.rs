//! Where the data lie under the spline: scattered contacts and grids stay what they are, down to the solver.

use crate::observation::{GridSites, ScatteredSites};
use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg::{GridAxis, Site, Sites, TensorShape};

/// Sites of the data of one fit.
#[derive(Clone, Debug)]
pub enum DataSites {
    /// Contacts wherever they fell.
    Scattered(ScatteredSites),
    /// Data on the product of two axes.
    Gridded(GridSites),
}

impl DataSites {
    /// Knots in x and y.
    pub fn knots(&self) -> [Knots; 2] {
        match self {
            DataSites::Scattered(sites) => sites.knots().clone(),
            DataSites::Gridded(sites) => sites.axes().clone().map(|axis| axis.knots),
        }
    }
}

impl Sites for DataSites {
    fn shape(&self) -> TensorShape {
        match self {
            DataSites::Scattered(sites) => sites.shape(),
            DataSites::Gridded(sites) => sites.shape(),
        }
    }

    fn len(&self) -> usize {
        match self {
            DataSites::Scattered(sites) => sites.len(),
            DataSites::Gridded(sites) => sites.len(),
        }
    }

    fn grid_axes(&self) -> Option<[GridAxis<'_>; 2]> {
        match self {
            DataSites::Scattered(_) => None,
            DataSites::Gridded(sites) => sites.grid_axes(),
        }
    }

    fn visit(&self, f: impl FnMut(&Site)) {
        match self {
            DataSites::Scattered(sites) => sites.visit(f),
            DataSites::Gridded(sites) => sites.visit(f),
        }
    }

    fn visit_cells(&self, f: impl FnMut([usize; 2], &[u32], &[f64])) -> bool {
        match self {
            DataSites::Scattered(sites) => sites.visit_cells(f),
            DataSites::Gridded(sites) => sites.visit_cells(f),
        }
    }
}
