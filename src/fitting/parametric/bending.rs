//! The curvature of the surface compared with the largest one that the contacts can have measured. A surface that oscillates
//! between contacts has no residuals there, but more curvature than the normals on both sides allow.
//!
//! ```text
//! felt(a)   = max over a, its neighbours b and theirs of (angle(n_a, n_b) + 3 sigma sqrt(1/N_a + 1/N_b)) / arc(a, b)
//! bending   = max over contacts and supported points of max(|k1|, |k2|) / felt there
//! ```
//!
//! a and b are means of contacts over boxes of (u, v). There are as many boxes as coefficients, so that the spline cannot
//! bend on a smaller scale than theirs. Along one of any two perpendicular directions the normal rotates by `|k| / sqrt 2`
//! or more per length, so a surface that is well covered by contacts has a bending near 1, and only an oscillation between
//! contacts has one of 2.5.

use super::cells::Cells;
use super::foot_point::Feet;
use super::patch_contacts::PatchContacts;
use super::vector::{Vector, arc, cross, dot, norm, unit};

/// Bending above which S and R do not come from the contacts. Balls and bars have 0.6 to 1.1, with noise up to 1.4, and a
/// biquadratic too stiff for its ball 1.9; overfitted noise has 2 to 3 while S is off by half, and a diverged fit 4 to
/// 10^6.
pub(super) const MOST_BENDING: f64 = 2.5;
/// Sds of the noise by which the true angle between two normals may exceed the measured one.
const HIDDEN: f64 = 3.0;

/// The largest curvature that contacts can have felt, for each box of (u, v).
#[derive(Debug)]
pub(super) struct MeasuredCurvature {
    counts: [usize; 2],
    domain: [[f64; 2]; 2],
    closed: [bool; 2],
    most: Vec<f64>,
    anywhere: f64,
}

#[derive(Clone, Debug)]
struct Bin {
    point: Vector,
    normal: Vector,
    count: f64,
}

impl MeasuredCurvature {
    /// From contacts with noise sd `sigma` of their normals, radians.
    pub(super) fn new(cells: &Cells, contacts: &PatchContacts, feet: &Feet, sigma: f64) -> MeasuredCurvature {
        let shape = cells.shape();
        let mut measured = MeasuredCurvature {
            counts: shape.free.map(|n| n.max(2)),
            domain: [0, 1].map(|k| cells.knots()[k].domain()),
            closed: shape.closed,
            most: Vec::new(),
            anywhere: 0.0,
        };
        let empty = Bin { point: [0.0; 3], normal: [0.0; 3], count: 0.0 };
        let mut boxes = vec![empty; measured.counts[0] * measured.counts[1]];
        for (r, place) in feet.places.iter().enumerate().filter(|(r, _)| contacts.normal_weight[*r] > 0.0) {
            let own = &mut boxes[measured.place(*place)];
            own.count += 1.0;
            (0..3).for_each(|d| own.point[d] += contacts.points[r][d]);
            (0..3).for_each(|d| own.normal[d] += contacts.normals[r][d]);
        }
        for own in boxes.iter_mut().filter(|b| b.count > 0.0) {
            own.point = own.point.map(|p| p / own.count);
            own.normal = unit(own.normal);
        }
        let pairs = measured.pairs(&boxes);
        let curvature_of = |a: &Bin, b: &Bin| {
            let angle = norm(cross(a.normal, b.normal)).atan2(dot(a.normal, b.normal));
            let hidden = HIDDEN * sigma * (1.0 / a.count + 1.0 / b.count).sqrt();
            (angle + hidden) / arc(a.point, b.point, a.normal, b.normal).max(f64::MIN_POSITIVE)
        };
        let mut own = vec![0.0_f64; boxes.len()];
        for &[a, b] in &pairs {
            let curvature = curvature_of(&boxes[a], &boxes[b]);
            (own[a], own[b]) = (own[a].max(curvature), own[b].max(curvature));
        }
        measured.most.clone_from(&own);
        for [a, b] in pairs {
            (measured.most[a], measured.most[b]) = (measured.most[a].max(own[b]), measured.most[b].max(own[a]));
        }
        measured.anywhere = own.into_iter().fold(0.0, f64::max);
        measured
    }

    /// `curvature` over the largest one felt near (u, v).
    pub(super) fn bending(&self, place: [f64; 2], curvature: f64) -> f64 {
        let near = self.most[self.place(place)];
        // a box without contacts or neighbours takes the largest curvature felt anywhere
        curvature / if near > 0.0 { near } else { self.anywhere }
    }

    fn place(&self, at: [f64; 2]) -> usize {
        let [i, j] = [0, 1].map(|k| {
            let ([lo, hi], count) = (self.domain[k], self.counts[k]);
            let share = (at[k] - lo) / (hi - lo);
            let share = if self.closed[k] { share.rem_euclid(1.0) } else { share };
            ((share * count as f64) as usize).min(count - 1)
        });
        i * self.counts[1] + j
    }

    /// Pairs of boxes that hold contacts and follow one another along u or v.
    fn pairs(&self, boxes: &[Bin]) -> Vec<[usize; 2]> {
        let [n, m] = self.counts;
        let mut pairs = Vec::new();
        let mut follow = |line: Vec<usize>, closed: bool| {
            let filled: Vec<usize> = line.into_iter().filter(|b| boxes[*b].count > 0.0).collect();
            pairs.extend(filled.windows(2).map(|p| [p[0], p[1]]));
            if let ([first, .., last], true) = (&filled[..], closed) {
                pairs.push([*last, *first]);
            }
        };
        (0..n).for_each(|i| follow((0..m).map(|j| i * m + j).collect(), self.closed[1]));
        (0..m).for_each(|j| follow((0..n).map(|i| i * m + j).collect(), self.closed[0]));
        pairs
    }
}
