//! Colour scales, and the words of a picture.

use crate::report::charts::{Axis, BLACK, SMALL};
use crate::report::colour::{DIVERGING, along};
use crate::report::drawing::{Anchor, Colour, Drawing, width_of};
use crate::report::png::Raster;
use palpate_geometry::curvature::ShapeClass;

/// Width of every picture: one column of a paper (85 mm), so that a pixel is 0.48 points.
pub(super) const WIDTH: f64 = 500.0;
/// A screen has room for more.
pub(super) const ON_SCREEN: f64 = 1.6;
/// Size of titles; at 85 mm 6.3 points, where axes have 5.8 and the foot 5.3.
pub(in crate::report) const LARGE: f64 = 13.0;
/// Width of a colour scale's bar.
const BAR: f64 = 10.0;

/// An empty picture of this height.
pub(in crate::report) fn picture(height: f64) -> Drawing {
    let mut drawing = Drawing::new(WIDTH, height.ceil());
    drawing.on_screen = ON_SCREEN;
    drawing
}

/// A name with its unit.
pub(super) fn with_unit(name: &str, unit: Option<&str>, power: i32) -> String {
    match (unit, power) {
        (Some(unit), 1) => format!("{name}, {unit}"),
        (Some(unit), _) => format!("{name}, 1/{unit}"),
        (None, 1) => name.to_string(),
        (None, _) => format!("{name}, 1/length"),
    }
}

/// A bar of colours from the least (below) to the largest.
fn bar(drawing: &mut Drawing, [x, y]: [f64; 2], height: f64, colour: &dyn Fn(f64) -> Colour) {
    const STEPS: usize = 128;
    let rgb = (0..STEPS).flat_map(|k| colour(1.0 - (k as f64 + 0.5) / STEPS as f64)).collect();
    drawing.image([x, y], [BAR, height], Raster { width: 1, height: STEPS, rgb });
    drawing.line(&[[x, y], [x + BAR, y], [x + BAR, y + height], [x, y + height], [x, y]], 0.6, BLACK);
}

/// The scale of S from cup to cap, with the name of every class at its middle.
pub(in crate::report) fn shape_bar(drawing: &mut Drawing, [x, y]: [f64; 2], height: f64) {
    bar(drawing, [x, y], height, &|t| along(&DIVERGING, t));
    for (k, class) in ShapeClass::CURVED.into_iter().enumerate() {
        let at = y + height * (1.0 - k as f64 / 8.0);
        drawing.line(&[[x + BAR, at], [x + BAR + 3.0, at]], 0.8, BLACK);
        let number = match k {
            0 => " -1",
            2 => " -0.5",
            4 => " 0",
            6 => " 0.5",
            8 => " 1",
            _ => "",
        };
        drawing.word([x + BAR + 6.0, at], format!("{}{number}", class.name()), SMALL, Anchor::Start);
    }
}

/// A scale with numbers; what its ticks are.
pub(in crate::report) fn number_bar(
    drawing: &mut Drawing,
    [x, y]: [f64; 2],
    height: f64,
    [lo, hi]: [f64; 2],
    stops: &[Colour],
) -> Vec<f64> {
    bar(drawing, [x, y], height, &|t| along(stops, t));
    let axis = Axis::linear([lo, hi], [y + height, y]);
    let mut ticks = axis.ticks(6);
    // words that would be cut at the picture's edge are written short
    let room = drawing.size[0] - (x + BAR + 6.0);
    if ticks.iter().any(|(_, word)| width_of(word, SMALL) > room) {
        ticks.iter_mut().for_each(|(value, word)| *word = powered(*value));
    }
    for (value, word) in &ticks {
        drawing.line(&[[x + BAR, axis.at(*value)], [x + BAR + 3.0, axis.at(*value)]], 0.8, BLACK);
        drawing.word([x + BAR + 6.0, axis.at(*value)], word.as_str(), SMALL, Anchor::Start);
    }
    ticks.into_iter().map(|(value, _)| value).collect()
}

/// A round number as a power of ten, `1.5e-5`, and 0 as that.
fn powered(value: f64) -> String {
    if value == 0.0 { "0".into() } else { format!("{value:.1e}").replacen(".0e", "e", 1) }
}

/// Text that fits into so many letters: its middle is left out where it is longer.
pub(in crate::report) fn fitting(text: &str, letters: usize) -> String {
    let all: Vec<char> = text.chars().collect();
    if all.len() <= letters {
        return text.to_string();
    }
    let tail = letters * 2 / 3;
    let head: String = all[..letters - tail - 3].iter().collect();
    let tail: String = all[all.len() - tail..].iter().collect();
    format!("{head}...{tail}")
}

/// Letters of a line at the foot.
const FOOT_LETTERS: usize = 82;

/// The picture's last lines: remarks, as many in a line as fit. The picture grows by them.
pub(in crate::report) fn foot(drawing: &mut Drawing, remarks: &[String]) {
    let mut lines: Vec<String> = Vec::new();
    for remark in remarks {
        match lines.last_mut().filter(|line| line.chars().count() + remark.chars().count() + 2 <= FOOT_LETTERS) {
            Some(line) => *line = format!("{line}; {remark}"),
            None => lines.extend(wrapped(remark)),
        }
    }
    for line in lines {
        drawing.word([8.0, drawing.size[1] + 4.0], line, SMALL, Anchor::Start);
        drawing.size[1] += 15.0;
    }
}

/// A remark in lines of at most [`FOOT_LETTERS`].
fn wrapped(remark: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in remark.split_whitespace() {
        match lines.last_mut().filter(|line| line.chars().count() + 1 + word.chars().count() <= FOOT_LETTERS) {
            Some(line) => *line = format!("{line} {word}"),
            None => lines.push(fitting(word, FOOT_LETTERS)),
        }
    }
    lines
}

/// A number without the zeros behind its last digit.
pub(in crate::report) fn short(value: f64) -> String {
    let text = crate::report::table::significant(value, 3);
    match text.contains('.') && !text.contains('e') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}

/// Which of `all` are drawn when at most `most` can be, and in words how many of them.
///
/// Every so many-th is drawn, by a prime: contacts come in rows, and a step that divides a row would draw one column.
pub(super) fn thinned(all: usize, most: usize) -> (usize, String) {
    let least = all.div_ceil(most.max(1)).max(1);
    let is_prime = |n: &usize| (2..).take_while(|d| d * d <= *n).all(|d| !n.is_multiple_of(d));
    let step = if least == 1 { 1 } else { (least..).find(is_prime).unwrap_or(least) };
    let words = match (all, step) {
        (_, 1) => format!("all {all} contacts"),
        (all, step) => format!("{} of {all} contacts (every {step}th)", all.div_ceil(step)),
    };
    (step, words.replace("every 2th", "every second").replace("every 3th", "every third"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_beside_a_scale_end_before_the_edge() {
        for most in [4.3e-18, 4.8e-5, 0.0021, 0.35, 12.0, 250_000.0] {
            let mut drawing = picture(200.0);
            number_bar(&mut drawing, [440.0, 20.0], 150.0, [0.0, most], &[[0; 3], [255; 3]]);
            for shape in &drawing.shapes {
                if let crate::report::drawing::Shape::Word { at, text, size, .. } = shape {
                    assert!(at[0] + width_of(text, *size) <= WIDTH, "{most}: {text}");
                }
            }
        }
        assert_eq!([0.0, 1.5e-5, 2e-18].map(powered), ["0", "1.5e-5", "2e-18"]);
    }

    #[test]
    fn long_remarks_at_the_foot_go_on_in_the_next_line() {
        let mut drawing = picture(100.0);
        foot(&mut drawing, &["short".into(), "many words of a remark ".repeat(6), "last".into()]);
        let words: Vec<&str> = drawing
            .shapes
            .iter()
            .filter_map(|shape| match shape {
                crate::report::drawing::Shape::Word { text, .. } => Some(text.as_str()),
                _ => None,
            })
            .collect();
        assert!(words.len() == 3 && words.iter().all(|line| !line.contains("...") && line.len() <= 82), "{words:?}");
    }

    #[test]
    fn thinning_is_said_and_steps_are_prime() {
        assert_eq!(thinned(36, 3000), (1, "all 36 contacts".into()));
        assert_eq!(thinned(10_000, 3000), (5, "2000 of 10000 contacts (every 5th)".into()));
        assert_eq!(fitting("abcdefghijklmnop", 9), "...klmnop");
    }
}
