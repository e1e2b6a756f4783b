//! The two visits of the rows that a backward error takes, eight sites of one cell at once.
//!
//! ```text
//! E_r c = [ z S,  a S_x + b S_y,  d S_y ]        S = sum N_i c_ij M_j, and so on; [z; a b; 0 d] the weights of site r
//! first     computed = b - E c      sizes = |E| |c| + |b|                          E'computed
//! second    r -= E v                E'r       and the last time       |E|'|r|,  squares of E's columns,
//!           sizes += |r|            |sizes|^2, |r|^2,  max_i |computed - r|_i / sizes_i
//! ```
//!
//! Sums over sites stay apart lane by lane; [`add_lanes`] brings them together. Lanes whose weights are zero add nothing.

use super::lanes::Lanes;
use super::{Level, by_width, dispatch};

/// Sites taken at once.
pub const SITES: usize = 8;

/// One number a site.
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

/// Sums over the sites of a cell for one coefficient, still lane by lane: `E'r`, `|E|'|r|`, squares of the column.
pub type ColumnSums = [SiteLanes; 3];
/// Places in [`ColumnSums`].
const PRODUCTS: usize = 0;
const SIZES: usize = 1;
const NORMS: usize = 2;

impl<'a> CellSites<'a> {
    /// The same with lengths that the compiler knows where P and Q are not 0.
    #[inline(always)]
    fn cut<const P: usize, const Q: usize>(&self) -> CellSites<'a> {
        if P * Q == 0 {
            return *self;
        }
        let ([x, dx], [y, dy]) = (self.x, self.y);
        CellSites { x: [&x[..P], &dx[..P]], y: [&y[..Q], &dy[..Q]], weights: &self.weights[..4] }
    }
}

/// What the last visit adds up over rows, lane by lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct RowSums {
    /// Squares of the sizes.
    pub sizes: SiteLanes,
    /// Squares of r.
    pub residual: SiteLanes,
    /// The largest ratio.
    pub worst: SiteLanes,
}

// `array::map` is a call of its own inside a kernel, with registers through memory: three lanes are written out instead
#[inline(always)]
fn three<V: Lanes>(rows: &[SiteLanes; 3], lanes: usize) -> [V; 3] {
    [V::load(&rows[0][lanes..]), V::load(&rows[1][lanes..]), V::load(&rows[2][lanes..])]
}

/// `[S, S_x, S_y]` with every term through `of`.
#[inline(always)]
fn rows_of<V: Lanes>(sites: &CellSites, c: &[f64], lanes: usize, of: impl Fn(V) -> V) -> [V; 3] {
    let width = sites.y[0].len();
    let at = |row: &SiteLanes| of(V::load(&row[lanes..]));
    let mut out = [V::splat(0.0); 3];
    for (a, c) in c[..sites.x[0].len() * width].chunks_exact(width).enumerate() {
        let (mut along, mut slope) = (V::splat(0.0), V::splat(0.0));
        for (b, value) in c.iter().enumerate() {
            let value = of(V::splat(*value));
            along = value.mul_add(at(&sites.y[0][b]), along);
            slope = value.mul_add(at(&sites.y[1][b]), slope);
        }
        let (n, dn) = (at(&sites.x[0][a]), at(&sites.x[1][a]));
        out = [n.mul_add(along, out[0]), dn.mul_add(along, out[1]), n.mul_add(slope, out[2])];
    }
    let w = sites.weights;
    let (z, wa, wb, d) = (at(&w[0]), at(&w[1]), at(&w[2]), at(&w[3]));
    [z * out[0], wa.mul_add(out[1], wb * out[2]), d * out[2]]
}

/// `sums += E'r` with every number of E through `of`, in the place PLACE.
#[inline(always)]
fn transposed<V: Lanes, const PLACE: usize>(
    sites: &CellSites,
    r: [V; 3],
    lanes: usize,
    of: impl Fn(V) -> V,
    sums: &mut [ColumnSums],
) {
    let at = |row: &SiteLanes| of(V::load(&row[lanes..]));
    let w = sites.weights;
    let (z, wa, wb, d) = (at(&w[0]), at(&w[1]), at(&w[2]), at(&w[3]));
    let (value, slope_x, slope_y) = (z * r[0], wa * r[1], wb.mul_add(r[1], d * r[2]));
    let width = sites.y[0].len();
    for (a, sums) in sums[..sites.x[0].len() * width].chunks_exact_mut(width).enumerate() {
        let (n, dn) = (at(&sites.x[0][a]), at(&sites.x[1][a]));
        let (along, across) = (value.mul_add(n, slope_x * dn), slope_y * n);
        for (b, sum) in sums.iter_mut().enumerate() {
            let sum = &mut sum[PLACE][lanes..];
            let terms = across.mul_add(at(&sites.y[1][b]), V::load(sum));
            along.mul_add(at(&sites.y[0][b]), terms).store(sum);
        }
    }
}

/// `norms += ` squares of the rows, row by row.
#[inline(always)]
fn add_norms<V: Lanes>(sites: &CellSites, lanes: usize, sums: &mut [ColumnSums]) {
    let at = |row: &SiteLanes| V::load(&row[lanes..]);
    let w = sites.weights;
    let (z, wa, wb, d) = (at(&w[0]), at(&w[1]), at(&w[2]), at(&w[3]));
    let width = sites.y[0].len();
    for (a, sums) in sums[..sites.x[0].len() * width].chunks_exact_mut(width).enumerate() {
        let (n, dn) = (at(&sites.x[0][a]), at(&sites.x[1][a]));
        let [zn, an, bn, d_n] = [z * n, wa * dn, wb * n, d * n];
        for (b, sum) in sums.iter_mut().enumerate() {
            let (m, dm) = (at(&sites.y[0][b]), at(&sites.y[1][b]));
            let (value, slope_x, slope_y) = (zn * m, an.mul_add(m, bn * dm), d_n * dm);
            let norm = value.mul_add(value, at(&sum[NORMS]));
            slope_y.mul_add(slope_y, slope_x.mul_add(slope_x, norm)).store(&mut sum[NORMS][lanes..]);
        }
    }
}

#[inline(always)]
fn first<V: Lanes, const P: usize, const Q: usize>(
    sites: &CellSites,
    c: &[f64],
    targets: &[SiteLanes; 3],
    [computed, sizes]: [&mut [SiteLanes; 3]; 2],
    columns: &mut [ColumnSums],
) {
    let sites = &sites.cut::<P, Q>();
    for lanes in (0..SITES).step_by(V::N) {
        let targets = three::<V>(targets, lanes);
        let (rows, magnitudes) = (rows_of::<V>(sites, c, lanes, |v| v), rows_of::<V>(sites, c, lanes, V::abs));
        let mut left = [V::splat(0.0); 3];
        for k in 0..3 {
            left[k] = targets[k] - rows[k];
            left[k].store(&mut computed[k][lanes..]);
            (magnitudes[k] + targets[k].abs()).store(&mut sizes[k][lanes..]);
        }
        transposed::<V, PRODUCTS>(sites, left, lanes, |v| v, columns);
    }
}

#[inline(always)]
fn second<V: Lanes, const P: usize, const Q: usize>(
    sites: &CellSites,
    v: &[f64],
    r: &mut [SiteLanes; 3],
    columns: &mut [ColumnSums],
) {
    let sites = &sites.cut::<P, Q>();
    for lanes in (0..SITES).step_by(V::N) {
        let moved = rows_of::<V>(sites, v, lanes, |v| v);
        let mut left = [V::splat(0.0); 3];
        for k in 0..3 {
            left[k] = V::load(&r[k][lanes..]) - moved[k];
            left[k].store(&mut r[k][lanes..]);
        }
        transposed::<V, PRODUCTS>(sites, left, lanes, |v| v, columns);
    }
}

#[inline(always)]
fn last<V: Lanes, const P: usize, const Q: usize>(
    sites: &CellSites,
    [r, computed]: [&[SiteLanes; 3]; 2],
    sizes: &mut [SiteLanes; 3],
    columns: &mut [ColumnSums],
    rows: &mut RowSums,
) {
    let sites = &sites.cut::<P, Q>();
    for lanes in (0..SITES).step_by(V::N) {
        let left = three::<V>(r, lanes);
        let (mut square, mut residual) = (V::load(&rows.sizes[lanes..]), V::load(&rows.residual[lanes..]));
        let mut worst = V::load(&rows.worst[lanes..]);
        for k in 0..3 {
            let size = V::load(&sizes[k][lanes..]) + left[k].abs();
            size.store(&mut sizes[k][lanes..]);
            square = size.mul_add(size, square);
            residual = left[k].mul_add(left[k], residual);
            let gap = (V::load(&computed[k][lanes..]) - left[k]).abs();
            worst = V::select((worst * size).less(gap), gap.div(size), worst);
        }
        square.store(&mut rows.sizes[lanes..]);
        residual.store(&mut rows.residual[lanes..]);
        worst.store(&mut rows.worst[lanes..]);
        let sizes = [left[0].abs(), left[1].abs(), left[2].abs()];
        transposed::<V, SIZES>(sites, sizes, lanes, V::abs, columns);
        add_norms::<V>(sites, lanes, columns);
    }
}

/// The first visit: `computed = targets - E c`, `sizes = |E||c| + |targets|`, and `E'computed` added to the columns.
///
/// # Panics
/// When slices are shorter than the cell's `(p + 1)(q + 1)` coefficients.
pub fn first_pass(
    level: Level,
    sites: &CellSites,
    c: &[f64],
    targets: &[SiteLanes; 3],
    out: [&mut [SiteLanes; 3]; 2],
    columns: &mut [ColumnSums],
) {
    by_width!(level, [sites.x[0].len(), sites.y[0].len()], first(
        sites: &CellSites,
        c: &[f64],
        targets: &[SiteLanes; 3],
        out: [&mut [SiteLanes; 3]; 2],
        columns: &mut [ColumnSums],
    ));
}

/// The second visit: `r -= E v`, and `E'r` added to the columns.
///
/// # Panics
/// As [`first_pass`].
pub fn second_pass(level: Level, sites: &CellSites, v: &[f64], r: &mut [SiteLanes; 3], columns: &mut [ColumnSums]) {
    by_width!(level, [sites.x[0].len(), sites.y[0].len()], second(
        sites: &CellSites,
        v: &[f64],
        r: &mut [SiteLanes; 3],
        columns: &mut [ColumnSums],
    ));
}

/// What remains to be summed when r is final (`residuals`: r and computed): `sizes += |r|`, then the sums of `columns`
/// (all but the products) and `rows`.
///
/// # Panics
/// As [`first_pass`].
pub fn last_sums(
    level: Level,
    sites: &CellSites,
    residuals: [&[SiteLanes; 3]; 2],
    sizes: &mut [SiteLanes; 3],
    columns: &mut [ColumnSums],
    rows: &mut RowSums,
) {
    by_width!(level, [sites.x[0].len(), sites.y[0].len()], last(
        sites: &CellSites,
        residuals: [&[SiteLanes; 3]; 2],
        sizes: &mut [SiteLanes; 3],
        columns: &mut [ColumnSums],
        rows: &mut RowSums,
    ));
}

/// The sum of all lanes, by pairs.
pub fn add_lanes(v: &SiteLanes) -> f64 {
    ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]))
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::*;

    const DEGREE: [usize; 2] = [2, 3];

    fn value(a: usize, b: usize) -> f64 {
        ((a * 7 + b * 5 + 1) as f64 * 0.41).sin()
    }

    fn lanes(seed: usize) -> SiteLanes {
        std::array::from_fn(|l| value(seed, l))
    }

    struct Cell {
        x: [Vec<SiteLanes>; 2],
        y: [Vec<SiteLanes>; 2],
        weights: [SiteLanes; 4],
        c: Vec<f64>,
    }

    impl Cell {
        fn new() -> Cell {
            let rows = |axis: usize, from: usize| (0..=DEGREE[axis]).map(|a| lanes(from + a)).collect();
            let mut weights = [lanes(31), lanes(32), lanes(33), lanes(34)];
            // the last lane is empty
            weights.iter_mut().for_each(|w| w[SITES - 1] = 0.0);
            let c = (0..(DEGREE[0] + 1) * (DEGREE[1] + 1)).map(|u| value(u, 40)).collect();
            Cell { x: [rows(0, 1), rows(0, 9)], y: [rows(1, 17), rows(1, 24)], weights, c }
        }

        fn sites(&self) -> CellSites<'_> {
            CellSites { x: [&self.x[0], &self.x[1]], y: [&self.y[0], &self.y[1]], weights: &self.weights }
        }

        /// Row k of E at site l, entry u, written out.
        fn entry(&self, l: usize, k: usize, u: usize) -> f64 {
            let (a, b) = (u / (DEGREE[1] + 1), u % (DEGREE[1] + 1));
            let ([n, dn], [m, dm]) = ([0, 1].map(|d| self.x[d][a][l]), [0, 1].map(|d| self.y[d][b][l]));
            let [z, wa, wb, d] = self.weights.map(|w| w[l]);
            [z * n * m, wa * dn * m + wb * n * dm, d * n * dm][k]
        }

        /// A bound of its size: the sum of the two terms' sizes.
        fn size(&self, l: usize, k: usize, u: usize) -> f64 {
            let (a, b) = (u / (DEGREE[1] + 1), u % (DEGREE[1] + 1));
            let ([n, dn], [m, dm]) = ([0, 1].map(|d| self.x[d][a][l].abs()), [0, 1].map(|d| self.y[d][b][l].abs()));
            let [z, wa, wb, d] = self.weights.map(|w| w[l].abs());
            [z * n * m, wa * dn * m + wb * n * dm, d * n * dm][k]
        }
    }

    /// Twin: every sum over the entries of E as they are written.
    #[test]
    fn every_level_agrees_with_the_rows_written_out() {
        let cell = Cell::new();
        let unknowns = cell.c.len();
        let targets = [lanes(51), lanes(52), lanes(53)];
        let v: Vec<f64> = (0..unknowns).map(|u| 0.01 * value(u, 61)).collect();
        let apply = |l: usize, k: usize, v: &[f64]| (0..unknowns).map(|u| cell.entry(l, k, u) * v[u]).sum::<f64>();
        for level in Level::available() {
            let [mut computed, mut sizes] = [[[0.0; SITES]; 3]; 2];
            let mut sums = vec![ColumnSums::default(); unknowns];
            first_pass(level, &cell.sites(), &cell.c, &targets, [&mut computed, &mut sizes], &mut sums);
            let mut twins = Twins::new("site_passes", level);
            let mut over = |l: usize, k: usize| {
                let size: f64 = (0..unknowns).map(|u| cell.size(l, k, u) * cell.c[u].abs()).sum();
                twins.compare(computed[k][l], targets[k][l] - apply(l, k, &cell.c));
                twins.compare(sizes[k][l], size + targets[k][l].abs());
            };
            (0..3 * SITES).for_each(|p| over(p / 3, p % 3));
            let mut r = computed;
            let mut again = vec![ColumnSums::default(); unknowns];
            second_pass(level, &cell.sites(), &v, &mut r, &mut again);
            let (before, mut rows) = (sizes, RowSums::default());
            last_sums(level, &cell.sites(), [&r, &computed], &mut sizes, &mut again, &mut rows);
            let mut expected = RowSums::default();
            for (l, k) in (0..3 * SITES).map(|p| (p / 3, p % 3)) {
                twins.compare(r[k][l], computed[k][l] - apply(l, k, &v));
                let size = before[k][l] + r[k][l].abs();
                twins.compare(sizes[k][l], size);
                expected.sizes[l] += size * size;
                expected.residual[l] += r[k][l] * r[k][l];
                expected.worst[l] = expected.worst[l].max((computed[k][l] - r[k][l]).abs() / size);
            }
            for l in 0..SITES {
                twins.compare(rows.sizes[l], expected.sizes[l]);
                twins.compare(rows.residual[l], expected.residual[l]);
                twins.compare(rows.worst[l], expected.worst[l]);
            }
            for u in 0..unknowns {
                let sum = |of: &dyn Fn(usize, usize) -> f64| (0..3 * SITES).map(|p| of(p / 3, p % 3)).sum::<f64>();
                twins.compare(add_lanes(&sums[u][PRODUCTS]), sum(&|l, k| cell.entry(l, k, u) * computed[k][l]));
                twins.compare(add_lanes(&again[u][PRODUCTS]), sum(&|l, k| cell.entry(l, k, u) * r[k][l]));
                twins.compare(add_lanes(&again[u][SIZES]), sum(&|l, k| cell.size(l, k, u) * r[k][l].abs()));
                twins.compare(add_lanes(&again[u][NORMS]), sum(&|l, k| cell.entry(l, k, u).powi(2)));
            }
            twins.hold(4.0);
        }
    }
}
