//! Gaps: coefficients that the data leave free, or hold only by a thread, take least-roughness values given the others.
//!
//! ```text
//! F = { columns of E with norm below 0.05 of the median, and those beside them below 0.25 },  D = the rest
//! P_FF c_F = -P_FD c_D        (roughness, by elimination: no small lambda)
//! A_DD c_D = E_D'(b - E_F c_F)
//! ```
//!
//! Without height rows the constant is free as well: one coefficient is pinned, and the mean height set to zero
//! afterwards, which moves no residual.
//!
//! The two are solved in turn; F is held by so little data that a handful of turns settles both.

use crate::fit::linear::Solution;
use crate::fit::linear::reasons::Reason;
use crate::fit::objective::equations::Equations;
use crate::linalg::{RowWeights, SiteWeights, StencilMatrix, apply_rows};
use crate::observation::roughness_matrix;
use crate::solve::Cholesky;

/// Columns whose norm is below this share of the median are held by a thread: their own data would put noise 20 times
/// the usual into the hole, while smoothness costs the rest of the surface less than 0.3 residual sd.
const THREAD: f64 = 0.05;
/// Beside a free coefficient this share is asked for instead. On the disc gap of the hard cases the worst error inside the
/// hole falls from 0.25 to 0.15 (0.2: 0.23, 0.3: 0.12) while nothing outside moves by more than 0.13 residual sd (0.17).
const RIM: f64 = 0.25;
/// Turns of the two solves at most; the coupling of thread columns is below 0.05^2, so 12 turns reach rounding.
const MAX_TURNS: usize = 40;

/// Which unknowns are free.
#[derive(Clone, Debug, Default)]
pub struct Free {
    flags: Vec<bool>,
    count: usize,
    pinned: Option<usize>,
}

/// Finds columns without data or held by a thread; with a roughness penalty every column is held.
pub fn find(matrix: &StencilMatrix, penalised: bool) -> Free {
    if penalised {
        return Free::default();
    }
    let diagonal = matrix.diagonal();
    let mut sorted: Vec<f64> = diagonal.iter().copied().filter(|d| *d > 0.0).collect();
    if sorted.is_empty() {
        return Free::default();
    }
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let flags: Vec<bool> = diagonal.iter().map(|d| *d < THREAD * THREAD * median).collect();
    let flags = with_rim(flags, &diagonal, median, matrix.shape().basis);
    let count = flags.iter().filter(|f| **f).count();
    if count == 0 { Free::default() } else { Free { flags, count, pinned: None } }
}

/// The same with the rim: neighbours of a free unknown that hang on little more than a thread themselves. They would
/// carry the noise of a few contacts at the edge of the hole across it.
fn with_rim(flags: Vec<bool>, diagonal: &[f64], median: f64, basis: [usize; 2]) -> Vec<bool> {
    let free = |i: usize, j: usize| flags[i * basis[1] + j];
    let beside = |i: usize, j: usize| {
        let rows = i.saturating_sub(1)..(i + 2).min(basis[0]);
        rows.into_iter().any(|a| (j.saturating_sub(1)..(j + 2).min(basis[1])).any(|b| free(a, b)))
    };
    let at = |u: usize| (u / basis[1], u % basis[1]);
    let hangs = |u: usize| diagonal[u] < RIM * RIM * median && beside(at(u).0, at(u).1);
    (0..flags.len()).map(|u| flags[u] || hangs(u)).collect()
}

impl Free {
    /// The same with the constant held still: the best determined coefficient that is not free is pinned to zero.
    pub fn pin_constant(mut self, matrix: &StencilMatrix) -> Free {
        let diagonal = matrix.diagonal();
        self.flags.resize(diagonal.len(), false);
        let held = (0..diagonal.len()).filter(|&u| !self.flags[u]);
        self.pinned = held.max_by(|&a, &b| diagonal[a].total_cmp(&diagonal[b]));
        self
    }

    /// Number of unknowns that no data hold.
    pub fn len(&self) -> usize {
        self.count + usize::from(self.pinned.is_some())
    }

    /// Every unknown is held.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The coefficient pinned to zero in place of the constant.
    pub fn pinned(&self) -> Option<usize> {
        self.pinned
    }

    /// Numbers of the free unknowns; the pinned one is as well determined as the others, up to the constant.
    pub fn list(&self) -> Vec<usize> {
        (0..self.flags.len()).filter(|&u| self.flags[u]).collect()
    }

    /// Sets the entries of free and pinned unknowns to zero.
    pub fn clear(&self, v: &mut [f64]) {
        self.flags.iter().zip(&mut *v).filter(|(free, _)| **free).for_each(|(_, w)| *w = 0.0);
        self.pinned.iter().for_each(|&u| v[u] = 0.0);
    }

    /// The matrix with free and pinned rows and columns replaced by those of the identity; `None` when there are none.
    pub fn mask(&self, matrix: &StencilMatrix) -> Option<StencilMatrix> {
        (!self.is_empty()).then(|| masked(matrix, |u| self.flags[u] || self.pinned == Some(u)))
    }
}

fn masked(matrix: &StencilMatrix, out: impl Fn(usize) -> bool) -> StencilMatrix {
    let mut result = matrix.clone();
    matrix.for_each_lower(|row, column, position| {
        if out(row) || out(column) {
            result.values_mut()[position] = if row == column { 1.0 } else { 0.0 };
        }
    });
    result
}

/// Solves for the held unknowns by `solution.factor` (of the masked matrix) and for the free ones by roughness, in turn.
pub fn complete_by_turns(equations: &Equations, solution: &mut Solution, free: &Free) {
    if free.count == 0 {
        let mut c = equations.right_side();
        free.clear(&mut c);
        solution.factor.solve(&mut c);
        solution.coefficients = c;
        return;
    }
    solution.reasons.push(Reason::Gap { coefficients: free.count });
    let penalty = roughness_matrix(&equations.sites.knots());
    let held_out = masked(&penalty, |u| !free.flags[u]);
    let Ok(mut smooth) = Cholesky::plan(penalty.shape()) else { return };
    if smooth.factor(&held_out).is_err() {
        return;
    }
    let mut bent = vec![0.0; solution.coefficients.len()];
    for turn in 0..MAX_TURNS {
        let before = solution.coefficients.clone();
        let mut step = equations.descent(&solution.coefficients);
        free.clear(&mut step);
        solution.factor.solve(&mut step);
        solution.coefficients.iter_mut().zip(&step).for_each(|(c, d)| *c += d);
        let mut held = solution.coefficients.clone();
        free.clear(&mut held);
        penalty.multiply(&held, &mut bent);
        for (u, b) in bent.iter_mut().enumerate() {
            *b = if free.flags[u] { -*b } else { 0.0 };
        }
        smooth.solve(&mut bent);
        for (u, b) in bent.iter().enumerate() {
            if free.flags[u] {
                solution.coefficients[u] = *b;
            }
        }
        let largest = solution.coefficients.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let moved = before.iter().zip(&solution.coefficients).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        if turn > 0 && moved <= 4.0 * f64::EPSILON * largest {
            break;
        }
    }
}

/// Unknowns that any undetermined direction moves by more than rounding.
pub fn touched(directions: &[Vec<f64>]) -> Vec<usize> {
    let mut list = Vec::new();
    for z in directions {
        let largest = z.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        list.extend((0..z.len()).filter(|&u| z[u].abs() > 1e-10 * largest));
    }
    list
}

/// Moves `c` along directions that the data cannot see to least roughness: `(Z'PZ) t = -Z'P c`, `c += Z t`.
pub fn smooth_along(penalty: &StencilMatrix, directions: &[Vec<f64>], c: &mut [f64]) {
    let count = directions.len();
    let mut bent = vec![0.0; c.len()];
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let mut matrix = faer::Mat::<f64>::zeros(count, count);
    let mut rhs = faer::Mat::<f64>::zeros(count, 1);
    for k in 0..count {
        penalty.multiply(&directions[k], &mut bent);
        (0..count).for_each(|l| matrix[(l, k)] = dot(&directions[l], &bent));
        rhs[(k, 0)] = -dot(c, &bent);
    }
    // planes are of no roughness: a self-adjoint eigendecomposition leaves such directions where they are
    let Ok(eigen) = matrix.self_adjoint_eigen(faer::Side::Lower) else { return };
    let (vectors, values) = (eigen.U(), eigen.S());
    let largest = (0..count).fold(0.0_f64, |m, k| m.max(values[k].abs()));
    for k in 0..count {
        if values[k] <= 1e-12 * largest {
            continue;
        }
        let along: f64 = (0..count).map(|l| vectors[(l, k)] * rhs[(l, 0)]).sum::<f64>() / values[k];
        for (l, direction) in directions.iter().enumerate() {
            let step = along * vectors[(l, k)];
            c.iter_mut().zip(direction).for_each(|(c, z)| *c += step * z);
        }
    }
}

/// Moves the surface up or down until its mean height over the data's sites is zero.
pub fn level(equations: &Equations, c: &mut [f64]) {
    let mut rows = Vec::new();
    let heights = RowWeights::Uniform(SiteWeights { z: 1.0, ..SiteWeights::default() });
    apply_rows(&equations.sites, &heights, c, &mut rows);
    let counts = |r: usize| {
        let m = equations.row_weights.at(r);
        m.a != 0.0 || m.d != 0.0
    };
    let met: Vec<f64> = (0..rows.len()).filter(|&r| counts(r)).map(|r| rows[r][0]).collect();
    let mean = met.iter().sum::<f64>() / met.len().max(1) as f64;
    c.iter_mut().for_each(|c| *c -= mean);
}
