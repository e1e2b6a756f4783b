//! Householder QR in 32 digits, rows sorted by size and columns pivoted, so that rows of any weight keep their digits.
//!
//! ```text
//! E D P = Q R,  D the columns' inverse norms        c = D P R^-1 Q'b        (E'E)^-1 g = D P R^-1 R^-T P'D g
//! ```
//!
//! M. J. D. Powell and J. K. Reid, Information Processing 68 (1969) 122; A. J. Cox and N. J. Higham (1998).

use palpate_numeric::linalg::DoubleDouble as Dd;

/// Below this share of a column's norm what is left of it depends on the other columns: not a problem of full rank.
const DEPENDENT: f64 = 1e-13;

/// Rows as columns, and their right-hand sides.
#[derive(Default)]
pub(super) struct Rows {
    pub columns: Vec<Vec<Dd>>,
    pub rhs: Vec<Dd>,
}

impl Rows {
    pub(super) fn new(unknowns: usize) -> Rows {
        Rows { columns: vec![Vec::new(); unknowns], rhs: Vec::new() }
    }

    /// Adds one row unless it is zero.
    pub(super) fn push(&mut self, weight: Dd, entries: &[Dd], value: Dd) {
        if weight != Dd::ZERO {
            self.columns.iter_mut().zip(entries).for_each(|(column, &v)| column.push(weight * v));
            self.rhs.push(weight * value);
        }
    }
}

/// R, with the order and the norms of the columns.
pub(super) struct Factor {
    columns: Vec<Vec<Dd>>,
    order: Vec<usize>,
    norms: Vec<Dd>,
    rhs: Vec<Dd>,
}

impl Factor {
    /// Factors rows given column by column; `None` where they are not of full rank.
    pub(super) fn new(rows: Rows) -> Option<Factor> {
        let Rows { mut columns, mut rhs } = rows;
        let (unknowns, equations) = (columns.len(), rhs.len());
        if equations < unknowns {
            return None;
        }
        sort_rows(&mut columns, &mut rhs);
        let norms: Vec<Dd> = columns.iter().map(|c| norm(c)).collect();
        for (column, &norm) in columns.iter_mut().zip(&norms) {
            if norm == Dd::ZERO {
                return None;
            }
            column.iter_mut().for_each(|v| *v = *v / norm);
        }
        let mut factor = Factor { columns, order: (0..unknowns).collect(), norms, rhs };
        (0..unknowns).all(|k| factor.eliminate(k)).then_some(factor)
    }

    /// One column; `false` where nothing is left of any.
    fn eliminate(&mut self, k: usize) -> bool {
        let left = |column: &[Dd]| column[k..].iter().map(|v| v.to_f64().powi(2)).sum::<f64>();
        let sizes: Vec<f64> = self.columns[k..].iter().map(|c| left(c)).collect();
        let largest = (0..sizes.len()).fold(0, |best, j| if sizes[j] > sizes[best] { j } else { best });
        self.columns.swap(k, k + largest);
        self.order.swap(k, k + largest);
        let length = norm(&self.columns[k][k..]);
        if length.to_f64().is_nan() || length.to_f64() < DEPENDENT {
            return false;
        }
        let alpha = if self.columns[k][k] > Dd::ZERO { -length } else { length };
        let mut v = self.columns[k][k..].to_vec();
        v[0] = v[0] - alpha;
        let beta = Dd::new(2.0) / dot(&v, &v);
        for column in &mut self.columns[k + 1..] {
            reflect(&mut column[k..], &v, beta);
        }
        reflect(&mut self.rhs[k..], &v, beta);
        self.columns[k][k] = alpha;
        true
    }

    /// The coefficients.
    pub(super) fn solution(&self) -> Vec<Dd> {
        self.back(&self.rhs)
    }

    /// `(E'E)^-1 g`.
    pub(super) fn normal_solution(&self, g: &[Dd]) -> Vec<Dd> {
        let n = self.columns.len();
        let mut y: Vec<Dd> = self.order.iter().map(|&u| g[u] / self.norms[u]).collect();
        for k in 0..n {
            let known = (0..k).fold(y[k], |sum, i| sum - self.columns[k][i] * y[i]);
            y[k] = known / self.columns[k][k];
        }
        self.back(&y)
    }

    fn back(&self, rhs: &[Dd]) -> Vec<Dd> {
        let n = self.columns.len();
        let mut y = vec![Dd::ZERO; n];
        for k in (0..n).rev() {
            let known = (k + 1..n).fold(rhs[k], |sum, j| sum - self.columns[j][k] * y[j]);
            y[k] = known / self.columns[k][k];
        }
        let mut c = vec![Dd::ZERO; n];
        (0..n).for_each(|k| c[self.order[k]] = y[k] / self.norms[self.order[k]]);
        c
    }
}

/// The rows with the largest entries first.
fn sort_rows(columns: &mut [Vec<Dd>], rhs: &mut Vec<Dd>) {
    let size = |r: usize| columns.iter().fold(0.0_f64, |m, c| m.max(c[r].to_f64().abs()));
    let sizes: Vec<f64> = (0..rhs.len()).map(size).collect();
    let mut order: Vec<usize> = (0..rhs.len()).collect();
    order.sort_by(|&a, &b| sizes[b].total_cmp(&sizes[a]));
    let taken = |column: &[Dd]| order.iter().map(|&r| column[r]).collect::<Vec<Dd>>();
    columns.iter_mut().for_each(|column| *column = taken(column));
    *rhs = taken(rhs);
}

fn norm(v: &[Dd]) -> Dd {
    dot(v, v).sqrt()
}

fn reflect(target: &mut [Dd], v: &[Dd], beta: Dd) {
    let s = beta * dot(target, v);
    target.iter_mut().zip(v).for_each(|(t, &w)| *t = *t - s * w);
}

/// `a'b`.
pub(super) fn dot(a: &[Dd], b: &[Dd]) -> Dd {
    a.iter().zip(b).fold(Dd::ZERO, |sum, (&u, &v)| sum + u * v)
}
