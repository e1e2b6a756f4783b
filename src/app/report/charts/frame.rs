//! The frame of a panel: box, ticks, numbers, names.

use super::axis::Axis;
use crate::report::drawing::{Anchor, Colour, Drawing, width_of};

/// Left and right, top and bottom of a panel.
pub(in crate::report) type Rect = [[f64; 2]; 2];

/// Sizes of words: axes, and numbers.
pub(in crate::report) const MIDDLE: f64 = 12.0;
pub(in crate::report) const SMALL: f64 = 11.0;
pub(in crate::report) const BLACK: Colour = [0; 3];
pub(in crate::report) const GREY: Colour = [120; 3];
const LIGHT: Colour = [222; 3];
/// Columns that a name takes which runs upwards beside the numbers.
const UPWARD: f64 = 17.0;
/// Least distance between two numbers below an axis.
const GAP: f64 = 5.0;

/// What stands around a panel.
#[derive(Clone, Copy, Debug)]
pub(in crate::report) struct Frame<'a> {
    /// Names of the axes; an empty one is left out.
    pub names: [&'a str; 2],
    /// Most numbers of each.
    pub most: [usize; 2],
    /// Whether the ordinate has numbers.
    pub numbers: bool,
    /// Pixels at the left of the panel.
    pub room: f64,
}

/// Box, ticks, numbers and names of a panel.
pub(in crate::report) fn frame(drawing: &mut Drawing, x: &Axis, y: &Axis, what: &Frame) {
    let (left, right, bottom, top) = (x.from, x.to, y.from, y.to);
    drawing.line(&[[left, top], [right, top], [right, bottom], [left, bottom], [left, top]], 1.0, BLACK);
    drawing.on_page("frame");
    for (value, word) in side_by_side(x, what.most[0]) {
        let at = x.at(value);
        drawing.line(&[[at, bottom], [at, bottom + 4.0]], 1.0, BLACK);
        drawing.on_page("tick");
        drawing.word([at, bottom + 12.0], word, SMALL, Anchor::Middle);
    }
    let mut widest = 0.0_f64;
    for (value, word) in y.ticks(what.most[1]) {
        let at = y.at(value);
        widest = widest.max(width_of(&word, SMALL));
        drawing.line(&[[left - 4.0, at], [left, at]], 1.0, BLACK);
        drawing.on_page("tick");
        if what.numbers {
            drawing.word([left - 6.0, at], word, SMALL, Anchor::End);
        }
    }
    let [across, up] = what.names;
    if !across.is_empty() {
        drawing.word([0.5 * (left + right), bottom + 26.0], across, MIDDLE, Anchor::Middle);
        drawing.on_page("name");
    }
    if up.is_empty() {
        return;
    }
    let room = what.room - 6.0;
    if what.numbers && widest > room - UPWARD && width_of(up, MIDDLE) < room {
        drawing.word([left - 6.0, top - 10.0], up, MIDDLE, Anchor::End);
    } else {
        drawing.upward_word([left - what.room + 9.0, 0.5 * (top + bottom)], up, MIDDLE);
    }
    drawing.on_page("name");
}

/// Light lines across the panel at the numbers: of the ordinate, and of a logarithmic abscissa.
pub(super) fn grid(drawing: &mut Drawing, x: &Axis, y: &Axis, most: [usize; 2]) {
    for (value, _) in y.ticks(most[1]) {
        drawing.line(&[[x.from, y.at(value)], [x.to, y.at(value)]], 0.7, LIGHT);
        drawing.on_page("grid");
    }
    for (value, _) in side_by_side(x, most[0]).into_iter().filter(|_| x.logarithmic) {
        drawing.line(&[[x.at(value), y.from], [x.at(value), y.to]], 0.7, LIGHT);
        drawing.on_page("grid");
    }
}

/// The most ticks up to `most` whose words do not touch.
fn side_by_side(axis: &Axis, most: usize) -> Vec<(f64, String)> {
    let apart = |ticks: &[(f64, String)]| {
        ticks.windows(2).all(|pair| {
            let away = (axis.at(pair[1].0) - axis.at(pair[0].0)).abs();
            away > 0.5 * (width_of(&pair[0].1, SMALL) + width_of(&pair[1].1, SMALL)) + GAP
        })
    };
    (1..=most).rev().map(|most| axis.ticks(most)).find(|ticks| apart(ticks)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_below_an_axis_do_not_touch() {
        let narrow = Axis::linear([-0.021, 0.024], [0.0, 90.0]);
        assert_eq!(narrow.ticks(5).len(), 5);
        let words: Vec<String> = side_by_side(&narrow, 5).into_iter().map(|(_, word)| word).collect();
        assert_eq!(words, ["-0.02", "0.00", "0.02"]);
        assert_eq!(side_by_side(&Axis { to: 400.0, ..narrow }, 5).len(), 5);
    }
}
