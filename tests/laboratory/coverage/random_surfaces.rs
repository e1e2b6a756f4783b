//! Surfaces drawn at random, on which intervals are judged that were built without them: sums of bumps, tori,
//! superquadrics, each with its own contacts and noise.
//!
//! ```text
//! bumps          z = sum_k h_k exp(-|(x, y) - c_k|^2/(2 w_k^2)),  k = 1..3
//! torus          radii 8 to 16 and 14 to 36, tilted, either side
//! superquadric   semi-axes 9 to 18, exponents 0.6 to 1, tilted, either side
//! contacts       27 to 200 over a square of half width 4; sd of z 0.005 to 0.05, of normals 60 degrees a unit of that
//! ```

use super::cramer_rao::Family;
use palpate_numeric::draws::EffectDraws;
use palpate_world::scene::{Effect, ImportedSurface, Surface, Sweep, World, linspace};

/// Numbers that a surface may draw.
const NUMBERS: usize = 24;

/// Numbers of one bump: height, place, width.
const PER_BUMP: usize = 4;

/// Fingers and stations.
const SWEEPS: [[usize; 2]; 5] = [[3, 9], [4, 9], [5, 12], [8, 12], [10, 20]];

/// A sum of bumps.
#[derive(Clone, Debug, PartialEq)]
struct Bumps(Vec<f64>);

impl ImportedSurface for Bumps {
    fn label(&self) -> &str {
        "a sum of bumps"
    }

    fn is_fit(&self) -> bool {
        false
    }

    fn jet(&self, x: f64, y: f64) -> Option<[f64; 6]> {
        let mut jet = [0.0; 6];
        for bump in self.0.chunks_exact(PER_BUMP) {
            let [h, cx, cy, w] = [bump[0], bump[1], bump[2], bump[3]];
            let (u, v) = ((x - cx) / w, (y - cy) / w);
            let g = h * (-0.5 * (u * u + v * v)).exp();
            let parts = [1.0, -u / w, -v / w, (u * u - 1.0) / (w * w), u * v / (w * w), (v * v - 1.0) / (w * w)];
            jet.iter_mut().zip(parts).for_each(|(sum, part)| *sum += g * part);
        }
        Some(jet)
    }
}

/// A surface drawn at random, with contacts and noise.
#[derive(Debug)]
pub struct RandomSurface {
    pub name: String,
    pub world: World,
    /// Numbers of the bumps; empty for other surfaces.
    bumps: Vec<f64>,
}

impl RandomSurface {
    /// The surface of a seed.
    pub fn new(seed: u64) -> RandomSurface {
        let mut numbers = [0.0; NUMBERS];
        EffectDraws::new(seed, "random surfaces").uniforms(0, 0, NUMBERS, &mut numbers);
        let between = |k: usize, lo: f64, hi: f64| lo + (hi - lo) * numbers[k];
        let sign = |k: usize| if numbers[k] < 0.5 { -1.0 } else { 1.0 };
        let mut bumps = Vec::new();
        let (kind, surface) = match seed % 3 {
            0 => {
                for k in [8, 12, 16] {
                    bumps.extend([sign(k + 3) * between(k, 0.5, 2.0), between(k + 1, -5.0, 5.0)]);
                    bumps.extend([between(k + 2, -5.0, 5.0), between(20 + k / 4 - 2, 3.0, 7.0)]);
                }
                ("bumps", Surface::imported(Bumps(bumps.clone())))
            }
            1 => {
                let minor = between(8, 8.0, 16.0);
                ("torus", Surface::torus(minor + between(9, 6.0, 20.0), minor))
            }
            _ => {
                let semi_axes = [8, 9, 10].map(|k| between(k, 9.0, 18.0));
                let exponents = [11, 12].map(|k| between(k, 0.6, 1.0));
                ("superquadric", Surface::superquadric(semi_axes, exponents))
            }
        };
        let surface = if seed.is_multiple_of(3) {
            surface
        } else {
            let tilt = [between(1, -10.0, 10.0), between(2, -10.0, 10.0), 0.0];
            let posed = surface.posed(between(0, 0.0, 180.0), tilt, [0.0; 3]);
            if numbers[3] < 0.5 { posed.concave() } else { posed }
        };
        let [fingers, stations] = SWEEPS[((numbers[4] * SWEEPS.len() as f64) as usize).min(SWEEPS.len() - 1)];
        let mut sweep = Sweep::new(linspace(-4.0, 4.0, fingers), linspace(-4.0, 4.0, stations));
        // a tilted body may leave a corner out of reach
        sweep.skip_unreachable = true;
        let sd = 0.005 * 10_f64.powf(numbers[5]);
        let world = World::new(surface, sweep)
            .with(Effect::position_noise([0.0, 0.0, sd]))
            .with(Effect::normal_noise(60.0 * sd));
        RandomSurface { name: format!("{kind}-{}-seed{seed}", fingers * stations), world, bumps }
    }

    /// The family that the surface belongs to.
    pub fn family(&self) -> Option<Family<'_>> {
        if self.bumps.is_empty() {
            return Family::of(&self.world.surface);
        }
        let surface = &self.world.surface;
        let member =
            move |p: &[f64]| Some(Surface { body: Surface::imported(Bumps(p.to_vec())).body, ..surface.clone() });
        Some(Family { sizes: self.bumps.clone(), member: Box::new(member) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_is_a_surface_that_fingers_reach_and_that_is_a_member_of_its_family() {
        for seed in 1..=30 {
            let (drawn, again) = (RandomSurface::new(seed), RandomSurface::new(seed));
            assert_eq!(drawn.name, again.name);
            assert!(drawn.world.compile().is_ok(), "{}", drawn.name);
            let family = drawn.family().unwrap();
            let member = (family.member)(&family.sizes).unwrap();
            let height = |surface: &Surface| surface.height(1.0, -2.0).unwrap();
            assert_eq!(height(&member), height(&again.world.surface));
        }
    }
}
