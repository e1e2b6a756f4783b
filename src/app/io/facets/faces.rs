//! Flat faces: facets that lie in one plane, and whether the surface is flat there or only drawn so.
//!
//! ```text
//! face     grown from its largest facet over neighbours with angle(n, n_largest) < 0.1 degrees + step / height
//! drawn    it meets others smoothly, and is not larger than 4 times all of these: a strip of a cylinder, a facet of a ball
//! ```
//!
//! The normal of a sliver is as uncertain as its height is small beside the file's last digit. A strip of a bent surface has
//! neighbours of its own size; a flat face that goes over into a rounding has narrow ones.

use super::Facets;
use super::joined::FILE_STEP;
use super::seams::{SHARP, SeamKind, Seams, angle};

/// Angle below which facets lie in one plane, in radians: below it, no one draws a bent surface so finely.
const FLAT: f64 = 0.1 * std::f64::consts::PI / 180.0;

/// A face this many times larger than all that it meets smoothly is flat.
const FLAT_BESIDE: f64 = 4.0;

/// Tells flat, smooth and sharp seams apart; gives back which facets lie in flat faces.
pub(super) fn judge(facets: &Facets, seams: &mut Seams) -> Vec<bool> {
    let faces = Faces::of(facets, seams);
    for seam in &mut seams.all {
        let [f, g] = seam.facets;
        seam.kind = if f == g {
            SeamKind::Joint
        } else if faces.of[f] == faces.of[g] {
            SeamKind::Flat
        } else if angle(facets, f, g) >= SHARP {
            SeamKind::Joint
        } else {
            SeamKind::Smooth
        };
    }
    let flat = faces.flat_facets(facets, seams);
    for seam in &mut seams.all {
        if seam.kind == SeamKind::Smooth && seam.facets.iter().any(|&f| flat[f]) {
            seam.kind = SeamKind::Joint;
        }
    }
    flat
}

/// The face of every facet.
struct Faces {
    of: Vec<usize>,
    count: usize,
}

impl Faces {
    fn of(facets: &Facets, seams: &Seams) -> Faces {
        let mut order: Vec<usize> = (0..facets.len()).collect();
        order.sort_by(|&a, &b| facets.areas[b].total_cmp(&facets.areas[a]));
        let step = FILE_STEP * facets.size;
        let slack = |f: usize| step * facets.longest[f] / (2.0 * facets.areas[f]);
        let mut face = vec![usize::MAX; facets.len()];
        let mut count = 0;
        for first in order {
            if face[first] != usize::MAX {
                continue;
            }
            face[first] = count;
            let mut open = vec![first];
            while let Some(facet) = open.pop() {
                for next in seams.of[facet].iter().filter_map(|&seam| seams.all[seam].other(facet)) {
                    if face[next] == usize::MAX && angle(facets, first, next) < (FLAT + slack(next)).min(SHARP) {
                        face[next] = count;
                        open.push(next);
                    }
                }
            }
            count += 1;
        }
        Faces { of: face, count }
    }

    /// Which facets lie in faces that are flat and not only drawn so.
    fn flat_facets(&self, facets: &Facets, seams: &Seams) -> Vec<bool> {
        let mut areas = vec![0.0; self.count];
        facets.areas.iter().zip(&self.of).for_each(|(area, &face)| areas[face] += area);
        let smooth = seams.all.iter().filter(|seam| seam.kind == SeamKind::Smooth);
        let mut pairs: Vec<[usize; 2]> = smooth.map(|seam| seam.facets.map(|f| self.of[f])).collect();
        pairs.extend(pairs.clone().into_iter().map(|[f, g]| [g, f]));
        pairs.sort_unstable();
        pairs.dedup();
        let mut beside = vec![0.0; self.count];
        pairs.iter().for_each(|&[f, g]| beside[f] += areas[g]);
        self.of.iter().map(|&face| areas[face] >= FLAT_BESIDE * beside[face]).collect()
    }
}
