//! Products with the rows of all sites, and their normal matrix.
//!
//! ```text
//! E c      b - E c      E' r      E'(b - E c)
//! A_(ab)(kl) += (wz^2 N_a N_k + a^2 N'_a N'_k) M_b M_l + a b (N'_a N_k M_b M'_l + N_a N'_k M'_b M_l)
//!               + (b^2 + d^2) N_a N_k M'_b M'_l
//! ```
//!
//! Scattered sites are visited one by one, grids row by row; both give the same bits, except that the matrix of a grid
//! whose weights differ is summed in another order.

use super::gram_of_rows::GramOfRows;
use super::grid_assembly::assemble_grid;
use super::grid_rows::{GridRows, visit_cells, visit_lines};
use super::sites::{RowWeights, Site, SiteWeights, Sites, Targets, add_transposed, site_rows};
use super::stencil::{StencilMatrix, TensorShape};
use crate::simd::Isa;
use crate::work;

/// Weights that leave every row as it is.
const PLAIN: SiteWeights = SiteWeights { z: 1.0, a: 1.0, b: 0.0, d: 1.0 };

/// Counts passes over the rows of all sites; on a grid lines along y are shared, and a pixel takes one axis alone.
fn count(sites: &impl Sites, passes: usize) {
    let [p, q] = sites.shape().degree.map(|d| d + 1);
    work::add(3 * passes * sites.len() * if sites.grid_axes().is_some() { p } else { p * q });
}

/// Rows `[wz S, a S_x + b S_y, d S_y]` from the values.
#[inline(always)]
fn weighted(w: &SiteWeights, [s, sx, sy]: [f64; 3]) -> [f64; 3] {
    [w.z * s, w.a * sx + w.b * sy, w.d * sy]
}

/// Calls `visit(site, [S, S_x, S_y])` for every site, in the order of the knot cells.
pub fn visit_values(sites: &impl Sites, c: &[f64], mut visit: impl FnMut(usize, [f64; 3])) {
    count(sites, 1);
    let basis = sites.shape().basis;
    match sites.grid_axes() {
        Some(axes) => visit_cells(axes, basis, c, visit),
        None => sites.visit(|site| visit(site.index, site_rows(site, &PLAIN, c, basis[1]))),
    }
}

/// Calls `visit(site, row of E c)` for every pixel of a grid in the user's order; `false`, and nothing visited, for
/// scattered sites.
pub fn visit_grid_rows(
    sites: &impl Sites,
    row_weights: &RowWeights,
    c: &[f64],
    mut visit: impl FnMut(usize, [f64; 3]),
) -> bool {
    let Some(axes) = sites.grid_axes() else { return false };
    count(sites, 1);
    visit_lines(axes, sites.shape().basis, c, |r, values| visit(r, weighted(&row_weights.at(r), values)));
    true
}

/// `out = E c`, weighted, in the user's order.
pub fn apply_rows(sites: &impl Sites, row_weights: &RowWeights, c: &[f64], out: &mut Targets) {
    let columns = sites.shape().basis[1];
    out.clear();
    out.reserve(sites.len());
    if visit_grid_rows(sites, row_weights, c, |_, row| out.push(row)) {
        return;
    }
    count(sites, 1);
    out.resize(sites.len(), [0.0; 3]);
    sites.visit(|site| out[site.index] = site_rows(site, &row_weights.at(site.index), c, columns));
}

/// `out = b - E c`, weighted, in the user's order.
pub fn residuals(sites: &impl Sites, row_weights: &RowWeights, targets: &Targets, c: &[f64], out: &mut Targets) {
    let columns = sites.shape().basis[1];
    out.clear();
    out.reserve(sites.len());
    if visit_grid_rows(sites, row_weights, c, |r, row| out.push([0, 1, 2].map(|k| targets[r][k] - row[k]))) {
        return;
    }
    count(sites, 1);
    out.resize(sites.len(), [0.0; 3]);
    sites.visit(|site| {
        let rows = site_rows(site, &row_weights.at(site.index), c, columns);
        let target = targets[site.index];
        out[site.index] = [0, 1, 2].map(|k| target[k] - rows[k]);
    });
}

/// `out = E' r` for weighted rows `r`.
pub fn normal_rhs(sites: &impl Sites, row_weights: &RowWeights, rows: &Targets, out: &mut [f64]) {
    count(sites, 1);
    let basis = sites.shape().basis;
    let columns = basis[1];
    out.fill(0.0);
    if let Some(axes) = sites.grid_axes() {
        return GridRows { axes, basis, row_weights, rows: |r: usize, _| rows[r] }.add_transposed(None, out);
    }
    sites.visit(|site| add_transposed(site, &row_weights.at(site.index), rows[site.index], columns, out));
}

/// `out = E'(b - E c)` in one visit, with the same bits as [`residuals`] followed by [`normal_rhs`].
pub fn descent(sites: &impl Sites, row_weights: &RowWeights, targets: &Targets, c: &[f64], out: &mut [f64]) {
    count(sites, 2);
    let basis = sites.shape().basis;
    let columns = basis[1];
    out.fill(0.0);
    if let Some(axes) = sites.grid_axes() {
        let rows = |r: usize, values: [f64; 3]| {
            let (row, target) = (weighted(&row_weights.at(r), values), targets[r]);
            [0, 1, 2].map(|k| target[k] - row[k])
        };
        return GridRows { axes, basis, row_weights, rows }.add_transposed(Some(c), out);
    }
    sites.visit(|site| {
        let weights = row_weights.at(site.index);
        let (rows, target) = (site_rows(site, &weights, c, columns), targets[site.index]);
        add_transposed(site, &weights, [0, 1, 2].map(|k| target[k] - rows[k]), columns, out);
    });
}

/// Adds `E'E` to `out`, cell by cell. The rank-one updates go into a dense matrix of the cell, which is added to `out` once.
pub fn assemble(sites: &impl Sites, row_weights: &RowWeights, out: &mut StencilMatrix) {
    let shape = sites.shape();
    count(sites, shape.local().div_ceil(2));
    if let (Some(axes), RowWeights::PerSite(weights)) = (sites.grid_axes(), row_weights)
        && weights.iter().all(|w| w.b == 0.0)
    {
        return assemble_grid(axes, |r| [weights[r].z, weights[r].a, weights[r].d].map(|w| w * w), out);
    }
    let mut local = LocalMatrix::new(shape, sites.len());
    sites.visit(|site| {
        if site.first != local.first {
            local.scatter(out);
            local.first = site.first;
        }
        local.add(site, &row_weights.at(site.index));
    });
    local.scatter(out);
}

/// One cell's matrix, its lower triangle, by the basis functions `(a, b)` of the cell.
struct LocalMatrix {
    first: [usize; 2],
    width: [usize; 2],
    columns: usize,
    gram: GramOfRows,
}

impl LocalMatrix {
    fn new(shape: TensorShape, sites: usize) -> LocalMatrix {
        let width = shape.degree.map(|d| d + 1);
        let gram = GramOfRows::new(Isa::for_work(sites), width[0] * width[1]);
        LocalMatrix { first: [0, 0], width, columns: shape.basis[1], gram }
    }

    fn add(&mut self, site: &Site, w: &SiteWeights) {
        // weights of N_a M_b, N'_a M_b and N_a M'_b in each row
        for [w_value, w_x, w_y] in [[w.z, 0.0, 0.0], [0.0, w.a, w.b], [0.0, 0.0, w.d]] {
            if w_value == 0.0 && w_x == 0.0 && w_y == 0.0 {
                continue;
            }
            let along = site.x.iter().zip(site.dx);
            for (part, (x, dx)) in self.gram.next_row().chunks_exact_mut(self.width[1]).zip(along) {
                let (of_value, of_slope) = (w_value * x + w_x * dx, w_y * x);
                let across = site.y.iter().zip(site.dy);
                part.iter_mut().zip(across).for_each(|(row, (y, dy))| *row = of_value * y + of_slope * dy);
            }
        }
    }

    fn scatter(&mut self, out: &mut StencilMatrix) {
        if self.gram.is_empty() {
            return;
        }
        self.gram.finish();
        let [_, m] = self.width;
        for row in 0..self.width[0] * m {
            let (a, b) = (row / m, row % m);
            let unknown = (self.first[0] + a) * self.columns + self.first[1] + b;
            for column in 0..=row {
                let (k, l) = (column / m, column % m);
                let position = out.position(unknown, a - k, l + m - 1 - b);
                out.values_mut()[position] += self.gram.at(row, column);
            }
        }
        self.gram.clear();
    }
}
