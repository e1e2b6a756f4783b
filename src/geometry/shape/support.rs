//! Whether contacts support a surface at a place of its chart, however that is decided.

use ndarray::Array2;

use super::{Outline, ShapeGrid, ShapeMaps, UvSupport};

/// The part of a chart that contacts support.
pub trait Support {
    /// Whether contacts support the place.
    fn supports(&self, at: [f64; 2]) -> bool;
}

/// Which points of a grid contacts support.
pub(super) fn supported(grid: &ShapeGrid, support: &impl Support) -> Array2<bool> {
    Array2::from_shape_fn((grid.x.len(), grid.y.len()), |(i, j)| support.supports([grid.x[i], grid.y[j]]))
}

impl ShapeMaps {
    /// Leaves out the points that contacts do not support; all of them stay where none would be left.
    pub fn leave_out_beyond(&mut self, support: &impl Support) {
        self.leave_out(&supported(&self.grid, support));
    }

    /// Leaves out the points that are not held; all of them stay where none would be left.
    pub fn leave_out(&mut self, held: &Array2<bool>) {
        if held.iter().zip(&self.supported).any(|(held, supported)| *held && *supported) {
            self.supported.zip_mut_with(held, |supported, held| *supported &= held);
        }
    }
}

impl Support for Outline {
    fn supports(&self, [x, y]: [f64; 2]) -> bool {
        self.holds(x, y)
    }
}

impl Support for UvSupport {
    fn supports(&self, [u, v]: [f64; 2]) -> bool {
        self.holds(u, v)
    }
}

impl<F: Fn([f64; 2]) -> bool> Support for F {
    fn supports(&self, at: [f64; 2]) -> bool {
        self(at)
    }
}
