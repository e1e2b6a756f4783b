//! A fit of many contacts that starts from the fit of a few, which stand for all.
//!
//! ```text
//! m of g contacts   descend, estimate Z, sigma, lambda, limit the bending        tie, slack
//! all g             descend from there, estimate Z and sigma again               tie g/m, slack g/m
//! ```
//!
//! The terms that only fix the parametrisation grow with the number of contacts. Otherwise they would weigh less and less
//! against the data, the minimum would lie elsewhere along the surface, and the descent would creep there in hundreds of
//! steps that change neither S nor R. The uncertainty is taken with these terms as they were.

use super::certificate::final_factor;
use super::descent::{Descent, Solver, State};
use super::flattening::Flattening;
use super::limit_bending::limit;
use super::noise::{self, Unknown, Until};
use super::problem::{Problem, Weights};
use super::thinning::thinned;
use super::vector::Vector;
use crate::fit::FitError;

/// What a fit owes to the few contacts.
pub(super) struct Few {
    /// How many stood for all; `None` where all took part in every step.
    pub standing: Option<usize>,
    /// How often fairness was raised for them.
    pub raised: usize,
}

/// What the few contacts found.
struct Start {
    /// Noise sds and weights for the fit of all.
    weights: Weights,
    raised: usize,
    coefficients: Vec<Vector>,
    steps: usize,
    folds_refused: usize,
}

/// Fits from the linear start to the minimum, by way of a few contacts where there are many. The weights are left in
/// `problem`, and the steps of all descents are counted.
///
/// # Errors
/// As [`noise::fit`].
pub(super) fn fit(
    problem: &mut Problem,
    solver: &mut Solver,
    flat: &Flattening,
    unknown: Unknown,
) -> Result<(State, Descent, Few), FitError> {
    let Some(standing) = thinned(problem.flattened, problem.cells) else {
        let (state, reached) = noise::fit(problem, solver, unknown, Until::SETTLED)?;
        return Ok((state, reached, Few { standing: None, raised: 0 }));
    };
    let start = fit_few(problem, solver, flat, &standing, unknown)?;
    let Problem { cells, contacts, flattened, gauss, .. } = *problem;
    *problem = Problem::new(cells, contacts, flattened, gauss, start.weights);
    let (state, mut reached) = noise::finish(problem, solver, start.coefficients, unknown)?;
    reached.steps += start.steps;
    reached.folds_refused += start.folds_refused;
    Ok((state, reached, Few { standing: Some(standing.len()), raised: start.raised }))
}

/// Leaves the factor with these weights of T and of the ties in `solver`, and gives its condition. Terms that were only
/// raised to hold the parametrisation are no information, and must not lessen the uncertainty.
///
/// # Errors
/// The normal matrix has no factor.
pub(super) fn unraised_factor(
    problem: &Problem,
    [slack, tie]: [f64; 2],
    solver: &mut Solver,
    state: &State,
) -> Result<f64, FitError> {
    let Problem { cells, contacts, flattened, gauss, weights, .. } = *problem;
    let plain = Problem::new(cells, contacts, flattened, gauss, Weights { slack, tie, ..weights });
    Ok(final_factor(&plain, solver, state)?.condition)
}

/// Fits to the contacts with the numbers `standing`.
///
/// # Errors
/// As [`noise::fit`].
fn fit_few(
    all: &Problem,
    solver: &mut Solver,
    flat: &Flattening,
    standing: &[usize],
    unknown: Unknown,
) -> Result<Start, FitError> {
    let few = all.contacts.chosen(standing);
    let places: Vec<[f64; 2]> = standing.iter().map(|&r| all.flattened[r]).collect();
    let mut problem = Problem::new(all.cells, &few, &places, all.gauss, all.weights);
    let (mut state, mut reached) = noise::fit(&mut problem, solver, unknown, Until::STARTED)?;
    // where these contacts do not allow a surface, all of them are asked
    let flat = Flattening { places: places.clone(), period: flat.period, triangles: Vec::new(), method: flat.method };
    let limited = limit(&mut problem, solver, &flat, unknown, &mut state, &mut reached);
    let times = all.flattened.len() as f64 / standing.len() as f64;
    let weights = problem.weights;
    Ok(Start {
        weights: Weights { slack: times * weights.slack, tie: times * weights.tie, ..weights },
        raised: limited.map_or(0, |limited| limited.raised),
        coefficients: state.coefficients,
        steps: reached.steps,
        folds_refused: reached.folds_refused,
    })
}

#[cfg(test)]
mod tests {
    use crate::fit::FitOptions;
    use crate::parametric::ParametricFit;
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::Lcg;

    /// A bar of radius 10 felt 4,000 times: the answer holds the truth, u is that of all contacts and not of the few.
    #[test]
    fn many_contacts_start_from_a_few_and_keep_their_uncertainty() {
        let lcg = &mut Lcg::new(3);
        let (mut points, mut normals) = (Vec::new(), Vec::new());
        for r in 0..4000 {
            let place = |step: f64| (f64::from(r) * step).fract() - 0.5;
            let (angle, along) = (place(0.754_877_666), 8.0 * place(0.569_840_291));
            let off = 10.0 + 0.01 * lcg.normal();
            let noise = [0, 1, 2].map(|_| 0.05 * lcg.normal());
            points.push([off * angle.sin(), along, off * angle.cos()]);
            normals.push([angle.sin() + noise[0], noise[1], angle.cos() + noise[2]]);
        }
        let fit = |points: &[[f64; 3]], normals: &[[f64; 3]]| {
            let contacts = Contacts::from_points(points).with_normal_vectors(normals);
            ParametricFit::new(&contacts, &FitOptions { degree: [3, 3], ..FitOptions::default() }).unwrap()
        };
        let (all, some) = (fit(&points, &normals), fit(&points[..1200], &normals[..1200]));
        assert_eq!((all.standing(), some.standing()), (Some(1200), None));
        assert!(all.certificate().settled && all.certificate().fold_free);
        for (found, fewer, truth) in [
            (all.shape().shape_index, some.shape().shape_index, 0.5),
            (all.shape().curvedness, some.shape().curvedness, 0.1 / 2.0_f64.sqrt()),
        ] {
            let (mean, u) = (found.mean.unwrap(), found.u.unwrap());
            assert!((mean - truth).abs() < 4.0 * u, "{mean} is not {truth} within {u}");
            // sqrt(1200 / 4000) is 0.55; fairness, which both estimate for themselves, changes it somewhat
            let share = u / fewer.u.unwrap();
            assert!((0.3..0.9).contains(&share), "{share}");
        }
    }
}
