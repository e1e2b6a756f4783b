//! A chart's place on the page, and numbers as the page has them.

use crate::report::charts::Rect;
use crate::report::drawing::Drawing;

use crate::report::table::significant;

/// Pixels of the viewing box; a phone shows it a little smaller, a desktop a little larger.
const SIZE: [f64; 2] = [440.0, 270.0];
/// The panel in it.
const PANEL: Rect = [[67.0, 428.0], [12.0, 232.0]];

/// A chart as SVG inside the page; `label` says in a sentence what it shows.
pub(super) fn chart(label: &str, draw: impl FnOnce(&mut Drawing, Rect)) -> String {
    let mut drawing = Drawing::new(SIZE[0], SIZE[1]);
    draw(&mut drawing, PANEL);
    drawing.inline("chart", label, "")
}

/// A number in words for pointing at.
pub(super) fn shown(value: f64) -> String {
    significant(value, 4)
}

/// A number with so many digits that two significant ones of `width` show.
pub(super) fn precise(value: f64, width: f64) -> String {
    let size = value.abs().max(width.abs());
    if width == 0.0 || !width.is_finite() || !(1e-4..1e6).contains(&size) {
        return shown(value);
    }
    // an interval far narrower than anything that is measured is one number
    let width = width.abs().max(1e-6 * value.abs());
    let decimals = (1.0 - width.log10().floor()).clamp(0.0, 12.0) as usize;
    let least = if value == 0.0 { 0 } else { (2.0 - value.abs().log10().floor()).clamp(0.0, 12.0) as usize };
    let words = format!("{value:.*}", decimals.max(least.min(4)));
    if words.trim_start_matches(['-', '0', '.']).is_empty() { "0".into() } else { words }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_of_a_narrow_interval_differ() {
        assert_eq!([precise(0.499_98, 4e-5), precise(0.500_02, 4e-5)], ["0.499980", "0.500020"]);
        assert_eq!(precise(6.599_999_999_84, 1e-9), "6.6000000");
        assert_eq!([precise(-0.4, 0.1), precise(0.0, 0.1), precise(96.84, 3.0)], ["-0.400", "0", "96.8"]);
    }
}
