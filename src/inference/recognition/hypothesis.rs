//! The kinds of surface that are compared with each other.

use crate::bodies::Symmetry;
use crate::primitives::placed::PartKind;

/// The kinds of surface that are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Hypothesis {
    /// No curvature.
    Plane,
    /// Both curvatures equal.
    Sphere,
    /// One curvature zero.
    Cylinder,
    /// Two constant curvatures: a patch of a torus.
    General,
    /// A height field of second degree over the mean tangent plane.
    Paraboloid,
    /// Two constant curvatures and a smooth displacement along the normal.
    Displaced,
    /// An ellipsoid, hyperboloid, cone or any other surface whose implicit equation is of second degree.
    Quadric,
    /// A circle turned about an axis in its plane, touched anywhere.
    Torus,
    /// A line turned about an axis that it meets.
    Cone,
    /// Any curve turned about an axis.
    Revolution,
    /// Any curve drawn along a line.
    Extrusion,
}

impl Hypothesis {
    /// All hypotheses, in the order in which they are tried.
    pub const ALL: [Hypothesis; 11] = [
        Hypothesis::Plane,
        Hypothesis::Sphere,
        Hypothesis::Cylinder,
        Hypothesis::General,
        Hypothesis::Paraboloid,
        Hypothesis::Displaced,
        Hypothesis::Quadric,
        Hypothesis::Torus,
        Hypothesis::Cone,
        Hypothesis::Revolution,
        Hypothesis::Extrusion,
    ];

    /// The word used in every output.
    pub fn name(self) -> &'static str {
        match self {
            Hypothesis::Plane => "plane",
            Hypothesis::Sphere => "sphere",
            Hypothesis::Cylinder => "cylinder",
            Hypothesis::General => "general",
            Hypothesis::Paraboloid => "paraboloid",
            Hypothesis::Displaced => "general with displacement",
            Hypothesis::Quadric => "quadric",
            Hypothesis::Torus => "torus",
            Hypothesis::Cone => "cone",
            Hypothesis::Revolution => "surface of revolution",
            Hypothesis::Extrusion => "extrusion",
        }
    }

    /// The same as part of a sentence.
    pub fn described(self) -> &'static str {
        match self {
            Hypothesis::Plane => "a plane",
            Hypothesis::Sphere => "a sphere",
            Hypothesis::Cylinder => "a cylinder",
            Hypothesis::General => "a surface of two constant curvatures",
            Hypothesis::Paraboloid => "a paraboloid",
            Hypothesis::Displaced => "a smooth surface near two constant curvatures",
            Hypothesis::Quadric => "an ellipsoid or another quadric",
            Hypothesis::Torus => "a torus",
            Hypothesis::Cone => "a cone",
            Hypothesis::Revolution => "a surface of revolution",
            Hypothesis::Extrusion => "an extrusion",
        }
    }

    /// Numbers that fix a surface of this kind; a displacement adds as many as the contacts call for.
    pub fn unknowns(self) -> usize {
        match self {
            // the axis alone: the curve has as many as the contacts call for
            Hypothesis::Extrusion => 2,
            Hypothesis::Revolution => 4,
            Hypothesis::Plane => 3,
            Hypothesis::Sphere => 4,
            Hypothesis::Cylinder => 5,
            Hypothesis::General | Hypothesis::Paraboloid | Hypothesis::Displaced | Hypothesis::Cone => 6,
            Hypothesis::Torus => 7,
            Hypothesis::Quadric => 9,
        }
    }
}

impl From<Symmetry> for Hypothesis {
    fn from(symmetry: Symmetry) -> Hypothesis {
        match symmetry {
            Symmetry::None => Hypothesis::Displaced,
            Symmetry::Turned => Hypothesis::Revolution,
            Symmetry::Extruded => Hypothesis::Extrusion,
        }
    }
}

impl From<PartKind> for Hypothesis {
    fn from(kind: PartKind) -> Hypothesis {
        match kind {
            PartKind::Plane | PartKind::Patch => Hypothesis::Plane,
            PartKind::Sphere => Hypothesis::Sphere,
            PartKind::Cylinder => Hypothesis::Cylinder,
            PartKind::Cone => Hypothesis::Cone,
            PartKind::Torus => Hypothesis::Torus,
            PartKind::Ellipsoid => Hypothesis::Quadric,
        }
    }
}

impl std::fmt::Display for Hypothesis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
