//! A panel with two logarithmic axes: decades, frame, error bars, the stairs of a frontier, numbers that do not collide.

use super::drawing::{Anchor, Colour, Drawing};

const LIGHT: Colour = [222, 222, 222];
const BLACK: Colour = [0; 3];
/// Most words along an axis.
const MOST_WORDS: i32 = 8;
/// Half the width and height of a number of two digits, pixels.
const NUMBER: [f64; 2] = [8.0, 6.0];

/// A logarithmic axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axis {
    /// Decimal logarithms of the ends.
    lo: f64,
    hi: f64,
}

impl Axis {
    /// Over these values, with some room; `None` without any above zero.
    pub(super) fn over(values: impl Iterator<Item = f64>) -> Option<Axis> {
        let logarithms = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let (lo, hi) = logarithms.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        let room = 0.06 * (hi - lo).max(0.5);
        (lo <= hi).then_some(Axis { lo: lo - room, hi: hi + room })
    }

    fn share(&self, value: f64) -> f64 {
        (value.max(f64::MIN_POSITIVE).log10() - self.lo) / (self.hi - self.lo)
    }

    /// Values with words: decades; where there are few, 1, 2 and 5 of each; where these are few too, all whole ones.
    fn ticks(&self) -> Vec<f64> {
        let (first, last) = (self.lo.floor() as i32, self.hi.ceil() as i32);
        let step = 1 + (last - first) / MOST_WORDS;
        let within = |v: &f64| (self.lo..=self.hi).contains(&v.log10());
        let decades = (first..=last).filter(|k| k % step == 0).map(|k| 10.0_f64.powi(k));
        let coarse: Vec<f64> = decades.filter(within).collect();
        if coarse.len() > 2 {
            return coarse;
        }
        let of = |digits: &[f64]| -> Vec<f64> {
            let all = (first..=last).flat_map(|k| digits.iter().map(move |m| m * 10.0_f64.powi(k)));
            all.filter(within).collect()
        };
        let fine = of(&[1.0, 2.0, 5.0]);
        if fine.len() > 2 { fine } else { of(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]) }
    }
}

/// A panel with what is drawn in it and where numbers may no longer stand.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    corner: [f64; 2],
    size: [f64; 2],
    axes: [Axis; 2],
    /// Boxes: centre and half sides.
    taken: Vec<([f64; 2], [f64; 2])>,
}

impl Panel {
    /// A panel whose upper left corner is there.
    pub(super) fn new(corner: [f64; 2], size: [f64; 2], x: Axis, y: Axis) -> Panel {
        Panel { corner, size, axes: [x, y], taken: Vec::new() }
    }

    /// Pixels of a point.
    pub(super) fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.corner[0] + self.size[0] * self.axes[0].share(x),
            self.corner[1] + self.size[1] * (1.0 - self.axes[1].share(y)),
        ]
    }

    /// Frame, light lines at the ticks, words.
    pub(super) fn frame(&self, drawing: &mut Drawing, x_name: &str, y_name: &str) {
        let [left, top] = self.corner;
        let [right, bottom] = [left + self.size[0], top + self.size[1]];
        for value in self.axes[0].ticks() {
            let x = left + self.size[0] * self.axes[0].share(value);
            drawing.line(&[[x, top], [x, bottom]], 0.7, LIGHT);
            drawing.word([x, bottom + 11.0], word(value), 10.0, Anchor::Middle);
        }
        for value in self.axes[1].ticks() {
            let y = top + self.size[1] * (1.0 - self.axes[1].share(value));
            drawing.line(&[[left, y], [right, y]], 0.7, LIGHT);
            drawing.word([left - 6.0, y], word(value), 10.0, Anchor::End);
        }
        drawing.line(&[[left, top], [right, top], [right, bottom], [left, bottom], [left, top]], 1.0, BLACK);
        drawing.word([0.5 * (left + right), bottom + 28.0], x_name, 12.0, Anchor::Middle);
        drawing.upward_word([left - 58.0, 0.5 * (top + bottom)], y_name, 12.0);
    }

    /// Error bars both ways.
    pub(super) fn bars(&self, drawing: &mut Drawing, at: [f64; 2], x: [f64; 2], y: [f64; 2], colour: Colour) {
        drawing.line(&[self.place([x[0], at[1]]), self.place([x[1], at[1]])], 1.4, colour);
        drawing.line(&[self.place([at[0], y[0]]), self.place([at[0], y[1]])], 1.4, colour);
    }

    /// What the cheapest so far reaches: level until a better one, then down. Points from cheap to dear.
    pub(super) fn stairs(&self, drawing: &mut Drawing, points: &[[f64; 2]], colour: Colour) {
        let mut line: Vec<[f64; 2]> = Vec::new();
        let mut best = f64::INFINITY;
        for point in points.iter().filter(|point| point[1].is_finite()) {
            if point[1] < best {
                line.extend(line.last().map(|last| [self.place(*point)[0], last[1]]));
                line.push(self.place(*point));
                best = point[1];
            }
        }
        drawing.line(&line, 1.2, colour);
    }

    /// Numbers keep off a marker of this radius.
    pub(super) fn taken(&mut self, at: [f64; 2], radius: f64) {
        self.taken.push((self.place(at), [radius; 2]));
    }

    /// A number beside its point, where it covers nothing; farther off with a line to it.
    pub(super) fn number(&mut self, drawing: &mut Drawing, at: [f64; 2], text: &str) {
        let point = self.place(at);
        for reach in [14.0, 22.0, 32.0, 44.0, 58.0, 74.0] {
            for turn in [1, 7, 3, 5, 0, 2, 6, 4] {
                let angle = f64::from(turn) * std::f64::consts::FRAC_PI_4;
                let centre = [point[0] + reach * angle.sin(), point[1] - reach * angle.cos()];
                if self.is_free(centre) {
                    if reach > 14.0 {
                        let part = |from: f64, to: f64| from + (reach - 7.0) / reach * (to - from);
                        drawing.line(&[point, [part(point[0], centre[0]), part(point[1], centre[1])]], 0.8, BLACK);
                    }
                    drawing.word(centre, text, 11.0, Anchor::Middle);
                    self.taken.push((centre, NUMBER));
                    return;
                }
            }
        }
    }

    fn is_free(&self, centre: [f64; 2]) -> bool {
        let inside = (0..2).all(|k| {
            let [lo, hi] = [self.corner[k] + NUMBER[k], self.corner[k] + self.size[k] - NUMBER[k]];
            (lo..=hi).contains(&centre[k])
        });
        inside
            && self
                .taken
                .iter()
                .all(|(other, half)| (0..2).any(|k| (centre[k] - other[k]).abs() >= NUMBER[k] + half[k]))
    }
}

/// `1e-5`, `20`, `0.02`.
fn word(value: f64) -> String {
    if (0.01..1e4).contains(&value) {
        return format!("{}", (value * 1e6).round() / 1e6);
    }
    format!("{value:.0e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_do_not_collide() {
        let axis = Axis::over([1e-6, 1e-3].into_iter()).unwrap();
        let mut panel = Panel::new([0.0, 0.0], [300.0, 300.0], axis, axis);
        let mut drawing = Drawing::new(300.0, 300.0);
        let points: Vec<[f64; 2]> = (0..20).map(|k| [1e-5 * (1.0 + 0.01 * f64::from(k)), 1e-5]).collect();
        points.iter().for_each(|at| panel.taken(*at, 6.0));
        let markers = panel.taken.len();
        points.iter().for_each(|at| panel.number(&mut drawing, *at, "8"));
        let numbers = &panel.taken[markers..];
        assert!(numbers.len() > 12);
        for (k, (a, _)) in numbers.iter().enumerate() {
            for (b, _) in &numbers[..k] {
                assert!((a[0] - b[0]).abs() >= 2.0 * NUMBER[0] || (a[1] - b[1]).abs() >= 2.0 * NUMBER[1]);
            }
        }
    }

    #[test]
    fn axes_have_words_over_one_decade_and_over_twenty() {
        let ticks = |values: [f64; 2]| Axis::over(values.into_iter()).unwrap().ticks();
        assert!((3..=9).contains(&ticks([1e-5, 4e-5]).len()));
        assert!((3..=9).contains(&ticks([1e-17, 1e3]).len()));
        assert!(Axis::over([0.0].into_iter()).is_none());
        assert_eq!((word(1e-5), word(20.0), word(0.02)), ("1e-5".into(), "20".into(), "0.02".into()));
    }
}
