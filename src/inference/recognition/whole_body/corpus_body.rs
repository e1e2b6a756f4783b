//! A body of a corpus, for which settings of priors are learned: how probable its contacts are under any.
//!
//! ```text
//! p(contacts; t) = sum over hypotheses of prior(t) x evidence(t)        t: a setting
//! the likeliest t of a corpus is where the sum of ln p over its bodies is largest
//! ```
//!
//! That is the marginal likelihood of type II (J. Berger, *Statistical Decision Theory and Bayesian Analysis*, section 3.5). Modes are looked for
//! once, with the defaults: settings of priors move a mode by far less than its width.

use crate::bodies::{BodySample, FoundBody, Tuning};
use crate::recognition::RecognitionOptions;
use crate::recognition::contacts::Observations;
use palpate_geometry::contact::Contacts;

/// Contacts of one body with the modes of all primitives among them.
#[derive(Debug)]
pub struct CorpusBody {
    found: FoundBody,
}

/// What a body's contacts say under some settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorpusEvidence {
    /// ln p of the contacts, in units of their own size.
    pub log_evidence: f64,
    /// Probabilities of plane, sphere, cylinder, cone, torus and ellipsoid.
    pub kinds: [f64; 6],
}

impl CorpusBody {
    /// `None` where contacts have no extent or are none.
    pub fn new(contacts: &Contacts) -> Option<CorpusBody> {
        let options = RecognitionOptions::default();
        let given = Observations::from_contacts(contacts, &options).ok()?;
        let normals = given.normals.as_deref().unwrap_or_default();
        let sample = BodySample::new(&given.points, normals, given.rounding)?;
        Some(CorpusBody { found: FoundBody::new(&sample, &options.tuning) })
    }

    /// Under these settings; `None` where no primitive has any evidence.
    pub fn evidence(&self, tuning: &Tuning) -> Option<CorpusEvidence> {
        let posterior = self.found.posterior(tuning)?;
        Some(CorpusEvidence { log_evidence: posterior.log_sum(), kinds: posterior.weights_of_kinds() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn egg(ratio: f64, size: f64) -> Contacts {
        let point = |i: usize| {
            let (sin, cos) = (2.4 * i as f64).sin_cos();
            let h = 1.0 - (2.0 * i as f64 + 1.0) / 40.0;
            let across = (1.0 - h * h).sqrt();
            let error = 1.0 + size * (97.0 * (i as f64 + 1.0).powf(1.3)).sin();
            [across * cos, ratio * across * sin, ratio.sqrt() * h].map(|v| error * v)
        };
        Contacts::from_points(&(0..40).map(point).collect::<Vec<[f64; 3]>>())
    }

    #[test]
    fn contacts_of_a_long_egg_are_likelier_where_half_axes_differ_more() {
        let long = CorpusBody::new(&egg(0.4, 0.004)).unwrap();
        let round = CorpusBody::new(&egg(0.9, 0.004)).unwrap();
        let by = |body: &CorpusBody, half_axes: f64| {
            body.evidence(&Tuning { half_axes, ..Tuning::default() }).unwrap().log_evidence
        };
        assert!(by(&long, 0.4) > by(&long, 0.1) && by(&round, 0.1) > by(&round, 0.4));
    }

    #[test]
    fn prior_odds_move_the_probabilities_of_kinds_by_their_ratio() {
        let body = CorpusBody::new(&egg(0.9, 0.1)).unwrap();
        let even = body.evidence(&Tuning::default()).unwrap();
        let eggs = Tuning { kinds: [1.0, 1.0, 1.0, 1.0, 1.0, 3.0], ..Tuning::default() };
        let more = body.evidence(&eggs).unwrap();
        let odds = |found: &CorpusEvidence| found.kinds[5] / (1.0 - found.kinds[5]);
        assert!(even.kinds[5] > 0.01 && even.kinds[5] < 0.99, "{even:?}");
        assert!((odds(&more) / odds(&even) - 3.0).abs() < 1e-6, "{even:?} {more:?}");
        assert!((more.kinds.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    }
}
