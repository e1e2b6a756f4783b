//! Shape of a patch: S and R over a grid, their means and spread, a class, a radius, and their uncertainty.
//!
//! ```text
//! S_g, R_g at every grid point g that the data support     mean, sd (n - 1)
//! u^2(mean S) = g' C g,   g = d(mean S)/dc,  C the coefficients' covariance       (delta method)
//! P(class) = Phi((hi - mean)/u) - Phi((lo - mean)/u)
//! ```
//!
//! The spread over the patch is not uncertainty: R varies over a paraboloid, for example, without any noise.

pub mod dual;
mod gradient;
#[cfg(test)]
mod gradient_kernel;
mod grid;
mod grid_gradients;
mod jet_gradient;
mod maps;
mod outline;
mod parametric_maps;
mod plane;
mod point_sds;
mod pointwise;
mod repeated_gradients;
mod report;
mod summary;
mod support;
mod triangle_bins;
mod truth;
mod uv_support;

pub use gradient::{by_coefficients, shape_gradient};
pub use gradient::{gap_gradient, mean_gradients, umbilic_gradients};
pub use grid::ShapeGrid;
pub use grid_gradients::{EightPoints, GridGradients};
pub use jet_gradient::{INPUTS, jet_gradient};
pub use maps::ShapeMaps;
pub use maps::{Spread, spread};
pub use outline::Outline;
pub use parametric_maps::parametric_maps_at;
pub use parametric_maps::{ParametricMaps, parametric_maps, uv_grid};
pub use plane::{PLANE_SIGNIFICANCE, best_plane, chi_square_upper_tail, f_upper_tail};
pub use point_sds::PointSds;
pub use pointwise::{ByJet, ShapeSds, Uncertain, point_sds, principal_gradients};
pub use repeated_gradients::RepeatedGradients;
pub use report::{ShapeReport, Statistic, every_class};
pub use summary::Interval;
pub use summary::{class_probabilities, normal_interval, radius_of};
pub use support::Support;
pub use truth::{ShapeAt, TruthComparison, compare_pairs, compare_with_truth};
pub use uv_support::UvSupport;
