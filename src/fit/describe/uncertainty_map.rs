//! The uncertainty that noise leaves in S and R at single points, over a coarse grid that covers the domain.
//!
//! ```text
//! u_S(x, y)^2 = g' C g,   g = dS(x, y)/dc,   C the covariance of the coefficients c        likewise R
//! ```
//!
//! A point is known far less well than the mean over the patch. What another kind of surface would say is not counted.

use super::uncertainty::of_mean;
use crate::bspline::linspace;
use crate::fit::noise::declared::declared_off;
use crate::fit::solved::Solved;
use crate::shape::{by_coefficients, shape_gradient};

/// Numbers that may be looked at for the whole grid: a few tenths of a second. Every point takes two solutions with the
/// factor and two passes over the rows.
const WORK: usize = 200_000_000;

/// Points a side: at most as many as a picture shows, and at least as many as show where the patch is known worst.
const SIDES: [usize; 2] = [5, 25];

/// Standard uncertainties over an evenly spaced grid, both ends of the domain included.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct UncertaintyMap {
    /// Points along x and y.
    pub side: usize,
    /// Of S and of R (1/length of the input), y running fastest; NaN where there is none.
    pub values: Vec<[f64; 2]>,
}

impl UncertaintyMap {
    /// Of a solved fit; `None` where that would take longer than a picture is worth.
    pub(super) fn new(solved: &Solved) -> Option<UncertaintyMap> {
        let unknowns = solved.surface.coefficients().len();
        // a factor holds some tens of numbers for every unknown
        let of_point = 2 * (9 * solved.fitted.equations.count() + 60 * unknowns);
        let side = ((WORK / of_point.max(1)) as f64).sqrt() as usize;
        if side < SIDES[0] {
            return None;
        }
        let side = side.min(SIDES[1]);
        let [x, y] = [0, 1].map(|k| {
            let [lo, hi] = solved.patch.knots[k].domain();
            linspace(lo, hi, side)
        });
        let above = declared_off(solved).map(|factor| factor.unwrap_or(1.0).max(1.0));
        let places = x.iter().flat_map(|x| y.iter().map(move |y| [*x, *y]));
        let values = places.map(|place| at(solved, place, above)).collect();
        Some(UncertaintyMap { side, values })
    }
}

/// Standard uncertainties of S and R at one point.
fn at(solved: &Solved, [x, y]: [f64; 2], above: [f64; 2]) -> [f64; 2] {
    let surface = &solved.surface;
    let (bx, by) = (surface.knots()[0].basis(x), surface.knots()[1].basis(y));
    let gradient = shape_gradient(&surface.with_rows(&bx, &by));
    let columns = surface.coefficients().ncols();
    let of = |derivatives: &[f64; 5]| {
        let mut out = vec![0.0; surface.coefficients().len()];
        by_coefficients(derivatives, &bx, &by, |a, b, value| out[(bx.first + a) * columns + by.first + b] = value);
        of_mean(solved, &out, above).map_or(f64::NAN, |part| part.u)
    };
    // nothing between -1 and 1 has a larger standard deviation than 1
    [of(&gradient.shape_index).min(1.0), of(&gradient.curvedness) / solved.patch.frame.scale]
}

#[cfg(test)]
mod tests {
    use crate::contact::Contacts;
    use crate::fit::{FitOptions, Objective, SlopeWeights, fit_contacts};

    #[test]
    fn the_middle_is_known_better_than_the_corners() {
        let at = |k: usize| ((k % 9) as f64 - 4.0, (k / 9) as f64 - 4.0);
        let noise = |k: usize| 0.01 * ((k * 7919 % 101) as f64 / 50.0 - 1.0);
        let (x, y): (Vec<f64>, Vec<f64>) = (0..81).map(at).unzip();
        let z = (0..81).map(|k| -0.05 * x[k] * x[k] + noise(k)).collect();
        let options = FitOptions { objective: Objective::Slopes(SlopeWeights::Auto), ..FitOptions::default() };
        let fit = fit_contacts(&Contacts::from_positions(x, y, z), &options).unwrap();
        let map = fit.uncertainty_map().unwrap();
        assert_eq!(map.values.len(), map.side * map.side);
        let (corner, middle) = (map.values[0], map.values[map.values.len() / 2]);
        for q in 0..2 {
            assert!(middle[q] > 0.0 && corner[q] >= middle[q], "{corner:?} {middle:?}");
        }
    }
}
