//! Surfaces of truncated hierarchical B-splines: knots only where the contacts ask for them, on sparse factorisations.
//!
//! ```text
//! mesh       which cells and knots there are, graded          space      the functions, and how they stand on every cell
//! field      S(x, y) with two derivatives                     equations  sums of contacts by cell, sparse normal equations, roughness
//! factor     sparse Cholesky, entries of the inverse          adaptive   fits that split cells by evidence and stop at the noise
//! ```
//!
//! It is a part of `palpate`, which people add and install; its names may change with every release.

pub mod adaptive;
pub mod equations;
pub mod error;
pub mod factor;
pub mod field;
pub mod mesh;
pub mod space;

pub use error::HierarchyError;
