//! The space of truncated hierarchical B-splines over a mesh: its functions, and how they stand on every cell.
//!
//! ```text
//! on cell Q of level l     S = sum_k (E_Q c)_k N^l_k,   k = the (p + 1)(q + 1) B-splines of level l on Q
//! ```
//!
//! `E_Q` has one entry 1 in a row where that B-spline is in the basis, and a few shares elsewhere. Whatever is
//! linear in S is computed as for a tensor spline and multiplied by `E_Q`.

mod functions;

use std::collections::BTreeMap;

pub use functions::ActiveFunction;
use functions::{LevelFunctions, NOT_ACTIVE, Truncation, lies_inside};

use crate::mesh::{CellId, Mesh};
use palpate_numeric::bspline::Knots;

/// A basis of truncated hierarchical B-splines.
#[derive(Clone, Debug)]
pub struct HierarchicalSpace {
    mesh: Mesh,
    functions: Vec<ActiveFunction>,
    /// Unsplit cells: base cell by base cell, children in the order of the tree.
    leaves: Vec<CellId>,
    /// Position in `leaves` of every cell of the tree; those that were split have none.
    leaf_numbers: Vec<u32>,
    /// Rows of all `E_Q`, (p + 1)(q + 1) for every leaf: a function, or beyond their number a row of `shares`.
    rows: Vec<u32>,
    share_starts: Vec<u32>,
    shares: Vec<(u32, f64)>,
}

/// One row of `E_Q`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LocalFunction<'a> {
    /// The B-spline is in the basis under this number.
    Active(u32),
    /// The B-spline's coefficient is this sum, `(function, share)`.
    Truncated(&'a [(u32, f64)]),
}

impl HierarchicalSpace {
    /// The basis over a mesh. The functions are ordered by level, then as in the level's tensor spline: y runs fastest.
    pub fn new(mesh: Mesh) -> HierarchicalSpace {
        let numbers = mesh.tree().leaves();
        let leaves: Vec<CellId> = numbers.iter().map(|number| mesh.tree().cell(*number)).collect();
        let mut leaf_numbers = vec![NOT_ACTIVE; mesh.tree().len()];
        numbers.iter().enumerate().for_each(|(leaf, number)| leaf_numbers[*number] = leaf as u32);
        let mut by_level = vec![Vec::new(); mesh.tree().deepest() + 1];
        leaves.iter().for_each(|cell| by_level[usize::from(cell.level)].push(*cell));
        let mut levels: Vec<LevelFunctions> =
            by_level.iter().enumerate().map(|(level, cells)| LevelFunctions::on_cells(&mesh, level, cells)).collect();
        let functions = number_functions(&mesh, &mut levels);
        let mut space = HierarchicalSpace {
            mesh,
            functions,
            leaves,
            leaf_numbers,
            rows: Vec::new(),
            share_starts: vec![0],
            shares: Vec::new(),
        };
        space.extract(&levels);
        space
    }

    /// Rows of `E_Q` for every leaf.
    fn extract(&mut self, levels: &[LevelFunctions]) {
        let HierarchicalSpace { mesh, functions, leaves, rows, share_starts, shares, .. } = self;
        let degree = mesh.levels().degree();
        let mut truncation = Truncation { mesh, levels, known: BTreeMap::new() };
        let mut stored: BTreeMap<ActiveFunction, u32> = BTreeMap::new();
        rows.reserve(leaves.len() * degree.map(|p| p + 1).iter().product::<usize>());
        for cell in leaves {
            let level = usize::from(cell.level);
            let axes = mesh.levels().at(level);
            let [i, j] = [0, 1].map(|axis| axes[axis].knots().first_basis(cell.place[axis] as usize) as u32);
            for a in 0..=degree[0] as u32 {
                // a cell's functions of one column stand one behind the other in the list of its level
                let Some(start) = levels[level].position([i + a, j]) else { continue };
                for b in 0..=degree[1] {
                    let number = levels[level].numbers[start + b];
                    if number != NOT_ACTIVE {
                        rows.push(number);
                        continue;
                    }
                    let function = ActiveFunction { level: cell.level, place: [i + a, j + b as u32] };
                    let row = *stored.entry(function).or_insert_with(|| {
                        shares.extend(truncation.shares(function));
                        share_starts.push(shares.len() as u32);
                        (functions.len() + share_starts.len() - 2) as u32
                    });
                    rows.push(row);
                }
            }
        }
    }

    /// The cells and knots.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The functions of the basis.
    pub fn functions(&self) -> &[ActiveFunction] {
        &self.functions
    }

    /// Number of functions.
    pub fn unknowns(&self) -> usize {
        self.functions.len()
    }

    /// The middle of what every function reaches, in base cells.
    pub fn places(&self) -> Vec<[f64; 2]> {
        let place = |function: &ActiveFunction| {
            let level = self.mesh.levels().at(function.level.into());
            let cells = f64::from(1_u32 << function.level);
            [0, 1].map(|axis| {
                let [from, to] = level[axis].reach(function.place[axis] as usize);
                (f64::from(from) + f64::from(to) + 1.0) / (2.0 * cells)
            })
        };
        self.functions.iter().map(place).collect()
    }

    /// The unsplit cells.
    pub fn leaves(&self) -> &[CellId] {
        &self.leaves
    }

    /// Functions of a level on a cell: (p + 1)(q + 1).
    pub fn local_count(&self) -> usize {
        self.mesh.levels().degree().iter().map(|p| p + 1).product()
    }

    /// Number of the leaf that holds a place.
    #[inline]
    pub fn leaf_at(&self, at: [f64; 2]) -> usize {
        self.leaf_numbers[self.mesh.locate(at)] as usize
    }

    /// Number of the leaf that is this cell; `None` where it was split or does not exist.
    pub fn leaf_of(&self, cell: CellId) -> Option<usize> {
        let number = self.leaf_numbers[self.mesh.tree().find(cell)?];
        (number != NOT_ACTIVE).then_some(number as usize)
    }

    /// Knots in x and y of the level of a leaf.
    pub fn knots_of(&self, leaf: usize) -> [&Knots; 2] {
        self.mesh.levels().at(self.leaves[leaf].level.into()).map(|level| level.knots())
    }

    /// The rows of `E_Q` of a leaf: y runs fastest.
    pub fn local_functions(&self, leaf: usize) -> impl ExactSizeIterator<Item = LocalFunction<'_>> {
        let count = self.local_count();
        self.rows[leaf * count..(leaf + 1) * count].iter().map(|row| self.local_function(*row))
    }

    fn local_function(&self, row: u32) -> LocalFunction<'_> {
        match (row as usize).checked_sub(self.functions.len()) {
            None => LocalFunction::Active(row),
            Some(at) => {
                let [from, to] = [self.share_starts[at] as usize, self.share_starts[at + 1] as usize];
                LocalFunction::Truncated(&self.shares[from..to])
            }
        }
    }

    /// Writes `E_Q c` of a leaf.
    pub fn local_coefficients(&self, leaf: usize, coefficients: &[f64], out: &mut [f64]) {
        for (target, function) in out.iter_mut().zip(self.local_functions(leaf)) {
            *target = match function {
                LocalFunction::Active(number) => coefficients[number as usize],
                LocalFunction::Truncated(shares) => {
                    shares.iter().map(|(number, share)| share * coefficients[*number as usize]).sum()
                }
            };
        }
    }

    /// The functions of the basis that do not vanish on a leaf, in ascending order.
    pub fn functions_on(&self, leaf: usize, out: &mut Vec<u32>) {
        out.clear();
        for function in self.local_functions(leaf) {
            match function {
                LocalFunction::Active(number) => out.push(number),
                LocalFunction::Truncated(shares) => out.extend(shares.iter().map(|(number, _)| *number)),
            }
        }
        out.sort_unstable();
        out.dedup();
    }
}

/// Gives the active functions of all levels their numbers.
fn number_functions(mesh: &Mesh, levels: &mut [LevelFunctions]) -> Vec<ActiveFunction> {
    let mut functions = Vec::new();
    for (level, list) in levels.iter_mut().enumerate() {
        for at in 0..list.places().len() {
            let place = list.places()[at];
            if lies_inside(mesh, level, place) {
                list.numbers[at] = functions.len() as u32;
                functions.push(ActiveFunction { level: level as u8, place });
            }
        }
    }
    functions
}
