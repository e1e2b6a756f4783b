//! From data to equations: the rows of `[N o M; N' o M; N o M']`, their weights and their targets.
//!
//! ```text
//! slope rows    wz (z - S)      wx (zx - S_x)     wy (zy - S_y)                    paper Eq. 14, linear
//! normal rows   (z - S)/Z       (n - n^(S_x, S_y))/sigma, n^ = (-S_x, -S_y, 1)/w   maximum likelihood, Gauss-Newton
//! ```
//!
//! [`ScatteredSites`] forms the row-wise Khatri-Rao product contact by contact, [`GridSites`] stores the two Kronecker
//! factors of a grid separately; both implement [`palpate_numeric::linalg::Sites`].

mod cells;
mod csr;
mod data;
mod gridded;
mod kronecker;
mod normal_rows;
#[cfg(test)]
mod one_by_one;
mod roughness;
mod scattered;
#[cfg(test)]
mod single_sites;
mod slope_rows;

pub use cells::{CellAssembly, CellRows, PackedCells, PackedRows};
pub use csr::{stacked_csr, to_csr};
pub use data::{Data, Measured};
pub use gridded::GridSites;
pub use kronecker::kronecker_normal_matrix;
pub use normal_rows::{angular_residual_squared, linearise_normals, normal_curving};
pub use roughness::{Roughness, RoughnessOrder, roughness_matrix, roughness_row_count, roughness_rows, roundings};
pub use scattered::CellNumbers;
pub use scattered::ScatteredSites;
