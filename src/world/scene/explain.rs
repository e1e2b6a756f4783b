//! What a compiled scene consists of, stage by stage.
//!
//! Only effects that the scene names become stages. Time is measured by the caller, because this room reads no clock: see
//! [`Simulator::run_stage`].

use super::batch::ContactBatch;
use super::simulate::Simulator;

/// One stage of a compiled scene.
#[derive(Clone, Debug, PartialEq)]
pub struct StageLine {
    /// Name as in a scene file.
    pub name: &'static str,
    /// What it changes.
    pub changes: String,
    /// Random numbers per contact.
    pub draws_per_contact: usize,
    /// Whether it leaves x and y as they are.
    pub keeps_sites: bool,
}

impl Simulator {
    /// The stages in the order they are applied.
    pub fn explain(&self) -> Vec<StageLine> {
        self.stages()
            .iter()
            .map(|stage| StageLine {
                name: stage.name(),
                changes: stage.changes(),
                draws_per_contact: stage.draws_per_contact(),
                keeps_sites: stage.keeps_sites(),
            })
            .collect()
    }

    /// Applies one stage alone to a batch (from [`Simulator::simulate_batch`]); for a caller with a clock.
    ///
    /// # Panics
    /// When there is no stage of this number.
    pub fn run_stage(&self, stage: usize, seed: u64, batch: &mut ContactBatch) {
        self.stages()[stage].apply(batch, &self.draws(stage, seed));
    }
}

/// A plain table of the stages; `nanoseconds` per contact where they were measured, in the same order.
pub fn table(simulator: &Simulator, nanoseconds: &[f64]) -> String {
    let (reachable, total) = simulator.reach();
    let mut text =
        format!("surface  {}, {reachable} of {total} sites within reach\n", simulator.truth().surface().body.kind());
    if let Some(label) = simulator.truth().inverse_crime() {
        text.push_str(&format!("inverse crime: the surface is itself a fit ({label})\n"));
    }
    if simulator.stages().is_empty() {
        text.push_str("no effects: the contacts are the touched points\n");
        return text;
    }
    text.push_str(&format!("{:<18} {:>5} {:>12} {:>6}  {}\n", "stage", "draws", "ns/contact", "sites", "changes"));
    for (index, line) in simulator.explain().iter().enumerate() {
        let time = nanoseconds.get(index).map_or("-".into(), |ns| format!("{ns:.1}"));
        let sites = if line.keeps_sites { "kept" } else { "moved" };
        text.push_str(&format!(
            "{:<18} {:>5} {:>12} {:>6}  {}\n",
            line.name, line.draws_per_contact, time, sites, line.changes
        ));
    }
    text
}
