//! Whether places stand over each other, as on a wall that is seen from its end.
//!
//! ```text
//! q  the place next to p in the plane of the patch        |z_p - z_q| > tan(reach) |xy_p - xy_q|   at most places
//! ```
//!
//! Along a ring or two rows the height follows the place, whatever surface they lie on, and does not tell how it bends. All over a short
//! pipe, which looks like a ring from its end, any height stands over a place.

use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::vector::Vector;

/// Whether most places, in the axes of their patch, are steeper over the next than a surface may be that reaches this far from its normal.
pub(crate) fn stand_upright(places: &[Vector], reach_deg: f64) -> bool {
    let flat: Vec<Vector> = places.iter().map(|[x, y, _]| [*x, *y, 0.0]).collect();
    let tree = Neighbours::new(&flat);
    let steepest = reach_deg.to_radians().tan();
    let is_steep = |i: &usize| {
        tree.nearest_other(*i).is_some_and(|(apart, next)| (places[*i][2] - places[next][2]).abs() > steepest * apart)
    };
    2 * (0..places.len()).filter(is_steep).count() > places.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places on a pipe of radius 1, as high as given, in turns of the golden angle.
    fn pipe(height: f64) -> Vec<Vector> {
        let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        let place = |k: usize| {
            let (sin, cos) = (golden * k as f64).sin_cos();
            [cos, sin, height * (k as f64 / 119.0 - 0.5)]
        };
        (0..120).map(place).collect()
    }

    #[test]
    fn a_short_pipe_stands_upright_and_rings_and_rows_do_not() {
        let on_ball = |x: f64, y: f64| [x, y, (100.0 - x * x - y * y).sqrt() - 10.0];
        let rows = |gap: f64| (0..30).map(|k| on_ball(gap * f64::from(k % 2), 0.5 * f64::from(k / 2) - 4.0)).collect();
        let rings: [Vec<Vector>; 4] = [pipe(0.0), pipe(0.01), rows(1.0), rows(6.0)];
        assert!(rings.iter().all(|places| !stand_upright(places, 60.0)));
        assert!(stand_upright(&pipe(1.0), 60.0));
    }
}
