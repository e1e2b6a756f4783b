//! The member nearest to the true surface: least squares inside the ranges of the sizes.
//!
//! ```text
//! (J'J + lambda D) step = -J'r,  D of J'J's diagonal        sizes at an end of their range stay there while the step points outwards
//! ```
//!
//! D. W. Marquardt, *J. SIAM* 11 (1963) 431.

use super::member::Member;
use super::view::{Held, View};

/// Longest rotation of one step, radians, and largest change of a size relative to it.
const TURN: f64 = 0.3;
const CHANGE: f64 = 0.5;

/// Least share of the diagonal that is added.
const LEAST_DAMPING: f64 = 1e-9;

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solves (F + lambda) x = g by Cholesky's factor, F of unit diagonal.
pub(crate) fn solve(f: &[Vec<f64>], g: &[f64], lambda: f64) -> Vec<f64> {
    let n = g.len();
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let v = f[i][j] + if i == j { lambda } else { 0.0 } - dot(&l[i][..j], &l[j][..j]);
            l[i][j] = if i == j { v.max(1e-18).sqrt() } else { v / l[j][j] };
        }
    }
    let mut x = g.to_vec();
    for i in 0..n {
        x[i] = (x[i] - dot(&l[i][..i], &x[..i])) / l[i][i];
    }
    for i in (0..n).rev() {
        let above: f64 = (i + 1..n).map(|k| l[k][i] * x[k]).sum();
        x[i] = (x[i] - above) / l[i][i];
    }
    x
}

/// Columns of unit length: their products, and the lengths. A column of rounding, where a motion leaves the body as it is, stays short.
pub(crate) fn products(columns: &[Vec<f64>]) -> (Vec<Vec<f64>>, Vec<f64>) {
    let lengths: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    let least = 1e-6 * lengths.iter().copied().fold(1e-100, f64::max);
    let sizes: Vec<f64> = lengths.iter().map(|length| length.max(least)).collect();
    let row = |i: usize| (0..columns.len()).map(|j| dot(&columns[i], &columns[j]) / (sizes[i] * sizes[j])).collect();
    ((0..columns.len()).map(row).collect(), sizes)
}

/// The end of a descent with its sum of squares.
pub(crate) fn descend(view: &View, start: Member, held: Option<Held>, iterations: usize) -> Option<(Member, f64)> {
    let mut member = start;
    let mut residual = view.residual(&member, held)?;
    let mut square = dot(&residual, &residual);
    let mut lambda = 1e-3;
    for _ in 0..iterations {
        let Some((columns, _)) = view.derivatives(&member, held) else { break };
        let (f, sizes) = products(&columns);
        let g: Vec<f64> = columns.iter().zip(&sizes).map(|(c, size)| -dot(c, &residual) / size).collect();
        let before = square;
        while lambda < 1e6 {
            let step = bounded(&member, &f, &g, &sizes, lambda);
            let (next, part) = taken(&member, &step);
            // what no contact tells makes steps long, and those alone would be shortened with them
            let tried = if part < 1.0 && lambda < 1e-2 { None } else { view.residual(&next, held) };
            let tried = tried.map(|residual| (dot(&residual, &residual), residual));
            if let Some((less, tried)) = tried.filter(|(tried, _)| *tried < square) {
                (member, residual, square) = (next, tried, less);
                lambda = f64::max(0.1 * lambda, LEAST_DAMPING);
                break;
            }
            lambda *= 10.0;
        }
        if before - square < 1e-7 * square + 1e-12 {
            break;
        }
    }
    Some((member, square))
}

/// The step, without the sizes that it would push out of their ranges.
fn bounded(member: &Member, f: &[Vec<f64>], g: &[f64], sizes: &[f64], lambda: f64) -> Vec<f64> {
    let limits = member.kind.limits();
    let mut free: Vec<usize> = (0..g.len()).collect();
    loop {
        let of_free: Vec<Vec<f64>> = free.iter().map(|&i| free.iter().map(|&j| f[i][j]).collect()).collect();
        let right: Vec<f64> = free.iter().map(|&i| g[i]).collect();
        let mut step = vec![0.0; g.len()];
        free.iter().zip(solve(&of_free, &right, lambda)).for_each(|(&i, x)| step[i] = x / sizes[i]);
        let leaves = |i: usize| {
            limits.get(i).is_some_and(|[lo, hi]| {
                let size = member.sizes[i];
                size <= *lo && step[i] < 0.0 || size >= *hi && step[i] > 0.0
            })
        };
        let before = free.len();
        free.retain(|&i| !leaves(i));
        if free.len() == before {
            return step;
        }
    }
}

/// The member after a step, and the part of it that was taken.
fn taken(member: &Member, step: &[f64]) -> (Member, f64) {
    let (of_sizes, motion) = step.split_at(member.sizes.len());
    let turn = dot(&motion[..3], &motion[..3]).sqrt();
    let most = member.sizes.iter().map(|size| CHANGE * size.abs().max(0.05));
    let part = of_sizes.iter().zip(most).map(|(step, most)| most / step.abs()).fold(TURN / turn, f64::min).min(1.0);
    let by = |k: usize| part * motion[k];
    let mut moved = member.moved([by(0), by(1), by(2)], [by(3), by(4), by(5)]);
    for ((size, step), [lo, hi]) in moved.sizes.iter_mut().zip(of_sizes).zip(member.kind.limits()) {
        *size = (*size + part * step).clamp(lo, hi);
    }
    (moved, part)
}
