//! Weighted moments of the contacts of one knot cell, and of what they measured.
//!
//! ```text
//! G[a][b] = sum_r w_r u_r^a v_r^b,   a <= 2p, b <= 2q          F_t[a][b] = sum_r f_t,r u_r^a v_r^b,   a <= p, b <= q
//! ```
//!
//! with `u, v` in [-1, 1] across the cell. Products of two basis functions are polynomials of degree 2p on a cell, so
//! the (p+1)^2 (q+1)^2 sums of the normal matrix are linear in these moments: seven eight-lane operations a contact
//! for a bicubic instead of the 26 that the unique products take. Centred powers up to the sixth lose at most a few
//! units in the last place of the largest entry (held by the test in `linalg` against the rows themselves); beyond
//! degree 3 the rows themselves are used.

use super::lanes::Lanes;
use super::{Level, dispatch};

/// Largest degree per direction whose squares fit the eight lanes: 2 * 3 + 1 = 7.
pub const MAX_MOMENT_DEGREE: usize = 3;

/// What [`moments`] adds to: `weights[a][b]` is G, `loads[t][a][b]` is F_t. Entries beyond the degrees hold rubbish.
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

/// `[1, v, v^2, .., v^7]`, by the bits of the exponent, in `8 / N` sets of lanes.
#[inline(always)]
fn powers<V: Lanes>(v: f64, bits: &[[V::Mask; 2]; 2]) -> [V; 2] {
    let (one, square) = (V::splat(1.0), v * v);
    let low = V::select(bits[0][0], V::splat(v), one) * V::select(bits[0][1], V::splat(square), one);
    let fourth = V::splat(square * square);
    if V::N == 8 {
        let high = V::select(bits[1][0], fourth, one);
        [low * high, one]
    } else {
        [low, low * fourth]
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
fn add_weights<V: Lanes>(degree: usize, u: &[f64], v: &[f64], weight: Option<&[f64]>, out: &mut [[f64; 8]; 7]) {
    let sets = 8 / V::N;
    let bits = exponent_bits::<V>();
    let mut sums = [[V::splat(0.0); 2]; 7];
    for r in 0..u.len() {
        let row = powers::<V>(v[r], &bits);
        let mut factor = weight.map_or(1.0, |w| w[r]);
        for sum in sums[..=2 * degree].iter_mut() {
            for k in 0..sets {
                sum[k] = V::splat(factor).mul_add(row[k], sum[k]);
            }
            factor *= u[r];
        }
    }
    for (sum, target) in sums[..=2 * degree].iter().zip(out.iter_mut()) {
        for k in 0..sets {
            (V::load(&target[k * V::N..]) + sum[k]).store(&mut target[k * V::N..]);
        }
    }
}

#[inline(always)]
fn add_loads<V: Lanes>(degree: usize, u: &[f64], v: &[f64], data: [&[f64]; 3], out: &mut [[[f64; 8]; 4]; 3]) {
    let bits = exponent_bits::<V>();
    let mut sums = [[V::splat(0.0); 4]; 3];
    for r in 0..u.len() {
        let low = powers::<V>(v[r], &bits)[0];
        for (sum, f) in sums.iter_mut().zip(data) {
            let mut term = V::splat(f[r]) * low;
            for power in sum[..=degree].iter_mut() {
                *power = *power + term;
                term = term * V::splat(u[r]);
            }
        }
    }
    for (sum, target) in sums.iter().zip(out.iter_mut()) {
        for (power, place) in sum[..=degree].iter().zip(target.iter_mut()) {
            (V::load(place) + *power).store(place);
        }
    }
}

#[inline(always)]
fn generic<V: Lanes>(
    degree: usize,
    local: [&[f64]; 2],
    weight: Option<&[f64]>,
    data: Option<[&[f64]; 3]>,
    out: &mut CellMoments,
) {
    let [u, v] = local;
    // the degree as a literal, so that the sums stay in registers
    match degree {
        1 => add_weights::<V>(1, u, v, weight, &mut out.weights),
        2 => add_weights::<V>(2, u, v, weight, &mut out.weights),
        _ => add_weights::<V>(3, u, v, weight, &mut out.weights),
    }
    if let Some(data) = data {
        match degree {
            1 => add_loads::<V>(1, u, v, data, &mut out.loads),
            2 => add_loads::<V>(2, u, v, data, &mut out.loads),
            _ => add_loads::<V>(3, u, v, data, &mut out.loads),
        }
    }
}

/// Adds the contacts at `local = [u, v]` to `out`: G with `weight` (`None`: ones), and F with `data = [f_z, f_x, f_y]`.
///
/// `degree` is p, at most [`MAX_MOMENT_DEGREE`]; q may be anything up to it. Contacts are added in their order, whatever
/// the number of threads around.
///
/// # Panics
/// When an array is shorter than u.
pub fn moments(
    level: Level,
    degree: usize,
    local: [&[f64]; 2],
    weight: Option<&[f64]>,
    data: Option<[&[f64]; 3]>,
    out: &mut CellMoments,
) {
    assert!((1..=MAX_MOMENT_DEGREE).contains(&degree), "moments are made for degrees 1 to {MAX_MOMENT_DEGREE}");
    dispatch!(level, generic [](
        degree: usize, local: [&[f64]; 2], weight: Option<&[f64]>, data: Option<[&[f64]; 3]>, out: &mut CellMoments));
}

/// The safe twin: powers by `powi`, one moment at a time.
pub fn moments_twin(
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
    use super::*;

    #[test]
    fn every_level_agrees_with_its_twin() {
        let column = |seed: f64| -> Vec<f64> { (0..53).map(|r| ((r as f64 + seed) * 12.9898).sin()).collect() };
        let (u, v, w) = (column(0.1), column(0.7), column(3.0));
        let f = [column(1.0), column(2.0), column(5.0)];
        let data = f.each_ref().map(|c| &c[..]);
        for degree in 1..=MAX_MOMENT_DEGREE {
            for weight in [None, Some(&w[..])] {
                let mut expected = CellMoments::ZERO;
                moments_twin(degree, [&u, &v], weight, Some(data), &mut expected);
                for level in Level::available() {
                    let mut made = CellMoments::ZERO;
                    moments(level, degree, [&u, &v], weight, Some(data), &mut made);
                    let mut worst = 0.0_f64;
                    for a in 0..=2 * degree {
                        for b in 0..7 {
                            worst = worst.max((made.weights[a][b] - expected.weights[a][b]).abs());
                        }
                    }
                    for t in 0..3 {
                        for a in 0..=degree {
                            for b in 0..4 {
                                worst = worst.max((made.loads[t][a][b] - expected.loads[t][a][b]).abs());
                            }
                        }
                    }
                    // 53 terms of size at most 1
                    assert!(worst < 53.0 * 4.0 * f64::EPSILON, "{} degree {degree}: {worst:e}", level.name());
                }
            }
        }
    }
}
