//! Contacts wherever they fell: each row is the Kronecker product of that contact's two basis rows (Khatri-Rao).

use crate::bspline::{Knots, MAX_DEGREE};
use crate::linalg::{Site, Sites, TensorShape};

/// Scattered sites, ordered knot cell by knot cell by a counting sort; basis values are formed as they are visited.
#[derive(Clone, Debug)]
pub struct ScatteredSites {
    knots: [Knots; 2],
    points: Vec<[f64; 2]>,
    /// Sites in cell order, and for each its cell.
    order: Vec<u32>,
    /// Start of every cell in `order`.
    cell_starts: Vec<u32>,
}

impl ScatteredSites {
    /// Sorts the points `(x, y)` (coordinates of the knots) by knot cell.
    pub fn new(knots: [Knots; 2], points: Vec<[f64; 2]>) -> ScatteredSites {
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
        ScatteredSites { knots, points, order, cell_starts }
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
        let across = self.knots[1].n_segments();
        let width = self.shape().degree.map(|d| d + 1);
        let (mut x, mut y) = ([0.0; 2 * (MAX_DEGREE + 1)], [0.0; 2 * (MAX_DEGREE + 1)]);
        for cell in 0..self.cell_starts.len() - 1 {
            let range = self.cell_starts[cell] as usize..self.cell_starts[cell + 1] as usize;
            let segment = [cell / across, cell % across];
            let first = [self.knots[0].first_basis(segment[0]), self.knots[1].first_basis(segment[1])];
            if range.is_empty() {
                continue;
            }
            let basis = [self.knots[0].on_segment(segment[0]), self.knots[1].on_segment(segment[1])];
            for &index in &self.order[range] {
                let index = index as usize;
                let point = self.points[index];
                basis[0].values_and_slopes(point[0], &mut x[..2 * width[0]]);
                basis[1].values_and_slopes(point[1], &mut y[..2 * width[1]]);
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
}
