//! Rows of the sites of one knot cell, on which the surface is one polynomial of the local coordinates in [-1, 1].
//!
//! ```text
//! S = sum_ij s_ij u^i v^j      S_x = S_u / h_x      S_y = S_v / h_y            i, j <= 3
//! r = b - [ z S,  a S_x + b S_y,  d S_y ]
//! G_ij = sum_r  z r_0 u^i v^j + a r_1 i u^(i-1) v^j / h_x + (b r_1 + d r_2) u^i j v^(j-1) / h_y
//! ```
//!
//! With the polynomial's 16 coefficients in place of the values of basis functions a site needs two numbers instead of
//! sixteen, and `E'r` of a whole cell comes out as the 16 numbers G, which are multiplied by the basis functions' own
//! coefficients once for the cell.

use super::cell_sites::{SITES, SiteLanes};
use super::lanes::Lanes;
use super::{Isa, dispatch};

/// Coefficients `[i][j]` of `u^i v^j`.
pub type CellPowers = [[f64; 4]; 4];

/// The sites of one cell in groups of eight.
#[derive(Clone, Copy, Debug)]
pub struct CellPiece<'a> {
    /// The surface.
    pub surface: &'a CellPowers,
    /// 1 / h_x, 1 / h_y.
    pub inverse_half: [f64; 2],
    /// u and v.
    pub places: [&'a [SiteLanes]; 2],
    /// b, three for each site; `None` stands for zeros.
    pub targets: Option<[&'a [SiteLanes]; 3]>,
    /// z, a, b, d of every group, or of one group if all are alike.
    pub weights: &'a [[SiteLanes; 4]],
    /// Weights of the last group, zero in lanes without a site.
    pub last: &'a [SiteLanes; 4],
}

impl<'a> CellPiece<'a> {
    #[inline(always)]
    fn weights_of(&self, k: usize) -> &'a [SiteLanes; 4] {
        if k + 1 == self.places[0].len() { self.last } else { &self.weights[k.min(self.weights.len() - 1)] }
    }
}

/// S, S_x and S_y.
#[inline(always)]
fn values_at<V: Lanes>(surface: &CellPowers, slopes: &[[f64; 3]; 4], inverse_half: [f64; 2], [u, v]: [V; 2]) -> [V; 3] {
    let (mut p, mut d) = ([V::splat(0.0); 4], [V::splat(0.0); 4]);
    for i in 0..4 {
        let s = &surface[i];
        let high = V::splat(s[3]).mul_add(v, V::splat(s[2]));
        p[i] = high.mul_add(v, V::splat(s[1])).mul_add(v, V::splat(s[0]));
        let s = &slopes[i];
        d[i] = V::splat(s[2]).mul_add(v, V::splat(s[1])).mul_add(v, V::splat(s[0]));
    }
    let value = p[3].mul_add(u, p[2]).mul_add(u, p[1]).mul_add(u, p[0]);
    let along = (V::splat(3.0) * p[3]).mul_add(u, V::splat(2.0) * p[2]).mul_add(u, p[1]);
    let across = d[3].mul_add(u, d[2]).mul_add(u, d[1]).mul_add(u, d[0]);
    [value, along * V::splat(inverse_half[0]), across * V::splat(inverse_half[1])]
}

/// Targets less the weighted rows, and the weights.
#[inline(always)]
fn residuals<V: Lanes>(piece: &CellPiece, slopes: &[[f64; 3]; 4], k: usize, lanes: usize) -> ([V; 3], [V; 4]) {
    let place = [V::load(&piece.places[0][k][lanes..]), V::load(&piece.places[1][k][lanes..])];
    let [value, sx, sy] = values_at(piece.surface, slopes, piece.inverse_half, place);
    let w = piece.weights_of(k);
    let (wz, wa) = (V::load(&w[0][lanes..]), V::load(&w[1][lanes..]));
    let (wb, wd) = (V::load(&w[2][lanes..]), V::load(&w[3][lanes..]));
    let mut target = [V::splat(0.0); 3];
    if let Some(targets) = &piece.targets {
        for t in 0..3 {
            target[t] = V::load(&targets[t][k][lanes..]);
        }
    }
    let first = wz.neg_mul_add(value, target[0]);
    let second = wb.neg_mul_add(sy, wa.neg_mul_add(sx, target[1]));
    ([first, second, wd.neg_mul_add(sy, target[2])], [wz, wa, wb, wd])
}

/// `i s_i` of the powers of v.
#[inline(always)]
fn slopes_of(surface: &CellPowers) -> [[f64; 3]; 4] {
    let mut slopes = [[0.0; 3]; 4];
    for i in 0..4 {
        slopes[i] = [surface[i][1], 2.0 * surface[i][2], 3.0 * surface[i][3]];
    }
    slopes
}

#[inline(always)]
fn products<V: Lanes>(piece: &CellPiece, out: &mut CellPowers) {
    let slopes = slopes_of(piece.surface);
    let mut sums = [[V::splat(0.0); 4]; 4];
    for k in 0..piece.places[0].len() {
        for lanes in (0..SITES).step_by(V::N) {
            let (r, [wz, wa, wb, wd]) = residuals::<V>(piece, &slopes, k, lanes);
            let (u, v) = (V::load(&piece.places[0][k][lanes..]), V::load(&piece.places[1][k][lanes..]));
            let f = wz * r[0];
            let fx = wa * r[1] * V::splat(piece.inverse_half[0]);
            let fy = wb.mul_add(r[1], wd * r[2]) * V::splat(piece.inverse_half[1]);
            let (uu, vv) = (u * u, v * v);
            let powers = [f, f.mul_add(u, fx), f.mul_add(u, fx + fx) * u, f.mul_add(u, V::splat(3.0) * fx) * uu];
            let across = [fy, fy * u, fy * uu, fy * (uu * u)];
            let (v2, v3, vvv) = (v + v, V::splat(3.0) * vv, vv * v);
            for i in 0..4 {
                sums[i][0] = sums[i][0] + powers[i];
                sums[i][1] = powers[i].mul_add(v, sums[i][1] + across[i]);
                sums[i][2] = powers[i].mul_add(vv, across[i].mul_add(v2, sums[i][2]));
                sums[i][3] = powers[i].mul_add(vvv, across[i].mul_add(v3, sums[i][3]));
            }
        }
    }
    for i in 0..4 {
        for j in 0..4 {
            out[i][j] = sums[i][j].sum();
        }
    }
}

#[inline(always)]
fn squares<V: Lanes>(piece: &CellPiece, out: &mut [f64; 2]) {
    let slopes = slopes_of(piece.surface);
    let mut sums = [V::splat(0.0); 2];
    for k in 0..piece.places[0].len() {
        for lanes in (0..SITES).step_by(V::N) {
            let (r, _) = residuals::<V>(piece, &slopes, k, lanes);
            sums[0] = r[0].mul_add(r[0], sums[0]);
            sums[1] = r[2].mul_add(r[2], r[1].mul_add(r[1], sums[1]));
        }
    }
    for block in 0..2 {
        out[block] += sums[block].sum();
    }
}

#[inline(always)]
fn values<V: Lanes>(
    surface: &CellPowers,
    inverse_half: [f64; 2],
    places: [&[SiteLanes]; 2],
    out: &mut [[SiteLanes; 3]],
) {
    let slopes = slopes_of(surface);
    for k in 0..out.len() {
        for lanes in (0..SITES).step_by(V::N) {
            let place = [V::load(&places[0][k][lanes..]), V::load(&places[1][k][lanes..])];
            let [s, sx, sy] = values_at(surface, &slopes, inverse_half, place);
            s.store(&mut out[k][0][lanes..]);
            sx.store(&mut out[k][1][lanes..]);
            sy.store(&mut out[k][2][lanes..]);
        }
    }
}

#[inline(always)]
fn basis<V: Lanes>(
    functions: &[[f64; 8]],
    inverse_half: f64,
    u: &SiteLanes,
    values: &mut [SiteLanes],
    slopes: &mut [SiteLanes],
) {
    for ((powers, value), slope) in functions.iter().zip(values).zip(slopes) {
        let [c0, c1, c2, c3, ..] = *powers;
        for lanes in (0..SITES).step_by(V::N) {
            let u = V::load(&u[lanes..]);
            let high = V::splat(c3).mul_add(u, V::splat(c2));
            high.mul_add(u, V::splat(c1)).mul_add(u, V::splat(c0)).store(&mut value[lanes..]);
            let high = V::splat(3.0 * c3).mul_add(u, V::splat(2.0 * c2));
            (high.mul_add(u, V::splat(c1)) * V::splat(inverse_half)).store(&mut slope[lanes..]);
        }
    }
}

/// Basis functions of degree at most 3, given by their powers of u, and their slopes at eight places.
pub fn cell_basis(
    isa: Isa,
    functions: &[[f64; 8]],
    inverse_half: f64,
    u: &SiteLanes,
    values: &mut [SiteLanes],
    slopes: &mut [SiteLanes],
) {
    dispatch!(isa, basis [](
        functions: &[[f64; 8]],
        inverse_half: f64,
        u: &SiteLanes,
        values: &mut [SiteLanes],
        slopes: &mut [SiteLanes],
    ));
}

/// `out = [S, S_x, S_y]` at the local coordinates `places` in u and v, group by group.
pub fn cell_values(
    isa: Isa,
    surface: &CellPowers,
    inverse_half: [f64; 2],
    places: [&[SiteLanes]; 2],
    out: &mut [[SiteLanes; 3]],
) {
    dispatch!(isa, values [](
        surface: &CellPowers,
        inverse_half: [f64; 2],
        places: [&[SiteLanes]; 2],
        out: &mut [[SiteLanes; 3]],
    ));
}

/// `out = G`.
pub fn cell_products(isa: Isa, piece: &CellPiece, out: &mut CellPowers) {
    dispatch!(isa, products [](piece: &CellPiece<'_>, out: &mut CellPowers));
}

/// Adds `r_0^2` and `r_1^2 + r_2^2`.
pub fn cell_squares(isa: Isa, piece: &CellPiece, out: &mut [f64; 2]) {
    dispatch!(isa, squares [](piece: &CellPiece<'_>, out: &mut [f64; 2]));
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::*;

    fn lanes(seed: usize) -> Vec<SiteLanes> {
        (0..3).map(|k| std::array::from_fn(|l| ((seed * 29 + k * 8 + l) as f64 * 0.73).sin())).collect()
    }

    /// Twin: powers and their derivatives by `powi`, one site at a time.
    #[test]
    fn every_isa_agrees_with_the_polynomial_written_out() {
        let surface: CellPowers = std::array::from_fn(|i| std::array::from_fn(|j| ((4 * i + j) as f64 * 0.9).cos()));
        let (u, v, targets) = (lanes(1), lanes(2), [lanes(3), lanes(4), lanes(5)]);
        let weights: Vec<[SiteLanes; 4]> = (0..3).map(|k| std::array::from_fn(|w| lanes(6 + w)[k])).collect();
        let mut last = weights[2];
        last.iter_mut().for_each(|w| w[5..].fill(0.0));
        let mut ends = targets.clone();
        ends.iter_mut().for_each(|t| t[2][5..].fill(0.0));
        let h = [1.7, 0.6];
        let piece = CellPiece {
            surface: &surface,
            inverse_half: h,
            places: [&u, &v],
            targets: Some([&ends[0], &ends[1], &ends[2]]),
            weights: &weights,
            last: &last,
        };
        let power = |x: f64, k: usize| x.powi(k as i32);
        let slope = |x: f64, k: usize| if k == 0 { 0.0 } else { k as f64 * x.powi(k as i32 - 1) };
        let (mut expected, mut sums) = ([[0.0; 4]; 4], [0.0; 2]);
        let mut values = Vec::new();
        for site in 0..21 {
            let (k, l) = (site / 8, site % 8);
            let terms = |f: &dyn Fn(f64, usize) -> f64, g: &dyn Fn(f64, usize) -> f64| -> CellPowers {
                std::array::from_fn(|i| std::array::from_fn(|j| f(u[k][l], i) * g(v[k][l], j)))
            };
            let [s, sx, sy] = [terms(&power, &power), terms(&slope, &power), terms(&power, &slope)];
            let of = |t: &CellPowers| (0..16).map(|n| surface[n / 4][n % 4] * t[n / 4][n % 4]).sum::<f64>();
            let [z, a, b, d] = weights[k].map(|w| w[l]);
            let (x, y) = (h[0] * of(&sx), h[1] * of(&sy));
            values.push([of(&s), x, y]);
            let r = [ends[0][k][l] - z * of(&s), ends[1][k][l] - a * x - b * y, ends[2][k][l] - d * y];
            sums[0] += r[0] * r[0];
            sums[1] += r[1] * r[1] + r[2] * r[2];
            for (i, j) in (0..16).map(|n| (n / 4, n % 4)) {
                expected[i][j] +=
                    z * r[0] * s[i][j] + h[0] * a * r[1] * sx[i][j] + h[1] * (b * r[1] + d * r[2]) * sy[i][j];
            }
        }
        for isa in Isa::available() {
            let (mut found, mut squares) = ([[0.0; 4]; 4], [0.0; 2]);
            cell_products(isa, &piece, &mut found);
            cell_squares(isa, &piece, &mut squares);
            let mut twins = Twins::new("cell_rows", isa);
            (0..16).for_each(|n| twins.compare(found[n / 4][n % 4], expected[n / 4][n % 4]));
            let mut at = [[[0.0; SITES]; 3]; 3];
            cell_values(isa, &surface, h, [&u, &v], &mut at);
            for (site, expected) in values.iter().enumerate() {
                (0..3).for_each(|t| twins.compare(at[site / 8][t][site % 8], expected[t]));
            }
            (0..2).for_each(|block| twins.compare(squares[block], sums[block]));
            let functions = [[0.3, -0.2, 0.7, 0.4, 0.0, 0.0, 0.0, 0.0], [1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]];
            let [mut values, mut slopes] = [[[0.0; SITES]; 2]; 2];
            cell_basis(isa, &functions, h[0], &u[1], &mut values, &mut slopes);
            for (n, l) in (0..2 * SITES).map(|n| (n / SITES, n % SITES)) {
                let sum =
                    |of: &dyn Fn(f64, usize) -> f64| (0..4).map(|i| functions[n][i] * of(u[1][l], i)).sum::<f64>();
                twins.compare(values[n][l], sum(&power));
                twins.compare(slopes[n][l], h[0] * sum(&slope));
            }
            twins.hold(16.0);
        }
    }
}
