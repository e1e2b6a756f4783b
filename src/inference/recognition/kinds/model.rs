//! The models that are fitted, each with its own free parameters `q` within `theta`.
//!
//! ```text
//! plane (h, a, b)   sphere (h, a, b, k1 = k2)   cylinder (h, a, b, k1, phi; k2 = 0)   general (h, a, b, k1, k2, phi)
//! evidence is taken in the coordinates of the Hessian (A, C, B): A, C curvatures along phi and across, B = d phi (k1 - k2)
//! ```
//!
//! The Hessian's coordinates are smooth where the curvatures are equal, and phi is not.

use std::f64::consts::FRAC_PI_4;

use palpate_numeric::vector::Vector;

use super::constant_curvature::ConstantCurvature;
use super::paraboloid::Paraboloid;

/// Difference of curvatures below which the derivative by B is taken from differences instead of from phi.
const UMBILIC: f64 = 0.1;

/// Largest curvature over the patch's length: with a radius below a thousandth of their extent contacts lie about a point.
const MOST_BENT: f64 = 1e3;

/// Which model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Plane,
    Sphere,
    Cylinder,
    General,
    Paraboloid,
}

impl Kind {
    pub(crate) const ALL: [Kind; 5] = [Kind::Plane, Kind::Sphere, Kind::Cylinder, Kind::General, Kind::Paraboloid];

    /// Number of free parameters.
    pub(crate) fn unknowns(self) -> usize {
        match self {
            Kind::Plane => 3,
            Kind::Sphere => 4,
            Kind::Cylinder => 5,
            Kind::General | Kind::Paraboloid => 6,
        }
    }

    /// The surface of this kind with the same free parameters; the others get the values that this kind has fixed.
    pub(crate) fn restricted(self, theta: [f64; 6]) -> [f64; 6] {
        let [h, a, b, k1, k2, phi] = theta;
        match self {
            Kind::Plane => [h, a, b, 0.0, 0.0, 0.0],
            Kind::Sphere => [h, a, b, k1, k1, 0.0],
            Kind::Cylinder => [h, a, b, k1, 0.0, phi],
            Kind::General | Kind::Paraboloid => [h, a, b, k1, k2, phi],
        }
    }

    /// `theta` moved by a step in the free parameters.
    pub(crate) fn moved(self, theta: [f64; 6], step: &[f64]) -> [f64; 6] {
        let mut out = theta;
        match self {
            Kind::Cylinder => [0, 1, 2, 3, 5].iter().zip(step).for_each(|(&i, s)| out[i] += s),
            _ => out.iter_mut().zip(step).for_each(|(t, s)| *t += s),
        }
        self.restricted(out)
    }

    /// Derivatives by the free parameters from those by theta.
    pub(crate) fn columns(self, by: [f64; 6]) -> [f64; 6] {
        let [h, a, b, k1, k2, phi] = by;
        match self {
            Kind::Plane => [h, a, b, 0.0, 0.0, 0.0],
            Kind::Sphere => [h, a, b, k1 + k2, 0.0, 0.0],
            Kind::Cylinder => [h, a, b, k1, phi, 0.0],
            Kind::General | Kind::Paraboloid => by,
        }
    }
}

/// A fitted surface of one kind.
#[allow(
    clippy::large_enum_variant,
    reason = "a handful of models exist at a time, and a box would cost an indirection at every distance"
)]
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Model {
    Constant(Kind, ConstantCurvature),
    Paraboloid(Paraboloid),
}

impl Model {
    pub(crate) fn new(kind: Kind, theta: [f64; 6]) -> Model {
        match kind {
            Kind::Paraboloid => Model::Paraboloid(Paraboloid { theta }),
            _ => Model::Constant(kind, ConstantCurvature::new(theta)),
        }
    }

    pub(crate) fn kind(&self) -> Kind {
        match self {
            Model::Constant(kind, _) => *kind,
            Model::Paraboloid(_) => Kind::Paraboloid,
        }
    }

    pub(crate) fn theta(&self) -> [f64; 6] {
        match self {
            Model::Constant(_, surface) => surface.theta,
            Model::Paraboloid(surface) => surface.theta,
        }
    }

    /// Whether it bends nowhere, whatever its kind.
    pub(crate) fn is_flat(&self) -> bool {
        self.theta()[3..5] == [0.0; 2]
    }

    /// Whether it is a surface that contacts can lie on, and not the point that a descent shrinks it to.
    pub(crate) fn is_possible(&self) -> bool {
        self.theta()[3..5].iter().all(|k| k.abs() <= MOST_BENT)
    }

    pub(crate) fn distance_and_normal(&self, x: Vector) -> (f64, Vector) {
        match self {
            Model::Constant(_, surface) => surface.distance_and_normal(x),
            Model::Paraboloid(surface) => surface.distance_and_normal(x),
        }
    }

    pub(crate) fn distance(&self, x: Vector) -> f64 {
        self.distance_and_normal(x).0
    }

    /// Distance and its derivatives by the free parameters.
    pub(crate) fn distance_by_free(&self, x: Vector) -> (f64, [f64; 6]) {
        let (d, by) = match self {
            Model::Constant(_, surface) => surface.distance_by_theta(x),
            Model::Paraboloid(surface) => surface.distance_by_theta(x),
        };
        (d, self.kind().columns(by))
    }

    /// Pairs of neighbouring surfaces with the difference of the evidence's coordinate between them: central
    /// differences for one column of the evidence's Jacobian each.
    pub(crate) fn neighbours(&self) -> Vec<(Model, Model, f64)> {
        let (kind, theta) = (self.kind(), self.theta());
        let shifted = |shift: [f64; 6]| Model::new(kind, [0, 1, 2, 3, 4, 5].map(|i| theta[i] + shift[i]));
        let step = 1e-5;
        let pair = |direction: [f64; 6], unit: f64| {
            (shifted(direction.map(|v| step * v)), shifted(direction.map(|v| -step * v)), 2.0 * step * unit)
        };
        let axis = |i: usize| {
            let mut direction = [0.0; 6];
            direction[i] = 1.0;
            pair(direction, 1.0)
        };
        match kind {
            Kind::Plane => (0..3).map(axis).collect(),
            Kind::Sphere => (0..3).map(axis).chain([pair([0.0, 0.0, 0.0, 1.0, 1.0, 0.0], 1.0)]).collect(),
            Kind::Cylinder => (0..4).map(axis).chain([twisted(theta)]).collect(),
            Kind::General => (0..5).map(axis).chain([twisted(theta)]).collect(),
            Kind::Paraboloid => (0..6).map(axis).collect(),
        }
    }
}

/// The pair of surfaces that differ in B alone.
fn twisted(theta: [f64; 6]) -> (Model, Model, f64) {
    let [h, a, b, k1, k2, phi] = theta;
    let gap = k1 - k2;
    let at = |k1: f64, k2: f64, phi: f64| Model::new(Kind::General, [h, a, b, k1, k2, phi]);
    if gap.abs() > UMBILIC {
        let step = 1e-5;
        return (at(k1, k2, phi + step), at(k1, k2, phi - step), 2.0 * step * gap);
    }
    let (mean, half) = (0.5 * (k1 + k2), 0.03);
    (at(mean + half, mean - half, phi + FRAC_PI_4), at(mean + half, mean - half, phi - FRAC_PI_4), 2.0 * half)
}
