//! A body of no simple kind: a process in space about a primitive that is near it, or about an axis.
//!
//! ```text
//! F(p) = d(p) - f(q) = 0      q = p           any surface
//!                             q = (rho, h)    a body of revolution: turned on a lathe or a wheel
//!                             q = (x, y)      a body that is the same all along a line: an extrusion
//! every form    rated about its base, the likeliest of each symmetry followed to its mode by steps of Gauss's and Newton's
//! an answer     where contacts left out lie as near as its scatter says, and far nearer than to the primitive,
//!               and where it does not meet itself within that scatter
//! ```
//!
//! That is a gaussian-process implicit surface whose mean is a primitive: O. Williams and A. Fitzgibbon, *Gaussian Process Implicit
//! Surfaces*, 2007. A symmetry costs nothing and is told by the evidence: f then has fewer places to go. A departure of it is shape,
//! never a sensor's error.

use super::body_hypothesis::BodyHypothesis;
use super::body_posterior::{BodyPosterior, normalised};
use super::coordinates::DepartureOver;
use super::departure_kernel::{DepartureKernel, KernelFamily};
use super::evidence::LinearisedBase;
use super::mode::{FalseContacts, Mode};
use super::posterior::{DrawnBase, draws};
use super::sample::BodySample;
use super::search::ModeSearch;
use super::symmetry::{FreeBody, symmetric_forms};
use super::tuning::Tuning;
use palpate_numeric::statistics::{Rank, mad, quantile};
use palpate_numeric::threads;
use palpate_numeric::vector::{Vector, along};

/// One contact of so many is left out.
const LEFT_OUT: usize = 5;

/// A surface as far as it is known, and the contacts that are its own.
#[derive(Clone)]
struct FreeMode {
    surface: DrawnBase,
    over: DepartureOver,
    /// Weights of the contacts, 0 or 1, and rough scales.
    mode: Mode,
    best: BodyHypothesis,
}

/// The posterior of a free surface; `None` where contacts are too few, or do not tell each other's place. Of more than
/// [`Tuning::free_contacts`] none is said to be its own: [`with_own_contacts`] says it where the surface is the answer, for it is asked of each.
pub(crate) fn free_surface(all: &BodySample, search: &ModeSearch) -> Option<BodyPosterior> {
    let tuning = search.tuning;
    let sample = &all.at_most(tuning.free_contacts);
    if sample.len() < tuning.free_from[usize::from(sample.known_normals() == 0)] {
        return None;
    }
    let few = sample.at_most(tuning.searched);
    let found = search.modes(&few);
    let likeliest = likeliest_modes(forms(sample, &found, tuning), sample, tuning);
    let best = likeliest.iter().max_by(|a, b| a.best.log_evidence.total_cmp(&b.best.log_evidence))?;
    if !predicts(best, sample, tuning) {
        return None;
    }
    let (mut nodes, mut primitives, mut members) = (Vec::new(), Vec::new(), Vec::new());
    for found in &likeliest {
        let linearised = found.linearised(sample, &of_every_family(tuning), tuning);
        let own = linearised.departed_nodes_near(primitives.len(), &tuning.free_sizes, tuning);
        nodes.extend(own);
        primitives.push(linearised.primitive);
        members.push(if sample.len() == all.len() { found.belonging(all, tuning) } else { Vec::new() });
    }
    let (nodes, weights, log_evidence) = normalised(nodes, tuning)?;
    Some(BodyPosterior { primitives, members, nodes, weights, log_evidence, is_free: true, instead: None })
}

/// The same with those of all contacts that lie on its likeliest surface, by what a contact scatters, or by what most contacts are off by
/// where they show more than the surface follows.
pub(crate) fn with_own_contacts(mut found: BodyPosterior, all: &BodySample, tuning: &Tuning) -> BodyPosterior {
    let Some(best) = found.best_of(found.kind()).filter(|_| all.len() > tuning.free_contacts) else { return found };
    let of = best.of;
    let surface = DrawnBase::likeliest(best.likeliest(&found.primitives[of]), best);
    let off: Vec<f64> = all.points.iter().map(|place| surface.distance(*place)).collect();
    let far = tuning.belongs * best.scatter().max(mad(off.iter().copied()));
    found.members[of] = (0..all.len()).filter(|i| off[*i].abs() <= far).collect();
    found
}

/// By which a mode is found.
fn gaussian(lengths: &[f64], apart: f64) -> Vec<DepartureKernel> {
    lengths.iter().map(|length| DepartureKernel::gaussian(*length, apart)).collect()
}

/// By which it is then known: what bends evenly, and what does not.
fn of_every_family(tuning: &Tuning) -> Vec<DepartureKernel> {
    let [_, evenly, apart] = tuning.free_apart;
    let matern = |length: &f64| DepartureKernel { family: KernelFamily::Matern, length: *length, apart };
    let gaussian = gaussian(&tuning.free_lengths, evenly);
    gaussian.into_iter().chain(tuning.free_lengths.iter().map(matern)).collect()
}

/// Every form that is tried.
fn forms(sample: &BodySample, found: &[Mode], tuning: &Tuning) -> Vec<FreeBody> {
    let in_space = |mode: &Mode| FreeBody { base: mode.primitive, over: DepartureOver::Space };
    let whole = found.iter().filter(|mode| mode.strays == FalseContacts::None);
    whole.map(in_space).chain(symmetric_forms(sample, found, tuning)).collect()
}

/// The likeliest form of every symmetry, followed to its mode.
fn likeliest_modes(forms: Vec<FreeBody>, sample: &BodySample, tuning: &Tuning) -> Vec<FreeMode> {
    let few = &sample.at_most(tuning.searched);
    let by = gaussian(&tuning.free_rated, tuning.free_apart[0]);
    let rated = threads::map(forms.len(), 1, |k| FreeMode::about(forms[k], few, &by, tuning));
    let mut rated: Vec<FreeMode> = rated.into_iter().flatten().collect();
    rated.sort_by(|a, b| b.best.log_evidence.total_cmp(&a.best.log_evidence));
    let own = |over: DepartureOver| rated.iter().filter(move |mode| mode.over == over).take(tuning.free_followed);
    let begun: Vec<&FreeMode> = DepartureOver::FORMS.into_iter().flat_map(own).collect();
    let followed = threads::map(begun.len(), 1, |k| {
        let found = begun[k].again(few, sample, tuning)?;
        Some(found).filter(|mode| !mode.folds_within_its_scatter(sample, tuning))
    });
    let of = |over: DepartureOver| {
        let own = followed.iter().flatten().filter(|mode| mode.over == over);
        own.max_by(|a, b| a.best.log_evidence.total_cmp(&b.best.log_evidence)).cloned()
    };
    DepartureOver::FORMS.into_iter().filter_map(of).collect()
}

impl FreeMode {
    /// About a base, with departures of some lengths.
    fn about(form: FreeBody, sample: &BodySample, kernels: &[DepartureKernel], tuning: &Tuning) -> Option<FreeMode> {
        let distances: Vec<f64> = sample.points.iter().map(|p| form.base.nearest(*p).0.abs()).collect();
        let scatter = quantile(distances, tuning.surely_own, Rank::Reached)?;
        let weights = vec![1.0; sample.len()];
        let sd = [scatter.max(sample.floor[0]), tuning.random_normals];
        let mode = Mode { primitive: form.base, weights, sd, likelihood: 0.0, strays: FalseContacts::None };
        FreeMode::found(DrawnBase::of_primitive(form.base), form.over, mode, sample, kernels, tuning)
    }

    /// The likeliest surface by the equations about one.
    fn found(
        surface: DrawnBase,
        over: DepartureOver,
        mode: Mode,
        sample: &BodySample,
        kernels: &[DepartureKernel],
        tuning: &Tuning,
    ) -> Option<FreeMode> {
        let linearised = LinearisedBase::of_level_set(&surface, over, &mode, sample, kernels, tuning);
        let nodes = linearised.departed_nodes_near(0, &tuning.free_sizes, tuning);
        let best = nodes.into_iter().max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))?;
        let surface = DrawnBase::likeliest(best.likeliest(&linearised.primitive), &best);
        let mode = Mode { sd: best.sd, ..mode };
        Some(FreeMode { surface, over, mode, best })
    }

    fn linearised<'a>(
        &self,
        sample: &'a BodySample,
        kernels: &[DepartureKernel],
        tuning: &Tuning,
    ) -> LinearisedBase<'a> {
        LinearisedBase::of_level_set(&self.surface, self.over, &self.mode, sample, kernels, tuning)
    }

    /// The same over all contacts, and then over those that lie near it, if these are likelier.
    fn again(&self, few: &BodySample, all: &BodySample, tuning: &Tuning) -> Option<FreeMode> {
        let near = self.clone().followed(few, &gaussian(&tuning.free_rated, tuning.free_apart[0]), tuning);
        let by = &gaussian(&tuning.free_lengths, tuning.free_apart[0]);
        let mode = Mode { weights: vec![1.0; all.len()], ..near.mode };
        let whole = FreeMode::found(near.surface, self.over, mode, all, by, tuning)?;
        let whole = whole.followed(all, by, tuning);
        let mode = Mode { weights: whole.weights(all, tuning), ..whole.mode.clone() };
        if mode.others().is_empty() {
            return Some(whole);
        }
        let own = FreeMode::found(whole.surface.clone(), self.over, mode, all, by, tuning);
        let own = own.map(|own| own.followed(all, by, tuning));
        Some(own.filter(|own| own.best.log_evidence > whole.best.log_evidence).unwrap_or(whole))
    }

    /// The same after steps to its mode.
    fn followed(self, sample: &BodySample, kernels: &[DepartureKernel], tuning: &Tuning) -> FreeMode {
        let mut known = self;
        for _ in 0..tuning.free_rounds {
            let (surface, mode) = (known.surface.clone(), known.mode.clone());
            let Some(next) = FreeMode::found(surface, known.over, mode, sample, kernels, tuning) else { break };
            let gain = next.best.log_evidence - known.best.log_evidence;
            if gain <= 0.0 {
                break;
            }
            known = next;
            if gain < SETTLED {
                break;
            }
        }
        known
    }

    /// 1 for the contacts that are no farther from the surface than its own scatter lets them.
    fn weights(&self, sample: &BodySample, tuning: &Tuning) -> Vec<f64> {
        let far = tuning.belongs * self.scatter(sample);
        let is_own = |p: &Vector| self.surface.distance(*p).abs() <= far;
        sample.points.iter().map(|p| if is_own(p) { 1.0 } else { 0.0 }).collect()
    }

    /// Sd of a contact, by the median of the distances.
    fn scatter(&self, sample: &BodySample) -> f64 {
        mad(sample.points.iter().map(|p| self.surface.distance(*p))).max(sample.floor[0])
    }

    /// Whether contacts have another sheet of it nearer than they scatter, so that they do not say on which they lie: a surface that is wound
    /// through a volume.
    fn folds_within_its_scatter(&self, sample: &BodySample, tuning: &Tuning) -> bool {
        let far = tuning.sheets_apart * self.best.scatter();
        let is_beside_another = |i: &usize| {
            let (foot, outwards) = self.surface.over(sample.points[*i]);
            [-far, far].into_iter().any(|by| self.surface.distance(along(foot, by, outwards)).abs() < 0.5 * far)
        };
        let own = self.mode.members();
        let folded = own.iter().filter(|i| is_beside_another(i)).count();
        folded as f64 > tuning.doubtful * own.len() as f64
    }

    fn belonging(&self, all: &BodySample, tuning: &Tuning) -> Vec<usize> {
        let weights = self.weights(all, tuning);
        (0..all.len()).filter(|i| weights[*i] > 0.5).collect()
    }
}

/// A round by which the log evidence grows less ends the search: no weight then changes by more than a tenth.
const SETTLED: f64 = 0.1;

/// Whether a departure of the likeliest length and size tells contacts that it was not told of: as nearly as their scatter and what it does
/// not know between the others say, and far more nearly than the primitive.
fn predicts(best: &FreeMode, sample: &BodySample, tuning: &Tuning) -> bool {
    let (Some([_, size]), Some(process)) = (best.best.departure, &best.best.process) else { return false };
    let own: Vec<usize> = best.mode.members();
    let is_out = |i: &usize| i.is_multiple_of(LEFT_OUT);
    let (out, kept): (Vec<usize>, Vec<usize>) = own.into_iter().partition(is_out);
    let few = sample.only(&kept);
    let mode = Mode { weights: vec![1.0; few.len()], ..best.mode.clone() };
    let linearised = LinearisedBase::of_level_set(&best.surface, best.over, &mode, &few, &[process.kernel()], tuning);
    let Some(node) = linearised.departed_nodes(0, &[size], 0.0, tuning).next() else { return false };
    let surface = DrawnBase::likeliest(node.likeliest(&linearised.primitive), &node);
    let scatter = node.scatter();
    let known = BodyPosterior::of_one(linearised.primitive, node);
    let drawn = draws(&known, &Tuning { draws: tuning.predicted_draws, ..tuning.clone() }, PREDICTED);
    let errors = out.iter().map(|i| {
        let place = sample.points[*i];
        let off = surface.distance(place);
        let unknown = drawn.iter().map(|d| d.share * (d.distance(place) - off).powi(2)).sum::<f64>();
        [off.powi(2), best.mode.primitive.nearest(place).0.powi(2), unknown + scatter.powi(2)]
    });
    let [of_surface, of_primitive, expected] = errors.fold([0.0; 3], |sum, e| [0, 1, 2].map(|k| sum[k] + e[k]));
    of_surface < (tuning.free_predicts.powi(2) * of_primitive).min(tuning.belongs.powi(2) * expected)
}

/// Seed of the draws by which contacts that were left out are predicted.
const PREDICTED: u64 = 0;
