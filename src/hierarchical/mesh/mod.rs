//! Which cells there are, and which knots: a dyadic hierarchy over a rectangle of knots, refined so that neighbours stay alike.
//!
//! ```text
//! before cell (l, i, j) is split, every cell of level l exists that a function of level l on it reaches
//! ```
//!
//! The rule makes the hierarchy admissible of class 2: functions of at most two levels do not vanish on any one cell, so that a
//! cell meets at most 2 (p + 1)(q + 1) of them (A. Buffa, C. Giannelli, *Math. Models Methods Appl. Sci.* 26 (2016) 1).

mod levels;
mod quadtree;
mod rectangles;

pub(crate) use levels::blossom_row;
pub use levels::{InsertionRow, KnotLevels, LevelKnots};
pub use quadtree::{CellId, MAX_LEVEL, Quadtree};
pub use rectangles::CellRectangle;

use crate::error::HierarchyError;
use palpate_numeric::bspline::Knots;

/// Cells and knots of a hierarchy.
///
/// ```
/// use palpate_hierarchical::mesh::{CellId, Mesh};
/// use palpate_numeric::bspline::Knots;
///
/// let base = || Knots::uniform(3, 8, 0.0, 1.0);
/// let mut mesh = Mesh::new([base()?, base()?])?;
/// mesh.refine(CellId { level: 0, place: [3, 4] })?;
/// // a cell of level 1 in a corner of the refined one asks for its neighbours' refinement first
/// mesh.refine(CellId { level: 1, place: [6, 8] })?;
/// assert!(mesh.tree().find(CellId { level: 2, place: [12, 16] }).is_some());
/// assert!(mesh.tree().find(CellId { level: 1, place: [3, 5] }).is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    levels: KnotLevels,
    tree: Quadtree,
}

impl Mesh {
    /// The base grid of two open knot vectors, nothing refined.
    ///
    /// # Errors
    /// Degrees outside 2 to 5, closed knots, more than 1,024 segments in a direction.
    pub fn new(base: [Knots; 2]) -> Result<Mesh, HierarchyError> {
        let tree = Quadtree::new(base.each_ref().map(Knots::n_segments));
        Ok(Mesh { levels: KnotLevels::new(base)?, tree })
    }

    /// The hierarchy in which these cells are split, and with them whatever admissibility asks for.
    ///
    /// # Errors
    /// Those of [`Mesh::new`] and of [`Mesh::refine`], and [`HierarchyError::Place`] for a cell that lies in no base cell.
    pub fn of_splits(base: [Knots; 2], splits: impl IntoIterator<Item = CellId>) -> Result<Mesh, HierarchyError> {
        let mut mesh = Mesh::new(base)?;
        let grid = mesh.tree.base();
        for cell in splits {
            if usize::from(cell.level) >= MAX_LEVEL {
                return Err(HierarchyError::Depth { level: cell.level.into(), most: MAX_LEVEL });
            }
            if (0..2).any(|axis| (cell.place[axis] >> cell.level) as usize >= grid[axis]) {
                return Err(HierarchyError::Place { level: cell.level.into(), place: cell.place });
            }
            mesh.refine(cell)?;
        }
        Ok(mesh)
    }

    /// The base grid with the knots of all levels down to this one; nothing is split.
    ///
    /// # Errors
    /// Those of [`Mesh::new`], [`HierarchyError::Depth`], and a segment too short to be halved.
    pub fn with_levels(base: [Knots; 2], deepest: usize) -> Result<Mesh, HierarchyError> {
        if deepest > MAX_LEVEL {
            return Err(HierarchyError::Depth { level: deepest, most: MAX_LEVEL });
        }
        let mut mesh = Mesh::new(base)?;
        mesh.levels.deepen(deepest)?;
        Ok(mesh)
    }

    /// All cells that are split: what [`Mesh::of_splits`] makes the same hierarchy of.
    pub fn splits(&self) -> impl Iterator<Item = CellId> + '_ {
        (0..self.tree.len()).filter(|number| self.tree.is_split(*number)).map(|number| self.tree.cell(number))
    }

    /// Knots of all levels.
    pub fn levels(&self) -> &KnotLevels {
        &self.levels
    }

    /// The cells.
    pub fn tree(&self) -> &Quadtree {
        &self.tree
    }

    /// Splits a cell, and before it whatever must be split so that the hierarchy stays admissible. A cell that does not exist is made to
    /// exist first; one that was split before is left as it is.
    ///
    /// # Errors
    /// [`HierarchyError::Depth`] at the deepest level, [`HierarchyError::Knots`] where a segment is too short to be halved.
    pub fn refine(&mut self, cell: CellId) -> Result<(), HierarchyError> {
        if usize::from(cell.level) >= MAX_LEVEL {
            return Err(HierarchyError::Depth { level: cell.level.into(), most: MAX_LEVEL });
        }
        self.levels.deepen(usize::from(cell.level) + 1)?;
        self.admit(cell);
        Ok(())
    }

    /// The recursion is at most as deep as there are levels.
    fn admit(&mut self, cell: CellId) {
        let number = match self.tree.find(cell) {
            Some(number) if self.tree.is_split(number) => return,
            Some(number) => number,
            None => {
                self.admit(cell.ancestor(cell.level - 1));
                return self.admit(cell);
            }
        };
        if cell.level > 0 {
            let level = self.levels.at(usize::from(cell.level));
            let [x, y] = [0, 1].map(|axis| level[axis].extension(cell.place[axis]));
            // cells of one parent exist together
            for i in x[0] / 2..=x[1] / 2 {
                for j in y[0] / 2..=y[1] / 2 {
                    self.admit(CellId { level: cell.level - 1, place: [i, j] });
                }
            }
        }
        self.tree.split(number);
    }

    /// Centre and half of the sides of a cell.
    pub fn centre_and_half(&self, cell: CellId) -> [[f64; 2]; 2] {
        let level = self.levels.at(cell.level.into());
        let ends = [0, 1].map(|axis| level[axis].knots().segment(cell.place[axis] as usize));
        [ends.map(|[a, b]| a + 0.5 * (b - a)), ends.map(|[a, b]| 0.5 * (b - a))]
    }

    /// Base cell of a place and the digits of its halvings; places outside belong to the nearest cell.
    #[inline]
    pub fn digits(&self, at: [f64; 2]) -> ([usize; 2], [u32; 2]) {
        const STEPS: f64 = (1u32 << MAX_LEVEL) as f64;
        let base = self.levels.at(0);
        let mut digits = [0; 2];
        let root = [0, 1].map(|axis| {
            let knots = base[axis].knots();
            let segment = knots.segment_of(at[axis]);
            let [lo, hi] = knots.segment(segment);
            // `as` saturates at 0, and places beyond the end take the last digit
            digits[axis] = (((at[axis] - lo) / (hi - lo) * STEPS) as u32).min((1 << MAX_LEVEL) - 1);
            segment
        });
        (root, digits)
    }

    /// Number of the unsplit cell that holds a place.
    #[inline]
    pub fn locate(&self, at: [f64; 2]) -> usize {
        let (root, digits) = self.digits(at);
        self.tree.leaf_at(root, digits)
    }
}
