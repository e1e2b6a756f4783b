//! Whole and partial bodies in random pose, touched at random, with the truth about them.
//!
//! ```text
//! kind, part of the way round, contacts, noise, normals or none       a cell
//! contact   p = foot + e g,  e ~ N(0, (noise size)^2)       normal tilted by N(0, 2 noise) in each tangent direction
//! pose      axis even on the sphere, place within ten sizes; sizes within a factor of ten of each other's unit
//! ```

use palpate_geometry::contact::Contacts;
use palpate_geometry::curvature::{curvedness, shape_index};
use palpate_geometry::primitives::{Cone, Cylinder, Plane, Primitive, Sphere, Torus, TriaxialEllipsoid};
use palpate_numeric::draws::Lcg;
use palpate_numeric::vector::{Vector, along, cross, dot, minus, reject, unit};

/// Kinds of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyKind {
    Plane,
    Sphere,
    Cylinder,
    Cone,
    Torus,
    Ellipsoid,
}

impl BodyKind {
    /// All of them.
    pub const ALL: [BodyKind; 6] =
        [BodyKind::Plane, BodyKind::Sphere, BodyKind::Cylinder, BodyKind::Cone, BodyKind::Torus, BodyKind::Ellipsoid];

    /// The word for it in tables.
    pub fn name(self) -> &'static str {
        match self {
            BodyKind::Plane => "plane",
            BodyKind::Sphere => "sphere",
            BodyKind::Cylinder => "cylinder",
            BodyKind::Cone => "cone",
            BodyKind::Torus => "torus",
            BodyKind::Ellipsoid => "ellipsoid",
        }
    }
}

/// How a body is touched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchedBody {
    /// What it is.
    pub kind: BodyKind,
    /// Part of the way round that is touched, 0 to 1.
    pub part: f64,
    /// Number of contacts.
    pub count: usize,
    /// Whether normals are given.
    pub has_normals: bool,
    /// Standard deviation of a distance over the body's size; of a normal half of it in radians.
    pub noise: f64,
}

/// A body with its contacts.
#[derive(Debug)]
pub struct RandomBody {
    /// Places with or without normals.
    pub contacts: Contacts,
    kind: BodyKind,
    sizes: [f64; 3],
    origin: Vector,
    axes: [Vector; 3],
}

fn gaussian(generator: &mut Lcg) -> f64 {
    (-2.0 * (1.0 - generator.uniform()).ln()).sqrt() * (std::f64::consts::TAU * generator.uniform()).cos()
}

fn between(generator: &mut Lcg, lo: f64, hi: f64) -> f64 {
    lo + (hi - lo) * generator.uniform()
}

/// Two unit vectors that complete `a` to right-handed axes.
fn axes_along(a: Vector) -> [Vector; 3] {
    let start = if a[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let first = unit(reject(start, a));
    [first, cross(a, first), a]
}

impl RandomBody {
    /// The body of a seed in a cell.
    pub fn new(cell: &TouchedBody, seed: u64) -> RandomBody {
        let mut generator = Lcg::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5bd1_e995);
        for _ in 0..10 {
            generator.uniform();
        }
        let size = 10.0_f64.powf(between(&mut generator, -0.5, 1.5));
        // the second size of a cone is an angle
        let relative = match cell.kind {
            BodyKind::Plane | BodyKind::Sphere | BodyKind::Cylinder => [1.0, 0.0, 0.0],
            BodyKind::Cone => [1.0, between(&mut generator, 0.15, 0.75) / size, 0.0],
            BodyKind::Torus => [1.0, between(&mut generator, 0.2, 0.7), 0.0],
            BodyKind::Ellipsoid => [1.0, between(&mut generator, 0.5, 0.9), between(&mut generator, 0.5, 0.95)],
        };
        let sizes = relative.map(|s| s * size);
        let axis = unit([gaussian(&mut generator), gaussian(&mut generator), gaussian(&mut generator)]);
        let origin = [0, 1, 2].map(|_| between(&mut generator, -10.0, 10.0) * size);
        let mut body =
            RandomBody { contacts: Contacts::default(), kind: cell.kind, sizes, origin, axes: axes_along(axis) };
        let (mut places, mut normals) = (Vec::new(), Vec::new());
        for _ in 0..cell.count {
            let foot = body.foot(cell.part, size, &mut generator);
            let (d, normal) = body.nearest(foot);
            let error = cell.noise * size * gaussian(&mut generator);
            places.push(along(foot, error - d, normal));
            let [first, second, _] = axes_along(normal);
            let tilt = [0, 1].map(|_| 2.0 * cell.noise * gaussian(&mut generator));
            normals.push(unit(along(along(normal, tilt[0], first), tilt[1], second)));
        }
        let contacts = Contacts::from_points(&places);
        body.contacts = if cell.has_normals { contacts.with_normal_vectors(&normals) } else { contacts };
        body
    }

    /// A place on the body, in the part that is touched.
    fn foot(&self, part: f64, size: f64, generator: &mut Lcg) -> Vector {
        let [one, two, _] = self.sizes;
        let angle = std::f64::consts::TAU * part * (generator.uniform() - 0.5);
        let rise = generator.uniform() - 0.5;
        let own = match self.kind {
            BodyKind::Plane => [size * angle, 3.0 * size * rise, 0.0],
            BodyKind::Sphere | BodyKind::Ellipsoid => {
                let h = (2.0 * part.max(0.3) * rise).clamp(-1.0, 1.0);
                let across = (1.0 - h * h).sqrt();
                let half_axes = if self.kind == BodyKind::Sphere { [one; 3] } else { self.sizes };
                [across * angle.cos() * half_axes[0], across * angle.sin() * half_axes[1], h * half_axes[2]]
            }
            BodyKind::Cylinder => [one * angle.cos(), one * angle.sin(), 3.0 * one * rise],
            BodyKind::Cone => {
                let h = 1.5 * one * rise;
                let rho = one + h * two.tan();
                [rho * angle.cos(), rho * angle.sin(), h]
            }
            BodyKind::Torus => {
                let round = std::f64::consts::TAU * part.max(0.5) * rise;
                let rho = one + two * round.cos();
                [rho * angle.cos(), rho * angle.sin(), two * round.sin()]
            }
        };
        (0..3).fold(self.origin, |place, k| along(place, own[k], self.axes[k]))
    }

    fn own_form<A>(&self, ask: impl FnOnce(&dyn Primitive) -> A) -> A {
        let [one, two, _] = self.sizes;
        match self.kind {
            BodyKind::Plane => ask(&Plane),
            BodyKind::Sphere => ask(&Sphere { radius: one }),
            BodyKind::Cylinder => ask(&Cylinder { radius: one }),
            BodyKind::Cone => ask(&Cone { radius: one, half_angle: two }),
            BodyKind::Torus => ask(&Torus { ring: one, tube: two }),
            BodyKind::Ellipsoid => ask(&TriaxialEllipsoid { half_axes: self.sizes }),
        }
    }

    fn own(&self, place: Vector) -> Vector {
        self.axes.map(|axis| dot(axis, minus(place, self.origin)))
    }

    /// Signed distance of a place and the normal outwards.
    pub fn nearest(&self, place: Vector) -> (f64, Vector) {
        let (d, gradient) = self.own_form(|form| form.distance(self.own(place)));
        (d, (0..3).fold([0.0; 3], |sum, k| along(sum, gradient[k], self.axes[k])))
    }

    /// Means of S (0 on a plane) and of R over the feet of places.
    pub fn mean_shape(&self, places: impl Iterator<Item = Vector>) -> [f64; 2] {
        let (mut sums, mut count) = ([0.0; 2], 0.0);
        for place in places {
            let [a, b] = self.own_form(|form| form.curvatures(self.own(place)));
            sums[0] += shape_index(a + b, (a - b).abs()).unwrap_or(0.0);
            sums[1] += curvedness(a, b);
            count += 1.0;
        }
        sums.map(|sum| sum / count)
    }

    /// The radius of what has one.
    pub fn radius(&self) -> Option<f64> {
        matches!(self.kind, BodyKind::Sphere | BodyKind::Cylinder).then_some(self.sizes[0])
    }

    /// The axis of what has one.
    pub fn axis(&self) -> Option<Vector> {
        matches!(self.kind, BodyKind::Cylinder | BodyKind::Cone | BodyKind::Torus).then_some(self.axes[2])
    }
}
