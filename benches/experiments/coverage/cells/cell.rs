//! What came of one scene: how often each kind of interval held the truth, how wide it was, and how wide it could be.
//!
//! ```text
//! width over the oracle's = median half width / (1.96 sd of the oracle)
//! ```

use palpate::montecarlo::{StudyError, StudyOptions};
use palpate_studies::montecarlo::{Held, Path, Study, coverage};
use serde::{Deserialize, Serialize};

use super::judged::Judged;

/// Half width of a normal law's 95 % interval over its sd.
const NORMAL: f64 = 1.96;

/// Replicates of the study whose errors the Monte Carlo's intervals carry.
const STUDY: u64 = 20_000;

/// Intervals that held the truth, of those asked, with the binomial interval of their share.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Inside {
    pub inside: u64,
    pub asked: u64,
    pub interval: Option<[f64; 2]>,
}

impl Inside {
    fn new(held: &Held) -> Inside {
        Inside { inside: held.inside, asked: held.asked, interval: held.interval.map(|i| [i.lo, i.hi]) }
    }

    pub(crate) fn share(&self) -> Option<f64> {
        (self.asked > 0).then(|| self.inside as f64 / self.asked as f64)
    }
}

/// S or R of one scene.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct CellQuantity {
    /// The delta method's interval, of noise alone.
    pub linear: Inside,
    pub monte_carlo: Inside,
    /// What is printed where the model is named.
    pub named: Inside,
    /// What is printed where none is.
    pub chosen: Inside,
    pub chosen_half_width: Option<f64>,
    pub chosen_over_oracle: Option<f64>,
    /// Least width, over the oracle's, of intervals that also hold surfaces 1 % of the relief beside the family.
    pub least_over_oracle: Option<f64>,
    /// Share of the relief from which on no interval that holds such surfaces is within 1.5 times the oracle's.
    pub goal_departure: Option<f64>,
    /// Errors of the values in whose intervals `chosen` looks for the truth, those of R relative; of random surfaces alone.
    pub errors: Vec<f64>,
}

/// One scene.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Cell {
    pub scene: String,
    pub seed: u64,
    pub replicates: u64,
    pub fitted: u64,
    pub failed: u64,
    /// Mean probability given to the reported class, and the share in which it is the true one.
    pub class_forecast: Option<[f64; 2]>,
    /// S and R.
    pub quantities: [CellQuantity; 2],
}

impl Cell {
    /// Studies the scene, and fits this many of its replicates.
    ///
    /// # Errors
    /// Where the scene cannot be studied.
    pub(crate) fn new(judged: &Judged, replicates: u64) -> Result<Cell, StudyError> {
        let scene = &judged.scene;
        let of_study = if judged.is_random { replicates } else { STUDY.max(replicates) };
        let options = StudyOptions { replicates: of_study, replicates_given: true, ..scene.study.clone() };
        let study = Study::new(scene.world.compile()?, &scene.fit, options, judged.seed)?;
        // whole fits are dear: as many as are asked of, no more
        let enough = if study.engine().path() == Path::Whole { replicates } else { of_study };
        let (state, _) = study.run(study.start(0), enough, &mut |_| true)?;
        let mut fit = scene.fit.clone();
        fit.level = scene.study.level;
        let found = coverage(&study, &fit, replicates, &study.result(&state, 0).quantities);
        let quantity = |q: usize| CellQuantity {
            linear: Inside::new(&found.linear[q]),
            monte_carlo: Inside::new(&found.monte_carlo[q]),
            named: Inside::new(&found.named[q]),
            chosen: Inside::new(&found.chosen[q]),
            chosen_half_width: found.chosen_half_width[q],
            chosen_over_oracle: found.chosen_half_width[q].zip(judged.oracle[q]).map(|(half, sd)| half / (NORMAL * sd)),
            least_over_oracle: judged.least.over_oracle[q],
            goal_departure: judged.least.share_of_goal[q],
            errors: if judged.is_random { found.chosen_errors[q].clone() } else { Vec::new() },
        };
        Ok(Cell {
            scene: scene.name.clone(),
            seed: judged.seed,
            replicates,
            fitted: found.fitted,
            failed: found.failed,
            class_forecast: found.class_forecast,
            quantities: [0, 1].map(quantity),
        })
    }
}
