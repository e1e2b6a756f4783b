//! Bodies of five families with what is true of them; sizes, pose, spacing and noise are drawn.

use palpate::parts::{JointKind, PartKind};
use palpate::scene::effects::{NormalNoise, PositionNoise};
use palpate::scene::surface::{Body, Pose, Solid, SolidShape, Solids, Surface};
use palpate::scene::{Sweep, World};

/// The families in the order of the table.
pub(crate) const FAMILIES: [&str; 5] = ["box", "capsule", "cone", "mug", "pipe"];

/// A true face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face {
    pub(crate) kind: PartKind,
    pub(crate) radius: Option<f64>,
    pub(crate) minor_radius: Option<f64>,
    pub(crate) half_angle_deg: Option<f64>,
}

/// A body with its truth.
pub(crate) struct Drawn {
    pub(crate) world: World,
    /// In the order in which the simulation numbers them.
    pub(crate) faces: Vec<Face>,
    pub(crate) joints: Vec<(usize, usize, JointKind)>,
}

/// SplitMix64, which needs no state but a counter.
struct Random(u64);

impl Random {
    fn between(&mut self, lo: f64, hi: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        lo + (hi - lo) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn faces_of(shape: &SolidShape) -> Vec<Face> {
    let face = |kind| Face { kind, radius: None, minor_radius: None, half_angle_deg: None };
    let plane = face(PartKind::Plane);
    match *shape {
        SolidShape::Block { .. } => vec![plane; 6],
        SolidShape::Ball { radius } => vec![Face { radius: Some(radius), ..face(PartKind::Sphere) }],
        SolidShape::Bar { radius, .. } => vec![Face { radius: Some(radius), ..face(PartKind::Cylinder) }, plane, plane],
        SolidShape::Frustum { radius, top, length } => {
            let angle = (radius - top).atan2(length).to_degrees();
            vec![Face { half_angle_deg: Some(angle), ..face(PartKind::Cone) }, plane, plane]
        }
        SolidShape::Ring { major, minor } => {
            vec![Face { radius: Some(major), minor_radius: Some(minor), ..face(PartKind::Torus) }]
        }
    }
}

/// The body of a family and a seed.
pub(crate) fn draw(family: &str, seed: u64) -> Drawn {
    use JointKind::{Concave, Convex, Smooth};
    let number = FAMILIES.iter().position(|f| *f == family).expect("a family of the list") as u64;
    let mut random = Random(seed.wrapping_mul(31).wrapping_add(number));
    let mut r = |lo: f64, hi: f64| random.between(lo, hi);
    let solid = |shape, offset| Solid { shape, pose: Pose::new(0.0, [0.0; 3], offset), cut: false };
    let cut = |shape, offset| Solid { cut: true, ..solid(shape, offset) };
    let mut eye = None;
    let (parts, joints) = match family {
        "box" => {
            let size = [r(8.0, 20.0), r(8.0, 20.0), r(8.0, 20.0)];
            eye = Some([r(45.0, 70.0), r(45.0, 70.0), r(45.0, 70.0)]);
            let joints = vec![(0, 2, Convex), (0, 4, Convex), (2, 4, Convex)];
            (vec![solid(SolidShape::Block { size }, [0.0; 3])], joints)
        }
        "capsule" => {
            let (radius, length) = (r(3.0, 7.0), r(10.0, 20.0));
            let bar = solid(SolidShape::Bar { radius, length }, [0.0; 3]);
            let ball = solid(SolidShape::Ball { radius }, [0.0, 0.0, 0.5 * length]);
            (vec![bar, ball], vec![(0, 2, Convex), (0, 3, Smooth)])
        }
        "cone" => {
            let (radius, length, height) = (r(5.0, 9.0), r(6.0, 14.0), r(8.0, 14.0));
            let bar = solid(SolidShape::Bar { radius, length }, [0.0; 3]);
            let cone = SolidShape::Frustum { radius, top: radius * r(0.25, 0.6), length: height };
            let cone = solid(cone, [0.0, 0.0, 0.5 * (length + height)]);
            (vec![bar, cone], vec![(0, 2, Convex), (0, 3, Convex), (3, 5, Convex)])
        }
        "mug" => {
            let (radius, length, wall, floor) = (r(8.0, 12.0), r(20.0, 26.0), r(2.5, 4.0), r(2.5, 4.0));
            let bar = solid(SolidShape::Bar { radius, length }, [0.0; 3]);
            let bore = SolidShape::Bar { radius: radius - wall, length };
            let bore = cut(bore, [0.0, 0.0, floor]);
            let ring = SolidShape::Ring { major: r(5.5, 8.0), minor: r(1.5, 2.2) };
            let pose = Pose::new(0.0, [90.0, 0.0, 0.0], [radius, 0.0, r(-2.0, 2.0)]);
            let joints = vec![(0, 1, Convex), (0, 2, Convex), (1, 3, Convex), (3, 5, Concave), (0, 6, Concave)];
            (vec![bar, bore, Solid { shape: ring, pose, cut: false }], joints)
        }
        _ => {
            let (radius, length, wall) = (r(6.0, 10.0), r(18.0, 26.0), r(2.5, 3.5));
            let bar = solid(SolidShape::Bar { radius, length }, [0.0; 3]);
            let bore = cut(SolidShape::Bar { radius: radius - wall, length: 2.0 * length }, [0.0; 3]);
            let ring = SolidShape::Ring { major: radius, minor: r(1.2, 2.2) };
            let groove = cut(ring, [0.0, 0.0, r(-3.0, 3.0)]);
            let joints = vec![(0, 1, Convex), (0, 2, Convex), (1, 3, Convex), (2, 3, Convex), (0, 6, Convex)];
            (vec![bar, bore, groove], joints)
        }
    };
    let faces = parts.iter().flat_map(|solid| faces_of(&solid.shape)).collect();
    let rotation = [r(-180.0, 180.0), r(-80.0, 80.0), r(-180.0, 180.0)];
    let offset = [r(-50.0, 50.0), r(-50.0, 50.0), r(-50.0, 50.0)];
    let mut surface = Surface::new(Body::Solids(Solids { parts }), 0.0);
    surface.pose = Pose::new(0.0, rotation, offset);
    let eye = eye.map(|eye| world_of(rotation, offset, eye));
    let sigma = r(0.01, 0.04);
    let world = World::new(surface, Sweep::scan(r(0.5, 0.7), eye))
        .with(PositionNoise::Sigma([sigma; 3]))
        .with(NormalNoise { sigma_deg: r(1.0, 4.0) });
    Drawn { world, faces, joints }
}

/// A place of the body in the world: `offset + Rz Ry Rx p`.
fn world_of([rx, ry, rz]: [f64; 3], offset: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    let turn = |degrees: f64, a: f64, b: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        (cos * a - sin * b, sin * a + cos * b)
    };
    let (y, z) = turn(rx, y, z);
    let (z, x) = turn(ry, z, x);
    let (x, y) = turn(rz, x, y);
    [x + offset[0], y + offset[1], z + offset[2]]
}
