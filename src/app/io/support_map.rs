//! Where contacts support a saved height field, as a small picture of letters: `#` supported, `.` not.
//!
//! ```text
//! letter j of line i stands at (x_i, y_j), evenly spaced over the domain with both ends; a point asks the nearest letter
//! ```

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Points each way: the outline is known to 1/64 of a side, in a thousand letters.
pub(crate) const SUPPORT_POINTS: usize = 33;

/// Most letters that are read.
const MOST_LETTERS: usize = 1 << 20;

/// The picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct SupportMap(Vec<String>);

impl SupportMap {
    /// Asks `holds` at every point of the domain; `None` where all of it is supported, which needs no picture.
    pub(crate) fn of(domain: [[f64; 2]; 2], holds: impl Fn(f64, f64) -> bool) -> Option<SupportMap> {
        let [x, y] = domain.map(|[lo, hi]| palpate_numeric::bspline::linspace(lo, hi, SUPPORT_POINTS));
        let line = |x: &f64| y.iter().map(|y| if holds(*x, *y) { '#' } else { '.' }).collect::<String>();
        let lines: Vec<String> = x.iter().map(line).collect();
        lines.iter().any(|line| line.contains('.')).then_some(SupportMap(lines))
    }

    /// Whether the lines make a picture.
    ///
    /// # Errors
    /// What is wrong.
    pub(crate) fn check(&self) -> Result<(), String> {
        let width = self.0.first().map_or(0, String::len);
        let letters = |line: &String| line.len() == width && line.bytes().all(|b| b == b'#' || b == b'.');
        if width < 2 || self.0.len() < 2 || self.0.len() > MOST_LETTERS / width || !self.0.iter().all(letters) {
            return Err("surface.support_map must be lines of # and . of one length".into());
        }
        Ok(())
    }

    /// What the letter nearest to a point of the domain says.
    pub(crate) fn holds(&self, domain: [[f64; 2]; 2], place: [f64; 2]) -> bool {
        let nearest = |k: usize, count: usize| {
            let [lo, hi] = domain[k];
            // beyond the ends, and where a number is none, the nearest end
            (((place[k] - lo) / (hi - lo)).clamp(0.0, 1.0) * (count - 1) as f64).round() as usize
        };
        let line = self.0.get(nearest(0, self.0.len()));
        line.is_some_and(|line| line.as_bytes().get(nearest(1, line.len())) == Some(&b'#'))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_keeps_its_outline() {
        let domain = [[-1.0, 1.0], [0.0, 4.0]];
        let disc = |x: f64, y: f64| x.hypot(0.5 * (y - 2.0)) <= 1.0;
        let map = SupportMap::of(domain, disc).unwrap();
        map.check().unwrap();
        assert!(map.holds(domain, [0.0, 2.0]) && map.holds(domain, [0.7, 2.0]) && !map.holds(domain, [0.9, 0.3]));
        assert_eq!(SupportMap::of(domain, |_, _| true), None);
        assert!(SupportMap(vec!["#.".into(), "#".into()]).check().is_err());
    }
}
