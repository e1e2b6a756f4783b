//! The hot path: plan once, then fit as often as data come, allocating nothing.
//!
//! ```text
//! scattered:  contacts -> moments per cell -> E'E, E'b -> L -> c            [`SlopePlan`]
//! a grid:     images -> B_x' Z B_y -> fast diagonalisation -> c             [`ImagePlan`]
//! ```
//!
//! Slope rows with one weight per block, in the coordinates of the knots: what a frame, a certificate and uncertainties
//! add is [`crate::fit::fit_contacts`]'s.

use crate::bspline::Knots;
use crate::fit::FitError;
use crate::linalg::{RowWeights, SiteWeights, StencilMatrix};
use crate::observation::{CellAssembly, CellRows, GridSites};
use crate::simd::{BandTerm, Isa, contract_rows};
use crate::solve::{Cholesky, FastDiagonalisation};

/// Repeated fits of scattered contacts with slopes under fixed knots and weights.
#[derive(Debug)]
pub struct SlopePlan {
    cells: CellAssembly,
    row_weights: SiteWeights,
    matrix: StencilMatrix,
    right: Vec<f64>,
    factor: Cholesky,
    coefficients: Vec<f64>,
}

/// Columns of contacts: x, y, z, dz/dx, dz/dy, of one length.
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
    /// Plans for these knots and the block weights `[wz, wx, wy]` (multiplying residuals). Degrees 1 to 3.
    ///
    /// # Errors
    /// [`FitError::Method`] for higher degrees; no memory.
    pub fn new(knots: [Knots; 2], weights: [f64; 3]) -> Result<SlopePlan, FitError> {
        let cells = CellAssembly::new(knots)
            .ok_or(FitError::Method { method: "plan", why: "moments are kept for degrees 1 to 3" })?;
        let shape = cells.shape();
        let factor = Cholesky::plan(shape).map_err(|source| FitError::Solve { source })?;
        Ok(SlopePlan {
            cells,
            row_weights: SiteWeights { z: weights[0], a: weights[1], b: 0.0, d: weights[2] },
            matrix: StencilMatrix::zeros(shape),
            right: vec![0.0; shape.unknowns()],
            factor,
            coefficients: vec![0.0; shape.unknowns()],
        })
    }

    /// Fits; coefficients n x m, row-major. Work is shared among the threads of the current pool, the bits are not.
    ///
    /// # Errors
    /// An unknown without data, or rows that leave the matrix singular to rounding.
    ///
    /// # Panics
    /// When a column is shorter than `x`.
    pub fn fit(&mut self, contacts: &SlopeColumns<'_>) -> Result<&[f64], FitError> {
        self.clear();
        self.add(contacts);
        self.solve()
    }

    /// Forgets all contacts.
    pub fn clear(&mut self) {
        self.matrix.clear();
        self.right.fill(0.0);
    }

    /// Takes contacts in, to those that are there: a million at a time, ten million fit in the memory of one.
    ///
    /// # Panics
    /// When a column is shorter than `x`.
    pub fn add(&mut self, contacts: &SlopeColumns<'_>) {
        let n = contacts.x.len();
        let SlopeColumns { x, y, z, zx, zy } = *contacts;
        let columns = SlopeColumns { x, y: &y[..n], z: &z[..n], zx: &zx[..n], zy: &zy[..n] };
        let rows = WeightedColumns {
            columns,
            squares: [self.row_weights.z, self.row_weights.a, self.row_weights.d].map(|w| w * w),
        };
        self.cells.add(&RowWeights::Uniform(self.row_weights), &rows, &mut self.matrix, &mut self.right);
    }

    /// The fit of all contacts taken in; more may follow.
    ///
    /// # Errors
    /// As [`SlopePlan::fit`].
    pub fn solve(&mut self) -> Result<&[f64], FitError> {
        self.coefficients.copy_from_slice(&self.right);
        self.factor
            .factor_and_solve(&self.matrix, &mut self.coefficients)
            .map_err(|source| FitError::Solve { source })?;
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

/// A stream of complete images with slopes under fixed axes, knots and weights.
#[derive(Debug)]
pub struct ImagePlan {
    sites: GridSites,
    /// N, N' and N again along x, times the squared weights of values, x slopes and y slopes.
    weighted: [Vec<f64>; 3],
    solver: FastDiagonalisation,
    /// `B_x' Z` of values and of y slopes, n x pixels, and transposed.
    half: [Vec<f64>; 2],
    turned: [Vec<f64>; 2],
    right: Vec<f64>,
    coefficients: Vec<f64>,
}

impl ImagePlan {
    /// Plans for pixels at `x` by `y`, these knots and the block weights `[wz, wx, wy]`.
    ///
    /// # Errors
    /// When an axis has too few pixels for its knots.
    pub fn new(knots: [Knots; 2], x: &[f64], y: &[f64], weights: [f64; 3]) -> Result<ImagePlan, FitError> {
        let sites = GridSites::new(knots, x, y);
        let [ax, ay] = sites.axes();
        let grams = [ax, ay].map(|axis| [axis.gram(0, None), axis.gram(1, None)]);
        let [gx, gy] = &grams;
        let solver = FastDiagonalisation::new([&gx[0], &gx[1]], [&gy[0], &gy[1]], weights)
            .map_err(|source| FitError::Solve { source })?;
        let (n, m) = (gx[0].len(), gy[0].len());
        let half = n * y.len();
        let scaled = |table: &[f64], w: f64| table.iter().map(|v| v * w * w).collect();
        let weighted = [scaled(&ax.values, weights[0]), scaled(&ax.slopes, weights[1]), scaled(&ax.values, weights[2])];
        Ok(ImagePlan {
            weighted,
            solver,
            half: [vec![0.0; half], vec![0.0; half]],
            turned: [vec![0.0; half], vec![0.0; half]],
            right: vec![0.0; n * m],
            coefficients: vec![0.0; n * m],
            sites,
        })
    }

    /// Fits one frame: heights and slopes, row-major pixels [x, y]; coefficients n x m, row-major.
    ///
    /// # Panics
    /// When an image is shorter than the axes say.
    pub fn fit_frame(&mut self, z: &[f64], zx: &[f64], zy: &[f64]) -> &[f64] {
        let isa = Isa::active();
        let [ax, ay] = self.sites.axes();
        let (n, m, pixels) = (ax.knots.n_basis(), ay.knots.n_basis(), ay.first.len());
        self.half.iter_mut().for_each(|h| h.fill(0.0));
        let width = ax.knots.degree() + 1;
        let term = |values, image| BandTerm { values, image };
        let [values, slopes, across] = &self.weighted;
        let along = [term(&values[..], z), term(&slopes[..], zx)];
        contract_rows(isa, width, &ax.first, &along, pixels, &mut self.half[0]);
        contract_rows(isa, width, &ax.first, &[term(&across[..], zy)], pixels, &mut self.half[1]);
        for (turned, half) in self.turned.iter_mut().zip(&self.half) {
            turn(half, n, pixels, turned);
        }
        self.right.fill(0.0);
        let terms = [term(&ay.values, &self.turned[0][..]), term(&ay.slopes, &self.turned[1][..])];
        contract_rows(isa, ay.knots.degree() + 1, &ay.first, &terms, n, &mut self.right);
        turn(&self.right, m, n, &mut self.coefficients);
        self.solver.solve(&mut self.coefficients);
        &self.coefficients
    }
}

/// `out (columns x rows) = from'`, in squares that stay in the first-level cache.
fn turn(from: &[f64], rows: usize, columns: usize, out: &mut [f64]) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bspline::linspace;
    use crate::linalg::{RowWeights, assemble, normal_rhs};
    use crate::observation::ScatteredSites;

    fn wave(r: usize, k: f64) -> f64 {
        (r as f64 * 0.37 * k + k).sin()
    }

    /// Oracle: the written normal equations, row by row, through the dense or sparse factor.
    fn oracle(knots: &[Knots; 2], points: Vec<[f64; 2]>, data: &[[f64; 3]], weights: [f64; 3]) -> Vec<f64> {
        let sites = ScatteredSites::new(knots.clone(), points);
        let row_weights = RowWeights::Uniform(SiteWeights { z: weights[0], a: weights[1], b: 0.0, d: weights[2] });
        let rows: Vec<[f64; 3]> = data.iter().map(|d| [0, 1, 2].map(|k| weights[k] * d[k])).collect();
        let shape = crate::linalg::Sites::shape(&sites);
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
            assert!(near(image.fit_frame(&z, &zx, &zy)));
            plan.clear();
            for from in (0..z.len()).step_by(333) {
                let part = |column: &'_ [f64]| column[from..(from + 333).min(column.len())].to_vec();
                let [px, py, z, zx, zy] = [&px, &py, &z, &zx, &zy].map(|c| part(c));
                plan.add(&SlopeColumns { x: &px, y: &py, z: &z, zx: &zx, zy: &zy });
            }
            assert!(near(plan.solve().unwrap()));
        }
    }
}
