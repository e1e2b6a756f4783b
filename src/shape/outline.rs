//! Where scattered contacts support a height field: inside their outline and near enough to one of them.
//!
//! ```text
//! spacing s = sqrt(area of the box / contacts)
//! inside    d . p <= max over contacts of d . c + s        for 16 directions d: the convex outline, and a little beyond
//! near      |p - c| <= 2.5 s  for some contact c           holes and bays of the outline hold nothing
//! ```
//!
//! A point on the outline counts as inside, so a patch that was swept on a lattice keeps all of its grid, though noise
//! moves the contacts of its edges. Contacts fall into a circle of 2.5 s about twenty at a time where they lie evenly;
//! fingers may lie a few times farther apart than stations follow each other.

/// Directions in which the outline is measured; the outline is exact to 1 - cos(pi/16), 2 % of its size.
const DIRECTIONS: usize = 16;

/// Distance, in spacings, up to which a contact supports what is around it.
const NEAR: f64 = 2.5;

/// Contacts that are looked at; of more, every so many-th, whose spacing is larger accordingly.
const ENOUGH: usize = 4096;

/// The outline of contacts in x and y, with the contacts themselves in square cells.
pub(crate) struct Outline {
    /// Contacts, those of a cell next to each other.
    contacts: Vec<[f64; 2]>,
    /// Where each cell's contacts begin, cells along y running fastest; one entry more than there are cells.
    starts: Vec<usize>,
    /// Corner of the first cell, and cells along x and y.
    corner: [f64; 2],
    cells: [usize; 2],
    /// Direction and farthest contact along it, one spacing added.
    edges: [([f64; 2], f64); DIRECTIONS],
    /// Distance up to which a contact supports: the side of a cell.
    near: f64,
}

impl Outline {
    /// Of contacts at these places.
    pub(crate) fn new(x: &[f64], y: &[f64]) -> Outline {
        let step = x.len().div_ceil(ENOUGH).max(1);
        let some = || x.iter().zip(y).step_by(step).map(|(x, y)| [*x, *y]);
        let count = some().count();
        let least = |k: usize| some().map(|c| c[k]).fold(f64::INFINITY, f64::min);
        let most = |k: usize| some().map(|c| c[k]).fold(f64::NEG_INFINITY, f64::max);
        let corner = [least(0), least(1)];
        let sides = [most(0) - corner[0], most(1) - corner[1]];
        let spacing = (sides[0] * sides[1] / count.max(1) as f64).sqrt();
        let edge = |k: usize| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / DIRECTIONS as f64).sin_cos();
            let farthest = some().map(|c| cos * c[0] + sin * c[1]).fold(f64::NEG_INFINITY, f64::max);
            ([cos, sin], farthest + spacing)
        };
        let near = NEAR * spacing;
        // contacts on one line have no area: one cell then holds them all
        let cells = sides.map(|side| if near > 0.0 { (side / near) as usize + 1 } else { 1 }.min(ENOUGH));
        let mut outline = Outline {
            contacts: vec![[0.0; 2]; count],
            starts: vec![0; cells[0] * cells[1] + 1],
            corner,
            cells,
            edges: std::array::from_fn(edge),
            near,
        };
        outline.fill(some);
        outline
    }

    /// Sorts the contacts by their cells, by counting.
    fn fill<I: Iterator<Item = [f64; 2]>>(&mut self, some: impl Fn() -> I) {
        for c in some() {
            let cell = self.cell(c);
            self.starts[cell + 1] += 1;
        }
        (1..self.starts.len()).for_each(|k| self.starts[k] += self.starts[k - 1]);
        let mut next = self.starts.clone();
        for c in some() {
            let cell = self.cell(c);
            self.contacts[next[cell]] = c;
            next[cell] += 1;
        }
    }

    /// Place of a coordinate among the cells along one direction, those beyond the ends at the ends.
    fn along(&self, k: usize, value: f64) -> usize {
        if self.near > 0.0 { (((value - self.corner[k]) / self.near) as usize).min(self.cells[k] - 1) } else { 0 }
    }

    fn cell(&self, c: [f64; 2]) -> usize {
        self.along(0, c[0]) * self.cells[1] + self.along(1, c[1])
    }

    /// Whether contacts support the point.
    pub(crate) fn holds(&self, x: f64, y: f64) -> bool {
        self.edges.iter().all(|(d, farthest)| d[0] * x + d[1] * y <= *farthest) && self.is_near(x, y)
    }

    fn is_near(&self, x: f64, y: f64) -> bool {
        let (i, j) = (self.along(0, x), self.along(1, y));
        let last = (j + 1).min(self.cells[1] - 1);
        (i.saturating_sub(1)..=(i + 1).min(self.cells[0] - 1)).any(|i| {
            // cells that follow each other along y are one run of contacts
            let row = i * self.cells[1];
            let run = self.starts[row + j.saturating_sub(1)]..self.starts[row + last + 1];
            self.contacts[run].iter().any(|c| (c[0] - x).powi(2) + (c[1] - y).powi(2) <= self.near * self.near)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_keeps_its_corners_and_a_turned_one_loses_those_of_its_box() {
        let lattice: Vec<[f64; 2]> = (0..36).map(|i| [(i % 6) as f64, (i / 6) as f64]).collect();
        let split = |points: &[[f64; 2]]| -> (Vec<f64>, Vec<f64>) { points.iter().map(|p| (p[0], p[1])).unzip() };
        let (x, y) = split(&lattice);
        let outline = Outline::new(&x, &y);
        assert!([[0.0, 0.0], [5.0, 0.0], [0.0, 5.0], [5.0, 5.0], [2.5, 2.5]].iter().all(|p| outline.holds(p[0], p[1])));
        let turned: Vec<[f64; 2]> = lattice.iter().map(|[x, y]| [x - y, x + y]).collect();
        let (x, y) = split(&turned);
        let outline = Outline::new(&x, &y);
        assert!(outline.holds(0.0, 0.0) && outline.holds(0.0, 5.0));
        assert!(!outline.holds(-5.0, 0.0) && !outline.holds(5.0, 10.0));
    }

    #[test]
    fn a_hole_is_not_supported() {
        let ring: Vec<f64> = (0..400).map(|i| i as f64 * 0.9).collect();
        let (x, y): (Vec<f64>, Vec<f64>) = ring.iter().map(|a| (10.0 * a.cos(), 10.0 * a.sin())).unzip();
        let outline = Outline::new(&x, &y);
        assert!(outline.holds(10.0, 0.0) && !outline.holds(0.0, 0.0));
    }
}
