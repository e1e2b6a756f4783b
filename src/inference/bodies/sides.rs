//! How probable it is that given normals point to the sides of things that they do.
//!
//! ```text
//! ln p = ln(2^-K B(1 + k, f + n - k) / B(1, f) + 2^-n) - ln 2        of n normals k are against most others of their thing, K things
//! ```
//!
//! f is [`Tuning::false_prior`].
//!
//! A sensor's normals point to the free side but for a few, whichever side of each thing that is; or, computed from the places alone, to
//! either. Normals on two concentric walls face each other, and those about one bar between them would contradict it by half.

use std::f64::consts::LN_2;

use statrs::function::beta::ln_beta;

use super::tuning::Tuning;
use palpate_numeric::statistics::log_mean_exp;

/// Log probability of normals of one sensor on some things, by their numbers on either side of each.
pub(super) fn log_sides(things: &[[usize; 2]], tuning: &Tuning) -> f64 {
    let count = things.iter().flatten().sum::<usize>() as f64;
    let against = things.iter().map(|[with, against]| with.min(against)).sum::<usize>() as f64;
    let f = tuning.false_prior;
    // where as many point to either side of a thing both readings are as probable
    let even = things.iter().filter(|[with, against]| with == against).count() as f64;
    let agreeing = ln_beta(1.0 + against, f + count - against) - ln_beta(1.0, f) - (things.len() as f64 - even) * LN_2;
    let of_either = -count * LN_2;
    log_mean_exp(agreeing, of_either)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_told_where_there_are_no_normals() {
        assert!(log_sides(&[[0, 0]], &Tuning::default()).abs() < 1e-12);
    }

    #[test]
    fn things_whose_normals_agree_are_more_probable_than_one_that_they_contradict() {
        let tuning = Tuning::default();
        let (one, two) = (log_sides(&[[20, 20]], &tuning), log_sides(&[[20, 0], [0, 20]], &tuning));
        // the contradiction is no worse than normals that point anywhere
        assert!(two > one + 20.0 && one > -40.5 * LN_2 - LN_2, "{one} {two}");
    }

    #[test]
    fn normals_of_either_side_tell_nothing_of_a_division() {
        let tuning = Tuning::default();
        let (one, two) = (log_sides(&[[22, 18]], &tuning), log_sides(&[[12, 8], [10, 10]], &tuning));
        assert!((one - two).abs() < 0.5, "{one} {two}");
    }
}
