//! Numbers of 32 digits as unevaluated sums of two doubles (T. J. Dekker 1971; D. Knuth's two-sum).
//!
//! ```text
//! x = hi + lo,  |lo| <= ulp(hi) / 2          errors of + - * /: a few 2^-104
//! ```
//!
//! Iterative refinement needs residuals in twice the working precision, which this gives. Products beyond 1e300 overflow
//! in the split.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `hi + lo`.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
}

impl DoubleDouble {
    /// 0.
    pub const ZERO: DoubleDouble = DoubleDouble { hi: 0.0, lo: 0.0 };
    /// 1.
    pub const ONE: DoubleDouble = DoubleDouble { hi: 1.0, lo: 0.0 };

    /// A double, exactly.
    pub fn new(value: f64) -> DoubleDouble {
        DoubleDouble { hi: value, lo: 0.0 }
    }

    /// The nearest double.
    pub fn to_f64(self) -> f64 {
        self.hi + self.lo
    }

    /// Square root, by one Newton step from the square root of `hi`; 0 for numbers that are not positive.
    pub fn sqrt(self) -> DoubleDouble {
        if self.hi.is_nan() || self.hi <= 0.0 {
            return DoubleDouble::ZERO;
        }
        let root = DoubleDouble::new(self.hi.sqrt());
        root + (self - root * root) / (root + root)
    }
}

fn quick_two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    DoubleDouble { hi, lo: b - (hi - a) }
}

fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    let v = hi - a;
    DoubleDouble { hi, lo: (a - (hi - v)) + (b - v) }
}

/// Veltkamp's split: 26 bits in each part.
fn split(a: f64) -> (f64, f64) {
    let t = 134_217_729.0 * a;
    let high = t - (t - a);
    (high, a - high)
}

fn two_product(a: f64, b: f64) -> DoubleDouble {
    let hi = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    DoubleDouble { hi, lo: ((ah * bh - hi) + ah * bl + al * bh) + al * bl }
}

impl Add for DoubleDouble {
    type Output = DoubleDouble;
    fn add(self, other: DoubleDouble) -> DoubleDouble {
        let s = two_sum(self.hi, other.hi);
        let t = two_sum(self.lo, other.lo);
        let u = quick_two_sum(s.hi, s.lo + t.hi);
        quick_two_sum(u.hi, u.lo + t.lo)
    }
}

impl Neg for DoubleDouble {
    type Output = DoubleDouble;
    fn neg(self) -> DoubleDouble {
        DoubleDouble { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for DoubleDouble {
    type Output = DoubleDouble;
    fn sub(self, other: DoubleDouble) -> DoubleDouble {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = DoubleDouble;
    fn mul(self, other: DoubleDouble) -> DoubleDouble {
        let p = two_product(self.hi, other.hi);
        quick_two_sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Div for DoubleDouble {
    type Output = DoubleDouble;
    fn div(self, other: DoubleDouble) -> DoubleDouble {
        let first = self.hi / other.hi;
        let rest = self - other * DoubleDouble::new(first);
        let second = rest.hi / other.hi;
        let last = (rest - other * DoubleDouble::new(second)).hi / other.hi;
        quick_two_sum(first, second) + DoubleDouble::new(last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thirty_digits() {
        let third = DoubleDouble::ONE / DoubleDouble::new(3.0);
        let rest = third + third + third - DoubleDouble::ONE;
        assert!(rest.to_f64().abs() < 1e-31, "{rest:?}");
        let two = DoubleDouble::new(2.0);
        let rest = two.sqrt() * two.sqrt() - two;
        assert!(rest.to_f64().abs() < 1e-30, "{rest:?}");
        let tiny = DoubleDouble::new(1.0) + DoubleDouble::new(1e-25) - DoubleDouble::ONE;
        assert!((tiny.to_f64() - 1e-25).abs() < 1e-40);
    }
}
