//! The kinds of surface that were compared, with how probable and how near each is.
//!
//! ```text
//! probability of a kind = sum of the weights of its nodes         rms = root mean square distance of the contacts from its likeliest surface
//! ```

use crate::recognition::evidence::{self, Node, curvatures};
use crate::recognition::kinds::Model;
use crate::recognition::start::weighted_rms;
use crate::recognition::{Hypothesis, Tried};

use super::inference::Findings;
use super::normalised_weights::total;
use super::posterior::likeliest;

impl Findings<'_> {
    /// All hypotheses that have a node, likeliest first.
    pub(super) fn tried(&self) -> Vec<Tried> {
        let scale = self.patch.frame.scale;
        let mut out: Vec<Tried> = Hypothesis::ALL
            .into_iter()
            .filter_map(|hypothesis| {
                let own = |n: &Node| n.hypothesis() == hypothesis;
                let best = evidence::likeliest(self.nodes.iter().filter(|n| own(n)))?;
                let model = self.evidence.models.iter().find(|m| m.kind() == best.kind)?;
                let [k1, k2] = curvatures(model, &best.x).map(|k| k / scale);
                let weight = total(&self.weights.estimate, self.nodes, own);
                Some(Tried { hypothesis, weight, k1, k2, rms: scale * self.rms(best, model) })
            })
            .collect();
        out.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        out
    }

    /// Root mean square distance of the contacts from a hypothesis: from its kind, or from a body, or over a plane, which is no kind, from
    /// the surface that stands there.
    fn rms(&self, node: &Node, model: &Model) -> f64 {
        let stands_there = node.is_body() || (node.is_displaced() && model.is_flat());
        match stands_there.then(|| likeliest(self.evidence, node)).flatten() {
            Some(state) => self.size(&self.residuals(node, &state)),
            None => weighted_rms(self.evidence.cells, model),
        }
    }
}

/// The hypothesis of largest weight, where general's two references count together; the plane only when it has more
/// than half of all weight, because the class then is plane too.
pub(super) fn reported(tried: &[Tried]) -> Option<Hypothesis> {
    let weight = |h: Hypothesis| tried.iter().filter(|t| t.hypothesis == h).map(|t| t.weight).sum::<f64>();
    let general = weight(Hypothesis::General) + weight(Hypothesis::Paraboloid);
    let eligible = tried.iter().filter(|t| t.hypothesis != Hypothesis::Plane || t.weight > 0.5);
    let best = eligible.max_by(|a, b| a.weight.total_cmp(&b.weight))?;
    if best.hypothesis == Hypothesis::Plane || best.weight >= general {
        return Some(best.hypothesis);
    }
    let torus = weight(Hypothesis::General) >= weight(Hypothesis::Paraboloid);
    Some(if torus { Hypothesis::General } else { Hypothesis::Paraboloid })
}
