//! Normal rows in 32 digits: the stationary point that belongs to an answer.
//!
//! ```text
//! E'W r = 0,   r = (z - S, n - n^(S_x, S_y)),   E the derivative of (S, n^)          n^ = (-p, -q, 1)/sqrt(1 + p^2 + q^2)
//! c <- c + t (E_0'W E_0)^-1 E'W r,   E_0 that of the answer: with t = 1 the same contraction as Gauss-Newton's
//! t = 1, 1/2, 1/4, ..               the first whose steps do not run away
//! ```

use palpate::{Contacts, Orientation};
use palpate_numeric::linalg::DoubleDouble as Dd;

use super::least_squares::{Factor, Rows, dot};
use super::oracle::{Grid, Solved, Written, products};

/// Steps at most; each is a third of the last where normals are poor.
const MAX_STEPS: usize = 200;
/// A step below this share of the largest coefficient is far below the last digit of a double.
const STILL: f64 = 1e-22;

/// Full steps overshoot where the objective bends more than its linearised rows, and then run away from a minimum however near
/// to it they begin. A smaller share of them comes to rest there.
const HALVINGS: i32 = 6;
/// Growth of the steps, over the first, that is a run-away.
const GROWN: f64 = 10.0;

/// Heights and normals of known noise.
pub(super) struct NormalRows<'a> {
    pub written: &'a Written<'a>,
    /// Inverse sds of heights and of normals (per radian).
    pub weights: [Dd; 2],
}

/// What does not change from step to step.
struct Touch {
    height: Vec<Dd>,
    slopes: [Vec<Dd>; 2],
    z: Dd,
    normal: [Dd; 3],
}

impl NormalRows<'_> {
    /// From the answer under test; `None` where the steps do not settle or the rows are not of full rank.
    pub(super) fn solve(&self, start: &[f64], grid: &Grid) -> Option<Solved> {
        let touches = self.touches()?;
        let start: Vec<Dd> = start.iter().map(|&v| Dd::new(v)).collect();
        let factor = Factor::new(self.rows(&touches, &start))?;
        let mut shares = (0..HALVINGS).map(|k| 0.5_f64.powi(k));
        let beside = shares.find_map(|share| self.settled(&touches, &factor, &start, share, GROWN));
        // an answer beside no stationary point is held against the one that full steps lead to
        let found = beside.or_else(|| self.settled(&touches, &factor, &start, 1.0, f64::INFINITY))?;
        Some(self.written.solved(&found, grid))
    }

    /// Where shares of full steps come to rest; `None` where they do not, or grow to `most` times the first.
    fn settled(&self, touches: &[Touch], factor: &Factor, start: &[Dd], share: f64, most: f64) -> Option<Vec<Dd>> {
        let mut c = start.to_vec();
        let (mut first, mut last) = (None, f64::INFINITY);
        for _ in 0..(MAX_STEPS as f64 / share) as usize {
            let step = factor.normal_solution(&self.descent(touches, &c));
            let largest = c.iter().fold(0.0_f64, |m, v| m.max(v.to_f64().abs()));
            let moved = step.iter().fold(0.0_f64, |m, v| m.max(v.to_f64().abs())) / largest;
            let first = *first.get_or_insert(moved);
            if moved.is_nan() || moved > 1e3 * last.min(1.0) || moved > most * first {
                return None;
            }
            c.iter_mut().zip(&step).for_each(|(c, &d)| *c = *c + Dd::new(share) * d);
            if moved < STILL {
                return Some(c);
            }
            last = moved;
        }
        None
    }

    fn touches(&self) -> Option<Vec<Touch>> {
        let Contacts { x, y, z, orientation: Orientation::Normals { nx, ny, nz }, .. } = self.written.contacts else {
            return None;
        };
        let touch = |r: usize| {
            let [n, m] = self.written.basis_at(Dd::new(x[r]), Dd::new(y[r]));
            let normal = [nx[r], ny[r], nz[r]].map(Dd::new);
            let length = dot(&normal, &normal).sqrt();
            Touch {
                height: products(&n[0], &m[0]),
                slopes: [products(&n[1], &m[0]), products(&n[0], &m[1])],
                z: Dd::new(z[r]),
                normal: normal.map(|v| v / length),
            }
        };
        Some((0..x.len()).map(touch).collect())
    }

    fn rows(&self, touches: &[Touch], c: &[Dd]) -> Rows {
        let mut rows = Rows::new(c.len());
        for touch in touches {
            rows.push(self.weights[0], &touch.height, touch.z);
            let (_, turned) = touch.residual(c);
            for k in 0..3 {
                let of = |(&a, &b): (&Dd, &Dd)| a * turned[0][k] + b * turned[1][k];
                let entries: Vec<Dd> = touch.slopes[0].iter().zip(&touch.slopes[1]).map(of).collect();
                rows.push(self.weights[1], &entries, Dd::ZERO);
            }
        }
        rows
    }

    /// `E'W r`.
    fn descent(&self, touches: &[Touch], c: &[Dd]) -> Vec<Dd> {
        let [wz, w] = self.weights.map(|w| w * w);
        let mut sum = vec![Dd::ZERO; c.len()];
        for touch in touches {
            let of_height = wz * (touch.z - dot(&touch.height, c));
            let (residual, turned) = touch.residual(c);
            let [p, q] = turned.map(|along| w * dot(&along, &residual));
            for (u, sum) in sum.iter_mut().enumerate() {
                *sum = *sum + of_height * touch.height[u] + p * touch.slopes[0][u] + q * touch.slopes[1][u];
            }
        }
        sum
    }
}

impl Touch {
    /// `n - n^`, and the derivatives of `n^` by both slopes.
    fn residual(&self, c: &[Dd]) -> ([Dd; 3], [[Dd; 3]; 2]) {
        let slopes = [dot(&self.slopes[0], c), dot(&self.slopes[1], c)];
        let v = [-slopes[0], -slopes[1], Dd::ONE];
        let length = dot(&v, &v).sqrt();
        let unit = v.map(|v| v / length);
        let residual = [0, 1, 2].map(|k| self.normal[k] - unit[k]);
        // d(v/|v|) = dv/|v| - v (v.dv)/|v|^3, and v.dv = p dp
        let turned = [0, 1].map(|axis| {
            let shrink = slopes[axis] / (length * length);
            [0, 1, 2].map(|k| {
                let own = if k == axis { Dd::ONE / length } else { Dd::ZERO };
                -own - unit[k] * shrink
            })
        });
        (residual, turned)
    }
}
