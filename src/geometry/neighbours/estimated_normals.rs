//! Normals of contacts that have none, from the planes through their neighbours.
//!
//! ```text
//! n_i = direction of least spread of the 13 contacts nearest to contact i, itself included
//! signs carried from neighbour to neighbour, then all towards the viewpoint, or towards +z where none is given
//! ```
//!
//! H. Hoppe et al., *Surface reconstruction from unorganized points*, SIGGRAPH 1992. Such normals tell nothing new:
//! they follow from the positions, and a recognition uses them for the free side alone.

use faer::{Mat, Side};

use crate::contact::{ContactError, Contacts, Orientation};
use palpate_numeric::vector::{Vector, minus};

use super::neighbour_lists::NeighbourLists;
use super::orientation::oriented_anew;
use super::tree::Neighbours;

/// Contacts in the plane through a neighbourhood, its own included.
pub const NEAREST: usize = 13;

impl Contacts {
    /// The same contacts with a normal each, estimated from the planes through neighbouring positions; towards `viewpoint`,
    /// or towards +z where none is given. Such normals tell the free side and nothing else.
    ///
    /// ```
    /// # use palpate_geometry::facade as palpate;
    /// use palpate::{Contacts, Orientation};
    ///
    /// let points: Vec<[f64; 3]> = (0..25).map(|r| [f64::from(r % 5), f64::from(r / 5), 0.0]).collect();
    /// let contacts = Contacts::from_points(&points).with_estimated_normals(None)?;
    /// let Orientation::Normals { nz, .. } = &contacts.orientation else { panic!("no normals") };
    /// assert!(nz.iter().all(|nz| (nz - 1.0).abs() < 1e-12));
    /// # Ok::<(), palpate::ContactError>(())
    /// ```
    ///
    /// # Errors
    /// When a coordinate is not finite or the columns differ in length.
    pub fn with_estimated_normals(&self, viewpoint: Option<[f64; 3]>) -> Result<Contacts, ContactError> {
        let bare = Contacts { orientation: Orientation::None, ..self.clone() };
        bare.check()?;
        let points: Vec<Vector> = (0..bare.len()).map(|r| [bare.x[r], bare.y[r], bare.z[r]]).collect();
        let tree = Neighbours::new(&points);
        let upward = |n: Vector| if n[2] < 0.0 { n.map(|v| -v) } else { n };
        let normals = points.iter().map(|p| plane_normal(&tree, &points, *p).map_or([0.0, 0.0, 1.0], upward)).collect();
        Ok(bare.with_normal_vectors(
            &oriented_anew(&points, normals, viewpoint, &NeighbourLists::<NEAREST>::new(&points)).normals,
        ))
    }
}

/// Normal of the plane through the nearest contacts, of either sign.
pub fn plane_normal(tree: &Neighbours, points: &[Vector], place: Vector) -> Option<Vector> {
    let near = tree.nearest(place, NEAREST);
    let mut mean = [0.0; 3];
    for (_, i) in &near {
        (0..3).for_each(|k| mean[k] += points[*i as usize][k] / near.len() as f64);
    }
    let mut covariance = Mat::<f64>::zeros(3, 3);
    for (_, i) in &near {
        let d = minus(points[*i as usize], mean);
        for r in 0..3 {
            (0..=r).for_each(|c| covariance[(r, c)] += d[r] * d[c]);
        }
    }
    let eigen = covariance.self_adjoint_eigen(Side::Lower).ok()?;
    Some([0, 1, 2].map(|r| eigen.U()[(r, 0)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::vector::dot;

    #[test]
    fn normals_of_a_ball_point_out_or_to_the_viewpoint() {
        let points: Vec<Vector> = (0..900)
            .map(|i| [(i % 30) as f64 / 30.0 - 0.5, (i / 30) as f64 / 30.0 - 0.5])
            .map(|[x, y]| [x, y, (1.0 - x * x - y * y).sqrt()])
            .collect();
        let out = |viewpoint| {
            let Orientation::Normals { nx, ny, nz } =
                Contacts::from_points(&points).with_estimated_normals(viewpoint).unwrap().orientation
            else {
                panic!("no normals")
            };
            (0..900).map(|r| dot([nx[r], ny[r], nz[r]], points[r])).collect::<Vec<f64>>()
        };
        assert!(out(None).iter().all(|cosine| *cosine > 0.98));
        assert!(out(Some([0.0, 0.0, -5.0])).iter().all(|cosine| *cosine < -0.98));
    }
}
