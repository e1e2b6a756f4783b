//! The written problem in double-double, by a route of its own: Cox-de Boor basis, rows, Householder QR, shape.
//!
//! ```text
//! min sum wz^2 (z - S)^2 + wx^2 (zx - S_x)^2 + wy^2 (zy - S_y)^2,   S = sum_ij c_ij N_i(x) M_j(y)
//! ```

use palpate::internals::linalg::DoubleDouble as Dd;
use palpate::{Contacts, Orientation};

/// A slope-row problem on given knots, explicit weights.
pub(crate) struct Problem<'a> {
    pub contacts: &'a Contacts,
    pub degree: [usize; 2],
    pub knots: [&'a [f64]; 2],
    pub weights: [f64; 3],
}

/// Coefficients, and S and R at grid points.
pub(crate) struct Solved {
    pub coefficients: Vec<f64>,
    pub shape_index: Vec<f64>,
    pub curvedness: Vec<f64>,
}

impl Problem<'_> {
    /// `None` where a diagonal entry of R falls below 1e-13 of the largest: not a full-rank problem.
    pub(crate) fn solve(&self, grid: [&[Dd]; 2]) -> Option<Solved> {
        let (mut columns, mut rhs) = self.rows();
        let c = least_squares(&mut columns, &mut rhs)?;
        let mut solved = Solved { coefficients: Vec::new(), shape_index: Vec::new(), curvedness: Vec::new() };
        for &x in grid[0] {
            for &y in grid[1] {
                let (s, r) = self.shape(&c, x, y);
                solved.shape_index.push(s);
                solved.curvedness.push(r);
            }
        }
        solved.coefficients = c.iter().map(|v| v.to_f64()).collect();
        Some(solved)
    }

    fn rows(&self) -> (Vec<Vec<Dd>>, Vec<Dd>) {
        let data = self.contacts;
        let unknowns: usize = [0, 1].iter().map(|&k| self.knots[k].len() - self.degree[k] - 1).product();
        let (mut columns, mut rhs) = (vec![Vec::new(); unknowns], Vec::new());
        for r in 0..data.len() {
            let n = basis(self.knots[0], self.degree[0], Dd::new(data.x[r]));
            let m = basis(self.knots[1], self.degree[1], Dd::new(data.y[r]));
            let mut push = |weight: f64, row_weight: &Option<Vec<f64>>, dx: usize, dy: usize, value: f64| {
                let w = Dd::new(weight) * Dd::new(row_weight.as_ref().map_or(1.0, |v| v[r]));
                let products = n[dx].iter().flat_map(|&a| m[dy].iter().map(move |&b| a * b));
                columns.iter_mut().zip(products).for_each(|(column, v)| column.push(w * v));
                rhs.push(w * Dd::new(value));
            };
            push(self.weights[0], &data.weights.z, 0, 0, data.z[r]);
            if let Orientation::Slopes { zx, zy } = &data.orientation {
                push(self.weights[1], &data.weights.x, 1, 0, zx[r]);
                push(self.weights[2], &data.weights.y, 0, 1, zy[r]);
            }
        }
        (columns, rhs)
    }

    fn shape(&self, c: &[Dd], x: Dd, y: Dd) -> (f64, f64) {
        let n = basis(self.knots[0], self.degree[0], x);
        let m = basis(self.knots[1], self.degree[1], y);
        let at = |dx: usize, dy: usize| {
            let products = n[dx].iter().flat_map(|&a| m[dy].iter().map(move |&b| a * b));
            products.zip(c).fold(Dd::ZERO, |sum, (v, &c)| sum + v * c)
        };
        let (zx, zy, zxx, zxy, zyy) = (at(1, 0), at(0, 1), at(2, 0), at(1, 1), at(0, 2));
        let (ex, ey) = (Dd::ONE + zx * zx, Dd::ONE + zy * zy);
        let w2 = Dd::ONE + zx * zx + zy * zy;
        let cross = zx * zy * zxy;
        let mean = (ey * zxx - cross - cross + ex * zyy) / ((w2 + w2) * w2.sqrt());
        let half_gap = (mean * mean - (zxx * zyy - zxy * zxy) / (w2 * w2)).sqrt();
        let (mean, half_gap) = (mean.to_f64(), half_gap.to_f64());
        (-std::f64::consts::FRAC_2_PI * mean.atan2(half_gap), mean.hypot(half_gap))
    }
}

/// Values, first and second derivatives of all basis functions; right limit at a knot, left at the last.
fn basis(knots: &[f64], degree: usize, x: Dd) -> [Vec<Dd>; 3] {
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
    if b == Dd::ZERO { Dd::ZERO } else { a / b }
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

/// Householder QR of equilibrated columns, in place.
fn least_squares(columns: &mut [Vec<Dd>], rhs: &mut [Dd]) -> Option<Vec<Dd>> {
    let (unknowns, equations) = (columns.len(), rhs.len());
    if equations < unknowns {
        return None;
    }
    let norms: Vec<Dd> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    for (column, &norm) in columns.iter_mut().zip(&norms) {
        if norm == Dd::ZERO {
            return None;
        }
        column.iter_mut().for_each(|v| *v = *v / norm);
    }
    for k in 0..unknowns {
        let norm = dot(&columns[k][k..], &columns[k][k..]).sqrt();
        if norm.to_f64() < 1e-13 {
            return None;
        }
        let alpha = if columns[k][k] > Dd::ZERO { -norm } else { norm };
        let mut v = columns[k][k..].to_vec();
        v[0] = v[0] - alpha;
        let beta = Dd::new(2.0) / dot(&v, &v);
        for column in &mut columns[k + 1..] {
            reflect(&mut column[k..], &v, beta);
        }
        reflect(&mut rhs[k..], &v, beta);
        columns[k][k] = alpha;
    }
    let mut c = vec![Dd::ZERO; unknowns];
    for k in (0..unknowns).rev() {
        let known = (k + 1..unknowns).fold(rhs[k], |sum, j| sum - columns[j][k] * c[j]);
        c[k] = known / columns[k][k];
    }
    Some(c.iter().zip(&norms).map(|(&v, &norm)| v / norm).collect())
}

fn reflect(target: &mut [Dd], v: &[Dd], beta: Dd) {
    let s = beta * dot(target, v);
    target.iter_mut().zip(v).for_each(|(t, &w)| *t = *t - s * w);
}

fn dot(a: &[Dd], b: &[Dd]) -> Dd {
    a.iter().zip(b).fold(Dd::ZERO, |sum, (&u, &v)| sum + u * v)
}
