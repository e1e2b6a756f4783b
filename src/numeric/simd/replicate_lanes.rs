//! Many replicates of one small fit at once, one replicate in each SIMD lane: coefficients from gaussians, and means of S
//! and R from coefficients.
//!
//! ```text
//! c_i += sum_k P[i][k] n_k           S_g, R_g from c at every grid point g           mean over g, replicate by replicate
//! along y on a segment:  S_x = sum_k P_1,k t^k,  P_d,k = sum_av N_a^(d)(x) D_k[v] c[first_x + a][first_y + v]
//! ```
//!
//! Lanes are never combined, so a replicate's bits do not depend on its neighbours.

use super::curvature_row::RowPieces;
use super::lanes::Lanes;
use super::shape_maps::ShapeBatch;
use super::{Isa, dispatch};

/// Numbers whose S and R are computed together: 32 points of eight lanes.
const BATCH: usize = 256;

/// Replicates in a block.
pub const REPLICATES: usize = 32;

/// The points of the shape grid: basis values at every x, `(p + 1)` per point and derivative, and runs of points in y.
#[derive(Clone, Debug)]
pub struct GridTables {
    /// First basis function of every x.
    pub first_x: Vec<usize>,
    /// `x[d][i (p + 1) + a]`: d-th derivatives.
    pub x: [Vec<f64>; 3],
    /// The points in y with the Taylor coefficients of their segments.
    pub y: RowPieces,
}

#[inline(always)]
fn draws<V: Lanes>(weights: &[[f64; 3]], gaussians: &[[f64; REPLICATES]; 3], coefficients: &mut [[f64; REPLICATES]]) {
    for l in (0..REPLICATES).step_by(V::N) {
        let n = gaussians.each_ref().map(|row| V::load(&row[l..]));
        for (w, c) in weights.iter().zip(coefficients.iter_mut()) {
            let mut sum = V::load(&c[l..]);
            for k in 0..3 {
                sum = V::splat(w[k]).mul_add(n[k], sum);
            }
            sum.store(&mut c[l..]);
        }
    }
}

/// `coefficients[i] += sum_k weights[i][k] gaussians[k]`, lane by lane.
pub fn add_draws(
    isa: Isa,
    weights: &[[f64; 3]],
    gaussians: &[[f64; REPLICATES]; 3],
    coefficients: &mut [[f64; REPLICATES]],
) {
    dispatch!(isa, draws [](weights: &[[f64; 3]], gaussians: &[[f64; REPLICATES]; 3], coefficients: &mut [[f64; REPLICATES]]));
}

/// Sums over the points of a grid, lane by lane.
#[derive(Clone, Copy)]
struct Sums<V> {
    shape_index: V,
    defined: V,
    curvedness: V,
}

impl<V: Lanes> Sums<V> {
    /// Adds the first `count` sets of lanes of a batch.
    #[inline(always)]
    fn add(&mut self, batch: &mut ShapeBatch<BATCH>, count: usize) {
        for k in 0..count {
            self.curvedness = self.curvedness + batch.root::<V>(k * V::N);
        }
        let zero = V::splat(0.0);
        for k in 0..count {
            let s = batch.index::<V>(k * V::N);
            // comparisons with NaN are false, so flat points are left out of the mean of S
            let defined = V::splat(-2.0).less(s);
            self.shape_index = self.shape_index + V::select(defined, s, zero);
            self.defined = self.defined + V::select(defined, V::splat(1.0), zero);
        }
    }
}

/// `powers[a][k] = sum_v D_k[v] c[first_x + a][first_y + v]` of the lanes from `l` on: powers of t instead of basis
/// functions in y.
#[inline(always)]
fn powers_of<V: Lanes, const W: usize>(
    y: &RowPieces,
    run: usize,
    first_x: usize,
    coefficients: &[[f64; REPLICATES]],
    l: usize,
) -> [[V; W]; W] {
    let mut powers = [[V::splat(0.0); W]; W];
    for a in 0..W {
        let line = &coefficients[(first_x + a) * y.n_basis + y.first[run]..][..W];
        for v in 0..W {
            let c = V::load(&line[v][l..]);
            for k in 0..W {
                powers[a][k] = V::splat(y.taylor[(k * W + v) * y.padded + run]).mul_add(c, powers[a][k]);
            }
        }
    }
    powers
}

/// The polynomials in t of S_x, S_y, S_xx, S_xy and S_yy along y, lowest power first.
struct Lines<V, const W: usize>([[V; W]; 5]);

impl<V: Lanes, const W: usize> Lines<V, W> {
    #[inline(always)]
    fn new(grid: &GridTables, i: usize, powers: &[[V; W]; W]) -> Lines<V, W> {
        let zero = V::splat(0.0);
        let mut along = [[zero; W]; 3];
        for (d, line) in along.iter_mut().enumerate() {
            let weights = &grid.x[d][i * W..][..W];
            for a in 0..W {
                let weight = V::splat(weights[a]);
                for k in 0..W {
                    line[k] = weight.mul_add(powers[a][k], line[k]);
                }
            }
        }
        let [mut y, mut xy, mut yy] = [[zero; W]; 3];
        for k in 1..W {
            let factor = V::splat(k as f64);
            (y[k - 1], xy[k - 1]) = (factor * along[0][k], factor * along[1][k]);
        }
        for k in 1..W - 1 {
            yy[k - 1] = V::splat(k as f64) * y[k];
        }
        Lines([along[1], y, along[2], xy, yy])
    }

    #[inline(always)]
    fn at(&self, t: V) -> [V; 5] {
        let value = |line: usize, degree: usize| {
            let mut sum = self.0[line][degree];
            for k in (0..degree).rev() {
                sum = sum.mul_add(t, self.0[line][k]);
            }
            sum
        };
        [value(0, W - 1), value(1, W - 2), value(2, W - 1), value(3, W - 2), value(4, W - 3)]
    }
}

#[inline(always)]
fn means_of<V: Lanes, const W: usize>(
    grid: &GridTables,
    coefficients: &[[f64; REPLICATES]],
    shape_index: &mut [f64; REPLICATES],
    curvedness: &mut [f64; REPLICATES],
) {
    let zero = V::splat(0.0);
    let mut batch = ShapeBatch::<BATCH>::new();
    for l in (0..REPLICATES).step_by(V::N) {
        let mut sums = Sums { shape_index: zero, defined: zero, curvedness: zero };
        let (mut waiting, mut from) = (0, 0);
        for (run, &to) in grid.y.ends.iter().enumerate() {
            let mut held = usize::MAX;
            let mut powers = [[zero; W]; W];
            for (i, &first_x) in grid.first_x.iter().enumerate() {
                if first_x != held {
                    held = first_x;
                    powers = powers_of::<V, W>(&grid.y, run, first_x, coefficients, l);
                }
                let lines = Lines::new(grid, i, &powers);
                let mut j = from;
                while j < to {
                    let count = (to - j).min(BATCH / V::N - waiting);
                    for (k, t) in grid.y.offsets[j..j + count].iter().enumerate() {
                        batch.put((waiting + k) * V::N, lines.at(V::splat(*t)));
                    }
                    (j, waiting) = (j + count, waiting + count);
                    if waiting == BATCH / V::N {
                        sums.add(&mut batch, waiting);
                        waiting = 0;
                    }
                }
            }
            from = to;
        }
        sums.add(&mut batch, waiting);
        sums.shape_index.div(sums.defined).store(&mut shape_index[l..]);
        let points = (grid.first_x.len() * grid.y.len()) as f64;
        sums.curvedness.div(V::splat(points)).store(&mut curvedness[l..]);
    }
}

/// Mean S (over the points where S is defined; NaN if there are none) and mean R of every lane's surface.
///
/// Both degrees are equal, 2 to 4; returns `false`, and does nothing, for others.
pub fn mean_shapes(
    isa: Isa,
    degree: [usize; 2],
    grid: &GridTables,
    coefficients: &[[f64; REPLICATES]],
    shape_index: &mut [f64; REPLICATES],
    curvedness: &mut [f64; REPLICATES],
) -> bool {
    if degree[0] != degree[1] {
        return false;
    }
    match degree[0] {
        2 => of_width::<3>(isa, grid, coefficients, shape_index, curvedness),
        3 => of_width::<4>(isa, grid, coefficients, shape_index, curvedness),
        4 => of_width::<5>(isa, grid, coefficients, shape_index, curvedness),
        _ => return false,
    }
    true
}

fn of_width<const W: usize>(
    isa: Isa,
    grid: &GridTables,
    coefficients: &[[f64; REPLICATES]],
    shape_index: &mut [f64; REPLICATES],
    curvedness: &mut [f64; REPLICATES],
) {
    dispatch!(isa, means_of [W](
        grid: &GridTables, coefficients: &[[f64; REPLICATES]],
        shape_index: &mut [f64; REPLICATES], curvedness: &mut [f64; REPLICATES]));
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::super::shape_maps::shape_maps_twin;
    use super::*;

    fn value(a: usize, b: usize) -> f64 {
        ((a * 17 + b * 5) as f64 * 0.37).sin()
    }

    /// Two runs in y and two first functions in x; more points than a batch holds.
    fn grid(width: usize) -> (GridTables, Vec<f64>) {
        let offsets: Vec<f64> = (0..13).map(|j| -0.6 + 0.1 * j as f64).collect();
        let taylor = [3, 4].map(|seed| (0..width * width).map(|k| value(k, seed)).collect::<Vec<f64>>());
        let runs = [(5, 0, &taylor[0][..]), (8, 1, &taylor[1][..])];
        let y = RowPieces::new(width - 1, width + 1, runs.into_iter(), &offsets);
        let first_x = (0..9).map(|i| i / 5).collect();
        let x = [0, 1, 2].map(|d| (0..9 * width).map(|k| value(k, 40 + d)).collect());
        (GridTables { first_x, x, y }, offsets)
    }

    /// Twin: every derivative as a double sum, the textbook's shape operator, the mean.
    #[test]
    fn means_of_every_isa_agree_with_the_written_sums() {
        for width in [3, 4, 5] {
            let (grid, offsets) = grid(width);
            let coefficients: Vec<[f64; REPLICATES]> =
                (0..(width + 1) * (width + 1)).map(|k| std::array::from_fn(|l| value(k, 90 + l))).collect();
            let mean_of = |l: usize| {
                let mut derivatives: [Vec<f64>; 5] = Default::default();
                for i in 0..9 {
                    for (j, t) in offsets.iter().enumerate() {
                        let run = usize::from(j >= 5);
                        let at = |d: usize, e: usize| -> f64 {
                            let mut sum = 0.0;
                            for (a, k, v) in (0..width * width * width)
                                .map(|n| (n / (width * width), n / width % width, n % width))
                                .filter(|(_, k, _)| *k >= e)
                            {
                                let falling: f64 = (0..e).map(|m| (k - m) as f64).product();
                                let basis = grid.x[d][i * width + a];
                                let taylor = grid.y.taylor[(k * width + v) * grid.y.padded + run];
                                let c = coefficients[(grid.first_x[i] + a) * (width + 1) + run + v][l];
                                sum += basis * falling * t.powi((k - e) as i32) * taylor * c;
                            }
                            sum
                        };
                        let all = [at(1, 0), at(0, 1), at(2, 0), at(1, 1), at(0, 2)];
                        derivatives.iter_mut().zip(all).for_each(|(column, value)| column.push(value));
                    }
                }
                let (mut s, mut r) = ([0.0; 117], [0.0; 117]);
                shape_maps_twin(derivatives.each_ref().map(|d| &d[..]), &mut s, &mut r);
                [s.iter().sum::<f64>() / 117.0, r.iter().sum::<f64>() / 117.0]
            };
            for isa in Isa::available() {
                let (mut s, mut r) = ([0.0; REPLICATES], [0.0; REPLICATES]);
                assert!(mean_shapes(isa, [width - 1; 2], &grid, &coefficients, &mut s, &mut r));
                let [mut twins_s, mut twins_r] = ["mean_shapes S", "mean_shapes R"].map(|name| Twins::new(name, isa));
                for l in 0..REPLICATES {
                    let [mean_s, mean_r] = mean_of(l);
                    twins_s.compare(s[l], mean_s);
                    twins_r.compare(r[l], mean_r);
                }
                twins_s.hold(64.0);
                twins_r.hold(64.0);
            }
        }
    }

    #[test]
    fn flat_points_are_left_out_of_the_mean_of_s() {
        let (grid, _) = grid(3);
        for isa in Isa::available() {
            let (mut s, mut r) = ([0.0; REPLICATES], [0.0; REPLICATES]);
            assert!(mean_shapes(isa, [2, 2], &grid, &[[0.0; REPLICATES]; 16], &mut s, &mut r));
            assert!(s.iter().all(|s| s.is_nan()) && r == [0.0; REPLICATES], "{}", isa.name());
        }
    }

    /// Twin: the written sum.
    #[test]
    fn draws_of_every_isa_agree_with_the_written_sum() {
        let weights: Vec<[f64; 3]> = (0..7).map(|i| std::array::from_fn(|k| value(i, k))).collect();
        let gaussians: [[f64; REPLICATES]; 3] = std::array::from_fn(|k| std::array::from_fn(|l| value(l, k + 9)));
        for isa in Isa::available() {
            let mut coefficients = [[0.25; REPLICATES]; 7];
            add_draws(isa, &weights, &gaussians, &mut coefficients);
            let mut twins = Twins::new("add_draws", isa);
            for (c, w) in coefficients.iter().zip(&weights) {
                for l in 0..REPLICATES {
                    twins.compare(c[l], 0.25 + (0..3).map(|k| w[k] * gaussians[k][l]).sum::<f64>());
                }
            }
            twins.hold(64.0);
        }
    }
}
