//! The recognised surface as a map `Q(u, v)` into space, over a rectangle of its chart.

use crate::contact::Frame;

/// A surface of two constant curvatures, its displacement or a paraboloid, in the input's coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct RecognisedSurface {
    /// Frame in which the surface is written.
    pub frame: Frame,
    /// Range of the first chart coordinate that the contacts cover, in units of the frame's length.
    pub u: [f64; 2],
    /// Range of the second chart coordinate.
    pub v: [f64; 2],
}

impl RecognisedSurface {
    /// Point and unit normal at chart coordinates, in the input's coordinates.
    pub fn at(&self, u: f64, v: f64) -> ([f64; 3], [f64; 3]) {
        (self.frame.to_input([u, v, 0.0]), self.frame.rotate_back([0.0, 0.0, 1.0]))
    }
}
