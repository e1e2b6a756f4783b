//! Koenderink's nine classes: bins of S centred at k/4, edges at odd multiples of 1/8, and the plane.

/// What a patch looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ShapeClass {
    /// S about -1: concave sphere.
    Cup,
    /// S about -3/4.
    Trough,
    /// S about -1/2: concave cylinder.
    Rut,
    /// S about -1/4.
    SaddleRut,
    /// S about 0.
    Saddle,
    /// S about 1/4.
    SaddleRidge,
    /// S about 1/2: convex cylinder.
    Ridge,
    /// S about 3/4.
    Dome,
    /// S about 1: convex sphere.
    Cap,
    /// No curvature that the data can tell from zero; S is undefined.
    Plane,
}

impl ShapeClass {
    /// The nine curved classes in the order of S.
    pub const CURVED: [ShapeClass; 9] = [
        ShapeClass::Cup,
        ShapeClass::Trough,
        ShapeClass::Rut,
        ShapeClass::SaddleRut,
        ShapeClass::Saddle,
        ShapeClass::SaddleRidge,
        ShapeClass::Ridge,
        ShapeClass::Dome,
        ShapeClass::Cap,
    ];

    /// Class of a shape index in [-1, 1]; on an edge, the class nearer 0.
    pub fn of_shape_index(shape_index: f64) -> ShapeClass {
        // round half towards zero: ceil(|4 S| - 1/2)
        let bins = (4.0 * shape_index.abs() - 0.5).ceil().clamp(0.0, 4.0) as usize;
        if shape_index < 0.0 { ShapeClass::CURVED[4 - bins] } else { ShapeClass::CURVED[4 + bins] }
    }

    /// The edges of the class in S, infinite at both ends of the scale; `None` for the plane.
    pub fn edges(self) -> Option<(f64, f64)> {
        let k = ShapeClass::CURVED.iter().position(|c| *c == self)? as f64;
        let lo = if k == 0.0 { f64::NEG_INFINITY } else { (2.0 * k - 9.0) / 8.0 };
        let hi = if k == 8.0 { f64::INFINITY } else { (2.0 * k - 7.0) / 8.0 };
        Some((lo, hi))
    }

    /// Whether one direction of the class bends less than the other: that is its axis.
    pub fn has_axis(self) -> bool {
        use ShapeClass::{Dome, Ridge, Rut, SaddleRidge, SaddleRut, Trough};
        matches!(self, Ridge | Rut | Dome | Trough | SaddleRidge | SaddleRut)
    }

    /// The class seen from the other side: what bulges is hollow from there.
    pub fn mirrored(self) -> ShapeClass {
        let place = ShapeClass::CURVED.iter().position(|c| *c == self);
        place.map_or(self, |k| ShapeClass::CURVED[8 - k])
    }

    /// The word used in every output.
    pub fn name(self) -> &'static str {
        match self {
            ShapeClass::Cup => "cup",
            ShapeClass::Trough => "trough",
            ShapeClass::Rut => "rut",
            ShapeClass::SaddleRut => "saddle rut",
            ShapeClass::Saddle => "saddle",
            ShapeClass::SaddleRidge => "saddle ridge",
            ShapeClass::Ridge => "ridge",
            ShapeClass::Dome => "dome",
            ShapeClass::Cap => "cap",
            ShapeClass::Plane => "plane",
        }
    }
}

impl std::fmt::Display for ShapeClass {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::ShapeClass as C;

    /// The words that documents hold, from S = -1 to S = 1.
    #[test]
    fn names_are_those_of_the_literature() {
        let names =
            ["cup", "trough", "rut", "saddle rut", "saddle", "saddle ridge", "ridge", "dome", "cap"].map(String::from);
        assert_eq!(C::CURVED.map(|class| class.to_string()), names);
        assert_eq!(C::Plane.name(), "plane");
    }

    #[test]
    fn bins_are_centred_at_quarters_and_ties_go_towards_zero() {
        for (k, class) in C::CURVED.iter().enumerate() {
            assert_eq!(C::of_shape_index(k as f64 / 4.0 - 1.0), *class);
        }
        assert_eq!(C::of_shape_index(0.625), C::Ridge);
        assert_eq!(C::of_shape_index(0.625 + 1e-12), C::Dome);
        assert_eq!(C::of_shape_index(-0.125), C::Saddle);
        assert_eq!(C::of_shape_index(-0.125 - 1e-12), C::SaddleRut);
    }

    #[test]
    fn edges_agree_with_bins() {
        for class in C::CURVED {
            let (lo, hi) = class.edges().unwrap();
            let inside = lo.max(-1.0) + 1e-9;
            assert_eq!(C::of_shape_index(inside), class);
            assert_eq!(C::of_shape_index(hi.min(1.0) - 1e-9), class);
        }
        assert_eq!(C::Plane.edges(), None);
    }
}
