//! Flat faces: facets that lie in one plane, and whether the surface is flat there or only drawn so.
//!
//! ```text
//! face     grown from its largest facet over neighbours with angle(n, n_largest) < 0.1 degrees + step / height
//! drawn    it meets others smoothly, and is smaller than all of these together, or than 4 times them and turned from them as strips of one
//!          bent surface are: a strip of a cylinder, a facet of a ball
//! turned   angle = k (w + w') / 2 between strips of widths w and w' of a surface of curvature k, and k w' / 2 beside a flat face, where k is
//!          that at the longest of the strip's other seams
//! ```
//!
//! The normal of a sliver is as uncertain as its height is small beside the file's last digit. A strip of a bent surface has
//! neighbours of its own size; a flat face that goes over into a rounding has narrow ones, and turns by half as much there as they do.

use palpate_numeric::vector::{minus, norm};

use super::Facets;
use super::joined::FILE_STEP;
use super::seams::{SHARP, SeamKind, Seams, angle};

/// Angle below which facets lie in one plane, in radians: below it, no one draws a bent surface so finely.
const FLAT: f64 = 0.1 * std::f64::consts::PI / 180.0;

/// A face this many times larger than all that it meets smoothly is flat, however it turns.
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
        let mut counts = vec![0; self.count];
        self.of.iter().for_each(|&face| counts[face] += 1);
        let met = SmoothMeetings::of(self, facets, seams, (areas, counts));
        let flat: Vec<bool> = (0..self.count).map(|face| met.is_flat(face)).collect();
        self.of.iter().map(|&face| flat[face]).collect()
    }
}

/// Two faces that meet smoothly.
struct Meeting {
    faces: [usize; 2],
    /// Of all seams between them.
    length: f64,
    /// Mean angle along them.
    angle: f64,
}

/// Where faces meet smoothly.
struct SmoothMeetings {
    all: Vec<Meeting>,
    /// Facets of each face.
    facets: Vec<usize>,
    /// Numbers of those of each face.
    of: Vec<Vec<usize>>,
    areas: Vec<f64>,
}

impl SmoothMeetings {
    fn of(faces: &Faces, facets: &Facets, seams: &Seams, (areas, counts): (Vec<f64>, Vec<usize>)) -> SmoothMeetings {
        let smooth = seams.all.iter().filter(|seam| seam.kind == SeamKind::Smooth);
        let mut between: Vec<([usize; 2], f64, f64)> = smooth
            .map(|seam| {
                let [f, g] = seam.facets;
                let ends = seam.ends.map(|end| facets.places[end]);
                let (a, b) = (faces.of[f], faces.of[g]);
                ([a.min(b), a.max(b)], norm(minus(ends[1], ends[0])), angle(facets, f, g))
            })
            .collect();
        between.sort_by_key(|(pair, _, _)| *pair);
        let of = vec![Vec::new(); areas.len()];
        let mut found = SmoothMeetings { all: Vec::new(), facets: counts, of, areas };
        for group in between.chunk_by(|a, b| a.0 == b.0) {
            let length: f64 = group.iter().map(|(_, length, _)| length).sum();
            let turned: f64 = group.iter().map(|(_, length, angle)| length * angle).sum();
            let pair = group[0].0;
            pair.iter().for_each(|&face| found.of[face].push(found.all.len()));
            found.all.push(Meeting { faces: pair, length, angle: turned / length });
        }
        found
    }

    fn is_flat(&self, face: usize) -> bool {
        let other = |meeting: &Meeting| meeting.faces[usize::from(meeting.faces[0] == face)];
        let beside: f64 = self.of[face].iter().map(|&k| self.areas[other(&self.all[k])]).sum();
        let area = self.areas[face];
        area >= FLAT_BESIDE * beside || area >= beside && self.turns_as_flat(face, other)
    }

    /// Whether the neighbours turn away from a face as they do from a flat one. Strips alone tell, which have two facets: single ones are
    /// of what bends both ways.
    fn turns_as_flat(&self, face: usize, other: impl Fn(&Meeting) -> usize) -> bool {
        let width = |face: usize, meeting: &Meeting| self.areas[face] / meeting.length;
        let curvature = |k: &usize| {
            let meeting = &self.all[*k];
            2.0 * meeting.angle / meeting.faces.map(|face| width(face, meeting)).iter().sum::<f64>()
        };
        let favour = |k: &usize| {
            let meeting = &self.all[*k];
            let strip = Some(other(meeting)).filter(|strip| self.facets[*strip] > 1)?;
            let beyond = self.of[strip].iter().filter(|other| *other != k);
            let longest = beyond.max_by(|a, b| self.all[**a].length.total_cmp(&self.all[**b].length));
            let bend = longest.map(curvature).filter(|bend| *bend > 0.0)?;
            let as_bent = (curvature(k) / bend).ln().abs();
            let as_flat = (2.0 * meeting.angle / width(strip, meeting) / bend).ln().abs();
            Some(meeting.length * (as_bent - as_flat))
        };
        self.of[face].iter().filter_map(favour).sum::<f64>() > 0.0
    }
}

#[cfg(test)]
mod tests {
    use palpate_numeric::vector::Vector;

    use super::*;

    /// Which faces of a profile that is drawn along y are flat: a wall, a rounding of 15 degrees a step, and a wall.
    fn flat_of(wall: f64) -> Vec<bool> {
        let rounding = (0..=6).map(|k| f64::from(15 * k).to_radians().sin_cos());
        let mut profile: Vec<[f64; 2]> = rounding.map(|(sin, cos)| [1.0 - cos, 1.0 - sin]).collect();
        profile.insert(0, [0.0, 1.0 + wall]);
        profile.push([1.0 + wall, 0.0]);
        let places: Vec<Vector> = profile.iter().flat_map(|[x, z]| [[*x, 0.0, *z], [*x, 20.0, *z]]).collect();
        let strip = |k: usize| [[2 * k, 2 * k + 2, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 1]];
        let triangles: Vec<[usize; 3]> = (0..profile.len() - 1).flat_map(strip).collect();
        let facets = Facets::of(places, &triangles);
        let flat = judge(&facets, &mut Seams::between(&facets));
        flat.chunks(2).map(|pair| pair[0] && pair[1]).collect()
    }

    #[test]
    fn walls_are_flat_beside_a_rounding_and_its_strips_are_not() {
        for wall in [0.3, 0.8, 5.0] {
            let flat = flat_of(wall);
            assert_eq!((flat[0], flat[7]), (true, true), "{wall}");
            assert!(flat[1..7].iter().all(|flat| !flat), "{wall}: {flat:?}");
        }
    }
}
