//! Traces of the hat matrices, the unknowns that each kind of rows accounts for.
//!
//! ```text
//! H_b = E_b (E'WE + lambda P)^-1 E_b' W_b          trace H_b = trace (E'WE + lambda P)^-1 E_b' W_b E_b
//! ```

use crate::fit::linear::equations::{Equations, RowKind};
use crate::fit::linear::solution::Solution;
use crate::fit::noise::hutchinson::Signs;
use palpate_numeric::linalg::StencilMatrix;
use palpate_numeric::solve::Factor;

/// Unknowns up to which a trace takes one solve for each, where the factor has no trace of its own. Cholesky's comes from
/// the inverse's entries within the band; both are exact. For more unknowns (by nested dissection, QR or conjugate
/// gradients) the trace is estimated by probes, with an error below sqrt(2 n / 64).
const UNIT_VECTORS: usize = 400;
/// Probes of Hutchinson's estimator: its sd is then 18 % of sqrt(n), against rows that outnumber n.
const PROBES: usize = 64;

/// Traces of the hat matrices of height rows and of slope rows.
pub(crate) fn hat_traces(equations: &Equations, solution: &Solution) -> [f64; 2] {
    let heights = equations.data_matrix_of(RowKind::Heights);
    let of_heights = trace(solution, &heights);
    if equations.roughness.is_none() {
        return [of_heights, solution.rank as f64 - of_heights];
    }
    let slopes = equations.data_matrix_of(RowKind::Slopes);
    [of_heights, trace(solution, &slopes)]
}

/// `trace(A^-1 B)` over the unknowns that the data hold.
pub(crate) fn trace(solution: &Solution, b: &StencilMatrix) -> f64 {
    inverse_trace(&*solution.factor, b, &|u| solution.is_free(u))
}

/// The same over the unknowns for which `out` is false.
pub(crate) fn inverse_trace(factor: &dyn Factor, b: &StencilMatrix, out: &dyn Fn(usize) -> bool) -> f64 {
    let exact = factor.inverse_trace(b, out);
    exact.unwrap_or_else(|| {
        if b.order() <= UNIT_VECTORS { by_unit_vectors(factor, b, out) } else { by_probes(factor, b, out) }
    })
}

/// Sets the entries of unknowns that are out to zero.
fn clear(v: &mut [f64], out: &dyn Fn(usize) -> bool) {
    v.iter_mut().enumerate().filter(|(u, _)| out(*u)).for_each(|(_, v)| *v = 0.0);
}

fn by_unit_vectors(factor: &dyn Factor, b: &StencilMatrix, out: &dyn Fn(usize) -> bool) -> f64 {
    let order = b.order();
    let mut product = vec![0.0; order];
    let mut unit = vec![0.0; order];
    let mut sum = 0.0;
    for u in (0..order).filter(|&u| !out(u)) {
        unit.fill(0.0);
        unit[u] = 1.0;
        b.multiply(&unit, &mut product);
        clear(&mut product, out);
        factor.solve(&mut product);
        sum += product[u];
    }
    sum
}

fn by_probes(factor: &dyn Factor, b: &StencilMatrix, out: &dyn Fn(usize) -> bool) -> f64 {
    let order = b.order();
    let mut product = vec![0.0; order];
    let mut probe = vec![0.0; order];
    let mut signs = Signs::new();
    let mut sum = 0.0;
    for _ in 0..PROBES {
        for (u, p) in probe.iter_mut().enumerate() {
            let sign = signs.sign();
            *p = if out(u) { 0.0 } else { sign };
        }
        b.multiply(&probe, &mut product);
        clear(&mut product, out);
        factor.solve(&mut product);
        sum += probe.iter().zip(&product).map(|(p, v)| p * v).sum::<f64>();
    }
    sum / PROBES as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{FitOptions, Objective, SlopeWeights, Smooth, fit_contacts};
    use palpate_geometry::contact::Contacts;

    #[test]
    fn the_trace_within_the_band_is_that_of_unit_vectors_also_with_free_unknowns() {
        let place = |r: usize| [0.754_877_666, 0.569_840_291].map(|k| (r as f64 * k).fract());
        // a hole leaves coefficients free, slopes alone pin one
        let held = (0..6000).map(place).filter(|[x, y]| (x - 0.4).hypot(y - 0.5) > 0.2);
        let (x, y): (Vec<f64>, Vec<f64>) = held.map(|[x, y]| (x, y)).unzip();
        let z: Vec<f64> = x.iter().zip(&y).map(|(x, y)| (3.0 * x).sin() * y + 0.01 * (1e4 * x * y).sin()).collect();
        let slopes = z.iter().map(|z| 0.3 * z).collect::<Vec<f64>>();
        let contacts = Contacts::from_positions(x, y, z).with_slopes(slopes.clone(), slopes);
        for weights in [[1.0, 0.1, 0.1], [0.0, 1.0, 1.0]] {
            let objective = Objective::Slopes(SlopeWeights::Explicit(weights));
            let options = FitOptions { degree: [3, 2], segments: [22, 21], objective, ..FitOptions::default() };
            let fit = fit_contacts(&contacts, &options).unwrap();
            let (equations, solution) = (fit.equations(), fit.solution());
            assert!(!solution.unsupported.is_empty() && equations.unknowns() > UNIT_VECTORS);
            for kind in [RowKind::Heights, RowKind::Slopes] {
                let b = equations.data_matrix_of(kind);
                let out = |u: usize| solution.is_free(u);
                let expected = by_unit_vectors(&*solution.factor, &b, &out);
                let exact = trace(solution, &b);
                assert!((exact - expected).abs() <= 1e-9 * expected, "{weights:?} {kind:?}: {exact} {expected}");
                // the probes estimate the same number
                let probed = by_probes(&*solution.factor, &b, &out);
                let sd = (2.0 * equations.unknowns() as f64 / PROBES as f64).sqrt();
                assert!((probed - expected).abs() <= 4.0 * sd, "{weights:?} {kind:?}: {probed} {expected}");
            }
        }
    }

    /// Without a penalty the kinds share the unknowns; with one they share fewer, each as its own unit vectors say.
    #[test]
    fn the_traces_of_both_kinds_are_those_of_the_dense_hat_matrices() {
        let place = |r: usize| [0.754_877_666, 0.569_840_291].map(|k| (r as f64 * k).fract());
        let (x, y): (Vec<f64>, Vec<f64>) = (0..40).map(place).map(|[x, y]| (x, y)).unzip();
        let z: Vec<f64> = x.iter().zip(&y).map(|(x, y)| (3.0 * x).sin() * y).collect();
        let slopes = z.iter().map(|z| 0.3 * z).collect::<Vec<f64>>();
        let contacts = Contacts::from_positions(x, y, z).with_slopes(slopes.clone(), slopes);
        for smooth in [Smooth::None, Smooth::Lambda(0.1)] {
            let objective = Objective::Slopes(SlopeWeights::Equal);
            let options = FitOptions { segments: [3, 2], objective, smooth, ..FitOptions::default() };
            let fit = fit_contacts(&contacts, &options).unwrap();
            let (equations, solution) = (fit.equations(), fit.solution());
            let traces = hat_traces(equations, solution);
            let unknowns = equations.unknowns();
            // tr(A^-1 E_b'E_b) = sum of (E_b A^-1 e_u).(E_b e_u), and a product is a quarter of two squares' difference
            let mut expected = [0.0; 2];
            for u in 0..unknowns {
                let mut v: Vec<f64> = (0..unknowns).map(|k| f64::from(u8::from(k == u))).collect();
                solution.factor.solve(&mut v);
                let unit: Vec<f64> = (0..unknowns).map(|k| f64::from(u8::from(k == u))).collect();
                let polar = |sign: f64| {
                    let sum: Vec<f64> = v.iter().zip(&unit).map(|(v, e)| v + sign * e).collect();
                    equations.row_squares(&sum)
                };
                (0..2).for_each(|b| expected[b] += 0.25 * (polar(1.0)[b] - polar(-1.0)[b]));
            }
            for b in 0..2 {
                assert!((traces[b] - expected[b]).abs() < 1e-8, "{smooth:?}: {traces:?} {expected:?}");
            }
            let sum = traces[0] + traces[1];
            assert!(if smooth == Smooth::None {
                (sum - unknowns as f64).abs() < 1e-8
            } else {
                sum < unknowns as f64 - 0.5
            });
        }
    }
}
