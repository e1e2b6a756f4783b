//! Numbers of 32 digits as unevaluated sums of two doubles, those of the crate `qd`.
//!
//! ```text
//! x = hi + lo,  |lo| <= ulp(hi) / 2          errors of + - * /: a few 2^-104
//! ```
//!
//! Iterative refinement needs residuals in twice the working precision. Sums are qd's accurate ones: its operators take the
//! quick ones, whose error is relative to the summands and not to their sum.

use std::ops::{Add, Div, Mul, Neg, Sub};

use qd::Quad;

/// `hi + lo`.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct DoubleDouble(Quad);

impl DoubleDouble {
    /// 0.
    pub const ZERO: DoubleDouble = DoubleDouble(Quad::ZERO);
    /// 1.
    pub const ONE: DoubleDouble = DoubleDouble(Quad::ONE);

    /// A double, exactly.
    pub fn new(value: f64) -> DoubleDouble {
        DoubleDouble(Quad::from_f64(value))
    }

    /// The nearest double.
    pub fn to_f64(self) -> f64 {
        self.0.0 + self.0.1
    }

    /// Square root; 0 for numbers that are not positive.
    pub fn sqrt(self) -> DoubleDouble {
        if self.0.0 > 0.0 { DoubleDouble(self.0.sqrt()) } else { DoubleDouble::ZERO }
    }
}

impl Default for DoubleDouble {
    fn default() -> DoubleDouble {
        DoubleDouble::ZERO
    }
}

impl Add for DoubleDouble {
    type Output = DoubleDouble;
    fn add(self, other: DoubleDouble) -> DoubleDouble {
        DoubleDouble(self.0.add_accurate(other.0))
    }
}

impl Neg for DoubleDouble {
    type Output = DoubleDouble;
    fn neg(self) -> DoubleDouble {
        DoubleDouble(self.0.neg())
    }
}

impl Sub for DoubleDouble {
    type Output = DoubleDouble;
    fn sub(self, other: DoubleDouble) -> DoubleDouble {
        DoubleDouble(self.0.sub_accurate(other.0))
    }
}

impl Mul for DoubleDouble {
    type Output = DoubleDouble;
    fn mul(self, other: DoubleDouble) -> DoubleDouble {
        DoubleDouble(self.0 * other.0)
    }
}

impl Div for DoubleDouble {
    type Output = DoubleDouble;
    fn div(self, other: DoubleDouble) -> DoubleDouble {
        DoubleDouble(self.0 / other.0)
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
