//! Tests of the repository itself: which rooms import which, and that documents say what the code does.

mod floors;
mod names;
mod public_names;
mod readme;
