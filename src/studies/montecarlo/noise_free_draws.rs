//! Effects at rest, and poked one random number at a time: what derivatives and nominal contacts are made of.
//!
//! At rest every normal number is 0 and every uniform one is where the effect does what it does on average: biases,
//! quantisation and wrong radii stay, noise is gone.

use std::sync::Arc;

use palpate_numeric::draws::DrawSource;
use palpate_world::scene::Simulator;

/// Standard deviation of a uniform law on (0, 1).
const UNIFORM_SD: f64 = 0.288_675_134_594_812_9;

/// No noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct AtRest {
    uniform: f64,
}

impl AtRest {
    /// The rest of every stage of a simulator.
    pub(super) fn shared(simulator: &Simulator) -> Vec<Arc<dyn DrawSource>> {
        let at_rest = |uniform: f64| Arc::new(AtRest { uniform }) as Arc<dyn DrawSource>;
        simulator.stages().iter().map(|stage| at_rest(stage.rest())).collect()
    }
}

impl DrawSource for AtRest {
    fn gaussians(&self, _contact: u64, _first: u64, _per: usize, out: &mut [f64]) {
        out.fill(0.0);
    }

    fn uniforms(&self, _contact: u64, _first: u64, _per: usize, out: &mut [f64]) {
        out.fill(self.uniform);
    }
}

/// One stage at rest but for one number in every replicate: replicate `2 (contact per + component) + s` has that
/// component of that contact's numbers at `+h` (s = 0) or `-h` (s = 1) standard deviations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Poked {
    /// Numbers per contact.
    pub per: usize,
    /// How far.
    pub h: f64,
    /// The stage's rest.
    pub rest: f64,
    /// Whether its two uniform numbers are the size and the direction of a tilt.
    pub tilts: bool,
}

impl Poked {
    /// `(component, sign)` where replicate `b` pokes this contact.
    fn at(&self, contact: u64, b: u64) -> Option<(usize, f64)> {
        let number = b / 2;
        let per = self.per as u64;
        let sign = if b.is_multiple_of(2) { 1.0 } else { -1.0 };
        (number / per == contact).then_some(((number % per) as usize, sign))
    }
}

impl DrawSource for Poked {
    fn gaussians(&self, contact: u64, first: u64, per: usize, out: &mut [f64]) {
        out.fill(0.0);
        for (b, values) in out.chunks_exact_mut(per).enumerate() {
            if let Some((component, sign)) = self.at(contact, first + b as u64)
                && let Some(value) = values.get_mut(component)
            {
                *value = sign * self.h;
            }
        }
    }

    fn uniforms(&self, contact: u64, first: u64, per: usize, out: &mut [f64]) {
        out.fill(self.rest);
        for (b, values) in out.chunks_exact_mut(per).enumerate() {
            let Some((component, sign)) = self.at(contact, first + b as u64) else { continue };
            match (self.tilts, &mut values[..]) {
                (true, [size, direction, ..]) => {
                    // the size of two normal numbers of which one is h, in the direction of that one
                    *size = (-0.5 * self.h * self.h).exp();
                    let quarter = 0.25 * component as f64;
                    *direction = if sign > 0.0 { quarter } else { quarter + 0.5 };
                }
                (false, values) => {
                    if let Some(value) = values.get_mut(component) {
                        *value = self.rest + sign * self.h * UNIFORM_SD;
                    }
                }
                _ => {}
            }
        }
    }
}
