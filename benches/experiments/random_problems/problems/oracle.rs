//! The written problem in 32 digits, by a route of its own: basis, rows, QR, shape.
//!
//! ```text
//! min sum wz^2 (z - S)^2 + wx^2 (zx - S_x)^2 + wy^2 (zy - S_y)^2 + lambda integral (S_xx^2 + 2 S_xy^2 + S_yy^2)
//! ```
//!
//! The integral is a sum over Gauss's points of every knot cell, which is exact, so the penalty is rows like the others.

use palpate::spline::Knots;
use palpate::{Contacts, Orientation};
use palpate_laboratory::hard_cases::digits_absolute;
use palpate_numeric::linalg::DoubleDouble as Dd;

use super::basis::{basis, gauss};
use super::least_squares::{Factor, Rows, dot};

/// Weighted slope rows, and a roughness penalty, on given knots.
pub(crate) struct Written<'a> {
    pub contacts: &'a Contacts,
    pub degree: [usize; 2],
    pub knots: &'a [Knots; 2],
    /// Weights of every contact's rows in input units.
    pub weights: Vec<[Dd; 3]>,
    pub lambda: Dd,
}

/// x and y of the grid's points, `None` where nothing is compared.
pub(crate) type Grid = [Vec<Option<Dd>>; 2];

/// Coefficients, and S and R at grid points, NaN where nothing is compared.
pub(crate) struct Solved {
    pub coefficients: Vec<Dd>,
    pub shape_index: Vec<f64>,
    pub curvedness: Vec<f64>,
}

impl Written<'_> {
    /// `None` where the problem is not of full rank.
    pub(crate) fn solve(&self, grid: &Grid) -> Option<Solved> {
        let c = Factor::new(self.rows())?.solution();
        Some(self.solved(&c, grid))
    }

    /// The shape of these coefficients.
    pub(super) fn solved(&self, c: &[Dd], grid: &Grid) -> Solved {
        let mut solved = Solved { coefficients: Vec::new(), shape_index: Vec::new(), curvedness: Vec::new() };
        for &x in &grid[0] {
            for &y in &grid[1] {
                let at = x.zip(y).map(|(x, y)| shape(&self.partials(c, x, y)));
                let (s, r) = at.unwrap_or((f64::NAN, f64::NAN));
                solved.shape_index.push(s);
                solved.curvedness.push(r);
            }
        }
        solved.coefficients = c.to_vec();
        solved
    }

    pub(super) fn unknowns(&self) -> usize {
        [0, 1].iter().map(|&k| self.knots[k].as_slice().len() - self.degree[k] - 1).product()
    }

    /// All rows: data, then roughness.
    pub(super) fn rows(&self) -> Rows {
        let mut rows = self.data_rows();
        if self.lambda != Dd::ZERO {
            let root = self.lambda.sqrt();
            self.each_rough_row(|weight, entries| rows.push(root * weight, entries, Dd::ZERO));
        }
        rows
    }

    /// Rows of the data.
    pub(super) fn data_rows(&self) -> Rows {
        let (data, mut rows) = (self.contacts, Rows::new(self.unknowns()));
        for r in 0..data.len() {
            let [n, m] = self.basis_at(Dd::new(data.x[r]), Dd::new(data.y[r]));
            let [wz, wx, wy] = self.weights[r];
            rows.push(wz, &products(&n[0], &m[0]), Dd::new(data.z[r]));
            if let Orientation::Slopes { zx, zy } = &data.orientation {
                rows.push(wx, &products(&n[1], &m[0]), Dd::new(zx[r]));
                rows.push(wy, &products(&n[0], &m[1]), Dd::new(zy[r]));
            }
        }
        rows
    }

    /// Calls `visit(root of Gauss's weight, row)` for the rows whose sum of squares is the roughness.
    pub(super) fn each_rough_row(&self, mut visit: impl FnMut(Dd, &[Dd])) {
        let points = [0, 1].map(|k| places(self.knots[k].as_slice(), &gauss(self.degree[k] + 1)));
        for &(x, wx) in &points[0] {
            for &(y, wy) in &points[1] {
                let [n, m] = self.basis_at(x, y);
                let root = (wx * wy).sqrt();
                visit(root, &products(&n[2], &m[0]));
                visit(Dd::new(2.0).sqrt() * root, &products(&n[1], &m[1]));
                visit(root, &products(&n[0], &m[2]));
            }
        }
    }

    pub(super) fn basis_at(&self, x: Dd, y: Dd) -> [[Vec<Dd>; 3]; 2] {
        [basis(self.knots[0].as_slice(), self.degree[0], x), basis(self.knots[1].as_slice(), self.degree[1], y)]
    }

    /// `[S_x, S_y, S_xx, S_xy, S_yy]`.
    fn partials(&self, c: &[Dd], x: Dd, y: Dd) -> [Dd; 5] {
        let [n, m] = self.basis_at(x, y);
        [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2)].map(|(dx, dy)| dot(&products(&n[dx], &m[dy]), c))
    }
}

impl Solved {
    /// `-log10` of the worst error over the largest coefficient.
    pub(crate) fn digits_of_coefficients(&self, found: &[f64]) -> f64 {
        if found.len() != self.coefficients.len() {
            return 0.0;
        }
        let errors = found.iter().zip(&self.coefficients).map(|(&f, &c)| (Dd::new(f) - c).to_f64().abs());
        // the largest of numbers some of which may be none is none
        let worst = errors.fold(0.0_f64, |m, e| if e.is_nan() { f64::NAN } else { m.max(e) });
        let size = self.coefficients.iter().fold(0.0_f64, |m, c| m.max(c.to_f64().abs()));
        digits_absolute((worst / size).max(f64::EPSILON / 2.0))
    }
}

/// `n (x) m`, number `i m + j`.
pub(super) fn products(n: &[Dd], m: &[Dd]) -> Vec<Dd> {
    n.iter().flat_map(|&a| m.iter().map(move |&b| a * b)).collect()
}

/// Gauss's points of every cell that is not empty.
fn places(knots: &[f64], gauss: &[(Dd, Dd)]) -> Vec<(Dd, Dd)> {
    let half = Dd::new(0.5);
    let cells = knots.windows(2).filter(|cell| cell[1] > cell[0]);
    cells
        .flat_map(|cell| {
            let [lo, hi] = [Dd::new(cell[0]), Dd::new(cell[1])];
            gauss.iter().map(move |&(t, w)| (half * (lo + hi) + half * (hi - lo) * t, half * (hi - lo) * w))
        })
        .collect()
}

fn shape(&[zx, zy, zxx, zxy, zyy]: &[Dd; 5]) -> (f64, f64) {
    let (ex, ey) = (Dd::ONE + zx * zx, Dd::ONE + zy * zy);
    let w2 = Dd::ONE + zx * zx + zy * zy;
    let cross = zx * zy * zxy;
    let mean = (ey * zxx - cross - cross + ex * zyy) / ((w2 + w2) * w2.sqrt());
    let half_gap = (mean * mean - (zxx * zyy - zxy * zxy) / (w2 * w2)).sqrt();
    let (mean, half_gap) = (mean.to_f64(), half_gap.to_f64());
    (-std::f64::consts::FRAC_2_PI * mean.atan2(half_gap), mean.hypot(half_gap))
}

/// Grid points not rounded to the input's own ulp: far from the origin that would be another place. `None` for a point that
/// meets a knot to rounding without being that knot: derivatives may jump there, and either side is right.
pub(crate) fn grid_of([x0, x1, y0, y1]: [f64; 4], points: usize, knots: &[Knots; 2]) -> Grid {
    let axis = |low: f64, high: f64, knots: &Knots| -> Vec<Option<Dd>> {
        let step = (Dd::new(high) - Dd::new(low)) / Dd::new((points - 1) as f64);
        let near = 8.0 * f64::EPSILON * low.abs().max(high.abs());
        let place = |i: usize| {
            let place = Dd::new(low) + Dd::new(i as f64) * step;
            let off = |t: f64| (place - Dd::new(t)).to_f64().abs();
            let is_beside = |t: f64| off(t) > 0.0 && off(t) <= near;
            if knots.as_slice().iter().any(|&t| is_beside(t)) { None } else { Some(place) }
        };
        (0..points).map(place).collect()
    };
    [axis(x0, x1, &knots[0]), axis(y0, y1, &knots[1])]
}
