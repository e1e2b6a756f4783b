//! The objective, its Gauss-Newton matrix and its gradient.
//!
//! ```text
//! F(c) = sum_r (n^ . (P_r - Q(u_r)))^2 / Z^2 + |n_r - n^|^2 / sigma^2
//!        + lambda E(c) + tau T(c) + (alpha / g) sum_r |(P_r - Q(u_r0))^t|^2          ^t: across n_r
//! u_r  the foot of P_r on Q, so the distance is orthogonal;   n^ = Q_u x Q_v / |Q_u x Q_v| there
//! ```
//!
//! The maximum likelihood for isotropic errors of points and normals. The last two terms only fix the
//! parametrisation: T alone leaves every affine change of (u, v) free, so the contacts are loosely tied to the places u_r0
//! that they were flattened to.
//! A change dQ of the surface moves the foot, `M du = (-Q_a . dQ + d n . dQ_a)_a`, `M_ab = g_ab - d h_ab`, d the distance.
//! The distance does not depend on that, the normal does; e_1, e_2 being orthonormal tangents, D_ak = g^ab Q_b . e_k:
//!
//! ```text
//! distance   n . dQ / Z              normal_k   -(D_ak n . dQ_a + H_kb du_b) / sigma,   H_kb = D_ak h_ab
//! ```
//!
//! With du_b the rows vanish for a mere change of (u, v), so that it does not slow down Gauss-Newton.

use super::cell_sums::{Buckets, Gather, Products};
use super::cells::{Cells, Jet};
use super::fairness::{ORDERS, RESIDUALS, ThirdJet, residuals, values};
use super::foot_point::Feet;
use super::parallel;
use super::patch_contacts::PatchContacts;
use super::quadrature::GaussPoint;
use super::vector::{Vector, cross, dot, minus, norm, unit};
use palpate_numeric::linalg::BlockMatrix;

/// Noise sds and weights of the parts of the objective, patch units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Weights {
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

/// The objective at given weights.
pub(super) struct Problem<'a> {
    /// Knots and numbering.
    pub cells: &'a Cells,
    /// Contacts in patch units.
    pub contacts: &'a PatchContacts,
    /// Places (u, v) that the contacts were flattened to.
    pub flattened: &'a [[f64; 2]],
    /// Quadrature rule for E and T, cell after cell.
    pub gauss: &'a [GaussPoint],
    /// Weights.
    pub weights: Weights,
    tied: Buckets,
    /// Matrix of the ties, which does not change from step to step.
    ties: BlockMatrix,
}

/// The parts of F, unweighted sums.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    /// Squared distances, weighted by the contacts' weights.
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
pub(super) struct Parts {
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
    pub(super) const ALL: Parts = Parts { position: true, normal: true, fairness: true, slack: true };
    /// Nothing.
    pub(super) const NONE: Parts = Parts { position: false, normal: false, fairness: false, slack: false };
}

/// A foot whose contact is farther off its surface normal than this, patch units, was held back by the end of its range.
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

/// Tangent frame at a contact; `None` where the surface has no tangent plane.
fn tangents(jet: &Jet) -> Option<Tangents> {
    let [point, qu, qv] = [jet[0][0], jet[1][0], jet[0][1]];
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

/// `V_ka = H_kb (M^-1)_ba`: rotation of the normal by a move of the foot; zero where the foot was held back.
fn foot_rotation(jet: &Jet, t: &Tangents, off: Vector) -> [[f64; 2]; 2] {
    let distance = dot(t.normal, off);
    let aside = t.frame.map(|e| dot(e, off));
    if aside[0].hypot(aside[1]) > HELD {
        return [[0.0; 2]; 2];
    }
    let [huu, huv, hvv] = [jet[2][0], jet[1][1], jet[0][2]].map(|w| dot(t.normal, w));
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

impl<'a> Problem<'a> {
    /// The objective at these weights, with the matrix of the ties.
    pub(super) fn new(
        cells: &'a Cells,
        contacts: &'a PatchContacts,
        flattened: &'a [[f64; 2]],
        gauss: &'a [GaussPoint],
        weights: Weights,
    ) -> Problem<'a> {
        let tied = Buckets::new(cells.count(), flattened.iter().map(|p| cells.cell_of(*p)));
        let ties = BlockMatrix::zeros(cells.shape());
        let mut problem = Problem { cells, contacts, flattened, gauss, weights, tied, ties };
        if weights.tie > 0.0 {
            let (mut ties, weight) = (problem.ties.clone(), problem.tie_weight().sqrt());
            let mut unused = vec![0.0; ties.order()];
            problem.gather(&mut ties, &mut unused, |cell, sums, products| {
                for &r in problem.tied.of(cell) {
                    products.fill(&cells.row(flattened[r][0], flattened[r][1], 0), &[(0, 0)]);
                    for e in across(contacts.normals[r]) {
                        sums.add(&[(e.map(|v| weight * v), products.of(0))], 0.0);
                    }
                }
            });
            problem.ties = ties;
        }
        problem
    }

    fn tie_weight(&self) -> f64 {
        self.weights.tie / self.flattened.len() as f64
    }

    /// F and its parts at these coefficients and feet; `None` where the surface has no tangent plane.
    pub(super) fn value(&self, c: &[Vector], feet: &Feet) -> Option<(f64, Sums)> {
        let contacts = parallel::sum(feet.places.len(), |r| self.contact_sums(r, c, feet.places[r]))?;
        let rule = parallel::sum(self.gauss.len(), |k| {
            let point = &self.gauss[k];
            let values = values(&self.third_jet(point, c))?;
            let part = |range: std::ops::Range<usize>| values[range].iter().map(|v| v * v).sum::<f64>();
            Some([point.weight * part(0..4), point.weight * part(4..RESIDUALS), 0.0])
        })?;
        let [position, normal, tie] = contacts;
        let sums = Sums { position, normal, fairness: rule[0], slack: rule[1], tie };
        let value = self.total(&sums);
        value.is_finite().then_some((value, sums))
    }

    /// Squared distance, squared difference of the normals, and squared distance of the tie, of one contact.
    fn contact_sums(&self, r: usize, c: &[Vector], foot: [f64; 2]) -> Option<[f64; 3]> {
        let jet = self.cells.jet::<1>(&self.cells.row(foot[0], foot[1], 1), c);
        let t = tangents(&jet)?;
        let (point, normal) = (self.contacts.points[r], self.contacts.normals[r]);
        let (wp, wn) = (self.contacts.position_weight[r], self.contacts.normal_weight[r]);
        let distance = wp * dot(t.normal, minus(point, t.point));
        let difference = minus(normal, t.normal);
        let tied = self.flattened[r];
        let off = minus(point, self.cells.jet::<0>(&self.cells.row(tied[0], tied[1], 0), c)[0][0]);
        let lift = dot(off, normal);
        Some([
            distance * distance,
            wn * wn * dot(difference, difference),
            (dot(off, off) - lift * lift) / self.flattened.len() as f64,
        ])
    }

    /// Distance and difference of the normals of every contact, without weights.
    pub(super) fn residuals(&self, c: &[Vector], feet: &Feet) -> Vec<[f64; 2]> {
        parallel::map(feet.places.len(), |r| {
            let [u, v] = feet.places[r];
            let Some(t) = tangents(&self.cells.jet::<1>(&self.cells.row(u, v, 1), c)) else {
                return [f64::INFINITY; 2];
            };
            let difference = norm(minus(self.contacts.normals[r], t.normal));
            [dot(t.normal, minus(self.contacts.points[r], t.point)), difference]
        })
    }

    /// F from its parts.
    fn total(&self, s: &Sums) -> f64 {
        let w = &self.weights;
        s.position / (w.position * w.position)
            + s.normal / (w.normal * w.normal)
            + w.fairness * s.fairness
            + w.slack * s.slack
            + w.tie * s.tie
    }

    fn third_jet(&self, point: &GaussPoint, c: &[Vector]) -> ThirdJet {
        let jet = self.cells.jet::<3>(&point.row, c);
        ORDERS.map(|(k, l)| jet[k][l])
    }

    /// Adds the Gauss-Newton matrix of `parts` to `matrix` and `-1/2` the gradient to `rhs`.
    pub(super) fn assemble(&self, c: &[Vector], feet: &Feet, parts: Parts, matrix: &mut BlockMatrix, rhs: &mut [f64]) {
        let by_cell = if parts.position || parts.normal {
            Buckets::new(self.cells.count(), feet.places.iter().map(|p| self.cells.cell_of(*p)))
        } else {
            Buckets::default()
        };
        if parts.slack {
            matrix.add_matrix(&self.ties);
        }
        self.gather(matrix, rhs, |cell, sums, products| {
            if parts.position || parts.normal {
                by_cell.of(cell).iter().for_each(|r| self.add_contact(*r, c, feet.places[*r], parts, sums, products));
            }
            if parts.slack && self.weights.tie > 0.0 {
                self.tied.of(cell).iter().for_each(|r| self.add_tie(*r, c, sums, products));
            }
            let fairness = if parts.fairness { self.weights.fairness } else { 0.0 };
            let slack = if parts.slack { self.weights.slack } else { 0.0 };
            if fairness > 0.0 || slack > 0.0 {
                self.rule_of(cell).iter().for_each(|p| self.add_rule_point(p, c, [fairness, slack], sums, products));
            }
        });
    }

    /// Gauss points of one cell.
    pub(super) fn rule_of(&self, cell: usize) -> &[GaussPoint] {
        let count = self.cells.local();
        &self.gauss[cell * count..(cell + 1) * count]
    }

    /// Adds the rows that `fill` finds for every cell to matrix and right-hand side.
    pub(super) fn gather(
        &self,
        matrix: &mut BlockMatrix,
        rhs: &mut [f64],
        fill: impl Fn(usize, &mut Gather, &mut Products) + Sync,
    ) {
        let local = self.cells.local();
        let mut alive = Vec::with_capacity(local);
        let new = || (Gather::new(local), Products::new(local, ORDERS.len()));
        parallel::in_order(
            self.cells.count(),
            new,
            |cell, (sums, products)| {
                sums.clear();
                fill(cell, sums, products);
                sums.finish();
            },
            |cell, (sums, _)| {
                self.cells.alive(&self.rule_of(cell)[0].row, &mut alive);
                sums.scatter(&alive, matrix, rhs);
            },
        );
    }

    fn add_contact(
        &self,
        r: usize,
        c: &[Vector],
        [u, v]: [f64; 2],
        parts: Parts,
        sums: &mut Gather,
        products: &mut Products,
    ) {
        let row = self.cells.row(u, v, 2);
        let jet = self.cells.jet::<2>(&row, c);
        let Some(t) = tangents(&jet) else { return };
        let off = minus(self.contacts.points[r], t.point);
        let distance = dot(t.normal, off);
        products.fill(&row, &[(0, 0), (1, 0), (0, 1)]);
        if parts.position {
            let weight = self.contacts.position_weight[r] / self.weights.position;
            sums.add(&[(t.normal.map(|n| weight * n), products.of(0))], weight * distance);
        }
        if parts.normal {
            let weight = self.contacts.normal_weight[r] / self.weights.normal;
            let rotation = foot_rotation(&jet, &t, off);
            for k in 0..2 {
                let moved: Vector =
                    [0, 1, 2].map(|d| weight * (rotation[k][0] * t.along[0][d] + rotation[k][1] * t.along[1][d]));
                let [a, b] = [0, 1].map(|a| -weight * (t.dual[a][k] + distance * rotation[k][a]));
                let scaled = |factor: f64| t.normal.map(|n| factor * n);
                let terms = [(moved, products.of(0)), (scaled(a), products.of(1)), (scaled(b), products.of(2))];
                sums.add(&terms, weight * dot(t.frame[k], self.contacts.normals[r]));
            }
        }
    }

    /// Adds the right-hand side of a tie; its matrix was made once.
    fn add_tie(&self, r: usize, c: &[Vector], sums: &mut Gather, products: &mut Products) {
        let row = self.cells.row(self.flattened[r][0], self.flattened[r][1], 0);
        let off = minus(self.contacts.points[r], self.cells.jet::<0>(&row, c)[0][0]);
        let (weight, n) = (self.tie_weight(), self.contacts.normals[r]);
        let lift = dot(n, off);
        products.fill(&row, &[(0, 0)]);
        sums.add_right([0, 1, 2].map(|d| weight * (off[d] - lift * n[d])), products.of(0));
    }

    fn add_rule_point(
        &self,
        point: &GaussPoint,
        c: &[Vector],
        weights: [f64; 2],
        sums: &mut Gather,
        products: &mut Products,
    ) {
        let Some((values, slopes)) = residuals(&self.third_jet(point, c)) else { return };
        products.fill(&point.row, &ORDERS);
        for (r, (value, slope)) in values.iter().zip(&slopes).enumerate() {
            let weight = (point.weight * weights[usize::from(r >= 4)]).sqrt();
            if weight > 0.0 {
                let term = |k: usize| (slope[k].map(|s| weight * s), products.of(k));
                if r < 4 {
                    sums.add(&std::array::from_fn::<_, 9, _>(term), -weight * value);
                } else {
                    sums.add(&[term(0), term(1), term(2 + (r - 4) / 2)], -weight * value);
                }
            }
        }
    }
}

/// Two unit vectors across a unit vector and each other.
fn across(n: Vector) -> [Vector; 2] {
    let axis = if n[2].abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
    let e1 = unit(cross(n, axis));
    [e1, cross(n, e1)]
}
