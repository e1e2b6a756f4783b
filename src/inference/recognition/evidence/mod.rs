//! How probable every hypothesis is.
//!
//! ```text
//! log ev = -(log det Sigma + log det(I + Z'Z) + RSS + log det(H/2 pi))/2 + log prior(node) + log prior(shape)
//! P(hypothesis | contacts) ~ sum of exp(log ev) over its nodes
//! ```
//!
//! `node.rs` says what a hypothesis is. `linearised.rs` collects what the evidence is computed from, about the contacts of
//! `search_context.rs`, `whitened.rs` brings it under one covariance, and `marginal_likelihood.rs` computes it. `evidence_grid.rs` chooses which hypotheses are asked, `relinearise.rs`
//! asks again about a displaced surface, `discrepancy_over_plane.rs` about one that stands over a plane, and `model_search.rs` takes the
//! equations that explain most. `joint_posterior.rs` gives the surfaces of one node.

mod discrepancy_over_plane;
mod evidence_grid;
mod joint_posterior;
mod linearised;
mod marginal_likelihood;
mod model_search;
mod node;
mod relinearise;
mod search_context;
mod whitened;

pub(crate) use linearised::{FactorPair, Linearised};
#[cfg(test)]
pub(crate) use marginal_likelihood::Look;
pub(crate) use marginal_likelihood::{Evidence, curvatures};
pub(crate) use model_search::likeliest_look;
pub(crate) use node::{GROUPS, Node, highest, likeliest};
pub(crate) use search_context::SearchContext;
