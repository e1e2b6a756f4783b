//! Repeated fits of scattered contacts with slopes: planned once, then fitted as often as data come.
//!
//! ```text
//! contacts -> moments per knot cell -> A = E'W^2 E, b = E'W^2 d -> L L' = A -> c        (n m unknowns)
//! ```
//!
//! The rows are slope rows with one weight per block, in the coordinates of the knots. The frame, the certificate and
//! the uncertainties are added by [`crate::fit::fit_contacts`]. No fit after the first allocates memory.

use super::error::{PlanError, all_finite, check_weights};
use crate::observation::{CellAssembly, CellRows};
use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg::{RowWeights, SiteWeights, StencilMatrix};
use palpate_numeric::solve::Cholesky;

/// Repeated fits of scattered contacts with slopes under fixed knots and weights.
///
/// ```
/// # use palpate_fitting::facade as palpate;
/// use palpate::spline::Knots;
/// use palpate::plans::{SlopeColumns, SlopePlan};
///
/// // z = x^2 touched at nine places, with its slopes
/// let axis = Knots::uniform(2, 1, -1.0, 1.0)?;
/// let mut plan = SlopePlan::new([axis.clone(), axis], [1.0, 1.0, 1.0])?;
/// let x: Vec<f64> = (0..9).map(|r| (r / 3) as f64 - 1.0).collect();
/// let y: Vec<f64> = (0..9).map(|r| (r % 3) as f64 - 1.0).collect();
/// let z: Vec<f64> = x.iter().map(|x| x * x).collect();
/// let zx: Vec<f64> = x.iter().map(|x| 2.0 * x).collect();
/// let zy = vec![0.0; 9];
/// let coefficients = plan.fit(&SlopeColumns { x: &x, y: &y, z: &z, zx: &zx, zy: &zy })?;
/// // x^2 has the B-spline coefficients 1, -1, 1 along x
/// assert!((coefficients[0] - 1.0).abs() < 1e-12 && (coefficients[3] + 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// From the plan to S and R, again and again without memory being asked for, and to the surface itself:
///
/// ```
/// # use palpate_fitting::facade as palpate;
/// use palpate::plans::{SlopeColumns, SlopePlan};
/// use palpate::spline::{CurvatureGrid, HeightField, Knots, linspace};
///
/// // a bowl of radius 5: S = -1 and R = 1/5 at its bottom
/// let axis = Knots::uniform(2, 1, -1.0, 1.0)?;
/// let knots = [axis.clone(), axis];
/// let mut plan = SlopePlan::new(knots.clone(), [1.0, 1.0, 1.0])?;
/// let points = linspace(-0.05, 0.05, 3);
/// let mut grid = CurvatureGrid::new(&knots, &points, &points);
/// let (mut s, mut r) = ([0.0; 9], [0.0; 9]);
///
/// let x: Vec<f64> = (0..9).map(|k| (k / 3) as f64 - 1.0).collect();
/// let y: Vec<f64> = (0..9).map(|k| (k % 3) as f64 - 1.0).collect();
/// let z: Vec<f64> = x.iter().zip(&y).map(|(x, y)| 0.1 * (x * x + y * y)).collect();
/// let [zx, zy] = [&x, &y].map(|v| v.iter().map(|v| 0.2 * v).collect::<Vec<f64>>());
/// let coefficients = plan.fit(&SlopeColumns { x: &x, y: &y, z: &z, zx: &zx, zy: &zy })?;
/// grid.maps(coefficients, &mut s, &mut r);
/// assert!(s.iter().all(|s| *s < -0.99) && r.iter().all(|r| (r - 0.2).abs() < 1e-3));
///
/// let surface = HeightField::new(knots, coefficients)?;
/// assert!((surface.at(0.5, 0.0).z - 0.025).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SlopePlan {
    cells: CellAssembly,
    row_weights: SiteWeights,
    matrix: StencilMatrix,
    right: Vec<f64>,
    factor: Cholesky,
    coefficients: Vec<f64>,
}

/// Columns of contacts: x, y, z, dz/dx, dz/dy, all of one length; x, y and z in the unit of the knots.
#[derive(Clone, Copy, Debug)]
pub struct SlopeColumns<'a> {
    /// x.
    pub x: &'a [f64],
    /// y.
    pub y: &'a [f64],
    /// Heights.
    pub z: &'a [f64],
    /// Slopes in x.
    pub zx: &'a [f64],
    /// Slopes in y.
    pub zy: &'a [f64],
}

impl SlopeColumns<'_> {
    fn named(&self) -> [(&'static str, &[f64]); 5] {
        [("x", self.x), ("y", self.y), ("z", self.z), ("zx", self.zx), ("zy", self.zy)]
    }

    /// Checks that all columns have one length.
    ///
    /// # Errors
    /// [`PlanError::Length`].
    fn check_lengths(&self) -> Result<(), PlanError> {
        let expected = self.x.len();
        for (column, values) in self.named() {
            if values.len() != expected {
                return Err(PlanError::Length { column, found: values.len(), expected });
            }
        }
        Ok(())
    }

    /// The number that made a sum NaN or infinite.
    #[cold]
    fn culprit(&self) -> PlanError {
        for (column, values) in self.named() {
            if let Some(index) = values.iter().position(|v| !v.is_finite()) {
                return PlanError::NotFinite { column, index, value: values[index] };
            }
        }
        PlanError::Overflow
    }
}

/// Contacts with the squares of their block weights.
struct WeightedColumns<'a> {
    columns: SlopeColumns<'a>,
    squares: [f64; 3],
}

impl CellRows for WeightedColumns<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.columns.x.len()
    }
    #[inline(always)]
    fn at(&self, r: usize) -> [f64; 2] {
        [self.columns.x[r], self.columns.y[r]]
    }
    #[inline(always)]
    fn loads(&self, r: usize) -> [f64; 3] {
        let (c, [wz, wx, wy]) = (&self.columns, self.squares);
        [wz * c.z[r], wx * c.zx[r], wy * c.zy[r]]
    }
}

impl SlopePlan {
    /// Plans for these knots and the block weights `[wz, wx, wy]`, which multiply residuals. Degrees 1 to 3.
    ///
    /// # Errors
    /// [`PlanError::Degree`] for higher degrees; [`PlanError::Weight`]; no memory.
    pub fn new(knots: [Knots; 2], weights: [f64; 3]) -> Result<SlopePlan, PlanError> {
        check_weights(weights)?;
        let degree = knots.each_ref().map(Knots::degree);
        let cells = CellAssembly::new(knots)
            .ok_or(PlanError::Degree { degree, allowed: "moments of the knot cells are kept for degrees 1 to 3" })?;
        let shape = cells.shape();
        let factor = Cholesky::plan(shape)?;
        Ok(SlopePlan {
            cells,
            row_weights: SiteWeights { z: weights[0], a: weights[1], b: 0.0, d: weights[2] },
            matrix: StencilMatrix::zeros(shape),
            right: vec![0.0; shape.unknowns()],
            factor,
            coefficients: vec![0.0; shape.unknowns()],
        })
    }

    /// Fits these contacts alone and returns the coefficients, n x m, row-major, in the unit of the heights.
    ///
    /// The threads of the current pool share the work, and the bits do not depend on their number. Contacts outside the
    /// knots' domain count there by the end polynomials.
    ///
    /// # Errors
    /// Columns of different lengths; a number that is not finite; an unknown without data, or rows that leave the matrix
    /// singular to rounding.
    pub fn fit(&mut self, contacts: &SlopeColumns<'_>) -> Result<&[f64], PlanError> {
        self.clear();
        self.add(contacts)?;
        self.solve()
    }

    /// Forgets all contacts.
    pub fn clear(&mut self) {
        self.matrix.clear();
        self.right.fill(0.0);
    }

    /// Adds contacts to those that the plan already holds. Only the sums are kept, so ten million contacts added a
    /// million at a time need the memory of one million.
    ///
    /// Every number is checked by way of the sums, which costs nothing per contact.
    ///
    /// # Errors
    /// [`PlanError::Length`] for columns of different lengths, and nothing has changed then; [`PlanError::NotFinite`]
    /// and [`PlanError::Overflow`], after which the plan holds no contacts at all.
    pub fn add(&mut self, contacts: &SlopeColumns<'_>) -> Result<(), PlanError> {
        contacts.check_lengths()?;
        let rows = WeightedColumns {
            columns: *contacts,
            squares: [self.row_weights.z, self.row_weights.a, self.row_weights.d].map(|w| w * w),
        };
        self.cells.add(&RowWeights::Uniform(self.row_weights), &rows, &mut self.matrix, &mut self.right);
        if all_finite(&self.right) {
            return Ok(());
        }
        self.clear();
        Err(contacts.culprit())
    }

    /// The fit of all contacts added since the last [`SlopePlan::clear`]; more may follow.
    ///
    /// # Errors
    /// An unknown without data, or rows that leave the matrix singular to rounding.
    pub fn solve(&mut self) -> Result<&[f64], PlanError> {
        self.coefficients.copy_from_slice(&self.right);
        self.factor.factor_and_solve(&self.matrix, &mut self.coefficients)?;
        Ok(&self.coefficients)
    }

    /// The factor of the last fit, for covariance, condition and further right-hand sides.
    pub fn factor(&self) -> &Cholesky {
        &self.factor
    }

    /// The normal matrix of the last fit.
    pub fn matrix(&self) -> &StencilMatrix {
        &self.matrix
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observation::ScatteredSites;
    use crate::plans::ImagePlan;
    use palpate_numeric::bspline::linspace;
    use palpate_numeric::linalg::{RowWeights, assemble, normal_rhs};

    fn wave(r: usize, k: f64) -> f64 {
        (r as f64 * 0.37 * k + k).sin()
    }

    /// Oracle: the written normal equations, row by row, through the dense or sparse factor.
    fn oracle(knots: &[Knots; 2], points: Vec<[f64; 2]>, data: &[[f64; 3]], weights: [f64; 3]) -> Vec<f64> {
        let sites = ScatteredSites::new(knots.clone(), points);
        let row_weights = RowWeights::Uniform(SiteWeights { z: weights[0], a: weights[1], b: 0.0, d: weights[2] });
        let rows: Vec<[f64; 3]> = data.iter().map(|d| [0, 1, 2].map(|k| weights[k] * d[k])).collect();
        let shape = palpate_numeric::linalg::Sites::shape(&sites);
        let mut matrix = StencilMatrix::zeros(shape);
        assemble(&sites, &row_weights, &mut matrix);
        let mut right = vec![0.0; shape.unknowns()];
        normal_rhs(&sites, &row_weights, &rows, &mut right);
        let mut factor = Cholesky::plan(shape).unwrap();
        factor.factor(&matrix).unwrap();
        factor.solve(&mut right);
        right
    }

    #[test]
    fn plans_solve_the_written_equations() {
        let knots = [Knots::uniform(3, 7, 0.0, 1.0).unwrap(), Knots::uniform(2, 5, 0.0, 2.0).unwrap()];
        let (x, y) = (linspace(0.0, 1.0, 40), linspace(0.0, 2.0, 31));
        let weights = [1.0, 0.5, 2.0];
        let points: Vec<[f64; 2]> = x.iter().flat_map(|x| y.iter().map(|y| [*x, *y])).collect();
        let data: Vec<[f64; 3]> = (0..points.len()).map(|r| [wave(r, 1.0), wave(r, 2.0), wave(r, 3.0)]).collect();
        let column = |k: usize| data.iter().map(|d| d[k]).collect::<Vec<f64>>();
        let (px, py): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p[0], p[1])).unzip();
        let [z, zx, zy] = [0, 1, 2].map(column);
        let expected = oracle(&knots, points, &data, weights);
        let mut plan = SlopePlan::new(knots.clone(), weights).unwrap();
        let columns = SlopeColumns { x: &px, y: &py, z: &z, zx: &zx, zy: &zy };
        let mut image = ImagePlan::new(knots, &x, &y, weights).unwrap();
        for _ in 0..2 {
            let near = |found: &[f64]| found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-11);
            assert!(near(plan.fit(&columns).unwrap()));
            assert!(near(image.fit_frame(&z, &zx, &zy).unwrap()));
            plan.clear();
            for from in (0..z.len()).step_by(333) {
                let part = |column: &'_ [f64]| column[from..(from + 333).min(column.len())].to_vec();
                let [px, py, z, zx, zy] = [&px, &py, &z, &zx, &zy].map(|c| part(c));
                plan.add(&SlopeColumns { x: &px, y: &py, z: &z, zx: &zx, zy: &zy }).unwrap();
            }
            assert!(near(plan.solve().unwrap()));
        }
    }

    #[test]
    fn a_faulty_column_is_named_and_reaches_no_coefficient() {
        let axis = Knots::uniform(2, 2, 0.0, 1.0).unwrap();
        let mut plan = SlopePlan::new([axis.clone(), axis.clone()], [1.0; 3]).unwrap();
        let good: [Vec<f64>; 5] =
            std::array::from_fn(|k| (0..50).map(|r| 0.5 + 0.5 * wave(r, 1.0 + k as f64)).collect());
        let view = |c: &[Vec<f64>; 5], plan: &mut SlopePlan| {
            plan.fit(&SlopeColumns { x: &c[0], y: &c[1], z: &c[2], zx: &c[3], zy: &c[4] }).map(<[f64]>::to_vec)
        };
        let expected = view(&good, &mut plan).unwrap();
        for (k, name) in ["x", "y", "z", "zx", "zy"].into_iter().enumerate() {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut columns = good.clone();
                columns[k][17] = bad;
                let found = view(&columns, &mut plan);
                assert!(
                    matches!(found, Err(PlanError::NotFinite { column, index: 17, .. }) if column == name),
                    "{found:?}"
                );
            }
            let mut columns = good.clone();
            columns[k].pop();
            assert!(matches!(view(&columns, &mut plan), Err(PlanError::Length { .. })));
        }
        assert_eq!(view(&good, &mut plan.clone()).unwrap(), expected);
        for weight in [-1.0, f64::NAN, f64::INFINITY] {
            let found = SlopePlan::new([axis.clone(), axis.clone()], [1.0, weight, 1.0]);
            assert!(matches!(found, Err(PlanError::Weight { block: "x slopes", .. })));
        }
        let quartic = Knots::uniform(4, 1, 0.0, 1.0).unwrap();
        assert!(matches!(SlopePlan::new([quartic.clone(), quartic], [1.0; 3]), Err(PlanError::Degree { .. })));
    }
}
