//! The structured system: `minimise |W (E c - b)|^2`, where E consists of tensor-product rows and is never formed.
//!
//! ```text
//! one site:   rows   wz  (N  o M )                      value row
//!                    a (N' o M) + b (N o M')            slope rows: a 2 x 2 upper triangle [a b; 0 d] times (S_x, S_y)
//!                    d (N  o M')
//! all sites:  A = E'E (stencil of a tensor spline),  E'b,  b - E c
//! ```
//!
//! [`Sites`] says where the data lie and has two implementations, scattered and gridded. [`RowWeights`] holds the weights
//! of the rows, [`Targets`] their right-hand sides. Everything else is written once, over these three.

mod blocks;
mod condition;
mod conjugate_gradients;
mod dense;
mod dot;
mod double_double;
mod gram_of_rows;
mod grid_assembly;
mod grid_axis;
mod grid_rows;
mod row_products;
mod site_groups;
mod sites;
pub mod small;
mod stencil;

pub use blocks::{BlockMatrix, MapShape};
pub use condition::inverse_norm1_estimate;
pub use conjugate_gradients::{GradientLimits, conjugate_gradients};
pub use dense::{Eigen, cholesky, eigen, product};
pub use dot::dot;
pub(crate) use dot::partial_dots;
pub use double_double::DoubleDouble;
pub use gram_of_rows::GramOfRows;
pub use grid_axis::GridAxis;
pub use row_products::{apply_rows, descent, residuals, visit_grid_rows, visit_values};
pub use row_products::{assemble, normal_rhs};
pub use site_groups::{KEPT, SiteGroups, SiteRows};
pub use sites::Site;
pub use sites::{RowWeights, SiteWeights, Sites, Targets};
pub use stencil::{StencilMatrix, TensorShape};
