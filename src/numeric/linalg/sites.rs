//! Data sites, the weights of their rows, their right-hand sides, and the rows of one site.
//!
//! For a site with x values `N, N'` and y values `M, M'` (p + 1 and q + 1 of each, coefficients `c_ab` of the patch)
//!
//! ```text
//! S = sum N_a c_ab M_b     S_x = sum N'_a c_ab M_b     S_y = sum N_a c_ab M'_b
//! ```

use super::grid_axis::GridAxis;
use super::stencil::TensorShape;

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
    /// The axes of a grid; `None` for scattered data.
    fn grid_axes(&self) -> Option<[GridAxis<'_>; 2]> {
        None
    }
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
pub(super) fn site_rows(site: &Site, weights: &SiteWeights, c: &[f64], columns: usize) -> [f64; 3] {
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
