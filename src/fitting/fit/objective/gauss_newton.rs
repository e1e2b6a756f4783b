//! Normal rows: Gauss-Newton on `sum ((z - S)/Z)^2 + |n - n^(S_x, S_y)|^2 / sigma^2`, with step control.
//!
//! Each step is the same sparse least squares with new rows. The iteration starts from the heights alone (from slope rows
//! where they are too few) and stops when no coefficient moves by more than 1e-10 of the largest. The final answer is then
//! polished until its steps are rounding: the steps contract linearly, so after a step of 1e-10 the error may be larger.

use std::cell::RefCell;

use crate::fit::linear;
use crate::fit::linear::equations::{Equations, packed_cells};
use crate::fit::linear::solution::Solution;
use crate::fit::noise::sds::RowSds;
use crate::fit::objective::budget::Budget;
use crate::fit::objective::extrapolation::LastStep;
use crate::fit::placing::sites::DataSites;
use crate::fit::{FitError, Method};
use crate::observation::{Measured, Roughness, angular_residual_squared, linearise_normals};
use palpate_numeric::linalg::{RowWeights, SiteWeights, Sites, Targets, dot, visit_values};

/// Steps at most: with poor normals each step is a third of the last, so 1e-10 takes some 25; after 200 there is no minimum
/// nearby.
const MAX_STEPS: usize = 200;
/// Steps that do not halve the least move so far, after which moves below [`AT_ROUNDING`] are taken for rounding: badly
/// conditioned rows never come to rest at 1e-10. Slowly shrinking steps, a third and more of the last one, halve sooner.
const AT_REST: usize = 20;
/// Moves above this are no rounding.
pub(super) const AT_ROUNDING: f64 = 1e-6;
/// Halvings of one step at most: where 2^-30 of it does not lower the objective, the point is stationary to rounding.
const MAX_HALVINGS: usize = 30;
/// Polishing steps at most: each, with the extrapolation between them, gains one to four of the last six digits.
const MAX_POLISH: usize = 8;
/// A move this small is rounding.
const POLISHED: f64 = 8.0 * f64::EPSILON;
/// The start takes slopes from normals no flatter than this, so that nz = 0 does not divide.
const START_NZ: f64 = 0.05;

/// Where Gauss-Newton ended.
#[derive(Debug)]
pub(super) struct Minimum {
    /// The last linearised problem.
    pub equations: Equations,
    /// Its solution.
    pub solution: Solution,
    /// Steps taken.
    pub steps: usize,
    /// Move of the last step, relative to the largest coefficient.
    pub moved: f64,
    /// The last full step; empty before the first.
    pub step: Vec<f64>,
}

impl Minimum {
    /// `|E s|_2` of the last full step: what that step moved the rows by.
    pub(super) fn last_step(&self) -> f64 {
        if self.step.is_empty() {
            return f64::INFINITY;
        }
        let of_data: f64 = self.equations.row_squares(&self.step).iter().sum();
        let of_roughness = self.equations.roughness.as_ref().map_or(0.0, |rough| roughness_of(rough, &self.step));
        (of_data + of_roughness).sqrt()
    }
}

/// `lambda c'Pc`.
fn roughness_of(Roughness { lambda, penalty, .. }: &Roughness, c: &[f64]) -> f64 {
    let mut bent = vec![0.0; c.len()];
    penalty.multiply(c, &mut bent);
    lambda * dot(c, &bent)
}

/// The nonlinear problem at fixed noise sds.
pub(super) struct NormalProblem<'a> {
    /// Sites of the data.
    pub sites: &'a DataSites,
    /// Heights and normals.
    pub measured: &'a Measured,
    /// Noise sds.
    pub sds: RowSds,
    /// The roughness penalty.
    pub roughness: Option<Roughness>,
    /// Linear solver.
    pub method: Method,
    /// Steps that are left to all loops of the fit.
    pub budget: &'a Budget,
    /// Equations that are no longer needed, whose memory the next ones take.
    pub spare: &'a RefCell<Option<Equations>>,
}

impl NormalProblem<'_> {
    /// Minimises from `start`, or from heights alone, until a step moves by no more than `tolerance` of the largest
    /// coefficient, or the budget is spent. The equations returned are those of that step, linearised about the coefficients before it;
    /// [`NormalProblem::polish`] replaces them by equations about the answer.
    ///
    /// # Errors
    /// [`FitError::NotSettled`], or where a linear step has no solution.
    pub(super) fn minimise(&self, start: Option<&[f64]>, tolerance: f64) -> Result<Minimum, FitError> {
        let mut current = match start {
            Some(c) => c.to_vec(),
            None => self.start()?,
        };
        let mut value = self.objective(&current);
        let mut moved = f64::INFINITY;
        let (mut least, mut least_at) = (f64::INFINITY, 0);
        for steps in 1..=MAX_STEPS {
            let equations = self.linearised(&current);
            let mut solution = linear::solve_intermediate(&equations, self.method)?;
            let (next, next_value) = self.line_search(&current, value, &solution.coefficients);
            let largest = next.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
            moved = current.iter().zip(&next).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            moved /= largest.max(f64::MIN_POSITIVE);
            (current, value) = (next, next_value);
            if moved < 0.5 * least {
                (least, least_at) = (moved, steps);
            }
            let is_at_rest = steps - least_at >= AT_REST && least <= AT_ROUNDING;
            self.budget.take(&equations, &solution);
            if moved <= tolerance || is_at_rest || self.budget.is_spent() {
                solution.coefficients = current;
                return Ok(Minimum { equations, solution, steps, moved, step: Vec::new() });
            }
            self.spare.replace(Some(equations));
        }
        Err(FitError::NotSettled { steps: MAX_STEPS, moved })
    }

    /// Full steps from a minimum found roughly, until they are rounding, those that would follow two of them at once.
    ///
    /// # Errors
    /// Where a linear step has no solution.
    pub(super) fn polish(&self, mut found: Minimum) -> Result<Minimum, FitError> {
        let mut from = found.solution.coefficients.clone();
        let mut before = LastStep::default();
        let mut last = f64::INFINITY;
        for _ in 0..MAX_POLISH {
            let equations = self.linearised(&from);
            let solution = linear::solve(&equations, self.method)?;
            let step: Vec<f64> = solution.coefficients.iter().zip(&from).map(|(a, b)| a - b).collect();
            let largest = solution.coefficients.iter().fold(f64::MIN_POSITIVE, |m, c| m.max(c.abs()));
            let moved = step.iter().fold(0.0_f64, |m, d| m.max(d.abs())) / largest;
            if moved >= last {
                break;
            }
            last = moved;
            from = solution.coefficients.clone();
            let steps = found.steps + 1;
            let next = Minimum { equations, solution, steps, moved, step: step.clone() };
            let replaced = std::mem::replace(&mut found, next);
            self.spare.replace(Some(replaced.equations));
            if moved <= POLISHED {
                break;
            }
            before.extrapolate(&mut from, step);
        }
        Ok(found)
    }

    fn line_search(&self, from: &[f64], value: f64, to: &[f64]) -> (Vec<f64>, f64) {
        let mut share = 1.0;
        for _ in 0..MAX_HALVINGS {
            let next: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + share * (b - a)).collect();
            let next_value = self.objective(&next);
            // near the minimum the objective is equal to rounding, which is accepted
            if next_value <= value * (1.0 + 1e-14) {
                return (next, next_value);
            }
            share *= 0.5;
        }
        (from.to_vec(), value)
    }

    fn start(&self) -> Result<Vec<f64>, FitError> {
        let heights = RowWeights::PerSite(
            self.measured.z_weight.iter().map(|w| SiteWeights { z: *w, ..SiteWeights::default() }).collect(),
        );
        let targets: Targets =
            self.measured.z.iter().zip(&self.measured.z_weight).map(|(z, w)| [w * z, 0.0, 0.0]).collect();
        let equations = Equations::new(self.sites.clone(), heights, targets, self.roughness.clone());
        if equations.count() >= equations.unknowns() {
            match linear::solve_intermediate(&equations, Method::Cholesky) {
                Ok(solution) if solution.rank == equations.unknowns() => return Ok(solution.coefficients),
                _ => {}
            }
        }
        Ok(linear::solve_intermediate(&self.slope_start(), Method::Auto)?.coefficients)
    }

    fn slope_start(&self) -> Equations {
        let (mut site_weights, mut targets) = (Vec::new(), Targets::new());
        for r in 0..self.measured.z.len() {
            let [nx, ny, nz] = self.measured.normals[r];
            let (wz, w) = (self.measured.z_weight[r], self.measured.normal_weight[r]);
            let nz = nz.max(START_NZ);
            site_weights.push(SiteWeights { z: wz, a: w, b: 0.0, d: w });
            targets.push([wz * self.measured.z[r], -w * nx / nz, -w * ny / nz]);
        }
        Equations::new(self.sites.clone(), RowWeights::PerSite(site_weights), targets, self.roughness.clone())
    }

    /// The rows of one Gauss-Newton step about `c`.
    pub(super) fn linearised(&self, c: &[f64]) -> Equations {
        let equations = self.spare.take().unwrap_or_else(|| {
            let weights = RowWeights::PerSite(vec![SiteWeights::default(); self.sites.len()]);
            let targets = vec![[0.0; 3]; self.sites.len()];
            Equations::new(self.sites.clone(), weights, targets, self.roughness.clone())
        });
        equations.refilled(|site_weights, targets| self.linearise_into(c, site_weights, targets))
    }

    fn linearise_into(&self, c: &[f64], site_weights: &mut [SiteWeights], targets: &mut Targets) {
        self.each_site(c, |r, [_, p, q]| {
            let z = self.measured.z_weight[r] / self.sds.z;
            let w = self.measured.normal_weight[r] / self.sds.slope;
            site_weights[r] = SiteWeights { z, ..SiteWeights::default() };
            targets[r] = [z * self.measured.z[r], 0.0, 0.0];
            if w != 0.0 {
                let (u, [first, second]) = linearise_normals(self.measured.normals[r], p, q);
                site_weights[r] = SiteWeights { z, a: w * u.a, b: w * u.b, d: w * u.d };
                (targets[r][1], targets[r][2]) = (w * first, w * second);
            }
        });
    }

    /// Calls `visit(site, [S, S_x, S_y])` for every site, in the order of the knot cells.
    pub(super) fn each_site(&self, c: &[f64], visit: impl FnMut(usize, [f64; 3])) {
        if let Some(cells) = packed_cells(self.sites) {
            return cells.values(c, visit);
        }
        visit_values(self.sites, c, visit);
    }

    /// Weighted squares of heights and normals (true chords) at `c`.
    pub(super) fn squares(&self, c: &[f64]) -> [f64; 2] {
        let mut sums = [0.0, 0.0];
        self.each_site(c, |r, [s, p, q]| {
            let (wz, w) = (self.measured.z_weight[r], self.measured.normal_weight[r]);
            if wz != 0.0 {
                let residual = wz * (self.measured.z[r] - s) / self.sds.z;
                sums[0] += residual * residual;
            }
            if w != 0.0 {
                let chord = angular_residual_squared(self.measured.normals[r], p, q);
                sums[1] += w * w * chord / (self.sds.slope * self.sds.slope);
            }
        });
        sums
    }

    fn objective(&self, c: &[f64]) -> f64 {
        let [heights, normals] = self.squares(c);
        heights + normals + self.roughness.as_ref().map_or(0.0, |rough| roughness_of(rough, c))
    }
}
