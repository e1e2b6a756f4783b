//! The interval of a mean: noise by Student's t, and the kind of surface by what other kinds say.
//!
//! ```text
//! noise    mean +- k u_noise,  k = t_{dof}((1 + level)/2)        dof infinite where the noise was declared
//! total    the hull with the interval of other kinds of surface  u = reach of its farther end / k
//! ```

use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::erf;

use palpate_geometry::shape::{Interval, Spread, Statistic};

/// Degrees of freedom from which on the expansion serves; its error is below 1e-7 there up to a level of 95 %, 1e-6 at 99 %.
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

    /// The expansion for many degrees of freedom against the inverse of the law itself, and both against quantiles of tables.
    #[test]
    fn coverage_factors_are_quantiles_of_student() {
        for dof in [30.0, 30.5, 33.0, 50.0, 120.0, 1000.0] {
            // towards the middle of the law the last term of the expansion shows
            for (level, error) in [(0.5, 2e-9), (0.9, 1e-7), (0.95, 1e-7), (0.99, 1e-6)] {
                let exact = StudentsT::new(0.0, 1.0, dof).unwrap().inverse_cdf(0.5 * (1.0 + level));
                let found = coverage_factor(dof, level);
                assert!((found - exact).abs() < error, "{dof} {level}: {found} {exact}");
            }
        }
        // one and two degrees of freedom have closed forms: tan(pi level/2) and level sqrt(2/(1 - level^2))
        assert!((coverage_factor(1.0, 0.9) - (0.45 * std::f64::consts::PI).tan()).abs() < 1e-8);
        assert!((coverage_factor(2.0, 0.9) - 0.9 * (2.0_f64 / 0.19).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn an_interval_reaches_its_end_and_stays_within_its_bounds() {
        let spread = Spread { mean: Some(0.8), sd: Some(0.1), count: 4 };
        let noise = NoisePart { reaches: Some(1.0), ..NoisePart::new(0.05, f64::INFINITY) };
        let upper = statistic(spread, Some(noise), None, 0.95, [-1.0, 1.0]);
        let k = coverage_factor(f64::INFINITY, 0.95);
        let interval = upper.interval.unwrap();
        assert!((interval.lo - (0.8 - 0.05 * k)).abs() < 1e-12 && interval.hi == 1.0);
        assert!((upper.u.unwrap() - 0.2 / k).abs() < 1e-12 && upper.u_noise == upper.u);
        let lower = statistic(spread, Some(NoisePart { reaches: Some(0.2), ..noise }), None, 0.95, [0.5, 1.0]);
        let interval = lower.interval.unwrap();
        assert!(interval.lo == 0.5 && (interval.hi - (0.8 + 0.05 * k)).abs() < 1e-12);
        assert!((lower.u.unwrap() - 0.6 / k).abs() < 1e-12);
        // other kinds of surface below the mean
        let below = statistic(spread, Some(NoisePart::new(0.05, 7.0)), Some([0.1, 0.6]), 0.9, [-1.0, 1.0]);
        let (interval, k) = (below.interval.unwrap(), coverage_factor(7.0, 0.9));
        assert!(interval.lo == 0.1 && (interval.hi - (0.8 + 0.05 * k)).abs() < 1e-12);
        assert!((below.u.unwrap() - 0.7 / k).abs() < 1e-12 && (below.u_noise.unwrap() - 0.05).abs() < 1e-12);
        assert!((below.u_model.unwrap() - ((0.7 / k).powi(2) - 0.0025).sqrt()).abs() < 1e-12);
        assert_eq!(
            (below.dof, below.coverage_factor, below.mean, below.sd),
            (Some(7.0), Some(k), Some(0.8), Some(0.1))
        );
    }

    /// Noise that cannot be told, a level of nothing, and a mean that there is not.
    #[test]
    fn an_interval_needs_a_mean_and_something_about_it() {
        let spread = Spread { mean: Some(0.8), sd: Some(0.1), count: 4 };
        let bounds = [0.0, f64::INFINITY];
        let bare = statistic(spread, None, None, 0.95, bounds);
        assert!(bare.interval.is_none() && bare.u.is_none() && bare.mean == Some(0.8));
        let other = statistic(spread, None, Some([0.7, 1.0]), 0.95, bounds);
        assert_eq!((other.interval.unwrap().lo, other.interval.unwrap().hi, other.u_noise), (0.7, 1.0, Some(0.0)));
        let none = statistic(spread, Some(NoisePart::new(0.1, 9.0)), Some([0.7, 1.0]), 0.0, bounds);
        assert_eq!((none.u, none.u_noise, none.u_model), (Some(0.1), Some(0.1), Some(0.0)));
        let empty = Spread { mean: None, sd: None, count: 0 };
        assert!(statistic(empty, Some(NoisePart::new(0.1, 9.0)), None, 0.95, bounds).interval.is_none());
    }
}
