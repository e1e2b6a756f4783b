//! The simulated world: analytic surfaces, sweeping fingers, and the effects that a scene calls for.
//!
//! ```text
//! World { surface, sweeps, effects }  --compile-->  Simulator  --(seed, replicate)-->  (Contacts, Truth)
//! ```
//!
//! Nothing here knows splines, so a fit is not tested on surfaces of its own kind. (An imported surface is the
//! exception, and every output says so.) Compiling a world checks all of it. An effect that a world does not name costs
//! nothing: it draws no random numbers and is not even asked about.

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

pub use batch::ContactBatch;
pub use effects::{Effect, Stage};
pub use error::SceneError;
pub use palpate_numeric::draws::{EffectDraws, NoiseLaw};
pub use simulate::Simulator;
#[doc(hidden)]
pub use surface::SurfacePoint;
pub use surface::{ImportedSurface, Solid, Surface};
pub use sweep::Sweep;
pub use sweep::SweepPath;
#[doc(hidden)]
pub use sweep::{MAX_TOUCHES, Site, linspace};
pub use truth::Truth;

/// A world to be touched.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct World {
    /// What the fingers meet.
    pub surface: Surface,
    /// How they move over it; at least one sweep.
    pub sweeps: Vec<Sweep>,
    /// What comes between, in any order; each at most once.
    pub effects: Vec<Effect>,
    /// Effects whose errors have another law than the gaussian one, by name.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "laws_by_name"))]
    pub laws: Vec<(&'static str, NoiseLaw)>,
}

/// The laws with the effects' own names, which outlive the text that is read.
#[cfg(feature = "serde")]
fn laws_by_name<'de, D: serde::Deserializer<'de>>(reader: D) -> Result<Vec<(&'static str, NoiseLaw)>, D::Error> {
    use serde::Deserialize;
    use serde::de::Error;
    let read: Vec<(String, NoiseLaw)> = Vec::deserialize(reader)?;
    let named = |(name, law): (String, NoiseLaw)| match Effect::ORDER.iter().find(|known| **known == name) {
        Some(known) => Ok((*known, law)),
        None => Err(D::Error::custom(format!("there is no effect {name}, only {}", Effect::ORDER.join(", ")))),
    };
    read.into_iter().map(named).collect()
}

impl World {
    /// A world without effects.
    pub fn new(surface: Surface, sweep: Sweep) -> World {
        World { surface, sweeps: vec![sweep], effects: Vec::new(), laws: Vec::new() }
    }

    /// The same world with one more effect.
    pub fn with(mut self, effect: Effect) -> World {
        self.effects.push(effect);
        self
    }

    /// The same world in which the effect of this name errs by another law.
    pub fn with_law(mut self, effect: &'static str, law: NoiseLaw) -> World {
        self.laws.push((effect, law));
        self
    }
}

#[cfg(all(test, feature = "serde"))]
mod tests {
    use super::*;

    fn world() -> World {
        let surface = Surface::cylinder(10.0).posed(45.0, [10.0, 0.0, 0.0], [0.0, 0.0, 3.0]);
        let sweep = Sweep::new(vec![-4.0, 0.0, 4.0], linspace(-4.0, 4.0, 9));
        World::new(surface, sweep).with(Effect::position_noise([0.02; 3])).with_law("position_noise", NoiseLaw::Laplace)
    }

    #[test]
    fn a_world_comes_back_from_its_text() {
        let text = serde_json::to_string(&world()).unwrap();
        assert_eq!(serde_json::from_str::<World>(&text).unwrap(), world());
    }

    #[test]
    fn a_text_that_is_no_world_is_refused() {
        let text = serde_json::to_string(&world()).unwrap();
        for (right, wrong, complaint) in [
            ("[[\"position_noise\"", "[[\"posision_noise\"", "there is no effect posision_noise"),
            ("\"matrix\":[[", "\"matrix\":[[1", "must be a rotation"),
            ("\"upright\":false", "\"upright\":true", "must leave the z axis alone"),
        ] {
            assert!(text.contains(right), "{text}");
            let error = serde_json::from_str::<World>(&text.replace(right, wrong)).unwrap_err();
            assert!(error.to_string().contains(complaint), "{error}");
        }
    }
}
