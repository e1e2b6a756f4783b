//! A smooth displacement f along the normal of the general surface: how the shape departs from two constant curvatures.
//!
//! ```text
//! f(u, v) = sum_ij c_ij N_i(u) N_j(v)        degree 4, segments as the resolution has them
//! prior of f:  exp(-1/(2 g s^2) sum_k binom(3, k) int (D_u^k D_v^(3-k) f)^2)
//! ```
//!
//! A displacement of second degree has no penalty. The general surface's own parameters represent it already, so it is
//! left out: the columns are the eigenvectors of the penalty with positive eigenvalues, scaled so that a displacement
//! of prior size has mean square 1.
//!
//! Nine more columns, with a prior of their own, hold departures of third and fourth degree ([`natural`]), and some hundred
//! those of processes that are smooth in all their derivatives ([`smooth`]). All are combinations of the same splines.
//!
//! A cell's row holds means over its contacts (`cell_charts.rs`).

use faer::Mat;

use crate::recognition::contacts::Cells;
use crate::recognition::kinds::ConstantCurvature;
use palpate_geometry::primitives::NormalJet;
use palpate_numeric::bspline::{Knots, gram};
use palpate_numeric::linalg;

use super::basis::{DEGREE, JetRow, WIDTH};
use super::bodies::{self, Body, Forms};
use super::cell_charts::CellCharts;
use super::resolution::DepartureResolution;
use super::{polynomial_prior, smooth};

use palpate_numeric::vector::Vector;

/// Order of the derivatives that are penalised.
const ORDER: usize = 3;

/// Cells needed. Below 16 the prior decides most of f, which is right where an interval asks what else the surface may be.
const FEWEST_CELLS: usize = 9;

/// Smallest |Q_v| of the chart. Nearer to a pole the chart's derivatives grow without bound, and the intervals with
/// them.
pub(crate) const POLE: f64 = 0.5;

/// Share of the largest mean square at the cells below which a column of a smooth departure is left out. With a tenth of it there are a
/// quarter more columns and the same intervals.
const UNSEEN: f64 = 1e-5;

/// Places at which a displaced surface is compared with bodies.
const COMPARED: usize = 40;

/// Margin of the chart's box, relative to its width.
const MARGIN: f64 = 0.02;

/// Columns of the displacement at the cells, and the matrix from the columns' weights to spline coefficients.
#[derive(Clone, Debug)]
pub(crate) struct Displacement {
    knots: [Knots; 2],
    /// Coefficients x columns.
    to_coefficients: Mat<f64>,
    /// Number of columns with the prior above.
    pub(crate) rough: usize,
    /// Number of columns of natural departures, which follow.
    pub(crate) natural: usize,
    /// First column and number of columns of every smooth departure.
    pub(crate) smooth: Vec<(usize, usize)>,
    /// First column and number of columns of every body; none of those that do not lie near the surface.
    pub(crate) bodies: [(usize, usize); Body::ALL.len()],
    /// The forms about which those are linear.
    pub(crate) forms: Forms,
    /// Rows of the distances.
    pub(crate) positions: Mat<f64>,
    /// Rows of the normals' two tangential parts, one after the other; only where normals are used.
    pub(crate) normals: Option<Mat<f64>>,
    /// The same rows for the displacements u^2/2, v^2/2 and u v, which over a plane are exact columns of its curvatures.
    pub(crate) quadratic: Quadratic,
}

/// Rows of the displacements u^2/2, v^2/2 and u v.
#[derive(Clone, Debug)]
pub(crate) struct Quadratic {
    pub(crate) positions: Mat<f64>,
    pub(crate) normals: Option<Mat<f64>>,
}

impl Displacement {
    /// The displacement over the cells of a general surface, where the data and the chart allow one.
    /// `contacts` are all of them: their outline lies beyond that of the cells, and the displacement reaches it. Bodies are linear about
    /// these `forms`, and natural departures have a prior of so many natural sizes.
    pub(crate) fn new(
        surface: &ConstantCurvature,
        cells: &Cells,
        contacts: &[Vector],
        forms: &Forms,
        (resolution, natural_sizes): (DepartureResolution, f64),
    ) -> Option<Displacement> {
        let charts: Vec<[f64; 2]> = cells.points.iter().map(|p| surface.chart(*p)).collect();
        if charts.len() < FEWEST_CELLS || charts.iter().any(|c| surface.form().width(c[0]).abs() < POLE) {
            return None;
        }
        let outline: Vec<[f64; 2]> = contacts.iter().map(|p| surface.chart(*p)).collect();
        let segments = resolution.segments();
        let knots = [knots_over(&outline, 0, segments)?, knots_over(&outline, 1, segments)?];
        let mut rough = penalised_columns(&knots)?;
        let means = CellCharts::new(surface, &outline, cells);
        let at_cells = |columns: &Mat<f64>| {
            product(&knots, &means.places, columns, |i, row| {
                let [uu, uv, vv] = means.spreads[i];
                row[0] + 0.5 * (uu * row[3] + vv * row[5]) + uv * row[4]
            })
        };
        let mut positions = at_cells(&rough);
        let size = (square_sum(&positions) / charts.len() as f64).sqrt();
        scale(&mut rough, 1.0 / size);
        scale(&mut positions, -1.0 / size);
        let natural = polynomial_prior::columns(&knots, surface, natural_sizes);
        let mut natural_positions = at_cells(&natural);
        scale(&mut natural_positions, -1.0);
        let mut made = Displacement {
            knots: knots.clone(),
            to_coefficients: beside(&rough, &natural),
            positions: beside(&positions, &natural_positions),
            rough: rough.ncols(),
            natural: natural.ncols(),
            smooth: Vec::new(),
            bodies: [(0, 0); Body::ALL.len()],
            forms: *forms,
            normals: None,
            quadratic: Quadratic { positions: means.quadratic(), normals: None },
        };
        for process in smooth::all(resolution) {
            let weights = process.and_then(|process| smooth::weights(surface, &made.knots, &rough, process));
            made.add_smooth(&rough, &positions, &weights.unwrap_or_else(|| Mat::zeros(rough.ncols(), 0)));
        }
        // over a plane a body is none of what departs from two constant curvatures
        for body in Body::ALL.into_iter().filter(|_| !surface.is_flat()) {
            if let Some(coefficients) = bodies::columns(&knots, surface, body, forms[body.number()]) {
                made.add_body(body, &coefficients, at_cells(&coefficients));
            }
        }
        if cells.normals.is_some() {
            made.normals = Some(means.slopes(&made.knots, &made.to_coefficients));
            made.quadratic.normals = Some(means.quadratic_slopes());
        }
        Some(made)
    }

    /// Adds the columns of a smooth departure, but for those that hardly show at the cells. `positions` are the rough columns there.
    fn add_smooth(&mut self, rough: &Mat<f64>, positions: &Mat<f64>, weights: &Mat<f64>) {
        let at_cells = linalg::product(positions.as_ref(), weights.as_ref());
        let squares: Vec<f64> =
            (0..at_cells.ncols()).map(|j| at_cells.col_as_slice(j).iter().map(|v| v * v).sum()).collect();
        let largest = squares.iter().copied().fold(0.0, f64::max);
        let kept: Vec<usize> = (0..squares.len()).filter(|&j| squares[j] > UNSEEN * largest).collect();
        let sum: f64 = kept.iter().map(|&j| squares[j]).sum();
        let size = (sum / at_cells.nrows() as f64).sqrt();
        let scaled = |m: &Mat<f64>| Mat::from_fn(m.nrows(), kept.len(), |i, k| m[(i, kept[k])] / size);
        self.smooth.push((self.positions.ncols(), kept.len()));
        self.positions = beside(&self.positions, &scaled(&at_cells));
        let coefficients = linalg::product(rough.as_ref(), scaled(weights).as_ref());
        self.to_coefficients = beside(&self.to_coefficients, &coefficients);
    }

    /// Adds the columns of a body: spline coefficients and what these are at the cells.
    fn add_body(&mut self, body: Body, coefficients: &Mat<f64>, mut at_cells: Mat<f64>) {
        scale(&mut at_cells, -1.0);
        self.bodies[body.number()] = (self.columns(), coefficients.ncols());
        self.positions = beside(&self.positions, &at_cells);
        self.to_coefficients = beside(&self.to_coefficients, coefficients);
    }

    /// Number of columns.
    pub(crate) fn columns(&self) -> usize {
        self.to_coefficients.ncols()
    }

    /// First column and number of columns of every group that stands together in some departure: rough and natural columns, and those
    /// of every smooth departure and of every body.
    pub(crate) fn groups(&self) -> Vec<(usize, usize)> {
        let bodies = self.bodies.iter().filter(|(_, count)| *count > 0);
        std::iter::once((0, self.rough + self.natural)).chain(self.smooth.iter().chain(bodies).copied()).collect()
    }

    /// Spline coefficients for given weights of the columns. A surface uses the columns of one departure and not the others.
    pub(crate) fn coefficients(&self, weights: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.to_coefficients.nrows()];
        for (j, w) in weights.iter().enumerate().filter(|(_, w)| **w != 0.0) {
            out.iter_mut().zip(self.to_coefficients.col_as_slice(j)).for_each(|(out, c)| *out += w * c);
        }
        out
    }

    /// The forms in which bodies are nearest to the displaced surface with these coefficients, at some of these places of the chart; those
    /// that they are linear about where they are not near, or not asked for.
    pub(crate) fn nearest_forms(
        &self,
        surface: &ConstantCurvature,
        charts: &[[f64; 2]],
        coefficients: &[f64],
        is_asked: impl Fn(Body) -> bool,
    ) -> Forms {
        let every = charts.len().div_ceil(COMPARED);
        let compared: Vec<([f64; 2], f64)> =
            charts.iter().step_by(every).map(|chart| (*chart, self.at(*chart).jet(coefficients)[0])).collect();
        let of = |body: Body| {
            let start = self.forms[body.number()];
            if !is_asked(body) {
                return start;
            }
            bodies::nearest_form(surface, body, start, &compared, bodies::farthest(&self.knots)).unwrap_or(start)
        };
        if surface.is_flat() { self.forms } else { Body::ALL.map(of) }
    }

    /// Spline coefficients of many displacements, one a column, for given weights of the columns from `first` on.
    pub(crate) fn coefficients_of_many(&self, first: usize, weights: &Mat<f64>) -> Mat<f64> {
        linalg::product(self.to_coefficients.as_ref().subcols(first, weights.nrows()), weights.as_ref())
    }

    /// The basis functions at a chart point, with which many displacements can be evaluated there.
    pub(crate) fn at(&self, [u, v]: [f64; 2]) -> JetRow {
        JetRow::new(&self.knots, [u, v])
    }
}

fn knots_over(charts: &[[f64; 2]], side: usize, segments: usize) -> Option<Knots> {
    let lo = charts.iter().map(|c| c[side]).fold(f64::INFINITY, f64::min);
    let hi = charts.iter().map(|c| c[side]).fold(f64::NEG_INFINITY, f64::max);
    let margin = MARGIN * (hi - lo);
    Knots::uniform(DEGREE, segments, lo - margin, hi + margin).ok()
}

/// One of the six numbers of the jet at every chart point (rows), for every column of the displacement.
fn product(
    knots: &[Knots; 2],
    charts: &[[f64; 2]],
    columns: &Mat<f64>,
    pick: impl Fn(usize, NormalJet) -> f64,
) -> Mat<f64> {
    let mut basis = Mat::<f64>::zeros(charts.len(), columns.nrows());
    for (i, chart) in charts.iter().enumerate() {
        let row = JetRow::new(knots, *chart);
        for a in 0..WIDTH {
            for b in 0..WIDTH {
                basis[(i, row.coefficient(a, b))] = pick(i, row.jet_of(a, b));
            }
        }
    }
    linalg::product(basis.as_ref(), columns.as_ref())
}

/// Eigenvectors of the penalty with positive eigenvalues, divided by the roots of those.
fn penalised_columns(knots: &[Knots; 2]) -> Option<Mat<f64>> {
    let [nu, nv] = [0, 1].map(|side| knots[side].n_basis());
    let full = |side: usize, order: usize| {
        let bands = gram(&knots[side], order);
        move |i: usize, j: usize| {
            let (i, j) = (i.max(j), i.min(j));
            bands[i].get(i - j).copied().unwrap_or(0.0)
        }
    };
    let mut penalty = Mat::<f64>::zeros(nu * nv, nu * nv);
    for (k, binomial) in [1.0, 3.0, 3.0, 1.0].into_iter().enumerate() {
        let (u, v) = (full(0, k), full(1, ORDER - k));
        for i in 0..nu * nv {
            for j in 0..=i {
                penalty[(i, j)] += binomial * u(i / nv, j / nv) * v(i % nv, j % nv);
            }
        }
    }
    let eigen = linalg::eigen(penalty.as_ref())?;
    let count = nu * nv;
    let largest = eigen.values[count - 1];
    let kept: Vec<usize> = (0..count).filter(|&k| eigen.values[k] > 1e-9 * largest).collect();
    Some(Mat::from_fn(count, kept.len(), |i, j| eigen.vectors[(i, kept[j])] / eigen.values[kept[j]].sqrt()))
}

fn beside(a: &Mat<f64>, b: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(a.nrows(), a.ncols() + b.ncols(), |i, j| if j < a.ncols() { a[(i, j)] } else { b[(i, j - a.ncols())] })
}

fn square_sum(m: &Mat<f64>) -> f64 {
    (0..m.ncols()).map(|j| (0..m.nrows()).map(|i| m[(i, j)] * m[(i, j)]).sum::<f64>()).sum()
}

fn scale(m: &mut Mat<f64>, by: f64) {
    for j in 0..m.ncols() {
        (0..m.nrows()).for_each(|i| m[(i, j)] *= by);
    }
}
