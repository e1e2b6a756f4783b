//! Two surfaces compared: height or distance, normal, S and R, each against its uncertainty.
//!
//! ```text
//! same axes      d = z_B(x, y) - z_A(x, y) over the common part of both domains, u(d) along z
//! otherwise      d = distance from A to B along A's normal, where the normal meets B
//! normal         angle between the normals       S, R: their differences at the same two points
//! u^2 = u_A^2 + u_B^2                            ratio = |d| / u
//! ```
//!
//! The surfaces are the same within what the data tell when no ratio exceeds `t`, the quantile beyond which one of all
//! comparisons falls by chance with probability 5 %. There are as many independent comparisons as the larger spline has
//! coefficients, at most as many as points, for each of four quantities (Bonferroni). The two are taken as independent:
//! for two fits of the same contacts, u is too large.

mod foot;
mod side;

use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::erf;

pub(crate) use side::{ComparedSurface, Side};

use foot::Feet;
use palpate_geometry::shape::spread;
use palpate_numeric::vector::{dot, minus, norm};
use side::Here;

/// Height or distance, normal, S, R.
pub(crate) const QUANTITIES: usize = 4;

/// Chance that surfaces which are the same are called different.
const CHANCE: f64 = 0.05;

/// Share of the normals that must point to the other side before the free sides are said to differ.
const OPPOSITE: f64 = 0.5;

/// Numbers of the four quantities; `None` where undefined.
pub(crate) type Quantities = [Option<f64>; QUANTITIES];

/// Why two surfaces cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NotComparable {
    /// They have no part in common; least and largest coordinates of both.
    Apart {
        /// Of the first.
        a: [[f64; 3]; 2],
        /// Of the second.
        b: [[f64; 3]; 2],
    },
    /// Their normals point to opposite sides.
    OppositeSides,
}

/// One point at which both surfaces are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ComparedPoint {
    /// On the first surface, input coordinates.
    pub(crate) place: [f64; 3],
    /// B less A; the normal as an angle in degrees.
    pub(crate) difference: Quantities,
    /// Their standard uncertainties.
    pub(crate) u: Quantities,
}

impl ComparedPoint {
    /// Differences in units of their uncertainty.
    pub(crate) fn ratio(&self, quantity: usize) -> Option<f64> {
        let (d, u) = (self.difference[quantity]?.abs(), self.u[quantity]?);
        // no difference is none, however little is known of it
        if d == 0.0 { Some(0.0) } else { Some(d / u).filter(|r| !r.is_nan()) }
    }
}

/// One quantity over all points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct QuantitySummary {
    /// Points at which it is defined on both.
    pub(crate) points: usize,
    /// Mean difference.
    pub(crate) mean: Option<f64>,
    /// Root mean square difference.
    pub(crate) rms: Option<f64>,
    /// Difference that is largest in size, and its point.
    pub(crate) largest: Option<(f64, [f64; 3])>,
    /// Mean uncertainty.
    pub(crate) u: Option<f64>,
    /// Largest ratio, and its point.
    pub(crate) worst: Option<(f64, [f64; 3])>,
    /// Points whose ratio exceeds the threshold, of those that have one.
    pub(crate) beyond: [usize; 2],
}

/// Two surfaces compared.
#[derive(Clone, Debug)]
pub(crate) struct Comparison {
    /// Whether heights along one axis were compared, rather than distances along normals.
    pub(crate) heights: bool,
    /// Places along both directions of the first surface's chart.
    pub(crate) at: [Vec<f64>; 2],
    /// The second direction runs fastest; `None` where one of the surfaces is not, or is not supported.
    pub(crate) points: Vec<Option<ComparedPoint>>,
    /// Height or distance, normal, S, R.
    pub(crate) quantities: [QuantitySummary; QUANTITIES],
    /// Ratio that chance does not exceed.
    pub(crate) threshold: f64,
    /// Whether they are the same within what the data tell; `None` where neither carries uncertainties.
    pub(crate) same: Option<bool>,
}

/// Compares two surfaces at `points` places each way.
///
/// # Errors
/// [`NotComparable`].
pub(crate) fn compare(a: &Side, b: &Side, points: [usize; 2]) -> Result<Comparison, NotComparable> {
    let apart = || NotComparable::Apart { a: a.bounds(), b: b.bounds() };
    let heights = a.shares_axes_with(b);
    let domain = if heights { a.common_domain(b).ok_or_else(apart)? } else { a.domain() };
    let at = [0, 1].map(|k| palpate_numeric::bspline::linspace(domain[k][0], domain[k][1], points[k]));
    let feet = (!heights).then(|| Feet::new(b));
    let places = at[0].iter().flat_map(|u| at[1].iter().map(move |v| [*u, *v]));
    let both: Vec<Option<(Here, Here)>> = places
        .map(|place| {
            let here = a.at(place)?;
            let there = match &feet {
                None => b.at(place)?,
                Some(feet) => b.at(feet.along(here.point, here.normal)?)?,
            };
            Some((here, there))
        })
        .collect();
    let count = both.iter().flatten().count();
    if count == 0 {
        return Err(apart());
    }
    let opposite = both.iter().flatten().filter(|(a, b)| dot(a.normal, b.normal) < 0.0).count();
    if opposite as f64 > OPPOSITE * count as f64 {
        return Err(NotComparable::OppositeSides);
    }
    let compared = both.iter().map(|pair| pair.as_ref().map(|(here, there)| compared(here, there, a, heights)));
    let compared: Vec<Option<ComparedPoint>> = compared.collect();
    let independent = count.min(a.unknowns().max(b.unknowns())) * QUANTITIES;
    let threshold = threshold(independent, a.dof.into_iter().chain(b.dof).fold(f64::INFINITY, f64::min));
    let quantities = std::array::from_fn(|k| summary(&compared, k, threshold));
    let judged = quantities.iter().any(|q: &QuantitySummary| q.beyond[1] > 0);
    let same = judged.then(|| quantities.iter().all(|q| q.beyond[0] == 0));
    Ok(Comparison { heights, at, points: compared, quantities, threshold, same })
}

fn compared(here: &Here, there: &Here, a: &Side, heights: bool) -> ComparedPoint {
    let offset = minus(there.point, here.point);
    // along z of the common axes, or along the normal, to whose side the distance counts
    let (d, along) = if heights {
        let up = a.up();
        (dot(offset, up), dot(here.normal, up))
    } else {
        (dot(offset, here.normal), 1.0)
    };
    let chord = norm(minus(there.normal, here.normal));
    let angle = 2.0 * (0.5 * chord).clamp(0.0, 1.0).asin().to_degrees();
    let both = |k: usize| match (here.u[k], there.u[k]) {
        (Some(a), Some(b)) => Some(a.hypot(b)),
        (a, b) => a.or(b),
    };
    let difference = |a: Option<f64>, b: Option<f64>| Some(b? - a?);
    ComparedPoint {
        place: here.point,
        difference: [
            Some(d),
            Some(angle),
            difference(here.shape_index, there.shape_index),
            difference(here.curvedness, there.curvedness),
        ],
        // an uncertainty along the normal is a larger one along z
        u: [both(0).map(|u| u / along.abs()), both(1), both(2), both(3)],
    }
}

fn summary(points: &[Option<ComparedPoint>], quantity: usize, threshold: f64) -> QuantitySummary {
    let known = || points.iter().flatten().filter_map(|p| Some((p, p.difference[quantity]?)));
    let count = known().count();
    let largest = known().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map(|(p, d)| (d, p.place));
    let ratios = || points.iter().flatten().filter_map(|p| Some((p.ratio(quantity)?, p.place)));
    QuantitySummary {
        points: count,
        mean: spread(known().map(|(_, d)| d).collect::<Vec<_>>().into_iter()).mean,
        rms: (count > 0).then(|| (known().map(|(_, d)| d * d).sum::<f64>() / count as f64).sqrt()),
        largest,
        u: spread(points.iter().flatten().filter_map(|p| p.u[quantity]).collect::<Vec<_>>().into_iter()).mean,
        worst: ratios().max_by(|a, b| a.0.total_cmp(&b.0)),
        beyond: [ratios().filter(|(r, _)| *r > threshold).count(), ratios().count()],
    }
}

/// Two-sided quantile beyond which one of `independent` comparisons falls with probability [`CHANCE`].
fn threshold(independent: usize, dof: f64) -> f64 {
    let tail = CHANCE / independent.max(1) as f64;
    let gaussian = std::f64::consts::SQRT_2 * erf::erfc_inv(tail);
    match StudentsT::new(0.0, 1.0, dof) {
        Ok(law) if dof.is_finite() => law.inverse_cdf(1.0 - 0.5 * tail),
        _ => gaussian,
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;
    use palpate_geometry::contact::Frame;
    use palpate_geometry::surface::{HeightField, Parametric};
    use palpate_numeric::bspline::Knots;

    /// z = bend x^2 + lift over [0, 2] x [0, 2].
    fn bowl(bend: f64, lift: f64) -> HeightField {
        let axis = Knots::uniform(2, 1, 0.0, 2.0).unwrap();
        let along = [0.0, 0.0, 4.0 * bend];
        let coefficients = Array2::from_shape_fn((3, 3), |(i, _)| along[i] + lift);
        HeightField::new([axis.clone(), axis], coefficients).unwrap()
    }

    fn in_space(field: &HeightField) -> Parametric {
        let [x, y] = field.knots().each_ref().map(Knots::greville);
        let at = |(i, j): (usize, usize)| [x[i], y[j], field.coefficients()[[i, j]]];
        Parametric::new(field.knots().clone(), Array2::from_shape_fn((3, 3), at)).unwrap()
    }

    fn side<'a>(surface: ComparedSurface<'a>, u: &'a dyn Fn([f64; 2]) -> Quantities) -> Side<'a> {
        Side { surface, supported: &|_| true, uncertainty: u, dof: None }
    }

    #[test]
    fn heights_along_z_and_distances_along_normals_agree() {
        let (a, b) = (bowl(0.1, 0.0), bowl(0.1, 0.01));
        let u = |_: [f64; 2]| [Some(0.02), Some(1.0), Some(0.1), Some(0.1)];
        let none = |_: [f64; 2]| [None; QUANTITIES];
        let height = |f| ComparedSurface::Height(f, &Frame::IDENTITY);
        let found = compare(&side(height(&a), &u), &side(height(&b), &none), [5, 5]).unwrap();
        assert!(found.heights && found.same == Some(true));
        assert!((found.quantities[0].rms.unwrap() - 0.01).abs() < 1e-15);
        assert!(found.quantities[1].rms.unwrap() < 1e-14);
        let map = in_space(&b);
        let found = compare(&side(height(&a), &none), &side(ComparedSurface::Space(&map), &none), [5, 5]).unwrap();
        assert!(!found.heights && found.same.is_none());
        // at x = 0 the normal is z
        let first = found.points[2].unwrap();
        assert!((first.difference[0].unwrap() - 0.01).abs() < 1e-12, "{first:?}");
        let last = found.points[22].unwrap();
        let expected = 0.01 / 0.4_f64.hypot(1.0);
        assert!((last.difference[0].unwrap() - expected).abs() < 1e-4, "{last:?}");
    }

    #[test]
    fn a_difference_beyond_chance_is_found_at_its_place() {
        let (a, b) = (bowl(0.1, 0.0), bowl(0.12, 0.0));
        let u = |_: [f64; 2]| [Some(0.005), None, None, None];
        let height = |f| ComparedSurface::Height(f, &Frame::IDENTITY);
        let found = compare(&side(height(&a), &u), &side(height(&b), &u), [5, 5]).unwrap();
        assert_eq!(found.same, Some(false));
        let (ratio, place) = found.quantities[0].worst.unwrap();
        // 0.02 x^2 at x = 2, the uncertainty along z larger than along the normal
        let w = 0.4_f64.hypot(1.0);
        let w_b = 0.48_f64.hypot(1.0);
        assert!(ratio > 8.0 && place[0] == 2.0 && w < w_b, "{ratio}");
    }

    #[test]
    fn surfaces_apart_and_opposite_sides_are_refused() {
        let (a, far) = (bowl(0.1, 0.0), bowl(0.1, 0.0).placed([100.0, 0.0, 0.0], 1.0).unwrap());
        let none = |_: [f64; 2]| [None; QUANTITIES];
        let height = |f| ComparedSurface::Height(f, &Frame::IDENTITY);
        let outcome = compare(&side(height(&a), &none), &side(height(&far), &none), [5, 5]);
        assert!(matches!(outcome, Err(NotComparable::Apart { .. })));
        let map = in_space(&a);
        let [u, v] = map.knots();
        let turned = map.coefficients().t().to_owned();
        let turned = Parametric::new([v.clone(), u.clone()], turned).unwrap();
        let outcome = compare(&side(height(&a), &none), &side(ComparedSurface::Space(&turned), &none), [5, 5]);
        assert!(matches!(outcome, Err(NotComparable::OppositeSides)));
    }

    #[test]
    fn more_comparisons_and_fewer_degrees_of_freedom_raise_the_threshold() {
        assert!((threshold(1, f64::INFINITY) - 1.959_964).abs() < 1e-5);
        assert!(threshold(36, f64::INFINITY) > 3.0 && threshold(36, 10.0) > threshold(36, f64::INFINITY));
    }
}
