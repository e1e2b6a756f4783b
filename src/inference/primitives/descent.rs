//! Least squares of a primitive through points and normals, by Levenberg's and Marquardt's damping.
//!
//! ```text
//! minimise  sum_i (d(p_i) / u_d)^2 + |n(p_i) - n_i|^2 / u_n^2        4 rows a point, at most 9 unknowns: `normal_equations.rs`
//! ```
//!
//! Rows come from [`Primitive::at`], so a new primitive brings its distance and nothing else. D. W. Marquardt, *J. SIAM*
//! 11 (1963) 431.

use super::normal_equations::{NormalEquations, WeightedContact, rows};
use super::placed::{MOST_UNKNOWNS, Primitive};
use palpate_numeric::levenberg_marquardt::{self, ResidualModel, Settings};
use palpate_numeric::linalg::small::{NotPositiveDefinite, Square, cholesky, inverse, solve};
use palpate_numeric::vector::{Vector, along, dot};

/// Of 40 trials at most: from a start of the right kind six to ten steps are enough.
const SETTINGS: Settings = Settings {
    first: 1e-3,
    most: 1e9,
    fall: |damping| (0.2 * damping).max(1e-12),
    rounding: 0.0,
    steps: usize::MAX,
    trials: 40,
};

/// A step that lowers the sum by less than this share ends a descent to the last digit.
const SETTLED: f64 = 1e-10;

/// The same while kinds are compared and regions grow, where some digits of the sum decide: half of the steps.
/// At 1e-5, a third of them, regions of a scanned box stopped short, and a ring stood beside its bar.
const ROUGHLY_SETTLED: f64 = 1e-7;

/// Points with normals, and how far each is off.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<'a> {
    pub(crate) points: &'a [Vector],
    pub(crate) normals: &'a [Vector],
    /// Standard deviation of a distance.
    pub(crate) u_distance: f64,
    /// Standard deviation of a normal per tangent axis, radians.
    pub(crate) u_normal: f64,
}

/// A primitive at its minimum.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Descended {
    pub(crate) primitive: Primitive,
    /// The sum of squares.
    pub(crate) sum: f64,
    /// The normal matrix, by the unknowns that are free; ones on the diagonal of the others.
    pub(crate) matrix: Square<MOST_UNKNOWNS>,
}

impl Descended {
    /// Covariance of the unknowns; `None` where the points leave one open.
    pub(crate) fn covariance(&self) -> Option<Square<MOST_UNKNOWNS>> {
        let scale: [f64; MOST_UNKNOWNS] = std::array::from_fn(|i| self.matrix[i][i].sqrt().max(f64::MIN_POSITIVE));
        let scaled: Square<MOST_UNKNOWNS> =
            std::array::from_fn(|i| std::array::from_fn(|j| self.matrix[i][j] / (scale[i] * scale[j])));
        let mut covariance = inverse(&cholesky(&scaled)?);
        let free = self.primitive.kind.free();
        for i in 0..MOST_UNKNOWNS {
            for j in 0..MOST_UNKNOWNS {
                let both = free.contains(&i) && free.contains(&j);
                covariance[i][j] = if both { covariance[i][j] / (scale[i] * scale[j]) } else { 0.0 };
            }
        }
        Some(covariance)
    }
}

/// How many of the unknowns the distances determine; the normals determine the rest: the trace of the hat matrix over the rows
/// of distances. `None` where the points leave an unknown open.
pub(crate) fn share_of_distances(found: &Descended, sample: &Sample) -> Option<f64> {
    let covariance = found.covariance()?;
    let free = found.primitive.kind.free();
    let mut matrix = [[0.0; MOST_UNKNOWNS]; MOST_UNKNOWNS];
    for (p, n) in sample.points.iter().zip(sample.normals) {
        let [(_, row), ..] = rows(&found.primitive, *p, *n);
        free.iter().for_each(|&i| free.iter().for_each(|&j| matrix[i][j] += row[i] * row[j]));
    }
    let trace: f64 = free
        .iter()
        .flat_map(|&i| free.iter().map(move |&j| (i, j)))
        .map(|(i, j)| matrix[i][j] * covariance[j][i])
        .sum();
    Some((trace / sample.u_distance.powi(2)).clamp(0.0, free.len() as f64))
}

/// The sum of squares alone.
pub(crate) fn sum_of_squares(primitive: &Primitive, sample: &Sample) -> f64 {
    let one = |(p, n): (&Vector, &Vector)| {
        let (d, normal) = primitive.nearest(*p);
        let off = along(normal, -1.0, *n);
        (d / sample.u_distance).powi(2) + dot(off, off) / sample.u_normal.powi(2)
    };
    sample.points.iter().zip(sample.normals).map(one).sum()
}

/// Normal matrix, gradient and sum of squares at a primitive.
fn reached(primitive: Primitive, sample: &Sample) -> ReachedPrimitive {
    let weights = [sample.u_distance.powi(-2), sample.u_normal.powi(-2)];
    let contacts = sample.points.iter().zip(sample.normals);
    let weighted = contacts.map(|(p, n)| WeightedContact { point: *p, normal: Some(*n), weights });
    let NormalEquations { matrix, gradient, sum } = NormalEquations::new(&primitive, |given, _| given, weighted);
    ReachedPrimitive { at: Descended { primitive, sum, matrix }, gradient }
}

/// Marquardt's step: the diagonal raised by a share, the equations scaled to ones on it.
pub(crate) fn damped_step(
    mut damped: Square<MOST_UNKNOWNS>,
    gradient: &[f64; MOST_UNKNOWNS],
    damping: f64,
) -> Result<[f64; MOST_UNKNOWNS], NotPositiveDefinite> {
    (0..MOST_UNKNOWNS).for_each(|i| damped[i][i] *= 1.0 + damping);
    let scale: [f64; MOST_UNKNOWNS] = std::array::from_fn(|i| damped[i][i].sqrt().max(f64::MIN_POSITIVE));
    let scaled: Square<MOST_UNKNOWNS> =
        std::array::from_fn(|i| std::array::from_fn(|j| damped[i][j] / (scale[i] * scale[j])));
    let lower = cholesky(&scaled).ok_or(NotPositiveDefinite)?;
    let step = solve(&lower, std::array::from_fn(|i| -gradient[i] / scale[i]));
    Ok(std::array::from_fn(|i| step[i] / scale[i]))
}

/// A primitive with its equations.
#[derive(Clone, Copy)]
struct ReachedPrimitive {
    at: Descended,
    gradient: [f64; MOST_UNKNOWNS],
}

/// The four rows of every point, and the equations at the last primitive.
struct PrimitiveRows<'a> {
    sample: &'a Sample<'a>,
    /// About which the primitive is turned.
    centre: Vector,
    here: ReachedPrimitive,
    /// Share of the sum below which a step ends the descent.
    settled: f64,
}

impl ResidualModel for PrimitiveRows<'_> {
    type Point = ReachedPrimitive;
    type Step = [f64; MOST_UNKNOWNS];
    type Error = NotPositiveDefinite;

    fn linearise(&mut self, at: &ReachedPrimitive) -> f64 {
        self.here = *at;
        at.at.sum
    }

    fn solve(&mut self, damping: f64) -> Result<[f64; MOST_UNKNOWNS], NotPositiveDefinite> {
        damped_step(self.here.at.matrix, &self.here.gradient, damping)
    }

    fn moved(&mut self, from: &ReachedPrimitive, step: &[f64; MOST_UNKNOWNS]) -> Option<(ReachedPrimitive, f64)> {
        let next = reached(from.at.primitive.moved(step).about(self.centre), self.sample);
        Some((next, next.at.sum))
    }

    fn gives_up(&self, _: &[f64; MOST_UNKNOWNS], before: f64, after: Option<f64>) -> bool {
        // at the minimum nothing is lower by rounding
        after.is_some_and(|after| after <= before * (1.0 + 1e-12))
    }

    fn is_settled(&mut self, _: &[f64; MOST_UNKNOWNS], before: f64, after: f64) -> bool {
        before - after <= self.settled * before
    }
}

/// Descends from `start` to the last digit; `None` where the points do not determine this kind of primitive.
pub(crate) fn descend(start: &Primitive, sample: &Sample) -> Option<Descended> {
    descend_until(SETTLED, start, sample)
}

/// The same to as many digits as it takes to compare kinds.
pub(crate) fn descend_roughly(start: &Primitive, sample: &Sample) -> Option<Descended> {
    descend_until(ROUGHLY_SETTLED, start, sample)
}

fn descend_until(settled: f64, start: &Primitive, sample: &Sample) -> Option<Descended> {
    let count = sample.points.len() as f64;
    let sum_of = sample.points.iter().fold([0.0; 3], |sum, p| along(sum, 1.0, *p));
    let centre = sum_of.map(|v| v / count);
    let mut found = reached(start.about(centre), sample);
    let mut rows = PrimitiveRows { sample, centre, here: found, settled };
    // a matrix that has no factor under any damping leaves the primitive where it is
    let _ = levenberg_marquardt::descend(&mut rows, &mut found, &mut SETTINGS.first.clone(), &SETTINGS);
    found.at.sum.is_finite().then_some(found.at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::placed::PartKind;
    use palpate_numeric::vector::{axes_along, norm, unit};

    fn primitive(kind: PartKind) -> Primitive {
        let sizes = match kind {
            PartKind::Cone => [2.0, 0.4, 0.0],
            PartKind::Torus => [3.0, 0.8, 0.0],
            PartKind::Ellipsoid => [3.0, 2.0, 1.5],
            _ => [2.0, 0.0, 0.0],
        };
        Primitive { kind, origin: [0.3, -0.2, 0.5], axes: axes_along(unit([1.0, 2.0, -0.5])), sizes, side: -1.0 }
    }

    const PLACES: [Vector; 3] = [[2.1, 0.4, -0.6], [-1.2, 1.9, 2.2], [0.2, -2.4, 1.1]];

    /// Central differences of the residuals by every unknown, through the step that the descent takes.
    #[test]
    fn every_derivative_is_that_of_finite_differences() {
        const STEP_OF_DIFFERENCES: f64 = 1e-6;
        for kind in PartKind::BODIES {
            let at = primitive(kind);
            let normal = unit([0.2, -0.7, 0.4]);
            for place in PLACES {
                let row = rows(&at, place, normal);
                for &unknown in kind.free() {
                    let residual = |sign: f64| {
                        let mut step = [0.0; MOST_UNKNOWNS];
                        step[unknown] = sign * STEP_OF_DIFFERENCES;
                        rows(&at.moved(&step), place, normal).map(|(residual, _)| residual)
                    };
                    let (plus, minus) = (residual(1.0), residual(-1.0));
                    for k in 0..4 {
                        let difference = (plus[k] - minus[k]) / (2.0 * STEP_OF_DIFFERENCES);
                        let error = (difference - row[k].1[unknown]).abs();
                        assert!(
                            error < 1e-7,
                            "{kind:?}, row {k}, unknown {unknown}: {difference} {}",
                            row[k].1[unknown]
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn the_gradient_is_the_normal_and_has_length_one() {
        for kind in PartKind::EXACT {
            let at = primitive(kind);
            for place in PLACES {
                let (_, normal) = at.nearest(place);
                assert!((norm(normal) - 1.0).abs() < 1e-14);
                for k in 0..3 {
                    let along_axis = |sign: f64| {
                        let mut moved = place;
                        moved[k] += sign * 1e-6;
                        at.nearest(moved).0
                    };
                    assert!(((along_axis(1.0) - along_axis(-1.0)) / 2e-6 - normal[k]).abs() < 1e-8, "{kind:?}");
                }
            }
        }
    }

    /// Exact points of a primitive, started a little off, come back to its sizes.
    #[test]
    fn a_descent_finds_the_sizes_that_made_the_points() {
        for kind in PartKind::EXACT {
            let truth = primitive(kind);
            let mut points = Vec::new();
            let mut normals = Vec::new();
            for k in 0..60 {
                let (a, b) = (0.11 * f64::from(k), (0.618 * f64::from(k)).fract() - 0.5);
                let mut place = [4.0 * a.cos(), 4.0 * a.sin(), 3.0 * b];
                // onto the surface along the normal
                for _ in 0..3 {
                    let world = along(truth.origin, 1.0, truth.out(place));
                    let (d, normal) = truth.nearest(world);
                    let on = along(world, -d, normal);
                    place = truth.own(on);
                }
                let world = along(truth.origin, 1.0, truth.out(place));
                points.push(world);
                normals.push(truth.nearest(world).1);
            }
            let sample = Sample { points: &points, normals: &normals, u_distance: 0.01, u_normal: 0.01 };
            let start = truth.moved(&[0.02, -0.03, 0.02, 0.01, -0.02, 0.03, 0.01, 0.0, 0.0]);
            let found = descend(&start, &sample).unwrap();
            assert!(found.sum < 1e-12, "{kind:?}: {}", found.sum);
            if !matches!(kind, PartKind::Plane | PartKind::Cone) {
                assert!((found.primitive.sizes[0] - truth.sizes[0]).abs() < 1e-8, "{kind:?}");
            }
            assert!(kind != PartKind::Cone || (found.primitive.sizes[1] - truth.sizes[1]).abs() < 1e-8);
            assert!(found.covariance().is_some());
        }
    }
}
