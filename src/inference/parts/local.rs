//! The surface about each point: a parabola through its neighbours and their normals, with S and R and how sure they are.
//!
//! ```text
//! z = c0 + c1 x + c2 y + (c3 x^2 + 2 c4 x y + c5 y^2) / 2        axes: the point's own normal is z
//! rows: heights / u_z, slopes n_z^2 / u_n                          21 points, 63 rows, 6 unknowns
//! u_z^2, u_n^2 = residual sums / (rows - trace of the block's hat matrix), at the quantile of points that few edges reach
//! ```
//!
//! Where an edge or a joint runs through the neighbourhood, the misfit is large: that is how regions know where not to begin.

use std::sync::OnceLock;

use super::cloud::{Cloud, LINKED, NEAREST};
use super::tuning::PartsTuning;
use palpate_geometry::contact::Rounding;
use palpate_geometry::curvature::{Derivatives, Principal};
use palpate_numeric::linalg::small::{Square, cholesky, inverse, solve};
use palpate_numeric::statistics::{self, ENOUGH_FOR_RANKS, Rank, evenly_among};
use palpate_numeric::threads;
use palpate_numeric::vector::{axes_along, dot, minus};

/// Noise below this share of the cloud's size is rounding.
pub(super) const ROUNDING: f64 = 1e-10;

/// Standard deviations of a point along the normal and of a normal per tangent axis, in the cloud's units and in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Noise {
    pub(super) distance: f64,
    pub(super) normal: f64,
}

impl Noise {
    /// The same where normals tell nothing: those of planes through neighbours say what their places say.
    pub(super) fn blind(&self) -> Noise {
        Noise { normal: f64::INFINITY, ..*self }
    }

    /// Not less than what written numbers leave. Contacts that lie on a surface to far less than that were not rounded, however round their
    /// numbers are.
    pub(super) fn at_least(&self, rounding: &Rounding) -> Noise {
        let [distance, normal] = rounding.variances().map(f64::sqrt);
        let [of_place, of_normal] = rounding.largest().map(|sd| Rounding::EXACT * sd);
        let above = |own: f64, exact: f64, least: f64| if own > exact { own.max(least) } else { own };
        Noise { distance: above(self.distance, of_place, distance), normal: above(self.normal, of_normal, normal) }
    }

    /// Not less than another.
    pub(super) fn at_least_as(&self, other: &Noise) -> Noise {
        Noise { distance: self.distance.max(other.distance), normal: self.normal.max(other.normal) }
    }

    /// With errors that are independent of these.
    pub(super) fn hypot(&self, other: &Noise) -> Noise {
        Noise { distance: self.distance.hypot(other.distance), normal: self.normal.hypot(other.normal) }
    }

    /// Not less than one and not more than another; where these contradict, the former.
    pub(super) fn between(&self, least: &Noise, most: &Noise) -> Noise {
        Noise {
            distance: self.distance.min(most.distance).max(least.distance),
            normal: self.normal.min(most.normal).max(least.normal),
        }
    }
}

/// The surface at one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalShape {
    /// Curvatures there; `None` where the neighbours leave them open.
    pub(super) principal: Option<Principal>,
    /// Standard uncertainty of S.
    pub(super) u_shape_index: f64,
    /// Residual sums over their degrees of freedom: heights, normals.
    pub(super) variance: [f64; 2],
}

/// A neighbourhood, and the degrees of freedom that it leaves to heights and to normals.
struct Width {
    nearest: usize,
    freedom: [f64; 2],
}

/// The widths at which noise is looked for. Where contacts are few, the wider one reaches round a handle, and the narrower one does not.
const WIDTHS: [Width; 2] =
    [Width { nearest: LINKED, freedom: [5.0, 15.0] }, Width { nearest: NEAREST, freedom: [16.0, 36.0] }];

/// The noise that most neighbourhoods show, the narrow ones and the wide ones.
pub(super) fn noise_by_width(cloud: &Cloud, tuning: &PartsTuning) -> [Noise; 2] {
    WIDTHS.map(|width| noise_at(cloud, &width, tuning))
}

/// The surfaces at the points of a cloud, each computed when it is first asked for: of very many contacts few are in no part.
pub(super) struct LocalShapes {
    noise: Noise,
    /// Cosine between the normals of a point and of a neighbour up to which they are on no one sheet.
    faces_away: f64,
    known: Vec<OnceLock<Box<LocalShape>>>,
}

impl LocalShapes {
    /// By the noise of wide neighbourhoods.
    pub(super) fn new(count: usize, noise: Noise, tuning: &PartsTuning) -> LocalShapes {
        let known = std::iter::repeat_with(OnceLock::new).take(count).collect();
        LocalShapes { noise, faces_away: tuning.faces_away, known }
    }

    pub(super) fn at(&self, cloud: &Cloud, i: usize) -> &LocalShape {
        self.known[i].get_or_init(|| Box::new(local_shape(cloud, i, NEAREST, (&self.noise, self.faces_away))))
    }

    /// Those of some points, computed side by side.
    pub(super) fn of(&self, cloud: &Cloud, points: &[u32]) -> Vec<&LocalShape> {
        threads::map(points.len(), 64, |k| self.at(cloud, points[k] as usize))
    }
}

/// The noise that most neighbourhoods of one width show.
fn noise_at(cloud: &Cloud, width: &Width, tuning: &PartsTuning) -> Noise {
    let [smooth, gaussian] = tuning.smooth;
    // the ratio of the two noises decides little: any start of the right size finds it in two rounds
    let mut noise = Noise { distance: 0.1 * cloud.spacing, normal: 0.05 };
    let asked: Vec<usize> = evenly_among(cloud.len(), ENOUGH_FOR_RANKS).collect();
    for _ in 0..3 {
        let at = |k: usize| local_shape(cloud, asked[k], width.nearest, (&noise, tuning.faces_away)).variance;
        let variances = threads::map(asked.len(), 64, at);
        let quantile = |block: usize| {
            let values: Vec<f64> = variances.iter().map(|v: &[f64; 2]| v[block]).collect();
            let value = statistics::quantile(values, smooth, Rank::Floor).unwrap_or(0.0);
            // Wilson and Hilferty: the quantile of a mean of so many squares
            let share: f64 = 2.0 / (9.0 * width.freedom[block]);
            (value / (1.0 - share + gaussian * share.sqrt()).powi(3)).sqrt()
        };
        noise = Noise { distance: quantile(0).max(ROUNDING), normal: quantile(1).max(ROUNDING) };
    }
    noise
}

fn local_shape(cloud: &Cloud, i: usize, nearest: usize, (noise, faces_away): (&Noise, f64)) -> LocalShape {
    let axes = axes_along(cloud.normals[i]);
    let length = cloud.spacing;
    let near = &cloud.near(i)[..nearest];
    let mut rows: Vec<([f64; 6], f64, usize)> = Vec::with_capacity(3 * near.len() + 3);
    for &j in std::iter::once(&(i as u32)).chain(near) {
        let offset = minus(cloud.points[j as usize], cloud.points[i]);
        let [x, y, z] = axes.map(|axis| dot(axis, offset) / length);
        let [nx, ny, nz] = axes.map(|axis| dot(axis, cloud.normals[j as usize]));
        // what faces away is another wall, or lies beyond an edge
        if nz <= faces_away {
            continue;
        }
        let heavy = length / noise.distance;
        rows.push((
            [heavy, heavy * x, heavy * y, 0.5 * heavy * x * x, heavy * x * y, 0.5 * heavy * y * y],
            heavy * z,
            0,
        ));
        let heavy = nz * nz / noise.normal;
        rows.push(([0.0, heavy, 0.0, heavy * x, heavy * y, 0.0], -heavy * nx / nz, 1));
        rows.push(([0.0, 0.0, heavy, 0.0, heavy * x, heavy * y], -heavy * ny / nz, 1));
    }
    solved(&rows, length, noise).unwrap_or(LocalShape {
        principal: None,
        u_shape_index: f64::INFINITY,
        variance: [f64::MAX; 2],
    })
}

fn solved(rows: &[([f64; 6], f64, usize)], length: f64, noise: &Noise) -> Option<LocalShape> {
    let (mut matrix, mut right) = ([[0.0; 6]; 6], [0.0; 6]);
    for (row, value, _) in rows {
        for a in 0..6 {
            right[a] += row[a] * value;
            (0..=a).for_each(|b| matrix[a][b] += row[a] * row[b]);
        }
    }
    (0..6).for_each(|a| (0..a).for_each(|b| matrix[b][a] = matrix[a][b]));
    let lower = cholesky(&matrix)?;
    let c = solve(&lower, right);
    let covariance = inverse(&lower);
    let (mut sums, mut freedom) = ([0.0; 2], [0.0; 2]);
    for (row, value, block) in rows {
        let residual = value - row.iter().zip(&c).map(|(r, c)| r * c).sum::<f64>();
        sums[*block] += residual * residual;
        freedom[*block] += 1.0 - quadratic(&covariance, row, row);
    }
    let scale = [noise.distance, noise.normal];
    let variance = [0, 1].map(|k| sums[k] / freedom[k].max(1.0) * scale[k] * scale[k]);
    let [_, zx, zy, xx, xy, yy] = c;
    // x, y, z were divided by the length: slopes stay, curvatures are its inverse
    let principal = Derivatives::of_height(zx, zy, xx, xy, yy).principal()?;
    let by = |direction: [f64; 3]| {
        let [x, y, _] = direction;
        [0.0, 0.0, 0.0, x * x, 2.0 * x * y, y * y]
    };
    let (one, two) = (by(principal.direction1), by(principal.direction2));
    let (k1, k2) = (principal.k1, principal.k2);
    let square = (k1 * k1 + k2 * k2).max(f64::MIN_POSITIVE);
    let combined = |p: f64, q: f64| {
        let row: [f64; 6] = std::array::from_fn(|k| p * one[k] + q * two[k]);
        quadratic(&covariance, &row, &row).max(0.0).sqrt()
    };
    let in_s = std::f64::consts::FRAC_2_PI / square;
    Some(LocalShape {
        u_shape_index: combined(in_s * k2, -in_s * k1),
        principal: Some(Principal {
            k1: k1 / length,
            k2: k2 / length,
            difference: principal.difference / length,
            ..principal
        }),
        variance,
    })
}

fn quadratic(matrix: &Square<6>, a: &[f64; 6], b: &[f64; 6]) -> f64 {
    (0..6).map(|i| a[i] * (0..6).map(|j| matrix[i][j] * b[j]).sum::<f64>()).sum()
}
