//! The contacts as a segmentation sees them: in units of their own size about their own centre, each with its neighbours.
//!
//! ```text
//! p <- (p - mean) / s,  s = rms distance from the mean        spacing = median distance to the nearest other point
//! ```
//!
//! Every length in this room is in units of s until the answer is written, so that a cloud and its copy in metres are cut alike.

use super::tuning::PartsTuning;
use palpate_geometry::contact::Rounding;
use palpate_geometry::neighbours::{NeighbourLists, morton_order};
use palpate_numeric::statistics::{evenly_among, upper_median};
use palpate_numeric::vector::{Vector, along, dot, minus, scaled};

/// Neighbours of a point, nearest first, itself left out. Local surfaces of six unknowns take them all: with 3 rows each, a
/// tenth of the rows is spent on unknowns; more would reach across small features.
pub(super) const NEAREST: usize = 20;

/// The nearest of them, along which regions grow and labels agree.
pub(super) const LINKED: usize = 8;

/// Lengths in units of the cloud's size within which a surface is exact: six digits of text, or 32-bit numbers.
pub(super) const DIGITS: f64 = 1e-6;

/// Fewest points of a cloud: the neighbours of one, and it.
pub(super) const FEWEST_POINTS: usize = NEAREST + 4;

/// Points with unit normals and their neighbours.
#[derive(Clone, Debug)]
pub(super) struct Cloud {
    pub(super) points: Vec<Vector>,
    pub(super) normals: Vec<Vector>,
    neighbours: NeighbourLists<NEAREST>,
    /// Median distance between nearest neighbours.
    pub(super) spacing: f64,
    /// What one unit here is in the input.
    pub(super) scale: f64,
    pub(super) centre: Vector,
    /// By how much the numbers were rounded where they were written.
    pub(super) rounding: Rounding,
}

/// Points in units of their size about their centre, that centre and that size; `None` where all points are one.
pub(super) fn framed(points: &[Vector]) -> Option<(Vec<Vector>, Vector, f64)> {
    let count = points.len() as f64;
    let first = points[0];
    let sum = points.iter().fold([0.0; 3], |sum, p| along(sum, 1.0, minus(*p, first)));
    let centre = along(first, 1.0 / count, sum);
    let square = |p: &Vector| dot(minus(*p, centre), minus(*p, centre));
    let scale = (points.iter().map(square).sum::<f64>() / count).sqrt();
    let is_sound = scale > 0.0 && scale.is_finite();
    is_sound.then(|| (points.iter().map(|p| scaled(1.0 / scale, minus(*p, centre))).collect(), centre, scale))
}

impl Cloud {
    /// From points and unit normals in the input's units; `None` where all points are one.
    pub(super) fn new(points: &[Vector], normals: Vec<Vector>) -> Option<Cloud> {
        Cloud::among(points, normals, NeighbourLists::new(points))
    }

    /// The same where neighbours are known.
    pub(super) fn among(points: &[Vector], normals: Vec<Vector>, neighbours: NeighbourLists<NEAREST>) -> Option<Cloud> {
        let (points, centre, scale) = framed(points)?;
        Cloud::in_its_units(points, normals, neighbours, (centre, scale))
    }

    fn in_its_units(
        points: Vec<Vector>,
        normals: Vec<Vector>,
        neighbours: NeighbourLists<NEAREST>,
        (centre, scale): (Vector, f64),
    ) -> Option<Cloud> {
        let spacing = upper_median(neighbours.nearest_distances(&points).collect::<Vec<f64>>())?;
        Some(Cloud { points, normals, neighbours, spacing, scale, centre, rounding: Rounding::NONE })
    }

    /// A place and its normal.
    pub(super) fn contact(&self, i: usize) -> (Vector, Vector) {
        (self.points[i], self.normals[i])
    }

    /// Whether two contacts next to each other are on the two sides of a wall.
    pub(super) fn are_back_to_back(&self, i: usize, j: usize, tuning: &PartsTuning) -> bool {
        dot(self.normals[i], self.normals[j]) < tuning.back_to_back
    }

    /// The same of numbers that were rounded by so much, in the input's units.
    pub(super) fn rounded(self, rounding: Rounding) -> Cloud {
        Cloud { rounding: rounding.per(self.scale), ..self }
    }

    /// So many of the contacts, evenly along a curve that fills space, in the same units; `None` where there are no more.
    pub(super) fn spread(&self, most: usize) -> Option<Cloud> {
        if self.len() <= most {
            return None;
        }
        let order = morton_order(&self.points);
        let taken = evenly_among(self.len(), most).map(|k| order[k] as usize);
        let (points, normals): (Vec<Vector>, Vec<Vector>) = taken.map(|i| (self.points[i], self.normals[i])).unzip();
        let neighbours = NeighbourLists::new(&points);
        let spread = Cloud::in_its_units(points, normals, neighbours, (self.centre, self.scale))?;
        Some(Cloud { rounding: self.rounding, ..spread })
    }

    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    /// By how much the numbers of some contacts were rounded, and how many share one rounding.
    pub(super) fn rounding_among(&self, members: &[u32]) -> Rounding {
        let of = |values: &[Vector]| members.iter().map(|&i| values[i as usize]).collect::<Vec<Vector>>();
        self.rounding.among(&of(&self.points), &of(&self.normals))
    }

    /// The neighbours of point `i`, nearest first.
    pub(super) fn near(&self, i: usize) -> &[u32] {
        self.neighbours.of(i)
    }

    /// The nearest of them.
    pub(super) fn linked(&self, i: usize) -> &[u32] {
        &self.near(i)[..LINKED]
    }

    /// A point in the input's units.
    pub(super) fn outside(&self, p: Vector) -> Vector {
        along(self.centre, self.scale, p)
    }
}
