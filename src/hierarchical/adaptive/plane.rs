//! Whether the contacts need more than a plane.
//!
//! ```text
//! p = P(F > ((rss(plane) - rss(S)) / (f - 3)) / (rss(S) / (N - f))),   rss = sum share w^2 (z - .)^2, f degrees of freedom of S
//! ```
//!
//! Heights alone decide: normals of a plane are all alike, and where they are not, heights over many contacts say so, too.

use super::refinement::MeshRefinement;
use palpate_geometry::shape::f_upper_tail;
use palpate_numeric::linalg::small;

/// p-value of the best plane against the surface of so many degrees of freedom.
pub(super) fn plane_probability(refinement: &MeshRefinement, freedom: f64) -> Option<f64> {
    let contacts = refinement.contacts.contacts();
    let weights = contacts.weights.z.as_deref();
    let weight = |r: usize| {
        let w = weights.map_or(1.0, |w| w[r]);
        refinement.shares.as_ref().map_or(1.0, |shares| shares[r]) * w * w
    };
    let (mut matrix, mut load) = ([[0.0; 3]; 3], [0.0; 3]);
    for r in 0..contacts.len() {
        let (w, row) = (weight(r), [1.0, contacts.x[r], contacts.y[r]]);
        for a in 0..3 {
            (0..3).for_each(|b| matrix[a][b] += w * row[a] * row[b]);
            load[a] += w * row[a] * contacts.z[r];
        }
    }
    let plane = small::solve(&small::cholesky(&matrix)?, load);
    let (mut of_plane, mut rest, mut rows) = (0.0, 0.0, 0.0);
    for r in 0..contacts.len() {
        let w = weight(r);
        of_plane += w * (contacts.z[r] - plane[0] - plane[1] * contacts.x[r] - plane[2] * contacts.y[r]).powi(2);
        rest += w * refinement.residuals.heights[r].powi(2);
        rows += if w > 0.0 { 1.0 } else { 0.0 };
    }
    // a surface that is a plane but for rounding uses next to nothing
    let (used, left) = ((freedom - 3.0).max(1.0), rows - freedom);
    (left > 0.0).then(|| f_upper_tail(((of_plane - rest) / used) / (rest / left), used, left))
}
