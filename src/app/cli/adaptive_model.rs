//! `--adaptive`: a height field with small cells where the contacts ask for them.

use std::borrow::Cow;

use clap::Args;

use crate::io::Input;
use crate::report::{AdaptiveAnswer, Answer, ChosenPart};
use palpate_fitting::fit::{FitError, FitOptions, NormalSigma, Objective};
use palpate_geometry::contact::Contacts;
use palpate_geometry::shape::Outline;
use palpate_hierarchical::HierarchyError;
use palpate_hierarchical::adaptive::{AdaptiveFit, AdaptiveOptions, RowVariances, ShapeQuestion, fit_adaptive};

use super::found::{Found, Refusal};
use super::options::FitFlags;
use super::pixels::weighed_contacts_of;
use super::tuned::{TunedOption, tuned_option};

/// Points of the shape grid each way where none were typed: features of a hundredth of the patch count in the means.
pub(super) const GRID: [usize; 2] = [65; 2];

/// Whether an adaptive surface was asked for.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Fit")]
pub(super) struct AdaptiveFlags {
    /// Small cells where the contacts ask for them: many contacts, with features far smaller than the whole
    ///
    /// The surface is z over x, y. Cells are split until nothing but noise is left, and contacts far off what is around count for nothing
    #[arg(long, conflicts_with_all = ["surface", "closed", "segments", "weights", "method", "smooth", "robust", "frame", "sigma_xy"])]
    pub(super) adaptive: bool,
    /// Numbers that decide about an adaptive surface, such as false_discovery_rate=0.05,last_halving=on
    ///
    /// false_discovery_rate (default 0.01) is the share of cells that may be split by chance; deepest_level (12) says how small they get; last_halving (off) halves the last ones once more, and intervals near features hold more often; clip and reject (3, 4.5) are scales of outliers; most_factor_entries (5e8) and posterior_draws (64) bound memory. AdaptiveOptions in the library's documentation has them all
    #[arg(long, hide_short_help = true, value_name = "NAME=VALUE,..", value_delimiter = ',', value_parser = tuned_option, requires = "adaptive", conflicts_with_all = ["surface", "closed", "segments", "weights", "method", "smooth", "robust", "frame", "sigma_xy"])]
    pub(super) tune: Vec<TunedOption>,
}

impl AdaptiveFlags {
    /// All that was typed for an adaptive surface.
    pub(super) fn typed(&self, fit: &FitFlags) -> TypedForAdaptive {
        TypedForAdaptive { degree: fit.typed_degree(), grid: fit.typed_grid(), tuned: self.tune.clone() }
    }
}

/// What was typed, and means another thing for other surfaces where it was not.
#[derive(Clone, Debug, Default)]
pub(super) struct TypedForAdaptive {
    /// Degrees in x and y.
    pub(super) degree: Option<[usize; 2]>,
    /// Points of the shape grid.
    pub(super) grid: Option<[usize; 2]>,
    /// Other numbers.
    pub(super) tuned: Vec<TunedOption>,
}

/// The answer of exactly this model; domain and sigma are those of the options.
pub(super) fn adaptive_model(
    input: &Input,
    typed: &TypedForAdaptive,
    options: &FitOptions,
    bare: bool,
) -> Result<Found, Refusal> {
    options.check().map_err(Refusal::Fit)?;
    let contacts = match input {
        Input::Contacts(contacts) => Cow::Borrowed(contacts),
        Input::Grid(grid) => Cow::Owned(weighed_contacts_of(grid)),
    };
    let asked = adaptive_options(typed, options, bare).map_err(Refusal::Fit)?;
    let fit = fit_adaptive(&contacts, &asked).map_err(|error| refused(error, contacts.len(), options))?;
    Ok(adaptive_found(fit, &contacts, options, typed.grid.unwrap_or(GRID)))
}

/// A fit with its shape over a grid of so many points, as an answer.
pub(super) fn adaptive_found(fit: AdaptiveFit, contacts: &Contacts, options: &FitOptions, points: [usize; 2]) -> Found {
    let why = how(&fit);
    // who names a domain asks about all of it
    let support = options.domain.is_none().then(|| Outline::new(&contacts.x, &contacts.y));
    let question = ShapeQuestion { points, inset: options.inset, level: options.level };
    Found {
        answer: Answer::Adaptive(Box::new(AdaptiveAnswer::new(fit, support, question))),
        chosen: Some(ChosenPart::new("adaptive", why)),
        lack_of_fit: None,
        notes: Vec::new(),
    }
}

pub(super) fn adaptive_options(
    typed: &TypedForAdaptive,
    options: &FitOptions,
    bare: bool,
) -> Result<AdaptiveOptions, FitError> {
    let mut defaults = AdaptiveOptions::default();
    let tuned = typed.tuned.iter().try_for_each(|tuned| tuned.set(&mut defaults));
    tuned.map_err(|error| match error {
        HierarchyError::Option { option, value, expected } => FitError::Option { option, value, expected },
        error => FitError::Word { expected: error.to_string() },
    })?;
    let degree = match typed.degree {
        None => defaults.degree,
        Some([p, q]) if p == q => p,
        Some([p, q]) => {
            let expected = "one degree for x and y";
            return Err(FitError::Option { option: "degree", value: format!("{p},{q}"), expected });
        }
    };
    let noise = match options.objective {
        Objective::Normals(NormalSigma::Known { z, normal_deg }) => {
            RowVariances::Known { heights: z, slopes: normal_deg.to_radians() }
        }
        _ => defaults.noise,
    };
    let domain = options.domain.map(|[x0, x1, y0, y1]| [[x0, x1], [y0, y1]]);
    Ok(AdaptiveOptions { degree, noise, domain, uncertainty: !bare, ..defaults })
}

/// What came of it, in one sentence.
fn how(fit: &AdaptiveFit) -> String {
    let space = fit.field().space();
    let (cells, rounds) = (space.leaves().len(), fit.report().rounds.len());
    match space.mesh().tree().deepest() {
        0 => format!("nothing but noise is left with {cells} cells of one size: the contacts ask for no smaller ones"),
        deepest => {
            let times = 1_u64 << deepest;
            format!("{cells} cells after {rounds} rounds, the smallest 1/{times} as wide as the largest")
        }
    }
}

/// A refusal in the words of the other fits.
pub(super) fn refused(error: HierarchyError, contacts: usize, options: &FitOptions) -> Refusal {
    match error {
        HierarchyError::Contacts(error) => Refusal::Fit(FitError::Contacts(error)),
        HierarchyError::Option { option, value, expected } => {
            Refusal::Fit(FitError::Option { option, value, expected })
        }
        HierarchyError::Outside { index, x, y } => {
            let domain = options.domain.unwrap_or_default();
            Refusal::Fit(FitError::Outside { index, x, y, domain })
        }
        HierarchyError::Flat { .. } => Refusal::Fit(FitError::Collinear { contacts }),
        HierarchyError::NotPositiveDefinite { .. } => {
            Refusal::Shape("the contacts lie on too few lines in x, y to hold a surface: touch beside them".into())
        }
        error => Refusal::Shape(error.to_string()),
    }
}
