//! The solver frontier: the scene's own problem against double-double, and hard cases against their references of 80 digits.
//!
//! ```text
//! digits of the coefficients against time, method by method; error = 10^-digits
//! ```

use serde_json::Value;

use crate::cases::{CaseData, DIGITS_OF_A_DOUBLE, DenseRows, HardCase, digits_each};
use palpate_fitting::fit::{Equations, Fit, FitOptions, fit_contacts, fit_grid};
use palpate_geometry::contact::Contacts;
use palpate_numeric::solve::{DenseMethod, solve_dense};
use palpate_numeric::threads;

use super::clock::{Call, Limits, Watch, rounds};
use super::pareto;
use super::point::Point;
use super::reference::reference;
use super::solver::{Solver, digits};

/// Rounds of the solvers: microseconds to milliseconds a call.
const LIMITS: Limits = Limits { least: 3, most: 40, seconds: 10.0, each: 0.1 };

macro_rules! references {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/golden/", $name, ".json")))),*]
    };
}

/// Hard cases by rising condition, each with its reference.
const CASES: &[(&str, &str)] = references![
    "umbilic_cup_pixels",
    "sphere_r1e3",
    "clustered_ten_thousand_to_one",
    "nist_filippelli_centred",
    "degree_nine_single_segment",
    "nist_longley",
    "degree_nine_heights",
    "hilbert_even_degree_nine",
    "aspect_1e6",
    "hilbert_rows",
    "nist_filippelli_raw",
    "weights_slopes_1e12",
];

/// Methods for problems that come as rows and are no splines; each corrects its answer by residuals in double-double.
const DENSE: [(DenseMethod, &str); 3] = [
    (DenseMethod::Cholesky, "cholesky, double-double residuals"),
    (DenseMethod::SemiNormal, "qr, double-double residuals"),
    (DenseMethod::Qr, "pivoted qr, double-double residuals"),
];

/// What is solved, and what the answer should be.
#[derive(Debug)]
enum Problem {
    /// Equations of a spline; coefficients in the patch's units become those of the reference by `height + scale c`.
    Spline { equations: Box<Equations>, height: f64, scale: f64 },
    /// Rows.
    Dense { values: Vec<f64>, rows: DenseRows },
}

#[derive(Debug)]
struct Case {
    name: String,
    condition: f64,
    contacts: usize,
    problem: Problem,
    reference: Vec<f64>,
}

/// One way to solve one case.
struct Way<'a> {
    case: &'a Case,
    label: String,
    how: How,
}

enum How {
    Spline(Solver),
    Dense(DenseMethod),
}

/// Every call of the solver frontier with what it gives back.
#[derive(Debug)]
pub struct SolverSubject {
    cases: Vec<Case>,
    notes: Vec<String>,
}

impl SolverSubject {
    /// The problem of these contacts, named `scene`, and the hard cases.
    pub fn new(scene: &str, contacts: &Contacts, options: &FitOptions) -> SolverSubject {
        let mut subject = SolverSubject { cases: Vec::new(), notes: Vec::new() };
        match own_case(scene, contacts, options) {
            Ok(case) => subject.cases.push(case),
            Err(why) => subject.notes.push(format!("the solver frontier leaves the scene itself out: {why}")),
        }
        subject.cases.extend(CASES.iter().filter_map(|(name, golden)| hard_case(name, golden)));
        subject
    }

    /// Remarks.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    fn ways(&self) -> Vec<Way<'_>> {
        let mut ways = Vec::new();
        for case in &self.cases {
            match &case.problem {
                Problem::Spline { .. } => ways.extend(Solver::all().into_iter().map(|solver| Way {
                    case,
                    label: solver.name(),
                    how: How::Spline(solver),
                })),
                Problem::Dense { .. } => {
                    ways.extend(DENSE.map(|(method, label)| Way { case, label: label.into(), how: How::Dense(method) }))
                }
            }
        }
        ways
    }

    /// Every call, case by case and method by method.
    pub fn calls(&self) -> Vec<Call<'_, Result<Vec<f64>, String>>> {
        fn call(way: Way<'_>) -> Call<'_, Result<Vec<f64>, String>> {
            match (&way.case.problem, way.how) {
                (Problem::Spline { equations, .. }, How::Spline(solver)) => Box::new(move |_| solver.solve(equations)),
                (Problem::Dense { values, rows }, How::Dense(method)) => Box::new(move |_| {
                    let [m, n] = [rows.rows.nrows(), rows.rows.ncols()];
                    let solved = solve_dense(m, n, values, &rows.rhs, method).map_err(|e| e.to_string())?;
                    Ok(solved.coefficients)
                }),
                _ => Box::new(|_| Err("this method is for another kind of problem".into())),
            }
        }
        self.ways().into_iter().map(call).collect()
    }

    /// Measures every method on every case, on one thread.
    pub fn measure(&self, watch: Watch<'_>) -> Vec<Point> {
        threads::alone(|| self.measure_here(watch))
    }

    fn measure_here(&self, watch: Watch<'_>) -> Vec<Point> {
        let ways = self.ways();
        let mut found: Vec<Option<Result<f64, String>>> = vec![None; ways.len()];
        let times = rounds(&mut self.calls(), LIMITS, watch, |k, number, answer| {
            // nothing is random: every call of a method gives the same bits
            if number == 0 {
                found[k] = Some(answer.map(|c| ways[k].case.digits(&c)));
            }
        });
        let mut points: Vec<Point> = Vec::new();
        for ((way, found), time) in ways.iter().zip(found).zip(times) {
            let mut point = Point {
                label: way.label.clone(),
                case: Some(way.case.name.clone()),
                method: way.label.clone(),
                contacts: way.case.contacts,
                seconds: Some(time),
                replicates: 1,
                condition: Some(way.case.condition),
                ..Point::default()
            };
            match found {
                Some(Ok(digits)) => {
                    let error = 10.0_f64.powf(-digits);
                    (point.digits, point.error, point.error_interval) = (Some(digits), Some(error), Some([error; 2]));
                }
                Some(Err(why)) => point.failed = Some(why),
                None => point.failed = Some("not called".into()),
            }
            points.push(point);
        }
        mark_solvers(&mut points);
        points
    }
}

/// Marks the points of each case that no other of the same case beats.
pub fn mark_solvers(points: &mut [Point]) {
    for own in points.chunk_by_mut(|a, b| a.case == b.case) {
        pareto::mark(&mut own.iter_mut().collect::<Vec<_>>());
    }
}

impl Case {
    fn digits(&self, found: &[f64]) -> f64 {
        match &self.problem {
            Problem::Spline { height, scale, .. } => {
                let placed: Vec<f64> = found.iter().map(|c| height + scale * c).collect();
                digits(&placed, &self.reference)
            }
            Problem::Dense { .. } => digits_each(found, &self.reference),
        }
    }
}

fn own_case(scene: &str, contacts: &Contacts, options: &FitOptions) -> Result<Case, String> {
    let fit = fit_contacts(contacts, options).map_err(|e| e.to_string())?;
    let equations = fit.equations().clone();
    if equations.roughness.is_some() || !fit.solution().unsupported.is_empty() {
        return Err("it is smoothed, or has coefficients without data".into());
    }
    let reference = reference(&equations)?;
    let condition = fit.condition();
    let problem = Problem::Spline { equations: Box::new(equations), height: 0.0, scale: 1.0 };
    Ok(Case { name: scene.into(), condition, contacts: contacts.len(), problem, reference })
}

fn hard_case(name: &str, golden: &str) -> Option<Case> {
    let case = HardCase::named(name)?;
    let golden: Value = serde_json::from_str(golden).ok()?;
    let number = |v: &Value| v.as_f64().or_else(|| v.as_str()?.parse().ok());
    let reference: Vec<f64> = golden["coefficients"].as_array()?.iter().map(number).collect::<Option<_>>()?;
    let condition = number(&golden["condition"])?;
    let spline = |fit: Fit| {
        let frame = fit.frame();
        let (height, scale) = (frame.origin[2], frame.scale);
        Problem::Spline { equations: Box::new(fit.equations().clone()), height, scale }
    };
    let (contacts, problem) = match case.data {
        CaseData::Contacts(contacts) => (contacts.len(), spline(fit_contacts(&contacts, &case.options).ok()?)),
        CaseData::Grid(grid) => (grid.len(), spline(fit_grid(&grid, &case.options).ok()?)),
        CaseData::Rows(rows) => {
            let values = rows.rows.t().iter().copied().collect();
            (rows.rows.nrows(), Problem::Dense { values, rows })
        }
    };
    Some(Case { name: name.into(), condition, contacts, problem, reference })
}

/// Where Cholesky stops being enough: the best conditioned case in which it keeps less than half of the digits, and the worst
/// in which it keeps more.
pub fn cholesky_ends(points: &[Point]) -> Option<String> {
    const HALF: f64 = DIGITS_OF_A_DOUBLE / 2.0;
    let plain: Vec<(&Point, f64, f64)> = points
        .iter()
        .filter(|point| point.method == "cholesky")
        .filter_map(|point| Some((point, point.condition?, point.digits.unwrap_or(0.0))))
        .collect();
    let name = |(point, condition, digits): &(&Point, f64, f64)| {
        let case = point.case.as_deref().unwrap_or("");
        format!("{digits:.1} digits of {case} at condition {condition:.1e}")
    };
    let kept = plain.iter().filter(|(_, _, d)| *d >= HALF).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let lost = plain.iter().filter(|(_, _, d)| *d < HALF).min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!("Cholesky alone keeps {} and is no longer enough with {}", name(kept), name(lost)))
}
