//! The serialised form of surfaces: degrees, knots and nested rows of coefficients, checked when they are read.

use ndarray::Array2;

use palpate_numeric::bspline::{Knots, SplineError};

/// One knot vector.
#[derive(serde::Serialize, serde::Deserialize)]
struct SavedKnots {
    degree: usize,
    closed: bool,
    knots: Vec<f64>,
}

/// A surface with coefficients `C`: `f64` of a height field, `[f64; 3]` of a parametric surface.
#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct SavedSurface<C> {
    knots: [SavedKnots; 2],
    coefficients: Vec<Vec<C>>,
}

impl SavedKnots {
    fn of(knots: &Knots) -> SavedKnots {
        SavedKnots { degree: knots.degree(), closed: knots.is_closed(), knots: knots.as_slice().to_vec() }
    }

    fn read(self) -> Result<Knots, SplineError> {
        if self.closed {
            return Knots::closed_from(self.degree, &self.knots);
        }
        let knots = Knots::new(self.degree, self.knots)?;
        // made as uniform knots again, they find the segment of a point without a search
        let [lo, hi] = knots.domain();
        let uniform = Knots::uniform(self.degree, knots.n_segments(), lo, hi);
        Ok(uniform.ok().filter(|uniform| uniform.as_slice() == knots.as_slice()).unwrap_or(knots))
    }
}

impl<C: Copy> SavedSurface<C> {
    pub(super) fn of(knots: &[Knots; 2], coefficients: &Array2<C>) -> SavedSurface<C> {
        SavedSurface {
            knots: knots.each_ref().map(SavedKnots::of),
            coefficients: coefficients.rows().into_iter().map(|row| row.to_vec()).collect(),
        }
    }

    pub(super) fn read(self) -> Result<([Knots; 2], Array2<C>), SplineError> {
        let [u, v] = self.knots;
        let knots = [u.read()?, v.read()?];
        let expected = [knots[0].n_basis(), knots[1].n_basis()];
        let columns = self.coefficients.iter().map(Vec::len).find(|m| *m != expected[1]).unwrap_or(expected[1]);
        let found = [self.coefficients.len(), columns];
        let flat = self.coefficients.into_iter().flatten().collect();
        let array = Array2::from_shape_vec((found[0], found[1]), flat).ok().filter(|_| found == expected);
        Ok((knots, array.ok_or(SplineError::Shape { found, expected })?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{HeightField, Parametric};

    #[test]
    fn surfaces_come_back_and_faulty_ones_do_not() {
        let knots = || [Knots::uniform(2, 2, 0.0, 1.0).unwrap(), Knots::uniform(1, 1, 0.0, 1.0).unwrap()];
        let c = Array2::from_shape_fn((4, 2), |(i, j)| 0.1 * i as f64 + 7.0 * j as f64);
        let surface = HeightField::new(knots(), c).unwrap();
        let text = serde_json::to_string(&surface).unwrap();
        let back: HeightField = serde_json::from_str(&text).unwrap();
        assert_eq!((back.at(0.3, 0.7), back.coefficients()), (surface.at(0.3, 0.7), surface.coefficients()));
        let ragged = text.replace("[0.0,7.0]", "[0.0]");
        assert!(serde_json::from_str::<HeightField>(&ragged).unwrap_err().to_string().contains("call for"));

        let closed = [Knots::closed(2, 4, 0.0, 1.0).unwrap(), Knots::uniform(1, 1, 0.0, 1.0).unwrap()];
        let free: Vec<[f64; 3]> = (0..8).map(|k| [f64::from(k), f64::from(k * k), 0.25]).collect();
        let tube = Parametric::from_free(closed, &free).unwrap();
        let text = serde_json::to_string(&tube).unwrap();
        assert_eq!(serde_json::from_str::<Parametric>(&text).unwrap(), tube);
        let torn = text.replacen("[0.0,0.0,0.25]", "[9.0,0.0,0.25]", 1);
        assert!(serde_json::from_str::<Parametric>(&torn).unwrap_err().to_string().contains("does not repeat"));
    }
}
