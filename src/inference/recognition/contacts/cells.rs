//! At most 200 averaged contacts: means over voxels of their feet on the robust surface, with the curvature inside a voxel taken
//! out. Voxels of the contacts themselves would part those of one place by their errors.
//!
//! ```text
//! C = mean P + (mean d - d(mean P)) n         the mean distance, at the foot of the mean place
//! D = diag(mean count / count)                variance of a mean relative to that of an average cell
//! ```
//!
//! There are at most 200, because work with dense matrices grows with the cube of their number; 300 gave the same
//! answers.

use std::collections::HashMap;

use super::rounding::Floors;
use super::scatter_within::ScatterWithin;
use crate::recognition::kinds::Model;
use palpate_numeric::statistics::median;
use palpate_numeric::vector::{Vector, along, cross, dot, reject, scaled, unit};

/// Cells at most.
const MOST_CELLS: usize = 200;

/// Range of voxel sizes, in units of the patch's size, and the halvings of its logarithm.
const SIZES: [f64; 2] = [1e-3, 8.0];
const HALVINGS: usize = 20;

/// Widening of the least size that will do: at that size itself a border runs through contacts of an even grid, and their errors
/// would decide on which side they count.
const ROOM: f64 = 1.05;

/// Variance of a cell without normals, relative to that of an average one: its rows stay, and have no weight. With a hundredth of a normal's
/// weight they were measurements without errors, and normals that scatter by 2 degrees had 0.01.
const UNKNOWN: f64 = 1e8;

/// Whether cells with normals of this relative variance have any.
pub(crate) fn is_known(variance: f64) -> bool {
    variance < UNKNOWN
}

/// Measured normals of the cells.
#[derive(Clone, Debug)]
pub(crate) struct CellNormals {
    pub(crate) measured: Vec<Vector>,
    /// Variance relative to that of an average cell.
    pub(crate) variance: Vec<f64>,
}

impl CellNormals {
    /// Those that are known, and zero where there is none.
    pub(crate) fn where_known(&self) -> Vec<Vector> {
        let pairs = self.measured.iter().zip(&self.variance);
        pairs.map(|(normal, variance)| if is_known(*variance) { *normal } else { [0.0; 3] }).collect()
    }

    /// How many cells have any.
    pub(crate) fn known(&self) -> usize {
        self.variance.iter().filter(|variance| is_known(**variance)).count()
    }
}

/// The averaged contacts.
#[derive(Clone, Debug)]
pub(crate) struct Cells {
    pub(crate) points: Vec<Vector>,
    /// Their feet on the robust surface, by which neighbours are told.
    pub(crate) feet: Vec<Vector>,
    /// Variance relative to that of an average cell.
    pub(crate) variance: Vec<f64>,
    /// Weights of the plain refits: the counts, limited so that a crowded cell does not outvote the others.
    pub(crate) weights: Vec<f64>,
    /// Two tangents of the robust surface.
    pub(crate) tangents: [Vec<Vector>; 2],
    pub(crate) normals: Option<CellNormals>,
    /// Cell of every contact.
    pub(crate) of: Vec<usize>,
    /// Floors of the errors of a cell.
    pub(crate) floors: Floors,
    /// How contacts scatter within them.
    pub(crate) within: ScatterWithin,
}

impl Cells {
    /// The vector across `normal` whose parts along both tangents of a cell are these: `g = a' p + b' q` with the tangents' own parts p
    /// and q across it. Zero where those do not span a plane.
    pub(crate) fn gradient(&self, cell: usize, normal: Vector, [a, b]: [f64; 2]) -> Vector {
        let [p, q] = [0, 1].map(|side| reject(self.tangents[side][cell], normal));
        let (pp, pq, qq) = (dot(p, p), dot(p, q), dot(q, q));
        let det = pp * qq - pq * pq;
        if det <= 0.0 {
            return [0.0; 3];
        }
        along(scaled((a * qq - b * pq) / det, p), (b * pp - a * pq) / det, q)
    }
}

/// Averages contacts whose feet on the surface share a voxel; `errors` are measured minus model normals, `None` where a normal is
/// not used.
pub(crate) fn cells(points: &[Vector], feet: &[Vector], surface: &Model, errors: Option<&[Option<Vector>]>) -> Cells {
    let (of, count) = membership(feet);
    let mut counts = vec![0.0; count];
    let mut sums = vec![[0.0; 3]; count];
    let mut distances = vec![0.0; count];
    for (&cell, p) in of.iter().zip(points) {
        counts[cell] += 1.0;
        sums[cell] = along(sums[cell], 1.0, *p);
        distances[cell] += surface.distance(*p);
    }
    let mut centres = Vec::with_capacity(count);
    let mut feet = Vec::with_capacity(count);
    let mut surface_normals = Vec::with_capacity(count);
    for cell in 0..count {
        let mean = sums[cell].map(|v| v / counts[cell]);
        let (d, normal) = surface.distance_and_normal(mean);
        centres.push(along(mean, distances[cell] / counts[cell] - d, normal));
        feet.push(along(mean, -d, normal));
        surface_normals.push(normal);
    }
    let middle = median(counts.clone()).unwrap_or(0.0);
    let mean_count = points.len() as f64 / count as f64;
    let first: Vec<Vector> = surface_normals.iter().map(|n| tangent(*n)).collect();
    let second = surface_normals.iter().zip(&first).map(|(n, t)| cross(*n, *t)).collect();
    Cells {
        normals: errors.map(|errors| cell_normals(&of, &centres, surface, errors)),
        variance: counts.iter().map(|c| mean_count / c).collect(),
        weights: counts.iter().map(|c| c.min(4.0 * middle) / middle).collect(),
        tangents: [first, second],
        points: centres,
        feet,
        of,
        floors: Floors::default(),
        within: ScatterWithin::default(),
    }
}

fn tangent(n: Vector) -> Vector {
    let axis = if n[1].abs() < 0.9 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
    unit(cross(n, axis))
}

fn cell_normals(of: &[usize], centres: &[Vector], surface: &Model, errors: &[Option<Vector>]) -> CellNormals {
    let mut counts = vec![0.0_f64; centres.len()];
    let mut sums = vec![[0.0; 3]; centres.len()];
    for (&cell, error) in of.iter().zip(errors) {
        if let Some(error) = error {
            counts[cell] += 1.0;
            sums[cell] = along(sums[cell], 1.0, *error);
        }
    }
    let measured = (0..centres.len())
        .map(|c| along(surface.distance_and_normal(centres[c]).1, 1.0 / counts[c].max(1.0), sums[c]))
        .collect();
    let mean = counts.iter().sum::<f64>() / counts.iter().filter(|c| **c > 0.0).count().max(1) as f64;
    let variance = |c: &f64| if *c > 0.0 { mean / c } else { UNKNOWN };
    CellNormals { measured, variance: counts.iter().map(variance).collect() }
}

/// Cell of every point, and the number of cells.
fn membership(points: &[Vector]) -> (Vec<usize>, usize) {
    if points.len() <= MOST_CELLS {
        return ((0..points.len()).collect(), points.len());
    }
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for p in points {
        (0..3).for_each(|k| (bounds[0][k], bounds[1][k]) = (bounds[0][k].min(p[k]), bounds[1][k].max(p[k])));
    }
    let [mut lo, mut hi] = SIZES;
    for _ in 0..HALVINGS {
        let size = (lo * hi).sqrt();
        if are_more(points, bounds, size, MOST_CELLS) {
            lo = size;
        } else {
            hi = size;
        }
    }
    let size = ROOM * hi;
    let mut numbers = VoxelNumbers::new(bounds, size);
    let of = points.iter().map(|p| numbers.of(voxel(*p, size))).collect();
    (of, numbers.count)
}

/// Whether voxels of this size hold more than `most` groups of the points.
fn are_more(points: &[Vector], bounds: [Vector; 2], size: f64, most: usize) -> bool {
    let mut numbers = VoxelNumbers::new(bounds, size);
    points.iter().any(|p| {
        numbers.of(voxel(*p, size));
        numbers.count > most
    })
}

/// The voxel of a point: `floor(p / size + 1/2)`.
fn voxel(p: Vector, size: f64) -> [i64; 3] {
    p.map(|v| {
        let place = v / size + 0.5;
        // a conversion cuts towards zero
        let whole = place as i64;
        whole - i64::from((whole as f64) > place)
    })
}

/// Voxels of a table that is looked up instead of a hash map.
const TABLE: usize = 1 << 16;

/// Voxels numbered as they are met.
struct VoxelNumbers {
    count: usize,
    /// First voxel and numbers of voxels of the table, and the number of each, 0 where it was not met; empty where the
    /// points reach over too many voxels.
    from: [i64; 3],
    sides: [i64; 3],
    table: Vec<u32>,
    map: HashMap<[i64; 3], usize>,
}

impl VoxelNumbers {
    /// For points within these bounds.
    fn new([lo, hi]: [Vector; 2], size: f64) -> VoxelNumbers {
        let (from, to) = (voxel(lo, size), voxel(hi, size));
        let sides = [0, 1, 2].map(|k| to[k].saturating_sub(from[k]).saturating_add(1).max(1));
        let room = sides.iter().try_fold(1_usize, |room, side| room.checked_mul(usize::try_from(*side).ok()?));
        let table = vec![0; room.filter(|room| *room <= TABLE).unwrap_or(0)];
        VoxelNumbers { count: 0, from, sides, table, map: HashMap::new() }
    }

    fn of(&mut self, voxel: [i64; 3]) -> usize {
        let [i, j, k] = [0, 1, 2].map(|d| voxel[d].wrapping_sub(self.from[d]));
        let at = (i.wrapping_mul(self.sides[1]).wrapping_add(j)).wrapping_mul(self.sides[2]).wrapping_add(k);
        if let Some(number) = usize::try_from(at).ok().and_then(|at| self.table.get_mut(at)) {
            if *number == 0 {
                self.count += 1;
                *number = self.count as u32;
            }
            return *number as usize - 1;
        }
        let number = *self.map.entry(voxel).or_insert(self.count);
        self.count += usize::from(number == self.count);
        number
    }
}
