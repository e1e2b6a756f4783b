//! Standard uncertainties of a surface at one point, whatever kind of fit they come from.

/// Standard uncertainties at one point, in the units of the frame that they are given in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointSds {
    /// Of the position along the surface's normal.
    pub position: f64,
    /// Of the normal: root mean square angle, radians.
    pub normal: f64,
    /// Of the shape index, where it is defined.
    pub shape_index: Option<f64>,
    /// Of the curvedness, where it is defined.
    pub curvedness: Option<f64>,
    /// Of the principal curvatures, the larger first, where they are defined.
    pub curvatures: Option<[f64; 2]>,
}

impl PointSds {
    /// The same where lengths of the frame are `scale` lengths of the input.
    pub fn scaled(self, scale: f64) -> PointSds {
        PointSds {
            position: scale * self.position,
            curvedness: self.curvedness.map(|u| u / scale),
            curvatures: self.curvatures.map(|both| both.map(|u| u / scale)),
            // nothing between -1 and 1 has a larger standard deviation
            shape_index: self.shape_index.map(|u| u.min(1.0)),
            // nor has an angle between directions
            normal: self.normal.min(std::f64::consts::PI),
        }
    }
}
