//! The shape as C sees it: a struct of numbers, NaN where something is undefined.

use std::ffi::{CStr, c_char};

use palpate_geometry::curvature::ShapeClass;
use palpate_inference::recognition::Hypothesis;

/// Koenderink's classes, in the order of S, and the plane.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names of the classes say what they are")]
pub enum PalpateClass {
    Cup = 0,
    Trough = 1,
    Rut = 2,
    SaddleRut = 3,
    Saddle = 4,
    SaddleRidge = 5,
    Ridge = 6,
    Dome = 7,
    Cap = 8,
    Plane = 9,
    /// There is no other class, or none at all.
    None = 10,
}

/// Kinds of surface that a recognition compares.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names of the kinds say what they are")]
pub enum PalpateKind {
    Plane = 0,
    Sphere = 1,
    Cylinder = 2,
    General = 3,
    Paraboloid = 4,
    Displaced = 5,
    Quadric = 6,
    Torus = 7,
    Cone = 8,
    /// The height field that was named.
    HeightField = 9,
    /// Any curve turned about an axis.
    Revolution = 10,
    /// Any curve drawn along a line.
    Extrusion = 11,
}

/// A number with its uncertainty.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PalpateEstimate {
    /// Mean over the patch.
    pub mean: f64,
    /// Standard uncertainty of the mean, in all.
    pub u: f64,
    /// Lower end of the interval.
    pub lo: f64,
    /// Upper end of the interval.
    pub hi: f64,
}

/// What contacts show. Lengths are in their unit; NaN is what is undefined.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PalpateShape {
    /// Class of the mean S.
    pub class_: PalpateClass,
    /// The class from the other side, where nothing tells which side is free.
    pub other_class: PalpateClass,
    /// Probability of `class_`, and of `other_class` where there is one.
    pub class_probability: f64,
    /// Likeliest kind of surface.
    pub kind: PalpateKind,
    /// Its probability.
    pub kind_probability: f64,
    /// Shape index S.
    pub shape_index: PalpateEstimate,
    /// Curvedness R, 1/length.
    pub curvedness: PalpateEstimate,
    /// Radius of cap, cup, ridge and rut; its `u` is NaN.
    pub radius: PalpateEstimate,
    /// Level of the intervals.
    pub level: f64,
    /// Contacts that were used.
    pub contacts: usize,
    /// Contacts that do not belong to the surface and were left out.
    pub outliers: usize,
}

/// A point of a map.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PalpateMapPoint {
    /// Point of the surface.
    pub position: [f64; 3],
    /// Outward unit normal.
    pub normal: [f64; 3],
    /// Shape index; NaN on a plane.
    pub shape_index: f64,
    /// Curvedness, 1/length.
    pub curvedness: f64,
    /// Larger principal curvature.
    pub k1: f64,
    /// Smaller principal curvature.
    pub k2: f64,
    /// Whether contacts support the surface here.
    pub supported: bool,
}

impl PalpateEstimate {
    pub(crate) const UNDEFINED: PalpateEstimate =
        PalpateEstimate { mean: f64::NAN, u: f64::NAN, lo: f64::NAN, hi: f64::NAN };
}

pub(crate) fn class_of(class: ShapeClass) -> PalpateClass {
    match class {
        ShapeClass::Cup => PalpateClass::Cup,
        ShapeClass::Trough => PalpateClass::Trough,
        ShapeClass::Rut => PalpateClass::Rut,
        ShapeClass::SaddleRut => PalpateClass::SaddleRut,
        ShapeClass::Saddle => PalpateClass::Saddle,
        ShapeClass::SaddleRidge => PalpateClass::SaddleRidge,
        ShapeClass::Ridge => PalpateClass::Ridge,
        ShapeClass::Dome => PalpateClass::Dome,
        ShapeClass::Cap => PalpateClass::Cap,
        ShapeClass::Plane => PalpateClass::Plane,
    }
}

pub(crate) fn kind_of(hypothesis: Hypothesis) -> PalpateKind {
    match hypothesis {
        Hypothesis::Plane => PalpateKind::Plane,
        Hypothesis::Sphere => PalpateKind::Sphere,
        Hypothesis::Cylinder => PalpateKind::Cylinder,
        Hypothesis::General => PalpateKind::General,
        Hypothesis::Paraboloid => PalpateKind::Paraboloid,
        Hypothesis::Displaced => PalpateKind::Displaced,
        Hypothesis::Quadric => PalpateKind::Quadric,
        Hypothesis::Torus => PalpateKind::Torus,
        Hypothesis::Cone => PalpateKind::Cone,
        Hypothesis::Revolution => PalpateKind::Revolution,
        Hypothesis::Extrusion => PalpateKind::Extrusion,
    }
}

/// Where nothing tells which side is free: the mirror image of the class.
pub(crate) fn other_side(class: ShapeClass) -> PalpateClass {
    let other = Some(class.mirrored()).filter(|other| *other != class);
    other.map_or(PalpateClass::None, class_of)
}

/// A `PalpateClass` in one word, as in every other output.
#[unsafe(no_mangle)]
pub extern "C" fn palpate_class_name(class_: i32) -> *const c_char {
    // a number, because C may hand in any
    const NAMES: [&CStr; 11] = [
        c"cup",
        c"trough",
        c"rut",
        c"saddle rut",
        c"saddle",
        c"saddle ridge",
        c"ridge",
        c"dome",
        c"cap",
        c"plane",
        c"none",
    ];
    named_in(&NAMES, class_)
}

/// A `PalpateKind` in words, as in every other output.
#[unsafe(no_mangle)]
pub extern "C" fn palpate_kind_name(kind: i32) -> *const c_char {
    const NAMES: [&CStr; 12] = [
        c"plane",
        c"sphere",
        c"cylinder",
        c"general",
        c"paraboloid",
        c"general with displacement",
        c"quadric",
        c"torus",
        c"cone",
        c"height field",
        c"surface of revolution",
        c"extrusion",
    ];
    named_in(&NAMES, kind)
}

/// The word of this number; `unknown` of a number that names nothing.
fn named_in(names: &[&'static CStr], number: i32) -> *const c_char {
    let known = usize::try_from(number).ok().and_then(|number| names.get(number));
    known.copied().unwrap_or(c"unknown").as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_every_other_output() {
        // SAFETY: both functions give words that stay
        let text = |words: *const c_char| unsafe { CStr::from_ptr(words) }.to_str().unwrap();
        for class in ShapeClass::CURVED.into_iter().chain([ShapeClass::Plane]) {
            assert_eq!(text(palpate_class_name(class_of(class) as i32)), class.name());
        }
        for hypothesis in Hypothesis::ALL {
            assert_eq!(text(palpate_kind_name(kind_of(hypothesis) as i32)), hypothesis.name());
        }
        assert_eq!(other_side(ShapeClass::Dome), PalpateClass::Trough);
        assert_eq!([ShapeClass::Saddle, ShapeClass::Plane].map(other_side), [PalpateClass::None; 2]);
        assert_eq!([-1, 99].map(|number| text(palpate_kind_name(number))), ["unknown"; 2]);
    }
}
