//! The cells of a hierarchy: every base cell is the root of a tree whose nodes have four children or none.
//!
//! ```text
//! cell (l, i, j)     children (l + 1, 2i + a, 2j + b), a, b = 0, 1       Omega^l = union of all cells of level l that exist
//! ```

/// The deepest level: places of cells and of contacts are counted in 32 bits, and base grids have up to 2^10 segments.
pub const MAX_LEVEL: usize = 20;

const NONE: u32 = u32::MAX;

/// One cell by its level and its place in the grid of that level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellId {
    /// Level, 0 in the base grid.
    pub level: u8,
    /// Segment in x and in y, counted in the grid of the level.
    pub place: [u32; 2],
}

impl CellId {
    /// The cell of a coarser level that holds it.
    pub fn ancestor(self, level: u8) -> CellId {
        let by = self.level - level;
        CellId { level, place: self.place.map(|k| k >> by) }
    }

    /// Its four children, in the order of the tree.
    pub fn children(self) -> [CellId; 4] {
        let [i, j] = self.place.map(|k| 2 * k);
        [[0, 0], [0, 1], [1, 0], [1, 1]].map(|[a, b]| CellId { level: self.level + 1, place: [i + a, j + b] })
    }
}

/// A forest of cells over the base grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quadtree {
    base: [u32; 2],
    cells: Vec<CellId>,
    /// First of the four children of every cell, or `NONE`.
    children: Vec<u32>,
    deepest: u8,
}

impl Quadtree {
    /// The base grid, nothing split.
    pub fn new(base: [usize; 2]) -> Quadtree {
        let [across, along] = base.map(|k| k as u32);
        let cells: Vec<CellId> =
            (0..across).flat_map(|i| (0..along).map(move |j| CellId { level: 0, place: [i, j] })).collect();
        let children = vec![NONE; cells.len()];
        Quadtree { base: [across, along], cells, children, deepest: 0 }
    }

    /// Segments of the base grid.
    pub fn base(&self) -> [usize; 2] {
        self.base.map(|k| k as usize)
    }

    /// Level of the finest cell.
    pub fn deepest(&self) -> usize {
        usize::from(self.deepest)
    }

    /// Number of all cells, those that were split included.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// A forest has at least one cell.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// The cell with this number.
    pub fn cell(&self, number: usize) -> CellId {
        self.cells[number]
    }

    /// Whether the cell with this number was split.
    pub fn is_split(&self, number: usize) -> bool {
        self.children[number] != NONE
    }

    /// Number of a cell; `None` where its parent was not split.
    pub fn find(&self, cell: CellId) -> Option<usize> {
        let root = cell.ancestor(0).place;
        let mut number = root[0] as usize * self.base[1] as usize + root[1] as usize;
        for bit in (0..cell.level).rev() {
            let first = self.children[number];
            if first == NONE {
                return None;
            }
            let [a, b] = cell.place.map(|k| (k >> bit & 1) as usize);
            number = first as usize + 2 * a + b;
        }
        Some(number)
    }

    /// Number of the unsplit cell that holds a place: base cell and digits of [`MAX_LEVEL`] halvings in each direction.
    #[inline]
    pub fn leaf_at(&self, root: [usize; 2], digits: [u32; 2]) -> usize {
        let mut number = root[0] * self.base[1] as usize + root[1];
        let mut bit = MAX_LEVEL;
        while self.children[number] != NONE && bit > 0 {
            bit -= 1;
            let [a, b] = digits.map(|k| (k >> bit & 1) as usize);
            number = self.children[number] as usize + 2 * a + b;
        }
        number
    }

    /// Splits the cell with this number into four; nothing happens where it was split before.
    pub(super) fn split(&mut self, number: usize) {
        if self.children[number] != NONE {
            return;
        }
        let cell = self.cells[number];
        self.children[number] = self.cells.len() as u32;
        self.cells.extend(cell.children());
        self.children.extend([NONE; 4]);
        self.deepest = self.deepest.max(cell.level + 1);
    }

    /// Numbers of all unsplit cells: base cell by base cell, children in the order of the tree.
    pub fn leaves(&self) -> Vec<usize> {
        let roots = self.base[0] as usize * self.base[1] as usize;
        let mut leaves = Vec::new();
        let mut waiting = Vec::new();
        for root in 0..roots {
            waiting.push(root);
            while let Some(number) = waiting.pop() {
                match self.children[number] {
                    NONE => leaves.push(number),
                    first => waiting.extend((first as usize..first as usize + 4).rev()),
                }
            }
        }
        leaves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_found_where_they_are() {
        let mut tree = Quadtree::new([3, 2]);
        let root = tree.find(CellId { level: 0, place: [2, 1] }).unwrap();
        tree.split(root);
        let child = tree.find(CellId { level: 1, place: [5, 2] }).unwrap();
        tree.split(child);
        assert_eq!((tree.len(), tree.deepest(), tree.leaves().len()), (14, 2, 12));
        assert_eq!(tree.find(CellId { level: 1, place: [0, 0] }), None);
        for number in 0..tree.len() {
            assert_eq!(tree.find(tree.cell(number)), Some(number));
        }
        let half = 1 << (MAX_LEVEL - 1);
        let deep = tree.leaf_at([2, 1], [half | half >> 1, 0]);
        assert_eq!(tree.cell(deep), CellId { level: 2, place: [11, 4] });
        assert_eq!(tree.cell(tree.leaf_at([0, 1], [half, half])), CellId { level: 0, place: [0, 1] });
    }
}
