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

/// Cosines of multiples of 22.5 degrees: the outline is measured along 16 directions, and is exact to 1 - cos(pi/16), 2 % of
/// its size.
const COSINES: [f64; 5] = [1.0, 0.923_879_532_511_286_7, std::f64::consts::FRAC_1_SQRT_2, 0.382_683_432_365_089_8, 0.0];

/// Half of the directions; the other half are their opposites.
const HALF: usize = 8;

/// Distance, in spacings, up to which a contact supports what is around it.
const NEAR: f64 = 2.5;

/// Contacts that are looked at; of more, every so many-th, whose spacing is larger accordingly.
const MOST_CONTACTS: usize = 4096;

/// Up to so many contacts one cell holds all: looking at each takes less than finding the cells around a point.
const FEW_CONTACTS: usize = 64;

/// The outline of contacts in x and y, with the contacts themselves in square cells.
#[derive(Debug)]
pub struct Outline {
    /// Contacts, those of a cell next to each other.
    contacts: Vec<[f64; 2]>,
    /// Where each cell's contacts begin, cells along y running fastest; one entry more than there are cells.
    starts: Vec<usize>,
    /// Corner of the first cell, and cells along x and y.
    corner: [f64; 2],
    cells: [usize; 2],
    /// Least and largest place of the contacts along each half of the directions, one spacing added.
    ends: [[f64; 2]; HALF],
    /// Distance up to which a contact supports: the side of a cell.
    near: f64,
}

/// Unit vector number k of the first half of the directions.
fn direction(k: usize) -> [f64; 2] {
    if k <= 4 { [COSINES[k], COSINES[4 - k]] } else { [-COSINES[8 - k], COSINES[k - 4]] }
}

/// Least and largest place along a direction.
fn ends_along(contacts: &[[f64; 2]], [a, b]: [f64; 2]) -> [f64; 2] {
    let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
    for c in contacts {
        let place = a * c[0] + b * c[1];
        ends = [ends[0].min(place), ends[1].max(place)];
    }
    ends
}

impl Outline {
    /// Of so many contacts every which one is looked at, from the first on.
    pub fn step_of(contacts: usize) -> usize {
        contacts.div_ceil(MOST_CONTACTS).max(1)
    }

    /// Of contacts at these places.
    pub fn new(x: &[f64], y: &[f64]) -> Outline {
        let step = Outline::step_of(x.len());
        let given: Vec<[f64; 2]> = (0..x.len()).step_by(step).map(|r| [x[r], y[r]]).collect();
        let [along_x, along_y] = [ends_along(&given, [1.0, 0.0]), ends_along(&given, [0.0, 1.0])];
        let sides = [along_x[1] - along_x[0], along_y[1] - along_y[0]];
        let spacing = (sides[0] * sides[1] / given.len().max(1) as f64).sqrt();
        let near = NEAR * spacing;
        // contacts on one line have no area: one cell then holds them all
        let split = near > 0.0 && given.len() > FEW_CONTACTS;
        let cells = sides.map(|side| if split { (side / near) as usize + 1 } else { 1 }.min(MOST_CONTACTS));
        let ends = std::array::from_fn(|k| {
            let [lo, hi] = ends_along(&given, direction(k));
            [lo - spacing, hi + spacing]
        });
        let corner = [along_x[0], along_y[0]];
        let mut outline = Outline { contacts: Vec::new(), starts: vec![0, given.len()], corner, cells, ends, near };
        if split {
            outline.fill(&given);
        } else {
            outline.contacts = given;
        }
        outline
    }

    /// Sorts the contacts by their cells, by counting.
    fn fill(&mut self, given: &[[f64; 2]]) {
        self.starts = vec![0; self.cells[0] * self.cells[1] + 1];
        for c in given {
            let cell = self.cell(*c);
            self.starts[cell + 1] += 1;
        }
        (1..self.starts.len()).for_each(|k| self.starts[k] += self.starts[k - 1]);
        let mut next = self.starts.clone();
        self.contacts = vec![[0.0; 2]; given.len()];
        for c in given {
            let cell = self.cell(*c);
            self.contacts[next[cell]] = *c;
            next[cell] += 1;
        }
    }

    /// Place of a coordinate among the cells along one direction, those beyond the ends at the ends.
    fn along(&self, k: usize, value: f64) -> usize {
        if self.cells[k] == 1 { 0 } else { (((value - self.corner[k]) / self.near) as usize).min(self.cells[k] - 1) }
    }

    fn cell(&self, c: [f64; 2]) -> usize {
        self.along(0, c[0]) * self.cells[1] + self.along(1, c[1])
    }

    /// Whether contacts support the point.
    pub fn holds(&self, x: f64, y: f64) -> bool {
        let within = |(k, [lo, hi]): (usize, &[f64; 2])| {
            let [a, b] = direction(k);
            let place = a * x + b * y;
            *lo <= place && place <= *hi
        };
        self.is_near(x, y) && self.ends.iter().enumerate().all(within)
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
