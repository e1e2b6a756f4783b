//! Numbers that an image may consist of.
//!
//! ```text
//! f64 -> read where it lies        f32 -> converted row by row
//! ```

/// A pixel's number type: `f32` or `f64`.
pub trait Pixel: Copy + Into<f64> + sealed::Sealed {
    /// The same numbers without a copy, where they are `f64` already.
    #[doc(hidden)]
    fn as_f64(pixels: &[Self]) -> Option<&[f64]>;
}

impl Pixel for f32 {
    fn as_f64(_: &[f32]) -> Option<&[f64]> {
        None
    }
}

impl Pixel for f64 {
    fn as_f64(pixels: &[f64]) -> Option<&[f64]> {
        Some(pixels)
    }
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}
