//! The objective, its Gauss-Newton matrix and its gradient.
//!
//! ```text
//! F(c) = sum_r (n^ . (P_r - Q(u_r)))^2 / Z^2 + |n_r - n^|^2 / sigma^2
//!        + lambda E(c) + tau T(c) + (alpha / g) sum_r |(P_r - Q(u_r0))^t|^2          ^t: across n_r
//! u_r  the foot of P_r on Q, so the distance is orthogonal;   n^ = Q_u x Q_v / |Q_u x Q_v| there
//! ```
//!
//! The maximum likelihood for isotropic errors of points and normals. The last two terms only say which (u, v) is meant:
//! T alone leaves every affine change of them free, so the contacts are loosely tied to where they were flattened, u_r0.
//! A change dQ of the surface moves the foot, `M du = (-Q_a . dQ + d n . dQ_a)_a`, `M_ab = g_ab - d h_ab`, d the distance.
//! The distance does not feel that, the normal does; e_1, e_2 being orthonormal tangents, D_ak = g^ab Q_b . e_k:
//!
//! ```text
//! distance   n . dQ / Z              turn_k   -(D_ak n . dQ_a + H_kb du_b) / sigma,   H_kb = D_ak h_ab
//! ```
//!
//! With it a mere change of (u, v) has no rows at all, and Gauss-Newton converges as if it were not there.

use super::cells::{Cells, Row};
use super::fairness::{INPUTS, ORDERS, RESIDUALS, ThirdJet, residuals};
use super::foot::Feet;
use super::quadrature::GaussPoint;
use super::touches::Touches;
use super::vector::{Vector, cross, dot, minus, norm};
use crate::linalg::BlockMatrix;

/// Weights of the four parts of the objective, patch units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Sd Z of a position.
    pub position: f64,
    /// Sd sigma of a normal per tangent axis, radians.
    pub normal: f64,
    /// lambda of E.
    pub fairness: f64,
    /// tau of T.
    pub slack: f64,
    /// alpha, of the ties to the flattened places.
    pub tie: f64,
}

/// What is minimised, at given weights.
pub struct Problem<'a> {
    /// Knots and numbering.
    pub cells: &'a Cells,
    /// Data.
    pub touches: &'a Touches,
    /// Where the contacts were flattened to.
    pub flattened: &'a [[f64; 2]],
    /// Rule for E and T.
    pub gauss: &'a [GaussPoint],
    /// Weights.
    pub weights: Weights,
}

/// The parts of F, unweighted sums.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sums {
    /// Squared distances, with the contacts' own weights.
    pub position: f64,
    /// Squared differences of normals.
    pub normal: f64,
    /// E.
    pub fairness: f64,
    /// T.
    pub slack: f64,
    /// Mean square distance to the flattened places.
    pub tie: f64,
}

/// Which parts enter a matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// Distances.
    pub position: bool,
    /// Normals.
    pub normal: bool,
    /// E.
    pub fairness: bool,
    /// T and the ties.
    pub slack: bool,
}

impl Parts {
    /// Everything.
    pub const ALL: Parts = Parts { position: true, normal: true, fairness: true, slack: true };
    /// Nothing.
    pub const NONE: Parts = Parts { position: false, normal: false, fairness: false, slack: false };
}

/// A foot further than this from the contact's normal plane, patch units, has met the end of its range.
const HELD: f64 = 1e-7;

/// Frame of the surface at a contact.
struct Tangents {
    point: Vector,
    normal: Vector,
    /// Q_u, Q_v.
    along: [Vector; 2],
    /// e_1, e_2.
    frame: [Vector; 2],
    /// `g^ab Q_b . e_k`, [a][k].
    dual: [[f64; 2]; 2],
}

fn tangents(cells: &Cells, row: &Row, c: &[Vector]) -> Option<Tangents> {
    let [point, qu, qv] = [(0, 0), (1, 0), (0, 1)].map(|order| cells.derivative(row, c, order));
    let area = cross(qu, qv);
    let (jacobian, length) = (norm(area), norm(qu));
    if !(jacobian > 0.0 && jacobian.is_finite() && length > 0.0) {
        return None;
    }
    let normal = area.map(|a| a / jacobian);
    let e1 = qu.map(|a| a / length);
    let e2 = cross(normal, e1);
    // Q_u = l e1, Q_v = s e1 + t e2: the dual basis is (e1 - (s/t) e2)/l and e2/t
    let (shear, height) = (dot(qv, e1), jacobian / length);
    let dual = [[1.0 / length, -shear / (height * length)], [0.0, 1.0 / height]];
    Some(Tangents { point, normal, along: [qu, qv], frame: [e1, e2], dual })
}

/// `V_ka = H_kb (M^-1)_ba`: turn of the normal by what moves the foot; zero where the foot was held back from its place.
fn foot_turn(cells: &Cells, row: &Row, c: &[Vector], t: &Tangents, off: Vector) -> [[f64; 2]; 2] {
    let distance = dot(t.normal, off);
    let aside = t.frame.map(|e| dot(e, off));
    if aside[0].hypot(aside[1]) > HELD {
        return [[0.0; 2]; 2];
    }
    let [huu, huv, hvv] = [(2, 0), (1, 1), (0, 2)].map(|order| dot(t.normal, cells.derivative(row, c, order)));
    let h = [[huu, huv], [huv, hvv]];
    let m = |a: usize, b: usize| dot(t.along[a], t.along[b]) - distance * h[a][b];
    let (m00, m01, m11) = (m(0, 0), m(0, 1), m(1, 1));
    let det = m00 * m11 - m01 * m01;
    if det.is_nan() || det <= 0.0 {
        return [[0.0; 2]; 2];
    }
    [0, 1].map(|k| {
        let [p, q] = [0, 1].map(|b| t.dual[0][k] * h[0][b] + t.dual[1][k] * h[1][b]);
        [(p * m11 - q * m01) / det, (q * m00 - p * m01) / det]
    })
}

impl Problem<'_> {
    /// F and its parts at these coefficients and feet; `None` where the map has no tangent plane.
    pub fn value(&self, c: &[Vector], feet: &Feet) -> Option<(f64, Sums)> {
        let mut sums = Sums::default();
        for (r, foot) in feet.places.iter().enumerate() {
            let t = tangents(self.cells, &self.cells.row(foot[0], foot[1]), c)?;
            let (wp, wn) = (self.touches.position_weight[r], self.touches.normal_weight[r]);
            let distance = wp * dot(t.normal, minus(self.touches.points[r], t.point));
            let turn = minus(self.touches.normals[r], t.normal);
            sums.position += distance * distance;
            sums.normal += wn * wn * dot(turn, turn);
            let tied = self.flattened[r];
            let off =
                minus(self.touches.points[r], self.cells.derivative(&self.cells.row(tied[0], tied[1]), c, (0, 0)));
            let lift = dot(off, self.touches.normals[r]);
            sums.tie += (dot(off, off) - lift * lift) / feet.places.len() as f64;
        }
        for point in self.gauss {
            let values = residuals(&self.jet(point, c))?;
            let part = |range: std::ops::Range<usize>| values[range].iter().map(|v| v.value * v.value).sum::<f64>();
            sums.fairness += point.weight * part(0..4);
            sums.slack += point.weight * part(4..RESIDUALS);
        }
        let value = self.total(&sums);
        value.is_finite().then_some((value, sums))
    }

    /// Distance and turn of the normal of every contact, without weights.
    pub fn residuals(&self, c: &[Vector], feet: &Feet) -> Vec<[f64; 2]> {
        let of = |(r, place): (usize, &[f64; 2])| {
            let t = tangents(self.cells, &self.cells.row(place[0], place[1]), c)?;
            let turn = norm(minus(self.touches.normals[r], t.normal));
            Some([dot(t.normal, minus(self.touches.points[r], t.point)), turn])
        };
        feet.places.iter().enumerate().map(|at| of(at).unwrap_or([f64::INFINITY; 2])).collect()
    }

    fn total(&self, s: &Sums) -> f64 {
        let w = &self.weights;
        s.position / (w.position * w.position)
            + s.normal / (w.normal * w.normal)
            + w.fairness * s.fairness
            + w.slack * s.slack
            + w.tie * s.tie
    }

    fn jet(&self, point: &GaussPoint, c: &[Vector]) -> ThirdJet {
        ORDERS.map(|order| self.cells.derivative(&point.row, c, order))
    }

    /// Adds the Gauss-Newton matrix of `parts` to `matrix` and `-1/2` the gradient to `rhs`.
    pub fn assemble(&self, c: &[Vector], feet: &Feet, parts: Parts, matrix: &mut BlockMatrix, rhs: &mut [f64]) {
        if parts.position || parts.normal {
            self.add_contacts(c, feet, parts, matrix, rhs);
        }
        let fairness = if parts.fairness { self.weights.fairness } else { 0.0 };
        let slack = if parts.slack { self.weights.slack } else { 0.0 };
        if parts.slack && self.weights.tie > 0.0 {
            self.add_ties(c, matrix, rhs);
        }
        if fairness > 0.0 || slack > 0.0 {
            self.add_fairness(c, [fairness, slack], matrix, rhs);
        }
    }

    fn add_contacts(&self, c: &[Vector], feet: &Feet, parts: Parts, matrix: &mut BlockMatrix, rhs: &mut [f64]) {
        let rows: Vec<Row> = feet.places.iter().map(|p| self.cells.row(p[0], p[1])).collect();
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by_key(|&r| rows[r].cell);
        let mut local = LocalNormals::new(self.cells.local());
        for group in order.chunk_by(|a, b| rows[*a].cell == rows[*b].cell) {
            local.clear();
            self.cells.alive(&rows[group[0]], &mut local.alive);
            for &r in group {
                self.add_contact(r, &rows[r], c, parts, &mut local);
            }
            local.scatter(matrix, rhs);
        }
    }

    fn add_contact(&self, r: usize, row: &Row, c: &[Vector], parts: Parts, local: &mut LocalNormals) {
        let Some(t) = tangents(self.cells, row, c) else { return };
        let off = minus(self.touches.points[r], t.point);
        for (out, order) in local.products.iter_mut().zip([(0, 0), (1, 0), (0, 1)]) {
            row.products(order, out);
        }
        let mut scaled = std::mem::take(&mut local.row);
        if parts.position {
            let weight = self.touches.position_weight[r] / self.weights.position;
            let n = t.normal.map(|n| weight * n);
            for (s, b) in scaled.chunks_exact_mut(3).zip(&local.products[0]) {
                (0..3).for_each(|d| s[d] = n[d] * b);
            }
            local.add(&scaled, dot(n, off));
        }
        if parts.normal {
            let weight = self.touches.normal_weight[r] / self.weights.normal;
            let turn = foot_turn(self.cells, row, c, &t, off);
            let distance = dot(t.normal, off);
            for k in 0..2 {
                let moved: Vector =
                    [0, 1, 2].map(|d| weight * (turn[k][0] * t.along[0][d] + turn[k][1] * t.along[1][d]));
                let [a, b] = [0, 1].map(|a| -weight * (t.dual[a][k] + distance * turn[k][a]));
                let (q, [u, v]) = (&local.products[0], [&local.products[1], &local.products[2]]);
                for (alpha, s) in scaled.chunks_exact_mut(3).enumerate() {
                    let bent = a * u[alpha] + b * v[alpha];
                    (0..3).for_each(|d| s[d] = moved[d] * q[alpha] + bent * t.normal[d]);
                }
                local.add(&scaled, weight * dot(t.frame[k], self.touches.normals[r]));
            }
        }
        local.row = scaled;
    }

    fn add_ties(&self, c: &[Vector], matrix: &mut BlockMatrix, rhs: &mut [f64]) {
        let weight = self.weights.tie / self.flattened.len() as f64;
        let (mut alive, mut products) = (Vec::new(), Vec::new());
        for (r, place) in self.flattened.iter().enumerate() {
            let row = self.cells.row(place[0], place[1]);
            let (n, off) =
                (self.touches.normals[r], minus(self.touches.points[r], self.cells.derivative(&row, c, (0, 0))));
            let lift = dot(n, off);
            let across = [0, 1, 2].map(|a| [0, 1, 2].map(|b| f64::from(u8::from(a == b)) - n[a] * n[b]));
            self.cells.alive(&row, &mut alive);
            row.products((0, 0), &mut products);
            for (a, &i) in alive.iter().enumerate() {
                (0..3).for_each(|d| rhs[3 * i + d] += weight * products[a] * (off[d] - lift * n[d]));
                for (b, &j) in alive[..=a].iter().enumerate() {
                    let v = weight * products[a] * products[b];
                    matrix.add(i.max(j), i.min(j), &across.map(|line| line.map(|w| v * w)));
                }
            }
        }
    }

    fn add_fairness(&self, c: &[Vector], weights: [f64; 2], matrix: &mut BlockMatrix, rhs: &mut [f64]) {
        let width = 3 * self.cells.local();
        let (mut local, mut alive, mut products) = (vec![0.0; width * width], Vec::new(), Vec::new());
        let mut right = vec![0.0; width];
        let mut rows = vec![0.0; RESIDUALS * width];
        for group in self.gauss_by_cell() {
            local.fill(0.0);
            right.fill(0.0);
            self.cells.alive(&group[0].row, &mut alive);
            for point in &group {
                let Some(values) = residuals(&self.jet(point, c)) else { continue };
                rows.fill(0.0);
                for (k, order) in ORDERS.iter().enumerate() {
                    point.row.products(*order, &mut products);
                    for (r, value) in values.iter().enumerate() {
                        let slope = &value.slope[3 * k..3 * k + 3];
                        for (alpha, product) in products.iter().enumerate() {
                            (0..3).for_each(|d| rows[r * width + 3 * alpha + d] += slope[d] * product);
                        }
                    }
                }
                for (r, value) in values.iter().enumerate() {
                    let weight = point.weight * weights[usize::from(r >= 4)];
                    rank_one(&mut local, &mut right, &rows[r * width..(r + 1) * width], weight, -value.value);
                }
            }
            scatter_full(&local, &right, &alive, matrix, rhs);
        }
    }

    fn gauss_by_cell(&self) -> Vec<Vec<&GaussPoint>> {
        let mut order: Vec<&GaussPoint> = self.gauss.iter().collect();
        order.sort_by_key(|p| p.row.cell);
        order.chunk_by(|a, b| a.row.cell == b.row.cell).map(<[&GaussPoint]>::to_vec).collect()
    }
}

const _: () = assert!(INPUTS == 3 * ORDERS.len());

/// `A += w s s'`, `b += w s target`, lower triangle.
fn rank_one(matrix: &mut [f64], right: &mut [f64], s: &[f64], weight: f64, target: f64) {
    let width = s.len();
    for i in 0..width {
        let scaled = weight * s[i];
        right[i] += scaled * target;
        for (m, v) in matrix[i * width..=i * width + i].iter_mut().zip(s) {
            *m += scaled * v;
        }
    }
}

fn scatter_full(local: &[f64], right: &[f64], alive: &[usize], matrix: &mut BlockMatrix, rhs: &mut [f64]) {
    let width = right.len();
    for (alpha, &row) in alive.iter().enumerate() {
        (0..3).for_each(|d| rhs[3 * row + d] += right[3 * alpha + d]);
        for (beta, &column) in alive[..=alpha].iter().enumerate() {
            let at = |a: usize, b: usize| {
                let (i, j) = (3 * alpha + a, 3 * beta + b);
                local[i.max(j) * width + i.min(j)]
            };
            if column <= row {
                matrix.add(row, column, &[0, 1, 2].map(|a| [0, 1, 2].map(|b| at(a, b))));
            } else {
                matrix.add(column, row, &[0, 1, 2].map(|a| [0, 1, 2].map(|b| at(b, a))));
            }
        }
    }
}

/// Sums of rows over one cell's contacts, and the buffers they are made in.
struct LocalNormals {
    alive: Vec<usize>,
    products: [Vec<f64>; 3],
    row: Vec<f64>,
    matrix: Vec<f64>,
    right: Vec<f64>,
}

impl LocalNormals {
    fn new(local: usize) -> LocalNormals {
        let width = 3 * local;
        LocalNormals {
            alive: Vec::new(),
            products: Default::default(),
            row: vec![0.0; width],
            matrix: vec![0.0; width * width],
            right: vec![0.0; width],
        }
    }

    fn clear(&mut self) {
        self.matrix.fill(0.0);
        self.right.fill(0.0);
    }

    fn add(&mut self, row: &[f64], residual: f64) {
        rank_one(&mut self.matrix, &mut self.right, row, 1.0, residual);
    }

    fn scatter(&self, matrix: &mut BlockMatrix, rhs: &mut [f64]) {
        scatter_full(&self.matrix, &self.right, &self.alive, matrix, rhs);
    }
}
