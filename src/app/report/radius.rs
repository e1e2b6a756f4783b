//! Between which bounds the radius lies: those that were found, or else the interval of R turned round, since
//!
//! ```text
//! radius = factor / R        factor 1 of a ball, 1 / sqrt 2 of a pipe
//! ```

use super::document::ShapePart;

/// Lower and upper bound, where known; an upper bound that is missing beside a lower one is infinite.
pub(crate) fn radius_bounds(shape: &ShapePart) -> [Option<f64>; 2] {
    if let Some([lo, hi]) = shape.radius_interval {
        return [Some(lo), Some(hi)];
    }
    let (Some(radius), Some(mean), Some([lo, hi])) = (shape.radius, shape.curvedness.mean, shape.curvedness.interval)
    else {
        return [None; 2];
    };
    [hi, lo].map(|end| Some(radius * mean / end).filter(|bound| bound.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::super::document::MeasurePart;
    use super::*;

    #[test]
    fn the_interval_of_r_is_turned_round_where_no_other_is_known() {
        let part = |interval| MeasurePart { mean: Some(0.1), interval: Some(interval), ..MeasurePart::default() };
        let mut shape = super::super::sample::full_document().shape;
        (shape.radius, shape.radius_interval, shape.curvedness) = (Some(10.0), None, part([0.08, 0.125]));
        assert_eq!(radius_bounds(&shape), [Some(8.0), Some(12.5)]);
        shape.curvedness = part([0.0, 0.125]);
        assert_eq!(radius_bounds(&shape), [Some(8.0), None]);
        shape.radius_interval = Some([9.0, 11.0]);
        assert_eq!(radius_bounds(&shape), [Some(9.0), Some(11.0)]);
    }
}
