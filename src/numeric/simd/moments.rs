//! Moments of the contacts of one knot cell: of their weights (G) and of their weighted measurements (F).
//!
//! ```text
//! G[a][b] = sum_r w_r u_r^a v_r^b,   a <= 2p, b <= 2q          F_t[a][b] = sum_r f_t,r u_r^a v_r^b,   a <= p, b <= q
//! ```
//!
//! with `u, v` in [-1, 1] across the cell. Products of two basis functions are polynomials of degree 2p on a cell, so
//! the (p+1)^2 (q+1)^2 sums of the normal matrix are linear in these moments: seven eight-lane operations a contact
//! for a bicubic instead of the 26 that the unique products take. Centred powers up to the sixth lose at most a few
//! units in the last place of the largest entry (a test in `observation::cells` compares with the sum over rows).
//! Beyond degree 3 the sum over rows is used instead.

use super::lanes::Lanes;
use super::{Isa, dispatch};

/// Largest degree per direction whose squares fit the eight lanes: 2 * 3 + 1 = 7.
pub const MAX_MOMENT_DEGREE: usize = 3;

/// What [`moments`] adds to: `weights[a][b]` is G, `loads[t][a][b]` is F_t. Entries beyond the degrees have no meaning.
#[derive(Clone, Debug, PartialEq)]
pub struct CellMoments {
    /// G.
    pub weights: [[f64; 8]; 7],
    /// F_z, F_x, F_y.
    pub loads: [[[f64; 8]; 4]; 3],
}

impl CellMoments {
    /// No contacts yet.
    pub const ZERO: CellMoments = CellMoments { weights: [[0.0; 8]; 7], loads: [[[0.0; 8]; 4]; 3] };
}

/// Contacts taken at once: their powers stay in the first-level cache, and every sum reads its factor from there.
const BATCH: usize = 64;

/// Powers of up to 64 contacts, one column for each power: the working memory of [`moments`].
#[derive(Debug)]
pub struct MomentPowers {
    count: usize,
    /// `w u^k`, k up to 2p.
    weighted: [[f64; BATCH]; 7],
    /// u, u^2, u^3.
    u: [[f64; BATCH]; 3],
    /// v, v^2, v^4.
    v: [[f64; BATCH]; 3],
}

impl Default for MomentPowers {
    fn default() -> MomentPowers {
        MomentPowers { count: 0, weighted: [[0.0; BATCH]; 7], u: [[0.0; BATCH]; 3], v: [[0.0; BATCH]; 3] }
    }
}

impl MomentPowers {
    #[inline(always)]
    fn fill<V: Lanes>(&mut self, degree: usize, [u, v]: [&[f64]; 2], weight: Option<&[f64]>) {
        self.count = u.len();
        self.u[0][..u.len()].copy_from_slice(u);
        self.v[0][..u.len()].copy_from_slice(&v[..u.len()]);
        match weight {
            Some(weight) => self.weighted[0][..u.len()].copy_from_slice(&weight[..u.len()]),
            None => self.weighted[0][..u.len()].fill(1.0),
        }
        for r in (0..u.len()).step_by(V::N) {
            let (x, y) = (V::load(&self.u[0][r..]), V::load(&self.v[0][r..]));
            (x * x).store(&mut self.u[1][r..]);
            (x * x * x).store(&mut self.u[2][r..]);
            (y * y).store(&mut self.v[1][r..]);
            (y * y * (y * y)).store(&mut self.v[2][r..]);
            let mut power = V::load(&self.weighted[0][r..]);
            for k in 1..=2 * degree {
                power = power * x;
                power.store(&mut self.weighted[k][r..]);
            }
        }
    }

    /// `[1, v, v^2, .., v^7]` of contact r, by the bits of the exponent, in `8 / N` sets of lanes.
    #[inline(always)]
    fn row<V: Lanes>(&self, r: usize, bits: &[[V::Mask; 2]; 2]) -> [V; 2] {
        let one = V::splat(1.0);
        let low = self.low_row::<V>(r, bits);
        let fourth = V::splat(self.v[2][r]);
        if V::N == 8 { [low * V::select(bits[1][0], fourth, one), one] } else { [low, low * fourth] }
    }

    /// `[1, v, v^2, v^3]` of contact r, repeated to fill the lanes.
    #[inline(always)]
    fn low_row<V: Lanes>(&self, r: usize, bits: &[[V::Mask; 2]; 2]) -> V {
        let one = V::splat(1.0);
        V::select(bits[0][0], V::splat(self.v[0][r]), one) * V::select(bits[0][1], V::splat(self.v[1][r]), one)
    }
}

/// Masks of the lanes whose number has bit 0, 1 and 2 set.
#[inline(always)]
fn exponent_bits<V: Lanes>() -> [[V::Mask; 2]; 2] {
    let lanes_with = |bit: usize| {
        let marks: [f64; 8] = std::array::from_fn(|l| if l >> bit & 1 == 1 { -1.0 } else { 1.0 });
        V::load(&marks).less(V::splat(0.0))
    };
    [[lanes_with(0), lanes_with(1)], [lanes_with(2), lanes_with(2)]]
}

#[inline(always)]
fn add_weights<V: Lanes>(degree: usize, batch: &MomentPowers, out: &mut [[f64; 8]; 7]) {
    let sets = 8 / V::N;
    let bits = exponent_bits::<V>();
    let mut sums = [[V::splat(0.0); 2]; 7];
    for r in 0..batch.count {
        let row = batch.row::<V>(r, &bits);
        for (sum, power) in sums[..=2 * degree].iter_mut().zip(&batch.weighted) {
            for k in 0..sets {
                sum[k] = V::splat(power[r]).mul_add(row[k], sum[k]);
            }
        }
    }
    for (sum, target) in sums[..=2 * degree].iter().zip(out.iter_mut()) {
        for k in 0..sets {
            (V::load(&target[k * V::N..]) + sum[k]).store(&mut target[k * V::N..]);
        }
    }
}

#[inline(always)]
fn add_loads<V: Lanes>(degree: usize, batch: &MomentPowers, data: [&[f64]; 3], out: &mut [[[f64; 8]; 4]; 3]) {
    if V::N == 8 {
        add_loads_by_eights::<V>(degree, batch, data, out);
        return;
    }
    let bits = exponent_bits::<V>();
    let mut sums = [[V::splat(0.0); 4]; 3];
    for r in 0..batch.count {
        let low = batch.low_row::<V>(r, &bits);
        for (sum, f) in sums.iter_mut().zip(data) {
            let term = V::splat(f[r]) * low;
            sum[0] = sum[0] + term;
            for (power, u) in sum[1..=degree].iter_mut().zip(&batch.u) {
                *power = V::splat(u[r]).mul_add(term, *power);
            }
        }
    }
    for (sum, target) in sums.iter().zip(out.iter_mut()) {
        for (power, place) in sum[..=degree].iter().zip(target.iter_mut()) {
            (V::load(place) + *power).store(place);
        }
    }
}

/// Eight lanes hold the four powers of v twice: one half sums F_z and the other F_x; for F_y one half belongs to u^a and
/// the other to u^(a+1).
#[inline(always)]
fn add_loads_by_eights<V: Lanes>(degree: usize, batch: &MomentPowers, data: [&[f64]; 3], out: &mut [[[f64; 8]; 4]; 3]) {
    let bits = exponent_bits::<V>();
    let upper = bits[1][0];
    let zero = V::splat(0.0);
    let (mut both, mut last) = ([zero; 4], [zero; 2]);
    for r in 0..batch.count {
        let low = batch.low_row::<V>(r, &bits);
        let term = V::select(upper, V::splat(data[1][r]), V::splat(data[0][r])) * low;
        both[0] = both[0] + term;
        for (power, u) in both[1..=degree].iter_mut().zip(&batch.u) {
            *power = V::splat(u[r]).mul_add(term, *power);
        }
        let term = V::select(upper, V::splat(batch.u[0][r]), V::splat(1.0)) * (V::splat(data[2][r]) * low);
        last[0] = last[0] + term;
        last[1] = V::splat(batch.u[1][r]).mul_add(term, last[1]);
    }
    let mut lanes = [0.0; 8];
    let mut add = |lanes: &[f64], t: usize, a: usize| {
        out[t][a].iter_mut().zip(lanes).for_each(|(o, l)| *o += l);
    };
    for a in 0..=degree {
        both[a].store(&mut lanes);
        add(&lanes[..4], 0, a);
        add(&lanes[4..], 1, a);
    }
    for half in 0..=degree / 2 {
        last[half].store(&mut lanes);
        add(&lanes[..4], 2, 2 * half);
        add(&lanes[4..], 2, 2 * half + 1);
    }
}

#[inline(always)]
fn generic<V: Lanes>(
    degree: usize,
    local: [&[f64]; 2],
    weight: Option<&[f64]>,
    data: Option<[&[f64]; 3]>,
    batch: &mut MomentPowers,
    out: &mut CellMoments,
) {
    let n = local[0].len();
    for from in (0..n).step_by(BATCH) {
        let range = from..n.min(from + BATCH);
        let local = local.map(|c| &c[range.clone()]);
        let weight = weight.map(|w| &w[range.clone()]);
        let data = data.map(|d| d.map(|f| &f[range.clone()]));
        // the degree is a literal, so that the sums stay in registers
        match degree {
            1 => add_batch::<V>(1, batch, local, weight, data, out),
            2 => add_batch::<V>(2, batch, local, weight, data, out),
            _ => add_batch::<V>(3, batch, local, weight, data, out),
        }
    }
}

#[inline(always)]
fn add_batch<V: Lanes>(
    degree: usize,
    batch: &mut MomentPowers,
    local: [&[f64]; 2],
    weight: Option<&[f64]>,
    data: Option<[&[f64]; 3]>,
    out: &mut CellMoments,
) {
    batch.fill::<V>(degree, local, weight);
    add_weights::<V>(degree, batch, &mut out.weights);
    if let Some(data) = data {
        add_loads::<V>(degree, batch, data, &mut out.loads);
    }
}

/// Adds the contacts at `local = [u, v]` to `out`: G with `weight` (`None`: ones), and F with `data = [f_z, f_x, f_y]`.
///
/// `degree` is p, at most [`MAX_MOMENT_DEGREE`]; q may be anything up to it. Contacts are added in their order, so
/// the bits do not depend on the number of threads.
///
/// # Panics
/// When an array is shorter than u.
pub fn moments(
    isa: Isa,
    degree: usize,
    local: [&[f64]; 2],
    weight: Option<&[f64]>,
    data: Option<[&[f64]; 3]>,
    powers: &mut MomentPowers,
    out: &mut CellMoments,
) {
    assert!((1..=MAX_MOMENT_DEGREE).contains(&degree), "moments are made for degrees 1 to {MAX_MOMENT_DEGREE}");
    dispatch!(isa, generic [](
        degree: usize, local: [&[f64]; 2], weight: Option<&[f64]>, data: Option<[&[f64]; 3]>,
        powers: &mut MomentPowers, out: &mut CellMoments));
}

/// The safe twin: powers by `powi`, one moment at a time.
#[cfg(test)]
fn moments_twin(
    degree: usize,
    local: [&[f64]; 2],
    weight: Option<&[f64]>,
    data: Option<[&[f64]; 3]>,
    out: &mut CellMoments,
) {
    for r in 0..local[0].len() {
        let power = |a: usize, b: usize| local[0][r].powi(a as i32) * local[1][r].powi(b as i32);
        for a in 0..=2 * degree {
            for b in 0..7 {
                out.weights[a][b] += weight.map_or(1.0, |w| w[r]) * power(a, b);
            }
        }
        for (target, f) in out.loads.iter_mut().zip(data.iter().flatten()) {
            for a in 0..=degree {
                for b in 0..4 {
                    target[a][b] += f[r] * power(a, b);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::*;

    #[test]
    fn every_isa_agrees_with_its_twin() {
        let column = |seed: f64| -> Vec<f64> { (0..53).map(|r| ((r as f64 + seed) * 12.9898).sin()).collect() };
        let (u, v, w) = (column(0.1), column(0.7), column(3.0));
        let f = [column(1.0), column(2.0), column(5.0)];
        let data = f.each_ref().map(|c| &c[..]);
        for degree in 1..=MAX_MOMENT_DEGREE {
            for weight in [None, Some(&w[..])] {
                let mut expected = CellMoments::ZERO;
                moments_twin(degree, [&u, &v], weight, Some(data), &mut expected);
                for isa in Isa::available() {
                    let mut made = CellMoments::ZERO;
                    moments(isa, degree, [&u, &v], weight, Some(data), &mut MomentPowers::default(), &mut made);
                    let mut twins = Twins::new("moments", isa);
                    for a in 0..=2 * degree {
                        for b in 0..7 {
                            twins.compare(made.weights[a][b], expected.weights[a][b]);
                        }
                    }
                    for t in 0..3 {
                        for a in 0..=degree {
                            for b in 0..4 {
                                twins.compare(made.loads[t][a][b], expected.loads[t][a][b]);
                            }
                        }
                    }
                    twins.hold(64.0);
                }
            }
        }
    }
}
