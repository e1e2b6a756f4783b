//! Packed cells: the contacts of every knot cell stored side by side in groups of eight, for all passes over their rows.
//!
//! ```text
//! on a cell   S = sum_ij s_ij u^i v^j     s = X' c Y     X, Y: the basis functions' own powers, (p + 1) x 4 and (q + 1) x 4
//! E'r         += X G Y'                   G_ij = sum_r of the cell: see palpate_numeric::simd::cell_products
//! ```
//!
//! In the user's order every pass would jump through memory; in the order of the cells it reads memory from start to end.

use super::tables::AxisTables;
use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg::{RowWeights, Targets, TensorShape};
use palpate_numeric::simd::{
    CellPiece, CellPowers, CellSites, Isa, MAX_MOMENT_DEGREE, SITES, SiteLanes, cell_basis, cell_products,
    cell_squares, cell_values,
};
use palpate_numeric::work;

/// Local coordinates of the contacts of every cell, in groups of eight. Unused lanes of a cell's last group are zero.
#[derive(Debug)]
pub struct PackedCells {
    shape: TensorShape,
    axes: [AxisTables; 2],
    /// Number of cells in y.
    across: usize,
    /// First group of every cell, x segment by x segment, and the end.
    starts: Vec<usize>,
    /// Number of contacts of every cell.
    counts: Vec<usize>,
    /// Local coordinates.
    places: [Vec<SiteLanes>; 2],
    /// The contacts' numbers in the user's order.
    numbers: Vec<[u32; SITES]>,
}

/// Weights and targets in the order of [`PackedCells`].
#[derive(Debug)]
pub struct PackedRows {
    targets: [Vec<SiteLanes>; 3],
    weights: LaneWeights,
}

#[derive(Debug)]
enum LaneWeights {
    /// Weights of a full group, and of groups with 1 to 7 contacts, one of which ends a cell.
    Uniform(Box<[[SiteLanes; 4]; SITES]>),
    PerSite(Vec<[SiteLanes; 4]>),
}

impl PackedCells {
    /// Packs the contacts, whose numbers are given cell by cell in `order`; `None` above [`MAX_MOMENT_DEGREE`].
    pub fn new(knots: &[Knots; 2], points: &[[f64; 2]], order: &[u32], cell_starts: &[u32]) -> Option<PackedCells> {
        if knots.iter().any(|k| k.degree() > MAX_MOMENT_DEGREE) {
            return None;
        }
        let shape =
            TensorShape { basis: [0, 1].map(|k| knots[k].n_basis()), degree: [0, 1].map(|k| knots[k].degree()) };
        let axes = [AxisTables::nearest(&knots[0]), AxisTables::nearest(&knots[1])];
        let across = knots[1].n_segments();
        let counts: Vec<usize> = cell_starts.windows(2).map(|ends| (ends[1] - ends[0]) as usize).collect();
        let mut starts = vec![0];
        starts.extend(counts.iter().scan(0, |sum, count| {
            *sum += count.div_ceil(SITES);
            Some(*sum)
        }));
        let groups = starts[counts.len()];
        let mut places = [vec![[0.0; SITES]; groups], vec![[0.0; SITES]; groups]];
        let mut numbers = vec![[0; SITES]; groups];
        for (cell, &start) in starts[..counts.len()].iter().enumerate() {
            let segment = [cell / across, cell % across];
            let [(cx, hx), (cy, hy)] = [0, 1].map(|k| (axes[k].centre[segment[k]], axes[k].inverse_half[segment[k]]));
            let contacts = &order[cell_starts[cell] as usize..cell_starts[cell + 1] as usize];
            for (k, &number) in contacts.iter().enumerate() {
                let (group, lane) = (start + k / SITES, k % SITES);
                let [x, y] = points[number as usize];
                places[0][group][lane] = (x - cx) * hx;
                places[1][group][lane] = (y - cy) * hy;
                numbers[group][lane] = number;
            }
        }
        Some(PackedCells { shape, axes, across, starts, counts, places, numbers })
    }

    /// u, v and numbers of the contacts of one cell.
    pub(super) fn contacts(&self, [stripe, cell]: [usize; 2]) -> ([&[f64]; 2], &[u32]) {
        let cell = stripe * self.across + cell;
        let range = self.starts[cell] * SITES..self.starts[cell] * SITES + self.counts[cell];
        let [u, v] = [0, 1].map(|k| &self.places[k].as_flattened()[range.clone()]);
        ([u, v], &self.numbers.as_flattened()[range])
    }

    /// Weights and targets in the order of the cells.
    pub fn rows(&self, row_weights: &RowWeights, targets: &Targets) -> PackedRows {
        let groups = self.numbers.len();
        let mut made = PackedRows {
            targets: [0; 3].map(|_| vec![[0.0; SITES]; groups]),
            weights: match row_weights {
                RowWeights::Uniform(uniform) => LaneWeights::Uniform(Box::new(std::array::from_fn(|filled| {
                    let live = if filled == 0 { SITES } else { filled };
                    [uniform.z, uniform.a, uniform.b, uniform.d]
                        .map(|w| std::array::from_fn(|lane| if lane < live { w } else { 0.0 }))
                }))),
                RowWeights::PerSite(_) => LaneWeights::PerSite(vec![[[0.0; SITES]; 4]; groups]),
            },
        };
        self.refill(&mut made, row_weights, targets);
        made
    }

    /// Writes weights and targets over others of the same kind.
    pub(crate) fn refill(&self, made: &mut PackedRows, row_weights: &RowWeights, targets: &Targets) {
        for (cell, &start) in self.starts[..self.counts.len()].iter().enumerate() {
            for k in 0..self.counts[cell] {
                let (group, lane) = (start + k / SITES, k % SITES);
                let number = self.numbers[group][lane] as usize;
                for (column, target) in made.targets.iter_mut().zip(targets[number]) {
                    column[group][lane] = target;
                }
                if let (LaneWeights::PerSite(weights), RowWeights::PerSite(site_weights)) =
                    (&mut made.weights, row_weights)
                {
                    let w = site_weights[number];
                    for (column, weight) in weights[group].iter_mut().zip([w.z, w.a, w.b, w.d]) {
                        column[lane] = weight;
                    }
                }
            }
        }
    }

    /// Visits all groups of contacts with the values of their basis functions: `visit(first basis functions, sites, b)`.
    pub fn visit(&self, rows: &PackedRows, mut visit: impl FnMut([usize; 2], &CellSites, [&SiteLanes; 3])) {
        let (isa, width) = (Isa::active(), self.shape.degree.map(|d| d + 1));
        let mut basis = vec![[0.0; SITES]; 2 * (width[0] + width[1])];
        for (cell, &count) in self.counts.iter().enumerate() {
            let segment = [cell / self.across, cell % self.across];
            let first = [0, 1].map(|k| self.axes[k].first[segment[k]]);
            for group in self.starts[cell]..self.starts[cell + 1] {
                let (x, y) = basis.split_at_mut(2 * width[0]);
                let ((x, dx), (y, dy)) = (x.split_at_mut(width[0]), y.split_at_mut(width[1]));
                for (k, [values, slopes]) in [[&mut *x, &mut *dx], [&mut *y, &mut *dy]].into_iter().enumerate() {
                    let (functions, inverse_half) =
                        (&self.axes[k].values[segment[k]], self.axes[k].inverse_half[segment[k]]);
                    cell_basis(isa, functions, inverse_half, &self.places[k][group], values, slopes);
                }
                let is_last = group + 1 == self.starts[cell + 1];
                let weights = match &rows.weights {
                    LaneWeights::Uniform(filled) => &filled[if is_last { count % SITES } else { 0 }],
                    LaneWeights::PerSite(weights) => &weights[group],
                };
                let sites = CellSites { x: [x, dx], y: [y, dy], weights };
                visit(first, &sites, [0, 1, 2].map(|t| &rows.targets[t][group]));
            }
        }
    }

    /// Contacts.
    pub(super) fn len(&self) -> usize {
        self.counts.iter().sum()
    }

    /// Counts passes over the rows of all contacts.
    fn count(&self, passes: usize) {
        work::add(3 * passes * self.len() * self.shape.local());
    }

    /// `out += E'(b - E c)`.
    pub fn descent(&self, rows: &PackedRows, c: &[f64], out: &mut [f64]) {
        self.count(2);
        let isa = Isa::active();
        self.each_cell(rows, true, c, |[x, y], piece| {
            let mut powers = [[0.0; 4]; 4];
            cell_products(isa, piece, &mut powers);
            self.add_products([x, y], &powers, out);
        });
    }

    /// `|b - E c|^2` of heights and of slopes; without `targets`, `|E c|^2`.
    pub fn squares(&self, rows: &PackedRows, targets: bool, c: &[f64]) -> [f64; 2] {
        self.count(1);
        let isa = Isa::active();
        let mut sums = [0.0; 2];
        self.each_cell(rows, targets, c, |_, piece| cell_squares(isa, piece, &mut sums));
        sums
    }

    /// `visit(contact, [S, S_x, S_y])`, cell by cell.
    pub fn values(&self, c: &[f64], mut visit: impl FnMut(usize, [f64; 3])) {
        self.count(1);
        let (isa, mut found) = (Isa::active(), Vec::new());
        for (cell, &count) in self.counts.iter().enumerate() {
            if count == 0 {
                continue;
            }
            let range = self.starts[cell]..self.starts[cell + 1];
            let segment = [cell / self.across, cell % self.across];
            found.resize(range.len(), [[0.0; SITES]; 3]);
            let places = [0, 1].map(|k| &self.places[k][range.clone()]);
            let inverse_half = [0, 1].map(|k| self.axes[k].inverse_half[segment[k]]);
            cell_values(isa, &self.surface(segment, c), inverse_half, places, &mut found);
            let (_, numbers) = self.contacts(segment);
            for (k, &number) in numbers.iter().enumerate() {
                let group = &found[k / SITES];
                visit(number as usize, [0, 1, 2].map(|t| group[t][k % SITES]));
            }
        }
    }

    fn each_cell(&self, rows: &PackedRows, targets: bool, c: &[f64], mut visit: impl FnMut([usize; 2], &CellPiece)) {
        for (cell, &count) in self.counts.iter().enumerate() {
            if count == 0 {
                continue;
            }
            let range = self.starts[cell]..self.starts[cell + 1];
            let segment = [cell / self.across, cell % self.across];
            let (weights, last) = match &rows.weights {
                LaneWeights::Uniform(filled) => (&filled[..1], &filled[count % SITES]),
                LaneWeights::PerSite(weights) => (&weights[range.clone()], &weights[range.end - 1]),
            };
            visit(
                segment,
                &CellPiece {
                    surface: &self.surface(segment, c),
                    inverse_half: [0, 1].map(|k| self.axes[k].inverse_half[segment[k]]),
                    places: [0, 1].map(|k| &self.places[k][range.clone()]),
                    targets: targets.then(|| [0, 1, 2].map(|t| &rows.targets[t][range.clone()])),
                    weights,
                    last,
                },
            );
        }
    }

    /// `X' c Y` on one cell.
    fn surface(&self, [x, y]: [usize; 2], c: &[f64]) -> CellPowers {
        let [along, across] = &self.axes;
        let mut surface = [[0.0; 4]; 4];
        for (a, powers) in along.values[x].iter().enumerate() {
            let start = (along.first[x] + a) * self.shape.basis[1] + across.first[y];
            let mut line = [0.0; 4];
            for (value, function) in c[start..].iter().zip(&across.values[y]) {
                (0..4).for_each(|j| line[j] += value * function[j]);
            }
            for i in 0..4 {
                (0..4).for_each(|j| surface[i][j] += powers[i] * line[j]);
            }
        }
        surface
    }

    /// `out += X G Y'` of one cell.
    fn add_products(&self, [x, y]: [usize; 2], powers: &CellPowers, out: &mut [f64]) {
        let [along, across] = &self.axes;
        for (a, function) in along.values[x].iter().enumerate() {
            let mut line = [0.0; 4];
            for i in 0..4 {
                (0..4).for_each(|j| line[j] += function[i] * powers[i][j]);
            }
            let start = (along.first[x] + a) * self.shape.basis[1] + across.first[y];
            for (target, function) in out[start..].iter_mut().zip(&across.values[y]) {
                *target +=
                    (line[0] * function[0] + line[1] * function[1]) + (line[2] * function[2] + line[3] * function[3]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observation::ScatteredSites;
    use palpate_numeric::linalg::{SiteWeights, Sites, apply_rows, descent, residuals};

    /// Slopes of basis functions grow with the number of segments.
    fn size_of(segments: [usize; 2]) -> f64 {
        1.0 + segments[0].max(segments[1]) as f64
    }

    fn check(degree: [usize; 2], segments: [usize; 2], count: usize, row_weights: &RowWeights) {
        let knots = [
            Knots::uniform(degree[0], segments[0], 0.0, 1.0).unwrap(),
            Knots::uniform(degree[1], segments[1], -1.0, 1.0).unwrap(),
        ];
        let points: Vec<[f64; 2]> = (0..count)
            .map(|r| [(r as f64 * 0.754_877_666).fract(), (r as f64 * 0.569_840_291).fract() * 2.0 - 1.0])
            .collect();
        let targets: Targets = (0..count).map(|r| [1.0, 2.0, 3.0].map(|k| (k * r as f64).sin())).collect();
        let sites = ScatteredSites::new(knots, points);
        let packed = sites.packed_cells().unwrap();
        let rows = packed.rows(row_weights, &targets);
        let unknowns = packed.shape.unknowns();
        let c: Vec<f64> = (0..unknowns).map(|u| (u as f64 * 0.7).cos()).collect();
        for (with_targets, given) in [(true, &targets), (false, &vec![[0.0; 3]; count])] {
            let mut expected = Targets::new();
            residuals(&sites, row_weights, given, &c, &mut expected);
            let squares =
                expected.iter().fold([0.0, 0.0], |s, r| [s[0] + r[0] * r[0], s[1] + r[1] * r[1] + r[2] * r[2]]);
            let found = packed.squares(&rows, with_targets, &c);
            for block in 0..2 {
                assert!((found[block] - squares[block]).abs() <= 1e-13 * squares[block], "{found:?} {squares:?}");
            }
        }
        let plain = SiteWeights { z: 1.0, a: 1.0, b: 0.0, d: 1.0 };
        let (mut visited, mut expected) = (0, Targets::new());
        apply_rows(&sites, &RowWeights::Uniform(plain), &c, &mut expected);
        packed.values(&c, |number, found| {
            let size = size_of(segments);
            (0..3).for_each(|k| assert!((found[k] - expected[number][k]).abs() < 1e-14 * size, "{k} {found:?}"));
            visited += 1;
        });
        assert_eq!(visited, count);
        let mut expected = Vec::new();
        sites.visit(|s| expected.push((s.first, s.index, [s.x, s.dx, s.y, s.dy].concat())));
        let mut next = expected.iter();
        packed.visit(&rows, |first, group, b| {
            let basis: Vec<&SiteLanes> = group.x.iter().chain(&group.y).flat_map(|rows| rows.iter()).collect();
            // lanes without a site have weight zero
            for l in (0..SITES).filter(|l| group.weights[0][*l] != 0.0) {
                let (start, index, values) = next.next().unwrap();
                let w = row_weights.at(*index);
                assert_eq!(
                    (first, group.weights.iter().map(|lanes| lanes[l]).collect()),
                    (*start, vec![w.z, w.a, w.b, w.d])
                );
                assert_eq!(b.map(|b| b[l]), targets[*index]);
                basis.iter().zip(values).for_each(|(a, b)| assert!((a[l] - b).abs() < 1e-14 * size_of(segments)));
            }
        });
        assert!(next.next().is_none());
        let (mut found, mut expected) = (vec![0.0; unknowns], vec![0.0; unknowns]);
        packed.descent(&rows, &c, &mut found);
        descent(&sites, row_weights, &targets, &c, &mut expected);
        let largest = expected.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let worst = found.iter().zip(&expected).map(|(a, b)| (a - b).abs() / largest).fold(0.0, f64::max);
        println!("degree {degree:?} contacts {count}: {worst:.1e} of the largest entry");
        assert!(worst < 1e-14, "{degree:?}: {worst:e}");
    }

    #[test]
    fn lanes_and_rows_one_by_one_give_the_same_visits() {
        for (degree, segments) in
            [([3, 3], [5, 4]), ([2, 2], [1, 1]), ([2, 3], [12, 3]), ([1, 2], [3, 9]), ([3, 1], [9, 40])]
        {
            check(degree, segments, 3000, &RowWeights::Uniform(SiteWeights { z: 2.0, a: 0.5, b: 0.0, d: 0.7 }));
            check(degree, segments, 50, &RowWeights::Uniform(SiteWeights { z: 1.0, a: 0.5, b: -0.3, d: 0.7 }));
            let varied = |r: usize| {
                let w = 1.0 + 0.5 * (r as f64).sin();
                SiteWeights { z: w, a: 0.5 * w, b: 0.2 * (r as f64).cos(), d: 2.0 - w }
            };
            check(degree, segments, 700, &RowWeights::PerSite((0..700).map(varied).collect()));
        }
        let knots = [Knots::uniform(4, 2, 0.0, 1.0).unwrap(), Knots::uniform(3, 2, 0.0, 1.0).unwrap()];
        assert!(ScatteredSites::new(knots, vec![[0.5, 0.5]]).packed_cells().is_none());
    }
}
