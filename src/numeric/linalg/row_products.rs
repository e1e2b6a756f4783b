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

use super::grid_assembly::assemble_grid;
use super::grid_rows::{GridRows, visit_cells, visit_lines};
use super::sites::{RowWeights, Site, SiteWeights, Sites, Targets, add_transposed, site_rows};
use super::stencil::{StencilMatrix, TensorShape};
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
    let mut local = LocalMatrix::new(shape);
    sites.visit(|site| {
        if site.first != local.first {
            local.scatter(out);
            local.first = site.first;
        }
        local.add(site, &row_weights.at(site.index));
    });
    local.scatter(out);
}

/// One cell's matrix, of which only the blocks with `k <= a` in x are kept: entry `[a, k <= a][b, l]`.
struct LocalMatrix {
    first: [usize; 2],
    width: [usize; 2],
    touched: bool,
    blocks: Vec<f64>,
    y_products: Vec<[f64; 3]>,
    columns: usize,
}

impl LocalMatrix {
    fn new(shape: TensorShape) -> LocalMatrix {
        let width = shape.degree.map(|d| d + 1);
        let blocks = width[0] * (width[0] + 1) / 2 * width[1] * width[1];
        LocalMatrix {
            first: [0, 0],
            width,
            touched: false,
            blocks: vec![0.0; blocks],
            y_products: vec![[0.0; 3]; width[1] * width[1]],
            columns: shape.basis[1],
        }
    }

    fn add(&mut self, site: &Site, w: &SiteWeights) {
        self.touched = true;
        let square = self.width[1] * self.width[1];
        for b in 0..self.width[1] {
            for l in 0..self.width[1] {
                self.y_products[b * self.width[1] + l] =
                    [site.y[b] * site.y[l], site.y[b] * site.dy[l], site.dy[b] * site.dy[l]];
            }
        }
        let (zz, aa, ab, dd) = (w.z * w.z, w.a * w.a, w.a * w.b, w.b * w.b + w.d * w.d);
        let mut blocks = self.blocks.chunks_exact_mut(square);
        for a in 0..self.width[0] {
            for k in 0..=a {
                let Some(block) = blocks.next() else { return };
                let values = site.x[a] * site.x[k];
                let (along, across) = (zz * values + aa * site.dx[a] * site.dx[k], dd * values);
                for (target, y) in block.iter_mut().zip(&self.y_products) {
                    *target += along * y[0] + across * y[2];
                }
                if ab != 0.0 {
                    let (left, right) = (ab * site.dx[a] * site.x[k], ab * site.x[a] * site.dx[k]);
                    for b in 0..self.width[1] {
                        for l in 0..self.width[1] {
                            block[b * self.width[1] + l] += left * self.y_products[b * self.width[1] + l][1]
                                + right * self.y_products[l * self.width[1] + b][1];
                        }
                    }
                }
            }
        }
    }

    fn scatter(&mut self, out: &mut StencilMatrix) {
        if !self.touched {
            return;
        }
        let q = self.width[1] - 1;
        let mut entries = self.blocks.iter_mut();
        for a in 0..self.width[0] {
            for k in 0..=a {
                for b in 0..self.width[1] {
                    let row = (self.first[0] + a) * self.columns + self.first[1] + b;
                    for l in 0..self.width[1] {
                        let Some(entry) = entries.next() else { return };
                        if a > k || l <= b {
                            let position = out.position(row, a - k, l + q - b);
                            out.values_mut()[position] += *entry;
                        }
                        *entry = 0.0;
                    }
                }
            }
        }
        self.touched = false;
    }
}
