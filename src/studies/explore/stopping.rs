//! When to stop: at a goal that holds at two looks in a row, at the budget, or where the goal cannot be attained.
//!
//! ```text
//! goal          u(S) <= u_s and u(R) <= u_r R, the total uncertainties, and no richer spline explains the contacts better
//!               (p >= 0.1, asked from 15 contacts on), nor does a likely departure move S or R by more than the goal, at two
//!               successive looks
//! noise         u_noise x (u after the whole budget / u now, both planned) > goal: no touch left can bring it down
//! model         u_model > goal and no longer falling, or a richer spline or such a departure at every look for long: doubt
//!               about the kind of surface, or errors that contacts share
//! ```
//!
//! Whoever looks often and stops when an interval happens to be narrow stops too often where it is too narrow. The second
//! look is a fresh one: it is made with touches that the first did not know.

use super::status::{Look, Stopped};

/// The goals: standard uncertainties of S, and of R as a share of R.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Of S.
    pub u_s: f64,
    /// Of R, divided by R.
    pub u_r: f64,
}

/// Looks in a row at which a goal must hold.
const IN_A_ROW: usize = 2;

/// A goal is called out of reach when what can be attained is this many times it, at two looks in a row. Smaller: goals
/// are given up that a lucky look would meet. Larger: the budget is spent in vain.
const OUT_OF_REACH: f64 = 1.3;

/// Below this p a richer spline is thought to explain the contacts better. One look in ten of a surface rightly recognised
/// falls below it, which costs a round; a smaller level overlooks more bumps that were taken for balls.
const RICHER: f64 = 0.1;

/// Below this p a departure of the lowest orders is thought likely. It counts only where S or R would move by more than the
/// goal, so that a ball or a bar pays little for it. With 0.3 a third fewer balls come to the finer goal, and four bumps in five
/// fewer to the coarser one (`benches/runs/explore.md`).
const DEPARTS: f64 = 0.1;

/// Looks over which u_model must have stood still, and the share by which it may fall while it stands still.
const STILL: usize = 5;
const STANDS: f64 = 0.9;

impl Goal {
    /// u(S) and u(R)/R of a look as shares of the goals.
    fn shares(&self, look: &Look) -> Option<[f64; 2]> {
        let [s, r] = look.totals()?;
        Some([s / self.u_s, r / self.u_r])
    }

    /// Whether the goal holds.
    pub(super) fn holds(&self, look: &Look) -> bool {
        is_doubted_in_vain(look)
            && !self.is_departed_from(look)
            && self.shares(look).is_some_and(|shares| shares.iter().all(|share| *share <= 1.0))
    }

    /// Whether the contacts depart from what was recognised, and that moves S or R by more than the goal.
    fn is_departed_from(&self, look: &Look) -> bool {
        let (Some(departure), Some(r)) = (look.departure, look.curvedness) else { return false };
        let moves = departure.shape_index.abs() > self.u_s || departure.curvedness.abs() > self.u_r * r.mean;
        departure.p < DEPARTS && moves
    }

    /// Whether the looks so far end the exploration.
    pub(super) fn ends(&self, looks: &[Look]) -> Option<Stopped> {
        let last = |n: usize| looks.len().checked_sub(n).map(|from| &looks[from..]);
        if last(IN_A_ROW).is_some_and(|looks| looks.iter().all(|look| self.holds(look))) {
            return Some(Stopped::Goal);
        }
        let beyond = |look: &Look| {
            look.attainable.is_some_and(|[s, r]| s > OUT_OF_REACH * self.u_s || r > OUT_OF_REACH * self.u_r)
        };
        if last(IN_A_ROW).is_some_and(|looks| looks.iter().all(beyond)) {
            return Some(Stopped::Noise);
        }
        let stuck = |looks: &[Look]| {
            let goals = [self.u_s, self.u_r];
            let models: Option<Vec<[f64; 2]>> = looks.iter().map(Look::models).collect();
            models.is_some_and(|m| {
                (0..2).any(|q| {
                    let least = m.iter().map(|m| m[q]).fold(f64::INFINITY, f64::min);
                    least > OUT_OF_REACH * goals[q] && least > STANDS * m[0][q]
                })
            })
        };
        let hopeless =
            |looks: &[Look]| stuck(looks) || looks.iter().all(|look| is_refuted(look) || self.is_departed_from(look));
        last(STILL).filter(|looks| hopeless(looks)).map(|_| Stopped::Model)
    }
}

/// Whether a richer spline was asked and does no better; a named model is not doubted.
fn is_doubted_in_vain(look: &Look) -> bool {
    look.named || look.richer_p.is_some_and(|p| p >= RICHER)
}

/// Whether a richer spline explains the contacts better than what was recognised.
fn is_refuted(look: &Look) -> bool {
    look.richer_p.is_some_and(|p| p < RICHER)
}
