//! Products of the basis functions of one segment, as polynomials of the local coordinate in [-1, 1].
//!
//! ```text
//! N_a(u) = sum_i n_a,i u^i        (N_a N_k)_i = sum_j n_a,j n_k,i-j        d/dx = (1 / half) d/du
//! ```

use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg::{DoubleDouble, SiteWeights};

/// Numbers of one axis, segment by segment.
#[derive(Clone, Debug)]
pub(super) struct Axis<T> {
    pub basis: AxisTables,
    pub products: Vec<T>,
}

/// Products of the basis functions of every segment of one axis, as polynomials of the local coordinate.
#[derive(Clone, Debug)]
pub(super) struct AxisTables {
    pub first: Vec<usize>,
    pub centre: Vec<f64>,
    pub inverse_half: Vec<f64>,
    /// `values[segment][a]`, `slopes[segment][a]`: the functions themselves.
    pub values: Vec<Vec<[f64; 8]>>,
    pub slopes: Vec<Vec<[f64; 8]>>,
}

impl AxisTables {
    pub(super) fn new(knots: &Knots) -> AxisTables {
        let width = knots.degree() + 1;
        let mut made = AxisTables {
            first: Vec::new(),
            centre: Vec::new(),
            inverse_half: Vec::new(),
            values: Vec::new(),
            slopes: Vec::new(),
        };
        let mut taylor = vec![0.0; width * width];
        for segment in 0..knots.n_segments() {
            let [lo, hi] = knots.segment(segment);
            let (centre, half) = (0.5 * (lo + hi), 0.5 * (hi - lo));
            knots.derivatives_on(segment, centre, width - 1, &mut taylor);
            let mut values = vec![[0.0; 8]; width];
            let mut slopes = vec![[0.0; 8]; width];
            let mut factor = 1.0;
            for k in 0..width {
                for a in 0..width {
                    values[a][k] = taylor[k * width + a] * factor;
                    if k > 0 {
                        slopes[a][k - 1] = values[a][k] * k as f64 / half;
                    }
                }
                factor *= half / (k + 1) as f64;
            }
            made.first.push(knots.first_basis(segment));
            made.centre.push(centre);
            made.inverse_half.push(1.0 / half);
            made.values.push(values);
            made.slopes.push(slopes);
        }
        made
    }
}

impl AxisTables {
    /// The same, with every coefficient of the functions themselves correct to half a unit in the last place. Passes over
    /// rows need that, because an error in the tables is the same for all contacts of a cell and does not average out.
    pub(super) fn nearest(knots: &Knots) -> AxisTables {
        let mut made = AxisTables::new(knots);
        for segment in 0..knots.n_segments() {
            let powers = nearest_powers(knots, segment, made.centre[segment], made.inverse_half[segment]);
            made.values[segment].copy_from_slice(&powers);
        }
        made
    }
}

/// Cox's and de Boor's recurrence over polynomials of degree at most 3 in twice the working precision, with
/// `x - t = (centre - t) + half u`.
fn nearest_powers(knots: &Knots, segment: usize, centre: f64, inverse_half: f64) -> Vec<[f64; 8]> {
    type Polynomial = [DoubleDouble; 4];
    let number = DoubleDouble::new;
    let times = |polynomial: &Polynomial, constant: DoubleDouble, slope: DoubleDouble| -> Polynomial {
        let mut out = polynomial.map(|c| c * constant);
        (1..4).for_each(|i| out[i] = out[i] + polynomial[i - 1] * slope);
        out
    };
    let (degree, t) = (knots.degree(), knots.as_slice());
    let span = knots.first_basis(segment) + degree;
    let half = DoubleDouble::ONE / number(inverse_half);
    let mut functions = vec![[DoubleDouble::ZERO; 4]; degree + 1];
    functions[0][0] = DoubleDouble::ONE;
    for j in 1..=degree {
        let mut saved = [DoubleDouble::ZERO; 4];
        for r in 0..j {
            let (left, right) = (number(t[span + 1 + r - j]), number(t[span + 1 + r]));
            let share = functions[r].map(|c| c / (right - left));
            let falling = times(&share, right - number(centre), -half);
            (0..4).for_each(|i| functions[r][i] = saved[i] + falling[i]);
            saved = times(&share, number(centre) - left, half);
        }
        functions[j] = saved;
    }
    let rounded = |f: &Polynomial| {
        let mut powers = [0.0; 8];
        powers.iter_mut().zip(f).for_each(|(p, c)| *p = c.to_f64());
        powers
    };
    functions.iter().map(rounded).collect()
}

/// Product of two polynomials of degree at most 3.
fn product(a: &[f64; 8], b: &[f64; 8]) -> [f64; 8] {
    let mut out = [0.0; 8];
    for i in 0..4 {
        for j in 0..4 {
            out[i + j] += a[i] * b[j];
        }
    }
    out
}

/// `left[pair]` of one x segment: N N, N'N', N'N, N N' for the pairs (a, k <= a).
#[derive(Clone, Debug)]
pub(super) struct XTables {
    pub kinds: [Vec<[f64; 8]>; 4],
}

/// `right[power][b (q + 1) + l]` of every y segment: M M, M'M', M M', M'M.
#[derive(Clone, Debug)]
pub(super) struct YTables {
    pub kinds: [[[f64; 16]; 8]; 4],
}

impl XTables {
    pub(super) fn of(axis: &AxisTables, segment: usize) -> XTables {
        let (n, d) = (&axis.values[segment], &axis.slopes[segment]);
        let pairs = |f: &dyn Fn(usize, usize) -> [f64; 8]| {
            (0..n.len()).flat_map(|a| (0..=a).map(move |k| (a, k))).map(|(a, k)| f(a, k)).collect()
        };
        XTables {
            kinds: [
                pairs(&|a, k| product(&n[a], &n[k])),
                pairs(&|a, k| product(&d[a], &d[k])),
                pairs(&|a, k| product(&d[a], &n[k])),
                pairs(&|a, k| product(&n[a], &d[k])),
            ],
        }
    }
}

impl YTables {
    pub(super) fn of(axis: &AxisTables, segment: usize) -> YTables {
        let (m, d) = (&axis.values[segment], &axis.slopes[segment]);
        let width = m.len();
        let table = |left: &Vec<[f64; 8]>, right: &Vec<[f64; 8]>| {
            let mut out = [[0.0; 16]; 8];
            for b in 0..width {
                for l in 0..width {
                    for (power, value) in product(&left[b], &right[l]).into_iter().enumerate() {
                        out[power][b * width + l] = value;
                    }
                }
            }
            out
        };
        YTables { kinds: [table(m, m), table(d, d), table(m, d), table(d, m)] }
    }
}

/// The products of weights in the normal matrix: `wz^2, a^2, a b, b^2 + d^2`.
pub(super) fn squares_of(m: SiteWeights) -> [f64; 4] {
    [m.z * m.z, m.a * m.a, m.a * m.b, m.b * m.b + m.d * m.d]
}

/// The x tables of one stripe, multiplied by uniform row weights.
#[derive(Debug, Default)]
pub(super) struct Combined {
    pub values: Vec<[f64; 8]>,
    pub across: Vec<[f64; 8]>,
    pub coupling: [Vec<[f64; 8]>; 2],
    pub coupled: bool,
}

impl Combined {
    pub(super) fn take_in(&mut self, x: &XTables, [zz, aa, ab, dd]: [f64; 4]) {
        let set = |target: &mut Vec<[f64; 8]>, table: &[[f64; 8]], w: f64| {
            target.clear();
            target.extend(table.iter().map(|row| row.map(|v| w * v)));
        };
        set(&mut self.values, &x.kinds[0], zz);
        for (row, slopes) in self.values.iter_mut().zip(&x.kinds[1]) {
            row.iter_mut().zip(slopes).for_each(|(v, d)| *v += aa * d);
        }
        set(&mut self.across, &x.kinds[0], dd);
        self.coupled = ab != 0.0;
        if self.coupled {
            set(&mut self.coupling[0], &x.kinds[2], ab);
            set(&mut self.coupling[1], &x.kinds[3], ab);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_recurrences_give_the_same_powers() {
        for degree in 1..=3 {
            let uniform = Knots::uniform(degree, 9, -1.0, 0.7).unwrap();
            let mut uneven = vec![0.0; degree + 1];
            uneven.extend([0.1, 0.15]);
            uneven.extend(vec![0.6; degree.min(2)]);
            uneven.extend(vec![1.0; degree + 1]);
            for knots in [uniform, Knots::new(degree, uneven).unwrap()] {
                let (usual, nearest) = (AxisTables::new(&knots), AxisTables::nearest(&knots));
                for (a, b) in usual.values.iter().flatten().flatten().zip(nearest.values.iter().flatten().flatten()) {
                    assert!((a - b).abs() < 1e-14, "degree {degree}: {a} {b}");
                }
                // they sum to one, but for the roundings of this sum
                for functions in &nearest.values {
                    for power in 0..=degree {
                        let sum: f64 = functions.iter().map(|f| f[power]).sum();
                        let expected = if power == 0 { 1.0 } else { 0.0 };
                        assert!((sum - expected).abs() < 4.0 * f64::EPSILON, "{sum}");
                    }
                }
            }
        }
    }
}
