//! Random problems and their judge.
//!
//! ```text
//! (seed, number) -> problem -> the fit under test
//!                           -> the written problem in 32 digits, by a route of its own       found digits >= promised digits?
//! ```
//!
//! A problem is a function of the seed and its number alone, so a number is all that has to be kept of an exception.

mod basis;
pub(crate) mod draw;
mod gaps;
pub(crate) mod judge;
mod least_squares;
mod normals;
pub(crate) mod oracle;
mod touches;
