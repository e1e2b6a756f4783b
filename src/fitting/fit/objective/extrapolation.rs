//! What all further steps of a loop would add to this one, if each were the same share of the one before it.
//!
//! ```text
//! rho = d_k . d_(k-1) / |d_(k-1)|^2        c + d_k (rho + rho^2 + ...) = c + d_k rho / (1 - rho)
//! ```
//!
//! A. C. Aitken, *Proc. Roy. Soc. Edinburgh* 46 (1926) 289.

use palpate_numeric::linalg::dot;

/// Largest share that is extrapolated, ten steps ahead: beyond, two steps would be trusted too far.
const STEEPEST: f64 = 0.9;

/// The last step of a loop; none before the second, nor after an extrapolation, behind which a step shows no share.
#[derive(Debug, Default)]
pub(super) struct LastStep(Option<Vec<f64>>);

impl LastStep {
    /// Moves `c`, which this step has reached, on by what the steps after it would add.
    pub(super) fn extrapolate(&mut self, c: &mut [f64], step: Vec<f64>) {
        let share = self.0.take().map_or(0.0, |last| dot(&step, &last) / dot(&last, &last)).min(STEEPEST);
        // not a number where nothing moved
        if share > 0.0 {
            c.iter_mut().zip(&step).for_each(|(c, d)| *c += share / (1.0 - share) * d);
        } else {
            self.0 = Some(step);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// c -> 0.75 c + 1 has its fixed point at 4.
    #[test]
    fn a_loop_of_one_share_is_at_its_fixed_point_after_two_steps() {
        let (mut c, mut last) = (vec![0.0, 0.0], LastStep::default());
        for reached in [[0.0, 0.0], [4.0, 4.0]] {
            assert_eq!(c, reached);
            for _ in 0..2 {
                let next: Vec<f64> = c.iter().map(|c| 0.75 * c + 1.0).collect();
                let step: Vec<f64> = next.iter().zip(&c).map(|(a, b)| a - b).collect();
                c = next;
                last.extrapolate(&mut c, step);
            }
        }
        assert_eq!(c, [4.0, 4.0]);
    }

    #[test]
    fn steps_that_grow_are_carried_ten_ahead_and_those_that_turn_back_not_at_all() {
        for (step, reached) in [(2.0, 20.0), (-0.5, -0.5), (0.0, 0.0)] {
            let (mut c, mut last) = (vec![0.0], LastStep::default());
            last.extrapolate(&mut c, vec![1.0]);
            c = vec![step];
            last.extrapolate(&mut c, vec![step]);
            assert!((c[0] - reached).abs() < 1e-12, "{step}: {c:?}");
        }
    }
}
