//! Objects that nobody has seen: six kinds, their sizes, places and directions drawn from a seed.
//!
//! ```text
//! patch 8 by 8; radii 6 to 20; position noise 0.02 along each axis, normal noise 0.03 radian per tangent axis
//! ```

use palpate::scene::{Effect, Surface, Sweep, World};
use palpate_numeric::draws::EffectDraws;
use palpate_world::scene::linspace;

pub(crate) const KINDS: [&str; 6] = ["sphere", "cylinder", "saddle", "torus", "bump", "superquadric"];

/// Half the side of the patch.
pub(crate) const HALF: f64 = 4.0;

/// Standard deviations of a position along each axis, and of a normal per tangent axis in radians.
pub(crate) const NOISE: [f64; 2] = [0.02, 0.03];

/// Seeds from here on are kept for the last run: nothing was tuned on them.
pub(crate) const UNSEEN: u64 = 1_000_001;

/// The numbers of an object.
#[derive(Clone, Debug)]
pub(crate) struct Drawn {
    kind: u64,
    /// Sizes of the body.
    pub(crate) sizes: Vec<f64>,
    /// Rotation about the body's own axis and then about x and y, degrees; offset.
    pub(crate) pose: [f64; 6],
    concave: bool,
}

impl Drawn {
    /// The numbers of this seed; the kind is the seed's remainder by six.
    pub(crate) fn new(seed: u64) -> Drawn {
        let mut u = [0.0; 8];
        EffectDraws::new(seed, "objects").uniforms(0, 0, 8, &mut u);
        let between = |k: usize, lo: f64, hi: f64| lo + (hi - lo) * u[k];
        let sizes = match seed % 6 {
            0 | 1 => vec![between(0, 6.5, 20.0)],
            2 => vec![between(0, 6.5, 20.0), between(1, 6.5, 20.0)],
            3 => {
                let minor = between(0, 7.0, 14.0);
                vec![minor + between(1, 2.0, 20.0), minor]
            }
            4 => vec![between(0, 3.0, 8.0), between(1, 6.0, 10.0)],
            _ => vec![
                between(0, 9.0, 16.0),
                between(1, 9.0, 16.0),
                between(2, 7.0, 14.0),
                between(6, 0.8, 1.0),
                between(7, 0.8, 1.0),
            ],
        };
        // bars and rings reach far; the others stay over the patch
        let pose = [between(3, 0.0, 180.0), 0.0, 0.0, between(4, -1.0, 1.0), between(5, -1.0, 1.0), 0.0];
        // every other round of the kinds is seen from inside
        Drawn { kind: seed % 6, sizes, pose, concave: (seed / 6) % 2 == 1 }
    }

    /// The surface of these numbers.
    pub(crate) fn surface(&self) -> Surface {
        let p = &self.sizes;
        let body = match self.kind {
            0 => Surface::sphere(p[0]),
            1 => Surface::cylinder(p[0]),
            2 => Surface::saddle([p[0], p[1]]),
            3 => Surface::torus(p[0], p[1]),
            4 => Surface::gaussian_bump(p[0], p[1]),
            _ => Surface::superquadric([p[0], p[1], p[2]], [p[3], p[4]]),
        };
        let [axis, about_x, about_y, x, y, z] = self.pose;
        let posed = body.posed(axis, [about_x, about_y, 0.0], [x, y, z]);
        if self.concave { posed.concave() } else { posed }
    }
}

/// The object of this seed.
pub(crate) fn object(seed: u64) -> World {
    let sweep = Sweep::new(linspace(-HALF, HALF, 3), linspace(-HALF, HALF, 3));
    World::new(Drawn::new(seed).surface(), sweep)
        .with(Effect::position_noise([NOISE[0]; 3]))
        .with(Effect::normal_noise(NOISE[1].to_degrees()))
}
