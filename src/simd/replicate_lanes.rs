//! Many replicates of one small fit at once, one a lane: coefficients from draws, S and R means from coefficients.
//!
//! ```text
//! c_i += sum_k P[i][k] n_k           S_g, R_g from c at every grid point g           mean over g, replicate by replicate
//! ```
//!
//! No lane ever meets another, so a replicate's bits do not depend on its neighbours.

use super::lanes::Lanes;
use super::shape_maps::ShapeBatch;
use super::{Level, dispatch};

/// Numbers of which S and R are under way at once: 32 points of eight lanes.
const BATCH: usize = 256;

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
            // NaN compares with nothing: a flat point is left out of the mean of S
            let defined = V::splat(-2.0).less(s);
            self.shape_index = self.shape_index + V::select(defined, s, zero);
            self.defined = self.defined + V::select(defined, V::splat(1.0), zero);
        }
    }
}

/// `sums[d][b] = sum_a N_a^(d)(x_i) c[first_x + a][first_y + b]` of the lanes from `l` on.
#[inline(always)]
fn curves_of<V: Lanes, const P: usize, const Q: usize>(
    grid: &GridTables,
    i: usize,
    first_y: usize,
    coefficients: &[[f64; LANES]],
    l: usize,
) -> [[V; Q]; 3] {
    let mut curves = [[V::splat(0.0); Q]; 3];
    for a in 0..P {
        let line = &coefficients[(grid.first_x[i] + a) * grid.columns + first_y..][..Q];
        for d in 0..3 {
            let weight = V::splat(grid.x[d][i * P + a]);
            for b in 0..Q {
                curves[d][b] = weight.mul_add(V::load(&line[b][l..]), curves[d][b]);
            }
        }
    }
    curves
}

#[inline(always)]
fn means_of<V: Lanes, const P: usize, const Q: usize>(
    grid: &GridTables,
    coefficients: &[[f64; LANES]],
    shape_index: &mut [f64; LANES],
    curvedness: &mut [f64; LANES],
) {
    let zero = V::splat(0.0);
    let mut batch = ShapeBatch::<BATCH>::new();
    for l in (0..LANES).step_by(V::N) {
        let mut sums = Sums { shape_index: zero, defined: zero, curvedness: zero };
        let mut waiting = 0;
        for i in 0..grid.first_x.len() {
            let mut held = usize::MAX;
            let mut curves = [[zero; Q]; 3];
            for (j, &first_y) in grid.first_y.iter().enumerate() {
                if first_y != held {
                    held = first_y;
                    curves = curves_of::<V, P, Q>(grid, i, first_y, coefficients, l);
                }
                let along = |d: usize, e: usize| {
                    let values = &grid.y[e][j * Q..][..Q];
                    let mut sum = zero;
                    for b in 0..Q {
                        sum = V::splat(values[b]).mul_add(curves[d][b], sum);
                    }
                    sum
                };
                batch.put(waiting * V::N, [along(1, 0), along(0, 1), along(2, 0), along(1, 1), along(0, 2)]);
                waiting += 1;
                if waiting * V::N == BATCH {
                    sums.add(&mut batch, waiting);
                    waiting = 0;
                }
            }
        }
        sums.add(&mut batch, waiting);
        sums.shape_index.div(sums.defined).store(&mut shape_index[l..]);
        let points = (grid.first_x.len() * grid.first_y.len()) as f64;
        sums.curvedness.div(V::splat(points)).store(&mut curvedness[l..]);
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
