//! Intervals, class probabilities, radius.

use statrs::function::erf;

use crate::curvature::ShapeClass;

/// Both ends of an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Interval {
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

/// `mean +- z u` at the given level, cut to `[floor, ceiling]`.
pub fn normal_interval(mean: f64, u: f64, level: f64, floor: f64, ceiling: f64) -> Interval {
    let z = std::f64::consts::SQRT_2 * erf::erf_inv(level);
    Interval { lo: (mean - z * u).max(floor), hi: (mean + z * u).min(ceiling) }
}

/// Probability of each curved class where mean S is distributed as N(mean, u^2); the tails belong to the outermost
/// classes.
pub fn class_probabilities(mean: f64, u: f64) -> Vec<(ShapeClass, f64)> {
    // upper tail Q((edge - mean)/u), by erfc because 1 - Phi loses digits
    let above = |edge: f64| {
        if edge.is_infinite() {
            return if edge > 0.0 { 0.0 } else { 1.0 };
        }
        0.5 * erf::erfc((edge - mean) / (u * std::f64::consts::SQRT_2))
    };
    ShapeClass::CURVED
        .into_iter()
        .map(|class| {
            let share = if u > 0.0 {
                let (lo, hi) = class.edges().unwrap_or((0.0, 0.0));
                above(lo) - above(hi)
            } else {
                f64::from(u8::from(ShapeClass::of_shape_index(mean) == class))
            };
            (class, share)
        })
        .collect()
}

/// 1/R of spheres, 1/(R sqrt 2) of cylinders, `None` for everything else (paper Table 2).
pub fn radius_of(class: ShapeClass, curvedness: f64) -> Option<f64> {
    match class {
        ShapeClass::Cap | ShapeClass::Cup => Some(1.0 / curvedness),
        ShapeClass::Ridge | ShapeClass::Rut => Some(1.0 / (curvedness * std::f64::consts::SQRT_2)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_sum_to_one_and_collapse_without_noise() {
        for (mean, u) in [(0.5, 0.05), (-1.0, 0.2), (0.62, 0.3), (0.1, 0.0)] {
            let shares = class_probabilities(mean, u);
            assert!((shares.iter().map(|s| s.1).sum::<f64>() - 1.0).abs() < 1e-14);
        }
        let i = normal_interval(0.9, 0.1, 0.95, -1.0, 1.0);
        assert!((i.lo - (0.9 - 0.195_996_398_454_005_4)).abs() < 1e-12 && i.hi == 1.0);
    }
}
