//! Step 3a: the weighted linear least squares problem `minimise |b - E c|^2 + lambda c'Pc` in the patch frame.

use super::Observed;
use crate::linalg::{Metric, RowMetric, Sites, StencilMatrix, Targets, assemble, descent, normal_rhs, residuals};
use crate::observation::{CellAssembly, CellRows, ScatteredSites, kronecker_normal_matrix};

/// From this many contacts on the normal matrix comes from moments, cell by cell and on all threads, not row by row. The
/// two agree to a few units in the last place of the diagonal; below it row by row takes no time worth saving.
const MANY: usize = 20_000;

/// One linear problem: where, how weighted, towards what, how rough.
#[derive(Clone, Debug)]
pub struct Equations {
    /// Sites of the data.
    pub sites: Observed,
    /// Weights of the rows.
    pub metric: Metric,
    /// Weighted right-hand sides.
    pub targets: Targets,
    /// `lambda` and P.
    pub roughness: Option<(f64, StencilMatrix)>,
}

/// The two kinds of rows, whose noise levels are separate variance components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Block {
    /// Height rows.
    Heights,
    /// Slope or normal rows.
    Slopes,
}

/// The rows of one block alone: the other's weights set to zero.
pub fn only(metric: &Metric, block: Block) -> Metric {
    let keep = |m: &RowMetric| match block {
        Block::Heights => RowMetric { z: m.z, ..RowMetric::default() },
        Block::Slopes => RowMetric { z: 0.0, ..*m },
    };
    match metric {
        Metric::Uniform(m) => Metric::Uniform(keep(m)),
        Metric::PerSite(all) => Metric::PerSite(all.iter().map(keep).collect()),
    }
}

impl Equations {
    /// Equations: rows whose weight is not zero.
    pub fn count(&self) -> usize {
        self.metric.row_counts(self.sites.len()).iter().sum()
    }

    /// Unknowns n m.
    pub fn unknowns(&self) -> usize {
        self.sites.shape().unknowns()
    }

    /// `E'E + lambda P`, from Kronecker Grams where a grid's weights allow it.
    pub fn normal_matrix(&self) -> StencilMatrix {
        let mut matrix = data_normal_matrix(&self.sites, &self.metric);
        if let Some((lambda, penalty)) = &self.roughness {
            matrix.add_scaled(*lambda, penalty);
        }
        matrix
    }

    /// `E' r` for weighted rows.
    pub fn transposed(&self, rows: &Targets) -> Vec<f64> {
        let mut out = vec![0.0; self.unknowns()];
        normal_rhs(&self.sites, &self.metric, rows, &mut out);
        out
    }

    /// `b - E c`, row by row.
    pub fn residuals(&self, c: &[f64]) -> Targets {
        let mut out = Targets::new();
        residuals(&self.sites, &self.metric, &self.targets, c, &mut out);
        out
    }

    /// Gradient of half the objective's negative: `E'(b - E c) - lambda P c`, from the rows.
    pub fn descent(&self, c: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.unknowns()];
        descent(&self.sites, &self.metric, &self.targets, c, &mut out);
        if let Some((lambda, penalty)) = &self.roughness {
            let mut bent = vec![0.0; c.len()];
            penalty.multiply(c, &mut bent);
            out.iter_mut().zip(&bent).for_each(|(o, b)| *o -= lambda * b);
        }
        out
    }
}

/// `E'E` of data rows alone.
pub fn data_normal_matrix(sites: &Observed, metric: &Metric) -> StencilMatrix {
    if let (Observed::Gridded(grid), Metric::Uniform(m)) = (sites, metric)
        && m.b == 0.0
    {
        return kronecker_normal_matrix(grid, [m.z, m.a, m.d]);
    }
    let mut matrix = StencilMatrix::zeros(sites.shape());
    if let Observed::Scattered(scattered) = sites
        && scattered.len() >= MANY
        && let Some(mut cells) = CellAssembly::new(scattered.knots().clone())
    {
        let mut nothing = vec![0.0; matrix.order()];
        cells.assemble(metric, &Places(scattered), &mut matrix, &mut nothing);
        return matrix;
    }
    assemble(sites, metric, &mut matrix);
    matrix
}

/// Where contacts lie, their data left out.
struct Places<'a>(&'a ScatteredSites);

impl CellRows for Places<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.0.points().len()
    }
    #[inline(always)]
    fn at(&self, r: usize) -> [f64; 2] {
        self.0.points()[r]
    }
    #[inline(always)]
    fn loads(&self, _: usize) -> [f64; 3] {
        [0.0; 3]
    }
}

/// Sum of squares per block of weighted rows: `[heights, slopes]`.
pub fn block_squares(rows: &Targets) -> [f64; 2] {
    rows.iter().fold([0.0, 0.0], |s, r| [s[0] + r[0] * r[0], s[1] + r[1] * r[1] + r[2] * r[2]])
}
