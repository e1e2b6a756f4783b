//! Data sites, the weights of their rows, their right-hand sides, and the products that are built on these.
//!
//! For a site with x values `N, N'` and y values `M, M'` (p + 1 and q + 1 of each, coefficients `c_ab` of the patch)
//!
//! ```text
//! S = sum N_a c_ab M_b     S_x = sum N'_a c_ab M_b     S_y = sum N_a c_ab M'_b
//! A_(ab)(kl) += (wz^2 N_a N_k + a^2 N'_a N'_k) M_b M_l + a b (N'_a N_k M_b M'_l + N_a N'_k M'_b M_l)
//!               + (b^2 + d^2) N_a N_k M'_b M'_l
//! ```

use super::stencil::{StencilMatrix, TensorShape};

/// One data site: the basis functions that are not zero there, with their values and slopes.
#[derive(Clone, Copy, Debug)]
pub struct Site<'a> {
    /// Number of the datum in the user's order (gridded: `i m + j`).
    pub index: usize,
    /// First basis function in x and in y.
    pub first: [usize; 2],
    /// N, p + 1 values.
    pub x: &'a [f64],
    /// N'.
    pub dx: &'a [f64],
    /// M, q + 1 values.
    pub y: &'a [f64],
    /// M'.
    pub dy: &'a [f64],
}

impl Site<'_> {
    /// Calls `body` with this site. For degrees 2, 3 and 4 in both directions the rows have a length that the compiler
    /// knows, so it may unroll the loops of `body`; the bits are the same in both cases.
    #[inline(always)]
    pub fn unrolled<T>(&self, body: impl FnOnce(&Site) -> T) -> T {
        match [self.x.len(), self.y.len()] {
            [3, 3] => body(&self.cut(3)),
            [4, 4] => body(&self.cut(4)),
            [5, 5] => body(&self.cut(5)),
            _ => body(self),
        }
    }

    /// The same site with every row cut to length `n`.
    #[inline(always)]
    pub fn cut(&self, n: usize) -> Site<'_> {
        Site { x: &self.x[..n], dx: &self.dx[..n], y: &self.y[..n], dy: &self.dy[..n], ..*self }
    }
}

/// Sites of data under a tensor spline; implemented by scattered and by gridded data.
pub trait Sites: Sync {
    /// Shape of the spline.
    fn shape(&self) -> TensorShape;
    /// Number of sites.
    fn len(&self) -> usize;
    /// No sites.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Visits every site, knot cell by knot cell (x segment major): all sites of a cell come together.
    fn visit(&self, f: impl FnMut(&Site));
    /// The same visit, one cell at a time, if the basis rows are stored side by side; otherwise it visits nothing and
    /// returns `false`. It calls `f(first basis functions, numbers of the data, rows)`, where `rows` holds N, N', M, M' of
    /// one site after the other.
    fn visit_cells(&self, _f: impl FnMut([usize; 2], &[u32], &[f64])) -> bool {
        false
    }
}

/// Weights of one site's rows: `wz` and the upper triangle `[a b; 0 d]`. They multiply residuals, not squares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SiteWeights {
    /// Weight of the value row.
    pub z: f64,
    /// Entry a: slope in x.
    pub a: f64,
    /// Entry b: coupling of the slopes (normal rows only).
    pub b: f64,
    /// Entry d: slope in y.
    pub d: f64,
}

/// Weights of all rows.
#[derive(Clone, Debug, PartialEq)]
pub enum RowWeights {
    /// The same everywhere.
    Uniform(SiteWeights),
    /// One per site.
    PerSite(Vec<SiteWeights>),
}

impl RowWeights {
    /// Weights of site `index`.
    #[inline]
    pub fn at(&self, index: usize) -> SiteWeights {
        match self {
            RowWeights::Uniform(weights) => *weights,
            RowWeights::PerSite(weights) => weights[index],
        }
    }

    /// Number of rows with a weight that is not zero, among `sites` sites: `[values, slopes]`.
    pub fn row_counts(&self, sites: usize) -> [usize; 2] {
        let count = |w: &SiteWeights| {
            [usize::from(w.z != 0.0), usize::from(w.a != 0.0 || w.b != 0.0) + usize::from(w.d != 0.0)]
        };
        match self {
            RowWeights::Uniform(weights) => count(weights).map(|c| c * sites),
            RowWeights::PerSite(weights) => {
                weights.iter().map(count).fold([0, 0], |sum, c| [sum[0] + c[0], sum[1] + c[1]])
            }
        }
    }
}

/// Weighted right-hand sides, three per site: `wz z`, `a zx + b zy`, `d zy` (normal rows have their own in place of the last two).
pub type Targets = Vec<[f64; 3]>;

/// `[wz S, a S_x + b S_y, d S_y]` of the spline `c` at one site.
#[inline]
pub(crate) fn site_rows(site: &Site, weights: &SiteWeights, c: &[f64], columns: usize) -> [f64; 3] {
    site.unrolled(|site| site_rows_of(site, weights, c, columns))
}

#[inline(always)]
fn site_rows_of(site: &Site, weights: &SiteWeights, c: &[f64], columns: usize) -> [f64; 3] {
    let (mut s, mut sx, mut sy) = (0.0, 0.0, 0.0);
    for a in 0..site.x.len() {
        let start = (site.first[0] + a) * columns + site.first[1];
        let row = &c[start..start + site.y.len()];
        let (mut along, mut slope) = (0.0, 0.0);
        for (b, value) in row.iter().enumerate() {
            along += value * site.y[b];
            slope += value * site.dy[b];
        }
        s += site.x[a] * along;
        sx += site.dx[a] * along;
        sy += site.x[a] * slope;
    }
    [weights.z * s, weights.a * sx + weights.b * sy, weights.d * sy]
}

/// `out = E c`, weighted, in the user's order.
pub(crate) fn apply_rows(sites: &impl Sites, row_weights: &RowWeights, c: &[f64], out: &mut Targets) {
    let columns = sites.shape().basis[1];
    out.clear();
    out.resize(sites.len(), [0.0; 3]);
    sites.visit(|site| out[site.index] = site_rows(site, &row_weights.at(site.index), c, columns));
}

/// `out = b - E c`, weighted, in the user's order.
pub(crate) fn residuals(sites: &impl Sites, row_weights: &RowWeights, targets: &Targets, c: &[f64], out: &mut Targets) {
    let columns = sites.shape().basis[1];
    out.clear();
    out.resize(sites.len(), [0.0; 3]);
    sites.visit(|site| {
        let rows = site_rows(site, &row_weights.at(site.index), c, columns);
        let target = targets[site.index];
        out[site.index] = [0, 1, 2].map(|k| target[k] - rows[k]);
    });
}

/// `out = E' r` for weighted rows `r`.
pub fn normal_rhs(sites: &impl Sites, row_weights: &RowWeights, rows: &Targets, out: &mut [f64]) {
    let columns = sites.shape().basis[1];
    out.fill(0.0);
    sites.visit(|site| add_transposed(site, &row_weights.at(site.index), rows[site.index], columns, out));
}

/// `out = E'(b - E c)` in one visit, with the same bits as [`residuals`] followed by [`normal_rhs`].
pub(crate) fn descent(sites: &impl Sites, row_weights: &RowWeights, targets: &Targets, c: &[f64], out: &mut [f64]) {
    let columns = sites.shape().basis[1];
    out.fill(0.0);
    sites.visit(|site| {
        let weights = row_weights.at(site.index);
        let (rows, target) = (site_rows(site, &weights, c, columns), targets[site.index]);
        add_transposed(site, &weights, [0, 1, 2].map(|k| target[k] - rows[k]), columns, out);
    });
}

/// `out += E_site' r` for the weighted rows `r` of one site; `columns` are the basis functions in y.
#[inline]
pub(super) fn add_transposed(site: &Site, w: &SiteWeights, r: [f64; 3], columns: usize, out: &mut [f64]) {
    site.unrolled(|site| add_transposed_of(site, w, r, columns, out))
}

#[inline(always)]
fn add_transposed_of(site: &Site, w: &SiteWeights, r: [f64; 3], columns: usize, out: &mut [f64]) {
    let (value, slope_x, slope_y) = (w.z * r[0], w.a * r[1], w.b * r[1] + w.d * r[2]);
    for a in 0..site.x.len() {
        let start = (site.first[0] + a) * columns + site.first[1];
        let along = value * site.x[a] + slope_x * site.dx[a];
        let across = slope_y * site.x[a];
        for (b, target) in out[start..start + site.y.len()].iter_mut().enumerate() {
            *target += along * site.y[b] + across * site.dy[b];
        }
    }
}

/// Adds `E'E` to `out`, cell by cell. The rank-one updates go into a dense matrix of the cell, which is added to `out` once.
pub fn assemble(sites: &impl Sites, row_weights: &RowWeights, out: &mut StencilMatrix) {
    let shape = sites.shape();
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
