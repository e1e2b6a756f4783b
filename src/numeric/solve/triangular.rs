//! QR of the rows, front by front: memory holds the rows of one cell, of one strip and of one band at a time.
//!
//! ```text
//! cell   rows of its sites             -> at most (p+1)(q+1) rows          (sequential accumulation)
//! strip  cells of one x segment in y   -> (p+1) m rows
//! band   strips in x, carrying p m rows -> R, one block of rows per x basis function
//! ```
//!
//! The right-hand side is one more column, so Q is applied and never stored. R is kept, for refinement, for the condition
//! and for the rank. Lawson and Hanson, *Solving Least Squares Problems*, ch. 27, with tensor-product fronts. Against faer's
//! general sparse QR of the same compressed rows this keeps R and finds dependent columns (M. Heath,
//! *Some extensions of an algorithm for sparse linear least squares problems*, SIAM J. Sci. Stat. Comput. 3, 1982).

use super::SolveError;
use super::factor::Factor;
use super::householder::Front;
use crate::linalg::{RowWeights, Sites, Targets, TensorShape, inverse_norm1_estimate};

/// A cell's front is reduced whenever it has this many times as many rows as columns. A larger number wastes memory, a
/// smaller one does more work.
const CELL_ROWS: usize = 4;

/// Upper triangular R with `R'R = D E'E D`, in blocks of rows, and `Q'b`.
#[derive(Clone, Debug)]
pub struct TriangularFactor {
    shape: TensorShape,
    scale: Vec<f64>,
    blocks: Vec<RowBlock>,
    rhs: Vec<f64>,
    dead: Vec<usize>,
}

/// Rows of R for unknowns `first .. first + rows`, columns `first .. first + columns`, row-major.
#[derive(Clone, Debug)]
struct RowBlock {
    first: usize,
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

impl TriangularFactor {
    /// Factors the weighted rows of `sites` with right-hand side `targets`.
    ///
    /// `norms_squared` are the squared column norms of the rows, all positive.
    ///
    /// # Errors
    /// [`SolveError::EmptyColumn`], [`SolveError::NotFinite`].
    pub fn of_rows(
        sites: &impl Sites,
        row_weights: &RowWeights,
        targets: &Targets,
        norms_squared: &[f64],
    ) -> Result<TriangularFactor, SolveError> {
        let shape = sites.shape();
        let scale = equilibration(norms_squared)?;
        let mut band = Band::new(shape);
        let mut strip = Strip::new(shape, 0);
        sites.visit(|site| {
            if site.first[0] != strip.first {
                strip.finish(&mut band);
                band.advance_to(site.first[0]);
                strip.restart(site.first[0]);
            }
            if site.first[1] != strip.cell_first {
                strip.advance_to(site.first[1]);
            }
            strip.add(site, &row_weights.at(site.index), &targets[site.index], &scale);
        });
        strip.finish(&mut band);
        band.advance_to(shape.basis[0]);
        Ok(TriangularFactor { shape, scale, blocks: band.blocks, rhs: band.rhs, dead: band.dead })
    }

    /// Rank found: unknowns less dependent columns.
    pub fn rank(&self) -> usize {
        self.scale.len() - self.dead.len()
    }

    /// Shape of the spline.
    pub fn shape(&self) -> TensorShape {
        self.shape
    }

    /// The least squares coefficients `D R^-1 Q'b`; dependent unknowns are zero.
    pub fn coefficients(&self) -> Vec<f64> {
        let mut v = self.rhs.clone();
        self.solve_upper(&mut v);
        v.iter_mut().zip(&self.scale).for_each(|(w, d)| *w *= d);
        v
    }

    /// `v <- (E'E)^-1 v = D R^-1 R'^-1 D v`: with a residual from the rows, corrected semi-normal equations.
    pub fn solve(&self, v: &mut [f64]) {
        v.iter_mut().zip(&self.scale).for_each(|(w, d)| *w *= d);
        self.solve_upper_transposed(v);
        self.solve_upper(v);
        v.iter_mut().zip(&self.scale).for_each(|(w, d)| *w *= d);
    }

    /// Condition of `E D` in the 1-norm, from R.
    pub fn condition(&self) -> f64 {
        let mut column_sums = vec![0.0; self.scale.len()];
        for block in &self.blocks {
            for row in block.values.chunks_exact(block.columns) {
                row.iter().enumerate().for_each(|(k, v)| column_sums[block.first + k] += v.abs());
            }
        }
        let norm = column_sums.into_iter().fold(0.0, f64::max);
        norm * inverse_norm1_estimate(self.scale.len(), |v| self.solve_upper(v), |v| self.solve_upper_transposed(v))
    }

    fn solve_upper(&self, v: &mut [f64]) {
        for block in self.blocks.iter().rev() {
            for row in (0..block.rows).rev() {
                let r = &block.values[row * block.columns..(row + 1) * block.columns];
                let known = &v[block.first + row + 1..block.first + block.columns];
                let dot: f64 = r[row + 1..].iter().zip(known).map(|(a, b)| a * b).sum();
                let unknown = &mut v[block.first + row];
                *unknown = if r[row] == 0.0 { 0.0 } else { (*unknown - dot) / r[row] };
            }
        }
    }

    fn solve_upper_transposed(&self, v: &mut [f64]) {
        for block in &self.blocks {
            for row in 0..block.rows {
                let r = &block.values[row * block.columns..(row + 1) * block.columns];
                let (head, tail) = v[block.first + row..block.first + block.columns].split_at_mut(1);
                head[0] = if r[row] == 0.0 { 0.0 } else { head[0] / r[row] };
                tail.iter_mut().zip(&r[row + 1..]).for_each(|(t, a)| *t -= head[0] * a);
            }
        }
    }
}

impl Factor for TriangularFactor {
    fn solve(&self, v: &mut [f64]) {
        TriangularFactor::solve(self, v);
    }

    fn condition(&self) -> f64 {
        TriangularFactor::condition(self)
    }
}

/// `1 / |column|`, or the error of a column that has none.
pub(super) fn equilibration(norms_squared: &[f64]) -> Result<Vec<f64>, SolveError> {
    let scale = |(unknown, &norm): (usize, &f64)| {
        if norm == 0.0 {
            Err(SolveError::EmptyColumn { unknown })
        } else if !norm.is_finite() {
            Err(SolveError::NotFinite { unknown })
        } else {
            Ok(1.0 / norm.sqrt())
        }
    };
    norms_squared.iter().enumerate().map(scale).collect()
}

/// One x segment: the front of the current cell, with columns `(j - cell_first)(p + 1) + a`, and the finished rows that
/// go to the band.
struct Strip {
    shape: TensorShape,
    first: usize,
    cell_first: usize,
    cell: Front,
    /// Finished rows: first j, entries over the cell's columns, right-hand side last.
    done: Vec<(usize, Vec<f64>)>,
}

impl Strip {
    fn new(shape: TensorShape, first: usize) -> Strip {
        let columns = shape.local() + 1;
        Strip { shape, first, cell_first: 0, cell: Front::new(columns, CELL_ROWS * columns), done: Vec::new() }
    }

    fn restart(&mut self, first: usize) {
        (self.first, self.cell_first) = (first, 0);
        self.cell.clear();
        self.done.clear();
    }

    fn add(&mut self, site: &crate::linalg::Site, w: &crate::linalg::SiteWeights, target: &[f64; 3], scale: &[f64]) {
        let last = self.cell.columns - 1;
        let wide = self.shape.degree[0] + 1;
        for (kind, rhs) in target.iter().enumerate() {
            if [w.z == 0.0, w.a == 0.0 && w.b == 0.0, w.d == 0.0][kind] {
                continue;
            }
            if self.cell.is_full() {
                self.cell.triangularise();
            }
            let row = self.cell.add_row();
            for a in 0..wide {
                for b in 0..site.y.len() {
                    let value = match kind {
                        0 => w.z * site.x[a] * site.y[b],
                        1 => w.a * site.dx[a] * site.y[b] + w.b * site.x[a] * site.dy[b],
                        _ => w.d * site.x[a] * site.dy[b],
                    };
                    let unknown = (site.first[0] + a) * self.shape.basis[1] + site.first[1] + b;
                    self.cell.set(row, b * wide + a, value * scale[unknown]);
                }
            }
            self.cell.set(row, last, *rhs);
        }
    }

    /// Moves on to the cell whose first y basis function is `next`. Rows that no later cell changes are finished.
    fn advance_to(&mut self, next: usize) {
        let wide = self.shape.degree[0] + 1;
        let width = self.cell.columns - 1;
        self.cell.triangularise();
        let leaving = ((next - self.cell_first) * wide).min(width);
        let mut carried: Vec<Vec<f64>> = Vec::new();
        for row in 0..self.cell.rows {
            let values: Vec<f64> = (0..=width).map(|column| self.cell.get(row, column)).collect();
            if row < leaving || row >= width {
                self.done.push((self.cell_first, values));
            } else {
                carried.push(values);
            }
        }
        self.cell.clear();
        for values in carried {
            let row = self.cell.add_row();
            for column in leaving..width {
                self.cell.set(row, column - leaving, values[column]);
            }
            self.cell.set(row, width, values[width]);
        }
        self.cell_first = next;
    }

    fn finish(&mut self, band: &mut Band) {
        self.advance_to(self.cell_first + self.shape.degree[1] + 1);
        for (first, values) in self.done.drain(..) {
            band.add(self.first, first, &values);
        }
        self.cell.clear();
    }
}

/// The rows that later x segments may still change: columns `(i - first) m + j`, right-hand side last.
struct Band {
    shape: TensorShape,
    first: usize,
    front: Front,
    blocks: Vec<RowBlock>,
    rhs: Vec<f64>,
    dead: Vec<usize>,
}

impl Band {
    fn new(shape: TensorShape) -> Band {
        let columns = (shape.degree[0] + 1) * shape.basis[1] + 1;
        Band {
            shape,
            first: 0,
            front: Front::new(columns, 2 * columns),
            blocks: Vec::new(),
            rhs: Vec::new(),
            dead: Vec::new(),
        }
    }

    fn add(&mut self, first_x: usize, first_y: usize, values: &[f64]) {
        let wide = self.shape.degree[0] + 1;
        let width = values.len() - 1;
        let row = self.front.add_row();
        for (k, value) in values[..width].iter().enumerate() {
            let (b, a) = (k / wide, k % wide);
            if first_y + b < self.shape.basis[1] {
                self.front.set(row, (first_x + a - self.first) * self.shape.basis[1] + first_y + b, *value);
            }
        }
        let last = self.front.columns - 1;
        self.front.set(row, last, values[width]);
    }

    /// Eliminates the columns in which segments from `next` on have no entries, at most as many at a time as the front has.
    fn advance_to(&mut self, next: usize) {
        while self.first < next {
            self.step_to(next.min(self.first + self.shape.degree[0] + 1));
        }
    }

    fn step_to(&mut self, next: usize) {
        let m = self.shape.basis[1];
        let width = self.front.columns - 1;
        let leaving = ((next - self.first) * m).min(width);
        let live = width.min((self.shape.basis[0] - self.first) * m);
        let leaving = leaving.min(live);
        self.front.triangularise();
        let threshold = self.threshold();
        let deficient: Vec<usize> =
            (0..leaving).filter(|&k| k >= self.front.rows || self.front.get(k, k).abs() <= threshold).collect();
        if !deficient.is_empty() {
            self.eliminate_deficient(leaving, threshold);
        } else {
            self.take_rows(leaving, &(0..leaving).map(Some).collect::<Vec<_>>(), live);
            self.keep_rows(leaving, leaving);
        }
        self.first = next;
    }

    /// Diagonal entries below this are rounding errors: columns have norm 1, and each front adds a few roundings.
    fn threshold(&self) -> f64 {
        20.0 * (self.shape.unknowns() as f64).sqrt() * f64::EPSILON
    }

    /// Heath's rule: a column that is zero below the rows already used takes no row, and the next column tries the same row.
    fn eliminate_deficient(&mut self, leaving: usize, threshold: f64) {
        let live = (self.front.columns - 1).min((self.shape.basis[0] - self.first) * self.shape.basis[1]);
        let mut used = 0;
        let mut row_of = Vec::with_capacity(leaving);
        for column in 0..leaving {
            if self.front.eliminate_column(used, column, threshold) {
                row_of.push(Some(used));
                used += 1;
            } else {
                self.dead.push(self.first * self.shape.basis[1] + column);
                row_of.push(None);
            }
        }
        self.take_rows(leaving, &row_of, live);
        self.keep_rows(used, leaving);
    }

    fn take_rows(&mut self, leaving: usize, row_of: &[Option<usize>], live: usize) {
        let last = self.front.columns - 1;
        let mut values = vec![0.0; leaving * live];
        for (unknown, row) in row_of.iter().enumerate() {
            if let Some(row) = *row {
                for column in unknown..live {
                    values[unknown * live + column] = self.front.get(row, column);
                }
            }
            self.rhs.push(row.map_or(0.0, |row| self.front.get(row, last)));
        }
        let first = self.first * self.shape.basis[1];
        self.blocks.push(RowBlock { first, rows: leaving, columns: live, values });
    }

    /// Carries rows from `used` on, columns from `leaving` on, into an emptied front.
    fn keep_rows(&mut self, used: usize, leaving: usize) {
        let last = self.front.columns - 1;
        let mut next = Front::new(self.front.columns, 2 * self.front.columns);
        for row in used..self.front.rows {
            let to = next.add_row();
            for column in leaving..last {
                next.set(to, column - leaving, self.front.get(row, column));
            }
            next.set(to, last, self.front.get(row, last));
        }
        self.front = next;
    }
}
