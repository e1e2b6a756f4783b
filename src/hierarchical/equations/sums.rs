//! Sums over the contacts of every cell, from which its part of the normal equations follows.
//!
//! ```text
//! G_t[i][k] = sum_r w_t,r u_r^i v_r^k,  i <= 2p, k <= 2q       F_t[i][k] = sum_r f_t,r u_r^i v_r^k,  i <= p, k <= q
//! t of G:  z   wz^2         xx  a^2        xy  a b        yy  b^2 + d^2          (U = [a b; 0 d]: the weights of the slope rows)
//! t of F:  z   wz^2 r       x   a rho_1    y   b rho_1 + d rho_2
//! ```
//!
//! Their size depends on the cells alone and not on the contacts, which may come in any number of pieces. Where all of a
//! contact's rows have one weight, the four sums G are one.

use super::polynomials::CellPolynomial;
use super::residuals::{ContactResiduals, slope_residual};
use super::sorted_contacts::SortedContacts;
use super::surface_cells::SurfaceCells;
use palpate_geometry::contact::{Contacts, Orientation};
use palpate_numeric::simd::{CellMoments, Isa, MAX_MOMENT_DEGREE, MomentPowers, moments};
use palpate_numeric::threads;

/// Contacts whose columns are in the caches at once.
const BATCH: usize = 256;
/// Leaves that one thread takes at a time.
const PIECE: usize = 16;
/// Squares and counts of both kinds of rows.
const SCALARS: usize = 4;

/// Where everything stands among the numbers of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SumLayout {
    pub(crate) degree: [usize; 2],
    /// 1 where all rows of a contact have one weight, else 4.
    pub(crate) sets: usize,
    pub(crate) oriented: bool,
}

impl SumLayout {
    /// For contacts with the columns of these.
    pub fn of(degree: [usize; 2], columns: &Contacts) -> SumLayout {
        let weights = &columns.weights;
        let oriented = columns.orientation != Orientation::None;
        let normals = matches!(columns.orientation, Orientation::Normals { .. });
        let several = weights.x.is_some() || weights.y.is_some() || (weights.z.is_some() && oriented);
        SumLayout { degree, sets: if oriented && (normals || several) { 4 } else { 1 }, oriented }
    }

    fn set_len(&self) -> usize {
        (2 * self.degree[0] + 1) * (2 * self.degree[1] + 1)
    }

    fn load_len(&self) -> usize {
        (self.degree[0] + 1) * (self.degree[1] + 1)
    }

    fn stride(&self) -> usize {
        self.sets * self.set_len() + 3 * self.load_len() + SCALARS
    }
}

/// The numbers of one cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellSum<'a> {
    layout: SumLayout,
    values: &'a [f64],
}

impl<'a> CellSum<'a> {
    /// G of a kind: z, xx, xy, yy. With one set xy is none, and the others are the same.
    pub(crate) fn moments(&self, kind: usize) -> Option<&'a [f64]> {
        let len = self.layout.set_len();
        match (self.layout.sets, kind) {
            (1, 2) => None,
            (1, _) => Some(&self.values[..len]),
            _ => Some(&self.values[kind * len..(kind + 1) * len]),
        }
    }

    /// F of a kind: z, x, y.
    pub(crate) fn loads(&self, kind: usize) -> &'a [f64] {
        let len = self.layout.load_len();
        let from = self.layout.sets * self.layout.set_len() + kind * len;
        &self.values[from..from + len]
    }
}

/// The sums of all leaves of a space.
#[derive(Clone, Debug)]
pub struct CellSums {
    layout: SumLayout,
    values: Vec<f64>,
}

impl CellSums {
    /// No contacts yet.
    pub fn empty(cells: usize, layout: SumLayout) -> CellSums {
        CellSums { layout, values: vec![0.0; cells * layout.stride()] }
    }

    /// Sums that were taken apart by [`CellSums::into_values`], those of one run of cells behind those of another.
    pub fn of_values(layout: SumLayout, values: Vec<f64>) -> CellSums {
        CellSums { layout, values }
    }

    /// All numbers, cell by cell.
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }

    /// Cells that they are of.
    pub fn cells(&self) -> usize {
        self.values.len() / self.layout.stride()
    }

    /// Adds the contacts of these cells by what they say beyond the surface; `shares` multiplies the squared weights of each (`None`: all
    /// 1).
    ///
    /// # Panics
    /// When residuals or shares are not as many as the contacts, or the sums were made for other cells.
    pub fn add(
        &mut self,
        contacts: &SortedContacts,
        surface: SurfaceCells<'_>,
        residuals: &ContactResiduals,
        shares: Option<&[f64]>,
    ) {
        let stride = self.layout.stride();
        let layout = self.layout;
        assert_eq!(self.cells(), surface.cells.len(), "the sums are of other cells");
        let mut pieces: Vec<&mut [f64]> = self.values.chunks_mut(PIECE * stride).collect();
        threads::each(&mut pieces, |piece, cells| {
            let mut batch = Batch::new(layout);
            for (k, cell) in cells.chunks_exact_mut(stride).enumerate() {
                let number = piece * PIECE + k;
                let range = contacts.of_cell(surface.mesh, surface.cells[number]);
                if range.is_empty() {
                    continue;
                }
                let polynomial = surface.polynomial(number);
                for from in range.clone().step_by(BATCH) {
                    let to = range.end.min(from + BATCH);
                    batch.fill(contacts, &polynomial, residuals, shares, from..to);
                    batch.add_to(cell);
                }
            }
        });
    }

    /// Numbers of one leaf.
    pub(crate) fn cell(&self, leaf: usize) -> CellSum<'_> {
        let stride = self.layout.stride();
        CellSum { layout: self.layout, values: &self.values[leaf * stride..(leaf + 1) * stride] }
    }

    /// Weighted squares and counts of heights and of slopes over all leaves, in the order of the leaves.
    pub fn totals(&self) -> [f64; SCALARS] {
        let mut totals = [0.0; SCALARS];
        for cell in self.values.chunks_exact(self.layout.stride()) {
            totals.iter_mut().zip(&cell[cell.len() - SCALARS..]).for_each(|(sum, v)| *sum += v);
        }
        totals
    }

    pub(crate) fn layout(&self) -> SumLayout {
        self.layout
    }
}

/// Columns of up to [`BATCH`] contacts of one cell.
struct Batch {
    layout: SumLayout,
    count: usize,
    local: [[f64; BATCH]; 2],
    weights: [[f64; BATCH]; 4],
    loads: [[f64; BATCH]; 3],
    scalars: [f64; SCALARS],
    powers: Box<MomentPowers>,
}

impl Batch {
    fn new(layout: SumLayout) -> Box<Batch> {
        Box::new(Batch {
            layout,
            count: 0,
            local: [[0.0; BATCH]; 2],
            weights: [[0.0; BATCH]; 4],
            loads: [[0.0; BATCH]; 3],
            scalars: [0.0; SCALARS],
            powers: Box::default(),
        })
    }

    fn fill(
        &mut self,
        contacts: &SortedContacts,
        polynomial: &CellPolynomial,
        residuals: &ContactResiduals,
        shares: Option<&[f64]>,
        range: std::ops::Range<usize>,
    ) {
        let columns = contacts.contacts();
        self.count = range.len();
        self.scalars = [0.0; SCALARS];
        for (k, r) in range.enumerate() {
            let local = polynomial.local(columns.x[r], columns.y[r]);
            [self.local[0][k], self.local[1][k]] = local;
            let share = shares.map_or(1.0, |s| s[r]);
            let w = columns.weights.z.as_ref().map_or(1.0, |w| w[r]);
            let (square, residual) = (share * w * w, residuals.heights[r]);
            self.weights[0][k] = square;
            self.loads[0][k] = square * residual;
            self.scalars[0] += square * residual * residual;
            self.scalars[1] += if w > 0.0 { share } else { 0.0 };
            if !self.layout.oriented {
                continue;
            }
            let [first, second] = residuals.slopes[r];
            if self.layout.sets == 1 {
                [self.loads[1][k], self.loads[2][k]] = [share * first, share * second];
            } else {
                let [_, p, q] = polynomial.height_and_slopes(local);
                let m = slope_residual(contacts, r, p, q).0;
                let squares = [m.a * m.a, m.a * m.b, m.b * m.b + m.d * m.d];
                (0..3).for_each(|t| self.weights[t + 1][k] = share * squares[t]);
                self.loads[1][k] = share * m.a * first;
                self.loads[2][k] = share * (m.b * first + m.d * second);
            }
            self.scalars[2] += share * (first * first + second * second);
            self.scalars[3] += share;
        }
    }

    fn add_to(&mut self, cell: &mut [f64]) {
        let SumLayout { degree, sets, .. } = self.layout;
        if degree[0].max(degree[1]) <= MAX_MOMENT_DEGREE {
            self.add_by_lanes(cell);
        } else {
            self.add_by_powers(cell);
        }
        let from = sets * self.layout.set_len() + 3 * self.layout.load_len();
        cell[from..].iter_mut().zip(&self.scalars).for_each(|(sum, v)| *sum += v);
    }

    /// Degrees up to 3: the kernel of the tensor splines.
    fn add_by_lanes(&mut self, cell: &mut [f64]) {
        let SumLayout { degree: [p, q], sets, .. } = self.layout;
        let n = self.count;
        let local = self.local.each_ref().map(|column| &column[..n]);
        for t in 0..sets {
            let mut made = CellMoments::ZERO;
            let loads = (t == 0).then(|| self.loads.each_ref().map(|column| &column[..n]));
            let weight = Some(&self.weights[t][..n]);
            // the degree of the kernel is that of both directions, whichever is larger
            moments(Isa::active(), p.max(q), local, weight, loads, &mut self.powers, &mut made);
            let target = &mut cell[t * self.layout.set_len()..(t + 1) * self.layout.set_len()];
            for (row, from) in target.chunks_exact_mut(2 * q + 1).zip(&made.weights) {
                row.iter_mut().zip(from).for_each(|(sum, v)| *sum += v);
            }
            if t > 0 {
                continue;
            }
            let from = sets * self.layout.set_len();
            let kinds = cell[from..from + 3 * self.layout.load_len()].chunks_exact_mut(self.layout.load_len());
            for (kind, made) in kinds.zip(&made.loads) {
                for (row, from) in kind.chunks_exact_mut(q + 1).zip(&made[..=p]) {
                    row.iter_mut().zip(from).for_each(|(sum, v)| *sum += v);
                }
            }
        }
    }

    /// Higher degrees, one contact after another.
    fn add_by_powers(&self, cell: &mut [f64]) {
        let SumLayout { degree: [p, q], sets, oriented } = self.layout;
        let (sets_end, kinds) = (sets * self.layout.set_len(), if oriented { 3 } else { 1 });
        for k in 0..self.count {
            let [u, v] = [self.local[0][k], self.local[1][k]];
            let mut columns = [1.0; super::polynomials::POWERS];
            (1..=2 * q).for_each(|b| columns[b] = columns[b - 1] * v);
            let (moments, loads) = cell.split_at_mut(sets_end);
            for (t, set) in moments.chunks_exact_mut(self.layout.set_len()).enumerate() {
                let mut power = self.weights[t][k];
                for row in set.chunks_exact_mut(2 * q + 1) {
                    row.iter_mut().zip(&columns).for_each(|(sum, column)| *sum += power * column);
                    power *= u;
                }
            }
            for (t, kind) in loads.chunks_exact_mut(self.layout.load_len()).take(kinds).enumerate() {
                let mut power = self.loads[t][k];
                for row in kind.chunks_exact_mut(q + 1).take(p + 1) {
                    row.iter_mut().zip(&columns).for_each(|(sum, column)| *sum += power * column);
                    power *= u;
                }
            }
        }
    }
}
