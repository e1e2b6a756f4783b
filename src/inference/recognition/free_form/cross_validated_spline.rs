//! A height field for contacts that are one sheet and no simple shape, with as many segments, and as smooth, as predicts left-out
//! contacts.
//!
//! ```text
//! blocks       the contacts' box cut into 6 x 6; block (i, j) is in group (i + 2 j) mod 4
//!              one group is left out at a time
//! error(s)     root mean square of z - S_s(x, y) over the left-out contacts, S_s fitted to the others with s segments
//! s            the smallest whose error is at most `Tuning::field_as_good` times the least: along the longer side, and as many of that
//!              length along the shorter
//! smooth       third derivatives that cost what the contacts' likelihood says, where that predicts them no worse than s does
//! ```
//!
//! Likelihood takes errors for independent. Where neighbours err alike it follows these errors, predicts left-out blocks worse, and
//! the coarse field without a cost stays.
//!
//! x, y and z are along axes that the caller gives, and z is measured across the patch.
//!
//! Whole blocks are left out, because errors of neighbouring contacts are alike. A single contact left out would be
//! predicted the better, the more closely the field follows its neighbours' errors. (D. R. Roberts et al., *Ecography*
//! 40 (2017) 913.) Where waves are shorter than blocks no field predicts these; then single contacts are left out, of which a field that
//! follows errors alone predicts none.

use crate::bodies::Tuning;
use crate::recognition::start::thinned;
use palpate_fitting::fit::{Fit, FitError, FitOptions, Note, Smooth, fit_contacts, fit_contacts_over};
use palpate_geometry::contact::{Contacts, Frame, Orientation};
use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::draws::evenly;
use palpate_numeric::vector::Vector;

/// Blocks each way, and the number of groups that are left out one after the other.
const BLOCKS: usize = 6;
const GROUPS: usize = 4;

/// Segments that are tried.
const SEGMENTS: [usize; 7] = [1, 2, 4, 8, 12, 16, 24];

/// Degree of the height field: its curvature is continuous.
const DEGREE: usize = 3;

/// Degree of a smoothed field, whose third derivatives cost, and segments that are tried. A coarse one that predicts as well bends more
/// truly: what predicts heights best leaves noise in their second derivatives. The next finer one is taken, whose intervals count
/// what the coarse one cannot follow.
const SMOOTHED_DEGREE: usize = 4;
const SMOOTHED_SEGMENTS: [usize; 6] = [4, 6, 8, 12, 16, 24];

/// Points of the grid for every segment, where none was asked for.
const POINTS_PER_SEGMENT: usize = 4;

/// Segments that are tried where single contacts are left out: as fine as the waves ask for.
const FINE_SEGMENTS: [usize; 9] = [2, 4, 6, 8, 10, 12, 16, 24, 32];

/// Contacts among which blocks are left out; more would take longer and choose the same.
const MOST_CONTACTS: usize = 4_000;

/// A height field, and how well it predicts.
#[derive(Clone, Debug)]
pub struct Flexible {
    /// The fit to all contacts.
    pub fit: Fit,
    /// Its form.
    pub form: FieldForm,
    /// Fields tried, with the root mean square error of contacts left out.
    pub tried: Vec<(FieldForm, f64)>,
    /// That error of the number taken.
    pub error: f64,
    /// Root mean square distance of the contacts, along z, from their best plane.
    pub relief: f64,
}

/// How fine a height field is, and whether its roughness costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldForm {
    /// Segments along x and along y.
    pub segments: [usize; 2],
    /// Whether third derivatives cost, as the likelihood of the contacts says.
    pub smoothed: bool,
}

impl FieldForm {
    /// The options of a fit in this form.
    fn among(self, options: &FitOptions) -> FitOptions {
        let smooth = if self.smoothed { Smooth::Auto } else { options.smooth };
        // means are those of the surface, and not of the places that a coarse grid happens to have
        let untyped = options.grid == FitOptions::default().grid;
        // with two more points than steps of a segment no inner one lies on a knot, where rounding decides which cell it is in
        let followed = |k: usize| if untyped { POINTS_PER_SEGMENT * self.segments[k] + 2 } else { options.grid[k] };
        let grid = [0, 1].map(|k| followed(k).max(options.grid[k]));
        FitOptions { degree: [self.degree(); 2], segments: self.segments, smooth, grid, ..options.clone() }
    }

    fn degree(self) -> usize {
        if self.smoothed { SMOOTHED_DEGREE } else { DEGREE }
    }

    fn unknowns(self) -> usize {
        self.segments.iter().map(|segments| segments + self.degree()).product()
    }
}

/// Chooses a field and fits it over these axes (rows x, y, z). `None` where there are too few contacts to leave any out, and where they
/// lie on several sheets.
pub fn flexible(
    contacts: &Contacts,
    axes: [Vector; 3],
    options: &FitOptions,
    tuning: &Tuning,
) -> Option<Result<Flexible, FitError>> {
    Some(FieldChoice::of(contacts, axes, options, tuning)?.fitted(contacts, options))
}

/// A height field that was chosen and not fitted to all contacts yet.
pub(crate) struct FieldChoice {
    form: FieldForm,
    axes: [Vector; 3],
    tried: Vec<(FieldForm, f64)>,
    /// Root mean square error of contacts left out.
    pub(crate) error: f64,
    /// Root mean square distance of the contacts, along z, from their best plane.
    pub(crate) relief: f64,
}

impl FieldChoice {
    /// As [`flexible`].
    pub(crate) fn of(
        contacts: &Contacts,
        axes: [Vector; 3],
        options: &FitOptions,
        tuning: &Tuning,
    ) -> Option<FieldChoice> {
        let either = |sample: &FieldSample| sample.unpenalised();
        FieldChoice::by((either, tuning.field_as_good), contacts, axes, options, tuning)
    }

    /// The same by single contacts left out, and of smoothed fields the best: of a detail that is narrower than a block, blocks tell nothing,
    /// and one that few contacts show is hardly worse predicted by a field that does not follow it.
    pub(super) fn of_detail(
        contacts: &Contacts,
        axes: [Vector; 3],
        options: &FitOptions,
        tuning: &Tuning,
    ) -> Option<FieldChoice> {
        let single = |sample: &FieldSample| (sample.each_left_out(LeftOut::Contacts), LeftOut::Contacts);
        FieldChoice::by((single, 1.0), contacts, axes, options, tuning)
    }

    /// By these fields without a cost, and the coarsest smoothed one that predicts as well as the best up to this factor.
    fn by(
        (unpenalised, as_well): (impl Fn(&FieldSample) -> (Vec<(FieldForm, f64)>, LeftOut), f64),
        contacts: &Contacts,
        axes: [Vector; 3],
        options: &FitOptions,
        tuning: &Tuning,
    ) -> Option<FieldChoice> {
        let frame = Frame { axes, ..Frame::IDENTITY };
        let point = |r: usize| [contacts.x[r], contacts.y[r], contacts.z[r]];
        let points: Vec<Vector> =
            (0..contacts.len()).map(|r| if frame.keeps_axes() { point(r) } else { frame.rotate(point(r)) }).collect();
        let chosen: Vec<u32> = thinned(&points, MOST_CONTACTS).into_iter().map(|i| i as u32).collect();
        let [x, y, z] = [0, 1, 2].map(|k| points.iter().map(|p| p[k]).collect());
        let few = Contacts { x, y, z, orientation: Orientation::None, ..contacts.clone() }.in_order(&chosen);
        let relief = relief(&points);
        if are_sheets(&few, relief, tuning.field_sheets) {
            return None;
        }
        let sample = FieldSample { box_of: [extent(&few.x), extent(&few.y)], contacts: few, relief, tuning };
        let (tried, out) = unpenalised(&sample);
        let coarse = tried[coarsest_of(&tried, tuning.field_as_good)?];
        // a cost that was named stays
        let smoothed = if options.smooth == Smooth::None { sample.smoothed(out) } else { Vec::new() };
        let as_good = |at: &usize| smoothed.get(*at).is_some_and(|field| field.1 <= tuning.field_as_good * coarse.1);
        let best =
            coarsest_of(&smoothed, as_well).filter(as_good).map(|at| if as_good(&(at + 1)) { at + 1 } else { at });
        let (form, error) = best.map_or(coarse, |at| smoothed[at]);
        let tried = tried.into_iter().chain(smoothed).collect();
        Some(FieldChoice { form, axes, tried, error, relief })
    }

    /// The field fitted to these contacts. A height field cannot take normals that point down; the positions are then fitted without normals.
    pub(super) fn fitted(self, contacts: &Contacts, options: &FitOptions) -> Result<Flexible, FitError> {
        let FieldChoice { form, tried, error, relief, .. } = self;
        let options = form.among(options);
        let fit = fit_contacts_over(contacts, self.axes, &options).or_else(|_| {
            let places = Contacts { orientation: Orientation::None, ..contacts.clone() };
            fit_contacts_over(&places, self.axes, &options)
        })?;
        Ok(Flexible { fit, form, tried, error, relief })
    }
}

/// Number of the coarsest field that predicts as well as the best up to a factor.
fn coarsest_of(tried: &[(FieldForm, f64)], as_well: f64) -> Option<usize> {
    let least = tried.iter().map(|t| t.1).min_by(f64::total_cmp)?;
    tried.iter().position(|t| t.1 <= as_well * least)
}

/// Whether contacts next to each other over x and y differ in height as those of several sheets do.
fn are_sheets(few: &Contacts, relief: f64, apart_by: f64) -> bool {
    let places: Vec<Vector> = few.x.iter().zip(&few.y).map(|(x, y)| [*x, *y, 0.0]).collect();
    let tree = Neighbours::new(&places);
    let apart = |i: usize| Some(few.z[i] - few.z[tree.nearest_other(i)?.1]);
    let squares: Vec<f64> = (0..few.len()).filter_map(apart).map(|dz| 0.5 * dz * dz).collect();
    squares.iter().sum::<f64>() > apart_by * apart_by * relief * relief * squares.len().max(1) as f64
}

/// What is left out at a time.
#[derive(Clone, Copy)]
enum LeftOut {
    Blocks,
    Contacts,
}

/// Contacts over x and y by which fields are chosen.
struct FieldSample<'a> {
    contacts: Contacts,
    box_of: [[f64; 2]; 2],
    relief: f64,
    tuning: &'a Tuning,
}

impl FieldSample<'_> {
    /// Fields without a cost, and what was left out for them.
    fn unpenalised(&self) -> (Vec<(FieldForm, f64)>, LeftOut) {
        let [_, unpredicted] = self.tuning.field_risen;
        let predicted = |tried: &[(FieldForm, f64)]| tried.iter().any(|t| t.1 < unpredicted * self.relief);
        let blocks = self.each_left_out(LeftOut::Blocks);
        if !predicted(&blocks) {
            let fine = self.each_left_out(LeftOut::Contacts);
            if predicted(&fine) {
                return (fine, LeftOut::Contacts);
            }
        }
        (blocks, LeftOut::Blocks)
    }

    /// Segments with the error of contacts left out, up to where finer fields follow noise.
    fn each_left_out(&self, out: LeftOut) -> Vec<(FieldForm, f64)> {
        let mut tried: Vec<(FieldForm, f64)> = Vec::new();
        let Tuning { field_risen: [risen, unpredicted], field_per_unknown: [coarse, fine, _], .. } = *self.tuning;
        let (all, per_unknown) = match out {
            LeftOut::Blocks => (&SEGMENTS[..], coarse),
            LeftOut::Contacts => (&FINE_SEGMENTS[..], fine),
        };
        for &segments in all {
            let form = FieldForm { segments: alike(segments, self.box_of), smoothed: false };
            let Some(error) = self.error_of(form, Smooth::None, per_unknown, out) else { break };
            tried.push((form, error));
            let least = tried.iter().map(|t| t.1).fold(f64::INFINITY, f64::min);
            if least < unpredicted * self.relief && error > risen * least {
                break;
            }
        }
        tried
    }

    /// The same of smoothed fields, up to where two finer ones predict no better.
    fn smoothed(&self, out: LeftOut) -> Vec<(FieldForm, f64)> {
        let mut tried: Vec<(FieldForm, f64)> = Vec::new();
        let [.., per_unknown] = self.tuning.field_per_unknown;
        for segments in SMOOTHED_SEGMENTS {
            let form = FieldForm { segments: alike(segments, self.box_of), smoothed: true };
            let error = self.likeliest_cost(form).and_then(|cost| self.error_of(form, cost, per_unknown, out));
            let Some(error) = error else { break };
            tried.push((form, error));
            // along a narrow side two sizes may have the same segments, and the longer side alone predicts no better
            if let [.., (_, before), (_, one), (_, two)] = tried[..]
                && before <= one.min(two)
            {
                break;
            }
        }
        tried
    }

    /// What roughness costs as all contacts say: left-out fits then need not find it again.
    fn likeliest_cost(&self, form: FieldForm) -> Option<Smooth> {
        let fit = fit_contacts(&self.contacts, &form.among(&self.over_box())).ok()?;
        fit.notes().iter().find_map(|note| if let Note::Smoothed { chosen } = note { Some(*chosen) } else { None })
    }

    /// Error of contacts left out; `None` where there are too few for so many unknowns.
    fn error_of(&self, form: FieldForm, cost: Smooth, per_unknown: f64, out: LeftOut) -> Option<f64> {
        let kept = (self.contacts.len() * (GROUPS - 1) / GROUPS) as f64;
        if per_unknown * form.unknowns() as f64 > kept {
            return None;
        }
        let options = FitOptions { smooth: cost, ..form.among(&self.over_box()) };
        left_out(&self.contacts, &options, self.box_of, out).ok().filter(|error| error.is_finite())
    }

    fn over_box(&self) -> FitOptions {
        let [[x0, x1], [y0, y1]] = self.box_of;
        FitOptions { domain: Some([x0, x1, y0, y1]), ..FitOptions::default() }
    }
}

/// This many segments along the longer side, and as many of that length as the shorter side takes.
fn alike(segments: usize, box_of: [[f64; 2]; 2]) -> [usize; 2] {
    let sides = box_of.map(|[lo, hi]| hi - lo);
    let longer = sides[0].max(sides[1]);
    sides.map(|side| ((segments as f64 * side / longer).ceil() as usize).clamp(1, segments))
}

fn extent(values: &[f64]) -> [f64; 2] {
    let lo = values.iter().copied().fold(f64::INFINITY, f64::min);
    [lo, values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

/// Root mean square error over all that is left out.
fn left_out(contacts: &Contacts, options: &FitOptions, [x, y]: [[f64; 2]; 2], out: LeftOut) -> Result<f64, FitError> {
    let block = |v: f64, [lo, hi]: [f64; 2]| ((BLOCKS as f64 * (v - lo) / (hi - lo)) as usize).min(BLOCKS - 1);
    let group = |r: usize| match out {
        LeftOut::Blocks => (block(contacts.x[r], x) + 2 * block(contacts.y[r], y)) % GROUPS,
        // no rows of a lattice are left out together
        LeftOut::Contacts => (GROUPS as f64 * evenly(r)) as usize,
    };
    let (mut sum, mut count) = (0.0, 0_usize);
    for number in 0..GROUPS {
        let kept: Vec<u32> = (0..contacts.len() as u32).filter(|&r| group(r as usize) != number).collect();
        let surface = fit_contacts(&contacts.in_order(&kept), options)?.input_surface()?;
        for r in (0..contacts.len()).filter(|&r| group(r) == number) {
            sum += (contacts.z[r] - surface.at(contacts.x[r], contacts.y[r]).z).powi(2);
            count += 1;
        }
    }
    Ok((sum / count.max(1) as f64).sqrt())
}

fn relief(points: &[Vector]) -> f64 {
    let (plane, _) = palpate_geometry::shape::best_plane(points.iter().copied());
    let off = points.iter().map(|p| (p[2] - (plane[0] + plane[1] * p[0] + plane[2] * p[1])).powi(2));
    (off.sum::<f64>() / points.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::draws::Lcg;

    fn chosen(contacts: &Contacts) -> Flexible {
        flexible(contacts, Frame::IDENTITY.axes, &FitOptions::default(), &Tuning::default()).unwrap().unwrap()
    }

    #[test]
    fn waves_call_for_segments_and_are_predicted() {
        let points: Vec<Vector> = (0..1600)
            .map(|i| [(i % 40) as f64 * 0.2, (i / 40) as f64 * 0.2])
            .map(|[x, y]| [x, y, (2.0 * x).sin() + 0.01 * (37.0 * x + 91.0 * y).sin()])
            .collect();
        let found = chosen(&Contacts::from_points(&points));
        assert!(found.tried.len() > 3 && found.error < 0.2 * found.relief, "{:?} of {}", found.tried, found.relief);
        assert!(found.fit.options().segments[0] >= 8);
    }

    #[test]
    fn waves_shorter_than_blocks_are_predicted_from_their_neighbours() {
        let points: Vec<Vector> = (0..400)
            .map(|i| [(i % 20) as f64 * 0.5, (i / 20) as f64 * 0.5])
            .map(|[x, y]| [x, y, x.sin() + (1.3 * y).cos().powi(2)])
            .collect();
        let found = chosen(&Contacts::from_points(&points));
        assert!(found.error < 0.25 * found.relief, "{:?} of {}", found.tried, found.relief);
    }

    /// Where errors are independent, what third derivatives cost is told by the contacts, and a field with that cost bends more truly.
    #[test]
    fn a_smooth_surface_is_smoothed_and_bends_as_it_does() {
        let mut generator = Lcg::new(11);
        let mut place = || {
            let [x, y] = [0, 1].map(|_| 12.0 * generator.uniform() - 6.0);
            [x, y, 1.5 * (-(x * x + y * y) / 18.0).exp() + 0.03 * generator.normal()]
        };
        let contacts = Contacts::from_points(&(0..900).map(|_| place()).collect::<Vec<Vector>>());
        let found = chosen(&contacts);
        assert_eq!(found.fit.options().smooth, Smooth::Auto, "{:?}", found.tried);
        let cubic = FitOptions::default().with_degree(DEGREE).with_segments(4, 4);
        let errors = [&found.fit, &fit_contacts(&contacts, &cubic).unwrap()].map(|fit| {
            let surface = fit.input_surface().unwrap();
            let off = |k: i32| {
                let [x, y] = [k % 9, k / 9].map(|i| f64::from(i) - 4.0);
                let expected = 1.5 * (-(x * x + y * y) / 18.0).exp() * (x * x / 81.0 - 1.0 / 9.0);
                (surface.at(x, y).zxx - expected).powi(2)
            };
            (0..81).map(off).sum::<f64>().sqrt()
        });
        assert!(errors[0] < errors[1], "{errors:?}");
    }

    #[test]
    fn two_sheets_over_each_other_are_not_predicted() {
        let points: Vec<Vector> =
            (0..800).map(|i| [(i % 20) as f64, (i / 20) as f64, if i * 7 % 2 == 0 { 0.0 } else { 5.0 }]).collect();
        let found = chosen(&Contacts::from_points(&points));
        assert!(found.error > 0.5 * found.relief);
    }
}
