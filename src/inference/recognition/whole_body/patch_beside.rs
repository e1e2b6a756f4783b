//! Why a patch may be no answer, and whether it serves as well as a free surface.

use super::answer::BodyAnswer;
use crate::bodies::{BodyHypothesis, Symmetry};
use crate::recognition::{Hypothesis, NormalsUse, Recognition};

/// Why a patch is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PatchDoubt {
    None,
    /// The kind bends in more than one way, or leaves much to errors that neighbours share, and may be one that patches do not know.
    Kind,
    /// Some contacts do not belong, or lie on two sheets.
    Slight,
    /// It bends farther than a patch may.
    Bent,
    /// The contacts go farther round than it does.
    AllRound,
    Refused,
}

/// A patch beside a free surface.
pub(super) struct PatchBeside<'a> {
    /// Whether it follows the contacts wherever they go.
    follows: bool,
    /// Whether its normals say nothing that the places do not, which a free surface is not told.
    is_of_places: bool,
    /// Root mean square distance of the contacts from it, over their scatter about the free surface.
    times: f64,
    free: &'a BodyAnswer<'a>,
}

impl<'a> PatchBeside<'a> {
    /// Of a patch from whose surface contacts lie so far, root mean square.
    pub(super) fn new(found: &Recognition, rms: f64, free: &'a BodyAnswer<'a>) -> PatchBeside<'a> {
        let scatter = free.posterior.best_of(free.posterior.kind()).map_or(f64::INFINITY, BodyHypothesis::scatter);
        let times = rms / (free.sample.frame.scale * scatter);
        let is_of_places = found.normals == NormalsUse::DerivedFromPositions;
        PatchBeside { follows: found.hypothesis == Hypothesis::Displaced, is_of_places, times, free }
    }

    fn is_far(&self) -> bool {
        self.times >= 1.0 / self.free.options.tuning.sharper
    }

    /// Whether what it lies far off is shape. Places alone may err together: then it is farther off than any sensor's do.
    pub(super) fn leaves_shape(&self) -> bool {
        let sharper = self.free.options.tuning.sharper;
        let told = if self.free.sample.known_normals() > 0 { sharper } else { sharper * sharper };
        !self.follows && self.times * told >= 1.0 && self.free.bends_as_a_body()
    }

    /// Whether it tells contacts as well as a free surface that goes round a body, or as well as is asked of what goes no farther round than
    /// a patch may. A symmetry that is certain says more than a patch that lies farther from the contacts, by a little where the patch only
    /// follows them and by much where it is of a kind.
    pub(super) fn serves(&self, doubt: PatchDoubt) -> bool {
        let tuning = &self.free.options.tuning;
        let is_symmetric = self.free.posterior.weight_of_symmetry(Symmetry::None) < 1.0 - tuning.certain;
        let is_farther = self.is_far() || self.follows && self.times >= tuning.as_near;
        let says_less = is_symmetric && is_farther || self.leaves_shape();
        match doubt {
            PatchDoubt::Kind => self.is_of_places || !says_less,
            PatchDoubt::Slight => !self.free.closes() && !says_less,
            PatchDoubt::Bent => !self.free.closes() && !self.is_far(),
            PatchDoubt::None | PatchDoubt::AllRound | PatchDoubt::Refused => false,
        }
    }
}
