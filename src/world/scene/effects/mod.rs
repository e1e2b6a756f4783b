//! What comes between the surface and the numbers that a robot reads: one file per effect. Effects act in the physical
//! order of [`Effect::ORDER`], whatever their order in a scene.
//!
//! ```text
//! tip and skin    tip_radius_error, indentation          the tip's centre is C = P + (rho - delta) n
//! force           friction, force_noise                  the normal is the sensed force's direction
//! reading         position_noise, normal_noise, slope_gain
//! arm and frame   encoder, misalignment, latency
//! along the path  finger_noise, slip, dropout
//! rows of the fit row_noise
//! ```
//!
//! An effect whose strengths are all zero does not become a stage, so it costs and changes nothing. Each effect has
//! random numbers of its own (see `src/draws`), addressed by seed, replicate, the effect's name and the contact.
//!
//! A new effect is a file beside these, a line in the table at the end of this file, and a reader in
//! `io/scene_file/effects.rs`.

mod arm;
mod dropout;
mod encoder;
mod finger_noise;
mod force_noise;
mod friction;
mod indentation;
mod latency;
mod misalignment;
mod normal_noise;
mod position_noise;
mod row_noise;
mod slip;
mod slope_gain;
mod tip_radius_error;

pub use arm::{Arm, Link};
pub use dropout::Dropout;
pub use encoder::Encoder;
pub use finger_noise::FingerNoise;
pub use force_noise::ForceNoise;
pub use friction::Friction;
pub use indentation::Indentation;
pub use latency::Latency;
pub use misalignment::Misalignment;
pub use normal_noise::NormalNoise;
pub use position_noise::PositionNoise;
pub use row_noise::RowNoise;
pub use slip::Slip;
pub use slope_gain::SlopeGain;
pub use tip_radius_error::TipRadiusError;

use super::batch::ContactBatch;
use super::error::SceneError;
use super::surface::Surface;
use super::sweep::Site;
use palpate_numeric::draws::EffectDraws;

/// What an effect may look at when it is prepared.
#[derive(Debug)]
pub struct Context<'a> {
    pub sites: &'a [Site],
    pub surface: &'a Surface,
    /// Radius that the robot believes its tips to have.
    pub believed_radius: f64,
    pub tip_radius: f64,
    /// Force at which a reading is triggered, where indentation sets one.
    pub load: Option<f64>,
}

impl Context<'_> {
    /// Whether the contact before each contact was made by the same finger.
    pub(crate) fn continues(&self) -> Vec<bool> {
        let same = |i: usize| i > 0 && self.sites[i - 1].finger == self.sites[i].finger;
        (0..self.sites.len()).map(same).collect()
    }
}

/// Replaces the sensed normal. The robot computes the contact from the tip's centre, the radius it believes in and that
/// normal, so the contact moves with it.
pub fn swing(point: &mut [f64; 3], normal: &mut [f64; 3], sensed: [f64; 3], radius: f64) {
    for k in 0..3 {
        point[k] -= radius * (sensed[k] - normal[k]);
    }
    *normal = sensed;
}

/// One prepared effect: constants worked out, ready for batches of replicates.
///
/// An effect of the caller's own is a stage too, put behind the built-in ones with
/// [`Simulator::with_stage`](crate::scene::Simulator::with_stage):
///
/// ```
/// # use palpate_world::facade as palpate;
/// use palpate::scene::{ContactBatch, EffectDraws, Stage, Surface, Sweep, World};
/// use rand_distr::{Distribution, Gumbel};
///
/// /// Readings that come out too high, now and then by much.
/// #[derive(Debug)]
/// struct Drops(Gumbel<f64>);
///
/// impl Stage for Drops {
///     fn name(&self) -> &'static str {
///         "drops"
///     }
///     fn changes(&self) -> String {
///         "z by a Gumbel law".into()
///     }
///     fn draws_per_contact(&self) -> usize {
///         1
///     }
///     fn keeps_sites(&self) -> bool {
///         true
///     }
///     fn jumps(&self) -> bool {
///         // no derivative by numbers that are the generator's own
///         true
///     }
///     fn apply(&self, batch: &mut ContactBatch, draws: &EffectDraws) {
///         if draws.is_scripted() {
///             return;
///         }
///         for contact in 0..batch.contacts() {
///             for replicate in 0..batch.replicates() {
///                 // any generator of `rand`, any law of `rand_distr`; this one is the same however a study is split
///                 let mut generator = draws.generator(contact as u64, batch.first_replicate() + replicate as u64);
///                 let reading = contact * batch.replicates() + replicate;
///                 batch.points[reading][2] += self.0.sample(&mut generator);
///             }
///         }
///     }
/// }
///
/// let sweep = Sweep::new(vec![-1.0, 0.0, 1.0], (-4..=4).map(|k| 0.25 * f64::from(k)).collect());
/// let world = World::new(Surface::sphere(5.0), sweep);
/// let simulator = world.compile()?.with_stage(Drops(Gumbel::new(0.0, 0.01).unwrap()));
/// let (contacts, _) = simulator.simulate(1997, 0);
/// assert!(contacts.z.iter().zip(&simulator.noise_free().z).all(|(drawn, true_z)| drawn != true_z));
/// # Ok::<(), palpate::scene::SceneError>(())
/// ```
pub trait Stage: std::fmt::Debug + Send + Sync {
    /// Name as in a scene file.
    fn name(&self) -> &'static str;
    /// Name that the random numbers of this stage are addressed by.
    fn draws_name(&self) -> &'static str {
        self.name()
    }
    /// What it changes, in words.
    fn changes(&self) -> String;
    /// Random numbers per contact.
    fn draws_per_contact(&self) -> usize;
    /// Whether it leaves x and y of every contact as they are, so that a study can keep its factor.
    fn keeps_sites(&self) -> bool;
    /// The uniform number at which the effect has its mean or does not happen: 1/2 for errors of both signs, 1 for
    /// events that have a probability.
    fn rest(&self) -> f64 {
        0.5
    }
    /// Whether it depends on its random numbers by jumps, because something happens or does not: there is then no
    /// derivative by them.
    fn jumps(&self) -> bool {
        false
    }
    /// Whether its two uniform numbers are the size and the direction of a tilt, so that the derivative is taken by the
    /// tilt's two parts instead.
    fn tilts(&self) -> bool {
        false
    }
    /// Sds of z and of each slope, where the effect is nothing but row noise: a study then needs no contacts.
    fn row_sds(&self) -> Option<[f64; 2]> {
        None
    }
    /// Changes a batch of replicates in place.
    fn apply(&self, batch: &mut ContactBatch, draws: &EffectDraws);
}

/// Sweeps that an effect can act on.
enum Sweeps {
    /// All of them.
    Any,
    /// Those whose fingers come down from above.
    Down,
}

macro_rules! effects {
    ($($(#[$doc:meta])* $kind:ident => $name:literal, $sweeps:ident;)*) => {
        /// The numbers of every effect, in physical order.
        #[derive(Clone, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
        pub enum Kind {
            $($(#[$doc])* $kind($kind),)*
        }

        impl Effect {
            /// Names in the order of application, whatever the order in a file.
            pub const ORDER: &'static [&'static str] = &[$($name),*];

            /// Name as in a scene file.
            pub fn name(&self) -> &'static str {
                match &self.kind { $(Kind::$kind(_) => $name,)* }
            }

            /// Whether it acts on sweeps that go round the surface too, because it needs no direction of the fingers.
            pub(crate) fn goes_around(&self) -> bool {
                match &self.kind { $(Kind::$kind(_) => matches!(Sweeps::$sweeps, Sweeps::Any),)* }
            }

            /// Checks its numbers and prepares it; `None` when all its strengths are zero.
            pub(crate) fn prepare(&self, context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
                match &self.kind { $(Kind::$kind(effect) => effect.prepare(context),)* }
            }
        }

        $(impl From<$kind> for Effect {
            fn from(effect: $kind) -> Effect {
                Effect { kind: Kind::$kind(effect), misplaced: None }
            }
        })*
    };
}

// name as in a scene file, and the sweeps that the effect can act on
effects! {
    /// Wrong calibration of the tip's radius.
    TipRadiusError => "tip_radius_error", Down;
    /// Elastic tips that sink in until a force is reached.
    Indentation => "indentation", Down;
    /// Sliding friction, which tilts the sensed force.
    Friction => "friction", Down;
    /// Noise, bias, drift and quantisation of the force that the normal is estimated from.
    ForceNoise => "force_noise", Down;
    /// Independent errors of the measured position.
    PositionNoise => "position_noise", Any;
    /// Isotropic errors of the normal.
    NormalNoise => "normal_noise", Any;
    /// All slopes too steep by one factor.
    SlopeGain => "slope_gain", Down;
    /// Errors of the joint encoders, carried to the tip by the arm's kinematics.
    Encoder => "encoder", Down;
    /// The robot's frame is not where the robot believes it to be.
    Misalignment => "misalignment", Down;
    /// Positions older than the forces.
    Latency => "latency", Down;
    /// Correlated errors along the path of a finger.
    FingerNoise => "finger_noise", Down;
    /// Gross outliers.
    Slip => "slip", Down;
    /// Lost readings.
    Dropout => "dropout", Any;
    /// Independent errors of z, zx, zy, as the paper's studies have them.
    RowNoise => "row_noise", Down;
}

/// One thing that comes between the surface and the numbers a robot reads: noise, friction, a coarse encoder, a lost
/// reading.
///
/// Each has a constructor of its own, which says what it does, in which units, and what it leaves out. A world holds
/// each effect once at most, in any order; they act in the physical order of [`Effect::ORDER`]. An effect whose
/// strengths are all zero costs and changes nothing.
///
/// # Errors
/// The constructors take any numbers. [`World::compile`](crate::scene::World::compile) checks them, and names the number
/// that is out of range as a scene file would.
///
/// ```
/// # use palpate_world::facade as palpate;
/// use palpate::scene::{Effect, SceneError, Surface, Sweep, World};
///
/// let sweep = Sweep::new(vec![-4.0, 0.0, 4.0], (-4..=4).map(f64::from).collect());
/// let world = World::new(Surface::sphere(10.0), sweep)
///     .with(Effect::position_noise([0.02; 3]))
///     .with(Effect::normal_noise(2.0))
///     .with(Effect::dropout(0.1));
/// let (contacts, truth) = world.compile()?.simulate(1997, 0);
/// assert_eq!(contacts.len(), truth.points.len());
///
/// let wrong = world.with(Effect::slip(1.5, 0.3)).compile().unwrap_err();
/// assert_eq!(wrong.to_string(), "effects.slip.probability = 1.5: a probability, 0 to 1, is needed");
/// # Ok::<(), SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
pub struct Effect {
    pub kind: Kind,
    /// A setting that belongs to another effect; compiling the world says so.
    #[cfg_attr(feature = "serde", serde(skip))]
    misplaced: Option<(&'static str, &'static str)>,
}

impl Effect {
    /// The same effect, marked: `setting` was asked of it and belongs to effect `owner`.
    fn misplace(self, setting: &'static str, owner: &'static str) -> Effect {
        Effect { misplaced: Some((setting, owner)), ..self }
    }

    /// Refuses an effect that was given a setting of another one.
    pub(crate) fn check_settings(&self) -> Result<(), SceneError> {
        match self.misplaced {
            None => Ok(()),
            Some((setting, owner)) => Err(SceneError::Clash {
                first: format!("effects.{}", self.name()),
                second: setting.into(),
                why: format!("that setting belongs to {owner}"),
            }),
        }
    }

    /// Place in the physical order.
    pub fn order(&self) -> usize {
        Effect::ORDER.iter().position(|name| *name == self.name()).unwrap_or(usize::MAX)
    }
}
