//! What contacts show that go round a body or bend strongly: primitives in space, one posterior over all of them.
//!
//! ```text
//! contact i: place p_i, perhaps a direction n_i                base B(theta): signed distance, normal, curvatures
//! d(p_i; theta) = f(q_i) + e_i                                 f ~ GP(0, tau^2 exp(-|q - q'|^2 / 2 l^2)) over the feet q, or absent
//! n_i = normal of the displaced base + error                   e ~ N(0, s^2), normals N(0, s_n^2) in each tangent direction
//! a contact is false with probability eps                      then it lies anywhere within the reach, with any normal
//! hypothesis = kind x length x size x reading of the departure evidence: exact in f, Laplace in theta, s integrated
//! answer = one set of weighted draws of theta                  kind, S, R, radius, place, axis and map are all read from it
//! ```
//!
//! The base needs no chart and no patch frame, so that 3 degrees of a ball and all of it are the same to it. A. O'Hagan and
//! M. C. Kennedy, *J. R. Statist. Soc. B* 63 (2001) 425, on the departure; H. Rue, S. Martino and N. Chopin, *ibid.* 71 (2009) 319, on
//! Laplace's method in what is not linear.

mod body_hypothesis;
mod body_posterior;
mod candidates;
mod chart;
mod coordinates;
mod departure;
mod departure_kernel;
mod departure_reading;
mod division;
mod division_prior;
mod equations;
mod evidence;
mod faces;
#[cfg(test)]
mod few_touches_tests;
mod finer_shape;
mod free_surface;
mod inference;
mod kernel_layer;
mod level_set;
mod mode;
mod one_sensor;
mod other_things;
mod posterior;
mod prior;
mod rows;
mod sample;
mod search;
mod sides;
mod surface_reading;
mod symmetry;
#[cfg(test)]
mod symmetry_tests;
#[cfg(test)]
mod tests;
mod thing;
mod tuning;

pub(crate) use body_hypothesis::BodyHypothesis;
pub(crate) use body_posterior::BodyPosterior;
pub(crate) use chart::BodyChart;
pub(crate) use coordinates::Symmetry;
pub(crate) use division::is_simple;
pub(crate) use free_surface::with_own_contacts;
pub(crate) use inference::{FoundBody, Verdict, infer, infer_primitives, posterior_of_primitives};
pub(crate) use mode::aligned;
pub(crate) use other_things::{price_of_unknowns, scatter};
pub(crate) use posterior::{DrawnBase, PosteriorSpread, draws as drawn, spread};
pub(crate) use sample::BodySample;
pub(crate) use thing::{PossibleThings, Thing};
pub use tuning::Tuning;
