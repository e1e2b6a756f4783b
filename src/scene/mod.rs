//! The simulated world: analytic surfaces, sweeping fingers, and the effects that a scene calls for.
//!
//! ```text
//! World { surface, sweeps, effects }  --compile-->  Simulator  --(seed, replicate)-->  (Contacts, Truth)
//! ```
//!
//! Nothing here knows splines, so a fit is not tested on surfaces of its own kind. (An imported surface is the exception,
//! and every output says so.) Compiling a world checks all of it. An effect that a world does not name costs nothing: it
//! draws no random numbers and is not even asked about.

mod batch;
pub mod effects;
mod error;
#[doc(hidden)]
pub mod explain;
mod rotation;
mod simulate;
pub mod surface;
mod sweep;
mod truth;

pub use crate::draws::{EffectDraws, NoiseLaw};
pub use batch::ContactBatch;
pub use effects::Effect;
pub(crate) use effects::Smoothness;
pub use error::SceneError;
pub use simulate::Simulator;
pub(crate) use surface::Surface;
#[doc(hidden)]
pub use surface::SurfacePoint;
#[doc(hidden)]
pub use sweep::{MAX_TOUCHES, Site, linspace};
pub use sweep::{Sweep, SweepPath};
pub use truth::Truth;

/// A world to be touched.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// What the fingers meet.
    pub surface: Surface,
    /// How they move over it; at least one sweep.
    pub sweeps: Vec<Sweep>,
    /// What comes between, in any order; each at most once.
    pub effects: Vec<Effect>,
    /// Effects whose errors have another shape than the normal one, by name.
    pub laws: Vec<(&'static str, NoiseLaw)>,
}

impl World {
    /// A world without effects.
    pub fn new(surface: Surface, sweep: Sweep) -> World {
        World { surface, sweeps: vec![sweep], effects: Vec::new(), laws: Vec::new() }
    }

    /// The same world with one more effect.
    pub fn with(mut self, effect: impl Into<Effect>) -> World {
        self.effects.push(effect.into());
        self
    }

    /// The same world in which the effect of this name errs by another law.
    pub fn with_law(mut self, effect: &'static str, law: NoiseLaw) -> World {
        self.laws.push((effect, law));
        self
    }
}
