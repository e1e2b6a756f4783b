//! Values and derivatives of the p + 1 basis functions that are not zero at one x, in one pass (Piegl and Tiller, A2.3).

use super::{Knots, MAX_DEGREE};

const WIDTH: usize = MAX_DEGREE + 1;

/// The basis functions at one x: `values[k][a]` is the k-th derivative of basis function `first + a`.
#[derive(Clone, Debug, PartialEq)]
pub struct BasisRow {
    /// Index of the first basis function that is not zero here.
    pub first: usize,
    values: [[f64; WIDTH]; 3],
    width: usize,
}

impl BasisRow {
    /// k-th derivatives, k = 0, 1, 2, of the p + 1 basis functions.
    pub fn derivative(&self, k: usize) -> &[f64] {
        &self.values[k][..self.width]
    }
}

impl Knots {
    /// Values, first and second derivatives at `x`; outside the domain those of the end segment's polynomial.
    pub fn basis(&self, x: f64) -> BasisRow {
        self.basis_on(self.segment_of(x), x)
    }

    /// As [`Knots::basis`], but with the polynomials of segment `segment` wherever `x` is.
    pub fn basis_on(&self, segment: usize, x: f64) -> BasisRow {
        let width = self.degree() + 1;
        let mut flat = [0.0; 3 * WIDTH];
        self.derivatives_on(segment, x, 2, &mut flat[..3 * width]);
        let mut values = [[0.0; WIDTH]; 3];
        for (k, row) in values.iter_mut().enumerate() {
            row[..width].copy_from_slice(&flat[k * width..(k + 1) * width]);
        }
        BasisRow { first: self.first_basis(segment), values, width }
    }

    /// All derivatives from 0 to `order` at `x`, written row after row into `out`, which holds (order + 1)(p + 1)
    /// numbers; returns the index of the first basis function. Derivatives beyond the degree are zero.
    ///
    /// ```
    /// # use palpate_numeric::facade as palpate;
    /// use palpate::spline::Knots;
    ///
    /// let knots = Knots::uniform(2, 4, 0.0, 1.0)?;
    /// let mut values = [0.0; 3];
    /// // at a knot two parabolas meet with half of the weight each; the third basis function begins there
    /// assert_eq!(knots.derivatives(0.5, 0, &mut values), 2);
    /// assert_eq!(values, [0.5, 0.5, 0.0]);
    /// # Ok::<(), palpate::spline::SplineError>(())
    /// ```
    pub fn derivatives(&self, x: f64, order: usize, out: &mut [f64]) -> usize {
        let segment = self.segment_of(x);
        self.derivatives_on(segment, x, order, out);
        self.first_basis(segment)
    }

    /// As [`Knots::derivatives`], but with the polynomials of segment `segment` wherever `x` is.
    pub fn derivatives_on(&self, segment: usize, x: f64, order: usize, out: &mut [f64]) {
        let p = self.degree();
        let width = p + 1;
        let start = self.first_basis(segment) + p;
        let window = &self.as_slice()[start + 1 - p..=start + p];
        if order <= 2 {
            return up_to_second(window, p, x, &mut out[..(order + 1) * width]);
        }
        let (table, differences) = triangle(window, p, x);
        out[..width].copy_from_slice(&table[p][..width]);
        out[width..(order + 1) * width].fill(0.0);
        for a in 0..width {
            derivatives_of_one(&table, &differences, p, a, order.min(p), out);
        }
        let mut factor = 1.0;
        for k in 1..=order.min(p) {
            factor *= (p + 1 - k) as f64;
            out[k * width..(k + 1) * width].iter_mut().for_each(|v| *v *= factor);
        }
    }
}

/// Values and as many of the first two derivatives as `out` has rows for. Fits and maps need no more, so this is the
/// fast path.
///
/// ```text
/// B_r = N^(p-1)_r / d^p_r        N'_a  = p (B_(a-1) - B_a)
/// C_r = N^(p-2)_r / d^(p-1)_r    N''_a = p (B'_(a-1) - B'_a),   B'_r = (p-1) (C_(r-1) - C_r) / d^p_r
/// ```
fn up_to_second(knots: &[f64], p: usize, x: f64, out: &mut [f64]) {
    let width = p + 1;
    let (mut values, mut shares) = ([0.0; WIDTH], [[0.0; WIDTH]; 2]);
    values[0] = 1.0;
    for j in 1..=p {
        let [before, last] = &mut shares;
        std::mem::swap(before, last);
        let mut saved = 0.0;
        for r in 0..j {
            let (right, left) = (knots[p + r], knots[p + r - j]);
            last[r] = values[r] / (right - left);
            values[r] = saved + (right - x) * last[r];
            saved = (x - left) * last[r];
        }
        values[j] = saved;
    }
    out[..width].copy_from_slice(&values[..width]);
    let [before, last] = &shares;
    let mut rows = out[width..].chunks_exact_mut(width);
    if let Some(first) = rows.next() {
        differences(p as f64, &last[..p], first);
    }
    if let Some(second) = rows.next() {
        let mut bent = [0.0; WIDTH];
        if p > 1 {
            differences((p - 1) as f64, &before[..p - 1], &mut bent[..p]);
        }
        (0..p).for_each(|r| bent[r] /= knots[p + r] - knots[r]);
        differences(p as f64, &bent[..p], second);
    }
}

/// `out_a = factor (terms_(a-1) - terms_a)`, where terms beyond both ends are zero.
fn differences(factor: f64, terms: &[f64], out: &mut [f64]) {
    let mut before = 0.0;
    for (o, &term) in out.iter_mut().zip(terms) {
        *o = factor * (before - term);
        before = term;
    }
    out[terms.len()] = factor * before;
}

/// `table[j][r]`: basis function r of degree j; `differences[j][r]`: its knot difference `t_right - t_left`.
fn triangle(knots: &[f64], p: usize, x: f64) -> ([[f64; WIDTH]; WIDTH], [[f64; WIDTH]; WIDTH]) {
    let mut table = [[0.0; WIDTH]; WIDTH];
    let mut differences = [[1.0; WIDTH]; WIDTH];
    table[0][0] = 1.0;
    for j in 1..=p {
        let mut saved = 0.0;
        for r in 0..j {
            let (right, left) = (knots[p + r], knots[p + r - j]);
            differences[j][r] = right - left;
            let share = table[j - 1][r] / differences[j][r];
            table[j][r] = saved + (right - x) * share;
            saved = (x - left) * share;
        }
        table[j][j] = saved;
    }
    (table, differences)
}

/// Derivatives of basis function `a` as differences of those of lower degree. Two rows of coefficients take turns: one
/// holds the last order's, the other receives the next order's.
fn derivatives_of_one(
    table: &[[f64; WIDTH]; WIDTH],
    differences: &[[f64; WIDTH]; WIDTH],
    p: usize,
    a: usize,
    order: usize,
    out: &mut [f64],
) {
    let mut coefficients = [[0.0; WIDTH]; 2];
    coefficients[0][0] = 1.0;
    let (mut now, mut next) = (0, 1);
    for k in 1..=order {
        let low = p - k;
        let mut sum = 0.0;
        if a >= k {
            coefficients[next][0] = coefficients[now][0] / differences[low + 1][a - k];
            sum = coefficients[next][0] * table[low][a - k];
        }
        let from = if a + 1 >= k { 1 } else { k - a };
        let to = if a <= low + 1 { k - 1 } else { p - a };
        for j in from..=to {
            let difference = differences[low + 1][a + j - k];
            coefficients[next][j] = (coefficients[now][j] - coefficients[now][j - 1]) / difference;
            sum += coefficients[next][j] * table[low][a + j - k];
        }
        if a <= low {
            coefficients[next][k] = -coefficients[now][k - 1] / differences[low + 1][a];
            sum += coefficients[next][k] * table[low][a];
        }
        out[k * (p + 1) + a] = sum;
        (now, next) = (next, now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients of x^power by the blossom: elementary symmetric means of the p knots of each basis function.
    fn monomial_coefficients(knots: &Knots, power: usize) -> Vec<f64> {
        let p = knots.degree();
        let t = knots.as_slice();
        let binomial = |n: usize, k: usize| (0..k).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64);
        (0..knots.n_basis())
            .map(|i| {
                let mut symmetric = vec![0.0; p + 1];
                symmetric[0] = 1.0;
                for (count, knot) in t[i + 1..=i + p].iter().enumerate() {
                    for k in (1..=count + 1).rev() {
                        symmetric[k] += knot * symmetric[k - 1];
                    }
                }
                symmetric[power] / binomial(p, power)
            })
            .collect()
    }

    #[test]
    fn monomials_and_all_their_derivatives_are_exact() {
        for p in 1..=MAX_DEGREE {
            let mut t = vec![-1.0; p + 1];
            t.extend([-0.5, 0.125]);
            if p > 1 {
                t.push(0.125);
            }
            t.extend(vec![1.0; p + 1]);
            let knots = Knots::new(p, t).unwrap();
            let order = p + 2;
            let mut rows = vec![0.0; (order + 1) * (p + 1)];
            for power in 0..=p {
                let c = monomial_coefficients(&knots, power);
                for x in [-1.0, -0.7, -0.5, 0.0, 0.125, 0.6, 1.0] {
                    let first = knots.derivatives(x, order, &mut rows);
                    for k in 0..=order {
                        let value: f64 = (0..=p).map(|a| rows[k * (p + 1) + a] * c[first + a]).sum();
                        let falling = (0..k).fold(1.0, |f, i| f * (power as f64 - i as f64));
                        let exact = if k > power { 0.0 } else { falling * f64::powi(x, (power - k) as i32) };
                        let scale: f64 = (0..=p).map(|a| (rows[k * (p + 1) + a] * c[first + a]).abs()).sum();
                        assert!((value - exact).abs() <= 1e-14 * (1.0 + scale), "p {p} power {power} k {k} x {x}");
                    }
                }
            }
        }
    }

    #[test]
    fn partition_of_unity_at_both_ends_and_outside() {
        let knots = Knots::uniform(4, 5, 2.0, 3.0).unwrap();
        for x in [1.9, 2.0, 2.2, 2.5, 3.0, 3.1] {
            let row = knots.basis(x);
            assert!((row.derivative(0).iter().sum::<f64>() - 1.0).abs() < 1e-13);
            assert!(row.derivative(1).iter().sum::<f64>().abs() < 1e-10);
        }
        assert_eq!(knots.basis(2.0).derivative(0)[0], 1.0);
        assert_eq!(knots.basis(3.0).derivative(0)[4], 1.0);
    }
}
