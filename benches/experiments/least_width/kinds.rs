//! The families, with the sizes that their members may have.
//!
//! ```text
//! bodies         any size from 2 to 200; superquadrics as random surfaces draw them
//! drawn bumps    h 0.5 to 2, either sign or none; c -5 to 5; w 3 to 7: as random surfaces draw three of them
//! any bumps      three of any height, place and width
//! ```
//!
//! A longer superquadric than is drawn may bend ten times as much in a strip too narrow for any contact, and a mean over 8 x 8 places
//! meets that strip or does not: such members would make every interval wide, for a reason that is none of the surface's.

use palpate::scene::{ImportedSurface, Surface};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Sphere,
    Cylinder,
    Paraboloid,
    Ellipsoid,
    Torus,
    Gaussian,
    Superquadric,
    DrawnBumps,
    AnyBumps,
}

/// Sizes of a body, and of those where the descent starts.
const ANY: [f64; 2] = [2.0, 200.0];
const START: [f64; 2] = [5.0, 40.0];
/// Semi-axes and exponents of random superquadrics.
const AXIS: [f64; 2] = [9.0, 18.0];
const EXPONENT: [f64; 2] = [0.6, 1.0];
/// Height, place and width of one bump.
const DRAWN: [[f64; 2]; 4] = [[-2.0, 2.0], [-5.0, 5.0], [-5.0, 5.0], [3.0, 7.0]];
const FREE: [[f64; 2]; 4] = [[-300.0, 300.0], [-60.0, 60.0], [-60.0, 60.0], [1.0, 60.0]];

#[derive(Clone, Debug)]
struct Bumps(Vec<f64>);

impl ImportedSurface for Bumps {
    fn label(&self) -> &str {
        "a sum of bumps"
    }

    fn is_fit(&self) -> bool {
        false
    }

    fn jet(&self, x: f64, y: f64) -> Option<[f64; 6]> {
        let mut jet = [0.0; 6];
        for bump in self.0.chunks_exact(DRAWN.len()) {
            let [h, cx, cy, w] = [bump[0], bump[1], bump[2], bump[3]];
            let (u, v) = ((x - cx) / w, (y - cy) / w);
            let g = h * (-0.5 * (u * u + v * v)).exp();
            let parts = [1.0, -u / w, -v / w, (u * u - 1.0) / (w * w), u * v / (w * w), (v * v - 1.0) / (w * w)];
            jet.iter_mut().zip(parts).for_each(|(sum, part)| *sum += g * part);
        }
        Some(jet)
    }
}

impl Kind {
    pub(crate) const ALL: [Kind; 9] = [
        Kind::Sphere,
        Kind::Cylinder,
        Kind::Paraboloid,
        Kind::Ellipsoid,
        Kind::Torus,
        Kind::Gaussian,
        Kind::Superquadric,
        Kind::DrawnBumps,
        Kind::AnyBumps,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Kind::Sphere => "sphere",
            Kind::Cylinder => "cylinder",
            Kind::Paraboloid => "saddle or paraboloid",
            Kind::Ellipsoid => "ellipsoid",
            Kind::Torus => "torus",
            Kind::Gaussian => "bump",
            Kind::Superquadric => "superquadric",
            Kind::DrawnBumps => "drawn bumps",
            Kind::AnyBumps => "any bumps",
        }
    }

    pub(crate) fn is_sum(self) -> bool {
        matches!(self, Kind::DrawnBumps | Kind::AnyBumps)
    }

    /// The upright body of these sizes: a paraboloid's are curvatures, a torus's first is the width of its hole.
    pub(crate) fn body(self, p: &[f64]) -> Surface {
        match self {
            Kind::Sphere => Surface::sphere(p[0]),
            Kind::Cylinder => Surface::cylinder(p[0]),
            Kind::Paraboloid => Surface::paraboloid([1.0 / p[0], 1.0 / p[1]]),
            Kind::Ellipsoid => Surface::ellipsoid([p[0], p[1], p[2]]),
            Kind::Torus => Surface::torus(p[0] + p[1], p[1]),
            Kind::Gaussian => Surface::gaussian_bump(p[0], p[1]),
            Kind::Superquadric => Surface::superquadric([p[0], p[1], p[2]], [p[3], p[4]]),
            Kind::DrawnBumps | Kind::AnyBumps => Surface::imported(Bumps(p.to_vec())),
        }
    }

    /// Ranges of the sizes.
    pub(crate) fn limits(self) -> Vec<[f64; 2]> {
        match self {
            Kind::Sphere | Kind::Cylinder => vec![ANY],
            Kind::Paraboloid => vec![[-3.0, 3.0]; 2],
            Kind::Ellipsoid => vec![ANY; 3],
            Kind::Torus => vec![ANY; 2],
            Kind::Gaussian => vec![[-200.0, 200.0], ANY],
            Kind::Superquadric => vec![AXIS, AXIS, AXIS, EXPONENT, EXPONENT],
            Kind::DrawnBumps => [DRAWN; 3].concat(),
            Kind::AnyBumps => [FREE; 3].concat(),
        }
    }

    /// Ranges of the sizes at a start, and the most that a body is tilted there, in radians.
    pub(crate) fn starts(self) -> (Vec<[f64; 2]>, f64) {
        match self {
            Kind::Sphere => (vec![START], 0.0),
            Kind::Cylinder => (vec![START], 0.3),
            Kind::Paraboloid => (vec![[-0.2, 0.2]; 2], 0.3),
            Kind::Ellipsoid => (vec![START; 3], 0.3),
            Kind::Torus => (vec![[2.0, 30.0], [4.0, 16.0]], 1.2),
            Kind::Gaussian => (vec![[0.5, 8.0], [2.0, 12.0]], 0.3),
            Kind::Superquadric => (self.limits(), 0.2),
            Kind::DrawnBumps => (self.limits(), 0.0),
            Kind::AnyBumps => ([DRAWN; 3].concat(), 0.1),
        }
    }
}
