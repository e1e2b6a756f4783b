//! Normals of contacts that have none, from the planes through their neighbours.
//!
//! ```text
//! n_i = direction of least spread of the 13 contacts nearest to contact i, itself included
//! signs carried from neighbour to neighbour, then all towards the viewpoint, or towards +z where none is given
//! ```
//!
//! H. Hoppe et al., *Surface reconstruction from unorganized points*, SIGGRAPH 1992. Such normals tell nothing new:
//! they follow from the positions, and [`Recognition::of`](crate::recognition::Recognition::of) uses them for the free side alone.

use crate::contact::{ContactError, Contacts, Orientation};
use crate::vector::Vector;

use super::believable_normals::plane_normal;
use super::neighbours::Neighbours;
use super::orientation::oriented;

impl Contacts {
    /// The same contacts with a normal each, estimated from the planes through neighbouring positions; towards `viewpoint`,
    /// or towards +z where none is given. Such normals tell the free side and nothing else.
    ///
    /// ```
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
        Ok(bare.with_normal_vectors(&oriented(&points, normals, viewpoint).normals))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::dot;

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
