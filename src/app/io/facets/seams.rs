//! Seams: where two facets meet, or a facet ends.
//!
//! ```text
//! angle between the normals of two facets < 0.1 degrees     one flat face goes on
//!                                         < 40 degrees      one smooth surface
//! ```
//!
//! Chamfers have 45 degrees and are edges. A round bar drawn with nine sides has 40; one with fewer is taken for the prism that it is.

use palpate_numeric::vector::{cross, dot, norm};

use super::Facets;

/// From which angle on, in radians, two facets meet in an edge.
pub(super) const SHARP: f64 = 40.0 * std::f64::consts::PI / 180.0;

/// How the surface goes on across a seam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SeamKind {
    /// Within one flat face.
    Flat,
    /// The surface bends.
    Smooth,
    /// It ends: at an edge, at an open rim, or where a flat face meets a bent surface.
    Joint,
}

/// Two vertices and the facets that share them, the same one twice at a rim.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seam {
    pub(super) ends: [usize; 2],
    pub(super) facets: [usize; 2],
    /// Both facets run along it the same way: one of them is wound against the other.
    pub(super) against: bool,
    pub(super) kind: SeamKind,
}

impl Seam {
    pub(super) fn other(&self, facet: usize) -> Option<usize> {
        let [f, g] = self.facets;
        (f != g).then_some(if facet == f { g } else { f })
    }
}

/// All seams, in the order of their vertices.
pub(super) struct Seams {
    pub(super) all: Vec<Seam>,
    /// The three of each facet.
    pub(super) of: Vec<[usize; 3]>,
}

impl Seams {
    /// The seams before it is known how the surface goes on across them. Where more than two facets meet, the surface ends.
    pub(super) fn between(facets: &Facets) -> Seams {
        let mut sides: Vec<([usize; 2], usize, usize, bool)> = Vec::with_capacity(3 * facets.len());
        for (facet, corners) in facets.corners.iter().enumerate() {
            for side in 0..3 {
                let [a, b] = [corners[side], corners[(side + 1) % 3]];
                sides.push(([a.min(b), a.max(b)], facet, side, a < b));
            }
        }
        sides.sort_unstable();
        let mut seams = Seams { all: Vec::new(), of: vec![[0; 3]; facets.len()] };
        for group in sides.chunk_by(|a, b| a.0 == b.0) {
            match group {
                [(ends, f, s, forth), (_, g, t, back)] => {
                    seams.of[*f][*s] = seams.all.len();
                    seams.of[*g][*t] = seams.all.len();
                    seams.all.push(Seam {
                        ends: *ends,
                        facets: [*f, *g],
                        against: forth == back,
                        kind: SeamKind::Smooth,
                    });
                }
                rims => {
                    for (ends, f, s, _) in rims {
                        seams.of[*f][*s] = seams.all.len();
                        seams.all.push(Seam { ends: *ends, facets: [*f; 2], against: false, kind: SeamKind::Joint });
                    }
                }
            }
        }
        seams
    }
}

/// Angle between the normals of two facets, in radians.
pub(super) fn angle(facets: &Facets, f: usize, g: usize) -> f64 {
    let [a, b] = [facets.normals[f], facets.normals[g]];
    norm(cross(a, b)).atan2(dot(a, b))
}
