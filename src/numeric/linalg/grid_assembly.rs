//! The normal matrix of a grid whose weights differ from pixel to pixel, by sums over the pixels of each row.
//!
//! ```text
//! G = sum_j wz_ij^2 M M'      G_x = sum_j wx_ij^2 M M'      G_y = sum_j wy_ij^2 M' M''        row i within a cell, wx, wy not coupled
//! A_(a.)(k.) = sum_i N_a N_k (G + G_y) + N'_a N'_k G_x
//! ```

use std::ops::Range;

use super::grid_axis::GridAxis;
use super::stencil::StencilMatrix;

/// Products of two basis values in y, at every pixel: those of (b, l <= b), row by row.
struct Products {
    count: usize,
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl Products {
    fn new(y: GridAxis) -> Products {
        let mut products = Products { count: y.width * (y.width + 1) / 2, values: Vec::new(), slopes: Vec::new() };
        for j in 0..y.first.len() {
            let [values, slopes] = y.rows(j);
            for b in 0..y.width {
                products.values.extend((0..=b).map(|l| values[b] * values[l]));
                products.slopes.extend((0..=b).map(|l| slopes[b] * slopes[l]));
            }
        }
        products
    }

    /// Adds the weighted products of the pixels `run`: of values under wz^2 and wy^2's slopes, of values under wx^2.
    fn add<const N: usize>(&self, run: Range<usize>, squares: impl Fn(usize) -> [f64; 3], sums: &mut [Vec<f64>; 2]) {
        let (mut heights, mut along) = ([0.0; N], [0.0; N]);
        let of = |table: &[f64], j: usize| std::array::from_fn::<f64, N, _>(|u| table[j * N + u]);
        for j in run {
            let [z, x, y] = squares(j);
            let (value, slope) = (of(&self.values, j), of(&self.slopes, j));
            for u in 0..N {
                heights[u] += z * value[u] + y * slope[u];
                along[u] += x * value[u];
            }
        }
        sums[0].copy_from_slice(&heights);
        sums[1].copy_from_slice(&along);
    }

    fn add_any(&self, run: Range<usize>, squares: impl Fn(usize) -> [f64; 3], sums: &mut [Vec<f64>; 2]) {
        sums.iter_mut().for_each(|sums| sums.fill(0.0));
        for j in run {
            let [z, x, y] = squares(j);
            let at = j * self.count..(j + 1) * self.count;
            for (u, (value, slope)) in self.values[at.clone()].iter().zip(&self.slopes[at]).enumerate() {
                sums[0][u] += z * value + y * slope;
                sums[1][u] += x * value;
            }
        }
    }
}

/// Adds `E'E` to `out`; `squares(site)` are the squared weights of heights, x slopes and y slopes.
pub(super) fn assemble_grid(axes: [GridAxis; 2], squares: impl Fn(usize) -> [f64; 3], out: &mut StencilMatrix) {
    let [x, y] = axes;
    let (products, pixels) = (Products::new(y), y.first.len());
    let mut sums = [vec![0.0; products.count], vec![0.0; products.count]];
    let mut blocks = vec![0.0; x.width * (x.width + 1) / 2 * products.count];
    for x_run in x.runs {
        for y_run in y.runs {
            blocks.fill(0.0);
            for i in x_run.clone() {
                let of = |j: usize| squares(i * pixels + j);
                match products.count {
                    6 => products.add::<6>(y_run.clone(), of, &mut sums),
                    10 => products.add::<10>(y_run.clone(), of, &mut sums),
                    15 => products.add::<15>(y_run.clone(), of, &mut sums),
                    _ => products.add_any(y_run.clone(), of, &mut sums),
                }
                add_row(x, i, &sums, &mut blocks);
            }
            scatter([x.width, y.width], [x.first[x_run.start], y.first[y_run.start]], &blocks, out);
        }
    }
}

/// Adds the sums of one row of pixels to the blocks of all pairs (a, k <= a) in x.
fn add_row(x: GridAxis, i: usize, [heights, along]: &[Vec<f64>; 2], blocks: &mut [f64]) {
    let [n, dn] = x.rows(i);
    let mut blocks = blocks.chunks_exact_mut(heights.len());
    for a in 0..x.width {
        for (k, block) in (0..=a).zip(&mut blocks) {
            let (value, slope) = (n[a] * n[k], dn[a] * dn[k]);
            for ((entry, h), s) in block.iter_mut().zip(heights).zip(along) {
                *entry += value * h + slope * s;
            }
        }
    }
}

/// Adds the blocks of one cell, which are symmetric in y, to the matrix.
fn scatter(width: [usize; 2], first: [usize; 2], blocks: &[f64], out: &mut StencilMatrix) {
    let (columns, q) = (out.shape().basis[1], width[1] - 1);
    let pair = |b: usize, l: usize| b.max(l) * (b.max(l) + 1) / 2 + b.min(l);
    let mut blocks = blocks.chunks_exact(width[1] * (width[1] + 1) / 2);
    for a in 0..width[0] {
        for (k, block) in (0..=a).zip(&mut blocks) {
            for b in 0..width[1] {
                let row = (first[0] + a) * columns + first[1] + b;
                for l in (0..width[1]).filter(|&l| a > k || l <= b) {
                    let position = out.position(row, a - k, l + q - b);
                    out.values_mut()[position] += block[pair(b, l)];
                }
            }
        }
    }
}
