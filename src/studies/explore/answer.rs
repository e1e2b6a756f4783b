//! What the contacts so far answer: the recognised surface, or the fit of a model that was named.
//!
//! ```text
//! nothing named    recognition: u counts noise, doubt about the kind of surface, and errors that contacts share
//! model named      that fit: u counts noise alone
//! ```

use palpate_fitting::fit::{Fit, FitOptions, Statistic, fit_contacts};
use palpate_geometry::contact::Contacts;
use palpate_geometry::shape::compare_with_truth;
use palpate_inference::recognition::{Estimate, Recognition, RecognitionOptions};
use palpate_world::scene::Truth;

use super::curvature_departure_test::{Departure, departure};
use super::model::{fit_of, planning_fit};
use super::predictive_planner::PredictivePlanner;
use super::richer_spline_test::richer_p;

/// The answer to some contacts.
pub(super) enum Answer {
    /// No model was named.
    Recognised(Box<Recognition>),
    /// The fit of the model that was named.
    Fitted(Box<Fit>),
    /// Neither, and why.
    Refused(String),
}

impl Answer {
    /// Of contacts, under the model that was named or none. A recognition predicts what touches at these places would measure.
    pub(super) fn new(
        contacts: &Contacts,
        (model, recognition): (Option<&FitOptions>, &RecognitionOptions),
        touches: &[[f64; 2]],
    ) -> Answer {
        let level = recognition.level;
        match model {
            None => match Recognition::with_predictions(contacts, recognition, touches) {
                Ok(found) => Answer::Recognised(Box::new(found)),
                Err(error) => Answer::Refused(error.to_string()),
            },
            Some(model) => match fit_contacts(contacts, &model.clone().with_level(level)) {
                Ok(fit) => Answer::Fitted(Box::new(fit)),
                Err(error) => Answer::Refused(error.to_string()),
            },
        }
    }

    /// S and R.
    pub(super) fn estimates(&self) -> [Option<Estimate>; 2] {
        match self {
            Answer::Recognised(found) => [found.shape_index, Some(found.curvedness)],
            Answer::Fitted(fit) => {
                let shape = fit.shape();
                [&shape.shape_index, &shape.curvedness].map(|s| estimate(s, fit.options().level))
            }
            Answer::Refused(_) => [None; 2],
        }
    }

    /// The kind of surface in words.
    pub(super) fn kind(&self) -> Option<String> {
        match self {
            Answer::Recognised(found) => Some(found.hypothesis.name().into()),
            Answer::Fitted(fit) => Some(fit.shape().class.name().into()),
            Answer::Refused(_) => None,
        }
    }

    /// Whether a named model answered.
    pub(super) fn is_named(&self) -> bool {
        matches!(self, Answer::Fitted(_))
    }

    /// Why there is none.
    pub(super) fn refused(&self) -> Option<String> {
        if let Answer::Refused(why) = self { Some(why.clone()) } else { None }
    }

    /// Part of the map that contacts support.
    pub(super) fn support(&self) -> f64 {
        match self {
            Answer::Recognised(found) => found.support.0 as f64 / found.support.1.max(1) as f64,
            Answer::Fitted(fit) => fit.shape().support,
            Answer::Refused(_) => 0.0,
        }
    }

    /// Direction of k1 in x and y, radians; along x where the surface has none.
    pub(super) fn principal_direction(&self) -> f64 {
        match self {
            Answer::Recognised(found) => found.direction.map_or(0.0, |[x, y, _]| y.atan2(x)),
            Answer::Fitted(fit) => fit.shape().direction_deg.map_or(0.0, f64::to_radians),
            Answer::Refused(_) => 0.0,
        }
    }

    /// Mean S and R of the true surface at the places that the answer's means were taken over.
    pub(super) fn truth(&self, truth: &Truth) -> [Option<f64>; 2] {
        match self {
            Answer::Recognised(found) => {
                let local = found.averaged.iter().filter_map(|(point, normal)| truth.near(*point, *normal));
                let local: Vec<_> = local.collect();
                let s: Vec<f64> = local.iter().filter_map(|l| l.shape_index()).collect();
                let r: Vec<f64> = local.iter().map(|l| l.curvedness()).collect();
                [mean(&s), mean(&r)]
            }
            Answer::Fitted(fit) => {
                let compared = compare_with_truth(&fit.shape().maps, |[x, y, _]| {
                    let local = truth.at(x, y)?.local;
                    Some((local.shape_index(), local.curvedness()))
                });
                [compared.shape_index, compared.curvedness]
            }
            Answer::Refused(_) => [None; 2],
        }
    }

    /// Probability of so good an explanation by a richer spline, if what was recognised were all there is.
    pub(super) fn richer_p(&self, contacts: &Contacts) -> Option<f64> {
        if let Answer::Recognised(found) = self { richer_p(contacts, found) } else { None }
    }

    /// How the contacts depart from what was recognised.
    pub(super) fn departure(&self, contacts: &Contacts) -> Option<Departure> {
        if let Answer::Recognised(found) = self { departure(contacts, found) } else { None }
    }

    /// What touches are chosen by where nothing was named; `units` are those of S and R, or their own uncertainties.
    pub(super) fn predictive_planner(&self, units: Option<[f64; 2]>) -> Option<PredictivePlanner> {
        if let Answer::Recognised(found) = self { PredictivePlanner::new(found, units) } else { None }
    }

    /// The fit whose covariance touches are planned by; `None` where the contacts are too few for one.
    pub(super) fn planning_fit(&self, contacts: &Contacts) -> Option<Fit> {
        match self {
            Answer::Recognised(found) => planning_fit(contacts, Some(found)),
            Answer::Fitted(fit) => Some((**fit).clone()),
            Answer::Refused(_) => planning_fit(contacts, None),
        }
    }

    /// A fit and one of a richer model; `None` where the contacts are too few for either.
    pub(super) fn simple_and_rich(&self, contacts: &Contacts) -> Option<[Fit; 2]> {
        match self {
            Answer::Fitted(fit) => {
                let [p, q] = fit.options().degree;
                let rich = fit.options().clone().with_degrees(p + 1, q + 1);
                Some([(**fit).clone(), fit_contacts(contacts, &rich).ok()?])
            }
            Answer::Recognised(found) => Some([fit_of(contacts, Some(found), 2)?, fit_of(contacts, Some(found), 3)?]),
            Answer::Refused(_) => Some([fit_of(contacts, None, 2)?, fit_of(contacts, None, 3)?]),
        }
    }
}

/// A named fit's uncertainty is noise alone.
fn estimate(statistic: &Statistic, level: f64) -> Option<Estimate> {
    let (mean, u, interval) = (statistic.mean?, statistic.u?, statistic.interval?);
    let sd = statistic.sd.unwrap_or(0.0);
    let interval = [interval.lo, interval.hi];
    Some(Estimate { mean, sd, u_noise: u, u_model: 0.0, u, interval, level, dof: f64::INFINITY })
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}
