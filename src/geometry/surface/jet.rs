//! What a surface is at a place of its chart, whatever kind of surface it is.
//!
//! ```text
//! Q(u, v)   Q_u  Q_v   Q_uu  Q_uv  Q_vv          of a height field u, v are x, y, and Q = (x, y, S(x, y))
//! ```

use super::{HeightField, Parametric, ParametricPoint, SurfacePoint};
use crate::contact::Frame;
use crate::curvature::Derivatives;
use palpate_numeric::bspline::Knots;

/// Position, and first and second derivatives.
pub type Jet = ParametricPoint;

/// A map of a rectangle into space. Views, comparisons and tables of points ask a surface for no more than this, so that a new kind of
/// surface needs only a [`Surface::jet`].
pub trait Surface {
    /// Ranges of u and v.
    fn domain(&self) -> [[f64; 2]; 2];

    /// Which directions close on themselves.
    fn closed(&self) -> [bool; 2];

    /// Numbers that the map has: its coefficients.
    fn unknowns(&self) -> usize;

    /// Position and derivatives with `at` = (u, v); beyond the ends of the domain, the end polynomials'.
    fn jet(&self, at: [f64; 2]) -> Jet;
}

/// A surface `z = S(x, y)`.
pub trait Heights: Surface + std::fmt::Debug {
    /// Height, slopes and second derivatives; beyond the ends of the domain, the end polynomials'.
    fn height_at(&self, x: f64, y: f64) -> SurfacePoint;
}

impl Heights for HeightField {
    fn height_at(&self, x: f64, y: f64) -> SurfacePoint {
        self.at(x, y)
    }
}

impl Surface for HeightField {
    fn domain(&self) -> [[f64; 2]; 2] {
        self.knots().each_ref().map(Knots::domain)
    }

    fn closed(&self) -> [bool; 2] {
        [false; 2]
    }

    fn unknowns(&self) -> usize {
        self.coefficients().len()
    }

    fn jet(&self, [x, y]: [f64; 2]) -> Jet {
        let here = self.at(x, y);
        Jet { point: [x, y, here.z], derivatives: here.derivatives() }
    }
}

impl Surface for Parametric {
    fn domain(&self) -> [[f64; 2]; 2] {
        self.knots().each_ref().map(Knots::domain)
    }

    fn closed(&self) -> [bool; 2] {
        self.knots().each_ref().map(Knots::is_closed)
    }

    fn unknowns(&self) -> usize {
        self.coefficients().len()
    }

    fn jet(&self, [u, v]: [f64; 2]) -> Jet {
        self.at(u, v)
    }
}

/// A height field that stands along the axes of a frame, seen in the input's own.
#[derive(Clone, Copy, Debug)]
pub struct AlongAxes<'a> {
    /// Heights along the frame's third axis, input units.
    pub surface: &'a dyn Heights,
    /// The frame; its origin and scale do not count.
    pub frame: &'a Frame,
}

impl Surface for AlongAxes<'_> {
    fn domain(&self) -> [[f64; 2]; 2] {
        self.surface.domain()
    }

    fn closed(&self) -> [bool; 2] {
        self.surface.closed()
    }

    fn unknowns(&self) -> usize {
        self.surface.unknowns()
    }

    fn jet(&self, at: [f64; 2]) -> Jet {
        let Jet { point, derivatives: d } = self.surface.jet(at);
        let turned = |w: [f64; 3]| self.frame.direction_to_input(w);
        let [u, v, uu, uv, vv] = [d.u, d.v, d.uu, d.uv, d.vv].map(turned);
        Jet { point: turned(point), derivatives: Derivatives { u, v, uu, uv, vv } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    #[test]
    fn a_height_field_bends_alike_however_it_is_seen() {
        let knots = || [Knots::uniform(3, 3, -1.0, 1.0).unwrap(), Knots::uniform(2, 2, 0.0, 2.0).unwrap()];
        let heights = Array2::from_shape_fn((6, 4), |(i, j)| (0.7 * i as f64).sin() * (1.0 + 0.4 * j as f64));
        let field = HeightField::new(knots(), heights).unwrap();
        let [gx, gy] = knots().map(|k| k.greville());
        let points = Array2::from_shape_fn((6, 4), |(i, j)| [gx[i], gy[j], field.coefficients()[[i, j]]]);
        let map = Parametric::new(knots(), points).unwrap();
        // a third of a turn about the diagonal
        let axes = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
        let frame = Frame { axes, ..Frame::IDENTITY };
        let turned = AlongAxes { surface: &field, frame: &frame };
        for at in [[-0.7, 0.2], [0.1, 1.1], [0.9, 1.9]] {
            let [a, b, c] = [field.jet(at), map.jet(at), turned.jet(at)];
            let [p, q, r] = [a, b, c].map(|jet| jet.principal().unwrap());
            assert!((0..3).all(|k| (a.point[k] - b.point[k]).abs() < 1e-14));
            assert_eq!(frame.rotate(c.point), a.point);
            for other in [q, r] {
                assert!((p.k1 - other.k1).abs() < 1e-12 && (p.k2 - other.k2).abs() < 1e-12);
            }
        }
    }
}
