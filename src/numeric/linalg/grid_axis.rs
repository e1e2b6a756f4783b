//! One axis of a grid: its points, and the basis functions that are not zero there.

use std::ops::Range;

/// One axis of a grid: the basis functions that are not zero at each of its points.
#[derive(Clone, Copy, Debug)]
pub struct GridAxis<'a> {
    /// First basis function at each point.
    pub first: &'a [usize],
    /// p + 1 values per point.
    pub values: &'a [f64],
    /// p + 1 slopes per point.
    pub slopes: &'a [f64],
    /// Runs of points that share a segment.
    pub runs: &'a [Range<usize>],
    /// p + 1.
    pub width: usize,
}

impl GridAxis<'_> {
    /// Values and slopes at one point.
    #[inline(always)]
    pub(super) fn rows(&self, at: usize) -> [&[f64]; 2] {
        let range = at * self.width..(at + 1) * self.width;
        [&self.values[range.clone()], &self.slopes[range]]
    }
}
