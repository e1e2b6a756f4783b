//! Where the descents to the nearest member of a family start.
//!
//! ```text
//! sizes, tilt, direction, place, side: uniform within the ranges of the kind        height in the middle: that of the true surface
//! ```

use palpate_numeric::draws::EffectDraws;

use super::kinds::Kind;
use super::member::Member;
use super::view::View;

impl Kind {
    /// A member drawn at random that has the true surface's height in the middle; `None` where it does not reach there.
    pub(crate) fn start(self, draws: &EffectDraws, start: u64, view: &View) -> Option<Member> {
        let mut numbers = [0.0; 32];
        draws.uniforms(start, 0, 32, &mut numbers);
        let between = |k: usize, [lo, hi]: [f64; 2]| lo + (hi - lo) * numbers[k];
        let (ranges, tilt) = self.starts();
        let sizes: Vec<f64> = ranges.iter().enumerate().map(|(k, range)| between(k, *range)).collect();
        let tilt = tilt * numbers[20];
        let (sin, cos) = between(21, [0.0, std::f64::consts::TAU]).sin_cos();
        let reach = if self == Kind::Torus { sizes[0] + 2.0 * sizes[1] } else { 4.0 };
        let offset = if self.is_sum() { [0.0; 2] } else { [22, 23].map(|k| between(k, [-reach, reach])) };
        let spin = if self.is_sum() { 0.0 } else { between(24, [0.0, std::f64::consts::TAU]) };
        let mut member = Member::upright(self, sizes).moved([0.0, 0.0, spin], [0.0; 3]);
        member.concave = numbers[25] < 0.5;
        let member = member.moved([tilt * cos, tilt * sin, 0.0], [offset[0], offset[1], 0.0]);
        let height = member.seen([0.0; 2], view.middle)?.z;
        Some(member.moved([0.0; 3], [0.0, 0.0, view.middle - height]))
    }
}
