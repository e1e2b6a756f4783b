//! What contacts show: a simple shape, or a flexible height field where a simple shape leaves too much unsaid.
//!
//! ```text
//! unsaid       misfit > 1/4 of the relief, with a pattern (p < 0.01)
//!              flexible field, where its error at left-out contacts is below half of the simple shape's misfit
//! no answer    unsaid, no such field, and misfit > 0.1 of the patch's size: more than a sensor errs
//! averaged     a free surface that follows 400 contacts or more does so by means over at most 200 cells
//!              flexible field, where it is nearer to left-out contacts than that surface is to those that it follows
//! a line       what 400 contacts or more lie off a simple shape with a pattern runs along a line (`line_detail.rs`)
//!              flexible field, where it is nearer to left-out contacts than that shape is to those that it was fitted to
//! ```
//!
//! The field lies over axes that rotate with the contacts, so that it does not matter how they were placed. Where it is no
//! answer there, as on steps that a camera saw from above, the axes of the input are tried.

use crate::bodies::Tuning;
use crate::recognition::start::thinned;
use crate::recognition::{Hypothesis, Recognition, RecognitionError, RecognitionOptions};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::{Contacts, Frame, Orientation};
use palpate_numeric::statistics::standard_deviation;
use palpate_numeric::vector::{Vector, dot};

use super::cross_validated_spline::{FieldChoice, Flexible, flexible};
use super::line_detail::{ASKED, Offsets};
use super::named_model_uncertainty::leaves_much_unsaid;
use super::principal_axes::own_axes;

/// What contacts show.
#[derive(Debug)]
pub enum Shown {
    /// A simple shape.
    Simple(Box<Recognition>),
    /// One sheet of no simple shape, with the simple shape that it takes the place of, where one was found.
    Flexible(Box<Flexible>, Option<Box<Recognition>>),
    /// A simple shape with a detail along a line, as a scratch or a seam is: one sheet that follows both, and the simple shape.
    Detailed(Box<Flexible>, Box<Recognition>),
}

/// How a flexible height field is fitted.
#[derive(Debug)]
pub struct FieldRequest<'a> {
    /// Its options.
    pub fit: &'a FitOptions,
    /// Tell the free side where there are no normals.
    pub recognition: &'a RecognitionOptions,
    /// The contacts are pixels, whose axes are theirs.
    pub gridded: bool,
}

/// Keeps what was recognised, or puts a flexible height field in its place. `contacts` gives the contacts, which most
/// answers do not need again.
///
/// # Errors
/// That of the recognition; [`RecognitionError::NotOneSheet`] where neither is an answer.
pub fn shown(
    found: Result<Recognition, RecognitionError>,
    contacts: impl Fn() -> Contacts,
    request: &FieldRequest,
) -> Result<Shown, RecognitionError> {
    let tuning = &request.recognition.tuning;
    match found {
        Ok(found) if leaves_much_unsaid(&found, tuning) => {
            match instead(&found, &contacts(), request, (FieldChoice::of, tuning.field_better)) {
                Some(field) => Ok(Shown::Flexible(Box::new(field), Some(Box::new(found)))),
                None if is_no_answer(&found, tuning) => {
                    let strays = found.outliers as f64;
                    let outliers = 100.0 * strays / (strays + found.contacts as f64);
                    Err(RecognitionError::NotOneSheet { misfit: found.misfit.percent_of_relief, outliers })
                }
                None => Ok(Shown::Simple(Box::new(found))),
            }
        }
        Ok(found) if found.hypothesis == Hypothesis::Displaced && found.contacts >= tuning.field_averaged_from => {
            Ok(match instead(&found, &contacts(), request, (FieldChoice::of, tuning.field_nearer)) {
                Some(field) => Shown::Flexible(Box::new(field), Some(Box::new(found))),
                None => Shown::Simple(Box::new(found)),
            })
        }
        Ok(found) if may_hide_a_line(&found, tuning) => Ok(match with_detail(&found, &contacts(), request) {
            Some(field) => Shown::Detailed(Box::new(field), Box::new(found)),
            None => Shown::Simple(Box::new(found)),
        }),
        Ok(found) => Ok(Shown::Simple(Box::new(found))),
        Err(error @ (RecognitionError::NotOneSheet { .. } | RecognitionError::SeveralThings { .. })) => {
            // pieces of waves are no things: a field is nearer to the contacts that it was not told of than they are to the pieces
            let most =
                if let RecognitionError::SeveralThings { misfit, .. } = &error { *misfit } else { f64::INFINITY };
            let contacts = contacts();
            let field = request.axes(&contacts).into_iter().find_map(|axes| {
                let field = flexible(&contacts, axes, request.fit, tuning).and_then(Result::ok);
                field.filter(|field| field.error < (tuning.field_predicts * field.relief).min(most))
            });
            field.map(|field| Shown::Flexible(Box::new(field), None)).ok_or(error)
        }
        Err(error) => Err(error),
    }
}

impl FieldRequest<'_> {
    /// The axes to try, one after the other.
    fn axes(&self, contacts: &Contacts) -> Vec<[Vector; 3]> {
        let tuning = &self.recognition.tuning;
        let over_input = self.gridded || matches!(contacts.orientation, Orientation::Slopes { .. });
        let own = if over_input { None } else { own_axes(contacts, self.recognition) };
        let own = own.filter(|axes| is_sheet(contacts, axes, tuning));
        own.into_iter().chain([Frame::IDENTITY.axes]).filter(|axes| !goes_back(contacts, axes, tuning)).collect()
    }
}

/// Whether many normals point to either side of a height field over these axes, as those of a body that was touched all round do.
fn goes_back(contacts: &Contacts, axes: &[Vector; 3], tuning: &Tuning) -> bool {
    if !matches!(contacts.orientation, Orientation::Normals { .. }) {
        return false;
    }
    let [share, clearly] = tuning.field_back;
    let along = (0..contacts.len()).filter_map(|r| Some(dot(contacts.unit_normal(r)?, axes[2])));
    let [up, down] = along.fold([0_usize; 2], |[up, down], cosine| {
        [up + usize::from(cosine > clearly), down + usize::from(cosine < -clearly)]
    });
    up.min(down) as f64 > share * (up + down) as f64
}

/// Whether the contacts lie about one plane across the axes' z.
fn is_sheet(contacts: &Contacts, axes: &[Vector; 3], tuning: &Tuning) -> bool {
    let [x, y, z] = axes.map(|axis| {
        let along: Vec<f64> =
            (0..contacts.len()).map(|r| dot(axis, [contacts.x[r], contacts.y[r], contacts.z[r]])).collect();
        standard_deviation(&along)
    });
    z < tuning.field_folded * x.min(y)
}

/// Whether that is more than any sensor errs.
fn is_no_answer(found: &Recognition, tuning: &Tuning) -> bool {
    let best = found.tried.iter().find(|t| t.hypothesis == found.hypothesis);
    best.is_some_and(|t| t.rms > tuning.sensor_of_size * found.frame.scale) || is_waves(found, tuning)
}

/// Whether the misfit outdoes the shape, and neighbours differ from each other by far less: waves or dimples on what is flat on the whole.
fn is_waves(found: &Recognition, tuning: &Tuning) -> bool {
    let [of_relief, of_scatter, alike] = tuning.waves;
    let long = found.noise.sd_correlated > of_scatter * found.noise.sd_z;
    let short = found.misfit.neighbour_correlation > alike && found.noise.sd_z > tuning.deep_waves * found.frame.scale;
    found.misfit.percent_of_relief > 100.0 * of_relief && found.misfit.p < tuning.pattern_certain && (long || short)
}

/// Whether enough contacts lie off a simple shape with their neighbours for a line among them to be told.
fn may_hide_a_line(found: &Recognition, tuning: &Tuning) -> bool {
    let is_simple = found.hypothesis != Hypothesis::Displaced && found.surface.body().is_none();
    let is_told = found.contacts >= tuning.field_averaged_from && found.misfit.p < tuning.pattern_certain;
    is_simple && is_told && found.noise.sd_correlated > 0.0
}

/// A field that follows a detail along a line, where there is one.
fn with_detail(found: &Recognition, contacts: &Contacts, request: &FieldRequest) -> Option<Flexible> {
    let is_line = offsets(found, contacts).detail_ahead() > request.recognition.tuning.clearly;
    is_line.then(|| instead(found, contacts, request, (FieldChoice::of_detail, 1.0))).flatten()
}

/// What contacts that belong to a simple shape lie off it, evenly among all.
fn offsets(found: &Recognition, contacts: &Contacts) -> Offsets {
    let place = |r: u32| [contacts.x[r as usize], contacts.y[r as usize], contacts.z[r as usize]];
    let all: Vec<Vector> = found.belonging(contacts).iter().map(|(_, r)| place(*r)).collect();
    let local: Vec<Vector> = all.iter().map(|p| found.frame.to_patch(*p)).collect();
    let scale = found.frame.scale;
    let asked = |i: usize| ([scale * local[i][0], scale * local[i][1]], found.surface.distance(all[i]));
    let (places, off) = thinned(&local, ASKED).into_iter().map(asked).unzip();
    Offsets { places, off, length: found.noise.correlation_length.unwrap_or(scale) }
}

/// How a field is chosen for contacts over some axes.
type ChoiceOfField = fn(&Contacts, [Vector; 3], &FitOptions, &Tuning) -> Option<FieldChoice>;

/// A flexible height field whose error at left-out contacts is below this share of the misfit of what was found. Both are compared
/// on the contacts that belong to that, so that strays decide nothing.
fn instead(
    found: &Recognition,
    contacts: &Contacts,
    request: &FieldRequest,
    (choice, share): (ChoiceOfField, f64),
) -> Option<Flexible> {
    let belonging = found.belonging(contacts);
    let rms = (belonging.iter().map(|(d, _)| d * d).sum::<f64>() / belonging.len().max(1) as f64).sqrt();
    let numbers: Vec<u32> = belonging.iter().map(|(_, r)| *r).collect();
    let those = contacts.in_order(&numbers);
    let up = found.frame.rotate_back([0.0, 0.0, 1.0]);
    let tuning = &request.recognition.tuning;
    let is_level = |axes: &[Vector; 3]| dot(axes[2], up).abs() >= tuning.field_level;
    request.axes(&those).into_iter().filter(is_level).find_map(|axes| {
        let field = choice(&those, axes, request.fit, tuning)?;
        // errors are along the axes' z and distances along the surface's normal
        if dot(axes[2], up).abs() * field.error >= share * rms {
            return None;
        }
        field.fitted(contacts, request.fit).ok()
    })
}

impl Recognition {
    /// Distances, nearest first, and numbers of the contacts that belong to the surface: the farthest were set aside.
    pub fn belonging(&self, contacts: &Contacts) -> Vec<(f64, u32)> {
        let distance = |r: usize| self.surface.distance([contacts.x[r], contacts.y[r], contacts.z[r]]).abs();
        let all = (0..contacts.len()).map(|r| (distance(r), r as u32));
        let mut order: Vec<(f64, u32)> = all.filter(|(d, _)| d.is_finite()).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        order.truncate(self.contacts);
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::draws::Lcg;

    #[test]
    fn a_body_that_was_touched_all_round_goes_back_over_every_plane_and_a_dome_does_not() {
        let touched = |most: f64| {
            let place = |k: usize| {
                let (down, round) = (most * ((k as f64 + 0.5) / 200.0).acos(), 2.399_963 * k as f64);
                [down.sin() * round.cos(), down.sin() * round.sin(), down.cos()]
            };
            let places: Vec<Vector> = (0..200).map(place).collect();
            Contacts::from_points(&places).with_normal_vectors(&places)
        };
        let axes = Frame::IDENTITY.axes;
        assert!(!goes_back(&touched(1.0), &axes, &Tuning::default()));
        assert!(goes_back(&touched(2.0), &axes, &Tuning::default()));
    }

    /// What a ball of 900 contacts is shown as, with this beside it.
    fn shown_with(beside: impl Fn(f64, f64) -> f64) -> Shown {
        let mut generator = Lcg::new(8);
        let mut place = || {
            let [x, y] = [0, 1].map(|_| 12.0 * generator.uniform() - 6.0);
            [x, y, (400.0 - x * x - y * y).sqrt() - 20.0 + beside(x, y) + 0.03 * generator.normal()]
        };
        let contacts = Contacts::from_points(&(0..900).map(|_| place()).collect::<Vec<Vector>>());
        let recognition = RecognitionOptions::default();
        let request = FieldRequest { fit: &FitOptions::default(), recognition: &recognition, gridded: false };
        shown(Recognition::of(&contacts, &recognition), || contacts.clone(), &request).unwrap()
    }

    /// Both are as large, and neighbours share both: the second has no direction.
    #[test]
    fn a_scratch_is_followed_and_errors_that_neighbours_share_are_not() {
        let scratch = shown_with(|x, y| -0.1 * (-((0.8 * x - 0.6 * y - 1.0) / 0.6).powi(2) / 2.0).exp());
        let Shown::Detailed(field, simple) = scratch else { panic!("{scratch:?}") };
        assert_eq!(simple.hypothesis, Hypothesis::Sphere);
        // along the scratch the ball is 0.1 off
        let (surface, frame) = (field.fit.surface(), field.fit.frame());
        let off = |k: i32| {
            let [x, y] = [0.8 + 0.6 * f64::from(k), -0.6 + 0.8 * f64::from(k)];
            let at = frame.to_patch([x, y, (400.0 - x * x - y * y).sqrt() - 20.1]);
            (surface.at(at[0], at[1]).z - at[2]).abs()
        };
        let mean = (-4..=4).map(off).sum::<f64>() / 9.0;
        assert!(mean < 0.05, "{mean}");
        let errors = |x: f64, y: f64| 0.02 * ((2.1 * x + 0.4).sin() + (1.9 * y).cos() + (1.5 * x - 1.4 * y).sin());
        assert!(!matches!(shown_with(errors), Shown::Detailed(..)));
    }
}
