//! The objective, its Gauss-Newton matrix and its gradient.
//!
//! ```text
//! F(c) = sum_r (n^ . (P_r - Q(u_r)))^2 / Z^2 + |n_r - n^|^2 / sigma^2
//!        + lambda E(c) + tau T(c) + (alpha / g) sum_r |P_r - Q(u_r0)|^2
//! u_r  the foot of P_r on Q, so the distance is orthogonal;   n^ = Q_u x Q_v / |Q_u x Q_v| there
//! ```
//!
//! The maximum likelihood for isotropic errors of points and normals. The last two terms only say which (u, v) is meant:
//! T alone leaves every affine change of them free, so the contacts are loosely tied to where they were flattened, u_r0. At a foot the residual's derivative by u_r vanishes,
//! so each contact has three rows that all point along n^ (Kronecker factors `n^ (x) s`):
//!
//! ```text
//! distance  s = N o M / Z          normal  s = -(g^ab Q_b . e_k) (N o M)_a / sigma,   e_1, e_2 tangents
//! ```

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

/// Frame of the surface at a contact.
struct Tangents {
    point: Vector,
    normal: Vector,
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
    Some(Tangents { point, normal, frame: [e1, e2], dual })
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
            sums.tie += dot(off, off) / feet.places.len() as f64;
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
        let mut products: [Vec<f64>; 3] = Default::default();
        for (out, order) in products.iter_mut().zip([(0, 0), (1, 0), (0, 1)]) {
            row.products(order, out);
        }
        let mut scaled = vec![0.0; products[0].len()];
        if parts.position {
            let weight = self.touches.position_weight[r] / self.weights.position;
            scaled.iter_mut().zip(&products[0]).for_each(|(s, v)| *s = weight * v);
            local.add(&scaled, t.normal, weight * dot(t.normal, minus(self.touches.points[r], t.point)));
        }
        if parts.normal {
            let weight = self.touches.normal_weight[r] / self.weights.normal;
            for k in 0..2 {
                let [a, b] = [-weight * t.dual[0][k], -weight * t.dual[1][k]];
                for (s, (u, v)) in scaled.iter_mut().zip(products[1].iter().zip(&products[2])) {
                    *s = a * u + b * v;
                }
                local.add(&scaled, t.normal, weight * dot(t.frame[k], self.touches.normals[r]));
            }
        }
    }

    fn add_ties(&self, c: &[Vector], matrix: &mut BlockMatrix, rhs: &mut [f64]) {
        let weight = self.weights.tie / self.flattened.len() as f64;
        let (mut alive, mut products) = (Vec::new(), Vec::new());
        for (place, point) in self.flattened.iter().zip(&self.touches.points) {
            let row = self.cells.row(place[0], place[1]);
            let off = minus(*point, self.cells.derivative(&row, c, (0, 0)));
            self.cells.alive(&row, &mut alive);
            row.products((0, 0), &mut products);
            for (a, &i) in alive.iter().enumerate() {
                (0..3).for_each(|d| rhs[3 * i + d] += weight * products[a] * off[d]);
                for (b, &j) in alive[..=a].iter().enumerate() {
                    let v = weight * products[a] * products[b];
                    matrix.add(i.max(j), i.min(j), &[[v, 0.0, 0.0], [0.0, v, 0.0], [0.0, 0.0, v]]);
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

/// Sums of `(s s') (x) (n n')` over one cell's contacts.
struct LocalNormals {
    alive: Vec<usize>,
    blocks: Vec<[f64; 6]>,
    right: Vec<Vector>,
}

impl LocalNormals {
    fn new(local: usize) -> LocalNormals {
        let blocks = vec![[0.0; 6]; local * (local + 1) / 2];
        LocalNormals { alive: Vec::new(), blocks, right: vec![[0.0; 3]; local] }
    }

    fn clear(&mut self) {
        self.blocks.fill([0.0; 6]);
        self.right.fill([0.0; 3]);
    }

    fn add(&mut self, s: &[f64], n: Vector, residual: f64) {
        let outer = [n[0] * n[0], n[1] * n[0], n[1] * n[1], n[2] * n[0], n[2] * n[1], n[2] * n[2]];
        for alpha in 0..s.len() {
            (0..3).for_each(|d| self.right[alpha][d] += s[alpha] * residual * n[d]);
            let row = &mut self.blocks[alpha * (alpha + 1) / 2..][..=alpha];
            for (block, other) in row.iter_mut().zip(s) {
                let product = s[alpha] * other;
                (0..6).for_each(|k| block[k] += product * outer[k]);
            }
        }
    }

    fn scatter(&self, matrix: &mut BlockMatrix, rhs: &mut [f64]) {
        for (alpha, &row) in self.alive.iter().enumerate() {
            (0..3).for_each(|d| rhs[3 * row + d] += self.right[alpha][d]);
            for (beta, &column) in self.alive[..=alpha].iter().enumerate() {
                let [xx, xy, yy, xz, yz, zz] = self.blocks[alpha * (alpha + 1) / 2 + beta];
                // symmetric blocks: the transposed pair is the same
                matrix.add(row.max(column), row.min(column), &[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
            }
        }
    }
}
