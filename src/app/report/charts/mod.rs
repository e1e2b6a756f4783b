//! The charts: each figure is described once, and drawn into a [`Drawing`](super::drawing::Drawing) that becomes a file or a part of the
//! report page.
//!
//! ```text
//! study, exploration, sweep, frontier  ->  Chart: axes, lines, dots, bars, whiskers  ->  Drawing  ->  svg, png, pdf; inline SVG
//! ```
//!
//! The page's classes and words are hooks beside the shapes, which files leave out: `page/inline.rs`.
//!
//! Charts stay drawn by hand: plotters knows neither the page's hooks nor PDF, and its style had to be undone line by line.

mod axis;
mod chart;
mod explore;
mod frame;
mod frontier;
mod histogram;
mod numbers;
mod shares;
mod study;
mod sweep;

pub(super) use axis::Axis;
pub(super) use chart::{Style, legend};
pub(super) use explore::{Falling, touched};
pub(super) use frame::Rect;
pub(super) use frame::{BLACK, Frame, GREY, MIDDLE, SMALL, frame};
pub(super) use frontier::{FrontierFigure, INSTRUCTIONS, LINE, TIME, number, time};
pub(crate) use frontier::{FrontierKind, KINDS};
pub(super) use histogram::Histogram;
pub(super) use shares::draw_shares;
pub(super) use study::{CUT, Scatter, class_shares, effect_shares};
pub(super) use sweep::{SWEPT, series, sweep_panel};
