//! Which equations explain the contacts best: about plain kinds, about a displaced surface, with normals that are believed, about a
//! surface that departs from a plane, or with normals that are all turned or all too steep.
//!
//! ```text
//! looks: plain -> displaced where likely (relinearise.rs) -> normals believed -> a finer displacement
//!        -> over a plane (discrepancy_over_plane.rs) -> a tilt (noise/tilt.rs) and a gain (noise/gain.rs) of the normals
//! taken: the last whose highest log evidence, less `Tuning::rare_error` for a tilt or a gain, exceeds that of the look before;
//!        these only where the log likelihood of their likeliest surface does so, too
//! ```

use crate::recognition::discrepancy::DepartureResolution;
use crate::recognition::equations::slopes;

use super::discrepancy_over_plane::{OverPlane, over_plane};
use super::evidence_grid::PartialEvidence;
use super::linearised::{FactorPair, Linearised, NormalsTold};
use super::marginal_likelihood::{Evidence, Look};
use super::node::{Node, highest, likeliest};
use super::relinearise::{moved, taken, with_normals_believed};
use super::search_context::SearchContext;

/// A look: its equations, their evidence, all nodes.
type SearchedModel<'a> = (&'a Linearised, (Evidence<'a>, Vec<Node>));

impl<'a> SearchContext<'a> {
    fn begun(&self, made: &'a Linearised, look: Look) -> PartialEvidence<'a> {
        Evidence::begun(*self, made, look)
    }

    fn see(&self, made: &'a Linearised, look: Look) -> SearchedModel<'a> {
        (made, self.begun(made, look).finished())
    }

    /// The second look after a first one.
    fn again(&self, plain: &Linearised, nodes: &[Node]) -> Option<Linearised> {
        taken(plain, &moved(plain, nodes, *self)?, *self)
    }

    /// The same equations about a finer displacement, where the likeliest surface is displaced.
    fn finer(&self, chosen: &SearchedModel) -> Option<Linearised> {
        let (made, (_, nodes)) = chosen;
        likeliest_node(chosen).filter(|node| node.is_displaced())?;
        let moved = moved(made, nodes, *self)?;
        let fine = Linearised { resolution: DepartureResolution::Fine, ..(*made).clone() };
        taken(&fine, &moved, *self)
    }

    /// What one kernel says of these equations: those about the displaced surface, where a displacement is likely, and the highest log
    /// evidence of either.
    fn glance(&self, made: &Linearised, kernel: usize) -> (Option<Linearised>, f64) {
        let under = |made: &Linearised| Evidence::under(*self, made, kernel).1;
        let nodes = under(made);
        let again = self.again(made, &nodes);
        let (of, nodes) = again.as_ref().map_or((made, nodes), |again| (again, under(again)));
        let height = highest(&nodes) + of.log_share();
        (again, height)
    }

    /// Whether a gain of the normals explains any of what was chosen better, that surface and the errors kept as they are.
    fn gains(&self, chosen: &SearchedModel, likeliest: &Node) -> Option<bool> {
        let (made, (evidence, _)) = chosen;
        let (mean, _) = evidence.joint_posterior(likeliest)?;
        let (x, z) = mean.split_at(likeliest.kind.unknowns());
        let base = evidence.models.iter().find(|m| m.kind() == likeliest.kind)?;
        let slopes = slopes(&made.rows, &evidence.weights_of(likeliest, z), base, x);
        let gained = made.with_gain_about(slopes.as_ref(), self.cells, self.factors, self.tuning)?;
        let reached = Evidence::of_hypothesis(likeliest, *self, &gained)?;
        Some(reached > height(chosen))
    }

    /// Equations about a plane under what was chosen; `None` where they are not likelier under its kernel.
    fn over_plane(&self, chosen: &SearchedModel) -> Option<Linearised> {
        let (made, (evidence, nodes)) = chosen;
        let OverPlane { moved, longer } = over_plane(made, evidence, nodes, self.tuning)?;
        let flat = taken(made, &moved, *self)?;
        let flat = Linearised { over_plane: Some(longer), ..flat };
        let (_, found) = Evidence::under(*self, &flat, moved.kernel);
        (highest(&found) + flat.log_share() > height(chosen) + self.tuning.look_ahead).then_some(flat)
    }

    /// Equations with a gain of the normals; `None` where it would explain too little of a surface without departures, nothing of a
    /// displaced one, or is no likelier than what was chosen.
    fn with_gain(&self, plain: &Linearised, chosen: &SearchedModel) -> Option<(Linearised, Look)> {
        let likeliest = likeliest_node(chosen)?;
        if likeliest.is_displaced() && !self.gains(chosen, likeliest)? {
            return None;
        }
        let told = || plain.told_with_gain(self.cells, self.factors, self.tuning);
        if !likeliest.is_displaced() && !self.tells_more(plain, &told()?)? {
            return None;
        }
        self.glanced(plain.with_gain(self.cells, self.factors, self.tuning)?, chosen)
    }

    /// Equations with normals that are all turned; `None` where that explains too little of a surface without departures, or is no likelier
    /// than what was chosen.
    fn with_tilt(&self, plain: &Linearised, chosen: &SearchedModel) -> Option<(Linearised, Look)> {
        if !self.tells_more(plain, &plain.told_with_tilt(self.cells, self.factors, self.tuning)?)? {
            return None;
        }
        self.glanced(plain.with_tilt(self.cells, self.factors, self.tuning)?, chosen)
    }

    /// Whether the kinds alone are likelier with an error that all normals share: a look at them costs little, and mostly suffices.
    fn tells_more(&self, plain: &Linearised, told: &NormalsTold) -> Option<bool> {
        let of = |told: &NormalsTold| Evidence::of_plain_kinds(*self, plain, told);
        Some(of(told)? > of(&plain.told())? + self.tuning.rare_error)
    }

    /// These equations, or those about their displaced surface; `None` where they are no likelier than what was chosen, under the kernel of
    /// that or where neighbours share no errors.
    fn glanced(&self, made: Linearised, chosen: &SearchedModel) -> Option<(Linearised, Look)> {
        let kernel = likeliest_node(chosen)?.kernel;
        let kernels = if kernel == 0 { &[0][..] } else { &[0, kernel] };
        let looked = kernels.iter().map(|kernel| self.glance(&made, *kernel));
        let (again, reached) = looked.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let made = again.map_or((made, Look::First), |again| (again, Look::Second));
        (reached > height(chosen) + self.tuning.rare_error).then_some(made)
    }
}

/// Highest log evidence, with what the errors of the normals add.
fn height(seen: &SearchedModel) -> f64 {
    highest(&seen.1.1) + seen.0.log_share()
}

fn likeliest_node<'s>(seen: &'s SearchedModel) -> Option<&'s Node> {
    likeliest(&seen.1.1)
}

/// Log likelihood of the contacts under the likeliest surface.
fn fits(seen: &SearchedModel, factors: &FactorPair) -> Option<f64> {
    let of_contacts = seen.1.0.log_likelihood(likeliest_node(seen)?, &factors.positions)?;
    Some(of_contacts + seen.0.log_share())
}

/// Whether an error that all normals share makes both the contacts and the whole of what is known of them likelier than what was chosen.
fn explains(seen: &SearchedModel, chosen: &SearchedModel, at: SearchContext) -> bool {
    let rare = at.tuning.rare_error;
    let fits_better = fits(seen, at.factors) > fits(chosen, at.factors).map(|other| other + rare);
    fits_better && height(seen) > height(chosen) + rare
}

/// Whether a sensor may err as the likeliest surface says.
fn is_believable(seen: &SearchedModel) -> bool {
    let coefficients = likeliest_node(seen).and_then(|node| seen.1.0.coefficients(node));
    seen.0.gain.as_ref().zip(coefficients).is_some_and(|(gain, at)| gain.is_believable(&at))
}

/// Tells of the likeliest look. What `may_be_error` of the sensor and no shape stays over the curved base: a surface without it is one
/// of two constant curvatures, which there is none of over a plane.
pub(crate) fn likeliest_look<T>(
    at: SearchContext,
    plain: &Linearised,
    may_be_error: impl Fn(&Linearised, &Evidence, &[Node]) -> bool,
    tell: impl FnOnce(&Linearised, &Evidence, &[Node]) -> T,
) -> T {
    let begun = at.begun(plain, Look::First);
    // where a displaced surface is far ahead, the second look needs no whole first one
    let at_once = begun.displaced_at_once().and_then(|nodes| at.again(plain, &nodes));
    let later;
    let mut chosen = match &at_once {
        Some(again) => at.see(again, Look::Second),
        None => {
            let first = begun.finished();
            later = at.again(plain, &first.1);
            later.as_ref().map_or((plain, first), |again| at.see(again, Look::Second))
        }
    };
    let believed = with_normals_believed(chosen.0, plain, at);
    if let Some((believed, _)) = believed.as_ref().filter(|(_, log_evidence)| *log_evidence > height(&chosen)) {
        chosen = at.see(believed, Look::Second);
    }
    let finer = at.finer(&chosen);
    let told = finer.as_ref().map(|finer| at.see(finer, Look::Second)).filter(|seen| {
        // what it leaves to errors that neighbours share beyond those of a contact is a surface that it cannot follow, and a spline may
        let per_cell = at.contacts.len() as f64 / at.cells.points.len() as f64;
        let explains_all = likeliest_node(seen).is_some_and(|node| node.is_displaced() && node.ratio <= per_cell);
        explains_all && height(seen) > height(&chosen) + at.tuning.look_ahead
    });
    chosen = told.unwrap_or(chosen);
    let is_displaced = likeliest_node(&chosen).is_some_and(Node::is_displaced);
    let is_shape = is_displaced && !may_be_error(chosen.0, &chosen.1.0, &chosen.1.1);
    let flat = if is_shape { at.over_plane(&chosen) } else { None };
    if let Some(seen) = flat
        .as_ref()
        .map(|flat| at.see(flat, Look::Second))
        .filter(|seen| height(seen) > height(&chosen) + at.tuning.look_ahead)
    {
        chosen = seen;
    }
    let tilted = at.with_tilt(plain, &chosen);
    if let Some(seen) =
        tilted.as_ref().map(|(made, look)| at.see(made, *look)).filter(|seen| explains(seen, &chosen, at))
    {
        chosen = seen;
    }
    let turned = chosen.0.tilt.as_ref().and_then(|_| plain.with_tilt(at.cells, at.factors, at.tuning));
    let gained = at.with_gain(turned.as_ref().unwrap_or(plain), &chosen);
    let seen = gained.as_ref().map(|(made, look)| at.see(made, *look));
    if let Some(seen) = seen.filter(|seen| is_believable(seen) && explains(seen, &chosen, at)) {
        chosen = seen;
    }
    let (linearised, (evidence, nodes)) = &chosen;
    tell(linearised, evidence, nodes)
}
