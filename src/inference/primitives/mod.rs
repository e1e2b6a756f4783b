//! The exact primitives placed in space, where least squares begins with each kind, and how it moves them: what recognition and parts share.

pub(crate) mod descent;
pub(crate) mod normal_equations;
pub(crate) mod placed;
pub(crate) mod starts;
