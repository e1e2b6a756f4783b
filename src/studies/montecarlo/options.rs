//! Options of a study: the `[study]` section of a scene file, and what the command line may say.

use super::error::StudyError;
use super::quantity::Quantity;
use super::strategy::Path;

/// Most replicates whose values are all kept (64 MB for S and R); beyond, they are counted in bins.
pub(super) const KEPT: u64 = 1 << 22;
/// Replicates of the pilot that says where the bins stand.
pub(super) const PILOT: usize = 1 << 14;
/// Most replicates of one study: beyond, the replicates that attribution draws would be met.
pub(super) const MOST_REPLICATES: u64 = 1 << 40;
/// Replicates allowed when a tolerance decides and nothing else is said.
pub(super) const ALLOWED: u64 = 1 << 32;

/// How many significant digits of the standard uncertainty both ends of the intervals shall have, 1 to 4, and by which rule.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Tolerance {
    /// Two stages (C. Stein 1945; G. Wuebbeler et al., *Metrologia* 47 (2010) 317): batches of the first say how many
    /// more are needed. The one to take.
    Stein(u32),
    /// After every batch, when twice the standard deviation of the batches' means is below the tolerance (JCGM 101:2008,
    /// 7.9.4). It stops too early now and then: it looks until it likes what it sees.
    Adaptive(u32),
}

/// How often a study repeats, what its intervals cover, and when it stops.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct StudyOptions {
    /// Replicates; the most there may be where a tolerance is given. Default 10,000.
    pub replicates: u64,
    /// Whether `replicates` was said by somebody: a tolerance without a word takes what it needs.
    pub replicates_given: bool,
    /// Confidence level of the intervals, in (0, 1). Default 0.95.
    pub level: f64,
    /// Significant digits wanted.
    pub tolerance: Option<Tolerance>,
    /// Quantities beside S and R.
    pub quantities: Vec<Quantity>,
    /// Quantiles beside the intervals' ends, each in (0, 1).
    pub quantiles: Vec<f64>,
    /// The path, where one is forced.
    pub path: Option<Path>,
}

impl Default for StudyOptions {
    fn default() -> StudyOptions {
        StudyOptions {
            replicates: 10_000,
            replicates_given: false,
            level: 0.95,
            tolerance: None,
            quantities: Vec::new(),
            quantiles: Vec::new(),
            path: None,
        }
    }
}

impl StudyOptions {
    /// Checks every range.
    ///
    /// # Errors
    /// [`StudyError::Option`] with what would be right.
    pub fn check(&self) -> Result<(), StudyError> {
        let fault = |option, value: String, expected: &str| {
            Err(StudyError::Option { option, value, expected: expected.into() })
        };
        if self.replicates == 0 || self.replicates > MOST_REPLICATES {
            return fault("replicates", self.replicates.to_string(), "a whole number from 1 to 2^40");
        }
        if !(self.level > 0.0 && self.level < 1.0) {
            return fault("level", self.level.to_string(), "a probability between 0 and 1, such as 0.95");
        }
        if let Some(wrong) = self.quantiles.iter().find(|q| !(**q > 0.0 && **q < 1.0)) {
            return fault("quantile", wrong.to_string(), "probabilities between 0 and 1, such as 0.05,0.5");
        }
        match self.tolerance {
            Some(tolerance) if !(1..=4).contains(&tolerance.digits()) => {
                fault("tolerance", tolerance.digits().to_string(), "1 to 4 significant digits")
            }
            _ => Ok(()),
        }
    }

    /// The most replicates there may be: what decides whether values are kept or counted.
    pub fn most(&self) -> u64 {
        match self.tolerance {
            Some(_) if !self.replicates_given => ALLOWED,
            _ => self.replicates,
        }
    }
}

impl Tolerance {
    /// Significant digits wanted.
    pub fn digits(self) -> u32 {
        match self {
            Tolerance::Stein(digits) | Tolerance::Adaptive(digits) => digits,
        }
    }

    /// The rule wants to see every batch, not only those of a first stage.
    pub(crate) fn looks_on(self) -> bool {
        matches!(self, Tolerance::Adaptive(_))
    }
}
