//! Each part fitted to all its inner points, with the noise that they show, uncertainties, and whether the data reject it.
//!
//! ```text
//! u_d^2 = sum d^2 / (n - t),  u_n^2 = sum |n - n_i|^2 / (2 n - unknowns + t)       t = trace of the distances' hat matrix
//! covariance = C_jk sqrt(f_j f_k)          C = (J' W J)^-1,  f_k = variance of sum_i h_ik over cells / variance of independent ones
//!              h_i = C J_i' W r_i          what contact i moves the unknowns by; f_k = 1 unless neighbours share errors
//! F = (between / (cells - t)) / (within / (points - cells))
//!     between = sum_c n_c mean_c(d)^2,  within = sum_c sum_i (d_i - mean_c)^2          cells of some 12 neighbouring points
//! ```
//!
//! Neither u is less than what the step of written numbers leaves, of which those that are rounded alike count as one.
//! Normals of planes through neighbours tell nothing beside the places that they are from: where none were measured, distances are all.
//!
//! Points of one cell are near-replicates: whatever the true surface is, it hardly varies within a cell, so that the scatter
//! there is noise and the means beyond noise are lack of fit. A scanner's error that neighbours share is lack of fit, too, and
//! the parameters are then as uncertain as so few independent errors leave them. The half angle of a pipe is told by its
//! normals, and errors that these share count for it however independent the distances are. N. R. Draper and H. Smith, *Applied
//! Regression Analysis*, section 2.1; the covariance is that of K.-Y. Liang and S. L. Zeger, *Biometrika* 73 (1986) 13.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::cloud::{Cloud, LINKED};
use super::covariance_of_unknowns::covariance_of_unknowns;
use super::evidence::Cells;
use super::hypothesis::sampled;
use super::local::{Noise, ROUNDING};
use super::neighbour_products::Weighted;
use super::partition::{exact, explained};
use super::tuning::PartsTuning;
use crate::primitives::descent::{Descended, Sample, share_of_distances};
use crate::primitives::placed::{MOST_UNKNOWNS, PartKind, Primitive};
use palpate_numeric::linalg::small::Square;
use palpate_numeric::statistics::VarianceComponent;
use palpate_numeric::vector::{along, axes_along, dot, minus};

/// Points of a cell besides its first.
const CELL: usize = 11;

/// Whether two noises differ by so little that a fit is the same.
fn is_settled(a: &Noise, b: &Noise) -> bool {
    // of no normals both are infinite
    let same = |a: f64, b: f64| a == b || (a / b - 1.0).abs() < 1e-4;
    same(a.distance, b.distance) && same(a.normal, b.normal)
}

/// A part's primitive at the end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exact {
    pub(super) descended: Descended,
    /// The noise that its inner points show.
    pub(super) noise: Noise,
    /// Probability of so large a lack of fit by chance; `None` with too few cells.
    pub(super) p: Option<f64>,
    /// Root mean square of what noise does not explain, along the normal.
    pub(super) departure: f64,
    /// Covariance of the unknowns, with what neighbours share; `None` where the points leave one open.
    covariance: Option<Square<MOST_UNKNOWNS>>,
}

impl Exact {
    /// Covariance of the unknowns; `None` where the points leave one open.
    pub(super) fn covariance(&self) -> Option<Square<MOST_UNKNOWNS>> {
        self.covariance
    }

    /// Whether this is a cone whose half angle may as well be zero.
    fn may_be_cylinder(&self, tuning: &PartsTuning) -> bool {
        let angle = self.descended.primitive.sizes[1];
        let is_cone = self.descended.primitive.kind == PartKind::Cone;
        let squares = tuning.clear_u.powi(2);
        is_cone && self.covariance().is_none_or(|covariance| angle.powi(2) < squares * covariance[6][6])
    }

    /// Whether this is a ball or bar that may as well be flat: 1/r has the uncertainty u_r / r^2.
    fn may_be_plane(&self, tuning: &PartsTuning) -> bool {
        let Primitive { kind, sizes, .. } = self.descended.primitive;
        let is_round = matches!(kind, PartKind::Sphere | PartKind::Cylinder);
        let squares = tuning.clear_u.powi(2);
        is_round && self.covariance().is_some_and(|covariance| sizes[0].powi(2) < squares * covariance[5][5])
    }
}

/// The noise that a fit begins with.
pub(super) struct StartNoise<'a> {
    /// What most places show, with what is let pass.
    pub(super) coarse: Noise,
    /// Whether the start is a fit already, so that the noise is what its contacts scatter by: contacts that lie far apart show a coarse
    /// one that leads away from it.
    pub(super) is_known: bool,
    /// Whether normals are measurements.
    pub(super) measured: bool,
    /// What places are off by along the surface, where that turns their normals.
    pub(super) along: f64,
    pub(super) tuning: &'a PartsTuning,
}

/// What the contacts of a primitive scatter by, its unknowns not counted.
fn scatter_about(cloud: &Cloud, inner: &[u32], primitive: &Primitive) -> Noise {
    let [distances, normals] = squares_about(cloud, inner, primitive);
    let sd = |squares: f64| (squares / inner.len().max(1) as f64).sqrt().max(ROUNDING);
    Noise { distance: sd(distances), normal: sd(0.5 * normals) }
}

/// Sums of squares of distances from a primitive, and of what normals differ by from its own.
fn squares_about(cloud: &Cloud, inner: &[u32], primitive: &Primitive) -> [f64; 2] {
    inner.iter().fold([0.0; 2], |[distances, normals], &i| {
        let (d, normal) = primitive.nearest(cloud.points[i as usize]);
        let off = minus(normal, cloud.normals[i as usize]);
        [distances + d * d, normals + dot(off, off)]
    })
}

/// The simplest primitive of the part: a cone whose half angle's interval holds zero is a cylinder, and a ball or bar whose curvature's does
/// is a plane.
pub(super) fn simplest(
    cloud: &Cloud,
    inner: &[u32],
    start: &Primitive,
    noise: &StartNoise,
    cells: &Cells,
) -> Option<Exact> {
    let mut found = fitted(cloud, inner, start, noise, cells)?;
    if found.may_be_cylinder(noise.tuning) {
        let cone = found.descended.primitive;
        let cylinder = Primitive { kind: PartKind::Cylinder, sizes: [cone.sizes[0].abs(), 0.0, 0.0], ..cone };
        found = fitted(cloud, inner, &cylinder, noise, cells).unwrap_or(found);
    }
    if found.may_be_plane(noise.tuning) {
        let plane = tangent_plane(cloud, inner, &found.descended.primitive);
        found = fitted(cloud, inner, &plane, noise, cells).unwrap_or(found);
    }
    Some(found)
}

/// The plane that touches a primitive beside the middle of its points.
fn tangent_plane(cloud: &Cloud, inner: &[u32], primitive: &Primitive) -> Primitive {
    let share = 1.0 / inner.len().max(1) as f64;
    let origin = inner.iter().fold([0.0; 3], |sum, &i| along(sum, share, cloud.points[i as usize]));
    let axes = axes_along(primitive.nearest(origin).1);
    Primitive { kind: PartKind::Plane, origin, axes, sizes: [0.0; 3], side: 1.0 }
}

/// Fits until the noise has settled, to the points that the primitive explains.
fn fitted(cloud: &Cloud, inner: &[u32], start: &Primitive, begin: &StartNoise, cells: &Cells) -> Option<Exact> {
    let (coarse, tuning) = (&begin.coarse, begin.tuning);
    let told = |noise: Noise| if begin.measured { noise } else { Noise { normal: f64::INFINITY, ..noise } };
    let floor = cloud.rounding_among(inner);
    let mut noise = told(if begin.is_known { scatter_about(cloud, inner, start) } else { *coarse });
    let mut kept = explained(cloud, inner, start, coarse, begin.along, tuning);
    let mut descended = exact(cloud, &kept, start, &noise, tuning)?;
    for _ in 0..4 {
        kept = explained(cloud, inner, &descended.primitive, coarse, begin.along, tuning);
        let next = told(noise_of(cloud, &kept, &descended, &noise));
        let settled = is_settled(&next, &noise);
        noise = next;
        descended = exact(cloud, &kept, &descended.primitive, &noise.at_least(&floor), tuning)?;
        if settled {
            break;
        }
    }
    let (inner, weighed) = (&kept, noise.at_least(&floor));
    let share = share(cloud, inner, &descended, &weighed);
    let least = if weighed.distance > noise.distance { weighed.distance.powi(2) } else { 0.0 };
    let (p, departure) = lack_of_fit(cloud, inner, &descended.primitive, (share, least));
    let fit = Weighted { primitive: &descended.primitive, noise: &weighed, tuning };
    let covariance =
        descended.covariance().map(|independent| covariance_of_unknowns(cloud, inner, &fit, &independent, cells));
    Some(Exact { descended, noise, p, departure, covariance })
}

/// The unknowns that the distances determine.
fn share(cloud: &Cloud, inner: &[u32], descended: &Descended, noise: &Noise) -> f64 {
    let (points, normals) = sampled(cloud, inner, usize::MAX);
    let sample = Sample { points: &points, normals: &normals, u_distance: noise.distance, u_normal: noise.normal };
    share_of_distances(descended, &sample).unwrap_or(descended.primitive.kind.free().len() as f64)
}

/// Two variance components; the unknowns are shared out as the rows determine them under the noise `before`.
fn noise_of(cloud: &Cloud, inner: &[u32], descended: &Descended, before: &Noise) -> Noise {
    let primitive = &descended.primitive;
    let [distances, normals] = squares_about(cloud, inner, primitive);
    let unknowns = primitive.kind.free().len() as f64;
    let count = inner.len() as f64;
    let share = share(cloud, inner, descended, before);
    let of_distances = VarianceComponent { squares: distances, rows: count, trace: share };
    // a normal has two rows, the third is along the normal itself; they determine the unknowns that distances leave
    let of_normals = VarianceComponent { squares: normals, rows: 2.0 * count - unknowns, trace: -share };
    Noise {
        distance: of_distances.sd_of_one_at_least().max(ROUNDING),
        normal: of_normals.sd_of_one_at_least().max(ROUNDING),
    }
}

/// The probability of F, and the departure. `least` is the variance that contacts which are rounded alike share in any case.
fn lack_of_fit(cloud: &Cloud, inner: &[u32], primitive: &Primitive, (share, least): (f64, f64)) -> (Option<f64>, f64) {
    let distance = |i: u32| primitive.nearest(cloud.points[i as usize]).0;
    let (mut between, mut within, mut cells, mut points) = (0.0, 0.0, 0.0, 0.0);
    for cell in cells_of(cloud, inner) {
        let values: Vec<f64> = cell.iter().map(|&i| distance(i)).collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        between += count * mean * mean;
        within += values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        cells += 1.0;
        points += count;
    }
    let (upper, lower) = (cells - share, points - cells);
    if upper < 3.0 || lower < 3.0 {
        return (None, 0.0);
    }
    let (mean_between, mean_within) = (between / upper, (within / lower).max(least));
    if mean_within.sqrt() <= ROUNDING {
        // no noise at all: whatever is left is rounding, or a misfit that needs no statistics
        let rejected = mean_between.sqrt() > 100.0 * ROUNDING;
        return (Some(if rejected { 0.0 } else { 1.0 }), (between / points).sqrt());
    }
    let p = FisherSnedecor::new(upper, lower).map(|law| law.sf(mean_between / mean_within)).ok();
    (p.filter(|p| p.is_finite()), ((between - upper * mean_within).max(0.0) / points).sqrt())
}

/// Neighbouring points in cells, every inner point in one; cells of fewer than 4 are left out.
fn cells_of(cloud: &Cloud, inner: &[u32]) -> Vec<Vec<u32>> {
    let mut free = vec![false; cloud.len()];
    inner.iter().for_each(|&i| free[i as usize] = true);
    let mut cells = Vec::new();
    // along the axes the walk is even, whatever the order of the file
    for &first in inner {
        if !free[first as usize] {
            continue;
        }
        free[first as usize] = false;
        let mut cell = vec![first];
        for &j in cloud.near(first as usize).iter().take(LINKED + CELL) {
            if free[j as usize] && cell.len() <= CELL {
                free[j as usize] = false;
                cell.push(j);
            }
        }
        if cell.len() >= 4 {
            cells.push(cell);
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::hypothesis::{descended, extent};
    use palpate_numeric::draws::EffectDraws;

    /// Contacts each way, contacts of a side of the squares that share an error, and radius at the middle in spacings.
    const SIDE: u32 = 30;
    const SQUARE: u32 = 6;
    const RADIUS: f64 = 12.0;

    /// A body that widens by this angle, touched over 140 degrees of its round: places are off by 0.3, so that normals tell the
    /// angle; every normal is off by 0.01, and those of a square lean together by `shared` along the axis.
    fn touched(half_angle: f64, shared: f64) -> Cloud {
        let draws = EffectDraws::new(5, "exact");
        let contact = |k: u32| {
            let [i, j] = [k % SIDE, k / SIDE];
            let (mut own, mut common) = ([0.0; 4], [0.0; 1]);
            draws.gaussians(1, u64::from(k), 4, &mut own);
            draws.gaussians(2, u64::from(i / SQUARE + SIDE * (j / SQUARE)), 1, &mut common);
            let turn = 140_f64.to_radians() * (f64::from(i) / f64::from(SIDE - 1) - 0.5);
            let along = f64::from(j) - 0.5 * f64::from(SIDE - 1);
            let radius = RADIUS + along * half_angle.tan() + 0.3 * own[0];
            let lean = half_angle.tan() + shared * common[0];
            let normal = [turn.sin() + 0.01 * own[1], 0.01 * own[2] - lean, turn.cos() + 0.01 * own[3]];
            ([radius * turn.sin(), along, radius * turn.cos()], palpate_numeric::vector::unit(normal))
        };
        let (points, normals): (Vec<_>, Vec<_>) = (0..SIDE * SIDE).map(contact).unzip();
        Cloud::new(&points, normals).unwrap()
    }

    fn found(cloud: &Cloud, simple: bool) -> Exact {
        let members: Vec<u32> = (0..cloud.len() as u32).collect();
        let (points, normals) = sampled(cloud, &members, usize::MAX);
        let sample = Sample { points: &points, normals: &normals, u_distance: 0.002, u_normal: 0.02 };
        let (coarse, tuning) = (Noise { distance: 0.1, normal: 0.3 }, PartsTuning::default());
        let cone = descended(PartKind::Cone, &sample, &[], extent(&points), &tuning).unwrap().primitive;
        let begin = StartNoise { coarse, is_known: false, measured: true, along: 0.0, tuning: &tuning };
        let fit = if simple { simplest } else { fitted };
        fit(cloud, &members, &cone, &begin, &Cells::new(cloud, &tuning)).unwrap()
    }

    #[test]
    fn a_cone_whose_half_angle_may_be_zero_is_a_cylinder() {
        let kind = |cloud: &Cloud| found(cloud, true).descended.primitive.kind;
        assert_eq!(kind(&touched(0.0, 0.0)), PartKind::Cylinder);
        assert_eq!(kind(&touched(0.1, 0.0)), PartKind::Cone);
        assert_eq!(kind(&touched(0.0, 0.03)), PartKind::Cylinder);
    }

    /// The kind of a cap of this radius, begun as a ball.
    fn kind_of_cap(radius: f64) -> PartKind {
        let draws = EffectDraws::new(11, "nearly flat");
        let contact = |k: u32| {
            let [x, y] = [k % SIDE, k / SIDE].map(|i| f64::from(i) - 0.5 * f64::from(SIDE - 1));
            let mut error = [0.0; 3];
            draws.gaussians(1, u64::from(k), 3, &mut error);
            let place = [x, y, -(x * x + y * y) / (2.0 * radius) + error[0]];
            let slopes = [x / radius + 0.3 * error[1], y / radius + 0.3 * error[2]];
            (place, palpate_numeric::vector::unit([slopes[0], slopes[1], 1.0]))
        };
        let (points, normals): (Vec<_>, Vec<_>) = (0..SIDE * SIDE).map(contact).unzip();
        let cloud = Cloud::new(&points, normals).unwrap();
        let members: Vec<u32> = (0..cloud.len() as u32).collect();
        let (points, normals) = sampled(&cloud, &members, usize::MAX);
        let sample = Sample { points: &points, normals: &normals, u_distance: 0.1, u_normal: 0.3 };
        let (coarse, tuning) = (Noise { distance: 0.3, normal: 0.9 }, PartsTuning::default());
        let ball = descended(PartKind::Sphere, &sample, &[], extent(&points), &tuning).unwrap().primitive;
        let begin = StartNoise { coarse, is_known: false, measured: true, along: 0.0, tuning: &tuning };
        let cells = Cells::new(&cloud, &tuning);
        simplest(&cloud, &members, &ball, &begin, &cells).unwrap().descended.primitive.kind
    }

    #[test]
    fn a_ball_whose_curvature_may_be_zero_is_a_plane() {
        assert_eq!([kind_of_cap(200.0), kind_of_cap(1e6)], [PartKind::Sphere, PartKind::Plane]);
    }

    /// Planes through 13 neighbours lean at the rims of half a cone; with these as measurements its half angle was off by three u and more.
    #[test]
    fn normals_that_were_computed_from_places_tell_nothing_beside_them() {
        use crate::parts::{Parts, PartsOptions};
        use palpate_geometry::contact::Contacts;
        let half_angle = 20_f64.to_radians();
        let off = |seed: u64| {
            let draws = EffectDraws::new(seed, "half cone");
            let place = |k: u64| {
                let (mut at, mut error) = ([0.0; 2], [0.0]);
                draws.uniforms(k, 0, 2, &mut at);
                draws.gaussians(1, k, 1, &mut error);
                let (sin, cos) = (std::f64::consts::PI * at[0]).sin_cos();
                let radius = 1.0 - 2.0 * at[1] * half_angle.tan() + 0.005 * error[0];
                [radius * cos, -radius * sin, 2.0 * at[1]]
            };
            let points: Vec<_> = (0..400).map(place).collect();
            let part = Parts::of(&Contacts::from_points(&points), &PartsOptions::default()).unwrap().parts.remove(0);
            assert_eq!((part.kind, part.points > 380), (PartKind::Cone, true), "{part:?}");
            (part.geometry.half_angle_deg.unwrap() - 20.0) / part.u.half_angle_deg.unwrap()
        };
        let off: Vec<f64> = (1..=4).map(off).collect();
        assert!(off.iter().all(|off| off.abs() < 3.0), "{off:?}");
    }

    /// Independent errors of normals turn a half angle by 0.0003, those of 25 squares by up to 0.03/5.
    #[test]
    fn errors_that_neighbours_share_widen_what_they_turn() {
        let sd = |shared: f64| found(&touched(0.2, shared), false).covariance().unwrap()[6][6].sqrt();
        let [alone, together] = [sd(0.0), sd(0.03)];
        assert!(alone < 0.001, "{alone}");
        assert!(together > 4.0 * alone && together < 0.02, "{alone} {together}");
    }
}
