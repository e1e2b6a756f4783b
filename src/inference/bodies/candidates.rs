//! Where the search of each kind begins: closed forms over all contacts, over small sets of them, and over directions of an axis.
//!
//! ```text
//! sphere without normals    |p|^2 = 2 c . p + (r^2 - |c|^2)                 linear least squares
//! cylinder of a known axis  the same across the axis                        axes: principal ones and an even set of directions
//! with normals              the closed forms of `primitives::starts`, over all contacts and over sets of a few
//! order                     median distance, which half of the contacts may spoil
//! ```
//!
//! Normals that are not given are those of planes through neighbours; they serve here and nowhere else. Sets of a few: M. Fischler and
//! R. Bolles, *Comm. ACM* 24 (1981) 381; the median: P. Rousseeuw, *J. Am. Stat. Assoc.* 79 (1984) 871.

use super::mode::{Candidate, FalseContacts, Mode, fewest, is_possible, offsets};
use super::sample::BodySample;
use super::tuning::Tuning;
use crate::primitives::descent;
use crate::primitives::placed::{PartKind, Primitive};
use crate::primitives::starts::starts;
use palpate_geometry::contact::Contacts;
use palpate_numeric::draws::Lcg;
use palpate_numeric::linalg::small::{Square, cholesky, eigen, solve};
use palpate_numeric::statistics::{kurtosis_about_zero, median};
use palpate_numeric::vector::{Vector, along, axes_along, cross, dot};

/// Whether contacts may be false in the starts that are nearest by each of the three ratings.
const RATED: [FalseContacts; 3] = [FalseContacts::Some, FalseContacts::Some, FalseContacts::None];

/// Members of a small set: as many as a closed form needs, and one or two more.
fn members_of_a_set(kind: PartKind) -> usize {
    match kind {
        PartKind::Plane => 3,
        PartKind::Sphere => 4,
        PartKind::Cylinder => 4,
        PartKind::Cone => 6,
        PartKind::Torus | PartKind::Patch => 8,
        PartKind::Ellipsoid => 12,
    }
}

/// The starts of every kind that are worth a search.
pub(super) fn candidates(sample: &BodySample, tuning: &Tuning) -> Vec<Candidate> {
    let mut all = Vec::new();
    for_each_kind(sample, tuning, |_, starts| all.extend(nearest(starts, sample, tuning)));
    all
}

/// Starts near which a share of the contacts lies that one thing of several has at least. Rings and ellipsoids follow anything.
pub(super) fn of_minorities(sample: &BodySample, tuning: &Tuning) -> Vec<Candidate> {
    let mut all = Vec::new();
    // a set lies on its own plane, so that as many contacts as a thing has at least must be near
    let of_its_own = fewest(sample, tuning).saturating_sub(1) as f64 / sample.len() as f64;
    let least = (tuning.minority * tuning.other_things).max(of_its_own);
    for_each_kind(sample, tuning, |kind, starts| {
        if matches!(kind, PartKind::Torus | PartKind::Ellipsoid) {
            return;
        }
        let mut rated = rated(starts, sample, tuning.log_ratio[0].exp(), |distances| [at(distances, least)]);
        rated.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        let found = rated.into_iter().take(tuning.followed[0]);
        all.extend(found.map(|(_, start)| Candidate {
            start,
            strays: FalseContacts::Some,
            share: least,
            of_own: tuning.minority,
        }));
    });
    all
}

/// The start of a kind that is nearest to all contacts by the mean square.
pub(super) fn nearest_to_all(kind: PartKind, sample: &BodySample, tuning: &Tuning) -> Option<Primitive> {
    let mut of_kind = by_positions(kind, sample, tuning);
    if sample.known_normals() == sample.len() {
        of_kind.extend(closed_forms(kind, sample));
    }
    of_kind.retain(is_possible);
    let rated = rated(of_kind, sample, 0.0, |distances| [distances.iter().map(|d| d * d).sum::<f64>()]);
    rated.into_iter().min_by(|a, b| a.0[0].total_cmp(&b.0[0])).map(|(_, start)| start)
}

/// All starts of every kind.
fn for_each_kind(sample: &BodySample, tuning: &Tuning, mut take: impl FnMut(PartKind, Vec<Primitive>)) {
    let oriented = with_normals(sample, tuning);
    let mut generator = Lcg::new(sample.len() as u64);
    for kind in PartKind::BODIES {
        let mut of_kind = by_positions(kind, sample, tuning);
        if let Some(oriented) = &oriented {
            of_kind.extend(closed_forms(kind, oriented));
            of_kind.extend(of_small_sets(kind, oriented, tuning, &mut generator));
            of_kind.extend(tangent_planes(kind, oriented));
        } else {
            of_kind.extend(of_bare_sets(kind, sample, tuning, &mut generator));
        }
        of_kind.retain(is_possible);
        take(kind, of_kind);
    }
}

/// Starts beside a primitive: moved out and in to the middles of the contacts on either side of it, where these lie on two sheets, and fitted
/// to those whose normals point to either side, as on two walls that face each other.
pub(super) fn on_either_side(found: &Primitive, sample: &BodySample, tuning: &Tuning) -> Vec<Candidate> {
    let distances: Vec<f64> = sample.points.iter().map(|p| found.nearest(*p).0).collect();
    let middle = |side: f64| median(distances.iter().filter(|d| side * **d > 0.0).copied().collect::<Vec<f64>>());
    let sheets = if lie_on_two_sheets(&distances, tuning) { &[1.0, -1.0][..] } else { &[] };
    let moved = sheets.iter().filter_map(|side| Some(beside(found, middle(*side)?))).filter(is_possible);
    let moved = moved.map(|start| Candidate::new(start, FalseContacts::Some, tuning));
    moved.chain(facing(found, sample, tuning)).collect()
}

/// Whether a primitive lies between two sheets, or between walls that face each other.
pub(super) fn is_between(found: &Primitive, sample: &BodySample, tuning: &Tuning) -> bool {
    let distances: Vec<f64> = sample.points.iter().map(|p| found.nearest(*p).0).collect();
    lie_on_two_sheets(&distances, tuning) || by_side_of_normals(found, sample, tuning).is_some()
}

/// Fitted to the contacts whose normals point to one side of a primitive, and to those to the other.
fn facing(found: &Primitive, sample: &BodySample, tuning: &Tuning) -> Vec<Candidate> {
    let about = |own: Vec<usize>| {
        let start = Mode::of_members(found, &own, sample, tuning)?.primitive;
        let share = tuning.surely_own * own.len() as f64 / sample.len() as f64;
        Some(Candidate { start, strays: FalseContacts::Some, share, of_own: tuning.surely_own })
    };
    let sides = by_side_of_normals(found, sample, tuning).into_iter().flatten();
    sides.filter_map(about).filter(|found| is_possible(&found.start)).collect()
}

/// Contacts by the side of a primitive to which their normals point; `None` where those to one are too few to be a thing.
fn by_side_of_normals(found: &Primitive, sample: &BodySample, tuning: &Tuning) -> Option<[Vec<usize>; 2]> {
    let side = |i: usize| Some(dot(sample.normal(i)?, found.nearest(sample.points[i]).1) > 0.0);
    let sides = [true, false].map(|out| (0..sample.len()).filter(|i| side(*i) == Some(out)).collect::<Vec<usize>>());
    let least = tuning.other_things * sample.len() as f64;
    sides.iter().all(|own| own.len() as f64 >= least).then_some(sides)
}

/// Whether distances have a kurtosis near 1, the farthest counted or, since they may be false, not.
fn lie_on_two_sheets(distances: &[f64], tuning: &Tuning) -> bool {
    let mut sizes: Vec<f64> = distances.iter().map(|d| d.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let twice_expected = 2.0 / (1.0 + tuning.false_prior);
    let nearer = &sizes[..((1.0 - twice_expected) * sizes.len() as f64).ceil() as usize];
    kurtosis_about_zero(&sizes).min(kurtosis_about_zero(nearer)) <= tuning.two_peaks
}

/// The parallel surface at a distance.
fn beside(found: &Primitive, by: f64) -> Primitive {
    let [one, two, three] = found.sizes;
    match found.kind {
        PartKind::Plane | PartKind::Patch => Primitive { origin: along(found.origin, by, found.axes[2]), ..*found },
        PartKind::Sphere | PartKind::Cylinder => Primitive { sizes: [one + by, two, three], ..*found },
        PartKind::Cone => Primitive { sizes: [one + by / two.cos(), two, three], ..*found },
        PartKind::Torus => Primitive { sizes: [one, two + by, three], ..*found },
        PartKind::Ellipsoid => Primitive { sizes: found.sizes.map(|a| a + by), ..*found },
    }
}

/// The starts whose distances are least: by quantiles where contacts may be false, by the mean square where none is.
fn nearest(starts: Vec<Primitive>, sample: &BodySample, tuning: &Tuning) -> Vec<Candidate> {
    let rated = rated(starts, sample, 0.0, |distances| {
        [at(distances, tuning.surely_own), at(distances, 0.5), distances.iter().map(|d| d * d).sum::<f64>()]
    });
    let mut taken: Vec<Candidate> = Vec::new();
    for (by, (count, strays)) in tuning.followed.into_iter().zip(RATED).enumerate() {
        let mut order: Vec<&([f64; 3], Primitive)> = rated.iter().collect();
        order.sort_by(|a, b| a.0[by].total_cmp(&b.0[by]));
        let found = order.into_iter().take(count).map(|(_, start)| Candidate::new(*start, strays, tuning));
        for candidate in found {
            if !taken.contains(&candidate) {
                taken.push(candidate);
            }
        }
    }
    taken
}

/// Of distances in ascending order, the one that a share of them has at most.
fn at(distances: &[f64], share: f64) -> f64 {
    let number = ((share * distances.len() as f64) as usize).min(distances.len().saturating_sub(1));
    distances.get(number).copied().unwrap_or(f64::INFINITY)
}

/// Starts with their ratings by the contacts' distances, in ascending order: off the surface, and of normals off its own by a lever of some
/// length.
fn rated<const N: usize>(
    starts: Vec<Primitive>,
    sample: &BodySample,
    lever: f64,
    rates: impl Fn(&[f64]) -> [f64; N],
) -> Vec<([f64; N], Primitive)> {
    let offset = |(d, off): (f64, Option<f64>)| d.hypot(lever * off.map_or(0.0, f64::sqrt));
    let rate = |start: Primitive| {
        let mut distances: Vec<f64> = offsets(&start, sample).into_iter().map(offset).collect();
        distances.sort_unstable_by(f64::total_cmp);
        (rates(&distances), start)
    };
    starts.into_iter().map(rate).filter(|(rates, _)| rates.iter().all(|rate| rate.is_finite())).collect()
}

/// The contacts with given normals, or with those of planes through neighbours; `None` where there are too few for either.
pub(super) fn with_normals(sample: &BodySample, tuning: &Tuning) -> Option<BodySample> {
    if sample.known_normals() > 0 {
        let known: Vec<usize> = (0..sample.len()).filter(|i| sample.normal(*i).is_some()).collect();
        return Some(sample.only(&known));
    }
    if sample.len() < tuning.neighbourly {
        return None;
    }
    let contacts = Contacts::from_points(&sample.points).with_estimated_normals(None).ok()?;
    let normals = (0..contacts.len()).map(|r| contacts.unit_normal(r).unwrap_or([0.0, 0.0, 1.0])).collect();
    Some(BodySample { normals, ..sample.clone() })
}

pub(super) fn closed_forms(kind: PartKind, sample: &BodySample) -> Vec<Primitive> {
    let given = descent::Sample { points: &sample.points, normals: &sample.normals, u_distance: 1.0, u_normal: 1.0 };
    starts(kind, &given).into_iter().map(outside).collect()
}

/// The plane through every contact across its normal: of a small face few sets lie on it alone.
fn tangent_planes(kind: PartKind, oriented: &BodySample) -> Vec<Primitive> {
    let one =
        |(p, n): (&Vector, &Vector)| Primitive { kind, origin: *p, axes: axes_along(*n), sizes: [0.0; 3], side: 1.0 };
    let all = if kind == PartKind::Plane { oriented.points.len() } else { 0 };
    oriented.points.iter().zip(&oriented.normals).take(all).map(one).collect()
}

/// The side is asked of all normals at the end.
fn outside(start: Primitive) -> Primitive {
    Primitive { side: 1.0, ..start }
}

/// Members of a set, each drawn once.
fn drawn(count: usize, among: usize, generator: &mut Lcg) -> Vec<usize> {
    let mut set: Vec<usize> = Vec::with_capacity(count);
    for _ in 0..8 * count {
        let one = ((generator.uniform() * among as f64) as usize).min(among - 1);
        if !set.contains(&one) {
            set.push(one);
        }
        if set.len() == count {
            break;
        }
    }
    set
}

fn of_small_sets(kind: PartKind, sample: &BodySample, tuning: &Tuning, generator: &mut Lcg) -> Vec<Primitive> {
    let count = members_of_a_set(kind);
    if kind == PartKind::Ellipsoid {
        return of_bare_sets(kind, sample, tuning, generator);
    }
    if sample.len() <= count {
        return Vec::new();
    }
    let one = |_| closed_forms(kind, &sample.only(&drawn(count, sample.len(), generator)));
    (0..tuning.starts).flat_map(one).collect()
}

/// Sets of positions alone: planes and spheres have a closed form.
fn of_bare_sets(kind: PartKind, sample: &BodySample, tuning: &Tuning, generator: &mut Lcg) -> Vec<Primitive> {
    let count = members_of_a_set(kind);
    if sample.len() <= count || !matches!(kind, PartKind::Plane | PartKind::Sphere | PartKind::Ellipsoid) {
        return Vec::new();
    }
    let one = |_| by_positions(kind, &sample.only(&drawn(count, sample.len(), generator)), tuning);
    (0..tuning.starts).flat_map(one).collect()
}

/// Closed forms that need no normal.
fn by_positions(kind: PartKind, sample: &BodySample, tuning: &Tuning) -> Vec<Primitive> {
    let made = |origin, axis: Vector, sizes| Primitive { kind, origin, axes: axes_along(axis), sizes, side: 1.0 };
    let (middle, axes, _) = principal(sample);
    match kind {
        PartKind::Plane => vec![made(middle, axes[0], [0.0; 3])],
        PartKind::Sphere => {
            sphere(&sample.points).map(|(c, r)| made(c, [0.0, 0.0, 1.0], [r, 0.0, 0.0])).into_iter().collect()
        }
        PartKind::Cylinder | PartKind::Cone => {
            let across = |axis: Vector| {
                let (centre, radius) = circle(sample, axis)?;
                Some(made(centre, axis, [radius, 0.0, 0.0]))
            };
            axes.into_iter().chain(directions(tuning.directions)).filter_map(across).collect()
        }
        // a ring that lies about the contacts, its tube as wide as they scatter along its axis
        PartKind::Torus => axes
            .into_iter()
            .filter_map(|axis| {
                let (centre, radius) = circle(sample, axis)?;
                let rise = sample.points.iter().map(|p| dot(*p, axis).powi(2)).sum::<f64>() / sample.len() as f64;
                let tube = (2.0 * rise).sqrt().min(0.9 * radius);
                Some(made(centre, axis, [radius, tube, 0.0]))
            })
            .collect(),
        // the ball, and the quadric through the contacts
        PartKind::Ellipsoid => {
            let ball = sphere(&sample.points).map(|(c, r)| Primitive { axes, ..made(c, axes[2], [r; 3]) });
            ball.into_iter().chain(quadric(&sample.points)).collect()
        }
        PartKind::Patch => Vec::new(),
    }
}

/// The ellipsoid of the quadric `p'A p + b'p = 1` by linear least squares; `None` where that is none.
fn quadric(points: &[Vector]) -> Option<Primitive> {
    let (mut matrix, mut right) = ([[0.0; 9]; 9], [0.0; 9]);
    for [x, y, z] in points {
        let row = [x * x, y * y, z * z, 2.0 * y * z, 2.0 * x * z, 2.0 * x * y, *x, *y, *z];
        for i in 0..9 {
            right[i] += row[i];
            (0..9).for_each(|j| matrix[i][j] += row[i] * row[j]);
        }
    }
    let [a, b, c, f, g, h, u, v, w] = solve(&cholesky(&ridged(matrix))?, right);
    let form = [[a, h, g], [h, b, f], [g, f, c]];
    let centre = solve(&cholesky(&form)?, [-0.5 * u, -0.5 * v, -0.5 * w]);
    let value: f64 = 1.0 + (0..3).map(|i| centre[i] * dot(form[i], centre)).sum::<f64>();
    let (values, axes) = eigen(&form);
    let sizes = values.map(|lambda| (value / lambda).sqrt());
    let [first, second, _] = axes;
    let axes = [first, second, cross(first, second)];
    sizes.iter().all(|a| a.is_finite()).then_some(Primitive {
        kind: PartKind::Ellipsoid,
        origin: centre,
        axes,
        sizes,
        side: 1.0,
    })
}

/// Middle, principal axes, the narrowest first, and sums of squares along them.
pub(super) fn principal(sample: &BodySample) -> (Vector, [Vector; 3], [f64; 3]) {
    let count = sample.len() as f64;
    let middle = sample.points.iter().fold([0.0; 3], |sum, p| along(sum, 1.0 / count, *p));
    let mut spread = [[0.0; 3]; 3];
    for p in &sample.points {
        for i in 0..3 {
            (0..3).for_each(|j| spread[i][j] += (p[i] - middle[i]) * (p[j] - middle[j]));
        }
    }
    let (squares, axes) = eigen(&spread);
    (middle, axes, squares)
}

/// Whether contacts lie beside a line.
pub(super) fn spans(sample: &BodySample, tuning: &Tuning) -> bool {
    let [_, across, along] = principal(sample).2;
    across > tuning.row * tuning.row * along
}

/// An even set of directions on the upper half sphere, by the golden angle.
fn directions(count: usize) -> impl Iterator<Item = Vector> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..count).map(move |k| {
        let z = (k as f64 + 0.5) / count as f64;
        let (sin, cos) = (golden * k as f64).sin_cos();
        let across = (1.0 - z * z).sqrt();
        [across * cos, across * sin, z]
    })
}

/// Centre and radius by linear least squares.
fn sphere(points: &[Vector]) -> Option<(Vector, f64)> {
    let (mut matrix, mut right) = ([[0.0; 4]; 4], [0.0; 4]);
    for p in points {
        let row = [2.0 * p[0], 2.0 * p[1], 2.0 * p[2], 1.0];
        let square = dot(*p, *p);
        for i in 0..4 {
            right[i] += row[i] * square;
            (0..4).for_each(|j| matrix[i][j] += row[i] * row[j]);
        }
    }
    let [x, y, z, rest] = solve(&cholesky(&ridged(matrix))?, right);
    let centre = [x, y, z];
    let radius = (rest + dot(centre, centre)).sqrt();
    radius.is_finite().then_some((centre, radius))
}

/// Centre and radius of the circle through the contacts as they look along an axis.
pub(super) fn circle(sample: &BodySample, axis: Vector) -> Option<(Vector, f64)> {
    let [e1, e2, _] = axes_along(axis);
    let (mut matrix, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for p in &sample.points {
        let (u, v) = (dot(*p, e1), dot(*p, e2));
        let row = [2.0 * u, 2.0 * v, 1.0];
        for i in 0..3 {
            right[i] += row[i] * (u * u + v * v);
            (0..3).for_each(|j| matrix[i][j] += row[i] * row[j]);
        }
    }
    let [u, v, rest] = solve(&cholesky(&ridged(matrix))?, right);
    let radius = (rest + u * u + v * v).sqrt();
    radius.is_finite().then(|| (along(e1.map(|e| e * u), v, e2), radius))
}

/// A matrix whose factor rounding does not take away: contacts on a plane leave one direction open.
fn ridged<const N: usize>(mut matrix: Square<N>) -> Square<N> {
    let trace: f64 = (0..N).map(|i| matrix[i][i]).sum();
    (0..N).for_each(|i| matrix[i][i] += 1e-13 * trace);
    matrix
}
