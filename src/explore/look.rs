//! What is known after some contacts, and why an exploration ended.

use crate::recognition::{Estimate, Hypothesis, Recognition, RecognitionError};
use crate::scene::Truth;

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
    /// S; `None` on a plane, or where nothing was recognised.
    pub shape_index: Option<Estimate>,
    /// R; `None` where nothing was recognised.
    pub curvedness: Option<Estimate>,
    /// What the contacts show.
    pub hypothesis: Option<Hypothesis>,
    /// True S and R at the places that the means were taken over.
    pub truth: [Option<f64>; 2],
    /// Part of the map that contacts support.
    pub support: f64,
    /// u(S) and u(R)/R that noise would leave after the whole budget; `None` without a goal.
    pub attainable: Option<[f64; 2]>,
    /// Why nothing was recognised.
    pub refused: Option<String>,
}

impl Look {
    /// Of what was recognised, or why nothing was.
    pub(super) fn new(
        contacts: usize,
        touched: Vec<[f64; 2]>,
        found: &Result<Recognition, RecognitionError>,
        truth: &Truth,
    ) -> Look {
        let mut look = Look {
            contacts,
            touched,
            shape_index: None,
            curvedness: None,
            hypothesis: None,
            truth: [None; 2],
            support: 0.0,
            attainable: None,
            refused: None,
        };
        match found {
            Ok(found) => {
                look.shape_index = found.shape_index;
                look.curvedness = Some(found.curvedness);
                look.hypothesis = Some(found.hypothesis);
                look.truth = true_means(found, truth);
                look.support = found.support.0 as f64 / found.support.1.max(1) as f64;
            }
            Err(error) => look.refused = Some(error.to_string()),
        }
        look
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

/// Mean S and R of the true surface at the places that the recognition took its means over.
fn true_means(found: &Recognition, truth: &Truth) -> [Option<f64>; 2] {
    let local: Vec<_> = found.averaged.iter().filter_map(|(point, normal)| truth.near(*point, *normal)).collect();
    let mean = |values: Vec<f64>| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
    [mean(local.iter().filter_map(|l| l.shape_index()).collect()), mean(local.iter().map(|l| l.curvedness()).collect())]
}
