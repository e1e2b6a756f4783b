//! Where the descent of each kind of primitive begins: closed forms from points and normals.
//!
//! ```text
//! sphere    p = c + rho n                                  a regression; rho < 0: seen from inside
//! cylinder  axis: least of sum n n'                         p = c + rho n across it
//! cone      axis: least spread of n                         axis' place: n x (p - c) = 0 across it; a line in (rho, h)
//! torus     axis: every normal meets it, n . m + (p x n) . a = 0, least eigenvector in a      a circle in (rho, h)
//! ```
//!
//! The last is the linear complex of H. Pottmann and T. Randrup, *Rotational and helical surface approximation for reverse
//! engineering*, Computing 60 (1998) 307. A start may be rough; the descent and the evidence decide.

use super::descent::Sample;
use super::placed::{PartKind, Primitive};
use palpate_numeric::linalg::small::{Square, cholesky, eigen, solve};
use palpate_numeric::vector::{Vector, along, axes_along, cross, dot, minus, norm, reject, unit_or_zero};

/// Every start that these points allow for one kind.
pub(crate) fn starts(kind: PartKind, sample: &Sample) -> Vec<Primitive> {
    let means = Means::new(sample);
    let found = match kind {
        PartKind::Plane => plane(sample, &means),
        PartKind::Sphere => sphere(sample, &means),
        PartKind::Cylinder => cylinder(sample, &means),
        PartKind::Cone => cone(sample, &means),
        PartKind::Torus => return torus(sample, &means),
        PartKind::Patch | PartKind::Ellipsoid => None,
    };
    found.into_iter().collect()
}

/// Means of points and normals.
struct Means {
    point: Vector,
    normal: Vector,
}

impl Means {
    fn new(sample: &Sample) -> Means {
        let mean = |vectors: &[Vector]| {
            let sum = vectors.iter().fold([0.0; 3], |sum, v| along(sum, 1.0, *v));
            sum.map(|v| v / vectors.len() as f64)
        };
        Means { point: mean(sample.points), normal: mean(sample.normals) }
    }
}

fn pairs<'a>(sample: &'a Sample) -> impl Iterator<Item = (Vector, Vector)> + 'a {
    sample.points.iter().copied().zip(sample.normals.iter().copied())
}

fn outer(vectors: impl Iterator<Item = Vector>) -> Square<3> {
    let mut sum = [[0.0; 3]; 3];
    for v in vectors {
        for i in 0..3 {
            (0..3).for_each(|j| sum[i][j] += v[i] * v[j]);
        }
    }
    sum
}

/// Origin and axis with sizes; a negative radius is that of a body seen from inside.
fn made(kind: PartKind, origin: Vector, axis: Vector, [one, two]: [f64; 2], side: f64) -> Option<Primitive> {
    let sizes = [one, two, 0.0];
    let axis = unit_or_zero(axis);
    let sound = origin.iter().chain(&axis).chain(&sizes).all(|v| v.is_finite()) && norm(axis) > 0.5;
    sound.then(|| Primitive { kind, origin, axes: axes_along(axis), sizes, side })
}

fn plane(sample: &Sample, means: &Means) -> Option<Primitive> {
    let normal = unit_or_zero(means.normal);
    let (_, axes) = eigen(&outer(sample.points.iter().map(|p| minus(*p, means.point))));
    // points on a line leave the plane to the normals
    let by_points = if dot(axes[0], normal) < 0.0 { axes[0].map(|v| -v) } else { axes[0] };
    let axis = if dot(by_points, normal) > 0.7 { by_points } else { normal };
    made(PartKind::Plane, means.point, axis, [0.0; 2], 1.0)
}

/// The regression `p = c + rho n` over vectors of which some directions may be left out.
fn centre_of(pairs: impl Iterator<Item = (Vector, Vector)>, point: Vector, normal: Vector) -> Option<(Vector, f64)> {
    let (mut pn, mut nn) = (0.0, 0.0);
    for (p, n) in pairs {
        let (p, n) = (minus(p, point), minus(n, normal));
        pn += dot(p, n);
        nn += dot(n, n);
    }
    let rho = pn / nn;
    rho.is_finite().then(|| (along(point, -rho, normal), rho))
}

fn sphere(sample: &Sample, means: &Means) -> Option<Primitive> {
    let (centre, rho) = centre_of(pairs(sample), means.point, means.normal)?;
    made(PartKind::Sphere, centre, [0.0, 0.0, 1.0], [rho.abs(), 0.0], rho.signum())
}

fn cylinder(sample: &Sample, means: &Means) -> Option<Primitive> {
    let (_, axes) = eigen(&outer(sample.normals.iter().copied()));
    let axis = axes[0];
    let across = pairs(sample).map(|(p, n)| (reject(p, axis), reject(n, axis)));
    let (centre, rho) = centre_of(across, reject(means.point, axis), reject(means.normal, axis))?;
    made(PartKind::Cylinder, centre, axis, [rho.abs(), 0.0], rho.signum())
}

fn cone(sample: &Sample, means: &Means) -> Option<Primitive> {
    let (_, axes) = eigen(&outer(sample.normals.iter().map(|n| minus(*n, means.normal))));
    let axis = axes[0];
    let [e1, e2, _] = axes_along(axis);
    // n x (p - c) = 0 in the plane across the axis: n2 c1 - n1 c2 = n2 p1 - n1 p2
    let (mut matrix, mut right) = ([[0.0; 2]; 2], [0.0; 2]);
    for (p, n) in pairs(sample) {
        let row = [dot(n, e2), -dot(n, e1)];
        let value = row[0] * dot(p, e1) + row[1] * dot(p, e2);
        for i in 0..2 {
            right[i] += row[i] * value;
            (0..2).for_each(|j| matrix[i][j] += row[i] * row[j]);
        }
    }
    let [c1, c2] = solve(&cholesky(&matrix)?, right);
    let origin = along(along(axis.map(|a| a * dot(means.point, axis)), c1, e1), c2, e2);
    profile_line(sample, origin, axis)
}

/// The straight profile of a body of revolution.
fn profile_line(sample: &Sample, origin: Vector, axis: Vector) -> Option<Primitive> {
    let count = sample.points.len() as f64;
    let (mut h_mean, mut rho_mean, mut hh, mut hr, mut outwards) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let profile = || {
        pairs(sample).map(|(p, n)| {
            let q = minus(p, origin);
            let radial = reject(q, axis);
            (dot(q, axis), norm(radial), dot(n, unit_or_zero(radial)))
        })
    };
    for (h, rho, out) in profile() {
        h_mean += h / count;
        rho_mean += rho / count;
        outwards += out;
    }
    for (h, rho, _) in profile() {
        hh += (h - h_mean).powi(2);
        hr += (h - h_mean) * (rho - rho_mean);
    }
    let tangent = hr / hh;
    made(PartKind::Cone, along(origin, h_mean, axis), axis, [rho_mean, tangent.atan()], outwards.signum())
}

fn torus(sample: &Sample, means: &Means) -> Vec<Primitive> {
    let Some((origin, axis)) = axis_of_revolution(sample, means) else { return Vec::new() };
    // (rho, h) = c + r (n_rho, n_h): the same regression as the sphere's, in the half plane of the profile
    let flat: Vec<(Vector, Vector)> = pairs(sample)
        .map(|(p, n)| {
            let q = minus(p, origin);
            let radial = reject(q, axis);
            ([norm(radial), dot(q, axis), 0.0], [dot(n, unit_or_zero(radial)), dot(n, axis), 0.0])
        })
        .collect();
    let mean = |pick: fn(&(Vector, Vector)) -> Vector| {
        flat.iter().fold([0.0; 3], |sum, pair| along(sum, 1.0 / flat.len() as f64, pick(pair)))
    };
    let Some((centre, rho)) = centre_of(flat.iter().copied(), mean(|pair| pair.0), mean(|pair| pair.1)) else {
        return Vec::new();
    };
    let place = along(origin, centre[1], axis);
    made(PartKind::Torus, place, axis, [centre[0].abs(), rho.abs()], rho.signum()).into_iter().collect()
}

/// The line that all normals meet.
fn axis_of_revolution(sample: &Sample, means: &Means) -> Option<(Vector, Vector)> {
    let (mut nn, mut nk, mut kk) = ([[0.0; 3]; 3], [[0.0; 3]; 3], [[0.0; 3]; 3]);
    for (p, n) in pairs(sample) {
        let k = cross(minus(p, means.point), n);
        for i in 0..3 {
            for j in 0..3 {
                nn[i][j] += n[i] * n[j];
                nk[i][j] += n[i] * k[j];
                kk[i][j] += k[i] * k[j];
            }
        }
    }
    let trace = nn[0][0] + nn[1][1] + nn[2][2];
    // normals in one plane leave the moment along its normal open, and nothing depends on it
    (0..3).for_each(|i| nn[i][i] += 1e-10 * trace);
    let lower = cholesky(&nn)?;
    let columns: [Vector; 3] = std::array::from_fn(|j| solve(&lower, [nk[0][j], nk[1][j], nk[2][j]]));
    let reduced: Square<3> = std::array::from_fn(|i| {
        std::array::from_fn(|j| kk[i][j] - (0..3).map(|l| nk[l][i] * columns[j][l]).sum::<f64>())
    });
    let (_, vectors) = eigen(&reduced);
    let axis = vectors[0];
    let moment = (0..3).fold([0.0; 3], |sum, j| along(sum, -axis[j], columns[j]));
    Some((along(means.point, 1.0, cross(axis, moment)), axis))
}
