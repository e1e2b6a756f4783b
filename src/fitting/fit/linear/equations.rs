//! The weighted linear least squares problem `minimise |b - E c|^2 + lambda c'Pc` in the patch frame.

use std::sync::{Arc, OnceLock};

use crate::fit::placing::sites::DataSites;
use crate::observation::{CellAssembly, PackedCells, PackedRows, Roughness, kronecker_normal_matrix};
use palpate_numeric::linalg::{
    RowWeights, SiteWeights, Sites, StencilMatrix, Targets, apply_rows, assemble, descent, normal_rhs, residuals,
    visit_grid_rows,
};

/// One linear least squares problem: sites, row weights, targets and roughness.
#[derive(Clone, Debug)]
pub struct Equations {
    /// Sites of the data.
    pub sites: DataSites,
    /// Weights of the rows.
    pub row_weights: RowWeights,
    /// Weighted right-hand sides.
    pub targets: Targets,
    /// The roughness penalty, if there is one.
    pub roughness: Option<Roughness>,
    /// Weights and targets of many scattered contacts, packed by knot cells at the first visit.
    packed: OnceLock<Arc<PackedRows>>,
    /// Where many penalties are tried on the same rows.
    matrices: Option<Arc<DataMatrices>>,
}

/// `E'E` of the data rows, and of either kind alone.
#[derive(Debug)]
struct DataMatrices {
    whole: StencilMatrix,
    of_kinds: [StencilMatrix; 2],
}

/// The two kinds of rows, whose noise variances are estimated separately.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKind {
    /// Height rows.
    Heights,
    /// Slope or normal rows.
    Slopes,
}

/// The rows of one kind alone: the other kind's weights are set to zero.
pub(crate) fn only(row_weights: &RowWeights, kind: RowKind) -> RowWeights {
    let keep = |m: &SiteWeights| match kind {
        RowKind::Heights => SiteWeights { z: m.z, ..SiteWeights::default() },
        RowKind::Slopes => SiteWeights { z: 0.0, ..*m },
    };
    match row_weights {
        RowWeights::Uniform(m) => RowWeights::Uniform(keep(m)),
        RowWeights::PerSite(all) => RowWeights::PerSite(all.iter().map(keep).collect()),
    }
}

impl Equations {
    /// These rows, not packed yet.
    pub fn new(sites: DataSites, row_weights: RowWeights, targets: Targets, roughness: Option<Roughness>) -> Equations {
        Equations { sites, row_weights, targets, roughness, packed: OnceLock::new(), matrices: None }
    }

    /// The same, with matrices of the data rows that all penalties share: these need not be assembled again for each.
    pub(crate) fn assembled_once(self) -> Equations {
        let of_kinds = [RowKind::Heights, RowKind::Slopes].map(|kind| self.data_matrix_of(kind));
        let whole = data_normal_matrix(&self.sites, &self.row_weights);
        Equations { matrices: Some(Arc::new(DataMatrices { whole, of_kinds })), ..self }
    }

    /// `E'E` of all rows.
    pub(crate) fn data_matrix(&self) -> StencilMatrix {
        let assembled = || data_normal_matrix(&self.sites, &self.row_weights);
        self.matrices.as_ref().map_or_else(assembled, |matrices| matrices.whole.clone())
    }

    /// `E'E` of the rows of one kind.
    pub(crate) fn data_matrix_of(&self, kind: RowKind) -> StencilMatrix {
        match &self.matrices {
            Some(matrices) => matrices.of_kinds[kind as usize].clone(),
            None => data_normal_matrix(&self.sites, &only(&self.row_weights, kind)),
        }
    }

    /// The same sites with other rows, written over these ones: rows of a million contacts take 130 MB, and fetching them
    /// anew takes longer than filling them. `fill` gets weights and targets of all sites, whatever they held.
    pub(crate) fn refilled(mut self, fill: impl FnOnce(&mut [SiteWeights], &mut Targets)) -> Equations {
        self.matrices = None;
        let mut weights = match self.row_weights {
            RowWeights::PerSite(weights) => weights,
            RowWeights::Uniform(one) => {
                // packed rows of one weight have no room for many
                self.packed.take();
                vec![one; self.sites.len()]
            }
        };
        fill(&mut weights, &mut self.targets);
        self.row_weights = RowWeights::PerSite(weights);
        let rows = self.packed.take().and_then(|rows| Arc::try_unwrap(rows).ok());
        if let (Some(mut rows), Some(cells)) = (rows, packed_cells(&self.sites)) {
            cells.refill(&mut rows, &self.row_weights, &self.targets);
            self.packed = OnceLock::from(Arc::new(rows));
        }
        self
    }

    /// The same rows under another roughness penalty, or none.
    pub fn with_roughness(&self, roughness: Option<Roughness>) -> Equations {
        Equations { roughness, ..self.clone() }
    }

    /// Number of equations: rows whose weight is not zero.
    pub fn count(&self) -> usize {
        self.row_weights.row_counts(self.sites.len()).iter().sum()
    }

    /// Number of unknowns n m.
    pub fn unknowns(&self) -> usize {
        self.sites.shape().unknowns()
    }

    /// `E'E + lambda P`, from Kronecker Grams where a grid's weights allow it.
    pub fn normal_matrix(&self) -> StencilMatrix {
        let mut matrix = self.data_matrix();
        if let Some(rough) = &self.roughness {
            matrix.add_scaled(rough.lambda, &rough.penalty);
        }
        matrix
    }

    /// The rows of many scattered contacts packed by knot cells; `None` for few, for grids and for degrees above 3.
    pub fn packed(&self) -> Option<(&PackedCells, &PackedRows)> {
        let cells = packed_cells(&self.sites)?;
        Some((cells, self.packed.get_or_init(|| Arc::new(cells.rows(&self.row_weights, &self.targets)))))
    }

    /// `E' b`.
    pub fn right_side(&self) -> Vec<f64> {
        let mut out = vec![0.0; self.unknowns()];
        match self.packed() {
            Some((cells, rows)) => cells.descent(rows, &vec![0.0; out.len()], &mut out),
            None => normal_rhs(&self.sites, &self.row_weights, &self.targets, &mut out),
        }
        out
    }

    /// `|b - E c|^2` of height rows and of slope rows.
    pub fn residual_squares(&self, c: &[f64]) -> [f64; 2] {
        match self.packed() {
            Some((cells, rows)) => cells.squares(rows, true, c),
            None => self
                .grid_squares(c, |r, row| [0, 1, 2].map(|k| self.targets[r][k] - row[k]))
                .unwrap_or_else(|| self.residuals(c).iter().fold([0.0, 0.0], add_squares)),
        }
    }

    /// `|E v|^2` of height rows and of slope rows.
    pub fn row_squares(&self, v: &[f64]) -> [f64; 2] {
        if let Some(matrices) = &self.matrices {
            return matrices.of_kinds.each_ref().map(|of_kind| quadratic_form(of_kind, v));
        }
        if let Some((cells, rows)) = self.packed() {
            return cells.squares(rows, false, v);
        }
        if let Some(squares) = self.grid_squares(v, |_, row| row) {
            return squares;
        }
        let mut rows = Targets::new();
        apply_rows(&self.sites, &self.row_weights, v, &mut rows);
        rows.iter().fold([0.0, 0.0], add_squares)
    }

    /// Sums of squares of `rows(site, E c)` over a grid, without writing the rows down; `None` for scattered data.
    fn grid_squares(&self, c: &[f64], rows: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> Option<[f64; 2]> {
        let mut sums = [0.0, 0.0];
        let visited = visit_grid_rows(&self.sites, &self.row_weights, c, |r, row| {
            sums = add_squares(sums, &rows(r, row));
        });
        visited.then_some(sums)
    }

    /// `b - E c`, row by row.
    pub fn residuals(&self, c: &[f64]) -> Targets {
        let mut out = Targets::new();
        residuals(&self.sites, &self.row_weights, &self.targets, c, &mut out);
        out
    }

    /// Negative gradient of half the objective, `E'(b - E c) - lambda P c`, computed from the rows.
    pub fn descent(&self, c: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.unknowns()];
        match self.packed() {
            Some((cells, rows)) => cells.descent(rows, c, &mut out),
            None => descent(&self.sites, &self.row_weights, &self.targets, c, &mut out),
        }
        if let Some(Roughness { lambda, penalty, .. }) = &self.roughness {
            let mut bent = vec![0.0; c.len()];
            penalty.multiply(c, &mut bent);
            out.iter_mut().zip(&bent).for_each(|(o, b)| *o -= lambda * b);
        }
        out
    }
}

/// `v'Av`.
pub(crate) fn quadratic_form(a: &StencilMatrix, v: &[f64]) -> f64 {
    let mut product = vec![0.0; v.len()];
    a.multiply(v, &mut product);
    v.iter().zip(&product).map(|(v, p)| v * p).sum()
}

/// `E'E` of data rows alone.
pub(crate) fn data_normal_matrix(sites: &DataSites, row_weights: &RowWeights) -> StencilMatrix {
    if let (DataSites::Gridded(grid), RowWeights::Uniform(m)) = (sites, row_weights)
        && m.b == 0.0
    {
        return kronecker_normal_matrix(grid, [m.z, m.a, m.d]);
    }
    let mut matrix = StencilMatrix::zeros(sites.shape());
    if let (DataSites::Scattered(scattered), Some(packed)) = (sites, packed_cells(sites))
        && let Some(mut cells) = CellAssembly::new(scattered.knots().clone())
    {
        cells.add_packed(row_weights, packed, &mut matrix);
        return matrix;
    }
    assemble(sites, row_weights, &mut matrix);
    matrix
}

/// Many scattered contacts packed by knot cells; `None` for few, for grids and for degrees above 3.
pub(crate) fn packed_cells(sites: &DataSites) -> Option<&PackedCells> {
    match sites {
        DataSites::Scattered(scattered) if scattered.uses_packed_cells() => scattered.packed_cells(),
        _ => None,
    }
}

/// Sums of squares of the weighted rows of either kind, `[heights, slopes]`, with those of one more site.
fn add_squares(s: [f64; 2], r: &[f64; 3]) -> [f64; 2] {
    [s[0] + r[0] * r[0], s[1] + r[1] * r[1] + r[2] * r[2]]
}
