//! The interval of a mean: noise by Student's t, and the kind of surface by what other kinds say.
//!
//! ```text
//! noise    mean +- k u_noise,  k = t_{dof}((1 + level)/2)        dof infinite where the noise was declared
//! total    the hull with the interval of other kinds of surface  u = reach of its farther end / k
//! ```

use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::erf;

use crate::fit::describe::shape::Statistic;
use crate::shape::{Interval, Spread};

/// Degrees of freedom from which on the expansion serves; its error is below 1e-7 there.
const MANY: f64 = 30.0;

/// Uncertainty of a mean from noise alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoisePart {
    /// Standard uncertainty.
    pub(super) u: f64,
    /// Its degrees of freedom.
    pub(super) dof: f64,
    /// A value that the interval has to reach.
    pub(super) reaches: Option<f64>,
}

impl NoisePart {
    /// Of a value whose errors have this law about it.
    pub(super) fn new(u: f64, dof: f64) -> NoisePart {
        NoisePart { u, dof, reaches: None }
    }
}

/// Number of standard uncertainties to either side that hold the truth with this probability.
pub(super) fn coverage_factor(dof: f64, level: f64) -> f64 {
    let normal = std::f64::consts::SQRT_2 * erf::erf_inv(level);
    if dof >= MANY {
        // R. A. Fisher and E. A. Cornish, Technometrics 2 (1960) 209; the inverse of the law itself takes longer than a fit
        let (x, x2, v) = (normal, normal * normal, 1.0 / dof);
        let terms = [
            (x2 + 1.0) / 4.0,
            ((5.0 * x2 + 16.0) * x2 + 3.0) / 96.0,
            (((3.0 * x2 + 19.0) * x2 + 17.0) * x2 - 15.0) / 384.0,
            ((((79.0 * x2 + 776.0) * x2 + 1482.0) * x2 - 1920.0) * x2 - 945.0) / 92_160.0,
        ];
        return x * (1.0 + v * (terms[0] + v * (terms[1] + v * (terms[2] + v * terms[3]))));
    }
    StudentsT::new(0.0, 1.0, dof).map_or(normal, |law| law.inverse_cdf(0.5 * (1.0 + level)))
}

/// Mean and spread with the uncertainty of the mean and its interval within these bounds; `other` is the interval that
/// other kinds of surface give.
pub(super) fn statistic(
    spread: Spread,
    noise: Option<NoisePart>,
    other: Option<[f64; 2]>,
    level: f64,
    [floor, ceiling]: [f64; 2],
) -> Statistic {
    let bare = Statistic { mean: spread.mean, sd: spread.sd, ..Statistic::default() };
    // where noise cannot be told, other kinds of surface still say something
    let noise = noise.or(other.map(|_| NoisePart::new(0.0, f64::INFINITY)));
    let Some((mean, noise)) = spread.mean.zip(noise) else { return bare };
    let k = coverage_factor(noise.dof, level);
    let end = noise.reaches.unwrap_or(mean);
    let own = [(mean - k * noise.u).min(end), (mean + k * noise.u).max(end)];
    let hull = other.map_or(own, |[lo, hi]| [lo.min(own[0]), hi.max(own[1])]);
    // half an interval of no width is no uncertainty
    let reach = |[lo, hi]: [f64; 2], u: f64| if k > 0.0 { ((mean - lo).max(hi - mean) / k).max(u) } else { u };
    let u_noise = reach(own, noise.u);
    let u = reach(hull, u_noise);
    Statistic {
        u: Some(u),
        interval: Some(Interval { lo: hull[0].max(floor), hi: hull[1].min(ceiling) }),
        u_noise: Some(u_noise),
        u_model: other.map(|_| (u * u - u_noise * u_noise).max(0.0).sqrt()),
        dof: Some(noise.dof),
        coverage_factor: Some(k),
        ..bare
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_holds_both_intervals_and_the_parts_add_up() {
        assert!((coverage_factor(f64::INFINITY, 0.95) - 1.959_963_984_540_054).abs() < 1e-12);
        assert!((coverage_factor(5.0, 0.95) - 2.570_581_835_636_314).abs() < 1e-9);
        assert!((coverage_factor(40.0, 0.95) - 2.021_075_390_306_273).abs() < 1e-7);
        let spread = Spread { mean: Some(1.0), sd: Some(0.5), count: 4 };
        let noise = Some(NoisePart::new(0.1, f64::INFINITY));
        let alone = statistic(spread, noise, None, 0.95, [0.0, f64::INFINITY]);
        assert!((alone.interval.unwrap().hi - 1.195_996_398).abs() < 1e-8 && alone.u_model.is_none());
        let both = statistic(spread, noise, Some([1.3, 1.4]), 0.95, [0.0, f64::INFINITY]);
        let (interval, k) = (both.interval.unwrap(), both.coverage_factor.unwrap());
        assert_eq!((interval.lo, interval.hi), (alone.interval.unwrap().lo, 1.4));
        assert!((k * both.u.unwrap() - 0.4).abs() < 1e-12);
        let parts = both.u_noise.unwrap().hypot(both.u_model.unwrap());
        assert!((parts - both.u.unwrap()).abs() < 1e-12);
        let held = statistic(spread, noise, Some([0.9, 1.1]), 0.95, [0.0, 1.05]);
        assert_eq!((held.u, held.u_model, held.interval.unwrap().hi), (Some(0.1), Some(0.0), 1.05));
    }
}
