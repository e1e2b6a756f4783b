//! Repeated fits of images with a mask or weight maps that stay: planned once, then fitted frame by frame.
//!
//! ```text
//! A = E'W^2 E, factored once      c = A^-1 E'W^2 b, b the frame; pixels of weight 0 are not looked at
//! free coefficients F, held ones D:      P_FF c_F = -P_FD c_D,   A_DD c_D = (E'W^2 b)_D - A_DF c_F     in turn
//! ```
//!
//! A mask breaks the Kronecker structure of the matrix, but not that of the right-hand side, which is most of the work of
//! a frame. P is the roughness, as for gaps in a single fit.

use ndarray::ArrayView2;

use super::contraction::{Contraction, IMAGES, check_axis};
use super::error::{PlanError, check_weights};
use super::pixel::Pixel;
use crate::fit::Free;
use crate::observation::{GridSites, RoughnessOrder, roughness_matrix};
use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg::{RowWeights, SiteWeights, Sites, StencilMatrix, assemble};
use palpate_numeric::solve::Cholesky;

/// Rows of pixels that are weighted before they are contracted: together with their weights they stay in the cache.
const ROWS: usize = 8;
/// Alternations of held and free coefficients at most, as in a single fit.
const MAX_ALTERNATIONS: usize = 40;
const MAPS: [&str; 3] = ["wz", "wx", "wy"];

/// A stream of images of which every pixel has weights of its own.
#[derive(Clone, Debug)]
pub(super) struct MaskedPlan {
    contraction: Contraction,
    /// Squared weights of values, x slopes and y slopes, row-major.
    squares: [Vec<f64>; 3],
    matrix: StencilMatrix,
    factor: Cholesky,
    gaps: Option<Gaps>,
    /// A few weighted rows of pixels of each image.
    rows: [Vec<f64>; 3],
    right: Vec<f64>,
    coefficients: Vec<f64>,
}

/// What fills in the coefficients that the mask leaves without data.
#[derive(Clone, Debug)]
struct Gaps {
    free: Free,
    list: Vec<usize>,
    penalty: StencilMatrix,
    smooth: Cholesky,
    buffer: Vec<f64>,
    before: Vec<f64>,
}

impl MaskedPlan {
    /// Plans for pixels at `x` by `y`, both increasing, these knots, and maps of the weights of heights, x slopes and y
    /// slopes, indexed [x, y], which multiply residuals.
    ///
    /// # Errors
    /// [`PlanError::Axis`], [`PlanError::Weight`], [`PlanError::Shape`] of a map; [`PlanError::Solve`] where the pixels
    /// that are left determine no surface.
    pub(crate) fn new(
        knots: [Knots; 2],
        x: &[f64],
        y: &[f64],
        weights: [ArrayView2<'_, f64>; 3],
    ) -> Result<MaskedPlan, PlanError> {
        check_axis("x", x)?;
        check_axis("y", y)?;
        let expected = [x.len(), y.len()];
        for (image, map) in MAPS.into_iter().zip(&weights) {
            let found = [map.nrows(), map.ncols()];
            if found != expected {
                return Err(PlanError::Shape { image, found, expected });
            }
        }
        let [wz, wx, wy] = &weights;
        for ((z, a), d) in wz.iter().zip(wx).zip(wy) {
            check_weights([*z, *a, *d])?;
        }
        let sites = GridSites::new(knots.clone(), x, y);
        let of = |((z, a), d): ((&f64, &f64), &f64)| SiteWeights { z: *z, a: *a, b: 0.0, d: *d };
        let row_weights = RowWeights::PerSite(wz.iter().zip(wx).zip(wy).map(of).collect());
        let mut matrix = StencilMatrix::zeros(sites.shape());
        assemble(&sites, &row_weights, &mut matrix);
        let free = Free::find(&matrix, false);
        let mut factor = Cholesky::plan(matrix.shape())?;
        factor.factor(free.mask(&matrix).as_ref().unwrap_or(&matrix))?;
        let unknowns = matrix.order();
        Ok(MaskedPlan {
            contraction: Contraction::new(sites, [1.0; 3]),
            squares: weights.map(|map| map.iter().map(|w| w * w).collect()),
            factor,
            gaps: if free.is_empty() { None } else { Some(Gaps::new(free, &knots)?) },
            matrix,
            rows: std::array::from_fn(|_| vec![0.0; ROWS * y.len()]),
            right: vec![0.0; unknowns],
            coefficients: vec![0.0; unknowns],
        })
    }

    /// Numbers of the coefficients that the mask leaves without data, or nearly so; they take the values of least
    /// roughness.
    pub(crate) fn unsupported(&self) -> &[usize] {
        self.gaps.as_ref().map_or(&[], |gaps| &gaps.list)
    }

    /// Fits one frame given as views of `f64` or `f32` pixels, indexed [x, y], in any memory order, and returns the
    /// coefficients, n x m, row-major. Pixels of weight 0 are not looked at and may be NaN.
    ///
    /// # Errors
    /// [`PlanError::Shape`] for an image that is not as large as the axes say; [`PlanError::Pixel`] for a NaN or
    /// infinite pixel under a weight; [`PlanError::Overflow`].
    pub(crate) fn fit_views<T: Pixel>(
        &mut self,
        z: ArrayView2<'_, T>,
        zx: ArrayView2<'_, T>,
        zy: ArrayView2<'_, T>,
    ) -> Result<&[f64], PlanError> {
        let (views, expected) = ([z, zx, zy], self.contraction.pixels());
        self.contraction.check_views(&views)?;
        self.contraction.clear();
        for from in (0..expected[0]).step_by(ROWS) {
            let to = (from + ROWS).min(expected[0]);
            for ((out, view), squares) in self.rows.iter_mut().zip(&views).zip(&self.squares) {
                for i in from..to {
                    let squares = &squares[i * expected[1]..][..expected[1]];
                    weigh(view, i, squares, &mut out[(i - from) * expected[1]..][..expected[1]]);
                }
            }
            let used = (to - from) * expected[1];
            self.contraction.contract_x(from, self.rows.each_ref().map(|rows| &rows[..used]));
        }
        if !self.contraction.contract_y() {
            return Err(self.culprit(&views));
        }
        self.contraction.write_right_side(&mut self.right);
        self.solve();
        Ok(&self.coefficients)
    }

    /// The same of row-major pixels.
    ///
    /// # Errors
    /// [`PlanError::Length`] for an image that is not as large as the axes say, and as [`MaskedPlan::fit_views`].
    pub(crate) fn fit_frame(&mut self, z: &[f64], zx: &[f64], zy: &[f64]) -> Result<&[f64], PlanError> {
        let [along_x, along_y] = self.contraction.pixels();
        let expected = along_x * along_y;
        let view = |column, image| {
            let wrong = PlanError::Length { column, found: <[f64]>::len(image), expected };
            ArrayView2::from_shape((along_x, along_y), image).ok().filter(|_| image.len() == expected).ok_or(wrong)
        };
        let [of_z, of_zx, of_zy] = IMAGES;
        self.fit_views(view(of_z, z)?, view(of_zx, zx)?, view(of_zy, zy)?)
    }

    fn solve(&mut self) {
        let Some(gaps) = &mut self.gaps else {
            self.coefficients.copy_from_slice(&self.right);
            return self.factor.solve(&mut self.coefficients);
        };
        self.coefficients.fill(0.0);
        for alternation in 0..MAX_ALTERNATIONS {
            gaps.before.copy_from_slice(&self.coefficients);
            self.matrix.multiply(&gaps.before, &mut gaps.buffer);
            gaps.buffer.iter_mut().zip(&self.right).for_each(|(a, b)| *a = b - *a);
            gaps.free.clear(&mut gaps.buffer);
            self.factor.solve(&mut gaps.buffer);
            self.coefficients.iter_mut().zip(&gaps.buffer).for_each(|(c, d)| *c += d);
            gaps.fill_in(&mut self.coefficients);
            let largest = self.coefficients.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let moves = gaps.before.iter().zip(&self.coefficients).map(|(a, b)| (a - b).abs());
            if alternation > 0 && moves.fold(0.0_f64, f64::max) <= 4.0 * f64::EPSILON * largest {
                break;
            }
        }
    }

    /// The pixel under a weight that made a sum NaN or infinite.
    #[cold]
    fn culprit<T: Pixel>(&self, views: &[ArrayView2<'_, T>; 3]) -> PlanError {
        for ((image, view), squares) in IMAGES.into_iter().zip(views).zip(&self.squares) {
            let pixels = view.indexed_iter().zip(squares).filter(|(_, square)| **square != 0.0);
            for (((i, j), pixel), _) in pixels {
                let value: f64 = (*pixel).into();
                if !value.is_finite() {
                    return PlanError::Pixel { image, index: [i, j], value };
                }
            }
        }
        PlanError::Overflow
    }
}

impl Gaps {
    fn new(free: Free, knots: &[Knots; 2]) -> Result<Gaps, PlanError> {
        let penalty = roughness_matrix(knots, RoughnessOrder::Second.terms());
        let mut smooth = Cholesky::plan(penalty.shape())?;
        smooth.factor(&free.keep(&penalty))?;
        let zeros = vec![0.0; penalty.order()];
        Ok(Gaps { list: free.list(), free, penalty, smooth, buffer: zeros.clone(), before: zeros })
    }

    /// Gives the free coefficients the values of least roughness beside the held ones.
    fn fill_in(&mut self, c: &mut [f64]) {
        self.free.clear(c);
        self.penalty.multiply(c, &mut self.buffer);
        for (u, b) in self.buffer.iter_mut().enumerate() {
            *b = if self.free.has(u) { -*b } else { 0.0 };
        }
        self.smooth.solve(&mut self.buffer);
        self.list.iter().for_each(|&u| c[u] = self.buffer[u]);
    }
}

/// Row `i` of an image times the squared weights; a pixel of weight 0 is 0, whatever it holds.
fn weigh<T: Pixel>(view: &ArrayView2<'_, T>, i: usize, squares: &[f64], out: &mut [f64]) {
    let row = view.row(i);
    let times = |pixel: T, square: f64| if square == 0.0 { 0.0 } else { square * pixel.into() };
    match row.as_slice() {
        Some(row) => {
            out.iter_mut().zip(row).zip(squares).for_each(|((out, pixel), square)| *out = times(*pixel, *square));
        }
        None => {
            out.iter_mut().zip(row).zip(squares).for_each(|((out, pixel), square)| *out = times(*pixel, *square));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{FitOptions, Objective, SlopeWeights, fit_grid};
    use ndarray::Array2;
    use palpate_geometry::contact::Grid;
    use palpate_numeric::bspline::linspace;

    const SIDES: (usize, usize) = (61, 47);

    fn image(k: f64) -> Array2<f64> {
        // single-precision numbers, so that both types hold the same image
        Array2::from_shape_fn(SIDES, |(i, j)| f64::from(((i as f64 * k).sin() * (0.07 * j as f64).cos()) as f32))
    }

    /// The plan's coefficients are those of a single fit of the same pixels, weights and knots.
    fn compare(weights: &Array2<f64>) -> usize {
        let (x, y) = (linspace(0.0, 2.0, SIDES.0), linspace(0.0, 2.0, SIDES.1));
        let knots = [Knots::uniform(3, 9, 0.0, 2.0).unwrap(), Knots::uniform(3, 7, 0.0, 2.0).unwrap()];
        let slopes = weights.mapv(|w| 0.5 * w);
        let maps = [weights.view(), slopes.view(), slopes.view()];
        let mut plan = MaskedPlan::new(knots, &x, &y, maps).unwrap();
        let images = [0.05, 0.09, 0.13].map(image);
        let [z, zx, zy] = &images;
        let grid = Grid {
            zx: Some(zx.clone()),
            zy: Some(zy.clone()),
            wz: Some(weights.clone()),
            wx: Some(slopes.clone()),
            wy: Some(slopes.clone()),
            ..Grid::new(x.clone(), y.clone(), z.clone())
        };
        let objective = Objective::Slopes(SlopeWeights::Explicit([1.0; 3]));
        let options = FitOptions { degree: [3, 3], segments: [9, 7], objective, ..FitOptions::default() };
        let fit = fit_grid(&grid, &options).unwrap();
        let expected = fit.input_surface().unwrap();
        let size = expected.coefficients().iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let near = |found: &[f64]| found.iter().zip(expected.coefficients()).all(|(a, b)| (a - b).abs() < 1e-10 * size);
        assert!(near(plan.fit_views(z.view(), zx.view(), zy.view()).unwrap()));
        // masked pixels are not looked at; both types and orders give the same
        let hidden = images.each_ref().map(|image| {
            let mut image = image.mapv(|v| v as f32);
            image.zip_mut_with(weights, |v, w| *v = if *w == 0.0 { f32::NAN } else { *v });
            image
        });
        assert!(near(plan.fit_views(hidden[0].view(), hidden[1].view(), hidden[2].view()).unwrap()));
        let by_columns = images.each_ref().map(|image| image.t().as_standard_layout().to_owned());
        assert!(near(plan.fit_views(by_columns[0].t(), by_columns[1].t(), by_columns[2].t()).unwrap()));
        assert_eq!(plan.unsupported(), &fit.solution().unsupported[..]);
        plan.unsupported().len()
    }

    #[test]
    fn masked_and_weighted_frames_are_the_single_fits() {
        let weighted = Array2::from_shape_fn(SIDES, |(i, j)| 1.0 + 0.3 * ((i + 2 * j) as f64).sin());
        assert_eq!(compare(&weighted), 0);
        let dead = Array2::from_shape_fn(SIDES, |(i, j)| if (7 * i + 3 * j) % 11 == 0 { 0.0 } else { 1.0 });
        assert_eq!(compare(&dead), 0);
        let away = |i: usize, j: usize| (i as f64 - 30.0).hypot(j as f64 - 20.0);
        let hole = Array2::from_shape_fn(SIDES, |(i, j)| if away(i, j) < 15.0 { 0.0 } else { 1.0 });
        assert!(compare(&hole) > 0);
    }

    #[test]
    fn a_faulty_map_or_pixel_is_named() {
        let axis = Knots::uniform(2, 1, 0.0, 1.0).unwrap();
        let points = linspace(0.0, 1.0, 6);
        let plan = |map: &Array2<f64>| {
            MaskedPlan::new([axis.clone(), axis.clone()], &points, &points, [map.view(), map.view(), map.view()])
        };
        let ones = Array2::ones((6, 6));
        let mut bad = ones.clone();
        bad[[2, 3]] = f64::NAN;
        assert!(matches!(plan(&bad), Err(PlanError::Weight { .. })));
        assert!(matches!(plan(&Array2::ones((6, 5))), Err(PlanError::Shape { image: "wz", .. })));
        assert!(matches!(plan(&Array2::zeros((6, 6))), Err(PlanError::Solve(_))));
        let mut plan = plan(&ones).unwrap();
        let found = plan.fit_views(bad.view(), ones.view(), ones.view()).map(<[f64]>::to_vec);
        assert!(matches!(found, Err(PlanError::Pixel { image: "z", index: [2, 3], .. })), "{found:?}");
    }
}
