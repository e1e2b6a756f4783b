//! How many decimal digits an answer has right: `-log10(error)`, between 0 and the 15.95 that a double holds.

/// `-log10(2^-53)`: an error below half a unit in the last place counts as this many digits.
pub const DIGITS_OF_A_DOUBLE: f64 = 15.954589770191003;

/// Digits of one error that is relative or absolute already. NaN has none.
pub fn digits_absolute(error: f64) -> f64 {
    if error.is_nan() { 0.0 } else { (-error.log10()).clamp(0.0, DIGITS_OF_A_DOUBLE) }
}

/// Digits of a vector as a whole: `max_i |found_i - reference_i| / max_i |reference_i|`. Lengths that differ: none.
pub fn digits_of(found: &[f64], reference: &[f64]) -> f64 {
    if found.len() != reference.len() {
        return 0.0;
    }
    let size = reference.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let mut worst = 0.0_f64;
    for (f, r) in found.iter().zip(reference) {
        let error = (f - r).abs();
        if error.is_nan() {
            return 0.0;
        }
        worst = worst.max(error);
    }
    if worst == 0.0 { DIGITS_OF_A_DOUBLE } else { digits_absolute(worst / size) }
}
