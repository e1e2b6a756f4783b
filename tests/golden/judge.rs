//! An answer of palpate held against its reference: digits found, digits promised, digits the conditioning allows.

use palpate::fit::{Fit, FitError, fit_contacts, fit_grid};
use palpate_laboratory::hard_cases::{
    CaseData, DIGITS_OF_A_DOUBLE, DenseRows, Expectation, HardCase, digits_absolute, digits_each, digits_of,
};
use palpate_numeric::solve::{DenseMethod, solve_dense};

use super::Golden;

/// Digits of the coefficients (relative), of S (absolute), of R (relative); `None` where there is nothing to compare.
pub(crate) type Digits = [Option<f64>; 3];

/// One row of the hard-case table (the tests do not read every field).
pub(crate) struct Judged {
    /// Method that gave the answer, or why there is none.
    pub method: String,
    /// Whether there is an answer.
    pub answered: bool,
    /// The certificate's condition.
    pub condition: f64,
    /// Against the reference.
    pub found: Digits,
    /// By palpate, beforehand.
    pub promised: Digits,
    /// What a backward error of 2^-53 allows, from the reference's own conditioning.
    pub allowed: Digits,
    /// Worst error of the fitted heights at the contacts, relative to the largest.
    pub fitted: Option<f64>,
    /// Coefficients that the data leave free.
    pub unsupported: usize,
}

/// Fits the case and compares.
pub(crate) fn judge(case: &HardCase, golden: &Golden) -> Judged {
    match &case.data {
        CaseData::Rows(rows) => judge_rows(rows, golden),
        CaseData::Contacts(contacts) => judge_fit(case, golden, fit_contacts(contacts, &case.options)),
        CaseData::Grid(grid) => judge_fit(case, golden, fit_grid(grid, &case.options)),
    }
}

/// Digits that a relative error allows.
fn digits(error: f64) -> f64 {
    digits_absolute(error.max(f64::EPSILON / 2.0))
}

fn judge_rows(rows: &DenseRows, golden: &Golden) -> Judged {
    let [m, n] = [rows.rows.nrows(), rows.rows.ncols()];
    let values: Vec<f64> = rows.rows.t().iter().copied().collect();
    let solution = solve_dense(m, n, &values, &rows.rhs, DenseMethod::Auto).unwrap();
    let found = digits_each(&solution.coefficients, golden.coefficients.as_ref().unwrap());
    let allowed = digits(f64::EPSILON / 2.0 * golden.loss);
    Judged {
        method: format!("{:?}", solution.method).to_lowercase(),
        answered: true,
        condition: solution.condition,
        found: [Some(found), None, None],
        promised: [None; 3],
        allowed: [Some(allowed), None, None],
        fitted: None,
        unsupported: 0,
    }
}

fn judge_fit(case: &HardCase, golden: &Golden, fit: Result<Fit, FitError>) -> Judged {
    let fit = match fit {
        Ok(fit) => fit,
        Err(error) => return refused(error),
    };
    let certificate = fit.certificate();
    let unsupported = certificate.unsupported.len();
    let whole = unsupported == 0 || case.expectation == Expectation::UpToHeight;
    let found = [found_coefficients(&fit, golden).filter(|_| whole), None, None];
    let [s, r] = if whole { found_shape(&fit, golden) } else { [None; 2] };
    let allowed = [f64::EPSILON / 2.0 * golden.loss, golden.allowed[0], golden.allowed[1]];
    let found = [found[0], s, r];
    let keep = |digits: [f64; 3]| -> Digits { std::array::from_fn(|k| found[k].map(|_| digits[k])) };
    Judged {
        method: certificate.method.name().to_string(),
        answered: true,
        condition: certificate.condition,
        promised: keep([
            certificate.digits_of_coefficients,
            certificate.digits_of_shape_index,
            certificate.digits_of_curvedness,
        ]),
        allowed: keep(allowed.map(digits)),
        found,
        fitted: fitted_error(case, &fit, golden),
        unsupported,
    }
}

fn refused(error: FitError) -> Judged {
    Judged {
        method: error.to_string(),
        answered: false,
        condition: f64::NAN,
        found: [None; 3],
        promised: [None; 3],
        allowed: [None; 3],
        fitted: None,
        unsupported: 0,
    }
}

fn found_coefficients(fit: &Fit, golden: &Golden) -> Option<f64> {
    let reference = golden.coefficients.as_ref()?;
    let Ok(surface) = fit.input_surface() else { return Some(0.0) };
    let mut found: Vec<f64> = surface.coefficients().iter().copied().collect();
    if golden.gauge == "constant" {
        let first = found[0];
        found.iter_mut().for_each(|c| *c -= first);
    }
    Some(digits_of(&found, reference))
}

/// Over the points where the reference has an S and so has palpate; a palpate without any has no digits.
fn found_shape(fit: &Fit, golden: &Golden) -> [Option<f64>; 2] {
    let maps = &fit.shape().maps;
    let columns = maps.grid.y.len();
    let (mut s_error, mut r_error, mut points) = (0.0_f64, 0.0_f64, 0);
    for (k, reference) in golden.shape_index.iter().enumerate() {
        let (Some(reference), r) = (reference, golden.curvedness[k]) else { continue };
        let at = (k / columns, k % columns);
        let Some(s) = maps.shape_index_at(at.0, at.1) else { return [Some(0.0), Some(0.0)] };
        s_error = s_error.max((s - reference).abs());
        r_error = r_error.max(((maps.curvedness[at] - r) / r).abs());
        points += 1;
    }
    let of = |error: f64| if error == 0.0 { DIGITS_OF_A_DOUBLE } else { digits_absolute(error) };
    [(points > 0).then(|| of(s_error)), (points > 0).then(|| of(r_error))]
}

fn fitted_error(case: &HardCase, fit: &Fit, golden: &Golden) -> Option<f64> {
    let CaseData::Contacts(contacts) = &case.data else { return None };
    let surface = fit.input_surface().ok()?;
    let sites = contacts.x.iter().zip(&contacts.y).step_by(golden.every);
    let heights: Vec<f64> = sites.map(|(x, y)| surface.at(*x, *y).z).collect();
    let size = golden.fitted.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let pairs = heights.iter().zip(&golden.fitted);
    let worst = pairs.map(|(h, g)| (h - g).abs()).fold(0.0_f64, |m, e| if e.is_nan() { f64::NAN } else { m.max(e) });
    Some(if worst == 0.0 { 0.0 } else { worst / size })
}
