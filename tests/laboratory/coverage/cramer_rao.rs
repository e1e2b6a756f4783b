//! How narrow an interval could be: that of a fit which knows the surface's family and the noise.
//!
//! ```text
//! z(x, y; p), n(x, y; p)        p = sizes of the body, three shifts, three rotations
//! F = sum (dz/dp)'(dz/dp)/sd_z^2 + (dn/dp)'(dn/dp)/sd_n^2         Fisher information of all contacts
//! var S = (dS/dp) F^+ (dS/dp)'     R alike                        S and R means over the patch, differences for d/dp
//! ```
//!
//! Parameters that no contact tells apart (a ball has no direction) are left out by the pseudo-inverse. Where the
//! family holds S or R at one value, the oracle knows it: width 0, and no ratio is formed. C. R. Rao, *Bull. Calcutta
//! Math. Soc.* 37 (1945) 81.

use faer::{Mat, Side};

use palpate_numeric::linalg::dot;
use palpate_world::scene::effects::{Kind, NormalNoise, PositionNoise};
use palpate_world::scene::surface::{
    Body, Cylinder, Ellipsoid, GaussianBump, Paraboloid, Saddle, Sphere, Superquadric, Torus,
};
use palpate_world::scene::{Surface, World};

/// Step of the differences, relative to a size and to the patch.
const STEP_OF_DIFFERENCES: f64 = 1e-5;

/// Directions of the parameters that carry less than this share of the information of the others are not known at all.
const UNKNOWN: f64 = 1e-11;

/// Places each way that S and R are averaged over.
pub(super) const PLACES: usize = 8;

/// Number of rigid motions.
const MOTIONS: usize = 6;

/// The member of a family with these sizes; `None` where there is none.
type Member<'a> = Box<dyn Fn(&[f64]) -> Option<Surface> + 'a>;

/// A family of surfaces with the numbers of its true member.
#[expect(missing_debug_implementations, reason = "it holds a closure")]
pub struct Family<'a> {
    /// Sizes of the true member.
    pub(crate) sizes: Vec<f64>,
    /// The member with these sizes; `None` where there is none.
    pub(crate) member: Member<'a>,
}

impl Family<'_> {
    /// The family of a built-in body; `None` of bodies without one.
    pub fn of(surface: &Surface) -> Option<Family<'_>> {
        let sizes = match &surface.body {
            Body::Plane => Vec::new(),
            Body::Sphere(body) => vec![body.radius],
            Body::Cylinder(body) => vec![body.radius],
            Body::Ellipsoid(body) => body.semi_axes.to_vec(),
            Body::Saddle(body) => body.radii.to_vec(),
            Body::Paraboloid(body) => body.radii.to_vec(),
            Body::Torus(body) => vec![body.major, body.minor],
            Body::Gaussian(body) => vec![body.height, body.width],
            Body::Superquadric(body) => body.semi_axes.iter().chain(&body.exponents).copied().collect(),
            _ => return None,
        };
        let member = move |p: &[f64]| {
            let body = match (&surface.body, p) {
                (Body::Plane, _) => Body::Plane,
                (Body::Sphere(_), &[radius]) => Body::Sphere(Sphere { radius }),
                (Body::Cylinder(_), &[radius]) => Body::Cylinder(Cylinder { radius }),
                (Body::Ellipsoid(_), &[a, b, c]) => Body::Ellipsoid(Ellipsoid { semi_axes: [a, b, c] }),
                (Body::Saddle(_), &[a, b]) => Body::Saddle(Saddle { radii: [a, b] }),
                (Body::Paraboloid(_), &[a, b]) => Body::Paraboloid(Paraboloid { radii: [a, b] }),
                (Body::Torus(_), &[major, minor]) => Body::Torus(Torus { major, minor }),
                (Body::Gaussian(_), &[height, width]) => Body::Gaussian(GaussianBump { height, width }),
                (Body::Superquadric(_), &[a, b, c, e, f]) => {
                    Body::Superquadric(Superquadric { semi_axes: [a, b, c], exponents: [e, f] })
                }
                _ => return None,
            };
            Some(Surface { body, ..surface.clone() })
        };
        Some(Family { sizes, member: Box::new(member) })
    }
}

/// Height, normal, S and R over one place.
struct LocalShape {
    z: f64,
    normal: [f64; 3],
    shape: [Option<f64>; 2],
}

/// The surface over (x, y) after a small rigid motion: shift (first three) and rotation.
fn seen(surface: &Surface, motion: [f64; MOTIONS], [x, y]: [f64; 2]) -> Option<LocalShape> {
    let [a, b, c, i, j, k] = motion;
    let moved = |p: [f64; 3]| [a + j * p[2] - k * p[1], b + k * p[0] - i * p[2], c + i * p[1] - j * p[0]];
    let turned = |n: [f64; 3]| [j * n[2] - k * n[1], k * n[0] - i * n[2], i * n[1] - j * n[0]];
    let here = surface.at(x, y)?;
    let step = moved(here.point);
    // the point that the motion brings over (x, y)
    let before = surface.at(x - step[0], y - step[1])?;
    let (lift, turn) = (moved(before.point), turned(before.local.normal));
    Some(LocalShape {
        z: before.point[2] + lift[2],
        normal: [0, 1, 2].map(|d| before.local.normal[d] + turn[d]),
        shape: [before.local.shape_index(), Some(before.local.curvedness())],
    })
}

/// Means of S and R.
fn means(seen: &[LocalShape]) -> [Option<f64>; 2] {
    [0, 1].map(|q| {
        let values: Vec<f64> = seen.iter().filter_map(|s| s.shape[q]).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    })
}

/// Standard deviations of z and of a normal's tangential part that a world names; `None` where there is no such noise.
pub fn noise_of(world: &World) -> [Option<f64>; 2] {
    let z = world.effects.iter().find_map(|effect| match &effect.kind {
        Kind::PositionNoise(PositionNoise::Sigma([_, _, z])) => Some(*z),
        _ => None,
    });
    let normal = world.effects.iter().find_map(|effect| match &effect.kind {
        Kind::NormalNoise(NormalNoise { sigma_deg, .. }) => Some(sigma_deg.to_radians()),
        _ => None,
    });
    [z.filter(|z| *z > 0.0), normal.filter(|n| *n > 0.0)]
}

/// Standard deviations of mean S and mean R over the box of `places`; `None` where the family fixes the value or the
/// arithmetic fails.
pub fn oracle_sd(family: &Family, places: &[[f64; 2]], noise: [Option<f64>; 2]) -> [Option<f64>; 2] {
    found(family, places, noise).unwrap_or([None; 2])
}

fn found(family: &Family, places: &[[f64; 2]], noise: [Option<f64>; 2]) -> Option<[Option<f64>; 2]> {
    let tangent = Tangent::of(family, places, noise)?;
    let known = Known::of(&tangent.columns)?;
    Some([0, 1].map(|q| {
        let variance: f64 = known.coordinates(&tangent.slopes[q]).iter().map(|c| c * c).sum();
        tangent.moves(q).then(|| variance.sqrt())
    }))
}

/// How the contacts, and the means of S and R, answer to the parameters of a family: sizes, then motions.
pub(super) struct Tangent {
    /// By each parameter: derivatives of every height and normal, in their standard deviations.
    pub(super) columns: Vec<Vec<f64>>,
    /// Derivatives of mean S and of mean R.
    pub(super) slopes: [Vec<f64>; 2],
}

impl Tangent {
    /// That of the true member; `None` where a place has no contact or there is no noise of z.
    pub(super) fn of(family: &Family, places: &[[f64; 2]], [sd_z, sd_n]: [Option<f64>; 2]) -> Option<Tangent> {
        let sd_z = sd_z?;
        let grid = lattice(places);
        let mut tangent = Tangent { columns: Vec::new(), slopes: [Vec::new(), Vec::new()] };
        for parameter in 0..family.sizes.len() + MOTIONS {
            let [ahead, behind] = [1.0, -1.0].map(|sign| shifted(family, parameter, sign, places));
            let (ahead, behind) = (ahead?, behind?);
            let mut column = Vec::new();
            for (a, b) in ahead.iter().zip(&behind) {
                column.push((a.z - b.z) / (2.0 * STEP_OF_DIFFERENCES * sd_z));
                if let Some(sd) = sd_n {
                    column.extend((0..3).map(|d| (a.normal[d] - b.normal[d]) / (2.0 * STEP_OF_DIFFERENCES * sd)));
                }
            }
            tangent.columns.push(column);
            let [ahead, behind] = [1.0, -1.0].map(|sign| shifted(family, parameter, sign, &grid).map(|s| means(&s)));
            let (ahead, behind) = (ahead?, behind?);
            for (q, slopes) in tangent.slopes.iter_mut().enumerate() {
                slopes.push((ahead[q].unwrap_or(0.0) - behind[q].unwrap_or(0.0)) / (2.0 * STEP_OF_DIFFERENCES));
            }
        }
        Some(tangent)
    }

    /// Whether S (0) or R (1) differs between members: what differences of equal values leave is rounding.
    pub(super) fn moves(&self, q: usize) -> bool {
        self.slopes[q].iter().any(|s| s.abs() > 1e-7)
    }
}

/// The directions of the parameters that contacts tell, each scaled to one unit of information.
pub(super) struct Known {
    axes: Vec<Vec<f64>>,
}

impl Known {
    /// From the columns of a tangent; `None` where the arithmetic fails.
    pub(super) fn of(columns: &[Vec<f64>]) -> Option<Known> {
        let count = columns.len();
        let sizes: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt().max(1e-100)).collect();
        let information = Mat::from_fn(count, count, |i, j| dot(&columns[i], &columns[j]) / (sizes[i] * sizes[j]));
        let eigen = information.self_adjoint_eigen(Side::Lower).ok()?;
        let known = (0..count).filter(|&k| eigen.S()[k] > UNKNOWN * eigen.S()[count - 1]);
        let axis = |k: usize| (0..count).map(|i| eigen.U()[(i, k)] / (sizes[i] * eigen.S()[k].sqrt())).collect();
        Some(Known { axes: known.map(axis).collect() })
    }

    /// Coordinates c with `c(a) . c(b) = a' F^+ b`.
    pub(super) fn coordinates(&self, right: &[f64]) -> Vec<f64> {
        self.axes.iter().map(|axis| dot(axis, right)).collect()
    }
}

/// The surface over all places with one parameter moved by a step.
fn shifted(family: &Family, parameter: usize, sign: f64, places: &[[f64; 2]]) -> Option<Vec<LocalShape>> {
    let mut sizes = family.sizes.clone();
    let mut motion = [0.0; MOTIONS];
    match sizes.get_mut(parameter) {
        Some(size) => *size += sign * STEP_OF_DIFFERENCES,
        None => motion[parameter - family.sizes.len()] = sign * STEP_OF_DIFFERENCES,
    }
    let surface = (family.member)(&sizes)?;
    places.iter().map(|p| seen(&surface, motion, *p)).collect()
}

/// The box of the places: its ends along x and along y.
pub(super) fn ends(places: &[[f64; 2]]) -> [[f64; 2]; 2] {
    [0, 1].map(|d| {
        places.iter().map(|p| p[d]).fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)])
    })
}

/// An even lattice over the box of the places.
pub(super) fn lattice(places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let at = |[lo, hi]: [f64; 2], i: usize| lo + (hi - lo) * i as f64 / (PLACES - 1) as f64;
    let [x, y] = ends(places);
    (0..PLACES * PLACES).map(|i| [at(x, i / PLACES), at(y, i % PLACES)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places() -> Vec<[f64; 2]> {
        (0..36).map(|i| [(i % 6) as f64 - 2.5, (i / 6) as f64 - 2.5]).collect()
    }

    #[test]
    fn a_family_that_fixes_s_leaves_only_r_and_noise_scales_it() {
        for body in [Body::Sphere(Sphere { radius: 10.0 }), Body::Cylinder(Cylinder { radius: 10.0 })] {
            let surface = Surface::new(body, 30.0);
            let family = Family::of(&surface).unwrap();
            let of = |z: f64, n: f64| oracle_sd(&family, &places(), [Some(z), Some(n)]);
            let (one, ten) = (of(0.01, 0.02), of(0.1, 0.2));
            assert_eq!(one[0], None);
            assert!((ten[1].unwrap() / one[1].unwrap() - 10.0).abs() < 1e-3 && one[1].unwrap() < 0.002);
        }
    }

    #[test]
    fn the_radius_of_a_sphere_from_heights_alone_has_the_published_precision() {
        // z = z0 + a x + b y - (x^2 + y^2)/(2 r) for a large r: linear least squares in 1/r
        let surface = Surface::new(Body::Sphere(Sphere { radius: 1000.0 }), 0.0);
        let found = oracle_sd(&Family::of(&surface).unwrap(), &places(), [Some(0.01), None])[1].unwrap();
        let squares: Vec<f64> = places().iter().map(|[x, y]| 0.5 * (x * x + y * y)).collect();
        let mean = squares.iter().sum::<f64>() / 36.0;
        let sd = 0.01 / squares.iter().map(|q| (q - mean) * (q - mean)).sum::<f64>().sqrt();
        assert!((found / sd - 1.0).abs() < 0.01, "{found} {sd}");
    }
}
