//! What is known after some contacts, and why an exploration ended.

use palpate_inference::recognition::Estimate;
use palpate_world::scene::Truth;

use super::answer::Answer;
use super::curvature_departure_test::Departure;

/// Why it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// The goal holds.
    Goal,
    /// The budget is spent.
    Budget,
    /// The goal is below what the noise allows with this budget.
    Noise,
    /// The goal is below what doubt about the model allows.
    Model,
    /// No place is left to touch.
    Places,
    /// Whoever watched asked for it.
    Asked,
}

impl Stopped {
    /// The word in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Stopped::Goal => "goal",
            Stopped::Budget => "budget",
            Stopped::Noise => "noise",
            Stopped::Model => "model",
            Stopped::Places => "places",
            Stopped::Asked => "asked",
        }
    }
}

/// What is known after some contacts.
#[derive(Clone, Debug)]
pub struct Look {
    /// Contacts so far.
    pub contacts: usize,
    /// Places touched since the look before.
    pub touched: Vec<[f64; 2]>,
    /// S; `None` on a plane, or where there is no answer.
    pub shape_index: Option<Estimate>,
    /// R; `None` where there is no answer.
    pub curvedness: Option<Estimate>,
    /// What the contacts show: the kind of surface, or the class under a named model.
    pub kind: Option<String>,
    /// True S and R at the places that the means were taken over.
    pub truth: [Option<f64>; 2],
    /// Part of the map that contacts support.
    pub support: f64,
    /// u(S) and u(R)/R that noise would leave after the whole budget; `None` without a goal.
    pub attainable: Option<[f64; 2]>,
    /// Probability of so good an explanation by a richer spline, if what was recognised were all there is; `None` without
    /// a goal, under a named model, and where contacts are too few to ask.
    pub richer_p: Option<f64>,
    /// How the contacts depart from what was recognised; `None` as `richer_p` is.
    pub(super) departure: Option<Departure>,
    /// Whether a named model answered.
    pub named: bool,
    /// Why there is no answer.
    pub refused: Option<String>,
}

impl Look {
    /// Of what the contacts answer.
    pub(super) fn new(contacts: usize, touched: Vec<[f64; 2]>, answer: &Answer, truth: &Truth) -> Look {
        let [shape_index, curvedness] = answer.estimates();
        Look {
            contacts,
            touched,
            shape_index,
            curvedness,
            kind: answer.kind(),
            truth: answer.truth(truth),
            support: answer.support(),
            attainable: None,
            richer_p: None,
            departure: None,
            named: answer.is_named(),
            refused: answer.refused(),
        }
    }

    /// u(S) and u(R)/R; S of a plane is not asked for.
    pub(super) fn totals(&self) -> Option<[f64; 2]> {
        self.each(|estimate| estimate.u)
    }

    /// The part of both that is not independent noise.
    pub(super) fn models(&self) -> Option<[f64; 2]> {
        self.each(|estimate| estimate.u_model)
    }

    /// The part of both that is.
    pub(super) fn noises(&self) -> Option<[f64; 2]> {
        self.each(|estimate| estimate.u_noise)
    }

    fn each(&self, of: impl Fn(&Estimate) -> f64) -> Option<[f64; 2]> {
        let r = self.curvedness.as_ref()?;
        let s = self.shape_index.as_ref()?;
        Some([of(s), of(r) / r.mean])
    }
}
