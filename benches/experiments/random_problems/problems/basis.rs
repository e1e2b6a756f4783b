//! B-splines by the recursion of Cox and de Boor, and Gauss's points, in 32 digits.
//!
//! ```text
//! N_i^p = (x - t_i)/(t_{i+p} - t_i) N_i^{p-1} + (t_{i+p+1} - x)/(t_{i+p+1} - t_{i+1}) N_{i+1}^{p-1}
//! ```

use palpate_numeric::linalg::DoubleDouble as Dd;

/// Values, first and second derivatives of all basis functions; right limit at a knot, left at the last.
pub(super) fn basis(knots: &[f64], degree: usize, x: Dd) -> [Vec<Dd>; 3] {
    let count = knots.len() - degree - 1;
    let mut span = degree;
    while span < count - 1 && x >= Dd::new(knots[span + 1]) {
        span += 1;
    }
    let mut tables = vec![vec![Dd::ZERO; knots.len() - 1]];
    tables[0][span] = Dd::ONE;
    let knot = |i: usize| Dd::new(knots[i]);
    for p in 1..=degree {
        let last = &tables[p - 1];
        let next = (0..knots.len() - 1 - p)
            .map(|i| {
                ratio((x - knot(i)) * last[i], knot(i + p) - knot(i))
                    + ratio((knot(i + p + 1) - x) * last[i + 1], knot(i + p + 1) - knot(i + 1))
            })
            .collect();
        tables.push(next);
    }
    [0, 1, 2].map(|times| derivative(&tables, knots, degree, times))
}

fn ratio(a: Dd, b: Dd) -> Dd {
    if a == Dd::ZERO || b == Dd::ZERO { Dd::ZERO } else { a / b }
}

fn derivative(tables: &[Vec<Dd>], knots: &[f64], degree: usize, times: usize) -> Vec<Dd> {
    if times == 0 {
        return tables[degree].clone();
    }
    if degree == 0 {
        return vec![Dd::ZERO; knots.len() - 1];
    }
    let lower = derivative(tables, knots, degree - 1, times - 1);
    let side = |i: usize| Dd::new(knots[i + degree]) - Dd::new(knots[i]);
    let p = Dd::new(degree as f64);
    (0..lower.len() - 1).map(|i| p * (ratio(lower[i], side(i)) - ratio(lower[i + 1], side(i + 1)))).collect()
}

/// Gauss's points and weights on [-1, 1], exact for polynomials of degree `2 count - 1`: Newton's method on Legendre's
/// polynomial, from the usual cosines.
pub(super) fn gauss(count: usize) -> Vec<(Dd, Dd)> {
    let of = |k: usize| Dd::new(k as f64);
    let polynomial = |x: Dd| {
        let (mut before, mut now) = (Dd::ONE, x);
        for k in 2..=count {
            let next = (of(2 * k - 1) * x * now - of(k - 1) * before) / of(k);
            (before, now) = (now, next);
        }
        let slope = of(count) * (x * now - before) / (x * x - Dd::ONE);
        (now, slope)
    };
    let place = |k: usize| (std::f64::consts::PI * (k as f64 + 0.75) / (count as f64 + 0.5)).cos();
    let point = |k: usize| {
        let mut x = Dd::new(place(k));
        for _ in 0..4 {
            let (value, slope) = polynomial(x);
            x = x - value / slope;
        }
        let slope = polynomial(x).1;
        (x, Dd::new(2.0) / ((Dd::ONE - x * x) * slope * slope))
    };
    (0..count).map(point).collect()
}
