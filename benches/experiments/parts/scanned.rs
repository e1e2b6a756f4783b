//! Scans with errors in units of their own spacing, and mixed pixels as depth cameras make them.
//!
//! ```text
//! spacing = sqrt(area / contacts), found by a coarse scan        p <- p + level spacing g,  n <- turned by sd(level)
//! mixed pixel     p = p_i + w (p_j - p_i)        i, j next to each other in the image, of two faces or far behind each other
//!                 p = p_i + w d                  at the outline, d: away from the camera
//! ```

use palpate::Contacts;
use palpate::scene::{Surface, Sweep, World};
use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::{Vector, along, axes_along, dot, minus, norm, scaled, unit};

use super::bodies::{Form, Random};

/// Share of a scan that is mixed pixels.
const MIXED: f64 = 0.05;

/// How far behind the outline a mixed pixel may lie, in spacings.
const BEHIND: f64 = 6.0;

/// Distance of a camera; bodies reach 20.
const AWAY: f64 = 90.0;

/// How a body is scanned.
#[derive(Clone, Copy)]
pub(crate) struct Scan {
    pub(crate) contacts: f64,
    /// Noise of places in spacings.
    pub(crate) level: f64,
    /// Noise of normals, degrees; `None`: there are none.
    pub(crate) normals_deg: Option<f64>,
    /// From one side, or from all.
    pub(crate) from_one_side: bool,
    /// Whether there are mixed pixels.
    pub(crate) mixed: bool,
}

/// What the scanner gives, and what is true of it.
pub(crate) struct Scanned {
    pub(crate) contacts: Contacts,
    /// The face of every contact; of a mixed pixel the number of faces.
    pub(crate) faces: Vec<usize>,
    pub(crate) eye: Option<Vector>,
}

/// A scan of the body, drawn from `seed`.
pub(crate) fn scanned(form: &Form, scan: &Scan, seed: u64) -> Scanned {
    let mut random = Random(seed.wrapping_mul(613));
    let mut direction = || unit([0, 1, 2].map(|_| random.between(-1.0, 1.0)));
    let eye = scan.from_one_side.then(|| scaled(AWAY, direction()));
    let cameras: Vec<Vector> = eye.map_or_else(|| (0..4).map(|_| scaled(AWAY, direction())).collect(), |eye| vec![eye]);
    let mut r = |lo: f64, hi: f64| random.between(lo, hi);
    let rotation = [r(-180.0, 180.0), r(-80.0, 80.0), r(-180.0, 180.0)];
    let at = |spacing: f64| {
        let surface = Surface::solids(form.solids.clone()).posed(0.0, rotation, [0.0; 3]);
        let (contacts, truth) =
            World::new(surface, Sweep::scan(spacing, eye)).compile().expect("the body is sound").simulate(seed, 0);
        (contacts, truth.faces().expect("solids have faces"))
    };
    let coarse = 0.7;
    let spacing = coarse * (at(coarse).0.len() as f64 / scan.contacts).sqrt();
    let (contacts, mut faces) = at(spacing);
    let place = |i: usize| [contacts.x[i], contacts.y[i], contacts.z[i]];
    let mut points: Vec<Vector> = (0..contacts.len()).map(place).collect();
    let mut normals: Vec<Vector> = (0..contacts.len()).filter_map(|i| contacts.unit_normal(i)).collect();
    if scan.mixed {
        add_mixed(&mut points, &mut normals, &mut faces, (form.faces.len(), spacing), &cameras, &mut random);
    }
    let draws = EffectDraws::new(seed, "scanned");
    blur(&mut points, &mut normals, scan, spacing, &draws);
    let contacts = Contacts::from_points(&points);
    let contacts = if scan.normals_deg.is_some() { contacts.with_normal_vectors(&normals) } else { contacts };
    Scanned { contacts, faces, eye }
}

fn blur(points: &mut [Vector], normals: &mut [Vector], scan: &Scan, spacing: f64, draws: &EffectDraws) {
    let turn = scan.normals_deg.unwrap_or(0.0).to_radians();
    for (k, (p, n)) in points.iter_mut().zip(normals).enumerate() {
        let mut g = [0.0; 6];
        draws.gaussians(k as u64, 0, 6, &mut g);
        *p = [0, 1, 2].map(|a| p[a] + scan.level * spacing * g[a]);
        let [u, v, _] = axes_along(*n);
        *n = unit(along(along(*n, turn * g[3], u), turn * g[4], v));
    }
}

/// Mixed pixels of every camera, behind the contacts; their face is `none`.
fn add_mixed(
    points: &mut Vec<Vector>,
    normals: &mut Vec<Vector>,
    faces: &mut Vec<usize>,
    (none, spacing): (usize, f64),
    cameras: &[Vector],
    random: &mut Random,
) {
    let wanted = (MIXED / (1.0 - MIXED) * points.len() as f64).round() as usize;
    let mut found = Vec::new();
    for camera in cameras {
        found.extend(edges(points, normals, faces, spacing, *camera));
    }
    for _ in 0..wanted.min(8 * found.len()) {
        let (i, j, ray) = found[random.between(0.0, found.len() as f64) as usize];
        let w = random.between(0.1, 0.9);
        let (towards, normal) = match j {
            Some(j) => (minus(points[j], points[i]), along(scaled(1.0 - w, normals[i]), w, normals[j])),
            None => (scaled(BEHIND * spacing, ray), normals[i]),
        };
        points.push(along(points[i], w, towards));
        normals.push(if norm(normal) > 1e-3 { unit(normal) } else { normals[i] });
        faces.push(none);
    }
}

/// Contacts that a camera sees next to another face or next to nothing: the other contact, if any, and the ray.
fn edges(
    points: &[Vector],
    normals: &[Vector],
    faces: &[usize],
    spacing: f64,
    camera: Vector,
) -> Vec<(usize, Option<usize>, Vector)> {
    let seen: Vec<usize> =
        (0..points.len()).filter(|i| dot(normals[*i], minus(camera, points[*i])) > 0.1 * AWAY).collect();
    let [right, up, _] = axes_along(unit(camera));
    let image: Vec<Vector> = seen.iter().map(|i| [dot(points[*i], right), dot(points[*i], up), 0.0]).collect();
    if image.len() < 10 {
        return Vec::new();
    }
    let tree = Neighbours::new(&image);
    let mut found = Vec::new();
    for (k, &i) in seen.iter().enumerate() {
        let near = tree.nearest(image[k], 9);
        let ray = unit(minus(points[i], camera));
        let other = near.iter().map(|(_, n)| seen[*n as usize]).find(|j| faces[*j] != faces[i]);
        let middle =
            near.iter().fold([0.0; 3], |sum, (_, n)| along(sum, 1.0 / 9.0, minus(image[*n as usize], image[k])));
        if other.is_some() {
            found.push((i, other, ray));
        } else if norm(middle) > 0.5 * spacing {
            found.push((i, None, ray));
        }
    }
    found
}
