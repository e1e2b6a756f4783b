//! Touches in, answers out: what `palpate live` does between a touch that came and the line that answers it.
//!
//! ```text
//! touch -> the touches that count -> look, or the last look is moved, or it stands -> goal?
//! ```

use palpate_geometry::contact::Contacts;

use super::goal::{LiveGoal, half_of_radius};
use super::look::LiveLook;
use super::next::TouchReach;
use super::state::LiveState;
use super::store::TouchStore;

/// How touches are answered.
#[derive(Debug)]
pub(in crate::cli) struct LiveOptions {
    /// Touches that count; all without.
    pub(in crate::cli) window: Option<usize>,
    /// Share by which the touches grow until all are looked at again.
    pub(in crate::cli) refresh: f64,
    /// Goal for half of the radius's interval.
    pub(in crate::cli) until_radius: Option<f64>,
    /// Goals for the standard uncertainties of S, and of R as a share of R.
    pub(in crate::cli) until_shape: Option<[f64; 2]>,
    /// Where the sensor stood.
    pub(in crate::cli) viewpoint: Option<[f64; 3]>,
    /// Where touches may be made.
    pub(in crate::cli) reach: TouchReach,
}

/// The touches so far and what is known of them.
#[derive(Debug)]
pub(in crate::cli) struct LiveSession {
    viewpoint: Option<[f64; 3]>,
    refresh: f64,
    reach: TouchReach,
    store: TouchStore,
    goal: LiveGoal,
    look: Option<LiveLook>,
    /// The next touch is looked at with all others, whether it agrees or not.
    is_due: bool,
    looks: u64,
}

impl LiveSession {
    /// Without touches, or with those that an earlier run has kept.
    pub(in crate::cli) fn new(options: LiveOptions, before: Option<LiveState>) -> LiveSession {
        let store = TouchStore::new(options.window);
        let store = match before {
            Some(before) => store.with(before.contacts, before.touches),
            None => store,
        };
        LiveSession {
            viewpoint: options.viewpoint,
            refresh: options.refresh,
            reach: options.reach,
            store,
            goal: LiveGoal::new(options.until_radius, options.until_shape),
            look: None,
            is_due: true,
            looks: 0,
        }
    }

    /// One touch more: it and all others are looked at, or it moves the last look, or that stands. Says whether the goal is reached.
    pub(in crate::cli) fn touch(&mut self, touch: &Contacts) -> bool {
        self.store.push(touch);
        let is_fresh = self.is_due || self.calls_for_a_look(touch);
        if is_fresh {
            self.look_again();
        }
        let shape = self.look.as_ref().and_then(LiveLook::shape);
        let is_reached = is_fresh && self.goal.is_reached_by(shape);
        // what touches have moved to the goal is confirmed by a look
        self.is_due = if is_fresh { self.goal.is_near() } else { shape.is_some_and(|shape| self.goal.holds(shape)) };
        is_reached
    }

    /// What came since the last look was not looked at with all others yet: looks once more, where anything did.
    pub(in crate::cli) fn finish(&mut self) -> bool {
        let made = self.look.as_ref().map_or(0, |look| look.touches);
        let is_behind = self.store.len() > 0 && made != self.store.touches();
        if is_behind {
            self.look_again();
        }
        is_behind
    }

    fn calls_for_a_look(&mut self, touch: &Contacts) -> bool {
        let (touches, refresh) = (self.store.touches(), self.refresh);
        self.look.as_mut().is_none_or(|look| look.is_outgrown(touches, refresh) || !look.takes(touch))
    }

    /// Looks at all touches that count.
    pub(in crate::cli) fn look_again(&mut self) {
        let (contacts, touches) = (self.store.contacts(), self.store.touches());
        self.look = Some(LiveLook::at(contacts, touches, self.viewpoint, &self.reach));
        self.looks += 1;
    }

    /// The last look.
    pub(in crate::cli) fn look(&self) -> Option<&LiveLook> {
        self.look.as_ref()
    }

    /// How often all touches were looked at.
    pub(in crate::cli) fn looks(&self) -> u64 {
        self.looks
    }

    /// Touches that ever came.
    pub(in crate::cli) fn touches(&self) -> u64 {
        self.store.touches()
    }

    /// The touches that count.
    pub(in crate::cli) fn contacts(&self) -> Contacts {
        self.store.contacts()
    }

    /// What the next run needs to go on, but for what the source of the touches knows.
    pub(in crate::cli) fn state(&self) -> LiveState {
        LiveState::new(self.touches(), self.contacts())
    }

    /// Whether there is a goal.
    pub(super) fn has_goal(&self) -> bool {
        self.goal.is_any()
    }

    /// Half of the radius's interval, where that is a goal.
    pub(super) fn half_towards_goal(&self) -> Option<f64> {
        self.goal.radius?;
        half_of_radius(self.look()?.shape()?)
    }
}
