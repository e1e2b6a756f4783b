//! Scattered contacts: each row is the Kronecker product of the contact's two basis rows (row-wise Khatri-Rao product).

use std::sync::{Arc, OnceLock};

use super::cells::PackedCells;
use palpate_numeric::bspline::{Knots, MAX_DEGREE};
use palpate_numeric::linalg::{Site, Sites, TensorShape};

/// Basis rows are kept up to this many numbers (64 MB: half a million sites of degree 3). Larger fits form them again on
/// every visit, which costs twice the time and no memory.
const KEPT: usize = 1 << 23;
/// Fits with this many contacts, or with at least [`SOME`] contacts and [`DENSE`] for each cell, use packed cells: the
/// equations come from moments, cell by cell and on all threads, and passes over the rows use each cell's polynomial, eight
/// contacts at once. Results agree with those of single rows to a few units in the last place of the largest term.
const MANY: usize = 20_000;
/// Fewer contacts than this are as fast one by one, because the tables of the cells cost more than packing gains.
const SOME: usize = 100;
/// Contacts for each cell from which packing pays: a cell has a cost of its own, however few contacts it holds.
const DENSE: usize = 8;

/// Scattered sites, sorted by knot cell with a counting sort. Clones share their memory.
#[derive(Clone, Debug)]
pub struct ScatteredSites {
    knots: [Knots; 2],
    points: Arc<[[f64; 2]]>,
    /// Sites in cell order.
    order: Arc<[u32]>,
    /// Start of every cell in `order`.
    cell_starts: Arc<[u32]>,
    kept: Arc<Kept>,
}

/// Points sorted by knot cell. The counting sort is stable: points of one cell keep their order.
#[derive(Clone, Debug)]
pub struct CellNumbers {
    /// Numbers of the points.
    pub order: Vec<u32>,
    /// Start of every cell (x segment by x segment) in `order`, and the end.
    pub cell_starts: Vec<u32>,
}

impl CellNumbers {
    /// Sorts the points `(x, y)`, in the coordinates of the knots.
    pub(crate) fn of(knots: &[Knots; 2], points: &[[f64; 2]]) -> CellNumbers {
        let across = knots[1].n_segments();
        let cells: Vec<u32> =
            points.iter().map(|p| (knots[0].segment_of(p[0]) * across + knots[1].segment_of(p[1])) as u32).collect();
        let mut cell_starts = vec![0u32; knots[0].n_segments() * across + 1];
        cells.iter().for_each(|&cell| cell_starts[cell as usize + 1] += 1);
        for cell in 1..cell_starts.len() {
            cell_starts[cell] += cell_starts[cell - 1];
        }
        let mut next = cell_starts.clone();
        let mut order = vec![0u32; points.len()];
        for (site, &cell) in cells.iter().enumerate() {
            order[next[cell as usize] as usize] = site as u32;
            next[cell as usize] += 1;
        }
        CellNumbers { order, cell_starts }
    }
}

/// What is made at its first use.
#[derive(Debug, Default)]
struct Kept {
    /// In cell order, site after site: values in x, slopes in x, values in y, slopes in y.
    rows: OnceLock<Vec<f64>>,
    packed: OnceLock<Option<PackedCells>>,
}

impl ScatteredSites {
    /// Sorts the points `(x, y)` (coordinates of the knots) by knot cell.
    pub fn new(knots: [Knots; 2], points: Vec<[f64; 2]>) -> ScatteredSites {
        let CellNumbers { order, cell_starts } = CellNumbers::of(&knots, &points);
        let sites = ScatteredSites {
            knots,
            points: points.into(),
            order: order.into(),
            cell_starts: cell_starts.into(),
            kept: Arc::default(),
        };
        // with packed cells only QR visits single rows; other fits need the rows, so they are made now, while the points
        // are in the caches
        if !sites.uses_packed_cells() {
            sites.rows();
        }
        sites
    }

    /// Whether this many contacts under these knots are worth packing into cells ([`ScatteredSites::packed_cells`]).
    pub fn worth_packing(contacts: usize, knots: &[Knots; 2]) -> bool {
        let cells = knots[0].n_segments() * knots[1].n_segments();
        contacts >= MANY || contacts >= SOME.max(DENSE * cells)
    }

    /// Whether fits to these sites use packed cells.
    pub fn uses_packed_cells(&self) -> bool {
        ScatteredSites::worth_packing(self.points.len(), &self.knots)
    }

    /// The basis rows; `None` if there are too many to be kept.
    fn rows(&self) -> Option<&[f64]> {
        let each: usize = self.shape().degree.iter().map(|d| 2 * (d + 1)).sum();
        if self.points.len() * each > KEPT {
            return None;
        }
        let form = || {
            let mut rows = Vec::with_capacity(self.points.len() * each);
            self.form(|site| {
                for row in [site.x, site.dx, site.y, site.dy] {
                    rows.extend_from_slice(row);
                }
            });
            rows
        };
        Some(self.kept.rows.get_or_init(form))
    }

    /// The packed cells, made at the first call; `None` above the largest degree of moments.
    pub fn packed_cells(&self) -> Option<&PackedCells> {
        let pack = || PackedCells::new(&self.knots, &self.points, &self.order, &self.cell_starts);
        self.kept.packed.get_or_init(pack).as_ref()
    }

    /// Visits every site, forming its basis rows.
    fn form(&self, mut f: impl FnMut(&Site)) {
        let across = self.knots[1].n_segments();
        let width = self.shape().degree.map(|d| d + 1);
        let (mut x, mut y) = ([0.0; 2 * (MAX_DEGREE + 1)], [0.0; 2 * (MAX_DEGREE + 1)]);
        for cell in 0..self.cell_starts.len() - 1 {
            let range = self.cell_starts[cell] as usize..self.cell_starts[cell + 1] as usize;
            let segment = [cell / across, cell % across];
            let first = [self.knots[0].first_basis(segment[0]), self.knots[1].first_basis(segment[1])];
            for &index in &self.order[range] {
                let index = index as usize;
                let point = self.points[index];
                self.knots[0].derivatives_on(segment[0], point[0], 1, &mut x[..2 * width[0]]);
                self.knots[1].derivatives_on(segment[1], point[1], 1, &mut y[..2 * width[1]]);
                f(&Site {
                    index,
                    first,
                    x: &x[..width[0]],
                    dx: &x[width[0]..2 * width[0]],
                    y: &y[..width[1]],
                    dy: &y[width[1]..2 * width[1]],
                });
            }
        }
    }

    /// The knots in x and y.
    pub fn knots(&self) -> &[Knots; 2] {
        &self.knots
    }

    /// The points, in the user's order.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }
}

impl Sites for ScatteredSites {
    fn shape(&self) -> TensorShape {
        TensorShape {
            basis: [self.knots[0].n_basis(), self.knots[1].n_basis()],
            degree: [self.knots[0].degree(), self.knots[1].degree()],
        }
    }

    fn len(&self) -> usize {
        self.points.len()
    }

    fn visit(&self, mut f: impl FnMut(&Site)) {
        let Some(rows) = self.rows() else { return self.form(f) };
        let across = self.knots[1].n_segments();
        let width = self.shape().degree.map(|d| d + 1);
        let mut rows = rows.chunks_exact(2 * (width[0] + width[1]));
        for cell in 0..self.cell_starts.len() - 1 {
            let range = self.cell_starts[cell] as usize..self.cell_starts[cell + 1] as usize;
            let first = [self.knots[0].first_basis(cell / across), self.knots[1].first_basis(cell % across)];
            for (&index, row) in self.order[range].iter().zip(&mut rows) {
                let (along_x, along_y) = row.split_at(2 * width[0]);
                let ((x, dx), (y, dy)) = (along_x.split_at(width[0]), along_y.split_at(width[1]));
                f(&Site { index: index as usize, first, x, dx, y, dy });
            }
        }
    }

    fn visit_cells(&self, mut f: impl FnMut([usize; 2], &[u32], &[f64])) -> bool {
        let Some(rows) = self.rows() else { return false };
        let across = self.knots[1].n_segments();
        let each: usize = self.shape().degree.iter().map(|d| 2 * (d + 1)).sum();
        for (cell, ends) in self.cell_starts.windows(2).enumerate().filter(|(_, ends)| ends[0] < ends[1]) {
            let [from, to] = [ends[0] as usize, ends[1] as usize];
            let first = [self.knots[0].first_basis(cell / across), self.knots[1].first_basis(cell % across)];
            f(first, &self.order[from..to], &rows[from * each..to * each]);
        }
        true
    }
}
