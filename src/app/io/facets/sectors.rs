//! Sectors: the facets around a vertex between sharp edges, with the normal of the surface that they stand for.
//!
//! ```text
//! n ~ sum over the facets of  e1 x e2 / (|e1|^2 |e2|^2)        e1, e2 from the vertex to the other two corners
//! ```
//!
//! This is exact where the vertices lie on a ball, and does not depend on which diagonal a strip of a cylinder or cone is cut along.
//! N. Max, "Weights for Computing Vertex Normals from Facet Normals", J. Graphics Tools 4(2), 1999.

use palpate_numeric::vector::{Vector, along, cross, dot, minus, unit_or_zero};

use super::Facets;
use super::seams::{SHARP, SeamKind, Seams};

/// Sectors by the corners of facets: corner k of facet f is 3 f + k.
pub(super) struct Sectors {
    first: Vec<usize>,
    /// By the sector's first corner.
    normals: Vec<Vector>,
    /// The sector does not go all the way round, or its facets face too many ways for one normal.
    broken: Vec<bool>,
}

impl Sectors {
    pub(super) fn of(facets: &Facets, seams: &Seams) -> Sectors {
        let corners = 3 * facets.len();
        let mut found =
            Sectors { first: (0..corners).collect(), normals: vec![[0.0; 3]; corners], broken: vec![false; corners] };
        for seam in seams.all.iter().filter(|seam| seam.kind != SeamKind::Joint) {
            for end in seam.ends {
                let [a, b] = seam.facets.map(|f| found.root(corner(facets, f, end)));
                found.first[a.max(b)] = a.min(b);
            }
        }
        (0..corners).for_each(|c| found.first[c] = found.root(c));
        for c in 0..corners {
            let [at, b, d] = [0, 1, 2].map(|k| facets.places[facets.corners[c / 3][(c % 3 + k) % 3]]);
            let [e1, e2] = [minus(b, at), minus(d, at)];
            let weight = 1.0 / (dot(e1, e1) * dot(e2, e2));
            let normal = &mut found.normals[found.first[c]];
            *normal = along(*normal, weight, cross(e1, e2));
        }
        found.normals.iter_mut().for_each(|n| *n = unit_or_zero(*n));
        found.mark_broken(facets, seams);
        found
    }

    fn mark_broken(&mut self, facets: &Facets, seams: &Seams) {
        for c in 0..self.first.len() {
            let sector = self.first[c];
            self.broken[sector] |= dot(self.normals[sector], facets.normals[c / 3]) < SHARP.cos();
        }
        for seam in seams.all.iter().filter(|seam| seam.kind == SeamKind::Joint) {
            for (facet, end) in seam.facets.into_iter().flat_map(|f| seam.ends.map(|end| (f, end))) {
                self.broken[self.first[corner(facets, facet, end)]] = true;
            }
        }
    }

    fn root(&mut self, mut c: usize) -> usize {
        while self.first[c] != c {
            self.first[c] = self.first[self.first[c]];
            c = self.first[c];
        }
        c
    }

    /// The sector of `facet` at `vertex`.
    pub(super) fn at(&self, facets: &Facets, facet: usize, vertex: usize) -> usize {
        self.first[corner(facets, facet, vertex)]
    }

    pub(super) fn normal(&self, sector: usize) -> Vector {
        self.normals[sector]
    }

    pub(super) fn is_broken(&self, sector: usize) -> bool {
        self.broken[sector]
    }
}

fn corner(facets: &Facets, facet: usize, vertex: usize) -> usize {
    3 * facet + facets.corners[facet].iter().position(|&v| v == vertex).unwrap_or(0)
}
