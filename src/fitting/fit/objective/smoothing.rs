//! `--smooth auto`: what roughness costs, by restricted maximum likelihood over the weighted rows.
//!
//! ```text
//! degree 3 and more   lambda where bends are alike along x and y, and from there lambda with an aspect     third=LAMBDA,ASPECT
//! below               lambda                                                                               LAMBDA
//! ```
//!
//! Third derivatives are penalised where the spline has some, so that curvatures cost nothing: these are what is asked.

mod likelihood;
mod lowest;

use crate::fit::notes::Note;
use crate::fit::objective::PlainFit;
use crate::fit::objective::budget::Budget;
use crate::fit::objective::fitted::Fitted;
use crate::fit::objective::robust::fit_with_loss;
use crate::fit::placing::Patch;
use crate::fit::{FitError, FitOptions, Smooth};
use crate::observation::{Data, RoughnessOrder};
use likelihood::RestrictedLikelihood;
use lowest::{lowest_along, lowest_from};

/// Chooses the smoothing and fits with it.
///
/// # Errors
/// Those of a fit with a given lambda.
pub(super) fn fit_smoothed(
    patch: &Patch,
    data: &Data,
    options: &FitOptions,
    (plain, budget): (PlainFit, &Budget),
) -> Result<Fitted, FitError> {
    let order = RoughnessOrder::of_degrees(options.degree);
    let with = |smooth: Smooth| FitOptions { smooth, ..options.clone() };
    // noise sds and linearisation come from a fit with so little smoothing that it only makes the rank full
    let start = fit_with_loss(patch, data, &with(Smooth::faint(options.degree)), (plain, budget))?;
    let likelihood = RestrictedLikelihood::new(&start.equations, order, budget);
    let balance = likelihood.balance();
    let decade = |exponent: f64| balance * 10_f64.powf(exponent);
    let found = lowest_along(|exponent| likelihood.slope(decade(exponent)), budget);
    let chosen = match order {
        RoughnessOrder::Second => Smooth::Lambda(decade(found.at)),
        // where no lambda is the most likely one, no roughness has an aspect
        RoughnessOrder::Third if found.is_bracketed => with_aspect(&likelihood, decade(found.at), budget),
        RoughnessOrder::Third => Smooth::Stretched { lambda: rounded(decade(found.at)), aspect: 1.0 },
    };
    let mut fitted = fit_with_loss(patch, data, &with(chosen), (plain, budget))?;
    fitted.notes.push(Note::Smoothed { chosen });
    Ok(fitted)
}

/// The most likely lambda and aspect, from the most likely lambda of an aspect of 1. What is varied are the logarithms of the weights of
/// S_xxx^2 and S_yyy^2, which data tell nearly apart from each other.
fn with_aspect(likelihood: &RestrictedLikelihood, start: f64, budget: &Budget) -> Smooth {
    let meant =
        |[along_x, along_y]: [f64; 2]| [start * (0.5 * (along_x + along_y)).exp(), ((along_x - along_y) / 6.0).exp()];
    let slopes = |at: [f64; 2]| {
        let [lambda, aspect] = meant(at);
        let [by_lambda, by_aspect] = likelihood.slopes(lambda, aspect)?;
        Some([0.5 * by_lambda + by_aspect / 6.0, 0.5 * by_lambda - by_aspect / 6.0])
    };
    let [lambda, aspect] = meant(lowest_from([0.0; 2], slopes, budget)).map(rounded);
    Smooth::Stretched { lambda, aspect }
}

/// To four digits, by which a smoothing is easily named: far more than the data tell.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::fit_contacts;
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::Lcg;

    fn touched(count: usize, noise: f64, at: impl Fn(f64, f64) -> f64) -> Contacts {
        let mut generator = Lcg::new(7);
        let mut one = || {
            let [x, y] = [0, 1].map(|_| 2.0 * generator.uniform() - 1.0);
            [x, y, at(x, y) + noise * generator.normal()]
        };
        Contacts::from_points(&(0..count).map(|_| one()).collect::<Vec<[f64; 3]>>())
    }

    fn chosen(contacts: &Contacts, options: &FitOptions) -> Smooth {
        let fit = fit_contacts(contacts, &options.clone().with_smooth(Smooth::Auto)).unwrap();
        let chosen = fit.notes().iter().find_map(|note| match note {
            Note::Smoothed { chosen } => Some(*chosen),
            _ => None,
        });
        chosen.unwrap()
    }

    /// With as many unknowns as rows: the curvatures of a cap are kept, and its noise is none of its shape.
    #[test]
    fn curvatures_cost_nothing_and_noise_is_no_shape() {
        let contacts = touched(64, 0.02, |x, y| -0.5 * (x * x + y * y));
        let options = FitOptions::default().with_degree(3).with_segments(5, 5).with_smooth(Smooth::Auto);
        let fit = fit_contacts(&contacts, &options).unwrap();
        let surface = fit.input_surface().unwrap();
        for (x, y) in [(0.0, 0.0), (0.5, -0.4), (-0.6, 0.3)] {
            let here = surface.at(x, y);
            assert!((here.zxx + 1.0).abs() < 0.2 && (here.zyy + 1.0).abs() < 0.2, "{here:?}");
        }
    }

    /// Waves along one direction are smoothed along the other one, and turned waves the other way.
    #[test]
    fn waves_along_one_direction_have_an_aspect() {
        let options = FitOptions::default().with_degree(4).with_segments(4, 4);
        let [along_x, along_y] = [false, true].map(|turned| {
            let contacts = touched(200, 0.02, |x, y| (3.0 * if turned { y } else { x }).sin());
            match chosen(&contacts, &options) {
                Smooth::Stretched { aspect, .. } => aspect,
                other => panic!("{other}"),
            }
        });
        assert!(along_x < 0.7 && along_y > 1.4, "{along_x} {along_y}");
    }

    /// With as many unknowns as rows, the equations of three of these hundred are so poor that a tiny lambda is lost in rounding.
    #[test]
    fn as_many_unknowns_as_contacts_follow_no_noise() {
        for seed in 0..100 {
            let mut generator = Lcg::new(seed);
            let mut one = || {
                let [x, y] = [0, 1].map(|_| 12.0 * generator.uniform() - 6.0);
                [x, y, -0.05 * (x * x + 0.4 * y * y) + 0.03 * generator.normal()]
            };
            let contacts = Contacts::from_points(&(0..64).map(|_| one()).collect::<Vec<[f64; 3]>>());
            let options = FitOptions::default().with_degree(3).with_segments(5, 5).with_smooth(Smooth::Auto);
            let fit = fit_contacts(&contacts, &options).unwrap();
            let here = fit.input_surface().unwrap().at(0.5, -0.4);
            assert!((here.zxx + 0.1).abs() < 0.05 && (here.zyy + 0.04).abs() < 0.05, "{seed}: {here:?}");
        }
    }

    #[test]
    fn what_is_chosen_is_fitted_again_by_its_name() {
        let contacts = touched(150, 0.05, |x, y| (3.0 * x).sin() * y);
        for degree in [2, 3] {
            let options = FitOptions::default().with_degree(degree).with_segments(6, 6);
            let automatic = fit_contacts(&contacts, &options.clone().with_smooth(Smooth::Auto)).unwrap();
            let named: Smooth = chosen(&contacts, &options).to_string().parse().unwrap();
            let again = fit_contacts(&contacts, &options.with_smooth(named)).unwrap();
            assert_eq!(automatic.solution().coefficients, again.solution().coefficients);
        }
    }
}
