//! A height field over the product of two clamped knot vectors: `S(x, y) = sum_ij c_ij N_i(x) M_j(y)`, n m coefficients.

use ndarray::Array2;

#[cfg(feature = "serde")]
use super::saved::SavedSurface;
use crate::curvature::Derivatives;
use palpate_numeric::bspline::{BasisRow, Knots, SplineError};

/// Height and derivatives at one point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SurfacePoint {
    /// S.
    pub z: f64,
    /// S_x.
    pub zx: f64,
    /// S_y.
    pub zy: f64,
    /// S_xx.
    pub zxx: f64,
    /// S_xy.
    pub zxy: f64,
    /// S_yy.
    pub zyy: f64,
}

impl SurfacePoint {
    /// `S = sum c_ij N_i M_j` and its derivatives from the basis rows of a point and the coefficients `c(i, j)`.
    #[inline]
    pub fn of_rows(bx: &BasisRow, by: &BasisRow, c: impl Fn(usize, usize) -> f64) -> SurfacePoint {
        let [n, dn, ddn] = [0, 1, 2].map(|k| bx.derivative(k));
        let [m, dm, ddm] = [0, 1, 2].map(|k| by.derivative(k));
        let mut point = SurfacePoint::default();
        for a in 0..n.len() {
            let (mut s, mut sy, mut syy) = (0.0, 0.0, 0.0);
            for b in 0..m.len() {
                let c = c(bx.first + a, by.first + b);
                s += c * m[b];
                sy += c * dm[b];
                syy += c * ddm[b];
            }
            point.z += n[a] * s;
            point.zx += dn[a] * s;
            point.zxx += ddn[a] * s;
            point.zy += n[a] * sy;
            point.zxy += dn[a] * sy;
            point.zyy += n[a] * syy;
        }
        point
    }

    /// Derivatives of the map `(x, y, S)`.
    pub fn derivatives(&self) -> Derivatives {
        Derivatives::of_height(self.zx, self.zy, self.zxx, self.zxy, self.zyy)
    }

    /// Unit normal to the free side, `(-S_x, -S_y, 1)/w`.
    pub fn normal(&self) -> [f64; 3] {
        let w = self.zx.hypot(self.zy).hypot(1.0);
        [-self.zx / w, -self.zy / w, 1.0 / w]
    }

    /// Unit tangents along x and along y.
    pub fn tangents(&self) -> [[f64; 3]; 2] {
        let (along, across) = (self.zx.hypot(1.0), self.zy.hypot(1.0));
        [[1.0 / along, 0.0, self.zx / along], [0.0, 1.0 / across, self.zy / across]]
    }
}

/// A tensor-product B-spline height field. Lengths are in the unit of its knots and coefficients.
///
/// ```
/// # use palpate_geometry::facade as palpate;
/// use ndarray::Array2;
/// use palpate::spline::Knots;
/// use palpate::spline::HeightField;
///
/// // z = x^2 on [-1, 1] has the quadratic B-spline coefficients 1, -1, 1 along x
/// let axis = Knots::uniform(2, 1, -1.0, 1.0)?;
/// let coefficients = Array2::from_shape_fn((3, 3), |(i, _)| if i == 1 { -1.0 } else { 1.0 });
/// let surface = HeightField::new([axis.clone(), axis], coefficients)?;
/// let point = surface.at(0.5, 0.0);
/// assert!((point.z - 0.25).abs() < 1e-15 && (point.zx - 1.0).abs() < 1e-15 && (point.zxx - 2.0).abs() < 1e-15);
/// // row after row is as good
/// let rows = [1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0];
/// assert_eq!(surface, HeightField::new(surface.knots().clone(), &rows[..])?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(into = "SavedSurface<f64>", try_from = "SavedSurface<f64>"))]
pub struct HeightField {
    knots: [Knots; 2],
    coefficients: Array2<f64>,
}

/// Coefficients as they come: a table of n x m, or the same numbers row after row, as a plan's fit gives them.
#[derive(Clone, Debug)]
pub enum HeightCoefficients {
    /// n x m.
    Table(Array2<f64>),
    /// Row after row: y runs fastest.
    Rows(Vec<f64>),
}

impl From<Array2<f64>> for HeightCoefficients {
    fn from(table: Array2<f64>) -> HeightCoefficients {
        HeightCoefficients::Table(table)
    }
}

impl From<Vec<f64>> for HeightCoefficients {
    fn from(rows: Vec<f64>) -> HeightCoefficients {
        HeightCoefficients::Rows(rows)
    }
}

impl From<&[f64]> for HeightCoefficients {
    fn from(rows: &[f64]) -> HeightCoefficients {
        HeightCoefficients::Rows(rows.to_vec())
    }
}

impl HeightCoefficients {
    /// As a table of this shape.
    fn into_table(self, expected: [usize; 2]) -> Result<Array2<f64>, SplineError> {
        let wrong = |found| SplineError::Shape { found, expected };
        match self {
            HeightCoefficients::Table(table) if [table.nrows(), table.ncols()] == expected => Ok(table),
            HeightCoefficients::Table(table) => Err(wrong([table.nrows(), table.ncols()])),
            HeightCoefficients::Rows(rows) => {
                let count = rows.len();
                // one row of so many: the numbers do not say how they were meant to stand
                Array2::from_shape_vec((expected[0], expected[1]), rows).map_err(|_| wrong([1, count]))
            }
        }
    }
}

impl HeightField {
    /// A surface from its knots and its n x m coefficients, as a table or row after row.
    ///
    /// # Errors
    /// [`SplineError::Shape`], [`SplineError::NotFinite`].
    pub fn new(knots: [Knots; 2], coefficients: impl Into<HeightCoefficients>) -> Result<HeightField, SplineError> {
        let expected = [knots[0].n_basis(), knots[1].n_basis()];
        let coefficients = coefficients.into().into_table(expected)?;
        if let Some(((i, j), _)) = coefficients.indexed_iter().find(|(_, c)| !c.is_finite()) {
            return Err(SplineError::NotFinite { i, j });
        }
        Ok(HeightField { knots, coefficients })
    }

    /// Knots in x and y.
    pub fn knots(&self) -> &[Knots; 2] {
        &self.knots
    }

    /// Coefficients, n x m.
    pub fn coefficients(&self) -> &Array2<f64> {
        &self.coefficients
    }

    /// Height, slopes and second derivatives at `(x, y)`; outside the domain the end polynomials are extended.
    pub fn at(&self, x: f64, y: f64) -> SurfacePoint {
        self.with_rows(&self.knots[0].basis(x), &self.knots[1].basis(y))
    }

    /// The same from basis rows that were evaluated before.
    pub fn with_rows(&self, bx: &BasisRow, by: &BasisRow) -> SurfacePoint {
        SurfacePoint::of_rows(bx, by, |i, j| self.coefficients[[i, j]])
    }

    /// The same surface under `x -> ox + s x`, `y -> oy + s y`, `z -> oz + s z`.
    ///
    /// # Errors
    /// When the map leaves the finite numbers or makes distinct knots equal.
    pub fn placed(&self, origin: [f64; 3], scale: f64) -> Result<HeightField, SplineError> {
        // one multiplication and one addition, rounded once each
        let place = |k: &Knots, o: f64| Knots::new(k.degree(), k.as_slice().iter().map(|t| o + scale * t).collect());
        let knots = [place(&self.knots[0], origin[0])?, place(&self.knots[1], origin[1])?];
        HeightField::new(knots, self.coefficients.mapv(|c| origin[2] + scale * c))
    }
}

#[cfg(feature = "serde")]
impl From<HeightField> for SavedSurface<f64> {
    fn from(surface: HeightField) -> SavedSurface<f64> {
        SavedSurface::of(&surface.knots, &surface.coefficients)
    }
}

#[cfg(feature = "serde")]
impl TryFrom<SavedSurface<f64>> for HeightField {
    type Error = SplineError;

    fn try_from(saved: SavedSurface<f64>) -> Result<HeightField, SplineError> {
        let (knots, coefficients) = saved.read()?;
        HeightField::new(knots, coefficients)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A biquadratic through Greville products is exact: S = 2 + x - 3 y + x y.
    fn bilinear() -> HeightField {
        let knots = [Knots::uniform(2, 3, -1.0, 2.0).unwrap(), Knots::uniform(3, 2, 0.0, 1.0).unwrap()];
        let (gx, gy) = (knots[0].greville(), knots[1].greville());
        let c = Array2::from_shape_fn((gx.len(), gy.len()), |(i, j)| 2.0 + gx[i] - 3.0 * gy[j] + gx[i] * gy[j]);
        HeightField::new(knots, c).unwrap()
    }

    #[test]
    fn values_and_slopes_of_a_bilinear_surface() {
        let surface = bilinear();
        for (x, y) in [(-1.0, 0.0), (0.3, 0.7), (2.0, 1.0), (2.5, -0.5)] {
            let p = surface.at(x, y);
            let exact = [2.0 + x - 3.0 * y + x * y, 1.0 + y, -3.0 + x, 0.0, 1.0, 0.0];
            for (found, exact) in [p.z, p.zx, p.zy, p.zxx, p.zxy, p.zyy].iter().zip(exact) {
                assert!((found - exact).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn placing_moves_the_graph() {
        let placed = bilinear().placed([10.0, -4.0, 7.0], 2.0).unwrap();
        let (p, q) = (placed.at(10.6, -2.6), bilinear().at(0.3, 0.7));
        assert!((p.z - (7.0 + 2.0 * q.z)).abs() < 1e-12 && (p.zx - q.zx).abs() < 1e-12);
        assert!((p.zxy - q.zxy / 2.0).abs() < 1e-12);
    }
}
