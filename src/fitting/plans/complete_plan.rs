//! Repeated fits of complete images with slopes: planned once, then fitted frame by frame.
//!
//! ```text
//! C = U ((U' B V) / D) V',   B the images times the basis (contraction.rs)     n x m, by fast diagonalisation
//! ```
//!
//! R. E. Lynch, J. R. Rice, D. H. Thomas, *Numer. Math.* 6 (1964) 185. No fit after the first allocates memory.

use ndarray::ArrayView2;

use super::contraction::{Contraction, IMAGES, check_axis};
use super::error::{PlanError, check_weights};
use super::pixel::Pixel;
use crate::observation::GridSites;
use palpate_numeric::bspline::Knots;
use palpate_numeric::solve::FastDiagonalisation;

/// A stream of complete images.
#[derive(Clone, Debug)]
pub(super) struct CompletePlan {
    contraction: Contraction,
    solver: FastDiagonalisation,
    /// One row of pixels of each image, converted, for images that are not contiguous rows of `f64`.
    converted: [Vec<f64>; 3],
    coefficients: Vec<f64>,
}

impl CompletePlan {
    /// Plans for pixels at `x` by `y`, both increasing, these knots and the block weights `[wz, wx, wy]`, which multiply
    /// residuals.
    ///
    /// # Errors
    /// [`PlanError::Axis`] and [`PlanError::Weight`]; an axis with too few pixels for its knots.
    pub(crate) fn new(knots: [Knots; 2], x: &[f64], y: &[f64], weights: [f64; 3]) -> Result<CompletePlan, PlanError> {
        check_weights(weights)?;
        check_axis("x", x)?;
        check_axis("y", y)?;
        let sites = GridSites::new(knots, x, y);
        let [ax, ay] = sites.axes();
        let grams = [ax, ay].map(|axis| [axis.gram(0, None), axis.gram(1, None)]);
        let [gx, gy] = &grams;
        let solver = FastDiagonalisation::new([&gx[0], &gx[1]], [&gy[0], &gy[1]], weights)?;
        let unknowns = gx[0].len() * gy[0].len();
        Ok(CompletePlan {
            contraction: Contraction::new(sites, weights),
            solver,
            converted: std::array::from_fn(|_| vec![0.0; y.len()]),
            coefficients: vec![0.0; unknowns],
        })
    }

    /// Fits one frame and returns the coefficients, n x m, row-major. Heights and slopes are row-major pixels [x, y].
    ///
    /// # Errors
    /// [`PlanError::Length`] for an image that is not as large as the axes say; [`PlanError::Pixel`] for a NaN or
    /// infinite pixel; [`PlanError::Overflow`].
    pub(crate) fn fit_frame(&mut self, z: &[f64], zx: &[f64], zy: &[f64]) -> Result<&[f64], PlanError> {
        let [_, along_y] = self.contraction.pixels();
        let expected = self.contraction.pixels().iter().product();
        for (column, image) in IMAGES.into_iter().zip([z, zx, zy]) {
            if image.len() != expected {
                return Err(PlanError::Length { column, found: image.len(), expected });
            }
        }
        self.contraction.clear();
        self.contraction.contract_x(0, [z, zx, zy]);
        let is_finite = self.contraction.contract_y();
        if !is_finite {
            return Err(culprit([z, zx, zy].map(|image| image.iter().copied()), along_y));
        }
        Ok(self.solve())
    }

    /// Fits one frame given as views of `f64` or `f32` pixels, indexed [x, y], in any memory order.
    ///
    /// Row-major `f64` views are read where they lie; of others one row at a time is converted.
    ///
    /// # Errors
    /// [`PlanError::Shape`] for an image that is not as large as the axes say; [`PlanError::Pixel`];
    /// [`PlanError::Overflow`].
    pub(crate) fn fit_views<T: Pixel>(
        &mut self,
        z: ArrayView2<'_, T>,
        zx: ArrayView2<'_, T>,
        zy: ArrayView2<'_, T>,
    ) -> Result<&[f64], PlanError> {
        let (views, expected) = ([z, zx, zy], self.contraction.pixels());
        self.contraction.check_views(&views)?;
        if let [Some(z), Some(zx), Some(zy)] = views.each_ref().map(|view| view.as_slice().and_then(T::as_f64)) {
            return self.fit_frame(z, zx, zy);
        }
        self.contraction.clear();
        let mut rows = std::mem::take(&mut self.converted);
        for i in 0..expected[0] {
            for (row, view) in rows.iter_mut().zip(&views) {
                row.iter_mut().zip(view.row(i)).for_each(|(to, from)| *to = (*from).into());
            }
            self.contraction.contract_x(i, rows.each_ref().map(|row| &row[..]));
        }
        self.converted = rows;
        if !self.contraction.contract_y() {
            return Err(culprit(views.each_ref().map(|view| view.iter().map(|v| (*v).into())), expected[1]));
        }
        Ok(self.solve())
    }

    fn solve(&mut self) -> &[f64] {
        self.contraction.write_right_side(&mut self.coefficients);
        self.solver.solve(&mut self.coefficients);
        &self.coefficients
    }
}

/// The pixel that made a sum NaN or infinite; `images` are row-major with rows of `along_y` pixels.
#[cold]
fn culprit(images: [impl Iterator<Item = f64>; 3], along_y: usize) -> PlanError {
    for (image, mut pixels) in IMAGES.into_iter().zip(images) {
        if let Some((k, value)) = pixels.by_ref().enumerate().find(|(_, value)| !value.is_finite()) {
            return PlanError::Pixel { image, index: [k / along_y, k % along_y], value };
        }
    }
    PlanError::Overflow
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;
    use palpate_numeric::bspline::linspace;

    fn plan() -> CompletePlan {
        let knots = [Knots::uniform(3, 4, 0.0, 1.0).unwrap(), Knots::uniform(2, 5, 0.0, 2.0).unwrap()];
        CompletePlan::new(knots, &linspace(0.0, 1.0, 13), &linspace(0.0, 2.0, 19), [1.0, 0.5, 2.0]).unwrap()
    }

    fn image(k: f64) -> Array2<f64> {
        // single-precision numbers, so that both types hold the same image
        Array2::from_shape_fn((13, 19), |(i, j)| f64::from(((19 * i + j) as f64 * k).sin() as f32))
    }

    #[test]
    fn views_of_either_type_and_order_give_the_frame_fit() {
        let (mut plan, images) = (plan(), [0.37, 0.71, 1.3].map(image));
        let [z, zx, zy] = &images;
        let expected =
            plan.fit_frame(z.as_slice().unwrap(), zx.as_slice().unwrap(), zy.as_slice().unwrap()).unwrap().to_vec();
        assert_eq!(plan.fit_views(z.view(), zx.view(), zy.view()).unwrap(), expected);
        let near = |found: &[f64]| found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12);
        let by_columns = images.each_ref().map(|image| image.t().as_standard_layout().to_owned());
        let [a, b, c] = by_columns.each_ref().map(|image| image.t());
        assert!(near(plan.fit_views(a, b, c).unwrap()));
        let single = images.each_ref().map(|image| image.mapv(|v| v as f32));
        assert!(near(plan.fit_views(single[0].view(), single[1].view(), single[2].view()).unwrap()));
    }

    #[test]
    fn a_faulty_image_is_named_and_the_next_frame_is_clean() {
        let (mut plan, images) = (plan(), [0.37, 0.71, 1.3].map(image));
        let [z, zx, zy] = &images;
        let expected = plan.fit_views(z.view(), zx.view(), zy.view()).unwrap().to_vec();
        for (k, name) in IMAGES.into_iter().enumerate() {
            let mut bad = images.clone();
            bad[k][[4, 7]] = f64::NAN;
            let [z, zx, zy] = &bad;
            let found = plan.fit_views(z.view(), zx.view(), zy.view()).map(<[f64]>::to_vec);
            assert!(matches!(found, Err(PlanError::Pixel { image, index: [4, 7], .. }) if image == name), "{found:?}");
            let [z, zx, zy] = bad.each_ref().map(|image| image.mapv(|v| v as f32));
            assert!(matches!(plan.fit_views(z.view(), zx.view(), zy.view()), Err(PlanError::Pixel { .. })));
        }
        assert_eq!(plan.fit_views(z.view(), zx.view(), zy.view()).unwrap(), expected);
        assert!(matches!(plan.fit_frame(&[0.0], &[0.0], &[0.0]), Err(PlanError::Length { column: "z", .. })));
        let small = Array2::<f64>::zeros((2, 2));
        let shapes = plan.fit_views(z.view(), small.view(), zy.view());
        assert!(matches!(shapes, Err(PlanError::Shape { image: "zx", .. })));
    }

    #[test]
    fn a_faulty_axis_or_weight_is_refused() {
        let knots = || [Knots::uniform(2, 1, 0.0, 1.0).unwrap(), Knots::uniform(2, 1, 0.0, 1.0).unwrap()];
        let good = linspace(0.0, 1.0, 5);
        for bad in [&[0.0, f64::NAN, 1.0][..], &[0.0, 0.5, 0.5, 1.0], &[1.0, 0.5, 0.0]] {
            assert!(matches!(CompletePlan::new(knots(), bad, &good, [1.0; 3]), Err(PlanError::Axis { axis: "x", .. })));
        }
        assert!(matches!(CompletePlan::new(knots(), &good, &[], [1.0; 3]), Err(PlanError::Length { column: "y", .. })));
        let weights = [1.0, 1.0, f64::NAN];
        assert!(matches!(CompletePlan::new(knots(), &good, &good, weights), Err(PlanError::Weight { .. })));
    }
}
