//! Images times the basis: the right-hand side of a grid's normal equations.
//!
//! ```text
//! B = N' Wz^2 Z M + N'' Wx^2 Zx M + N' Wy^2 Zy M'     N' transposed along x, M along y
//! images, pixels_x x pixels_y  ->  half, n x pixels_y  ->  B, n x m
//! ```

use ndarray::ArrayView2;

use super::error::{PlanError, all_finite};
use crate::observation::GridSites;
use palpate_numeric::simd::{BandTerm, Isa, contract_rows};

/// What the images of a frame are called in messages.
pub(super) const IMAGES: [&str; 3] = ["z", "zx", "zy"];

/// Axes, bases and buffers; nothing is allocated after they are made.
#[derive(Clone, Debug)]
pub(super) struct Contraction {
    sites: GridSites,
    /// N, N' and N again along x, times the squared weights of values, x slopes and y slopes.
    weighted: [Vec<f64>; 3],
    /// `B_x' Z` of values with x slopes, and of y slopes: n x pixels in y.
    half: [Vec<f64>; 2],
    /// The same transposed.
    transposed: [Vec<f64>; 2],
    right: Vec<f64>,
}

impl Contraction {
    /// For pixels at these sites and block weights.
    pub(super) fn new(sites: GridSites, weights: [f64; 3]) -> Contraction {
        let [ax, ay] = sites.axes();
        let [n, m] = [ax, ay].map(|axis| axis.knots.n_basis());
        let half = n * ay.first.len();
        let scaled = |table: &[f64], w: f64| table.iter().map(|v| v * w * w).collect();
        let weighted = [scaled(&ax.values, weights[0]), scaled(&ax.slopes, weights[1]), scaled(&ax.values, weights[2])];
        Contraction {
            weighted,
            half: [vec![0.0; half], vec![0.0; half]],
            transposed: [vec![0.0; half], vec![0.0; half]],
            right: vec![0.0; n * m],
            sites,
        }
    }

    /// Pixels in x and in y.
    pub(super) fn pixels(&self) -> [usize; 2] {
        self.sites.axes().each_ref().map(|axis| axis.first.len())
    }

    /// Checks that every image is as large as the axes say.
    ///
    /// # Errors
    /// [`PlanError::Shape`].
    pub(super) fn check_views<T>(&self, views: &[ArrayView2<'_, T>; 3]) -> Result<(), PlanError> {
        let expected = self.pixels();
        for (image, view) in IMAGES.into_iter().zip(views) {
            let found = [view.nrows(), view.ncols()];
            if found != expected {
                return Err(PlanError::Shape { image, found, expected });
            }
        }
        Ok(())
    }

    /// Begins another frame.
    pub(super) fn clear(&mut self) {
        self.half.iter_mut().for_each(|h| h.fill(0.0));
    }

    /// Adds consecutive rows of the images, the first of them number `from`, to `half`.
    pub(super) fn contract_x(&mut self, from: usize, images: [&[f64]; 3]) {
        let isa = Isa::active();
        let [ax, ay] = self.sites.axes();
        let (width, pixels) = (ax.knots.degree() + 1, ay.first.len());
        let rows = from..from + images[0].len() / pixels;
        let first = &ax.first[rows.clone()];
        let [values, slopes, across] =
            self.weighted.each_ref().map(|table| &table[rows.start * width..rows.end * width]);
        let term = |values, image| BandTerm { values, image };
        let along = [term(values, images[0]), term(slopes, images[1])];
        contract_rows(isa, width, first, &along, pixels, &mut self.half[0]);
        contract_rows(isa, width, first, &[term(across, images[2])], pixels, &mut self.half[1]);
    }

    /// From `half` to the right-hand side; whether all of it is finite.
    pub(super) fn contract_y(&mut self) -> bool {
        let [ax, ay] = self.sites.axes();
        let (n, pixels) = (ax.knots.n_basis(), ay.first.len());
        for (transposed, half) in self.transposed.iter_mut().zip(&self.half) {
            transpose(half, n, pixels, transposed);
        }
        self.right.fill(0.0);
        let term = |values, image| BandTerm { values, image };
        let terms = [term(&ay.values[..], &self.transposed[0][..]), term(&ay.slopes[..], &self.transposed[1][..])];
        contract_rows(Isa::active(), ay.knots.degree() + 1, &ay.first, &terms, n, &mut self.right);
        all_finite(&self.right)
    }

    /// The right-hand side, n x m, row-major.
    pub(super) fn write_right_side(&self, out: &mut [f64]) {
        let [n, m] = self.sites.axes().each_ref().map(|axis| axis.knots.n_basis());
        transpose(&self.right, m, n, out);
    }
}

/// Checks a pixel axis.
pub(super) fn check_axis(axis: &'static str, values: &[f64]) -> Result<(), PlanError> {
    if values.is_empty() {
        return Err(PlanError::Length { column: axis, found: 0, expected: 1 });
    }
    for (index, &value) in values.iter().enumerate() {
        if !value.is_finite() {
            return Err(PlanError::Axis { axis, index, value, expected: "a finite number" });
        }
        if index > 0 && value <= values[index - 1] {
            return Err(PlanError::Axis { axis, index, value, expected: "above the entry before it" });
        }
    }
    Ok(())
}

/// `out (columns x rows) = from'`, in squares that stay in the first-level cache.
fn transpose(from: &[f64], rows: usize, columns: usize, out: &mut [f64]) {
    const SIDE: usize = 8;
    for i0 in (0..rows).step_by(SIDE) {
        for j0 in (0..columns).step_by(SIDE) {
            for j in j0..(j0 + SIDE).min(columns) {
                for i in i0..(i0 + SIDE).min(rows) {
                    out[j * rows + i] = from[i * columns + j];
                }
            }
        }
    }
}
