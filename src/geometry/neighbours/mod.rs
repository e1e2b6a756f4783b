//! Which contacts lie near each other, and what neighbours say of a normal.
//!
//! ```text
//! tree               the k nearest of n points in O(log n)
//! neighbour_lists    the k nearest of every point
//! morton_order       points along a curve that fills space
//! orientation        signs of normals, carried along a spanning tree of neighbours
//! estimated_normals  the normal of the plane through the nearest contacts
//! ```

mod estimated_normals;
mod morton_order;
mod neighbour_lists;
mod orientation;
mod tree;

pub use estimated_normals::{NEAREST, plane_normal};
pub use morton_order::morton_order;
pub use neighbour_lists::NeighbourLists;
pub use orientation::{Oriented, mean_of, oriented, oriented_among, oriented_anew};
pub use tree::Neighbours;
