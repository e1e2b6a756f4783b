//! The domain as rectangles along knot lines, each with a finest level of its own.
//!
//! ```text
//! price(rectangle) = min( (n + p)(m + q) + price of a face,  price(one half) + price(other half) )      n x m cells of its finest level
//! ```
//!
//! A rectangle is halved across its longer side down to single cells, and these into their four children; whatever is no cheaper in parts
//! stays whole. Where cells are small in few places, their numbers are written there alone.

use super::{CellId, Mesh};

/// Coefficients that a face of its own is as dear as: four faces of single cells are rather one of four cells.
const FACE: u64 = 64;

/// Cells of one level, from the first place to before the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellRectangle {
    /// Their level.
    pub level: u8,
    /// Segments of the level in x and y at which it begins.
    pub from: [u32; 2],
    /// Segments behind its last.
    pub to: [u32; 2],
}

impl CellRectangle {
    /// The same rectangle in cells of a finer level.
    #[must_use]
    pub fn in_level(self, level: u8) -> CellRectangle {
        let by = level - self.level;
        CellRectangle { level, from: self.from.map(|k| k << by), to: self.to.map(|k| k << by) }
    }

    /// Cells in x and y.
    pub fn sides(&self) -> [u32; 2] {
        [0, 1].map(|axis| self.to[axis] - self.from[axis])
    }

    /// Both halves across the longer side.
    fn halves(self) -> [CellRectangle; 2] {
        let [n, m] = self.sides();
        let axis = usize::from(m > n);
        let middle = self.from[axis] + self.sides()[axis] / 2;
        let (mut first, mut second) = (self, self);
        first.to[axis] = middle;
        second.from[axis] = middle;
        [first, second]
    }
}

/// A rectangle as it is best cut.
struct BestCut {
    deepest: u8,
    price: u64,
    pieces: Vec<CellRectangle>,
}

impl Mesh {
    /// Rectangles that cover the domain, each in cells of the finest level that it holds.
    pub fn rectangles(&self) -> Vec<CellRectangle> {
        let to = self.tree.base().map(|k| k as u32);
        self.best_cut(CellRectangle { level: 0, from: [0; 2], to }).pieces
    }

    /// The recursion is as deep as cells can be halved.
    fn best_cut(&self, rectangle: CellRectangle) -> BestCut {
        if rectangle.sides() == [1, 1] {
            let cell = CellId { level: rectangle.level, place: rectangle.from };
            let is_split = self.tree.find(cell).is_some_and(|number| self.tree.is_split(number));
            return if is_split {
                self.best_cut(rectangle.in_level(rectangle.level + 1))
            } else {
                BestCut { deepest: rectangle.level, price: self.price(rectangle), pieces: vec![rectangle] }
            };
        }
        let [mut first, second] = rectangle.halves().map(|half| self.best_cut(half));
        let deepest = first.deepest.max(second.deepest);
        let whole = rectangle.in_level(deepest);
        let (together, apart) = (self.price(whole), first.price + second.price);
        if together <= apart {
            return BestCut { deepest, price: together, pieces: vec![whole] };
        }
        first.pieces.extend(second.pieces);
        BestCut { deepest, price: apart, pieces: first.pieces }
    }

    fn price(&self, rectangle: CellRectangle) -> u64 {
        let [n, m] = rectangle.sides().map(u64::from);
        let [p, q] = self.levels.degree().map(|p| p as u64);
        (n + p) * (m + q) + FACE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::bspline::Knots;

    #[test]
    fn rectangles_cover_every_cell_once_at_its_level_or_finer() {
        let knots = |n| Knots::uniform(3, n, 0.0, 1.0).unwrap();
        let mut mesh = Mesh::new([knots(7), knots(4)]).unwrap();
        assert_eq!(mesh.rectangles(), [CellRectangle { level: 0, from: [0, 0], to: [7, 4] }]);
        for cell in [CellId { level: 4, place: [90, 33] }, CellId { level: 6, place: [5, 250] }] {
            mesh.refine(cell).unwrap();
        }
        let pieces = mesh.rectangles();
        assert!(pieces.len() > 4);
        let deepest = mesh.tree().deepest() as u8;
        let area =
            |piece: &CellRectangle| piece.in_level(deepest).sides().iter().map(|n| u64::from(*n)).product::<u64>();
        assert_eq!(pieces.iter().map(area).sum::<u64>(), 28 << (2 * deepest));
        for leaf in mesh.tree().leaves() {
            let cell = mesh.tree().cell(leaf);
            let fine = cell.place.map(|k| k << (deepest - cell.level));
            let holds = |piece: &&CellRectangle| {
                let piece = piece.in_level(deepest);
                (0..2).all(|axis| (piece.from[axis]..piece.to[axis]).contains(&fine[axis]))
            };
            let held: Vec<&CellRectangle> = pieces.iter().filter(holds).collect();
            assert!(held.len() == 1 && held[0].level >= cell.level, "{cell:?}");
        }
        let price = |piece: &CellRectangle| mesh.price(*piece);
        let whole = mesh.price(CellRectangle { level: 0, from: [0, 0], to: [7, 4] }.in_level(deepest));
        assert!(8 * pieces.iter().map(price).sum::<u64>() < whole);
    }
}
