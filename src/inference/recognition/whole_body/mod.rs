//! When contacts are judged as a body in space and not as a patch, and what is then said.
//!
//! ```text
//! patch not certain of its kind                                         ->   the same kinds and primitives in space in one posterior (`joint_kinds.rs`)
//! patch refused, or bent too far, or with contacts that do not belong   ->   primitives in space (`bodies`)
//! one primitive        the answer, read from its posterior
//! several things       a refusal that names them, unless a patch that bends in more than one way is as good
//! a free surface       where it is clearly more probable than primitives, and closes, has a symmetry, or goes farther than a patch may
//! none near enough     what the patch said
//! ```

mod answer;
mod corpus_body;
mod drawn_map;
mod drawn_shapes;
mod exchanged_axes;
mod joint_kinds;
mod kept_draws;
mod normals_of_neighbours;
mod own_axis;
mod patch_beside;
mod predicted_touches;

use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::neighbours::mean_of;
use palpate_numeric::statistics::{kurtosis_about_zero, mad};
use palpate_numeric::vector::{Vector, along, dot, norm, unit_or_zero};

pub use corpus_body::{CorpusBody, CorpusEvidence};
use exchanged_axes::agreeing_order_by_neighbours;
use joint_kinds::{beside_primitives, with_primitives_in_space, without_axis_of_patch};
use normals_of_neighbours::are_alike;
use patch_beside::{PatchBeside, PatchDoubt};

use crate::bodies::{self, BodyHypothesis, BodySample, PossibleThings, Symmetry, Thing, Tuning, Verdict};
use crate::primitives::placed::PartKind;
use crate::recognition::contacts::{
    Observations, distance_from_conic, patch_frame, spread_beside_a_line, stand_upright,
};
use crate::recognition::error::listed;
use crate::recognition::free_form::leaves_much_unsaid;
use crate::recognition::kinds::Kind;
use crate::recognition::{Hypothesis, NormalsUse, Recognition, RecognitionError, RecognitionOptions, Remark};

/// Share of the contacts' size within which distances are those of rounding.
const ROUNDING: f64 = 1e-9;

/// Contacts needed without and with normals: a ball's four unknowns and one more row.
pub(super) const NEEDED: [usize; 2] = [5, 3];

/// Contacts whose distance from a patch is asked at most: their scatter is known to a hundredth.
const ASKED: usize = 10_000;

/// The body's answer where the patch has none or a doubtful one.
///
/// # Errors
/// Those of the patch; [`RecognitionError::SeveralThings`]; [`RecognitionError::NormalsExchanged`].
pub(super) fn instead(
    patch: Result<Recognition, RecognitionError>,
    given: &Observations,
    touches: &[[f64; 2]],
    options: &RecognitionOptions,
) -> Result<Recognition, RecognitionError> {
    let patch = patch.map(without_axis_of_patch);
    let doubt = match &patch {
        Ok(found) => doubt(found, given, &options.tuning),
        Err(error) if may_be_body(error, given, options) => PatchDoubt::Refused,
        Err(_) => PatchDoubt::None,
    };
    let normals = given.normals.as_deref().unwrap_or_default();
    if doubt == PatchDoubt::None {
        return patch.map(|found| beside_primitives(found, given, touches, options));
    }
    let Some(sample) = BodySample::new(&given.points, normals, given.rounding) else { return patch };
    let question = answer::BodyQuestion { sample: &sample, given, options, touches };
    match bodies::infer(&sample, &options.tuning) {
        Verdict::Several(things) => match patch {
            Ok(found) if doubt == PatchDoubt::Kind && is_as_good(&found, &sample, &things, &options.tuning) => {
                Ok(found)
            }
            _ => Err(match agreeing_order_by_neighbours(&sample, &options.tuning) {
                Some(order) => RecognitionError::NormalsExchanged { order },
                None => several(&sample, &things),
            }),
        },
        Verdict::One(posterior) => one_instead(patch, doubt, &question.of(&posterior), normals),
        Verdict::Free { found: free, one, several } => {
            let one = one.as_deref().map(|one| question.of(one));
            let is_of_kind = one.is_some_and(|one| one.is_of_simple_kind());
            match one {
                _ if !is_of_kind && free_stands(&patch, doubt, &question.of(&free)) => {
                    let found = question.of(&bodies::with_own_contacts(*free, &sample, &options.tuning)).checked();
                    found.map(|found| beside_several(found, &sample, &several, None))
                }
                Some(one) => one_instead(patch, doubt, &one, normals),
                None => none_instead(patch, doubt, normals),
            }
        }
        Verdict::None => none_instead(patch, doubt, normals),
    }
}

/// The answer of a primitive, unless the patch tells as much, or the normals are those of another surface.
fn one_instead(
    patch: Result<Recognition, RecognitionError>,
    doubt: PatchDoubt,
    body: &answer::BodyAnswer,
    normals: &[Vector],
) -> Result<Recognition, RecognitionError> {
    body.check_axes_of_normals()?;
    let tuning = &body.options.tuning;
    if !body.explains_normals() && are_alike(body.sample, body.sd_of_normals(), tuning) {
        return none_instead(patch, doubt, normals);
    }
    let decisive = body.explains_normals() && body.false_share().max(body.normals_against()) >= tuning.decisive;
    let too_few = matches!(patch, Err(RecognitionError::TooFew { .. }));
    if too_few && body.probability() < tuning.sure_of_few {
        return patch;
    }
    let is_simpler = patch.as_ref().is_ok_and(|found| is_simpler(body, found));
    let stays = match doubt {
        PatchDoubt::Slight => !decisive && !is_simpler,
        PatchDoubt::Kind => !is_simpler,
        _ => false,
    };
    let instead = body.posterior.instead.as_ref();
    match patch {
        // things that were held against a body are held against a patch as well
        Ok(found) if stays => {
            let are_rivals = |possible: &&PossibleThings| !is_as_good(&found, body.sample, &possible.things, tuning);
            let instead = instead.filter(are_rivals);
            Ok(unless_several(with_primitives_in_space(found, body), body.sample, instead))
        }
        patch if stays => patch,
        _ => body.recognition().map(|found| unless_several(found, body.sample, instead)),
    }
}

/// The answer with less than certainty, where the contacts may be several things.
fn unless_several(mut found: Recognition, sample: &BodySample, instead: Option<&PossibleThings>) -> Recognition {
    let Some(PossibleThings { things, probability }) = instead else { return found };
    let of_one = 1.0 - probability;
    found.tried.iter_mut().for_each(|tried| tried.weight *= of_one);
    found.class_probability.iter_mut().for_each(|(_, p)| *p *= of_one);
    found.plane_probability *= of_one;
    beside_several(found, sample, things, Some(*probability))
}

/// The patch, unless contacts go farther round than it does.
fn none_instead(
    patch: Result<Recognition, RecognitionError>,
    doubt: PatchDoubt,
    normals: &[Vector],
) -> Result<Recognition, RecognitionError> {
    if doubt == PatchDoubt::AllRound { Err(all_around(normals)) } else { patch }
}

/// Whether a free surface is the answer: it has a symmetry, closes, goes farther round than a patch may, or bends as a body does where no patch
/// follows it or contacts lie far nearer to it than to any, for what does none of that is told by a patch or by a field over it; and no patch
/// serves as well.
fn free_stands(patch: &Result<Recognition, RecognitionError>, doubt: PatchDoubt, free: &answer::BodyAnswer) -> bool {
    let goes_far = doubt == PatchDoubt::AllRound || matches!(patch, Err(RecognitionError::AllAround { .. }));
    let is_other = goes_far || free.closes() || free.posterior.symmetry() != Symmetry::None;
    let tuning = &free.options.tuning;
    let enough = tuning.free_beside_patch[usize::from(free.sample.known_normals() == 0)];
    match patch {
        Ok(_) if free.sample.len() < enough => false,
        Ok(found) => {
            let beside = PatchBeside::new(found, root_mean_square(&distances(found, &free.given.points)), free);
            (is_other || beside.leaves_shape()) && !beside.serves(doubt)
        }
        Err(RecognitionError::NotOneSheet { .. }) => is_other || free.bends_as_a_body(),
        Err(_) => is_other,
    }
}

/// The patch, unless its places alone lie on one line or on one bent path but for their errors, and so tell nothing of the bend across it.
///
/// # Errors
/// [`RecognitionError::Collinear`]; [`RecognitionError::OnConic`].
pub(super) fn beside_a_line(
    found: Recognition,
    given: &Observations,
    tuning: &Tuning,
) -> Result<Recognition, RecognitionError> {
    if given.normals.is_some() {
        return Ok(found);
    }
    let err = found.noise.sd_of_contact();
    if found.class == ShapeClass::Plane && given.points.len() >= tuning.path_from {
        let scale = found.frame.scale;
        let local = given.points.iter().map(|p| found.frame.to_patch(*p));
        let places: Vec<[f64; 2]> = local.map(|[x, y, _]| [x * scale, y * scale]).collect();
        if distance_from_conic(&places).is_some_and(|off| off <= tuning.line_errors * err) {
            return Err(RecognitionError::OnConic);
        }
    }
    let [across, along] = spread_beside_a_line(&given.points)?;
    if across < tuning.narrow * along && across <= tuning.line_errors * err {
        Err(RecognitionError::Collinear { across, along })
    } else {
        Ok(found)
    }
}

/// The patch, unless most contacts lie farther off its surface than they are said to scatter. The mean of a cell lies on a plane between
/// two sheets that mirror each other, however far these are apart.
///
/// # Errors
/// [`RecognitionError::NotOneSheet`].
pub(super) fn within_its_noise(
    found: Recognition,
    given: &Observations,
    tuning: &Tuning,
) -> Result<Recognition, RecognitionError> {
    let off = distances(&found, &given.points);
    let most = (found.noise.sd_of_contact() / tuning.sharper).max(ROUNDING * found.frame.scale);
    if mad(off.iter().copied()) <= most {
        return Ok(found);
    }
    let rms = root_mean_square(&off);
    let outliers = 100.0 * found.outliers as f64 / given.points.len() as f64;
    Err(RecognitionError::NotOneSheet { misfit: 100.0 * rms / found.frame.scale, outliers })
}

/// Of contacts from a patch, of very many those of a part, evenly among all.
fn distances(found: &Recognition, points: &[Vector]) -> Vec<f64> {
    points.iter().step_by(points.len().div_ceil(ASKED).max(1)).map(|p| found.surface.distance(*p)).collect()
}

fn root_mean_square(off: &[f64]) -> f64 {
    (off.iter().map(|d| d * d).sum::<f64>() / off.len() as f64).sqrt()
}

fn may_be_body(error: &RecognitionError, given: &Observations, options: &RecognitionOptions) -> bool {
    let tuning = &options.tuning;
    match error {
        RecognitionError::NotOneSheet { .. } | RecognitionError::AllAround { .. } => true,
        // places on one ring or in two rows lie on many surfaces, but a short pipe looks like a ring from its end
        RecognitionError::OnConic => given.normals.is_some() || is_upright(given, options),
        RecognitionError::TooFew { .. } => {
            let in_a_row =
                spread_beside_a_line(&given.points).is_ok_and(|[across, along]| across < tuning.narrow * along);
            given.points.len() >= NEEDED[usize::from(given.normals.is_some())] && !in_a_row
        }
        // one finger's path with normals; places alone on a line tell no bend
        RecognitionError::Collinear { .. } => false,
        _ => false,
    }
}

fn is_upright(given: &Observations, options: &RecognitionOptions) -> bool {
    let Ok(frame) = patch_frame(&given.points, None, options) else { return false };
    let places: Vec<Vector> = given.points.iter().map(|p| frame.to_patch(*p)).collect();
    stand_upright(&places, options.tuning.patch_reach_deg)
}

fn doubt(found: &Recognition, given: &Observations, tuning: &Tuning) -> PatchDoubt {
    let count = given.points.len() as f64;
    let mean = found.averaged.iter().fold([0.0; 3], |sum, (_, normal)| along(sum, 1.0, *normal));
    let middle = unit_or_zero(mean);
    let least = tuning.patch_reach_deg.to_radians().cos();
    let turns_away = |normal: &Vector| dot(*normal, middle) < least;
    // believed normals, of whichever sign, go farther round than the map, where the patch is no more than a part of a body
    let given_normals = given.normals.iter().flatten().filter(|_| found.normals == NormalsUse::Believed);
    let away = given_normals.filter(|n| norm(**n) > 0.0 && dot(**n, middle).abs() < least).count() as f64;
    if away > tuning.farther_round * count {
        return PatchDoubt::AllRound;
    }
    if norm(mean) == 0.0 || found.averaged.iter().any(|(_, normal)| turns_away(normal)) {
        return PatchDoubt::Bent;
    }
    let set_aside = found.outliers.max(found.normals_against) as f64 > tuning.doubtful * count;
    let contradicted = found.normals == NormalsUse::Contradicting;
    if set_aside || contradicted || leaves_much_unsaid(found, tuning) || has_two_peaks(found, given, tuning) {
        return PatchDoubt::Slight;
    }
    let bends = matches!(
        found.hypothesis,
        Hypothesis::Torus | Hypothesis::General | Hypothesis::Quadric | Hypothesis::Paraboloid | Hypothesis::Displaced
    );
    // what is read as errors that neighbours share may be another kind of body
    if bends || found.noise.sd_correlated * tuning.sharper > found.noise.sd_z {
        return PatchDoubt::Kind;
    }
    PatchDoubt::None
}

/// Whether a body explains the contacts by less than a patch does: patches do not know the cone, and take what it is off a bar or a ring for
/// errors that neighbours share; a displaced patch is whatever primitive it is not far nearer to the contacts than, for that follows each of
/// few contacts; and a far nearer one is better than any patch. None of them departs, but for a cone that is still one.
fn is_simpler(body: &answer::BodyAnswer, found: &Recognition) -> bool {
    let (posterior, tuning) = (body.posterior, &body.options.tuning);
    let is_plain = posterior.weight_without_departure() > 0.5;
    if posterior.weight_of(PartKind::Cone) >= 0.5 {
        return is_plain || body.is_of_simple_kind();
    }
    let scatter = posterior.best_of(posterior.kind()).map_or(f64::INFINITY, BodyHypothesis::scatter);
    let least = if found.hypothesis == Hypothesis::Displaced { 1.0 / tuning.sharper } else { tuning.sharper };
    let is_other = Hypothesis::from(posterior.kind()) != found.hypothesis;
    is_plain && is_other && body.sample.frame.scale * scatter <= least * found.noise.sd_of_contact()
}

/// Whether a patch that bends in more than one way explains the contacts as well as several things: it makes them no less likely, or
/// rings and ellipsoids are among the things, which follow the pieces of any smooth surface.
///
/// ```text
/// ln p = -n ln s - u ln(sqrt(n) / s)       s: scatter in units of the contacts' size, u: unknowns
/// ```
///
/// The second term is [`bodies::price_of_unknowns`]. A contact of no thing is anywhere within the reach, as likely as with the scatter
/// `reach / sqrt(2 pi e)`. A patch with a displacement has as many unknowns as
/// it wants, and is given those of the things.
fn is_as_good(found: &Recognition, sample: &BodySample, things: &[Thing], tuning: &Tuning) -> bool {
    let follows_any = |thing: &Thing| matches!(thing.primitive.kind, PartKind::Torus | PartKind::Ellipsoid);
    let count = sample.len() as f64;
    let price = |scatter: f64, unknowns: usize| bodies::price_of_unknowns(unknowns as f64, count, scatter);
    let unknowns: usize = things.iter().map(|thing| thing.primitive.kind.free().len()).sum();
    let of_patch = if found.hypothesis == Hypothesis::Displaced { unknowns } else { Kind::General.unknowns() };
    let held = things.iter().map(|thing| thing.contacts).sum::<usize>() as f64;
    let of_none = tuning.scatter_of_none().ln();
    let [one, all] = [found.noise.sd_of_contact() / sample.frame.scale, bodies::scatter(things)];
    let of_things = held * all.ln() + (count - held) * of_none + price(all, unknowns);
    things.iter().any(follows_any) || count * one.ln() + price(one, of_patch) <= of_things
}

/// Whether the contacts lie on two sheets beside the surface.
fn has_two_peaks(found: &Recognition, given: &Observations, tuning: &Tuning) -> bool {
    if given.points.len() < tuning.peaks_from {
        return false;
    }
    kurtosis_about_zero(&distances(found, &given.points)) < tuning.two_peaks
}

fn all_around(normals: &[Vector]) -> RecognitionError {
    RecognitionError::AllAround { mean_length: norm(mean_of(normals)), measured: true }
}

fn several(sample: &BodySample, things: &[Thing]) -> RecognitionError {
    let (things_in_words, percent) = in_words(sample, things);
    RecognitionError::SeveralThings {
        things: things_in_words,
        percent,
        misfit: sample.frame.scale * bodies::scatter(things),
    }
}

/// A surface with the remark that several things may be what the contacts show.
fn beside_several(
    mut found: Recognition,
    sample: &BodySample,
    things: &[Thing],
    probability: Option<f64>,
) -> Recognition {
    if !things.is_empty() {
        let (things, percent) = in_words(sample, things);
        found.notes.push(Remark::MayBeSeveral { things: listed(&things, &percent), probability });
    }
    found
}

/// Things in words, and their shares of the contacts in percent.
fn in_words(sample: &BodySample, things: &[Thing]) -> (Vec<String>, Vec<f64>) {
    let share = |thing: &Thing| 100.0 * thing.contacts as f64 / sample.len() as f64;
    let name = |thing: &Thing| {
        let radius = significant(thing.primitive.sizes[0] * sample.frame.scale);
        match thing.primitive.kind {
            PartKind::Plane | PartKind::Patch => "a plane".to_string(),
            PartKind::Sphere => format!("a ball of radius {radius}"),
            PartKind::Cylinder => format!("a pipe or bar of radius {radius}"),
            PartKind::Cone => "a cone".to_string(),
            PartKind::Torus => format!("a ring of radius {radius}"),
            PartKind::Ellipsoid => "an ellipsoid".to_string(),
        }
    };
    (things.iter().map(name).collect(), things.iter().map(share).collect())
}

/// Four digits.
fn significant(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    format!("{rounded}")
}

/// The answer where nothing tells the free side: S by its size, every class with its mirror image.
pub(super) fn of_either_side(mut found: Recognition) -> Recognition {
    found.class_probability = mirrored(&found.class_probability);
    if let Some(s) = found.shape_index.as_mut() {
        let [lo, hi] = s.interval;
        let least = if lo > 0.0 { lo } else { (-hi).max(0.0) };
        (s.mean, s.interval) = (s.mean.abs(), [least, lo.abs().max(hi.abs())]);
        found.class = ShapeClass::of_shape_index(s.mean);
    }
    found
}

/// Half of every probability for the mirror image.
fn mirrored(classes: &[(ShapeClass, f64)]) -> Vec<(ShapeClass, f64)> {
    let mut out: Vec<(ShapeClass, f64)> = Vec::new();
    for (class, p) in classes {
        for class in [*class, class.mirrored()] {
            match out.iter_mut().find(|(known, _)| *known == class) {
                Some((_, sum)) => *sum += 0.5 * p,
                None => out.push((class, 0.5 * p)),
            }
        }
    }
    // of two that are as probable the convex one first
    out.sort_by(|a, b| b.1.total_cmp(&a.1).then((b.0 as u8).cmp(&(a.0 as u8))));
    out
}
