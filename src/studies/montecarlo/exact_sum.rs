//! Sums of `f64` without rounding: the same bits in any order and any split.
//!
//! ```text
//! sum = sum_k digit_k 2^(32 k - 1074)        digits of 32 bits in 64, carried on before they can overflow
//! ```
//!
//! A fixed-point number as long as the range of `f64` (J. R. Shewchuk's question, U. Kulisch's answer: *Advanced
//! Arithmetic for the Digital Computer*, 2002). Adding costs three additions of integers.

/// 32-bit digits from 2^-1074 to 2^1024, and two for carries.
const DIGITS: usize = 68;
/// Additions before carries must be passed on: 2^30 of 32-bit digits stay below 2^63.
const PATIENCE: u32 = 1 << 30;

/// A sum of finite numbers, exact.
#[derive(Clone, Debug)]
pub struct ExactSum {
    digits: [i64; DIGITS],
    waiting: u32,
}

impl Default for ExactSum {
    fn default() -> ExactSum {
        ExactSum { digits: [0; DIGITS], waiting: 0 }
    }
}

impl PartialEq for ExactSum {
    fn eq(&self, other: &ExactSum) -> bool {
        self.canonical() == other.canonical()
    }
}

impl ExactSum {
    /// Adds a finite number; others are the caller's to count.
    #[inline]
    pub fn add(&mut self, value: f64) {
        let bits = value.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as usize;
        let fraction = bits & 0x000f_ffff_ffff_ffff;
        let (mantissa, place) = if exponent == 0 { (fraction, 0) } else { (fraction | 1 << 52, exponent - 1) };
        let shifted = u128::from(mantissa) << (place % 32);
        let k = place / 32;
        // all ones for a negative number: x -> (x ^ s) - s is -x
        let s = (bits as i64) >> 63;
        for (digit, part) in self.digits[k..k + 3].iter_mut().zip([shifted, shifted >> 32, shifted >> 64]) {
            *digit += ((part as u32 as i64) ^ s) - s;
        }
        self.waiting += 1;
        if self.waiting >= PATIENCE {
            self.carry();
        }
    }

    /// Adds another sum.
    pub fn merge(&mut self, other: &ExactSum) {
        let other = other.canonical();
        self.carry();
        self.digits.iter_mut().zip(other).for_each(|(digit, more)| *digit += more);
        self.carry();
    }

    fn carry(&mut self) {
        let mut carry = 0_i64;
        for digit in &mut self.digits[..DIGITS - 1] {
            let whole = *digit + carry;
            carry = whole >> 32;
            *digit = whole & 0xffff_ffff;
        }
        self.digits[DIGITS - 1] += carry;
        self.waiting = 0;
    }

    /// Digits of 32 bits, the last one with the sign.
    fn canonical(&self) -> [i64; DIGITS] {
        let mut own = self.clone();
        own.carry();
        own.digits
    }

    /// The digits for a file.
    pub fn to_digits(&self) -> Vec<i64> {
        self.canonical().to_vec()
    }

    /// From the digits of a file; `None` where they are none.
    pub fn from_digits(digits: &[i64]) -> Option<ExactSum> {
        let digits: [i64; DIGITS] = digits.try_into().ok()?;
        let (_, low) = digits.split_last()?;
        low.iter().all(|d| (0..1 << 32).contains(d)).then_some(ExactSum { digits, waiting: 0 })
    }

    /// The sum, rounded once or twice; the same for the same sum.
    pub fn value(&self) -> f64 {
        let mut digits = self.canonical();
        let negative = digits[DIGITS - 1] < 0;
        if negative {
            // two's complement over all digits: sign and size
            let mut borrow = 0;
            for digit in &mut digits[..DIGITS - 1] {
                let whole = -*digit - borrow;
                borrow = i64::from(whole < 0);
                *digit = whole & 0xffff_ffff;
            }
            digits[DIGITS - 1] = -digits[DIGITS - 1] - borrow;
        }
        let Some(top) = digits.iter().rposition(|d| *d != 0) else { return 0.0 };
        // the four upper digits hold 97 bits or more
        let from = top.saturating_sub(3);
        let size = digits[from..=top].iter().rev().fold(0_u128, |sum, d| (sum << 32) | *d as u128);
        let power = 32 * from as i32 - 1074;
        // in two factors: 2^power alone may lie below the smallest number
        let value = size as f64 * 2.0_f64.powi(power / 2) * 2.0_f64.powi(power - power / 2);
        if negative { -value } else { value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_and_split_change_no_bit() {
        let values: Vec<f64> = (0..2000)
            .map(|k| (k as f64 * 0.7).sin() * 10.0_f64.powi(k % 60 - 30))
            .chain([1e300, -1e300, 5e-324])
            .collect();
        let sum = |values: &[f64]| {
            let mut sum = ExactSum::default();
            values.iter().for_each(|v| sum.add(*v));
            sum
        };
        let whole = sum(&values);
        let mut parts = sum(&values[1200..]);
        parts.merge(&sum(&values[..300]));
        parts.merge(&sum(&values[300..1200]));
        assert_eq!(whole, parts);
        assert_eq!(ExactSum::from_digits(&whole.to_digits()), Some(whole));
    }

    #[test]
    fn sums_are_exact_where_floats_are_not() {
        let mut sum = ExactSum::default();
        for v in [1e300, 1.0, -1e300, 1e-300, -0.25] {
            sum.add(v);
        }
        assert_eq!(sum.value(), 0.75);
        let mut tenths = ExactSum::default();
        (0..10_000_000).for_each(|_| tenths.add(-0.1));
        assert_eq!(tenths.value(), -1_000_000.0);
        let mut small = ExactSum::default();
        (0..3).for_each(|_| small.add(5e-324));
        assert_eq!(small.value(), 1.5e-323);
    }
}
