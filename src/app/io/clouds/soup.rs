//! Triangles without names of their vertices, as STL has them: corners at one place are joined, and each gets the normal
//!
//! ```text
//! n_v ~ sum over the triangles (a, b, c) at v of (b - a) x (c - a)        each weighs twice its area
//! ```
//!
//! N. Max, "Weights for Computing Vertex Normals from Facet Normals", J. Graphics Tools 4(2), 1999, compares the weights.

use std::collections::HashMap;

use crate::io::columns::{Column, Columns};
use crate::io::facets::{FacetContacts, sampled};

/// Vertices with normals, in the order in which they first appear.
#[derive(Debug, Default)]
pub(super) struct Soup {
    places: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
    known: HashMap<[u64; 3], usize>,
}

impl Soup {
    /// Adds a triangle whose corners run anticlockwise, seen from outside.
    pub(super) fn add(&mut self, corners: [[f64; 3]; 3]) {
        let [a, b, c] = corners;
        let [p, q] = [b, c].map(|v| [0, 1, 2].map(|k| v[k] - a[k]));
        let cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        let triangle = corners.map(|corner| {
            // -0 and 0 are one place
            let key = corner.map(|v| (v + 0.0).to_bits());
            let vertex = *self.known.entry(key).or_insert_with(|| {
                self.places.push(corner);
                self.normals.push([0.0; 3]);
                self.places.len() - 1
            });
            let normal = &mut self.normals[vertex];
            *normal = [0, 1, 2].map(|k| normal[k] + cross[k]);
            vertex
        });
        self.triangles.push(triangle);
    }

    /// Contacts on the triangles, where these are coarse.
    pub(super) fn sampled(&self) -> Option<FacetContacts> {
        sampled(&self.places, &self.triangles, None)
    }

    /// The vertices as columns, without those that have no normal, and the number of these.
    pub(super) fn into_columns(self, file: &str) -> Result<(Columns, usize), crate::io::IoError> {
        let has_normal = |n: &[f64; 3]| n.iter().any(|v| *v != 0.0);
        let kept: Vec<usize> = (0..self.places.len()).filter(|&v| has_normal(&self.normals[v])).collect();
        let mut columns = Columns::named(file, &["x", "y", "z", "nx", "ny", "nz"], crate::io::columns::Need::Contacts)?;
        let of = |values: &[[f64; 3]], k: usize| kept.iter().map(|&v| values[v][k]).collect::<Vec<f64>>();
        for (k, column) in [Column::X, Column::Y, Column::Z].into_iter().enumerate() {
            columns.set(column, of(&self.places, k));
        }
        for (k, column) in [Column::Nx, Column::Ny, Column::Nz].into_iter().enumerate() {
            columns.set(column, of(&self.normals, k));
        }
        Ok((columns, self.places.len() - kept.len()))
    }
}
