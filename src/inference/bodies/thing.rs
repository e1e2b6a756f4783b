//! One of several things among contacts, and what contacts of one thing may be instead.

use crate::primitives::placed::Primitive;

/// A primitive and how many contacts are its own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Thing {
    pub(crate) primitive: Primitive,
    pub(crate) contacts: usize,
    /// Sd of their distances.
    pub(crate) scatter: f64,
}

/// Several things that contacts may be.
#[derive(Clone, Debug)]
pub(crate) struct PossibleThings {
    pub(crate) things: Vec<Thing>,
    /// Of these against one thing.
    pub(crate) probability: f64,
}
