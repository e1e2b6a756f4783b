//! The solver frontier: every way of solving the problem at hand, against its coefficients in double-double.
//!
//! ```text
//! digits of the coefficients against time, method by method; error = 10^-digits
//! ```

use palpate_fitting::fit::{Equations, FitOptions, fit_contacts};
use palpate_geometry::contact::Contacts;
use palpate_numeric::threads;

use super::clock::{Call, Limits, Watch, rounds};
use super::digits::digits_of;
use super::pareto;
use super::point::Point;
use super::reference::reference;
use super::solver::Solver;

/// Rounds of the solvers: microseconds to milliseconds a call.
const LIMITS: Limits = Limits { least: 3, most: 40, seconds: 10.0, each: 0.1 };

/// The equations that are solved, and what the answer should be.
#[derive(Debug)]
struct Problem {
    name: String,
    condition: f64,
    contacts: usize,
    equations: Box<Equations>,
    reference: Vec<f64>,
}

/// Every call of the solver frontier with what it gives back.
#[derive(Debug)]
pub struct SolverSubject {
    problem: Option<Problem>,
    notes: Vec<String>,
}

impl SolverSubject {
    /// The problem of these contacts, named `scene`.
    pub fn new(scene: &str, contacts: &Contacts, options: &FitOptions) -> SolverSubject {
        match Problem::new(scene, contacts, options) {
            Ok(problem) => SolverSubject { problem: Some(problem), notes: Vec::new() },
            Err(why) => {
                let note = format!("the solver frontier leaves the scene itself out: {why}");
                SolverSubject { problem: None, notes: vec![note] }
            }
        }
    }

    /// Remarks.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    fn ways(&self) -> Vec<(&Problem, Solver)> {
        self.problem.iter().flat_map(|problem| Solver::all().into_iter().map(move |solver| (problem, solver))).collect()
    }

    /// Every call, method by method.
    pub fn calls(&self) -> Vec<Call<'_, Result<Vec<f64>, String>>> {
        fn call((problem, solver): (&Problem, Solver)) -> Call<'_, Result<Vec<f64>, String>> {
            Box::new(move |_| solver.solve(&problem.equations))
        }
        self.ways().into_iter().map(call).collect()
    }

    /// Measures every method, on one thread and in at most about so many seconds; those that are not reached are left out.
    pub fn measure(&self, seconds: f64, watch: Watch<'_>) -> Vec<Point> {
        threads::alone(|| self.measure_here(Limits { seconds: seconds.min(LIMITS.seconds), ..LIMITS }, watch))
    }

    fn measure_here(&self, limits: Limits, watch: Watch<'_>) -> Vec<Point> {
        let ways = self.ways();
        let mut found: Vec<Option<Result<f64, String>>> = vec![None; ways.len()];
        let times = rounds(&mut self.calls(), limits, watch, |k, number, answer| {
            // nothing is random: every call of a method gives the same bits
            if number == 0 {
                found[k] = Some(answer.map(|c| digits_of(&c, &ways[k].0.reference)));
            }
        });
        let mut points: Vec<Point> = Vec::new();
        for (((problem, solver), found), time) in ways.into_iter().zip(found).zip(times) {
            let Some(found) = found else { continue };
            let mut point = Point {
                label: solver.name(),
                case: Some(problem.name.clone()),
                method: solver.name(),
                contacts: problem.contacts,
                seconds: Some(time),
                replicates: 1,
                condition: Some(problem.condition),
                ..Point::default()
            };
            match found {
                Ok(digits) => {
                    let error = 10.0_f64.powf(-digits);
                    (point.digits, point.error, point.error_interval) = (Some(digits), Some(error), Some([error; 2]));
                }
                Err(why) => point.failed = Some(why),
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

impl Problem {
    fn new(scene: &str, contacts: &Contacts, options: &FitOptions) -> Result<Problem, String> {
        let fit = fit_contacts(contacts, options).map_err(|e| e.to_string())?;
        let equations = fit.equations().clone();
        if equations.roughness.is_some() || !fit.solution().unsupported.is_empty() {
            return Err("it is smoothed, or has coefficients without data".into());
        }
        let reference = reference(&equations)?;
        let equations = Box::new(equations);
        Ok(Problem { name: scene.into(), condition: fit.condition(), contacts: contacts.len(), equations, reference })
    }
}
