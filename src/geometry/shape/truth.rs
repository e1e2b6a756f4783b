//! The fitted shape against the true one, point by point.
//!
//! ```text
//! S, R          means of the truth over the points that the fit used, S where it is defined
//! error_S^2     mean of (S_fit - S_true)^2 over the points where both are defined, error_R likewise
//! ```

use super::ShapeMaps;

/// The true shape over the points of a fit, and the error of the fit. `None` where nothing can be compared.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TruthComparison {
    /// Mean true shape index.
    pub shape_index: Option<f64>,
    /// Mean true curvedness, 1/length.
    pub curvedness: Option<f64>,
    /// Pointwise rms error of S.
    pub error_shape_index: Option<f64>,
    /// Pointwise rms error of R, 1/length.
    pub error_curvedness: Option<f64>,
}

/// Shape index (where defined) and curvedness at one point.
pub type ShapeAt = (Option<f64>, f64);

/// Compares maps with `truth(x, y, z)`, which is `None` where the true surface does not reach.
pub fn compare_with_truth(maps: &ShapeMaps, truth: impl Fn([f64; 3]) -> Option<ShapeAt>) -> TruthComparison {
    let place = |(i, j)| [maps.grid.x[i], maps.grid.y[j], maps.points[[i, j]].z];
    let found = |(i, j)| (maps.shape_index_at(i, j), maps.curvedness[[i, j]]);
    compare_pairs(maps.supported_points().filter_map(|at| Some([found(at), truth(place(at))?])))
}

/// Compares what was found at each place with what is true there, in this order.
pub fn compare_pairs(pairs: impl Iterator<Item = [ShapeAt; 2]>) -> TruthComparison {
    let [mut s, mut r, mut error_s, mut error_r] = [Mean::default(); 4];
    for [(found_s, found_r), (true_s, true_r)] in pairs {
        r.add(true_r);
        error_r.add((found_r - true_r).powi(2));
        let Some(true_s) = true_s else { continue };
        // where a plane was found the surface has its S all the same
        s.add(true_s);
        if let Some(found_s) = found_s {
            error_s.add((found_s - true_s).powi(2));
        }
    }
    TruthComparison {
        shape_index: s.get(),
        curvedness: r.get(),
        error_shape_index: error_s.get().map(f64::sqrt),
        error_curvedness: error_r.get().map(f64::sqrt),
    }
}

#[derive(Clone, Copy, Default)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1.0;
    }

    fn get(self) -> Option<f64> {
        (self.count > 0.0).then(|| self.sum / self.count)
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;
    use crate::shape::ShapeGrid;
    use crate::surface::HeightField;
    use palpate_numeric::bspline::Knots;

    #[test]
    fn errors_are_root_mean_squares_over_supported_points() {
        let knots = [Knots::uniform(2, 1, 0.0, 1.0).unwrap(), Knots::uniform(2, 1, 0.0, 1.0).unwrap()];
        let surface = HeightField::new(knots, Array2::from_shape_fn((3, 3), |(i, _)| (i as f64).powi(2))).unwrap();
        let mut maps = surface.shape_maps(ShapeGrid::over([[0.0, 1.0]; 2], [2, 2], 0.0), &[]);
        maps.supported[[0, 0]] = false;
        maps.curvedness.fill(1.0);
        let found = compare_with_truth(&maps, |[x, _, _]| Some((None, 1.0 + 3.0 * x)));
        assert_eq!((found.shape_index, found.error_shape_index), (None, None));
        // one supported point at x = 0 with error 0, two at x = 1 with error 3
        assert_eq!(found.curvedness, Some(3.0));
        assert!((found.error_curvedness.unwrap() - 6.0_f64.sqrt()).abs() < 1e-15);
    }
}
