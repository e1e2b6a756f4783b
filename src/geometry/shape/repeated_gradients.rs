//! Sums of the gradients of S and R over a fixed grid, under coefficients that change from call to call.
//!
//! ```text
//! sum_g dS_g/dc, sum_g dR_g/dc        over the points g at which S, or R, is defined
//! ```
//!
//! Nothing is allocated after the plan is made.

use palpate_numeric::bspline::{BasisRow, Knots, MAX_DEGREE};
use palpate_numeric::simd::{
    CellPoints, CurveLanes, Isa, POINTS, PointLanes, PointShapes, cell_curves, shape_gradients,
};

/// Up to eight neighbours in y of one knot segment.
#[derive(Clone, Debug)]
struct Neighbours {
    /// Number of the first of them.
    start: usize,
    count: usize,
    /// First basis function.
    first: usize,
    /// M, M', M'' one after the other; lanes left over repeat the last point.
    y: Vec<PointLanes>,
}

/// A grid of points prepared for one pair of knot vectors.
#[derive(Clone, Debug)]
pub struct RepeatedGradients {
    /// Basis functions in y.
    columns: usize,
    width: [usize; 2],
    x: Vec<BasisRow>,
    neighbours: Vec<Neighbours>,
    /// Points in y.
    points: usize,
    curves: Vec<CurveLanes>,
    entries: [Vec<PointLanes>; 2],
}

impl RepeatedGradients {
    /// Prepares the points `x` by `y`, both ascending.
    pub fn new(knots: &[Knots; 2], x: &[f64], y: &[f64]) -> RepeatedGradients {
        let width = knots.each_ref().map(|knots| knots.degree() + 1);
        let along_y: Vec<BasisRow> = y.iter().map(|at| knots[1].basis(*at)).collect();
        let mut neighbours: Vec<Neighbours> = Vec::new();
        for rows in along_y.chunk_by(|a, b| a.first == b.first).flat_map(|run| run.chunks(POINTS)) {
            let last = rows.len() - 1;
            let lanes = |k: usize, b: usize| std::array::from_fn(|l: usize| rows[l.min(last)].derivative(k)[b]);
            let y = (0..3).flat_map(|k| (0..width[1]).map(move |b| (k, b))).map(|(k, b)| lanes(k, b)).collect();
            let start = neighbours.last().map_or(0, |before| before.start + before.count);
            neighbours.push(Neighbours { start, count: rows.len(), first: rows[0].first, y });
        }
        let cell = vec![[0.0; POINTS]; width[0] * width[1]];
        RepeatedGradients {
            columns: knots[1].n_basis(),
            width,
            x: x.iter().map(|at| knots[0].basis(*at)).collect(),
            neighbours,
            points: y.len(),
            curves: vec![CurveLanes::default(); width[0]],
            entries: [cell.clone(), cell],
        }
    }

    /// Writes the sums of the gradients of S and of R; `shape_index` is S at every point, row-major, NaN where it is not
    /// defined.
    pub fn sums(&mut self, coefficients: &[f64], shape_index: &[f64], sums: [&mut [f64]; 2]) {
        let isa = Isa::for_work(self.x.len() * self.points);
        let [of_s, of_r] = sums;
        of_s.fill(0.0);
        of_r.fill(0.0);
        let mut shapes = PointShapes::default();
        for Neighbours { start, count, first, y } in &self.neighbours {
            let q = self.width[1];
            let y = [&y[..q], &y[q..2 * q], &y[2 * q..]];
            let mut entered = usize::MAX;
            for (i, bx) in self.x.iter().enumerate() {
                let mut runs = [0; MAX_DEGREE + 1];
                runs.iter_mut().enumerate().for_each(|(a, run)| *run = (bx.first + a) * self.columns + first);
                if std::mem::replace(&mut entered, bx.first) != bx.first {
                    cell_curves(isa, coefficients, &runs[..self.width[0]], y, &mut self.curves);
                }
                let x = [bx.derivative(0), bx.derivative(1), bx.derivative(2)];
                let [by_s, by_r] = &mut self.entries;
                shape_gradients(isa, &CellPoints { x, y, curves: &self.curves }, [by_s, by_r], &mut shapes);
                let defined = &shape_index[i * self.points + start..][..*count];
                let is_there: PointLanes = std::array::from_fn(|l| f64::from(u8::from(l < *count)));
                let is_defined =
                    std::array::from_fn(|l| f64::from(u8::from(defined.get(l).is_some_and(|s| !s.is_nan()))));
                add(by_s, &is_defined, &runs, q, of_s);
                add(by_r, &is_there, &runs, q, of_r);
            }
        }
    }
}

/// Adds the lanes that count, 1 or 0, of every coefficient of a cell.
fn add(entries: &[PointLanes], counts: &PointLanes, runs: &[usize], width: usize, sums: &mut [f64]) {
    for (start, entries) in runs.iter().zip(entries.chunks_exact(width)) {
        for (sum, lanes) in sums[*start..][..width].iter_mut().zip(entries) {
            let mut terms = [0.0; POINTS];
            (0..POINTS).for_each(|l| terms[l] = if counts[l] == 0.0 { 0.0 } else { lanes[l] });
            *sum += ((terms[0] + terms[4]) + (terms[2] + terms[6])) + ((terms[1] + terms[5]) + (terms[3] + terms[7]));
        }
    }
}
