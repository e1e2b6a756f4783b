//! One problem fitted, and its answer held against 32 digits.
//!
//! ```text
//! broken      promised digits > found digits             refused     no answer to a problem of full rank
//! gaps        coefficients that lack data, compared with the rule for gaps where that can be written in 32 digits
//! ```

use palpate::Orientation;
use palpate::fit::{Fit, FitError, Method, MethodUsed, NormalSigma, Note, Objective, Reason, Smooth, fit_contacts};
use palpate::spline::Knots;
use palpate_laboratory::hard_cases::digits_absolute;
use palpate_numeric::linalg::DoubleDouble as Dd;

use super::draw::{Family, RandomProblem, draw};
use super::normals::NormalRows;
use super::oracle::{Grid, Solved, Written, grid_of};

/// What digits are promised of, in the order of the arrays.
pub(crate) const QUANTITIES: [&str; 3] = ["coefficients", "S", "R"];
/// Problems drawn for one number at most until one has full rank.
const MAX_ATTEMPTS: u64 = 1000;
/// The rule for gaps is compared up to this ratio of weights: it is written with E'E, which squares the ratio.
const GAP_WEIGHTS: f64 = 1e4;

/// How a problem ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Outcome {
    /// Digits found and digits promised.
    Compared { found: [f64; 3], promised: [f64; 3], gaps: bool },
    /// Answered with gaps and compared with nothing.
    Gaps,
    /// No answer.
    Refused,
}

/// What is kept of a problem that did not end as it should.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Exception {
    pub number: u64,
    pub attempt: u64,
    pub words: String,
}

/// One problem's end.
#[derive(Clone, Debug)]
pub(crate) struct Judged {
    pub family: Family,
    pub outcome: Outcome,
    /// Problems of this number that were not of full rank.
    pub redrawn: u64,
    pub exceptions: Vec<Exception>,
}

/// Draws, fits and compares the problem of this seed and number; `None` where no attempt gives full rank.
pub(crate) fn judge(seed: u64, number: u64) -> Option<Judged> {
    (0..MAX_ATTEMPTS).find_map(|attempt| {
        let problem = draw(seed, number, attempt);
        let fit = fit_contacts(&problem.contacts, &problem.options);
        let (outcome, words) = outcome(&problem, &fit)?;
        let exceptions = words.into_iter().map(|words| {
            let words = format!("{}, {words}", problem.family.name());
            Exception { number, attempt, words }
        });
        Some(Judged { family: problem.family, outcome, redrawn: attempt, exceptions: exceptions.collect() })
    })
}

/// How this answer to the problem ends, and what is wrong with it; `None` where the problem is not of full rank.
pub(crate) fn outcome(problem: &RandomProblem, fit: &Result<Fit, FitError>) -> Option<(Outcome, Vec<String>)> {
    let knots = knots_of(problem);
    let grid = grid_of(problem.options.domain?, problem.options.grid[0], &knots);
    let fit = match fit {
        Ok(fit) => fit,
        Err(error) => {
            let solved = written(problem, &knots, None).solve(&grid)?;
            return Some((Outcome::Refused, vec![refusal(problem, error, &solved)]));
        }
    };
    let written = written(problem, &knots, Some(fit));
    let certificate = fit.certificate();
    let mut words = missing_notes(problem, fit);
    let is_gap = !certificate.unsupported.is_empty();
    // the rank-revealing QR of full rank solves for all coefficients and only says which lack data
    let whole = !is_gap || (certificate.method == MethodUsed::PivotedQr && certificate.rank == certificate.unknowns);
    let solved = match problem.options.objective {
        Objective::Normals(_) if whole => normal_rows(&written, fit)?.solve(&coefficients(fit), &grid)?,
        _ if whole => written.solve(&grid)?,
        _ => {
            written.solve(&grid)?;
            match gap_answer(problem, fit, &written, &grid) {
                Some(solved) => solved,
                None => return Some((Outcome::Gaps, words)),
            }
        }
    };
    let (found, promised) = (found_digits(fit, &solved, problem), promised_digits(fit));
    for k in 0..3 {
        if promised[k].is_nan() || promised[k] > found[k] {
            let (condition, method) = (certificate.condition, certificate.method.name());
            words.push(format!(
                "broken: {} promised {:.2}, found {:.2}, condition {condition:.1e}, {method}{}",
                QUANTITIES[k],
                promised[k],
                found[k],
                if is_gap { ", with gaps" } else { "" }
            ));
        }
    }
    Some((Outcome::Compared { found, promised, gaps: is_gap }, words))
}

fn promised_digits(fit: &Fit) -> [f64; 3] {
    let promise = fit.certificate();
    [promise.digits_of_coefficients, promise.digits_of_shape_index, promise.digits_of_curvedness]
}

fn knots_of(problem: &RandomProblem) -> [Knots; 2] {
    let [x0, x1, y0, y1] = problem.options.domain.unwrap_or_default();
    let (degree, segments) = (problem.options.degree, problem.options.segments);
    [(x0, x1, 0), (y0, y1, 1)].map(|(lo, hi, k)| Knots::uniform(degree[k], segments[k], lo, hi).expect("a side"))
}

/// The problem as it is written: weights as given, or as the fit found them.
fn written<'a>(problem: &'a RandomProblem, knots: &'a [Knots; 2], fit: Option<&Fit>) -> Written<'a> {
    let found = fit.filter(|_| is_weighted_by_fit(problem));
    let (weights, mut lambda) = match found {
        Some(fit) => (found_weights(problem, fit), Dd::ZERO),
        None => given_weights(problem),
    };
    if let (Some(fit), Smooth::Auto) = (fit, problem.options.smooth) {
        lambda = Dd::new(fit.smoothing());
    }
    Written { contacts: &problem.contacts, degree: problem.options.degree, knots, weights, lambda }
}

fn is_weighted_by_fit(problem: &RandomProblem) -> bool {
    matches!(problem.family, Family::Robust | Family::Estimated)
}

fn given_weights(problem: &RandomProblem) -> (Vec<[Dd; 3]>, Dd) {
    let columns = &problem.contacts.weights;
    let of = |column: &Option<Vec<f64>>, r: usize| Dd::new(column.as_ref().map_or(1.0, |w| w[r]));
    let at = |r: usize| {
        let [z, x, y] = problem.weights.map(Dd::new);
        [z * of(&columns.z, r), x * of(&columns.x, r), y * of(&columns.y, r)]
    };
    let lambda = match problem.options.smooth {
        Smooth::Lambda(lambda) => lambda,
        _ => 0.0,
    };
    ((0..problem.contacts.len()).map(at).collect(), Dd::new(lambda))
}

/// Those of the last equations, whose heights are in units of the patch. A hundred contacts and more stand there in the order of
/// the knot cells; families whose weights are found have fewer.
fn found_weights(problem: &RandomProblem, fit: &Fit) -> Vec<[Dd; 3]> {
    assert!(problem.contacts.len() < 100, "{} contacts may be in another order", problem.contacts.len());
    let (equations, scale) = (fit.equations(), Dd::new(fit.frame().scale));
    let at = |r: usize| {
        let m = equations.row_weights.at(r);
        [Dd::new(m.z) / scale, Dd::new(m.a), Dd::new(m.d)]
    };
    (0..problem.contacts.len()).map(at).collect()
}

fn normal_rows<'a>(written: &'a Written<'a>, fit: &Fit) -> Option<NormalRows<'a>> {
    let sds = match fit.options().objective {
        Objective::Normals(NormalSigma::Known { z, normal_deg }) => [z, normal_deg],
        _ => [fit.noise().sigma_z?, fit.noise().sigma_normal_deg?],
    };
    let radians = Dd::new(sds[1]) * (Dd::new(std::f64::consts::PI) + Dd::new(PI_REST)) / Dd::new(180.0);
    Some(NormalRows { written, weights: [Dd::ONE / Dd::new(sds[0]), Dd::ONE / radians] })
}

/// What the double nearest to pi leaves of it.
const PI_REST: f64 = 1.224_646_799_147_353_2e-16;

fn gap_answer(problem: &RandomProblem, fit: &Fit, written: &Written, grid: &Grid) -> Option<Solved> {
    let certificate = fit.certificate();
    let by_rule = certificate.method == MethodUsed::Cholesky && certificate.reasons.iter().any(is_gap_rule);
    let sizes = written.weights.iter().flatten().map(|w| w.to_f64()).filter(|w| *w > 0.0);
    let (lo, hi) = sizes.fold((f64::INFINITY, 0.0_f64), |(lo, hi), w| (lo.min(w), hi.max(w)));
    let is_linear = problem.family != Family::Normals;
    let comparable = by_rule && is_linear && written.lambda == Dd::ZERO && hi <= GAP_WEIGHTS * lo;
    if comparable { written.solve_with_gaps(&certificate.unsupported, grid) } else { None }
}

fn is_gap_rule(reason: &Reason) -> bool {
    matches!(reason, Reason::Gap { .. })
}

fn coefficients(fit: &Fit) -> Vec<f64> {
    fit.input_surface().map(|s| s.coefficients().iter().copied().collect()).unwrap_or_default()
}

/// Digits of the coefficients that data hold, and of S and R at the supported points where they are defined.
fn found_digits(fit: &Fit, solved: &Solved, problem: &RandomProblem) -> [f64; 3] {
    let mut found = coefficients(fit);
    if found.len() == solved.coefficients.len() {
        fit.certificate().unsupported.iter().for_each(|&u| found[u] = solved.coefficients[u].to_f64());
    }
    let maps = &fit.shape().maps;
    let columns = problem.options.grid[1];
    let mut errors = [0.0_f64; 2];
    for (k, (s, r)) in solved.shape_index.iter().zip(&solved.curvedness).enumerate() {
        let (i, j) = (k / columns, k % columns);
        if s.is_nan() {
            continue;
        }
        if let Some(found) = maps.shape_index_at(i, j) {
            errors[0] = errors[0].max((found - s).abs());
            errors[1] = errors[1].max(((maps.curvedness[(i, j)] - r) / r).abs());
        }
    }
    let [s, r] = errors.map(|e| digits_absolute(e.max(f64::EPSILON / 2.0)));
    [solved.digits_of_coefficients(&found), s, r]
}

/// Why there is no answer, and what other methods would have answered.
fn refusal(problem: &RandomProblem, error: &FitError, solved: &Solved) -> String {
    let others = [Method::Cholesky, Method::Qr].map(|method| {
        let fit = fit_contacts(&problem.contacts, &problem.options.clone().with_method(method)).ok()?;
        Some(format!("{method:?} answers with {:.1} digits", solved.digits_of_coefficients(&coefficients(&fit))))
    });
    let others: Vec<String> = others.into_iter().flatten().collect();
    let others = if others.is_empty() { "no other method answers".to_string() } else { others.join(", ") };
    format!("refused: {error}; {others}")
}

/// Notes that an answer should carry and does not.
fn missing_notes(problem: &RandomProblem, fit: &Fit) -> Vec<String> {
    let (certificate, notes) = (fit.certificate(), fit.notes());
    let says = |is_it: fn(&Note) -> bool| notes.iter().any(is_it);
    let gaps = !certificate.unsupported.is_empty();
    let deficient = certificate.rank < certificate.unknowns && !gaps;
    let smoothed = problem.options.smooth == Smooth::Auto;
    let lost = [
        (gaps && !says(|n| matches!(n, Note::Unsupported { .. })), "coefficients lack data and no note says so"),
        (
            deficient && !certificate.reasons.iter().any(|r| matches!(r, Reason::RankDeficient { .. })),
            "rank is reduced",
        ),
        (smoothed && !says(|n| matches!(n, Note::Smoothed { .. })), "smoothing was found and no note says so"),
        (has_turned(problem, fit), "the axes were turned without need"),
    ];
    lost.iter().filter(|(is_lost, _)| *is_lost).map(|(_, words)| format!("note: {words}")).collect()
}

/// Normals that all point up keep the axes.
fn has_turned(problem: &RandomProblem, fit: &Fit) -> bool {
    let Orientation::Normals { nz, .. } = &problem.contacts.orientation else { return false };
    nz.iter().all(|n| *n > 0.0) && fit.notes().contains(&Note::Rotated)
}
