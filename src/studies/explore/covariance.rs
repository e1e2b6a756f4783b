//! The covariance of a fit's coefficients, and what three rows more make of it.
//!
//! ```text
//! P = (E'E)^-1                         after rows A (3 x unknowns):   P - P A' M^-1 A P,   M = I + A P A'
//! u^2(g'c) = g' P g                    falls by                       (A P g)' M^-1 (A P g)
//! ```
//!
//! This is the update of Kalman and of Sherman, Morrison and Woodbury; it is what a refit with the same linearisation
//! would find. `P` is kept once more cut into the knot cells' blocks, so that scoring a candidate reads memory in a row.

use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg::dot;

use super::rows::CandidateRows;

/// A quantity of which the uncertainty is followed: `P g` and `g' P g`.
#[derive(Clone, Debug, Default)]
pub(super) struct Followed {
    /// `P g`.
    solved: Vec<f64>,
    /// `g' P g`.
    pub square: f64,
}

/// `P` with what follows from it.
#[derive(Clone, Debug, Default)]
pub(super) struct Covariance {
    unknowns: usize,
    matrix: Vec<f64>,
    /// S and R.
    pub followed: [Followed; 2],
    /// Numbers of the coefficients of every knot cell, cell after cell.
    members: Vec<u32>,
    /// `P` over the members of every cell, and `P g` of S and of R over them.
    blocks: Vec<f64>,
    solved_blocks: [Vec<f64>; 2],
    /// `P A'` of the touch taken last.
    gain: Vec<f64>,
}

/// What a touch does: M by its Cholesky factor, and `A P g` of S and of R.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touched {
    factor: [f64; 6],
    along: [[f64; 3]; 2],
}

impl Touched {
    /// By how much the variances of S and of R fall.
    #[inline]
    pub(super) fn falls(&self) -> [f64; 2] {
        self.along.map(|b| {
            let t = substitute(&self.factor, b);
            t[0] * t[0] + t[1] * t[1] + t[2] * t[2]
        })
    }
}

impl Covariance {
    /// From `P` (row by row) and the gradients of S and of R.
    pub(super) fn new(knots: &[Knots; 2], matrix: Vec<f64>, gradients: [&[f64]; 2]) -> Covariance {
        let unknowns = knots[0].n_basis() * knots[1].n_basis();
        let followed = gradients.map(|g| {
            let solved: Vec<f64> = matrix.chunks_exact(unknowns).map(|row| dot(row, g)).collect();
            let square = dot(&solved, g);
            Followed { solved, square }
        });
        let mut members = Vec::new();
        for i in 0..knots[0].n_segments() {
            for j in 0..knots[1].n_segments() {
                for a in 0..=knots[0].degree() {
                    let row = (knots[0].first_basis(i) + a) * knots[1].n_basis() + knots[1].first_basis(j);
                    members.extend((row..=row + knots[1].degree()).map(|u| u as u32));
                }
            }
        }
        let local = (knots[0].degree() + 1) * (knots[1].degree() + 1);
        let mut made = Covariance {
            unknowns,
            matrix,
            followed,
            blocks: vec![0.0; members.len() * local],
            solved_blocks: [vec![0.0; members.len()], vec![0.0; members.len()]],
            gain: vec![0.0; 3 * unknowns],
            members,
        };
        made.cut(local);
        made
    }

    /// Takes over what another one holds; both belong to the same knots.
    pub(super) fn copy_from(&mut self, other: &Covariance) {
        self.unknowns = other.unknowns;
        self.matrix.clone_from(&other.matrix);
        for (own, other) in self.followed.iter_mut().zip(&other.followed) {
            own.solved.clone_from(&other.solved);
            own.square = other.square;
        }
        self.members.clone_from(&other.members);
        self.blocks.clone_from(&other.blocks);
        self.solved_blocks.iter_mut().zip(&other.solved_blocks).for_each(|(own, other)| own.clone_from(other));
        self.gain.clone_from(&other.gain);
    }

    /// Cuts `P` and `P g` into the cells' blocks.
    fn cut(&mut self, local: usize) {
        for (cell, members) in self.members.chunks_exact(local).enumerate() {
            let block = &mut self.blocks[cell * local * local..(cell + 1) * local * local];
            for (row, &u) in block.chunks_exact_mut(local).zip(members) {
                let from = &self.matrix[u as usize * self.unknowns..(u as usize + 1) * self.unknowns];
                row.iter_mut().zip(members).for_each(|(entry, &v)| *entry = from[v as usize]);
            }
            for (blocks, followed) in self.solved_blocks.iter_mut().zip(&self.followed) {
                let out = &mut blocks[cell * local..(cell + 1) * local];
                out.iter_mut().zip(members).for_each(|(entry, &u)| *entry = followed.solved[u as usize]);
            }
        }
    }

    /// By how much candidate `k` lets the variances of S and of R fall.
    #[inline]
    pub(super) fn falls(&self, rows: &CandidateRows, k: usize) -> [f64; 2] {
        self.touched(rows, k).falls()
    }

    /// At least as much: `|A P g|^2` of S and of R, since M is at least the unit matrix.
    #[inline]
    pub(super) fn falls_at_most(&self, rows: &CandidateRows, k: usize) -> [f64; 2] {
        let (local, cell) = (rows.local(), rows.cell(k));
        let three = rows.of(k);
        [0, 1].map(|q| {
            let solved = &self.solved_blocks[q][cell * local..(cell + 1) * local];
            match local {
                9 => squares_by::<9>(three, solved),
                16 => squares_by::<16>(three, solved),
                _ => three.chunks_exact(local).map(|row| dot(row, solved).powi(2)).sum(),
            }
        })
    }

    /// Variance of the height at candidate `k`, in units of a height's noise variance.
    pub(super) fn height_variance(&self, rows: &CandidateRows, k: usize) -> f64 {
        let (local, cell) = (rows.local(), rows.cell(k));
        let block = &self.blocks[cell * local * local..(cell + 1) * local * local];
        let height = &rows.of(k)[..local];
        block.chunks_exact(local).zip(height).map(|(row, a)| a * dot(row, height)).sum()
    }

    #[inline]
    fn touched(&self, rows: &CandidateRows, k: usize) -> Touched {
        let (local, cell) = (rows.local(), rows.cell(k));
        let block = &self.blocks[cell * local * local..(cell + 1) * local * local];
        let solved = [0, 1].map(|q| &self.solved_blocks[q][cell * local..(cell + 1) * local]);
        // lengths known to the compiler for the usual degrees
        match local {
            9 => touched_by::<9>(block, solved, rows.of(k)),
            16 => touched_by::<16>(block, solved, rows.of(k)),
            _ => touched_any(block, solved, rows.of(k), local),
        }
    }

    /// Takes candidate `k` as touched.
    pub(super) fn take(&mut self, rows: &CandidateRows, k: usize) {
        let (local, cell) = (rows.local(), rows.cell(k));
        let members = &self.members[cell * local..(cell + 1) * local];
        let touched = self.touched(rows, k);
        let three = rows.of(k);
        // K = P A' F'^-1, so that P falls by K K' and P g by K (F^-1 A P g)
        for (row, gain) in self.matrix.chunks_exact(self.unknowns).zip(self.gain.chunks_exact_mut(3)) {
            let mut along = [0.0; 3];
            for (e, along) in along.iter_mut().enumerate() {
                let own = &three[e * local..(e + 1) * local];
                *along = members.iter().zip(own).map(|(&u, a)| row[u as usize] * a).sum();
            }
            gain.copy_from_slice(&substitute(&touched.factor, along));
        }
        for (row, own) in self.matrix.chunks_exact_mut(self.unknowns).zip(self.gain.chunks_exact(3)) {
            for (entry, other) in row.iter_mut().zip(self.gain.chunks_exact(3)) {
                *entry -= own[0] * other[0] + own[1] * other[1] + own[2] * other[2];
            }
        }
        for (followed, along) in self.followed.iter_mut().zip(touched.along) {
            let t = substitute(&touched.factor, along);
            followed.square = (followed.square - t[0] * t[0] - t[1] * t[1] - t[2] * t[2]).max(0.0);
            for (entry, gain) in followed.solved.iter_mut().zip(self.gain.chunks_exact(3)) {
                *entry -= gain[0] * t[0] + gain[1] * t[1] + gain[2] * t[2];
            }
        }
        self.cut(local);
    }
}

/// Sum of the squares of every row's product with `solved`, the length known to the compiler.
#[inline]
fn squares_by<const LOCAL: usize>(rows: &[f64], solved: &[f64]) -> f64 {
    let ((rows, _), (solved, _)) = (rows.as_chunks::<LOCAL>(), solved.as_chunks::<LOCAL>());
    rows.iter().zip(solved.iter().cycle()).map(|(row, solved)| dot(row, solved).powi(2)).sum()
}

#[inline]
fn touched_by<const LOCAL: usize>(block: &[f64], solved: [&[f64]; 2], rows: &[f64]) -> Touched {
    let (block, _) = block.as_chunks::<LOCAL>();
    let ([height, first, second], _) = rows.as_chunks::<LOCAL>() else { return touched_any(&[], solved, rows, 0) };
    let own: [&[f64; LOCAL]; 3] = [height, first, second];
    let mut products = [[0.0; LOCAL]; 3];
    for (l, row) in block.iter().enumerate().take(LOCAL) {
        for (product, own) in products.iter_mut().zip(own) {
            let weight = own[l];
            for k in 0..LOCAL {
                product[k] += weight * row[k];
            }
        }
    }
    finished(own.map(|own| &own[..]), [&products[0], &products[1], &products[2]], solved)
}

fn touched_any(block: &[f64], solved: [&[f64]; 2], rows: &[f64], local: usize) -> Touched {
    const MOST_COEFFICIENTS: usize =
        (palpate_numeric::bspline::MAX_DEGREE + 1) * (palpate_numeric::bspline::MAX_DEGREE + 1);
    let mut products = [[0.0; MOST_COEFFICIENTS]; 3];
    let own: [&[f64]; 3] = [&rows[..local], &rows[local..2 * local], &rows[2 * local..3 * local]];
    for (l, row) in block.chunks_exact(local).enumerate() {
        for (product, own) in products.iter_mut().zip(own) {
            for (entry, p) in product.iter_mut().zip(row) {
                *entry += own[l] * p;
            }
        }
    }
    finished(own, [&products[0][..local], &products[1][..local], &products[2][..local]], solved)
}

/// A touch of rows A, from `A P` and `P g`.
#[inline]
pub(super) fn finished(own: [&[f64]; 3], products: [&[f64]; 3], solved: [&[f64]; 2]) -> Touched {
    let m = |a: usize, b: usize| dot(own[a], products[b]);
    let factor = factored([1.0 + m(0, 0), m(1, 0), 1.0 + m(1, 1), m(2, 0), m(2, 1), 1.0 + m(2, 2)]);
    Touched { factor, along: solved.map(|solved| own.map(|own| dot(own, solved))) }
}

/// Cholesky factor of a symmetric 3 x 3 matrix, lower triangle row by row; the matrix is at least the unit matrix.
fn factored([a, b, c, d, e, f]: [f64; 6]) -> [f64; 6] {
    let l0 = a.sqrt();
    let (l1, l3) = (b / l0, d / l0);
    let l2 = (c - l1 * l1).sqrt();
    let l4 = (e - l3 * l1) / l2;
    [l0, l1, l2, l3, l4, (f - l3 * l3 - l4 * l4).sqrt()]
}

/// `F^-1 b`.
fn substitute(factor: &[f64; 6], b: [f64; 3]) -> [f64; 3] {
    let first = b[0] / factor[0];
    let second = (b[1] - factor[1] * first) / factor[2];
    [first, second, (b[2] - factor[3] * first - factor[4] * second) / factor[5]]
}
