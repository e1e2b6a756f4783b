//! Replicates that need the whole fit: whatever `palpate fit` would do with these contacts, in the domain that stands still.

use super::quantity::Quantity;
use palpate_fitting::fit::{Fit, FitError, FitOptions};
use palpate_fitting::parametric::FittedSurface;
use palpate_geometry::contact::Contacts;
use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::shape::radius_of;
use palpate_world::scene::Truth;

/// Options and what is asked.
#[derive(Clone, Debug)]
pub(super) struct Whole {
    options: FitOptions,
    quantities: Vec<Quantity>,
}

impl Whole {
    /// Fits with these options.
    pub(super) fn new(options: FitOptions, quantities: Vec<Quantity>) -> Whole {
        Whole { options, quantities }
    }

    /// The quantities of one replicate, and whether the fit could not be told from a plane.
    ///
    /// # Errors
    /// Every [`FitError`].
    pub(super) fn values(&self, (contacts, _): (Contacts, Truth)) -> Result<(Vec<f64>, bool), FitError> {
        match FittedSurface::of(&contacts, &self.options)?.0 {
            FittedSurface::Height(fit) => {
                let plane = fit.shape().class == ShapeClass::Plane;
                Ok((self.of_height(&fit), plane))
            }
            FittedSurface::Parametric(fit) => {
                let shape = fit.shape();
                let mut values = vec![f64::NAN; self.quantities.len()];
                values[0] = shape.shape_index.mean.unwrap_or(f64::NAN);
                values[1] = shape.curvedness.mean.unwrap_or(f64::NAN);
                Ok((values, shape.class == ShapeClass::Plane))
            }
        }
    }

    fn of_height(&self, fit: &Fit) -> Vec<f64> {
        let shape = fit.shape();
        let maps = &shape.maps;
        let (mut s, mut defined, mut r, mut points, mut k1, mut k2) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for i in 0..maps.grid.x.len() {
            for j in 0..maps.grid.y.len() {
                let Some(curvedness) = maps.curvedness_at(i, j) else { continue };
                (r, k1, k2, points) = (r + curvedness, k1 + maps.k1[[i, j]], k2 + maps.k2[[i, j]], points + 1.0);
                if let Some(own) = maps.shape_index_at(i, j) {
                    (s, defined) = (s + own, defined + 1.0);
                }
            }
        }
        let (s, r) = (s / defined, r / points);
        let of = |quantity: &Quantity| match quantity {
            Quantity::ShapeIndex => s,
            Quantity::Curvedness => r,
            Quantity::K1 => k1 / points,
            Quantity::K2 => k2 / points,
            Quantity::Radius if s.is_nan() => f64::NAN,
            Quantity::Radius => radius_of(ShapeClass::of_shape_index(s), r).unwrap_or(f64::NAN),
            Quantity::Direction => shape.direction_deg.unwrap_or(f64::NAN),
            Quantity::ShapeIndexAt([x, y])
            | Quantity::CurvednessAt([x, y])
            | Quantity::K1At([x, y])
            | Quantity::K2At([x, y]) => {
                let frame = fit.frame();
                let [ox, oy, _] = frame.origin;
                let at = fit.surface().at((x - ox) / frame.scale, (y - oy) / frame.scale);
                at.derivatives().principal().map_or(f64::NAN, |p| quantity.at_point(&p, frame.scale))
            }
        };
        self.quantities.iter().map(of).collect()
    }
}
