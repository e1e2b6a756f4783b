//! `z = 0`; tilt it by the pose. `k1 = k2 = 0`, S undefined, R = 0.

use super::local::Local;
use super::quadric::Quadric;
use crate::scene::vector::UP;

pub(crate) const QUADRIC: Quadric = Quadric { alpha: 0.0, beta: 0.0, gamma: 0.0 };

pub(crate) fn local() -> Local {
    Local::known(UP, 0.0, 0.0)
}
