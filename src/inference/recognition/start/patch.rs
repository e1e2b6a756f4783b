//! The contacts in the frame of the patch, without what does not belong to the surface.
//!
//! ```text
//! normals on one side  ->  frame  ->  robust general surface  ->  outliers set aside  ->  normals used or not
//! ```
//!
//! Refused are places without normals that lie on one conic, contacts of which more than `Tuning::most_outliers` are outliers, and contacts
//! that go round more than half a body.

use crate::bodies::Tuning;
use crate::recognition::contacts::{
    CellNormals, Cells, Dropped, Floors, NormalsUse, Observations, ScatterWithin, cells, derived_from_positions,
    on_conic, patch_frame,
};
use crate::recognition::kinds::{Kind, Model};
use crate::recognition::{RecognitionError, RecognitionOptions, Remark};
use palpate_geometry::contact::Frame;

use super::descent::{TASK, plain};
use super::directions::Directions;
use super::robust::{Start, start, thinned};

use palpate_geometry::neighbours::{Neighbours, Oriented, mean_of, oriented};
use palpate_numeric::threads;
use palpate_numeric::vector::{Vector, along, dot, minus, norm, scaled};

/// Contacts that belong to the surface, in the frame of the patch, with the robust fit.
pub(crate) struct Patch {
    pub(crate) frame: Frame,
    pub(crate) points: Vec<Vector>,
    /// Feet of the contacts on the robust general surface. What lies beside what is told by them: in space, contacts that err much
    /// lie apart because they err, and their distances from a surface would be a smooth function of their places.
    pub(crate) feet: Vec<Vector>,
    /// Signed distances from the robust general surface.
    pub(crate) distances: Vec<f64>,
    /// Measured minus model normals where they are used.
    errors: Option<Vec<Option<Vector>>>,
    start: Start,
    floors: Floors,
    pub(crate) dropped: Dropped,
    pub(crate) normals: NormalsUse,
    pub(crate) notes: Vec<Remark>,
}

impl Patch {
    pub(crate) fn new(given: &Observations, options: &RecognitionOptions) -> Result<Patch, RecognitionError> {
        given.check_number()?;
        let tuning = &options.tuning;
        let mut notes = Vec::new();
        let mut dropped = Dropped { missing: given.missing, ..Dropped::default() };
        let mut state = if given.ignored { NormalsUse::Ignored } else { NormalsUse::Absent };
        let mut normals = None;
        if let Some(raw) = given.normals.clone() {
            let found = oriented(&given.points, raw, options.viewpoint);
            dropped.normals_of_length_zero = found.of_length_zero;
            (state, normals) = accepted(found, &mut dropped, &mut notes, tuning)?;
        }
        let frame = patch_frame(&given.points, normals.as_deref(), options)?;
        if normals.is_none() && options.up.is_none() && options.viewpoint.is_none() {
            notes.push(Remark::FreeSideAssumed);
        }
        let points: Vec<Vector> = given.points.iter().map(|p| frame.to_patch(*p)).collect();
        if normals.is_none() && on_conic(&points.iter().map(|p| [p[0], p[1]]).collect::<Vec<_>>(), tuning) {
            return Err(RecognitionError::OnConic);
        }
        let normals: Option<Vec<Vector>> = normals.map(|n| n.iter().map(|n| frame.rotate(*n)).collect());
        let floors = Floors::new(&given.rounding, &given.points, normals.as_deref(), &frame);
        let start = start(&points, normals.as_deref(), &floors, tuning);
        dropped.outliers = start.belongs.iter().filter(|b| !**b).count();
        let outliers = dropped.outliers as f64 / points.len() as f64;
        if outliers > tuning.most_outliers {
            let misfit =
                100.0 * start.distances.iter().map(|d| d * d).sum::<f64>().sqrt() / (points.len() as f64).sqrt();
            return Err(RecognitionError::NotOneSheet { misfit, outliers: 100.0 * outliers });
        }
        let surface_normals: Vec<Vector> =
            threads::map(points.len(), TASK, |k| start.general.distance_and_normal(points[k]).1);
        let length = norm(mean_of(&surface_normals));
        if length < tuning.round_patch {
            return Err(RecognitionError::AllAround { mean_length: length, measured: normals.is_some() });
        }
        let mut errors = None;
        if let Some(normals) = normals {
            (state, errors) = judged(&points, &normals, &surface_normals, &start, &mut dropped, tuning);
        }
        let kept = |i: &usize| start.belongs[*i];
        let chosen: Vec<usize> = (0..points.len()).filter(kept).collect();
        let foot = |i: usize| along(points[i], -start.distances[i], surface_normals[i]);
        Ok(Patch {
            frame,
            feet: chosen.iter().map(|&i| foot(i)).collect(),
            distances: chosen.iter().map(|&i| start.distances[i]).collect(),
            errors: errors.map(|e| chosen.iter().map(|&i| e[i]).collect()),
            points: chosen.iter().map(|&i| points[i]).collect(),
            start,
            floors,
            dropped,
            normals: state,
            notes,
        })
    }

    /// A sample of the contacts, each with the one whose foot is nearest.
    pub(crate) fn nearest(&self) -> Vec<[usize; 2]> {
        const SAMPLE: usize = 4000;
        let tree = Neighbours::new(&self.feet);
        let beside = |i: usize| tree.nearest_other(i).map(|(_, j)| [i, j]);
        thinned(&self.feet, SAMPLE).into_iter().filter_map(beside).collect()
    }

    /// Cosine between the robust surface's normal at a place and the input's z.
    pub(crate) fn upright(&self, place: Vector) -> f64 {
        self.frame.rotate_back(self.start.general.distance_and_normal(place).1)[2]
    }

    /// Averaged contacts.
    pub(crate) fn cells(&self, tuning: &Tuning) -> Cells {
        let cells = cells(&self.points, &self.feet, &self.start.general, self.errors.as_deref());
        let contacts = self.points.len() as f64 / cells.points.len() as f64;
        let floors = self.floors.of_means(contacts, self.normals_per_cell(&cells).max(1.0));
        let within = ScatterWithin::of(&cells.of, [&self.feet, &cells.feet], &cells.tangents, &self.distances, tuning);
        Cells { floors, within, ..cells }
    }

    /// All models refitted to the cells, each from its likeliest starts.
    pub(crate) fn fitted(&self, cells: &Cells, tuning: &Tuning) -> Vec<Model> {
        let general = self.start.general.theta();
        let [h, a, b, k1, k2, phi] = general;
        let across = phi + std::f64::consts::FRAC_PI_2;
        let mean = 0.5 * (k1 + k2);
        let cylinder = if k1.abs() > k2.abs() { [h, a, b, k1, 0.0, phi] } else { [h, a, b, k2, 0.0, across] };
        // the height quadric of the same surface: its normal at the middle is tilted by the vector (a, b)
        let (c, s) = (phi.cos(), phi.sin());
        let (xx, yy, xy) = (k1 * c * c + k2 * s * s, k1 * s * s + k2 * c * c, (k1 - k2) * c * s);
        let starts: [(Kind, Vec<[f64; 6]>); 5] = [
            (Kind::Plane, vec![general]),
            (Kind::Sphere, vec![self.start.sphere.theta(), [h, a, b, mean, mean, 0.0]]),
            (Kind::Cylinder, vec![self.start.cylinder.theta(), cylinder]),
            (Kind::General, vec![general, [h, a, b, k2, k1, across]]),
            (Kind::Paraboloid, vec![[h, -b, a, xx, yy, xy]]),
        ];
        let told = cells.normals.as_ref().filter(|_| self.start.with_normals);
        let of_known = |normals: &CellNormals| Directions::new(&normals.where_known(), self.floors.normal, tuning);
        let normals = told.map(of_known);
        let best = |(kind, starts): (Kind, Vec<[f64; 6]>)| {
            let fits =
                starts.into_iter().map(|theta| plain(&cells.points, normals.as_ref(), &cells.weights, kind, theta));
            fits.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(model, _)| model)
        };
        starts.into_iter().filter_map(best).collect()
    }

    /// How many normals a cell that has any averages, on the mean; with it a cell's noise gives that of a single normal.
    pub(crate) fn normals_per_cell(&self, cells: &Cells) -> f64 {
        let used = self.errors.as_ref().map_or(0, |e| e.iter().filter(|e| e.is_some()).count());
        used as f64 / cells.normals.as_ref().map_or(0, CellNormals::known).max(1) as f64
    }
}

/// Oriented normals if they are normals of a surface at all.
fn accepted(
    found: Oriented,
    dropped: &mut Dropped,
    notes: &mut Vec<Remark>,
    tuning: &Tuning,
) -> Result<(NormalsUse, Option<Vec<Vector>>), RecognitionError> {
    if !found.consistent {
        notes.push(Remark::NormalsContradict);
        return Ok((NormalsUse::Contradicting, None));
    }
    let length = norm(mean_of(&found.normals));
    if found.of_length_zero < found.normals.len() && length < tuning.round_patch {
        return Err(RecognitionError::AllAround { mean_length: length, measured: true });
    }
    notes.extend(found.undecided().map(|agree| Remark::SignsMixed { agree }));
    dropped.normals_flipped = found.flipped;
    if 2 * found.of_length_zero > found.normals.len() {
        notes.push(Remark::NormalsOfLengthZero);
        let known = (found.of_length_zero < found.normals.len()).then_some(found.normals);
        return Ok((NormalsUse::Contradicting, known));
    }
    Ok((NormalsUse::Believed, Some(found.normals)))
}

/// Whether the normals are used, and their errors if so.
fn judged(
    points: &[Vector],
    normals: &[Vector],
    surface: &[Vector],
    start: &Start,
    dropped: &mut Dropped,
    tuning: &Tuning,
) -> (NormalsUse, Option<Vec<Option<Vector>>>) {
    let agrees = |i: usize| dot(normals[i], surface[i]) > tuning.normal_against;
    let known = normals.iter().filter(|n| **n != [0.0; 3]).count();
    let agreeing = (0..normals.len()).filter(|&i| agrees(i)).count();
    dropped.normals_against = known - agreeing;
    if 2 * agreeing < normals.len() {
        return (NormalsUse::Contradicting, None);
    }
    let sample = start.sample.iter().copied().filter(|&i| start.belongs[i] && agrees(i));
    if derived_from_positions(points, normals, &start.general, sample, tuning) {
        return (NormalsUse::DerivedFromPositions, None);
    }
    let error = |i: usize| agrees(i).then(|| minus(normals[i], scaled(1.0, surface[i])));
    (NormalsUse::Believed, Some((0..normals.len()).map(error).collect()))
}
