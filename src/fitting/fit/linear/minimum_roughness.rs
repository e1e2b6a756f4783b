//! Gaps: free coefficients take the values of least roughness, given the others.
//!
//! ```text
//! P_FF c_F = -P_FD c_D        (roughness, by elimination: no small lambda)
//! A_DD c_D = E_D'(b - E_F c_F)
//! ```
//!
//! The two are solved alternately. Mostly so few data reach F that a handful of alternations settles both; where they reach
//! farther, alternation is slow or diverges, and its fixed point is solved for.
//!
//! Rounding in the first system moves the free coefficients, and by their rows the others:
//!
//! ```text
//! |dc_F|  <=  k u | |P_FF^-1| |P||c| |,     |D^-1 dc_D|  <=  |(E_D D)^+| |E_F dc_F|        k the roundings of an entry of P
//! ```

use faer::linalg::solvers::Solve;

use crate::fit::linear::equations::Equations;
use crate::fit::linear::free_unknowns::Free;
use crate::fit::linear::reasons::Reason;
use crate::fit::linear::solution::{BEYOND_CHOLESKY, Solution};
use crate::observation::{RoughnessOrder, roughness_matrix, roundings};
use palpate_numeric::linalg::{RowWeights, SiteWeights, StencilMatrix, apply_rows, inverse_norm1_estimate};
use palpate_numeric::solve::{Cholesky, Factor, SolveError};

/// Alternations of the two solves at most; nearly free columns couple by less than 0.05^2, so 12 reach rounding.
const MAX_ALTERNATIONS: usize = 40;
/// Free coefficients for whose coupling a dense system is written down where alternation has not settled: each costs an
/// alternation.
const MAX_DENSE: usize = 500;
/// Corrections by that system at most; one is nearly always enough.
const MAX_CORRECTIONS: usize = 4;
/// Moves of less than this share of the largest coefficient are rounding.
const STILL: f64 = 4.0 * f64::EPSILON;

/// The two solves.
struct Gap<'a> {
    equations: &'a Equations,
    factor: &'a dyn Factor,
    free: &'a Free,
    penalty: StencilMatrix,
    smooth: Cholesky,
}

/// Solves for the held unknowns by `solution.factor` (of the masked matrix) and for the free ones by least roughness.
///
/// # Errors
/// Where least roughness does not determine the free unknowns.
pub(super) fn solve_with_gaps(equations: &Equations, solution: &mut Solution, free: &Free) -> Result<(), SolveError> {
    if free.count() == 0 {
        let mut c = equations.right_side();
        free.clear(&mut c);
        solution.factor.solve(&mut c);
        solution.coefficients = c;
        return Ok(());
    }
    solution.reasons.push(Reason::Gap { coefficients: free.count() });
    let penalty = roughness_matrix(&equations.sites.knots(), RoughnessOrder::Second.terms());
    let mut smooth = Cholesky::plan(penalty.shape())?;
    smooth.factor(&free.keep(&penalty))?;
    if smooth.condition() > BEYOND_CHOLESKY {
        // planes have no roughness: where one fits into the gap, the factor is made of rounding
        let unknown = (0..solution.coefficients.len()).find(|&u| free.has(u)).unwrap_or(0);
        return Err(SolveError::NotPositiveDefinite { unknown });
    }
    let gap = Gap { equations, factor: &*solution.factor, free, penalty, smooth };
    let mut c = vec![0.0; solution.coefficients.len()];
    let mut moved = f64::INFINITY;
    let mut contraction = 1.0;
    let mut first = Vec::new();
    for alternation in 0..MAX_ALTERNATIONS {
        let before = moved;
        solution.turns += 1;
        moved = gap.alternate(&mut c);
        contraction = moved / before;
        if alternation == 0 {
            first = c.clone();
        } else if moved <= STILL {
            solution.filled = free.seen() * gap.rounding(&c);
            solution.coefficients = c;
            return Ok(());
        }
    }
    // what all alternations that are not made would move
    let mut amplified = if contraction < 1.0 { 1.0 / (1.0 - contraction) } else { f64::INFINITY };
    solution.unsettled = moved * amplified;
    if free.count() <= MAX_DENSE {
        solution.turns += free.count();
        if let Some(settled) = gap.settle(first) {
            (c, solution.unsettled) = (settled.coefficients, settled.off);
            (amplified, solution.enlarged) = (settled.amplified, settled.enlarged);
        }
    }
    solution.filled = amplified * free.seen() * gap.rounding(&c);
    solution.coefficients = c;
    Ok(())
}

/// The fixed point of the alternation.
struct Settled {
    coefficients: Vec<f64>,
    /// What the free ones can be off by, over the largest coefficient.
    off: f64,
    /// `|(I - M)^-1|`.
    amplified: f64,
    /// `|(I - M)^-1| (1 + |M|)`.
    enlarged: f64,
}

impl Gap<'_> {
    /// Held unknowns by the data, then free ones by the roughness; the largest move over the largest coefficient.
    fn alternate(&self, c: &mut [f64]) -> f64 {
        let before = c.to_vec();
        let mut step = self.equations.descent(c);
        self.free.clear(&mut step);
        self.factor.solve(&mut step);
        c.iter_mut().zip(&step).for_each(|(c, d)| *c += d);
        // as a correction, so that the turns refine what the factor of P_FF has rounded
        let mut bent = vec![0.0; c.len()];
        self.penalty.multiply(c, &mut bent);
        for (u, b) in bent.iter_mut().enumerate() {
            *b = if self.free.has(u) { -*b } else { 0.0 };
        }
        self.smooth.solve(&mut bent);
        (0..c.len()).filter(|&u| self.free.has(u)).for_each(|u| c[u] += bent[u]);
        let largest = c.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let moved = before.iter().zip(&*c).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        if largest > 0.0 { moved / largest } else { 0.0 }
    }

    /// Where one alternation takes the free coefficients `x` to `t + M x`, those with `(I - M) x = t`, by a dense factor of
    /// I - M. They can be off by `|(I - M)^-1|` times the next alternation's move. `None` where not finite.
    fn settle(&self, mut c: Vec<f64>) -> Option<Settled> {
        let list = self.free.list();
        let size = c.iter().fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
        let of_free = |c: &[f64]| list.iter().map(|&u| c[u]).collect::<Vec<f64>>();
        let mut reached = c.clone();
        self.alternate(&mut reached);
        let reached = of_free(&reached);
        let mut coupling = faer::Mat::<f64>::identity(list.len(), list.len());
        for (k, &u) in list.iter().enumerate() {
            let mut pushed = c.clone();
            pushed[u] += size;
            self.alternate(&mut pushed);
            let pushed = of_free(&pushed);
            (0..list.len()).for_each(|l| coupling[(l, k)] -= (pushed[l] - reached[l]) / size);
        }
        let factor = coupling.full_piv_lu();
        let mut inverse = faer::Mat::<f64>::identity(list.len(), list.len());
        factor.solve_in_place(&mut inverse);
        let row = |k: usize| (0..list.len()).map(|l| inverse[(k, l)].abs()).sum::<f64>();
        let amplified = (0..list.len()).map(row).fold(1.0_f64, f64::max);
        let of =
            |k: usize| (0..list.len()).map(|l| (coupling[(k, l)] - f64::from(u8::from(k == l))).abs()).sum::<f64>();
        let enlarged = amplified * (1.0 + (0..list.len()).map(of).fold(0.0_f64, f64::max));
        let mut moved = f64::INFINITY;
        for _ in 0..MAX_CORRECTIONS {
            let from = of_free(&c);
            self.alternate(&mut c);
            let mut step = faer::Mat::<f64>::from_fn(list.len(), 1, |k, _| c[list[k]] - from[k]);
            factor.solve_in_place(&mut step);
            list.iter().enumerate().for_each(|(k, &u)| c[u] = from[k] + step[(k, 0)]);
            let mut next = c.clone();
            let rest = self.alternate(&mut next);
            if !rest.is_finite() || rest >= moved {
                break;
            }
            (c, moved) = (next, rest);
            if moved <= STILL {
                break;
            }
        }
        let off = amplified * moved.max(STILL);
        (off.is_finite() && enlarged.is_finite()).then_some(Settled { coefficients: c, off, amplified, enlarged })
    }

    /// What rounding in P can move a free coefficient by: `k u | |P_FF^-1| |P||c| |`, the norm estimated as LAPACK does for its
    /// forward errors.
    fn rounding(&self, c: &[f64]) -> f64 {
        let (mut sizes, magnitudes) = (vec![0.0; c.len()], c.iter().map(|v| v.abs()).collect::<Vec<f64>>());
        let mut penalty = self.penalty.clone();
        penalty.values_mut().iter_mut().for_each(|v| *v = v.abs());
        penalty.multiply(&magnitudes, &mut sizes);
        let scale = |v: &mut [f64]| (0..v.len()).for_each(|u| v[u] *= if self.free.has(u) { sizes[u] } else { 0.0 });
        let after = |v: &mut [f64]| {
            self.smooth.solve(v);
            scale(v);
        };
        let before = |v: &mut [f64]| {
            scale(v);
            self.smooth.solve(v);
        };
        0.5 * f64::EPSILON * roundings(self.penalty.shape().degree) * inverse_norm1_estimate(c.len(), after, before)
    }
}

/// Moves the surface up or down until its mean height over the sites with slopes is zero, which changes no residual.
pub(super) fn centre_heights(equations: &Equations, c: &mut [f64]) {
    let mut rows = Vec::new();
    let heights = RowWeights::Uniform(SiteWeights { z: 1.0, ..SiteWeights::default() });
    apply_rows(&equations.sites, &heights, c, &mut rows);
    let has_slope = |r: usize| {
        let m = equations.row_weights.at(r);
        m.a != 0.0 || m.d != 0.0
    };
    let met: Vec<f64> = (0..rows.len()).filter(|&r| has_slope(r)).map(|r| rows[r][0]).collect();
    let mean = met.iter().sum::<f64>() / met.len().max(1) as f64;
    c.iter_mut().for_each(|c| *c -= mean);
}
