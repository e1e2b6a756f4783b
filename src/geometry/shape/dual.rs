//! Forward differentiation: `f + f' e`, e^2 = 0, with N directions at once: exact derivatives from the formula of
//! the value alone.

use std::ops::{Add, Mul, Neg, Sub};

/// A value with its derivatives along N directions.
#[derive(Clone, Copy, Debug)]
pub struct Dual<const N: usize> {
    /// Value.
    pub value: f64,
    /// Derivatives.
    pub slope: [f64; N],
}

/// A point of space made of duals.
pub type DualVector<const N: usize> = [Dual<N>; 3];

impl<const N: usize> Dual<N> {
    /// A number that depends on no variable.
    pub fn constant(value: f64) -> Self {
        Dual { value, slope: [0.0; N] }
    }

    /// The variable of direction `k`.
    pub fn variable(value: f64, k: usize) -> Self {
        let mut dual = Dual::constant(value);
        dual.slope[k] = 1.0;
        dual
    }

    /// `f(self)` from its value and derivative.
    fn chain(self, value: f64, derivative: f64) -> Self {
        Dual { value, slope: self.slope.map(|s| s * derivative) }
    }

    /// Square root.
    pub fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }

    /// `1 / self`.
    pub fn recip(self) -> Self {
        let inverse = 1.0 / self.value;
        self.chain(inverse, -inverse * inverse)
    }

    /// Times a constant.
    pub fn times(self, factor: f64) -> Self {
        self.chain(factor * self.value, factor)
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        self.value += other.value;
        self.slope.iter_mut().zip(other.slope).for_each(|(a, b)| *a += b);
        self
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    fn sub(mut self, other: Self) -> Self {
        self.value -= other.value;
        self.slope.iter_mut().zip(other.slope).for_each(|(a, b)| *a -= b);
        self
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let mut out = Dual::constant(self.value * other.value);
        for k in 0..N {
            out.slope[k] = self.slope[k] * other.value + self.value * other.slope[k];
        }
        out
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.times(-1.0)
    }
}

/// `a . b`.
pub fn dot<const N: usize>(a: &DualVector<N>, b: &DualVector<N>) -> Dual<N> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a x b`.
pub fn cross<const N: usize>(a: &DualVector<N>, b: &DualVector<N>) -> DualVector<N> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_a_compound_match_differences() {
        let f = |x: f64, y: f64| (x * y - y).sqrt() / (x + 2.0 * y);
        let (x, y) = (Dual::<2>::variable(3.0, 0), Dual::variable(0.7, 1));
        let found = (x * y - y).sqrt() * (x + y.times(2.0)).recip();
        let h = 1e-6;
        assert!((found.value - f(3.0, 0.7)).abs() < 1e-15);
        assert!((found.slope[0] - (f(3.0 + h, 0.7) - f(3.0 - h, 0.7)) / (2.0 * h)).abs() < 1e-9);
        assert!((found.slope[1] - (f(3.0, 0.7 + h) - f(3.0, 0.7 - h)) / (2.0 * h)).abs() < 1e-9);
    }
}
