//! Many replicates of one small fit at once, one a lane: coefficients from draws, S and R means from coefficients.
//!
//! ```text
//! c_i += sum_k P[i][k] n_k           S_g, R_g from c at every grid point g           mean over g, replicate by replicate
//! ```
//!
//! No lane ever meets another, so a replicate's bits do not depend on its neighbours.

use super::lanes::Lanes;
use super::shape_maps::shape_of;
use super::{Level, dispatch};

/// Replicates in a block.
pub const LANES: usize = 32;

/// Basis values along both axes of the shape grid, `(p + 1)` per point and derivative.
#[derive(Clone, Debug, Default)]
pub struct GridTables {
    /// First basis function of every x.
    pub first_x: Vec<usize>,
    /// `x[d][i (p + 1) + a]`: d-th derivatives.
    pub x: [Vec<f64>; 3],
    /// First basis function of every y.
    pub first_y: Vec<usize>,
    /// `y[d][j (q + 1) + b]`.
    pub y: [Vec<f64>; 3],
    /// Basis functions in y.
    pub columns: usize,
}

#[inline(always)]
fn draws<V: Lanes>(weights: &[[f64; 3]], normals: &[[f64; LANES]; 3], coefficients: &mut [[f64; LANES]]) {
    for l in (0..LANES).step_by(V::N) {
        let n = normals.each_ref().map(|row| V::load(&row[l..]));
        for (w, c) in weights.iter().zip(coefficients.iter_mut()) {
            let mut sum = V::load(&c[l..]);
            for k in 0..3 {
                sum = V::splat(w[k]).mul_add(n[k], sum);
            }
            sum.store(&mut c[l..]);
        }
    }
}

/// `coefficients[i] += sum_k weights[i][k] normals[k]`, lane by lane.
pub fn add_draws(level: Level, weights: &[[f64; 3]], normals: &[[f64; LANES]; 3], coefficients: &mut [[f64; LANES]]) {
    dispatch!(level, draws [](weights: &[[f64; 3]], normals: &[[f64; LANES]; 3], coefficients: &mut [[f64; LANES]]));
}

#[inline(always)]
fn means_of<V: Lanes, const P: usize, const Q: usize>(
    grid: &GridTables,
    coefficients: &[[f64; LANES]],
    shape_index: &mut [f64; LANES],
    curvedness: &mut [f64; LANES],
) {
    let zero = V::splat(0.0);
    for l in (0..LANES).step_by(V::N) {
        let (mut s_sum, mut s_count, mut r_sum) = (zero, zero, zero);
        for (i, &first_x) in grid.first_x.iter().enumerate() {
            let mut held = usize::MAX;
            let mut curves = [[zero; Q]; 3];
            for (j, &first_y) in grid.first_y.iter().enumerate() {
                if first_y != held {
                    held = first_y;
                    for b in 0..Q {
                        let mut sums = [zero; 3];
                        for a in 0..P {
                            let c = V::load(&coefficients[(first_x + a) * grid.columns + first_y + b][l..]);
                            for d in 0..3 {
                                sums[d] = V::splat(grid.x[d][i * P + a]).mul_add(c, sums[d]);
                            }
                        }
                        for d in 0..3 {
                            curves[d][b] = sums[d];
                        }
                    }
                }
                let along = |d: usize, e: usize| {
                    let mut sum = zero;
                    for b in 0..Q {
                        sum = V::splat(grid.y[e][j * Q + b]).mul_add(curves[d][b], sum);
                    }
                    sum
                };
                let (s, r) = shape_of([along(1, 0), along(0, 1), along(2, 0), along(1, 1), along(0, 2)]);
                // NaN compares with nothing: a flat point is left out of the mean of S
                let defined = V::splat(-2.0).less(s);
                s_sum = s_sum + V::select(defined, s, zero);
                s_count = s_count + V::select(defined, V::splat(1.0), zero);
                r_sum = r_sum + r;
            }
        }
        s_sum.div(s_count).store(&mut shape_index[l..]);
        let points = (grid.first_x.len() * grid.first_y.len()) as f64;
        r_sum.div(V::splat(points)).store(&mut curvedness[l..]);
    }
}

/// Mean S (over the points where it is defined; NaN where it is nowhere) and mean R of every lane's surface.
///
/// Both degrees are equal, 2 to 4; returns `false`, and does nothing, for others.
pub fn mean_shapes(
    level: Level,
    degree: [usize; 2],
    grid: &GridTables,
    coefficients: &[[f64; LANES]],
    shape_index: &mut [f64; LANES],
    curvedness: &mut [f64; LANES],
) -> bool {
    macro_rules! of_degree {
        ($($p:literal $q:literal),*) => {
            match (degree[0] + 1, degree[1] + 1) {
                $(($p, $q) => {
                    #[inline(always)]
                    fn fixed<V: Lanes>(
                        grid: &GridTables, coefficients: &[[f64; LANES]],
                        shape_index: &mut [f64; LANES], curvedness: &mut [f64; LANES],
                    ) {
                        means_of::<V, $p, $q>(grid, coefficients, shape_index, curvedness);
                    }
                    dispatch!(level, fixed [](grid: &GridTables, coefficients: &[[f64; LANES]],
                        shape_index: &mut [f64; LANES], curvedness: &mut [f64; LANES]));
                    true
                })*
                _ => false,
            }
        };
    }
    of_degree!(3 3, 4 4, 5 5)
}
