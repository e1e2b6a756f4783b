//! Which touches of a stream count: all, the last so many, or each the less the older it is.
//!
//! ```text
//! window n    A = sum of the last n touches: the new one is added, the oldest is taken away
//! decay d     A <- d A + new: a touch that is k touches old counts d^k, as if its sds were larger by d^(-k/2)
//! ```
//!
//! What is taken away leaves its rounding behind. Each time the window has been renewed, the sums are therefore formed anew
//! from the touches in it, so that rounding never gathers.

use super::error::PlanError;

/// Place, height and slopes of one touch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct StreamTouch {
    pub(super) at: [f64; 2],
    pub(super) z: f64,
    pub(super) slopes: [f64; 2],
}

/// What a stream remembers.
#[derive(Clone, Debug)]
pub(super) enum TouchMemory {
    /// Every touch counts.
    All,
    /// The last touches count: a ring, its next place, and how many it holds.
    Window { ring: Vec<StreamTouch>, next: usize, held: usize },
    /// All that was is multiplied by this before a touch is added.
    Decay(f64),
}

impl TouchMemory {
    /// The last `touches`.
    pub(super) fn window(touches: usize) -> Result<TouchMemory, PlanError> {
        let wrong = |expected| PlanError::Memory { what: "a window", value: touches as f64, expected };
        if touches == 0 {
            return Err(wrong("at least one touch"));
        }
        let mut ring = Vec::new();
        ring.try_reserve_exact(touches).map_err(|_| wrong("fewer touches, which memory holds"))?;
        ring.resize(touches, StreamTouch::default());
        Ok(TouchMemory::Window { ring, next: 0, held: 0 })
    }

    /// A share that is kept from touch to touch.
    pub(super) fn decay(share: f64) -> Result<TouchMemory, PlanError> {
        if share > 0.0 && share <= 1.0 {
            return Ok(TouchMemory::Decay(share));
        }
        Err(PlanError::Memory { what: "a decay", value: share, expected: "a share above 0 and at most 1" })
    }

    /// Nothing is remembered any longer.
    pub(super) fn clear(&mut self) {
        if let TouchMemory::Window { next, held, .. } = self {
            (*next, *held) = (0, 0);
        }
    }
}
