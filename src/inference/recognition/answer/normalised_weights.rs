//! Shares of hypotheses: in proportion to their evidence, summed, and raised to what they must have.
//!
//! ```text
//! share of a node = exp(log evidence) / sum of exp(log evidence) over the nodes chosen
//! ```

use crate::recognition::evidence::{Node, highest};

/// Shares in proportion to the evidence among the nodes chosen, 0 elsewhere; all 0 when none is chosen.
pub(super) fn shares(nodes: &[Node], chosen: impl Fn(&Node) -> bool) -> Vec<f64> {
    let largest = highest(nodes.iter().filter(|n| chosen(n)));
    let mut out: Vec<f64> =
        nodes.iter().map(|n| if chosen(n) { (n.log_evidence - largest).exp() } else { 0.0 }).collect();
    let sum: f64 = out.iter().sum();
    if sum > 0.0 {
        out.iter_mut().for_each(|w| *w /= sum);
    }
    out
}

/// Sum of the weights of the nodes chosen.
pub(super) fn total(weights: &[f64], nodes: &[Node], chosen: impl Fn(&Node) -> bool) -> f64 {
    weights.iter().zip(nodes).filter(|(_, n)| chosen(n)).map(|(w, _)| w).sum()
}

/// Gives the nodes chosen the share `to` of what the nodes `within` have, in proportion to their evidence.
pub(super) fn raise(
    weights: &mut [f64],
    nodes: &[Node],
    chosen: impl Fn(&Node) -> bool,
    within: impl Fn(&Node) -> bool,
    to: f64,
) {
    let all = total(weights, nodes, &within);
    let others = all - total(weights, nodes, &chosen);
    let fresh = shares(nodes, &chosen);
    if fresh.iter().sum::<f64>() == 0.0 {
        return;
    }
    for ((w, node), fresh) in weights.iter_mut().zip(nodes).zip(fresh) {
        if chosen(node) {
            *w = to * all * fresh;
        } else if within(node) && others > 0.0 {
            *w *= (1.0 - to) * all / others;
        }
    }
}

/// Largest log evidence among the nodes chosen.
pub(super) fn best(nodes: &[Node], chosen: impl Fn(&Node) -> bool) -> f64 {
    highest(nodes.iter().filter(|n| chosen(n)))
}
