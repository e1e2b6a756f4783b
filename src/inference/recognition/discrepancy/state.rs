//! One surface of one hypothesis, fixed in all its parameters: where it lies and how it bends at points of the chart.
//!
//! ```text
//! Hessian coordinates (A, C, B)  ->  k1, k2 = mean +- |((A - C)/2, B)|, axes rotated by atan2(2 B, A - C)/2,
//!                                    at most 45 degrees
//! ```

use crate::recognition::kinds::{ConstantCurvature, Kind, Model};
use palpate_geometry::curvature::{Derivatives, Principal, curvatures};
use palpate_geometry::primitives::{NormalJet, TwoCurvatures};

use super::basis::{JetRow, turned};

use palpate_numeric::vector::{Vector, along, cross, norm_hypot};

/// A point of the chart of the general surface.
#[derive(Clone, Debug)]
pub(crate) struct ChartPoint {
    pub(crate) chart: [f64; 2],
    /// Its place on the general surface, patch coordinates.
    pub(crate) place: Vector,
    /// What the displacement needs there.
    pub(crate) row: Option<JetRow>,
}

/// One surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct State {
    model: Model,
    /// Cosine and sine of the rotation from the chart's axes to those of k1 and k2.
    turn: [f64; 2],
    /// A, C and B of the displacement `(A u^2 + C v^2)/2 + B u v`, which the general surface's own parameters hold.
    quadratic: [f64; 3],
    /// Coefficients of the displacement.
    coefficients: Option<Vec<f64>>,
}

/// A surface at one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bent {
    pub(crate) place: Vector,
    pub(crate) normal: Vector,
    pub(crate) k1: f64,
    pub(crate) k2: f64,
    /// Direction of k1, patch axes; `None` where it is undefined.
    pub(crate) direction: Option<Vector>,
    /// Displacement along the normal.
    pub(crate) displacement: f64,
}

impl State {
    /// A model moved by x, in the evidence's coordinates.
    pub(crate) fn new(model: &Model, x: &[f64], coefficients: Option<Vec<f64>>) -> State {
        let (kind, theta) = (model.kind(), model.theta());
        let mut moved = theta;
        (0..3).for_each(|i| moved[i] += x[i]);
        let mut turn = [1.0, 0.0];
        let mut quadratic = [0.0; 3];
        match kind {
            Kind::Plane => {}
            Kind::Sphere => (moved[3], moved[4]) = (theta[3] + x[3], theta[3] + x[3]),
            Kind::Cylinder => {
                moved[3] += x[3];
                // d phi = B / k
                moved[5] += if theta[3].abs() > 1e-6 { (x[4] / theta[3]).clamp(-0.5, 0.5) } else { 0.0 };
            }
            Kind::Paraboloid => (3..6).for_each(|i| moved[i] += x[i]),
            Kind::General if coefficients.is_some() && model.is_flat() => quadratic = [x[3], x[4], x[5]],
            // a displacement is a function of the chart, whose axes stay: B is one more displacement, B u v
            Kind::General if coefficients.is_some() => {
                (moved[3], moved[4]) = (theta[3] + x[3], theta[4] + x[4]);
                quadratic[2] = x[5];
            }
            Kind::General => {
                let (a, c, b) = (theta[3] + x[3], theta[4] + x[4], x[5]);
                let half = 0.5 * (a - c);
                // a rotation of at most 45 degrees keeps the order of the curvatures, and with it the chart's axes
                let angle = 0.5 * (b / half).atan();
                let angle = if angle.is_finite() { angle } else { 0.0 };
                let gap = if half >= 0.0 { half.hypot(b) } else { -half.hypot(b) };
                (moved[3], moved[4], moved[5]) = (0.5 * (a + c) + gap, 0.5 * (a + c) - gap, theta[5] + angle);
                turn = [angle.cos(), angle.sin()];
            }
        }
        State { model: Model::new(kind, moved), turn, quadratic, coefficients }
    }

    pub(crate) fn model(&self) -> &Model {
        &self.model
    }

    /// Curvatures of the surface that is displaced, its quadratic displacement and coefficients; `None` where it is not displaced.
    pub(super) fn displaced(&self) -> Option<([f64; 2], [f64; 3], &[f64])> {
        match (&self.model, &self.coefficients) {
            (Model::Constant(_, surface), Some(coefficients)) => {
                Some(([surface.theta[3], surface.theta[4]], self.quadratic, coefficients))
            }
            _ => None,
        }
    }

    /// The displacement at a chart point.
    fn jet(&self, at: &ChartPoint) -> NormalJet {
        match (&self.coefficients, &at.row) {
            (Some(coefficients), Some(row)) => {
                let ([u, v], [a, c, b]) = (at.chart, self.quadratic);
                let [f, fu, fv, fuu, fuv, fvv] = row.jet(coefficients);
                let of_second = 0.5 * (a * u * u + c * v * v) + b * u * v;
                [f + of_second, fu + a * u + b * v, fv + c * v + b * u, fuu + a, fuv + b, fvv + c]
            }
            _ => [0.0; 6],
        }
    }

    /// Larger and smaller curvature at a chart point; `None` where the chart folds.
    pub(crate) fn curvatures(&self, at: &ChartPoint) -> Option<[f64; 2]> {
        match (&self.model, &self.coefficients) {
            (Model::Paraboloid(surface), _) => curvatures(&surface.derivatives(at.place[0], at.place[1])),
            (Model::Constant(_, surface), Some(_)) => {
                let [c, s] = self.turn;
                surface.form().bending(self.turned_chart(at)[0], &turned(&self.jet(at), c, s))
            }
            (Model::Constant(..), None) => self.constant_curvatures(),
        }
    }

    /// Larger and smaller curvature where they are the same everywhere.
    pub(crate) fn constant_curvatures(&self) -> Option<[f64; 2]> {
        match (&self.model, &self.coefficients) {
            (Model::Constant(_, surface), None) => {
                let [_, _, _, k1, k2, _] = surface.theta;
                Some([k1.max(k2), k1.min(k2)])
            }
            _ => None,
        }
    }

    fn principal(&self, at: &ChartPoint) -> Option<Principal> {
        match &self.model {
            Model::Paraboloid(surface) => surface.derivatives(at.place[0], at.place[1]).principal(),
            Model::Constant(_, surface) => self.derivatives(surface, at, &self.jet(at)).principal(),
        }
    }

    /// First and second derivatives of the displaced surface in its own axes.
    fn derivatives(&self, surface: &ConstantCurvature, at: &ChartPoint, jet: &NormalJet) -> Derivatives {
        let [c, s] = self.turn;
        surface.form().derivatives(self.turned_chart(at), &turned(jet, c, s))
    }

    /// Where the surface lies at a chart point, and its unit normal there: a part of [`State::at`], without its curvatures
    /// and directions where the surface is displaced.
    pub(crate) fn place_and_normal(&self, at: &ChartPoint) -> (Vector, Vector) {
        let Model::Constant(Kind::General, surface) = &self.model else {
            let bent = self.at(at);
            return (bent.place, bent.normal);
        };
        let (jet, chart) = (self.jet(at), self.turned_chart(at));
        let bent = self.derivatives(surface, at, &jet);
        (surface.point(chart[0], chart[1], jet[0]), surface.rotate_back(normal_of(cross(bent.u, bent.v))))
    }

    /// Directions of k1 and k2 at a chart point; `None` where they are undefined.
    pub(crate) fn directions(&self, at: &ChartPoint) -> Option<[Vector; 2]> {
        let [k1, normal] = match &self.model {
            Model::Constant(Kind::General, surface) => {
                let principal = self.principal(at)?;
                [principal.direction1, principal.normal].map(|along| surface.rotate_back(along))
            }
            _ => {
                let bent = self.at(at);
                [bent.direction?, bent.normal]
            }
        };
        Some([k1, cross(normal, k1)])
    }

    fn turned_chart(&self, at: &ChartPoint) -> [f64; 2] {
        let ([u, v], [c, s]) = (at.chart, self.turn);
        [c * u + s * v, c * v - s * u]
    }

    /// Everything at a chart point.
    pub(crate) fn at(&self, at: &ChartPoint) -> Bent {
        let curvatures = self.curvatures(at).unwrap_or([f64::NAN; 2]);
        let displacement = self.jet(at)[0];
        let [k1, k2] = curvatures;
        let bent = |place, normal, direction| Bent { place, normal, k1, k2, direction, displacement };
        match &self.model {
            Model::Paraboloid(surface) => {
                let [x, y, _] = at.place;
                let place = [x, y, surface.height(x, y)[0]];
                bent(place, surface.distance_and_normal(place).1, self.principal(at).map(|p| p.direction1))
            }
            Model::Constant(Kind::General, surface) => {
                let [u, v] = self.turned_chart(at);
                let place = surface.point(u, v, displacement);
                let principal = self.principal(at);
                let normal = principal.map_or([0.0, 0.0, 1.0], |p| p.normal);
                bent(place, surface.rotate_back(normal), principal.map(|p| surface.rotate_back(p.direction1)))
            }
            Model::Constant(kind, surface) => {
                let (d, normal) = surface.distance_and_normal(at.place);
                let place = along(at.place, -d, normal);
                bent(place, normal, (*kind == Kind::Cylinder).then(|| axis_of_k1(surface, place)))
            }
        }
    }
}

/// The unit normal along this cross product of two tangents; upright where they span no plane.
fn normal_of(across: Vector) -> Vector {
    let area = norm_hypot(across);
    if area > 0.0 && area.is_finite() { across.map(|w| w / area) } else { [0.0, 0.0, 1.0] }
}

/// Direction of the larger curvature of a cylinder.
fn axis_of_k1(surface: &ConstantCurvature, place: Vector) -> Vector {
    let bar = TwoCurvatures { k2: 0.0, ..surface.form() };
    let local = bar.derivatives(surface.chart(place), &[0.0; 6]).principal();
    surface.rotate_back(local.map_or([1.0, 0.0, 0.0], |p| p.direction1))
}
