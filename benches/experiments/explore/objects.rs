//! Objects that nobody has seen: six kinds, their sizes, places and directions drawn from a seed.
//!
//! ```text
//! patch 8 by 8; radii 6 to 20; position noise 0.02 along each axis, normal noise 0.03 radian per tangent axis
//! ```

use palpate::internals::draws::EffectDraws;
use palpate::internals::scene::linspace;
use palpate::scene::{Effect, Surface, Sweep, World};

pub(crate) const KINDS: [&str; 6] = ["sphere", "cylinder", "saddle", "torus", "bump", "superquadric"];

/// Half the side of the patch.
pub(crate) const HALF: f64 = 4.0;

/// Seeds from here on are kept for the last run: nothing was tuned on them.
pub(crate) const UNSEEN: u64 = 1_000_001;

/// The object of this seed; its kind is the seed's remainder by six.
pub(crate) fn object(seed: u64) -> World {
    let mut u = [0.0; 8];
    EffectDraws::new(seed, "objects").uniforms(0, 0, 8, &mut u);
    let between = |k: usize, lo: f64, hi: f64| lo + (hi - lo) * u[k];
    let body = match seed % 6 {
        0 => Surface::sphere(between(0, 6.5, 20.0)),
        1 => Surface::cylinder(between(0, 6.5, 20.0)),
        2 => Surface::saddle([between(0, 6.5, 20.0), between(1, 6.5, 20.0)]),
        3 => {
            let minor = between(0, 7.0, 14.0);
            Surface::torus(minor + between(1, 2.0, 20.0), minor)
        }
        4 => Surface::gaussian_bump(between(0, 3.0, 8.0), between(1, 6.0, 10.0)),
        _ => Surface::superquadric(
            [between(0, 9.0, 16.0), between(1, 9.0, 16.0), between(2, 7.0, 14.0)],
            [between(6, 0.8, 1.0), between(7, 0.8, 1.0)],
        ),
    };
    // bars and rings reach far; the others stay over the patch
    let offset = [between(4, -1.0, 1.0), between(5, -1.0, 1.0), 0.0];
    let mut surface = body.posed(between(3, 0.0, 180.0), [0.0; 3], offset);
    // every other round of the kinds is seen from inside
    if (seed / 6) % 2 == 1 {
        surface = surface.concave();
    }
    let sweep = Sweep::new(linspace(-HALF, HALF, 3), linspace(-HALF, HALF, 3));
    World::new(surface, sweep).with(Effect::position_noise([0.02; 3])).with(Effect::normal_noise(0.03_f64.to_degrees()))
}
