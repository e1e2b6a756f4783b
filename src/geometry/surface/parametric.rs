//! A parametric surface, a map into space: `Q(u, v) = sum_ij c_ij N_i(u) M_j(v)`, c_ij in R^3, either direction open or closed.
//!
//! It is tied to no axis of space, so that it may be steep or close on itself. In a closed direction the last p coefficients repeat the
//! first p, so Q and its derivatives up to p - 1 have no seam.

use ndarray::Array2;

#[cfg(feature = "serde")]
use super::saved::SavedSurface;
use crate::curvature::{Derivatives, Principal};
use palpate_numeric::bspline::{BasisRow, Knots, SplineError};

/// Point and derivatives of `Q` at one (u, v).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParametricPoint {
    /// Q.
    pub point: [f64; 3],
    /// Its first and second derivatives.
    pub derivatives: Derivatives,
}

impl ParametricPoint {
    /// `Q_u x Q_v`: it points to the free side, and its length is the Jacobian of the map.
    pub fn area_vector(&self) -> [f64; 3] {
        let (u, v) = (self.derivatives.u, self.derivatives.v);
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    }

    /// Principal curvatures and directions; `None` where the surface has no tangent plane.
    pub fn principal(&self) -> Option<Principal> {
        self.derivatives.principal()
    }
}

/// A tensor-product B-spline map into space.
///
/// ```
/// # use palpate_geometry::facade as palpate;
/// use palpate::spline::Knots;
/// use palpate::spline::Parametric;
///
/// // a tube of radius about 1 and length 1: u closes in 8 segments, v is straight
/// let knots = [Knots::closed(3, 8, 0.0, 8.0)?, Knots::uniform(1, 1, 0.0, 1.0)?];
/// let ring = |z: f64| move |i: i32| {
///     let (sin, cos) = (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
///     [cos, sin, z]
/// };
/// let free: Vec<[f64; 3]> = (0..8).flat_map(|i| [ring(0.0)(i), ring(1.0)(i)]).collect();
/// let tube = Parametric::from_free(knots, &free)?;
/// let here = tube.at(8.5, 0.5);
/// assert_eq!(here, tube.at(0.5, 0.5));
/// assert!((here.point[2] - 0.5).abs() < 1e-15 && here.principal().is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(into = "SavedSurface<[f64; 3]>", try_from = "SavedSurface<[f64; 3]>"))]
pub struct Parametric {
    knots: [Knots; 2],
    coefficients: Array2<[f64; 3]>,
}

impl Parametric {
    /// A surface from its knots and its n x m coefficients, those of a closed direction repeated at the end.
    ///
    /// # Errors
    /// [`SplineError::Shape`], [`SplineError::NotFinite`], [`SplineError::Seam`].
    pub fn new(knots: [Knots; 2], coefficients: Array2<[f64; 3]>) -> Result<Parametric, SplineError> {
        let expected = [knots[0].n_basis(), knots[1].n_basis()];
        let found = [coefficients.nrows(), coefficients.ncols()];
        if found != expected {
            return Err(SplineError::Shape { found, expected });
        }
        if let Some(((i, j), _)) = coefficients.indexed_iter().find(|(_, c)| c.iter().any(|v| !v.is_finite())) {
            return Err(SplineError::NotFinite { i, j });
        }
        let [n, m] = [knots[0].free(), knots[1].free()];
        if let Some(((i, j), _)) = coefficients.indexed_iter().find(|((i, j), c)| **c != coefficients[[i % n, j % m]]) {
            return Err(SplineError::Seam { i, j });
        }
        Ok(Parametric { knots, coefficients })
    }

    /// From the distinct coefficients alone, number `i free_v + j`.
    ///
    /// # Errors
    /// As [`Parametric::new`].
    pub fn from_free(knots: [Knots; 2], free: &[[f64; 3]]) -> Result<Parametric, SplineError> {
        let [n, m] = [knots[0].free(), knots[1].free()];
        if free.len() != n * m {
            return Err(SplineError::Shape { found: [free.len(), 1], expected: [n * m, 1] });
        }
        let shape = [knots[0].n_basis(), knots[1].n_basis()];
        let coefficients = Array2::from_shape_fn(shape, |(i, j)| free[(i % n) * m + j % m]);
        Parametric::new(knots, coefficients)
    }

    /// Knots in u and v.
    pub fn knots(&self) -> &[Knots; 2] {
        &self.knots
    }

    /// Coefficients, n x m.
    pub fn coefficients(&self) -> &Array2<[f64; 3]> {
        &self.coefficients
    }

    /// Point and derivatives at (u, v). Closed directions wrap; in open ones the end polynomials are extended.
    pub fn at(&self, u: f64, v: f64) -> ParametricPoint {
        self.with_rows(&self.row(0, u), &self.row(1, v))
    }

    /// The basis in direction `k` at `t`.
    pub fn row(&self, k: usize, t: f64) -> BasisRow {
        self.knots[k].basis(self.knots[k].wrapped(t))
    }

    /// Point and derivatives from the basis rows of both directions, which a grid needs once for each of its lines.
    pub fn with_rows(&self, bu: &BasisRow, bv: &BasisRow) -> ParametricPoint {
        let mut out = [[0.0; 3]; 6];
        for a in 0..=self.knots[0].degree() {
            let mut along = [[0.0; 3]; 3];
            for b in 0..=self.knots[1].degree() {
                let c = self.coefficients[[bu.first + a, bv.first + b]];
                for (l, sum) in along.iter_mut().enumerate() {
                    (0..3).for_each(|d| sum[d] += c[d] * bv.derivative(l)[b]);
                }
            }
            let orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];
            for (target, (k, l)) in out.iter_mut().zip(orders) {
                (0..3).for_each(|d| target[d] += bu.derivative(k)[a] * along[l][d]);
            }
        }
        let [point, u, v, uu, uv, vv] = out;
        ParametricPoint { point, derivatives: Derivatives { u, v, uu, uv, vv } }
    }

    /// The same surface under `P -> origin + scale P` with parameters scaled alike: `(u, v) -> scale (u, v)`.
    ///
    /// # Errors
    /// When the map leaves the finite numbers.
    pub fn placed(&self, origin: [f64; 3], scale: f64) -> Result<Parametric, SplineError> {
        let knots = [self.knots[0].mapped(0.0, 1.0 / scale)?, self.knots[1].mapped(0.0, 1.0 / scale)?];
        Parametric::new(knots, self.coefficients.mapv(|c| [0, 1, 2].map(|k| origin[k] + scale * c[k])))
    }
}

#[cfg(feature = "serde")]
impl From<Parametric> for SavedSurface<[f64; 3]> {
    fn from(surface: Parametric) -> SavedSurface<[f64; 3]> {
        SavedSurface::of(&surface.knots, &surface.coefficients)
    }
}

#[cfg(feature = "serde")]
impl TryFrom<SavedSurface<[f64; 3]>> for Parametric {
    type Error = SplineError;

    fn try_from(saved: SavedSurface<[f64; 3]>) -> Result<Parametric, SplineError> {
        let (knots, coefficients) = saved.read()?;
        Parametric::new(knots, coefficients)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheared_plane_is_flat_and_a_closed_ring_has_no_seam() {
        let knots = [Knots::uniform(2, 2, 0.0, 1.0).unwrap(), Knots::uniform(3, 1, 0.0, 2.0).unwrap()];
        let (gu, gv) = (knots[0].greville(), knots[1].greville());
        let c = Array2::from_shape_fn((gu.len(), gv.len()), |(i, j)| [gu[i] + gv[j], 2.0 * gv[j], -gu[i]]);
        let plane = Parametric::new(knots, c).unwrap();
        let p = plane.at(0.3, 1.7);
        assert!((p.point[0] - 2.0).abs() < 1e-14 && (p.point[2] + 0.3).abs() < 1e-14);
        assert!(p.principal().unwrap().curvedness() < 1e-12);

        let knots = [Knots::closed(3, 8, 0.0, 8.0).unwrap(), Knots::uniform(1, 1, 0.0, 1.0).unwrap()];
        let ring: Vec<[f64; 3]> = (0..8)
            .flat_map(|i| {
                let (s, c) = (i as f64 * std::f64::consts::FRAC_PI_4).sin_cos();
                [[c, s, 0.0], [c, s, 1.0]]
            })
            .collect();
        let tube = Parametric::from_free(knots, &ring).unwrap();
        assert_eq!(tube.at(8.5, 0.5), tube.at(0.5, 0.5));
        let (before, after) = (tube.at(8.0 - 1e-9, 0.5), tube.at(0.0, 0.5));
        assert!((before.derivatives.uu[0] - after.derivatives.uu[0]).abs() < 1e-8);
        let mut torn = tube.coefficients().clone();
        torn[[9, 0]] = [0.0; 3];
        assert!(matches!(Parametric::new(tube.knots().clone(), torn), Err(SplineError::Seam { i: 9, j: 0 })));
    }
}
