//! Bodies of five families with what is true of them; sizes, pose, spacing and noise are drawn.

use palpate::parts::{JointKind, PartKind};
use palpate::scene::{Effect, Solid, Surface, Sweep, World};
use palpate_numeric::vector::unit;

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
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// The next number, even between the two.
    pub(crate) fn between(&mut self, lo: f64, hi: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        lo + (hi - lo) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A solid with its faces, in the order in which the simulation numbers them.
type Faced = (Solid, Vec<Face>);

const PLANE: Face = Face { kind: PartKind::Plane, radius: None, minor_radius: None, half_angle_deg: None };

fn block(size: [f64; 3]) -> Faced {
    (Solid::block(size), vec![PLANE; 6])
}

fn ball(radius: f64) -> Faced {
    (Solid::ball(radius), vec![Face { kind: PartKind::Sphere, radius: Some(radius), ..PLANE }])
}

fn bar(radius: f64, length: f64) -> Faced {
    let mantle = Face { kind: PartKind::Cylinder, radius: Some(radius), ..PLANE };
    (Solid::bar(radius, length), vec![mantle, PLANE, PLANE])
}

fn frustum(radius: f64, top: f64, length: f64) -> Faced {
    let angle = (radius - top).atan2(length).to_degrees();
    let cone = Face { kind: PartKind::Cone, half_angle_deg: Some(angle), ..PLANE };
    (Solid::frustum(radius, top, length), vec![cone, PLANE, PLANE])
}

fn ring(major: f64, minor: f64) -> Faced {
    let tube = Face { kind: PartKind::Torus, radius: Some(major), minor_radius: Some(minor), ..PLANE };
    (Solid::ring(major, minor), vec![tube])
}

fn moved((solid, faces): Faced, offset: [f64; 3]) -> Faced {
    (solid.moved(offset), faces)
}

fn cut((solid, faces): Faced) -> Faced {
    (solid.cut(), faces)
}

/// The body of a family and a seed.
pub(crate) fn draw(family: &str, seed: u64) -> Drawn {
    seen(family, seed, None)
}

/// A body without pose, spacing or errors.
pub(crate) struct Form {
    pub(crate) solids: Vec<Solid>,
    /// In the order in which the simulation numbers them.
    pub(crate) faces: Vec<Face>,
    joints: Vec<(usize, usize, JointKind)>,
    /// Where the sensor stands, in the body's own axes, if the family is seen from one side.
    eye: Option<[f64; 3]>,
}

/// A body of the family with sizes of these draws.
pub(crate) fn form(family: &str, random: &mut Random) -> Form {
    use JointKind::{Convex, Smooth};
    let mut r = |lo: f64, hi: f64| random.between(lo, hi);
    let mut eye = None;
    let (parts, joints) = match family {
        "box" => {
            let size = [r(8.0, 20.0), r(8.0, 20.0), r(8.0, 20.0)];
            eye = Some([r(45.0, 70.0), r(45.0, 70.0), r(45.0, 70.0)]);
            let joints = vec![(0, 2, Convex), (0, 4, Convex), (2, 4, Convex)];
            (vec![block(size)], joints)
        }
        "capsule" => {
            let (radius, length) = (r(3.0, 7.0), r(10.0, 20.0));
            let end = moved(ball(radius), [0.0, 0.0, 0.5 * length]);
            (vec![bar(radius, length), end], vec![(0, 2, Convex), (0, 3, Smooth)])
        }
        "cone" => {
            let (radius, length, height) = (r(5.0, 9.0), r(6.0, 14.0), r(8.0, 14.0));
            let cone = frustum(radius, radius * r(0.25, 0.6), height);
            let cone = moved(cone, [0.0, 0.0, 0.5 * (length + height)]);
            (vec![bar(radius, length), cone], vec![(0, 2, Convex), (0, 3, Convex), (3, 5, Convex)])
        }
        "mug" => mug(&mut r),
        "flange" => flange(&mut r),
        "torus" => (vec![ring(r(8.0, 14.0), r(2.0, 5.0))], Vec::new()),
        _ => {
            let (radius, length, wall) = (r(6.0, 10.0), r(18.0, 26.0), r(2.5, 3.5));
            let bore = cut(bar(radius - wall, 2.0 * length));
            let groove = cut(moved(ring(radius, r(1.2, 2.2)), [0.0, 0.0, r(-3.0, 3.0)]));
            let joints = vec![(0, 1, Convex), (0, 2, Convex), (1, 3, Convex), (2, 3, Convex), (0, 6, Convex)];
            (vec![bar(radius, length), bore, groove], joints)
        }
    };
    let (solids, faces): (Vec<Solid>, Vec<Vec<Face>>) = parts.into_iter().unzip();
    Form { solids, faces: faces.concat(), joints, eye }
}

type Joined = (Vec<Faced>, Vec<(usize, usize, JointKind)>);

fn mug(r: &mut impl FnMut(f64, f64) -> f64) -> Joined {
    use JointKind::{Concave, Convex};
    let (radius, length, wall, floor) = (r(8.0, 12.0), r(20.0, 26.0), r(2.5, 4.0), r(2.5, 4.0));
    let bore = cut(moved(bar(radius - wall, length), [0.0, 0.0, floor]));
    let (handle, tube) = ring(r(5.5, 8.0), r(1.5, 2.2));
    let handle = handle.posed([90.0, 0.0, 0.0], [radius, 0.0, r(-2.0, 2.0)]);
    let joints = vec![(0, 1, Convex), (0, 2, Convex), (1, 3, Convex), (3, 5, Concave), (0, 6, Concave)];
    (vec![bar(radius, length), bore, (handle, tube)], joints)
}

/// A disc with a barrel on it, and a bore through both.
fn flange(r: &mut impl FnMut(f64, f64) -> f64) -> Joined {
    use JointKind::{Concave, Convex};
    let (disc, thick, length) = (r(10.0, 14.0), r(2.5, 4.0), r(8.0, 14.0));
    let barrel = r(0.45, 0.65) * disc;
    let bore = cut(bar(r(0.5, 0.7) * barrel, 4.0 * (thick + length)));
    let barrel = moved(bar(barrel, length), [0.0, 0.0, 0.5 * (thick + length)]);
    let joints = vec![(0, 1, Convex), (0, 2, Convex), (1, 3, Concave), (3, 4, Convex), (2, 6, Convex), (4, 6, Convex)];
    (vec![bar(disc, thick), barrel, bore], joints)
}

/// The same body in a pose, with a spacing and errors of `scan`'s own, and from one side; without a scan, in its own.
pub(crate) fn seen(family: &str, seed: u64, scan: Option<u64>) -> Drawn {
    let number = FAMILIES.iter().position(|f| *f == family).expect("a family of the list") as u64;
    let mut random = Random(seed.wrapping_mul(31).wrapping_add(number));
    let Form { solids, faces, joints, mut eye } = form(family, &mut random);
    if let Some(scan) = scan {
        random = Random(seed.wrapping_mul(977).wrapping_add(scan));
        let direction = unit([0, 1, 2].map(|_| random.between(-1.0, 1.0)));
        eye = Some(direction.map(|v| 90.0 * v));
    }
    let mut r = |lo: f64, hi: f64| random.between(lo, hi);
    let rotation = [r(-180.0, 180.0), r(-80.0, 80.0), r(-180.0, 180.0)];
    let offset = [r(-50.0, 50.0), r(-50.0, 50.0), r(-50.0, 50.0)];
    let surface = Surface::solids(solids).posed(0.0, rotation, offset);
    let eye = eye.map(|eye| world_of(rotation, offset, eye));
    let sigma = r(0.01, 0.04);
    let world = World::new(surface, Sweep::scan(r(0.5, 0.7), eye))
        .with(Effect::position_noise([sigma; 3]))
        .with(Effect::normal_noise(r(1.0, 4.0)));
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
