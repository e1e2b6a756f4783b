//! Numbers beside the points of a panel that cover neither each other nor a mark.

use super::frame::Rect;
use crate::report::drawing::{Anchor, Drawing, Hook};

/// Half the width and height of a number of two digits, pixels.
const NUMBER: [f64; 2] = [8.0, 6.0];
/// Distances from the point at which a place is looked for.
const REACHES: [f64; 6] = [14.0, 22.0, 32.0, 44.0, 58.0, 74.0];

/// Where numbers may no longer stand.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    inside: Rect,
    /// Boxes: centre and half sides.
    taken: Vec<([f64; 2], [f64; 2])>,
}

impl Numbers {
    /// Of a panel.
    pub(super) fn new(inside: Rect) -> Numbers {
        Numbers { inside, taken: Vec::new() }
    }

    /// Numbers keep off a mark of this radius.
    pub(super) fn keep_off(&mut self, at: [f64; 2], radius: f64) {
        self.taken.push((at, [radius; 2]));
    }

    /// A number beside its point, where it covers nothing; farther off with a line to it; none where there is no place. Files
    /// alone have numbers: on the page a point says what it is.
    pub(super) fn add(&mut self, drawing: &mut Drawing, point: [f64; 2], text: &str) {
        for reach in REACHES {
            for turn in [1, 7, 3, 5, 0, 2, 6, 4] {
                let angle = f64::from(turn) * std::f64::consts::FRAC_PI_4;
                let centre = [point[0] + reach * angle.sin(), point[1] - reach * angle.cos()];
                if !self.is_free(centre) {
                    continue;
                }
                let hook = || Hook { file_only: true, ..Hook::default() };
                if reach > REACHES[0] {
                    let part = |from: f64, to: f64| from + (reach - 7.0) / reach * (to - from);
                    drawing.line(&[point, [part(point[0], centre[0]), part(point[1], centre[1])]], 0.8, [0; 3]);
                    drawing.hook(hook());
                }
                drawing.word(centre, text, 11.0, Anchor::Middle);
                drawing.hook(hook());
                self.taken.push((centre, NUMBER));
                return;
            }
        }
    }

    fn is_free(&self, centre: [f64; 2]) -> bool {
        let inside = (0..2).all(|k| {
            let [lo, hi] = [self.inside[k][0] + NUMBER[k], self.inside[k][1] - NUMBER[k]];
            (lo..=hi).contains(&centre[k])
        });
        let apart =
            |other: [f64; 2], half: [f64; 2]| (0..2).any(|k| (centre[k] - other[k]).abs() >= NUMBER[k] + half[k]);
        inside && self.taken.iter().all(|(other, half)| apart(*other, *half))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_do_not_collide() {
        let mut numbers = Numbers::new([[0.0, 300.0], [0.0, 300.0]]);
        let mut drawing = Drawing::new(300.0, 300.0);
        let points: Vec<[f64; 2]> = (0..20).map(|k| [100.0 + 0.4 * f64::from(k), 200.0]).collect();
        points.iter().for_each(|at| numbers.keep_off(*at, 6.0));
        let marks = numbers.taken.len();
        points.iter().for_each(|at| numbers.add(&mut drawing, *at, "8"));
        let numbers = &numbers.taken[marks..];
        assert!(numbers.len() > 12);
        for (k, (a, _)) in numbers.iter().enumerate() {
            for (b, _) in &numbers[..k] {
                assert!((a[0] - b[0]).abs() >= 2.0 * NUMBER[0] || (a[1] - b[1]).abs() >= 2.0 * NUMBER[1]);
            }
        }
    }
}
