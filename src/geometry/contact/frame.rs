//! The patch frame: `p = A (P - origin) / scale`, one isotropic length, right-handed orthonormal axes.

/// The frame that a fit works in. Results are given back in the frame and unit of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Frame {
    /// Point of the input frame that is the patch's origin.
    pub origin: [f64; 3],
    /// Rows are the patch's x, y, z directions in the input frame.
    pub axes: [[f64; 3]; 3],
    /// Length of the input frame that is 1 in the patch.
    pub scale: f64,
}

impl Frame {
    /// The frame of the input itself: its axes, its origin, its unit.
    pub const IDENTITY: Frame =
        Frame { origin: [0.0; 3], axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], scale: 1.0 };

    /// Whether the axes are those of the input, so that the surface is a height field over its x and y.
    pub fn keeps_axes(&self) -> bool {
        self.axes == Frame::IDENTITY.axes
    }

    /// A point of the input in patch coordinates.
    pub fn to_patch(&self, point: [f64; 3]) -> [f64; 3] {
        let d = [point[0] - self.origin[0], point[1] - self.origin[1], point[2] - self.origin[2]];
        let local = if self.keeps_axes() { d } else { self.rotate(d) };
        local.map(|v| v / self.scale)
    }

    /// A direction of the input (normal, tangent) in patch axes; lengths stay.
    pub fn rotate(&self, v: [f64; 3]) -> [f64; 3] {
        let dot = |a: &[f64; 3]| a[0] * v[0] + a[1] * v[1] + a[2] * v[2];
        [dot(&self.axes[0]), dot(&self.axes[1]), dot(&self.axes[2])]
    }

    /// A direction in patch axes, back in the input's axes.
    pub fn rotate_back(&self, v: [f64; 3]) -> [f64; 3] {
        let a = &self.axes;
        [0, 1, 2].map(|k| a[0][k] * v[0] + a[1][k] * v[1] + a[2][k] * v[2])
    }

    /// A vector along the patch's axes, in the input's; nothing is rounded where the axes are the same.
    pub fn direction_to_input(&self, v: [f64; 3]) -> [f64; 3] {
        if self.keeps_axes() { v } else { self.rotate_back(v) }
    }

    /// A point of the patch in input coordinates.
    pub fn to_input(&self, point: [f64; 3]) -> [f64; 3] {
        let scaled = point.map(|v| v * self.scale);
        let local = self.direction_to_input(scaled);
        [0, 1, 2].map(|k| self.origin[k] + local[k])
    }
}
