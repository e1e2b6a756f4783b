//! When enough is known: a goal that holds at two answers in a row, each of touches that the other did not know.
//!
//! ```text
//! radius      (hi - lo) / 2 <= goal           of its interval
//! S and R     u(S) <= goal, u(R) / R <= goal   as palpate explore has them
//! ```

use crate::report::ShapePart;

/// Answers in a row at which a goal must hold: one interval may be narrow by chance.
const IN_A_ROW: usize = 2;

/// What is to be known, and for how many answers it has been.
#[derive(Clone, Debug, Default)]
pub(super) struct LiveGoal {
    /// Half of the radius's interval.
    pub(super) radius: Option<f64>,
    /// Standard uncertainties of S, and of R as a share of R.
    pub(super) shape: Option<[f64; 2]>,
    held: usize,
}

impl LiveGoal {
    /// Of a radius, or of S and R, or of both, or none.
    pub(super) fn new(radius: Option<f64>, shape: Option<[f64; 2]>) -> LiveGoal {
        LiveGoal { radius, shape, held: 0 }
    }

    /// Whether there is one.
    pub(super) fn is_any(&self) -> bool {
        self.radius.is_some() || self.shape.is_some()
    }

    /// Whether it held at the last answer, so that the next one decides.
    pub(super) fn is_near(&self) -> bool {
        self.held > 0
    }

    /// Whether it is reached by this answer, made of new touches; `None` is no answer.
    pub(super) fn is_reached_by(&mut self, shape: Option<&ShapePart>) -> bool {
        self.held = if shape.is_some_and(|shape| self.holds(shape)) { self.held + 1 } else { 0 };
        self.held >= IN_A_ROW
    }

    /// Whether an answer is as well known as is wished.
    pub(super) fn holds(&self, shape: &ShapePart) -> bool {
        let radius = self.radius.is_none_or(|goal| half_of_radius(shape).is_some_and(|half| half <= goal));
        let both = self.shape.is_none_or(|[u_s, u_r]| {
            let (s, r) = (&shape.shape_index, &shape.curvedness);
            let share = r.u.zip(r.mean).map(|(u, mean)| u / mean);
            s.u.is_some_and(|u| u <= u_s) && share.is_some_and(|u| u <= u_r)
        });
        self.is_any() && radius && both
    }
}

/// Half of the radius's interval.
pub(super) fn half_of_radius(shape: &ShapePart) -> Option<f64> {
    shape.radius?;
    match crate::report::radius_bounds(shape) {
        [Some(lo), Some(hi)] => Some(0.5 * (hi - lo)),
        _ => None,
    }
}
