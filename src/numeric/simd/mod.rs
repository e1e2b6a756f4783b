//! The inner loops (kernels). Each is written once over SIMD lanes, compiled for three instruction sets, and the set is
//! chosen at run time.
//!
//! | kernel | formula |
//! |---|---|
//! | [`curvature_row`], [`derivative_row`] | all derivatives of a tensor spline along one row of a grid of points; S and R |
//! | [`patch_maps`] | the same over a small grid on one segment, all rows in one call |
//! | [`factor_columns`], [`factor_dense`], [`invert_columns`] | Cholesky of 9, 16 or 25 unknowns, and of a few hundred; the inverse |
//! | [`combine_rows`], [`gram_rows`] | rows J of one cell from its jets, and `J' J` |
//! | [`moments`] | `sum_r w_r u_r^a v_r^b`, from which a cell's part of the normal matrix follows |
//! | [`gaussian_triples`], [`chacha8`] | gaussians from addressed random words |
//! | [`cell_curves`], [`shape_gradients`] | derivatives of S and R at eight points by a cell's coefficients |
//! | [`products_pass`], [`last_pass`], [`columns_pass`], [`norms_pass`] | residuals, sizes of their terms and `E'r` over eight sites of a cell |
//! | [`cell_basis`], [`cell_products`], [`cell_squares`], [`cell_values`] | `E'(b - E c)`, `|b - E c|^2` and S, S_x, S_y over the sites of a cell, from its polynomial |
//! | [`functional_bounds`] | bounds of the errors of functionals of the coefficients, two kinds at eight points |
//! | [`bilinear`] | `sum_t X_t G_t Y_t`: a cell's part of the normal matrix from its moments |
//! | [`factor_block`], [`update_block`], [`forward_block`], [`backward_block`] | Cholesky and substitution in panels of a band |
//! | [`subtract_product`] | `C -= A B'` for matrices in the band's panels |
//! | [`add_draws`], [`mean_shapes`] | noise added to contacts, and S and R averaged over a grid, eight replicates at once |
//! | [`displaced_shapes`] | S, R and both curvatures of eight displaced surfaces at points of one chart |
//! | [`multiply_add_peak`] | `a x + b` alone: the peak that benches compare the other kernels with |
//! | [`contract_rows`] | `B' Z` for a basis with p + 1 values a row, one pass over an image |
//!
//! This is the only room with unsafe code: the intrinsics, and the calls into functions that carry an instruction
//! set. Every kernel has a twin in safe, plain Rust, and a test limits the largest difference between the two.
//! Machines other than x86-64 have the portable lanes only.
#![allow(unsafe_code)] // intrinsics, and calls into functions that carry an instruction set: only here

mod arctangent;
mod bilinear;
mod block_columns;
mod block_substitution;
mod cell_rows;
mod cell_sites;
mod chacha8;
mod combine_rows;
mod contract_rows;
mod curvature_row;
mod dense_columns;
mod displaced_shapes;
mod functional_bounds;
mod gaussian;
mod gram_rows;
mod isa;
mod lanes;
mod moments;
mod panel_products;
mod patch_maps;
mod peak;
mod replicate_lanes;
mod shape_gradients;
mod shape_maps;
mod sine;
mod site_passes;

pub use bilinear::{BilinearTerm, bilinear};
pub use block_columns::{BlockShape, GRAIN, PADDING, factor_block, update_block};
pub use block_substitution::{backward_block, forward_block};
pub use cell_rows::{CellPiece, CellPowers, cell_basis, cell_products, cell_squares, cell_values};
pub use cell_sites::{CellSites, CellVectors, ColumnSums, RowSums, SITES, SiteLanes};
pub use chacha8::{BLOCKS as CHACHA_BLOCKS, WORDS as CHACHA_WORDS, chacha8};
pub use combine_rows::{RowTerm, combine_rows};
pub use contract_rows::{BandTerm, contract_rows};
pub use curvature_row::{RowPieces, RowScratch, curvature_row, derivative_row};
pub use dense_columns::{DenseColumns, factor_columns, factor_dense, invert_columns};
pub use displaced_shapes::{ChartBasis, EightShapes, EightSurfaces, SURFACES, displaced_shapes};
pub use functional_bounds::{BoundTerms, CellGradients, DirectedTerms, OfKinds, functional_bounds};
pub use gaussian::gaussian_triples;
pub use gram_rows::gram_rows;
pub use isa::Isa;
pub use moments::{CellMoments, MAX_MOMENT_DEGREE, MomentPowers, moments};
pub use panel_products::{Panels, ProductSize, subtract_product};
pub use patch_maps::{PATCH_POINTS, patch_maps};
pub use peak::multiply_add_peak;
pub use replicate_lanes::REPLICATES;
pub use replicate_lanes::{GridTables, add_draws, mean_shapes};
pub use shape_gradients::{
    CellPoints, CurveLanes, ORDERS, POINTS, PointLanes, PointShapes, ROUNDING, cell_curves, shape_gradients,
};
pub use shape_maps::shape_maps_twin;
pub use site_passes::{add_lanes, columns_pass, last_pass, norms_pass, products_pass};

/// Compiles `generic::<Lanes>` into one function for each instruction set and calls the one of `isa`.
macro_rules! dispatch {
    ($isa:expr, $generic:ident [$($konst:ident),*] ($($arg:ident : $ty:ty),* $(,)?) $(-> $ret:ty)?) => {{
        use $crate::simd::lanes::Kind;
        #[cfg(target_arch = "x86_64")]
        use $crate::simd::lanes::Detected;
        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx2,fma,bmi2")]
        fn on_avx512<D: Detected, $(const $konst: usize),*>(_: D, $($arg: $ty),*) $(-> $ret)? {
            $generic::<D::Lanes, $($konst),*>($($arg),*)
        }
        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2,fma,bmi2")]
        fn on_avx2<D: Detected, $(const $konst: usize),*>(_: D, $($arg: $ty),*) $(-> $ret)? {
            $generic::<D::Lanes, $($konst),*>($($arg),*)
        }
        match $isa.kind() {
            // SAFETY: `detected` is only made after the processor was asked for the features that the function carries
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 { detected } => unsafe { on_avx512::<_, $($konst),*>(detected, $($arg),*) },
            // SAFETY: as above
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 { detected } => unsafe { on_avx2::<_, $($konst),*>(detected, $($arg),*) },
            Kind::Portable => $generic::<$crate::simd::lanes::Portable, $($konst),*>($($arg),*),
        }
    }};
}
use dispatch;

/// Calls `kernel::<_, P, Q>` with literal widths for cells of 3 x 3, 4 x 4 and 5 x 5 coefficients, and with zeros for all
/// others; zero stands for the length of the slices. The compiler unrolls loops of known length and leaves out their
/// bounds checks.
macro_rules! by_width {
    ($isa:expr, $widths:expr, $kernel:ident($($arg:ident : $ty:ty),* $(,)?) $(-> $ret:ty)?) => {
        match $widths {
            [3, 3] => by_width!(@ $isa, $kernel, 3, ($($arg: $ty),*) $(-> $ret)?),
            [4, 4] => by_width!(@ $isa, $kernel, 4, ($($arg: $ty),*) $(-> $ret)?),
            [5, 5] => by_width!(@ $isa, $kernel, 5, ($($arg: $ty),*) $(-> $ret)?),
            _ => by_width!(@ $isa, $kernel, 0, ($($arg: $ty),*) $(-> $ret)?),
        }
    };
    (@ $isa:expr, $kernel:ident, $width:literal, ($($arg:ident : $ty:ty),*) $(-> $ret:ty)?) => {{
        #[inline(always)]
        fn generic<V: Lanes>($($arg: $ty),*) $(-> $ret)? {
            $kernel::<V, $width, $width>($($arg),*)
        }
        dispatch!($isa, generic []($($arg: $ty),*) $(-> $ret)?)
    }};
}
use by_width;

/// Distance of two numbers in units of the last place of `expected`.
#[cfg(test)]
fn ulps(value: f64, expected: f64) -> f64 {
    if value == expected || (value.is_nan() && expected.is_nan()) {
        return 0.0;
    }
    let unit = (expected.abs().next_up() - expected.abs()).max(f64::MIN_POSITIVE * f64::EPSILON);
    (value - expected).abs() / unit
}

/// Collects the largest difference between a kernel and its twin, to print it and to limit it:
/// `cargo test -p palpate-numeric simd -- --nocapture`.
#[cfg(test)]
struct Twins {
    kernel: &'static str,
    isa: Isa,
    difference: f64,
    size: f64,
}

#[cfg(test)]
impl Twins {
    fn new(kernel: &'static str, isa: Isa) -> Twins {
        Twins { kernel, isa, difference: 0.0, size: 0.0 }
    }

    fn compare(&mut self, value: f64, expected: f64) {
        let gap = (value - expected).abs();
        // written such that NaN counts as the largest difference
        self.difference = if gap <= self.difference { self.difference } else { gap };
        self.size = self.size.max(expected.abs());
    }

    /// Prints the largest difference in ulp of the largest number and holds it below `most` of them.
    fn hold(&self, most: f64) {
        let found = self.difference / (self.size * f64::EPSILON);
        println!(
            "{:<18} {:<9} largest difference {found:>6.1} ulp of the largest number",
            self.kernel,
            self.isa.name()
        );
        assert!(found < most, "{} {}: {found} ulp", self.kernel, self.isa.name());
    }
}
