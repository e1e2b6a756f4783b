//! Numbers and words beside the points of a panel that cover neither each other nor a mark.

use super::frame::{GREY, Rect, SMALL};
use crate::report::drawing::{Anchor, Drawing, Hook, width_of};

/// Half the width and height of a number of two digits, pixels.
const NUMBER: [f64; 2] = [8.0, 6.0];
/// Pixels of a letter on the page, which are the larger ones.
const ON_PAGE: f64 = 12.0;
/// Radius of the largest marks.
const RIM: f64 = 6.5;
/// Distances from the point at which a place is looked for.
const REACHES: [f64; 6] = [14.0, 22.0, 32.0, 44.0, 58.0, 74.0];

/// Where numbers may no longer stand.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    inside: Rect,
    /// Boxes: centre and half sides.
    taken: Vec<([f64; 2], [f64; 2])>,
    /// Those of them that are words.
    words: Vec<([f64; 2], [f64; 2])>,
}

impl Numbers {
    /// Of a panel.
    pub(super) fn new(inside: Rect) -> Numbers {
        Numbers { inside, taken: Vec::new(), words: Vec::new() }
    }

    /// Numbers keep off a mark of this radius.
    pub(super) fn keep_off(&mut self, at: [f64; 2], radius: f64) {
        self.taken.push((at, [radius; 2]));
    }

    /// A number beside its point, where it covers nothing; farther off with a line to it; none where there is no place. Files
    /// alone have numbers: on the page a point says what it is.
    pub(super) fn add(&mut self, drawing: &mut Drawing, point: [f64; 2], text: &str) {
        let _ = self.place(drawing, point, text, NUMBER, true);
    }

    /// A word beside its point in the same manner, on the page as well; where marks leave no place, over the small ones.
    pub(super) fn word(&mut self, drawing: &mut Drawing, point: [f64; 2], text: &str) {
        let half = [0.5 * width_of(text, ON_PAGE) + 3.0, NUMBER[1] + 1.0];
        if !self.place(drawing, point, text, half, false) {
            let marks = std::mem::take(&mut self.taken);
            let before = self.words.len();
            self.taken = self.words.clone();
            self.place(drawing, point, text, half, false);
            let placed = self.taken.split_off(before);
            self.taken = marks;
            self.taken.extend(placed);
        }
    }

    /// Whether there was a place.
    fn place(&mut self, drawing: &mut Drawing, point: [f64; 2], text: &str, half: [f64; 2], file_only: bool) -> bool {
        // words stand best beside a point, numbers above and below it
        let turns = if file_only { [1, 7, 3, 5, 0, 2, 6, 4] } else { [2, 6, 1, 3, 0, 4, 7, 5] };
        for (reach, turn) in REACHES.into_iter().flat_map(|reach| turns.map(|turn| (reach, turn))) {
            let angle = f64::from(turn) * std::f64::consts::FRAC_PI_4;
            let across = reach + half[0] - NUMBER[0];
            let centre = [point[0] + across * angle.sin(), point[1] - reach * angle.cos()];
            if !self.is_free(centre, half) {
                continue;
            }
            if reach > REACHES[0] {
                self.leader(drawing, point, centre, half);
                drawing.hook(Hook { class: "grid".into(), file_only, ..Hook::default() });
            }
            drawing.word(centre, text, SMALL, Anchor::Middle);
            drawing.hook(Hook { file_only, ..Hook::default() });
            self.taken.push((centre, half));
            self.words.push((centre, half));
            return true;
        }
        false
    }

    /// A line from the rim of a mark to the near edge of its words.
    fn leader(&self, drawing: &mut Drawing, point: [f64; 2], centre: [f64; 2], half: [f64; 2]) {
        let near = [0, 1].map(|k| point[k].clamp(centre[k] - half[k] + 2.0, centre[k] + half[k] - 2.0));
        let away = (near[0] - point[0]).hypot(near[1] - point[1]);
        let rim = [0, 1].map(|k| point[k] + (RIM / away).min(1.0) * (near[k] - point[k]));
        drawing.line(&[rim, near], 0.8, GREY);
    }

    fn is_free(&self, centre: [f64; 2], own: [f64; 2]) -> bool {
        let inside = (0..2).all(|k| {
            let [lo, hi] = [self.inside[k][0] + own[k], self.inside[k][1] - own[k]];
            (lo..=hi).contains(&centre[k])
        });
        let apart = |other: [f64; 2], half: [f64; 2]| (0..2).any(|k| (centre[k] - other[k]).abs() >= own[k] + half[k]);
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

    #[test]
    fn words_stand_over_small_marks_where_these_leave_no_place_and_never_over_each_other() {
        let mut numbers = Numbers::new([[0.0, 300.0], [0.0, 200.0]]);
        let mut drawing = Drawing::new(300.0, 200.0);
        let crowd = (0..60).flat_map(|i| (0..40).map(move |j| [5.0 * f64::from(i), 5.0 * f64::from(j)]));
        crowd.for_each(|at| numbers.keep_off(at, 1.5));
        for _ in 0..2 {
            numbers.word(&mut drawing, [150.0, 100.0], "degree 2, equal");
        }
        let [(a, half), (b, _)] = numbers.words[..] else { panic!("{:?}", numbers.words) };
        assert!((a[0] - b[0]).abs() >= 2.0 * half[0] || (a[1] - b[1]).abs() >= 2.0 * half[1]);
        // the marks are still there
        assert_eq!(numbers.taken.len(), 60 * 40 + 2);
    }
}
