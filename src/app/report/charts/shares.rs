//! Shares as bars: a row of a name, a share from 0 to 1 and words behind it. The page has them as a table.

use super::chart::Style;
use super::frame::SMALL;
use crate::report::drawing::{Anchor, Drawing, width_of};

/// Name, share from 0 to 1, words.
pub(in crate::report) type Share = (String, f64, String);

/// Pixels of a row.
const ROW: f64 = 18.0;

/// Draws the rows below a caption; how far down they reach.
pub(in crate::report) fn draw_shares(
    drawing: &mut Drawing,
    [left, right]: [f64; 2],
    top: f64,
    caption: &str,
    rows: &[Share],
) -> f64 {
    drawing.word([left, top], caption, 13.0, Anchor::Start);
    let widest = |of: fn(&Share) -> &str| rows.iter().map(|row| width_of(of(row), SMALL)).fold(0.0, f64::max);
    let start = left + widest(|row| &row.0) + 6.0;
    let length = (right - widest(|row| &row.2) - 6.0 - start).max(20.0);
    for (k, (name, share, words)) in rows.iter().enumerate() {
        let y = top + 24.0 + ROW * k as f64;
        let end = start + length * share.clamp(0.0, 1.0);
        let blue = Style::MAIN.colour;
        drawing.word([start - 6.0, y], name.as_str(), SMALL, Anchor::End);
        drawing.area(&[[start, y - 5.0], [end, y - 5.0], [end, y + 5.0], [start, y + 5.0]], blue, blue);
        drawing.word([end + 6.0, y], words.as_str(), SMALL, Anchor::Start);
    }
    top + 24.0 + ROW * rows.len() as f64
}
