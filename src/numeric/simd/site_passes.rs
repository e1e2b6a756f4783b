//! The passes over the rows that a backward error needs, eight sites of one cell at once.
//!
//! ```text
//! E_r c = [ z S,  a S_x + b S_y,  d S_y ]        S = sum N_i c_ij M_j, and so on; [z; a b; 0 d] the weights of site r
//! products  r = (b - E c) - E v                  E'r
//! last      sizes = |E| |c| + |b| + |r|          E'r, |E|'|r|, squares of E's columns,
//!                                                |sizes|^2, |r|^2,  max_i |b - E c - r|_i / sizes_i
//! ```
//!
//! Every pass forms the rows again, which takes less time than reading stored results of an earlier pass. Sums over sites
//! are kept lane by lane, and [`add_lanes`] adds the lanes. Lanes with zero weights add nothing.

use super::cell_sites::{CellSites, CellVectors, ColumnSums, RowSums, SITES, SiteLanes};
use super::lanes::Lanes;
use super::{Isa, by_width, dispatch};

/// Places in [`ColumnSums`].
const PRODUCTS: usize = 0;
const SIZES: usize = 1;
const NORMS: usize = 2;

// three lanes are written out, because `array::map` inside a kernel becomes a call that passes registers through memory
#[inline(always)]
fn three<V: Lanes>(rows: [&SiteLanes; 3], lanes: usize) -> [V; 3] {
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
fn norms<V: Lanes, const P: usize, const Q: usize>(sites: &CellSites, sums: &mut [ColumnSums]) {
    let sites = &sites.cut::<P, Q>();
    for lanes in (0..SITES).step_by(V::N) {
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
}

/// `[b - E c, r]`.
#[inline(always)]
fn residuals<V: Lanes>(sites: &CellSites, vectors: &CellVectors, lanes: usize) -> [[V; 3]; 2] {
    let mut computed = three::<V>(vectors.targets, lanes);
    let rows = rows_of::<V>(sites, vectors.c, lanes, |v| v);
    for k in 0..3 {
        computed[k] = computed[k] - rows[k];
    }
    let mut left = computed;
    if !vectors.v.is_empty() {
        let moved = rows_of::<V>(sites, vectors.v, lanes, |v| v);
        for k in 0..3 {
            left[k] = computed[k] - moved[k];
        }
    }
    [computed, left]
}

#[inline(always)]
fn products<V: Lanes, const P: usize, const Q: usize>(
    sites: &CellSites,
    vectors: &CellVectors,
    columns: &mut [ColumnSums],
) {
    let sites = &sites.cut::<P, Q>();
    for lanes in (0..SITES).step_by(V::N) {
        let [_, left] = residuals::<V>(sites, vectors, lanes);
        transposed::<V, PRODUCTS>(sites, left, lanes, |v| v, columns);
    }
}

#[inline(always)]
fn last<V: Lanes, const P: usize, const Q: usize>(
    sites: &CellSites,
    vectors: &CellVectors,
    columns: &mut [ColumnSums],
    rows: &mut RowSums,
) {
    let sites = &sites.cut::<P, Q>();
    for lanes in (0..SITES).step_by(V::N) {
        let [computed, left] = residuals::<V>(sites, vectors, lanes);
        transposed::<V, PRODUCTS>(sites, left, lanes, |v| v, columns);
        let sizes = row_sizes::<V>(sites, vectors, &left, lanes);
        let (mut square, mut residual) = (V::load(&rows.sizes[lanes..]), V::load(&rows.residual[lanes..]));
        for k in 0..3 {
            square = sizes[k].mul_add(sizes[k], square);
            residual = left[k].mul_add(left[k], residual);
        }
        square.store(&mut rows.sizes[lanes..]);
        residual.store(&mut rows.residual[lanes..]);
        add_worst::<V>(&computed, &left, &sizes, lanes, &mut rows.worst);
        let left = [left[0].abs(), left[1].abs(), left[2].abs()];
        transposed::<V, SIZES>(sites, left, lanes, V::abs, columns);
    }
}

/// `|E||c| + |b| + |r|`.
#[inline(always)]
fn row_sizes<V: Lanes>(sites: &CellSites, vectors: &CellVectors, left: &[V; 3], lanes: usize) -> [V; 3] {
    let mut sizes = rows_of::<V>(sites, vectors.c, lanes, V::abs);
    let targets = three::<V>(vectors.targets, lanes);
    for k in 0..3 {
        sizes[k] = (sizes[k] + targets[k].abs()) + left[k].abs();
    }
    sizes
}

#[inline(always)]
fn add_worst<V: Lanes>(computed: &[V; 3], left: &[V; 3], sizes: &[V; 3], lanes: usize, worst: &mut SiteLanes) {
    let mut most = V::load(&worst[lanes..]);
    for k in 0..3 {
        let gap = (computed[k] - left[k]).abs();
        most = V::select((most * sizes[k]).less(gap), gap.div(sizes[k]), most);
    }
    most.store(&mut worst[lanes..]);
}

#[inline(always)]
fn against_norms<V: Lanes, const P: usize, const Q: usize>(
    sites: &CellSites,
    vectors: &CellVectors,
    largest: &[f64],
    tiny: f64,
    worst: &mut SiteLanes,
) {
    let sites = &sites.cut::<P, Q>();
    for lanes in (0..SITES).step_by(V::N) {
        let [computed, left] = residuals::<V>(sites, vectors, lanes);
        let mut sizes = row_sizes::<V>(sites, vectors, &left, lanes);
        let norms = rows_of::<V>(sites, largest, lanes, V::abs);
        for k in 0..3 {
            sizes[k] = V::select(sizes[k].less(V::splat(tiny) * norms[k]), sizes[k] + norms[k], sizes[k]);
        }
        add_worst::<V>(&computed, &left, &sizes, lanes, worst);
    }
}

/// `E'r` added to the columns.
///
/// # Panics
/// When slices are shorter than the cell's `(p + 1)(q + 1)` coefficients.
pub fn products_pass(isa: Isa, sites: &CellSites, vectors: &CellVectors, columns: &mut [ColumnSums]) {
    by_width!(isa, [sites.x[0].len(), sites.y[0].len()], products(
        sites: &CellSites,
        vectors: &CellVectors,
        columns: &mut [ColumnSums],
    ));
}

/// Squares of the columns.
///
/// # Panics
/// As [`products_pass`].
pub fn columns_pass(isa: Isa, sites: &CellSites, columns: &mut [ColumnSums]) {
    by_width!(isa, [sites.x[0].len(), sites.y[0].len()], norms(sites: &CellSites, columns: &mut [ColumnSums]));
}

/// The last pass: all sums over rows, `E'r` and `|E|'|r|`.
///
/// # Panics
/// As [`products_pass`].
pub fn last_pass(isa: Isa, sites: &CellSites, vectors: &CellVectors, columns: &mut [ColumnSums], rows: &mut RowSums) {
    by_width!(isa, [sites.x[0].len(), sites.y[0].len()], last(
        sites: &CellSites,
        vectors: &CellVectors,
        columns: &mut [ColumnSums],
        rows: &mut RowSums,
    ));
}

/// The largest ratio again, where `|E| largest` is added to sizes below `tiny |E| largest`; `largest` has one entry for each
/// coefficient of the cell.
///
/// # Panics
/// As [`products_pass`].
pub fn norms_pass(
    isa: Isa,
    sites: &CellSites,
    vectors: &CellVectors,
    largest: &[f64],
    tiny: f64,
    worst: &mut SiteLanes,
) {
    by_width!(isa, [sites.x[0].len(), sites.y[0].len()], against_norms(
        sites: &CellSites,
        vectors: &CellVectors,
        largest: &[f64],
        tiny: f64,
        worst: &mut SiteLanes,
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
            // the last lane has no site
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

    /// Twin: the written sums over the entries of E.
    #[test]
    fn every_isa_agrees_with_the_rows_written_out() {
        let cell = Cell::new();
        let unknowns = cell.c.len();
        let targets = [lanes(51), lanes(52), lanes(53)];
        let v: Vec<f64> = (0..unknowns).map(|u| 0.01 * value(u, 61)).collect();
        let apply = |l: usize, k: usize, v: &[f64]| (0..unknowns).map(|u| cell.entry(l, k, u) * v[u]).sum::<f64>();
        let size = |l: usize, k: usize, v: &[f64]| (0..unknowns).map(|u| cell.size(l, k, u) * v[u].abs()).sum::<f64>();
        let gap = |l: usize, k: usize| apply(l, k, &v);
        let left = |l: usize, k: usize| targets[k][l] - apply(l, k, &cell.c) - gap(l, k);
        let whole = |l: usize, k: usize| size(l, k, &cell.c) + targets[k][l].abs() + left(l, k).abs();
        let ratio = |l: usize, k: usize, size: f64| if size > 0.0 { gap(l, k).abs() / size } else { 0.0 };
        let over = |of: &dyn Fn(usize, usize) -> f64| (0..3 * SITES).map(|p| of(p / 3, p % 3)).sum::<f64>();
        let vectors = CellVectors { c: &cell.c, v: &v, targets: targets.each_ref() };
        let (largest, tiny) = (vec![3.0; unknowns], 0.3);
        for isa in Isa::available() {
            let mut products = vec![ColumnSums::default(); unknowns];
            products_pass(isa, &cell.sites(), &vectors, &mut products);
            let (mut sums, mut rows) = (vec![ColumnSums::default(); unknowns], RowSums::default());
            last_pass(isa, &cell.sites(), &vectors, &mut sums, &mut rows);
            columns_pass(isa, &cell.sites(), &mut sums);
            let (zero, mut of_zero, mut of_nothing) = (vec![0.0; unknowns], products.clone(), products.clone());
            products_pass(isa, &cell.sites(), &CellVectors { v: &zero, ..vectors }, &mut of_zero);
            products_pass(isa, &cell.sites(), &CellVectors { v: &[], ..vectors }, &mut of_nothing);
            assert_eq!(of_zero, of_nothing);
            let mut against = SiteLanes::default();
            norms_pass(isa, &cell.sites(), &vectors, &largest, tiny, &mut against);
            let mut twins = Twins::new("site_passes", isa);
            for l in 0..SITES {
                let three = |of: &dyn Fn(usize) -> f64| (0..3).map(of).collect::<Vec<f64>>();
                twins.compare(rows.sizes[l], three(&|k| whole(l, k).powi(2)).iter().sum());
                twins.compare(rows.residual[l], three(&|k| left(l, k).powi(2)).iter().sum());
                twins.compare(rows.worst[l], three(&|k| ratio(l, k, whole(l, k))).into_iter().fold(0.0, f64::max));
                let with_norm = |k: usize| {
                    let (size, norm) = (whole(l, k), size(l, k, &largest));
                    ratio(l, k, if size < tiny * norm { size + norm } else { size })
                };
                twins.compare(against[l], three(&with_norm).into_iter().fold(0.0, f64::max));
            }
            for u in 0..unknowns {
                let product = over(&|l, k| cell.entry(l, k, u) * left(l, k));
                twins.compare(add_lanes(&products[u][PRODUCTS]), product);
                twins.compare(add_lanes(&sums[u][PRODUCTS]), product);
                twins.compare(add_lanes(&sums[u][SIZES]), over(&|l, k| cell.size(l, k, u) * left(l, k).abs()));
                twins.compare(add_lanes(&sums[u][NORMS]), over(&|l, k| cell.entry(l, k, u).powi(2)));
            }
            twins.hold(4.0);
        }
    }
}
