//! Whether the contacts need more than a plane.
//!
//! ```text
//! p = P(F > ((rss(plane) - rss(S)) / (f - 3)) / (rss(S) / (N - f))),   rss = sum share w^2 (z - .)^2, f degrees of freedom of S
//! ```
//!
//! Heights alone decide: normals of a plane are all alike, and where they are not, heights over many contacts say so, too.

use super::refinement::MeshRefinement;
use crate::error::HierarchyError;
use palpate_geometry::shape::f_upper_tail;
use palpate_numeric::linalg::small;

/// p-value of the best plane against the surface of so many degrees of freedom.
pub(super) fn plane_probability(
    refinement: &mut MeshRefinement<'_>,
    freedom: f64,
) -> Result<Option<f64>, HierarchyError> {
    let MeshRefinement { passes, field, .. } = refinement;
    let [w, x, y, xx, xy, yy, z, xz, yz] = passes.plane_moments(field)?;
    let Some(root) = small::cholesky(&[[w, x, y], [x, xx, xy], [y, xy, yy]]) else { return Ok(None) };
    let [of_plane, rest, rows] = passes.plane_squares(field, small::solve(&root, [z, xz, yz]))?;
    // a surface that is a plane but for rounding uses next to nothing
    let (used, left) = ((freedom - 3.0).max(1.0), rows - freedom);
    Ok((left > 0.0).then(|| f_upper_tail(((of_plane - rest) / used) / (rest / left), used, left)))
}
