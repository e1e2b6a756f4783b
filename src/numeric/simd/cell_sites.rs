//! Eight sites of one knot cell, and the vectors and sums that passes over their rows take ([`super::site_passes`]).
//!
//! ```text
//! x[k][a][lane] = N_a^(k), y[k][b][lane] = M_b^(k) at the site of that lane, k = 0, 1      weights z, a, b, d
//! ```

/// Sites taken at once.
pub const SITES: usize = 8;

/// One number for each site.
pub type SiteLanes = [f64; SITES];

/// Eight sites of one cell.
#[derive(Clone, Copy, Debug)]
pub struct CellSites<'a> {
    /// N and N', `p + 1` each.
    pub x: [&'a [SiteLanes]; 2],
    /// M and M', `q + 1` each.
    pub y: [&'a [SiteLanes]; 2],
    /// z, a, b, d.
    pub weights: &'a [SiteLanes],
}

/// Sums over the sites of a cell for one coefficient, kept lane by lane: `E'r`, `|E|'|r|`, squares of the column.
pub type ColumnSums = [SiteLanes; 3];
impl<'a> CellSites<'a> {
    /// The same slices cut to the lengths P and Q, which the compiler knows, unless they are 0.
    #[inline(always)]
    pub(super) fn cut<const P: usize, const Q: usize>(&self) -> CellSites<'a> {
        if P * Q == 0 {
            return *self;
        }
        let ([x, dx], [y, dy]) = (self.x, self.y);
        CellSites { x: [&x[..P], &dx[..P]], y: [&y[..Q], &dy[..Q]], weights: &self.weights[..4] }
    }
}

/// What the last pass sums over rows, lane by lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct RowSums {
    /// Squares of the sizes.
    pub sizes: SiteLanes,
    /// Squares of r.
    pub residual: SiteLanes,
    /// The largest ratio.
    pub worst: SiteLanes,
}

/// The vectors of one cell's sites and coefficients.
#[derive(Clone, Copy, Debug)]
pub struct CellVectors<'a> {
    /// c on the cell.
    pub c: &'a [f64],
    /// v on the cell; empty where it is zero.
    pub v: &'a [f64],
    /// b of the sites.
    pub targets: [&'a SiteLanes; 3],
}
