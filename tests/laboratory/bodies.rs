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
    /// How its other sizes are drawn beside the first.
    pub sizes: SizeLaw,
}

/// How sizes are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SizeLaw {
    /// Half angles of cones 9 to 43 degrees, tubes of 0.2 to 0.7 of their ring, half axes of 0.5 to 0.9 and 0.95 of the longest.
    Even,
    /// As a prior has them: half angles even up to 80 degrees; tubes and rings half Cauchy, the tube the smaller; logarithms of half axes
    /// gaussian about their mean in two directions, with this standard deviation. The part that is touched lies anywhere on an ellipsoid and
    /// round a tube, and is as small there as along the ring.
    Prior { half_axes: f64 },
}

/// Where a body is touched.
#[derive(Debug)]
struct TouchedPlace {
    /// Parts of the height of an ellipsoid and of the way round a tube.
    parts: [f64; 2],
    /// Axes about which directions of an ellipsoid are drawn.
    axes: [Vector; 3],
    /// Middle of the part round a tube, from its outermost circle.
    round: f64,
}

impl SizeLaw {
    fn place(self, part: f64, generator: &mut Lcg) -> TouchedPlace {
        match self {
            SizeLaw::Even => {
                let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
                TouchedPlace { parts: [part.max(0.3), part.max(0.5)], axes, round: 0.0 }
            }
            SizeLaw::Prior { .. } => {
                let axis = unit([gaussian(generator), gaussian(generator), gaussian(generator)]);
                let round = std::f64::consts::TAU * between(generator, 0.0, 1.0);
                TouchedPlace { parts: [part; 2], axes: axes_along(axis), round }
            }
        }
    }

    /// Sizes over the first of all; the second of a cone is an angle over the size.
    fn drawn(self, kind: BodyKind, size: f64, generator: &mut Lcg) -> [f64; 3] {
        let mut half_cauchy = || (0.5 * std::f64::consts::PI * between(generator, 0.0, 1.0)).tan();
        match (kind, self) {
            (BodyKind::Plane | BodyKind::Sphere | BodyKind::Cylinder, _) => [1.0, 0.0, 0.0],
            (BodyKind::Cone, SizeLaw::Even) => [1.0, between(generator, 0.15, 0.75) / size, 0.0],
            (BodyKind::Cone, SizeLaw::Prior { .. }) => [1.0, between(generator, 0.0, 80_f64.to_radians()) / size, 0.0],
            (BodyKind::Torus, SizeLaw::Even) => [1.0, between(generator, 0.2, 0.7), 0.0],
            (BodyKind::Torus, SizeLaw::Prior { .. }) => {
                let both = [half_cauchy(), half_cauchy()];
                [1.0, (both[0].min(both[1]) / both[0].max(both[1])).max(0.1), 0.0]
            }
            (BodyKind::Ellipsoid, SizeLaw::Even) => [1.0, between(generator, 0.5, 0.9), between(generator, 0.5, 0.95)],
            (BodyKind::Ellipsoid, SizeLaw::Prior { half_axes }) => {
                let [u, v] = [gaussian(generator), gaussian(generator)].map(|g| half_axes * g);
                let logs = [(2.0_f64 / 3.0).sqrt() * u, 0.5_f64.sqrt() * v - u / 6.0_f64.sqrt()];
                [logs[0], logs[1], -logs[0] - logs[1]].map(f64::exp)
            }
        }
    }
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
        let relative = cell.sizes.drawn(cell.kind, size, &mut generator);
        let sizes = relative.map(|s| s * size);
        let axis = unit([gaussian(&mut generator), gaussian(&mut generator), gaussian(&mut generator)]);
        let origin = [0, 1, 2].map(|_| between(&mut generator, -10.0, 10.0) * size);
        let mut body =
            RandomBody { contacts: Contacts::default(), kind: cell.kind, sizes, origin, axes: axes_along(axis) };
        let (mut places, mut normals) = (Vec::new(), Vec::new());
        let place = cell.sizes.place(cell.part, &mut generator);
        for _ in 0..cell.count {
            let foot = body.foot(cell.part, &place, size, &mut generator);
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
    fn foot(&self, part: f64, place: &TouchedPlace, size: f64, generator: &mut Lcg) -> Vector {
        let [one, two, _] = self.sizes;
        let angle = std::f64::consts::TAU * part * (generator.uniform() - 0.5);
        let rise = generator.uniform() - 0.5;
        let own = match self.kind {
            BodyKind::Plane => [size * angle, 3.0 * size * rise, 0.0],
            BodyKind::Sphere | BodyKind::Ellipsoid => {
                let h = (2.0 * place.parts[0] * rise).clamp(-1.0, 1.0);
                let across = (1.0 - h * h).sqrt();
                let half_axes = if self.kind == BodyKind::Sphere { [one; 3] } else { self.sizes };
                let direction = [across * angle.cos(), across * angle.sin(), h];
                [0, 1, 2].map(|k| half_axes[k] * (0..3).map(|j| direction[j] * place.axes[j][k]).sum::<f64>())
            }
            BodyKind::Cylinder => [one * angle.cos(), one * angle.sin(), 3.0 * one * rise],
            BodyKind::Cone => {
                // no nearer to the tip than a tenth of the radius
                let h = one * rise * (1.8 / two.tan()).min(1.5);
                let rho = one + h * two.tan();
                [rho * angle.cos(), rho * angle.sin(), h]
            }
            BodyKind::Torus => {
                let round = place.round + std::f64::consts::TAU * place.parts[1] * rise;
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

    /// What it is turned about, or the longest half axis.
    pub fn axis(&self) -> Option<Vector> {
        match self.kind {
            BodyKind::Cylinder | BodyKind::Cone | BodyKind::Torus => Some(self.axes[2]),
            BodyKind::Ellipsoid => {
                let longest = (0..3).max_by(|a, b| self.sizes[*a].total_cmp(&self.sizes[*b]));
                longest.map(|k| self.axes[k])
            }
            BodyKind::Plane | BodyKind::Sphere => None,
        }
    }
}
