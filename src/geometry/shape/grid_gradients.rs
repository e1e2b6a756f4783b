//! Derivatives of S and R by the coefficients at every point of a shape grid, eight neighbours in y at once.
//!
//! ```text
//! dS/dc_ij = sum_k (dS/d_k) D_k(N_i M_j)     R likewise     d_k = S_x, S_y, S_xx, S_xy, S_yy
//! ```
//!
//! They are computed once and read twice: the uncertainty of mean S and mean R follows from their mean, and the digits of
//! a certificate from each of them.

use crate::surface::HeightField;
use palpate_numeric::bspline::{BasisRow, MAX_DEGREE};
use palpate_numeric::simd::{
    CellPoints, CurveLanes, Isa, POINTS, PointLanes, PointShapes, cell_curves, shape_gradients,
};

/// Up to this many points the gradients are kept (0.8 MB at degree 2, 1.3 at degree 3). Those of larger grids are computed
/// again for every reader, which takes no longer than fetching them from memory.
const KEPT: usize = 1 << 12;

/// Up to eight neighbouring points of one grid row: the same x, ascending y, all in one knot cell.
#[derive(Clone, Copy, Debug)]
pub struct EightPoints<'a> {
    /// Indices of the first of them in the grid.
    pub at: [usize; 2],
    /// Number of points; the last one is repeated in the lanes left over.
    pub count: usize,
    /// First basis functions of the cell in x and in y.
    pub first: [usize; 2],
    /// `2 (L_xx + 2 L_xy + L_yy)` and `4 (L_x + L_y)`, L the largest 2-norms of the derivatives by the coefficients.
    pub spans: [f64; 2],
    /// Curvatures and their rounding errors.
    pub shapes: &'a PointShapes,
    /// dS/dc and dR/dc, number `a (q + 1) + b` of the cell.
    pub entries: [&'a [PointLanes]; 2],
}

/// Gradients of S and R over one grid.
#[derive(Clone, Debug)]
pub struct GridGradients {
    kept: Option<Kept>,
}

#[derive(Clone, Debug)]
struct Kept {
    heads: Vec<Head>,
    entries: Vec<PointLanes>,
}

#[derive(Clone, Debug)]
struct Head {
    at: [usize; 2],
    count: usize,
    first: [usize; 2],
    spans: [f64; 2],
    shapes: PointShapes,
}

impl Head {
    fn points<'a>(&'a self, entries: &'a [PointLanes]) -> EightPoints<'a> {
        let Head { at, count, first, spans, shapes } = self;
        let (of_s, of_r) = entries.split_at(entries.len() / 2);
        EightPoints { at: *at, count: *count, first: *first, spans: *spans, shapes, entries: [of_s, of_r] }
    }
}

impl GridGradients {
    /// The gradients of `surface` over the points with these basis rows along x and y.
    pub fn new(surface: &HeightField, rows: &[Vec<BasisRow>; 2]) -> GridGradients {
        let [along_x, along_y] = rows;
        if along_x.len() * along_y.len() > KEPT {
            return GridGradients { kept: None };
        }
        let mut walk = Walk::new(surface, rows);
        let room = 2 * along_x.len() * along_y.len().div_ceil(POINTS);
        let mut kept = Kept { heads: Vec::with_capacity(room / 2), entries: Vec::with_capacity(room * walk.cell()) };
        walk.all(rows, &mut kept, |_| ());
        GridGradients { kept: Some(kept) }
    }

    /// The gradients of any surface, none of them computed yet.
    pub fn unkept() -> GridGradients {
        GridGradients { kept: None }
    }

    /// Visits all points in groups of up to eight: for each group in y, all x in turn. `surface` and `rows` are those of [`Self::new`].
    pub fn visit(&self, surface: &HeightField, rows: &[Vec<BasisRow>; 2], mut f: impl FnMut(&EightPoints)) {
        let Some(Kept { heads, entries }) = &self.kept else {
            let mut latest = Kept { heads: Vec::new(), entries: Vec::new() };
            return Walk::new(surface, rows).all(rows, &mut latest, |kept| {
                f(&kept.heads[0].points(&kept.entries));
                kept.heads.clear();
                kept.entries.clear();
            });
        };
        let each = entries.len() / heads.len().max(1);
        heads.iter().zip(entries.chunks_exact(each.max(1))).for_each(|(head, entries)| f(&head.points(entries)));
    }
}

/// The state of a visit: the points in y, the cell, and its coefficients summed along y.
struct Walk<'a> {
    isa: Isa,
    coefficients: std::borrow::Cow<'a, [f64]>,
    /// Basis functions in y.
    columns: usize,
    /// Basis functions that are nonzero in a cell, in x and in y.
    width: [usize; 2],
    /// M, M', M'' one after the other.
    y: Vec<PointLanes>,
    /// Their largest 2-norms.
    lengths: [f64; 3],
    curves: Vec<CurveLanes>,
}

impl Walk<'_> {
    fn new<'a>(surface: &'a HeightField, [along_x, along_y]: &[Vec<BasisRow>; 2]) -> Walk<'a> {
        let width = surface.knots().each_ref().map(|knots| knots.degree() + 1);
        let coefficients = surface.coefficients();
        Walk {
            isa: Isa::for_work(along_x.len() * along_y.len()),
            coefficients: match coefficients.as_slice() {
                Some(slice) => slice.into(),
                None => coefficients.iter().copied().collect::<Vec<f64>>().into(),
            },
            columns: coefficients.ncols(),
            width,
            y: vec![[0.0; POINTS]; 3 * width[1]],
            lengths: [0.0; 3],
            curves: vec![CurveLanes::default(); width[0]],
        }
    }

    /// Coefficients of a cell.
    fn cell(&self) -> usize {
        self.width[0] * self.width[1]
    }

    /// Appends group after group to `kept`, and calls `f` after each.
    fn all(&mut self, [along_x, along_y]: &[Vec<BasisRow>; 2], kept: &mut Kept, mut f: impl FnMut(&mut Kept)) {
        let lengths: Vec<[f64; 3]> = along_x.iter().map(|row| [0, 1, 2].map(|k| length(row.derivative(k)))).collect();
        let mut start = 0;
        for rows in along_y.chunk_by(|a, b| a.first == b.first).flat_map(|run| run.chunks(POINTS)) {
            self.load_y(rows);
            let mut cell = usize::MAX;
            for (i, bx) in along_x.iter().enumerate() {
                let first = [bx.first, rows[0].first];
                if std::mem::replace(&mut cell, bx.first) != bx.first {
                    self.enter(first);
                }
                let head = Head {
                    at: [i, start],
                    count: rows.len(),
                    first,
                    spans: spans(&lengths[i], &self.lengths),
                    shapes: PointShapes::default(),
                };
                self.add(bx, head, kept);
                f(kept);
            }
            start += rows.len();
        }
    }

    /// Loads the basis of these neighbours in y.
    fn load_y(&mut self, rows: &[BasisRow]) {
        let last = rows.len() - 1;
        for (k, values) in self.y.chunks_exact_mut(self.width[1]).enumerate() {
            self.lengths[k] = rows.iter().map(|row| length(row.derivative(k))).fold(0.0, f64::max);
            let rows: [&[f64]; POINTS] = std::array::from_fn(|l| rows[l.min(last)].derivative(k));
            for (b, lanes) in values.iter_mut().enumerate() {
                *lanes = std::array::from_fn(|l| rows[l][b]);
            }
        }
    }

    fn y(&self) -> [&[PointLanes]; 3] {
        let q = self.width[1];
        [&self.y[..q], &self.y[q..2 * q], &self.y[2 * q..]]
    }

    /// Sums the coefficients of the cell with these first basis functions along y.
    fn enter(&mut self, first: [usize; 2]) {
        let mut runs = [0; MAX_DEGREE + 1];
        runs.iter_mut().enumerate().for_each(|(a, run)| *run = (first[0] + a) * self.columns + first[1]);
        let mut curves = std::mem::take(&mut self.curves);
        cell_curves(self.isa, &self.coefficients, &runs[..self.width[0]], self.y(), &mut curves);
        self.curves = curves;
    }

    fn add(&self, bx: &BasisRow, head: Head, kept: &mut Kept) {
        let (start, cell) = (kept.entries.len(), self.cell());
        kept.entries.resize(start + 2 * cell, [0.0; POINTS]);
        kept.heads.push(head);
        let x = [bx.derivative(0), bx.derivative(1), bx.derivative(2)];
        let points = CellPoints { x, y: self.y(), curves: &self.curves };
        let (of_s, of_r) = kept.entries[start..].split_at_mut(cell);
        if let Some(head) = kept.heads.last_mut() {
            shape_gradients(self.isa, &points, [of_s, of_r], &mut head.shapes);
        }
    }
}

fn length(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |sum, v| sum + v * v).sqrt()
}

/// [`EightPoints::spans`] from the norms of N, N', N'' and M, M', M''.
fn spans(n: &[f64; 3], m: &[f64; 3]) -> [f64; 2] {
    [2.0 * (n[2] * m[0] + 2.0 * n[1] * m[1] + n[0] * m[2]), 4.0 * (n[1] * m[0] + n[0] * m[1])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{by_coefficients, shape_gradient};
    use ndarray::Array2;
    use palpate_numeric::bspline::{Knots, linspace};

    /// Every point once, its gradients those of the formulas point by point, kept or computed on the way.
    #[test]
    fn every_point_has_its_gradients_once() {
        let knots = [Knots::uniform(2, 3, 0.0, 1.0).unwrap(), Knots::uniform(3, 2, 0.0, 1.0).unwrap()];
        let c = Array2::from_shape_fn([5, 5], |(i, j)| (i as f64 * 1.7 + j as f64 * 0.9).sin());
        let surface = HeightField::new(knots.clone(), c).unwrap();
        let along = |k: usize, n: usize| linspace(0.0, 1.0, n).iter().map(|at| knots[k].basis(*at)).collect();
        let rows: [Vec<BasisRow>; 2] = [along(0, 7), along(1, 21)];
        let visit = |gradients: &GridGradients| {
            let (mut seen, mut entries) = (vec![0; 7 * 21], Vec::new());
            gradients.visit(&surface, &rows, |eight| {
                for l in 0..eight.count {
                    let [i, j] = [eight.at[0], eight.at[1] + l];
                    seen[i * 21 + j] += 1;
                    let (bx, by) = (&rows[0][i], &rows[1][j]);
                    assert_eq!(eight.first, [bx.first, by.first]);
                    let expected = shape_gradient(&surface.with_rows(bx, by));
                    let size = expected.shape_index.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
                    by_coefficients(&expected.shape_index, bx, by, |a, b, value| {
                        let found = eight.entries[0][a * 4 + b][l];
                        assert!((found - value).abs() < 1e-11 * size, "{i} {j}: {found} {value}");
                    });
                    let [n, m] = [bx, by].map(|row| [0, 1, 2].map(|k| length(row.derivative(k))));
                    assert!(spans(&n, &m).iter().zip(eight.spans).all(|(own, most)| *own <= most * (1.0 + 1e-15)));
                }
                entries.push(eight.entries.map(<[PointLanes]>::to_vec));
            });
            assert!(seen.iter().all(|n| *n == 1));
            entries
        };
        let kept = GridGradients::new(&surface, &rows);
        assert!(kept.kept.is_some());
        assert_eq!(visit(&kept), visit(&GridGradients { kept: None }));
    }
}
