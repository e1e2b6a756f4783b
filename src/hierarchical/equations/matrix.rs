//! The normal equations over the basis: cells' parts multiplied by their rows of the basis and added into one sparse matrix.
//!
//! ```text
//! A = sum_Q E_Q' A_Q E_Q      g = sum_Q E_Q' g_Q      upper triangle in compressed columns
//! ```

use nalgebra_sparse::CscMatrix;
use nalgebra_sparse::pattern::SparsityPattern;

use super::local::{BlockWeights, LocalEquations};
use super::polynomials::{SegmentTable, SegmentTables};
use super::sums::CellSums;
use crate::space::{HierarchicalSpace, LocalFunction};
use palpate_fitting::observation::RoughnessOrder;
use palpate_numeric::threads;

/// Leaves whose parts are made on all threads before they are added, one after another.
const PIECE: usize = 2048;

/// Leaves that a thread takes at a time at least: their segments' tables are made once.
const LEAVES_OF_THREAD: usize = 128;

/// Which functions meet on some cell: the upper triangle of every matrix over a space.
#[derive(Clone, Debug, PartialEq)]
pub struct MeetingPattern {
    starts: Vec<usize>,
    rows: Vec<usize>,
}

/// The roughness over the cells of one level: the entries that are not zero, by their places in a pattern.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LevelRoughness {
    places: Vec<u32>,
    /// Row and column of every place.
    pairs: Vec<[u32; 2]>,
    values: Vec<f64>,
}

impl LevelRoughness {
    fn of(pattern: &MeetingPattern, values: &[f64]) -> LevelRoughness {
        let mut made = LevelRoughness::default();
        for column in 0..pattern.order() {
            for place in pattern.starts[column]..pattern.starts[column + 1] {
                if values[place] != 0.0 {
                    made.places.push(place as u32);
                    made.pairs.push([pattern.rows[place] as u32, column as u32]);
                    made.values.push(values[place]);
                }
            }
        }
        made
    }

    /// `a' P b`.
    pub fn form(&self, a: &[f64], b: &[f64]) -> f64 {
        let mut sum = 0.0;
        for ([i, k], value) in self.pairs.iter().zip(&self.values) {
            let (i, k) = (*i as usize, *k as usize);
            sum += value * if i == k { a[i] * b[i] } else { a[i] * b[k] + a[k] * b[i] };
        }
        sum
    }

    /// The diagonal, `(function, entry)`.
    pub fn diagonal(&self) -> impl Iterator<Item = (usize, f64)> {
        let own = self.pairs.iter().zip(&self.values).filter(|([i, k], _)| i == k);
        own.map(|([i, _], value)| (*i as usize, *value))
    }

    /// Adds a multiple to the values of a matrix.
    pub fn add_to(&self, factor: f64, matrix: &mut [f64]) {
        self.places.iter().zip(&self.values).for_each(|(place, v)| matrix[*place as usize] += factor * v);
    }
}

/// What one leaf adds: the functions on it and their matrix, row by row.
struct LeafPart {
    functions: Vec<u32>,
    matrix: Vec<f64>,
    load: Vec<f64>,
}

impl MeetingPattern {
    /// The pattern of a space.
    pub fn of(space: &HierarchicalSpace) -> MeetingPattern {
        let unknowns = space.unknowns();
        let leaves = space.leaves().len();
        let on_leaf = threads::map(leaves, PIECE, |leaf| {
            let mut functions = Vec::new();
            space.functions_on(leaf, &mut functions);
            functions
        });
        let (starts, leaves_of) = leaves_of_functions(unknowns, &on_leaf);
        let columns = threads::map_with(
            unknowns,
            PIECE,
            || vec![u32::MAX; unknowns],
            |seen, column| {
                let mut rows = Vec::new();
                for leaf in &leaves_of[starts[column]..starts[column + 1]] {
                    for row in on_leaf[*leaf as usize].iter().take_while(|row| **row as usize <= column) {
                        if seen[*row as usize] != column as u32 {
                            seen[*row as usize] = column as u32;
                            rows.push(*row);
                        }
                    }
                }
                rows.sort_unstable();
                rows
            },
        );
        let mut pattern = MeetingPattern { starts: vec![0], rows: Vec::new() };
        for column in columns {
            pattern.rows.extend(column.into_iter().map(|row| row as usize));
            pattern.starts.push(pattern.rows.len());
        }
        pattern
    }

    /// Start of every column in [`MeetingPattern::rows`], and the end.
    pub fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// Rows of every column in ascending order; the last is the diagonal.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Number of unknowns.
    pub fn order(&self) -> usize {
        self.starts.len() - 1
    }

    /// A matrix of this pattern for other programs.
    ///
    /// # Panics
    /// When the values are not as many as the pattern's rows.
    pub fn to_csc(&self, values: &[f64]) -> CscMatrix<f64> {
        let order = self.order();
        let pattern =
            SparsityPattern::try_from_offsets_and_indices(order, order, self.starts.clone(), self.rows.clone())
                .expect("columns are sorted and inside");
        CscMatrix::try_from_pattern_and_values(pattern, values.to_vec()).expect("one value for each entry")
    }

    /// `out = A v` of a symmetric matrix whose upper triangle has these values.
    pub fn multiply(&self, values: &[f64], v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for column in 0..self.order() {
            let range = self.starts[column]..self.starts[column + 1];
            let mut sum = 0.0;
            for (row, value) in self.rows[range.clone()].iter().zip(&values[range]) {
                sum += value * v[*row];
                if *row != column {
                    out[*row] += value * v[column];
                }
            }
            out[column] += sum;
        }
    }

    /// The matrix and right-hand side of all contacts.
    pub fn assemble(&self, space: &HierarchicalSpace, sums: &CellSums, weights: BlockWeights) -> (Vec<f64>, Vec<f64>) {
        let slopes = if sums.layout().oriented { weights.slopes } else { 0.0 };
        let weights = BlockWeights { slopes, ..weights };
        let leaves: Vec<usize> = (0..space.leaves().len()).collect();
        self.add_leaves(space, &leaves, |leaf, axes, local| local.add_contacts(axes, &sums.cell(leaf), weights))
    }

    /// The matrices of the roughness of this order over the cells of every level.
    pub fn roughness(&self, space: &HierarchicalSpace, order: RoughnessOrder) -> Vec<LevelRoughness> {
        let half = |leaf: usize| space.mesh().centre_and_half(space.leaves()[leaf])[1];
        let mut by_level = vec![Vec::new(); space.mesh().tree().deepest() + 1];
        space.leaves().iter().enumerate().for_each(|(leaf, cell)| by_level[usize::from(cell.level)].push(leaf));
        let of_level = |leaves: &Vec<usize>| {
            let (values, _) =
                self.add_leaves(space, leaves, |leaf, axes, local| local.add_roughness(axes, half(leaf), order));
            LevelRoughness::of(self, &values)
        };
        by_level.iter().map(of_level).collect()
    }

    fn add_leaves(
        &self,
        space: &HierarchicalSpace,
        leaves: &[usize],
        part: impl Fn(usize, [&SegmentTable; 2], &mut LocalEquations) + Sync,
    ) -> (Vec<f64>, Vec<f64>) {
        let (mut values, mut load) = (vec![0.0; self.rows.len()], vec![0.0; self.order()]);
        let widths = space.mesh().levels().degree().map(|p| p + 1);
        for piece in leaves.chunks(PIECE) {
            let start = || (LocalEquations::zeros(widths), SegmentTables::default());
            let parts = threads::map_with(piece.len(), LEAVES_OF_THREAD, start, |(local, tables), k| {
                let leaf = piece[k];
                let [x, y] = tables.of(space.leaves()[leaf], space.knots_of(leaf));
                local.clear();
                part(leaf, [&x, &y], local);
                in_basis(space, leaf, local)
            });
            parts.iter().for_each(|part| self.add_part(part, &mut values, &mut load));
        }
        (values, load)
    }

    fn add_part(&self, part: &LeafPart, values: &mut [f64], load: &mut [f64]) {
        let count = part.functions.len();
        for (c, column) in part.functions.iter().map(|k| *k as usize).enumerate() {
            load[column] += part.load[c];
            let mut at = self.starts[column];
            for (r, row) in part.functions[..=c].iter().map(|k| *k as usize).enumerate() {
                while self.rows[at] < row {
                    at += 1;
                }
                values[at] += part.matrix[r * count + c];
            }
        }
    }
}

/// The leaves of every function: starts, and the leaves in ascending order.
fn leaves_of_functions(unknowns: usize, on_leaf: &[Vec<u32>]) -> (Vec<usize>, Vec<u32>) {
    let mut starts = vec![0usize; unknowns + 1];
    on_leaf.iter().flatten().for_each(|k| starts[*k as usize + 1] += 1);
    (0..unknowns).for_each(|k| starts[k + 1] += starts[k]);
    let mut next = starts.clone();
    let mut leaves_of = vec![0u32; starts[unknowns]];
    for (leaf, functions) in on_leaf.iter().enumerate() {
        for k in functions {
            leaves_of[next[*k as usize]] = leaf as u32;
            next[*k as usize] += 1;
        }
    }
    (starts, leaves_of)
}

/// `E' A E` and `E' g` over the functions of the basis that do not vanish on the leaf.
fn in_basis(space: &HierarchicalSpace, leaf: usize, local: &LocalEquations) -> LeafPart {
    let mut functions = Vec::new();
    space.functions_on(leaf, &mut functions);
    let (count, width) = (functions.len(), local.load.len());
    if space.local_functions(leaf).all(|function| matches!(function, LocalFunction::Active(_))) {
        // all functions of one level, which are numbered in the order of the cell
        return LeafPart { functions, matrix: local.matrix.clone(), load: local.load.clone() };
    }
    let position = |number: u32| functions.binary_search(&number).unwrap_or(0);
    let rows: Vec<Vec<(usize, f64)>> = space
        .local_functions(leaf)
        .map(|function| match function {
            LocalFunction::Active(number) => vec![(position(number), 1.0)],
            LocalFunction::Truncated(shares) => shares.iter().map(|(n, share)| (position(*n), *share)).collect(),
        })
        .collect();
    let mut half = vec![0.0; count * width];
    let mut load = vec![0.0; count];
    for (k, row) in rows.iter().enumerate() {
        for (to, share) in row {
            load[*to] += share * local.load[k];
            let target = &mut half[to * width..(to + 1) * width];
            target.iter_mut().zip(&local.matrix[k * width..]).for_each(|(sum, v)| *sum += share * v);
        }
    }
    let mut matrix = vec![0.0; count * count];
    for (line, target) in half.chunks_exact(width).zip(matrix.chunks_exact_mut(count)) {
        for (value, row) in line.iter().zip(&rows) {
            row.iter().for_each(|(to, share)| target[*to] += share * value);
        }
    }
    LeafPart { functions, matrix, load }
}
