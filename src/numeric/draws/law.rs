//! Noise with a shape: standardised laws (mean 0, sd 1) in place of the normal, and draws from any source.
//!
//! ```text
//! uniform      on (-sqrt 3, sqrt 3)                    triangular   on (-sqrt 6, sqrt 6), mode 0
//! student_t    t(dof) sqrt((dof - 2)/dof), dof > 2     laplace      +- Exp(1)/sqrt 2
//! ```
//!
//! A law changes the shape of an effect's errors and leaves their sd alone. Its generator stands at
//! `replicate 2^10` words of the contact's stream, so that a law may reject as often as it likes (512 draws of 64 bits)
//! before it would meet the next replicate's words, and any split of the replicates gives the same bits.

use std::fmt;

use rand::Rng;
use rand_distr::{Distribution, Exp1, StandardNormal, StudentT, Triangular, Uniform};

/// Words (32 bits) between two replicates of one contact, as a power of two.
pub(super) const SLOT_BITS: u32 = 10;

/// Standard deviation of a uniform law on (0, 1).
pub(super) const UNIFORM_SD: f64 = 0.288_675_134_594_812_9;

/// The shape of an effect's errors; the effect says how large they are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum NoiseLaw {
    /// The normal law, drawn by address with the vectorised Box-Muller.
    #[default]
    Normal,
    /// Every value of an interval as likely.
    Uniform,
    /// Heavy tails; more than 2 degrees of freedom.
    StudentT {
        /// Degrees of freedom.
        dof: f64,
    },
    /// Two exponential tails.
    Laplace,
    /// Symmetric triangle.
    Triangular,
}

impl NoiseLaw {
    /// Words of a scene file, in the order of the variants.
    pub const NAMES: [&'static str; 5] = ["normal", "uniform", "student_t", "laplace", "triangular"];

    /// The word of a scene file.
    pub fn name(&self) -> &'static str {
        match self {
            NoiseLaw::Normal => "normal",
            NoiseLaw::Uniform => "uniform",
            NoiseLaw::StudentT { .. } => "student_t",
            NoiseLaw::Laplace => "laplace",
            NoiseLaw::Triangular => "triangular",
        }
    }

    /// Whether the law has the parameters it needs.
    pub fn is_sound(&self) -> bool {
        match self {
            NoiseLaw::StudentT { dof } => dof.is_finite() && *dof > 2.0,
            _ => true,
        }
    }
}

/// One draw with mean 0 and sd 1. An unsound law draws the normal.
impl Distribution<f64> for NoiseLaw {
    fn sample<R: Rng + ?Sized>(&self, generator: &mut R) -> f64 {
        match *self {
            NoiseLaw::Normal => StandardNormal.sample(generator),
            NoiseLaw::Uniform => Uniform::new(-1.0, 1.0).map_or(0.0, |law| law.sample(generator)) * 3.0_f64.sqrt(),
            NoiseLaw::StudentT { dof } => match StudentT::new(dof) {
                Ok(law) if dof > 2.0 => law.sample(generator) * ((dof - 2.0) / dof).sqrt(),
                _ => StandardNormal.sample(generator),
            },
            NoiseLaw::Laplace => {
                let size: f64 = Exp1.sample(generator);
                let sign: f64 = StandardNormal.sample(generator);
                size.copysign(sign) * std::f64::consts::FRAC_1_SQRT_2
            }
            NoiseLaw::Triangular => {
                let half = 6.0_f64.sqrt();
                Triangular::new(-half, half, 0.0).map_or(0.0, |law| law.sample(generator))
            }
        }
    }
}

impl fmt::Display for NoiseLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NoiseLaw::StudentT { dof } => write!(f, "student_t, {dof} degrees of freedom"),
            law => f.write_str(law.name()),
        }
    }
}

/// Where an effect's random numbers come from when they are not the addressed ones: a script of a derivative, say, or
/// a generator of the caller's own.
pub trait DrawSource: fmt::Debug + Send + Sync {
    /// `per` numbers of mean 0 and sd 1 for each replicate from `first` on.
    fn gaussians(&self, contact: u64, first: u64, per: usize, out: &mut [f64]);

    /// `per` numbers in (0, 1) for each replicate from `first` on.
    fn uniforms(&self, contact: u64, first: u64, per: usize, out: &mut [f64]);
}
