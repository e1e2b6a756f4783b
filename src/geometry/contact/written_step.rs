//! The step of written numbers: decimals, integers, binary fractions, single precision. What lies between two steps was rounded away.
//!
//! ```text
//! q = largest of   10^k, 2^k with all v_i in q Z;   rms 10^(e_i - d + 1) where d digits write every v_i;   ulp(max |v|) of single precision
//! rounding has the standard deviation q / sqrt 12;   no step found: that of doubles, ulp(max |v|)
//! copies = 1 + 2 max(0, pairs at one height - pairs one or two steps apart) / n
//! ```
//!
//! A bar along an even grid has few heights, each many times over, and all contacts of one height are rounded alike: `copies` of them
//! tell as much as one.

use palpate_numeric::draws::evenly;
use palpate_numeric::vector::Vector;

use super::{Contacts, Grid, Orientation};

/// Steps below this share of the largest number are those of doubles: random doubles are multiples of such steps by chance.
const FINEST: f64 = 1e-13;
/// Digits at most that are those of a rounded number.
const MOST_DIGITS: i32 = 9;
/// Different numbers below which a column shows no step: a plane at z = 5 is not rounded to integers.
const FEWEST_NUMBERS: usize = 3;

/// Contacts among which copies are counted: a thousand tell how many share a rounding to some per cent, and millions are slow to sort.
const COUNTED: usize = 4096;

/// Standard deviations by which numbers were rounded where they were written, and how often the same rounding comes again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounding {
    /// Of x, y, z.
    pub position: [f64; 3],
    /// Of a component of the unit normals; 0 without normals.
    pub normal: f64,
    /// Contacts whose heights share one rounding, and whose normals do, 1 or above.
    pub copies: [f64; 2],
}

impl Default for Rounding {
    fn default() -> Rounding {
        Rounding::NONE
    }
}

impl Rounding {
    /// Of numbers that were not rounded.
    pub const NONE: Rounding = Rounding { position: [0.0; 3], normal: 0.0, copies: [1.0; 2] };

    /// Share of a rounding below which what is left of a surface is none: numbers that lie on it were not rounded, however round they are.
    pub const EXACT: f64 = 1e-3;

    /// The same of numbers divided by a length.
    pub fn per(self, length: f64) -> Rounding {
        Rounding { position: self.position.map(|sd| sd / length), ..self }
    }

    /// The largest of a place in any direction, and that of a normal.
    pub fn largest(&self) -> [f64; 2] {
        [self.position.into_iter().fold(0.0, f64::max), self.normal]
    }

    /// Of some of the contacts, in the same units: what is left along their normals, and the copies among them, of whose heights the
    /// coordinate tells to which the normals are nearest. Without normals it may be any, and copies are those among all.
    pub fn among(self, points: &[Vector], normals: &[Vector]) -> Rounding {
        if normals.iter().all(|n| *n == [0.0; 3]) {
            return Rounding { position: [self.largest()[0]; 3], ..self };
        }
        let count = normals.len().max(1) as f64;
        let along = [0, 1, 2].map(|k| normals.iter().map(|n| n[k] * n[k]).sum::<f64>() / count);
        let variance: f64 = (0..3).map(|k| along[k] * self.position[k].powi(2)).sum();
        let up = (1..3).fold(0, |up, k| if along[k] > along[up] { k } else { up });
        let column = |of: &[Vector], k: usize| of.iter().map(|v| v[k]).collect::<Vec<f64>>();
        let of_heights = match self.position[up] {
            0.0 => 1.0,
            sd => copies(&column(points, up), step(sd)),
        };
        let columns = [0, 1, 2].map(|k| column(normals, k));
        let written = (self.normal > 0.0).then(|| step(self.normal));
        let (_, of_normals) = of_directions(&columns.each_ref(), |_| written);
        Rounding { position: [variance.sqrt(); 3], copies: [of_heights, of_normals], ..self }
    }

    /// Variances of a place and of a normal that count for as many contacts as there are: what shares one rounding errs alike.
    pub fn variances(&self) -> [f64; 2] {
        let [place, normal] = self.largest();
        [place * place * Rounding::of_copies(self.copies[0]), normal * normal * Rounding::of_copies(self.copies[1])]
    }

    /// By how much copies widen a variance. The few heights of a bar on an even grid are no sample of roundings: each may be off by half a
    /// step, whose square is three times the variance.
    pub fn of_copies(copies: f64) -> f64 {
        const WORST: f64 = 3.0;
        1.0 + WORST * (copies - 1.0)
    }

    /// Of contacts. Places that are rounder than their heights were chosen so: of x and y the finest step of all three counts.
    pub fn of_contacts(contacts: &Contacts) -> Rounding {
        let steps = [&contacts.x, &contacts.y, &contacts.z].map(|column| step_of_column(column));
        let normals = match &contacts.orientation {
            Orientation::None => (0.0, 1.0),
            Orientation::Slopes { zx, zy } => of_directions(&[zx, zy], common_step),
            Orientation::Normals { nx, ny, nz } => {
                let square = (0..nx.len()).map(|r| nx[r] * nx[r] + ny[r] * ny[r] + nz[r] * nz[r]).sum::<f64>();
                let (step, copies) = of_directions(&[nx, ny, nz], common_step);
                (step / (square / nx.len() as f64).sqrt(), copies)
            }
        };
        Rounding::of(steps, normals, &contacts.z)
    }

    /// Of the pixels with data.
    pub fn of_grid(grid: &Grid) -> Rounding {
        let known = |map: &ndarray::Array2<f64>| map.iter().copied().filter(|v| !v.is_nan()).collect::<Vec<f64>>();
        let heights = known(&grid.z);
        let slopes: Vec<Vec<f64>> = grid.zx.iter().chain(&grid.zy).map(known).collect();
        let normals = of_directions(&slopes.iter().collect::<Vec<_>>(), common_step);
        Rounding::of([step_of_column(&grid.x), step_of_column(&grid.y), step_of_column(&heights)], normals, &heights)
    }

    fn of([x, y, z]: [Option<f64>; 3], (normal, of_normals): (f64, f64), heights: &[f64]) -> Rounding {
        let Some(step) = z else {
            return Rounding { normal: sd(normal), copies: [1.0, of_normals], ..Rounding::NONE };
        };
        let beside = finest([x, y, z]);
        let copies = [copies(heights, step), of_normals];
        Rounding { position: [beside, beside, step].map(sd), normal: sd(normal), copies }
    }
}

/// Standard deviation of what rounding to a step takes away.
fn sd(step: f64) -> f64 {
    step / 12.0_f64.sqrt()
}

/// The step whose rounding has this standard deviation.
fn step(sd: f64) -> f64 {
    sd * 12.0_f64.sqrt()
}

/// Step of directions, and how many share one rounding, by the component that repeats most; the largest one hardly changes where the
/// others do. Normals of a plane are all the same, and of a bar mirrored; a component that is 0 or 1 throughout was not measured.
fn of_directions(columns: &[&Vec<f64>], written: impl Fn(&[f64]) -> Option<f64>) -> (f64, f64) {
    let mut sizes: Vec<Vec<f64>> =
        columns.iter().map(|column| column.iter().map(|v| v.abs()).collect::<Vec<f64>>()).collect();
    sizes.sort_by(|a, b| a.iter().sum::<f64>().total_cmp(&b.iter().sum()));
    let told = sizes.iter().filter(|sizes| sizes.iter().any(|v| *v != 0.0 && *v != 1.0));
    let found: Vec<(f64, f64)> = told.filter_map(|v| written(v).map(|step| (step, copies(v, step)))).collect();
    let step = found.iter().map(|(step, _)| *step).reduce(f64::min).unwrap_or(0.0);
    (step, found.iter().take(2).map(|(_, copies)| *copies).fold(1.0, f64::max))
}

/// The finest of the steps that columns show; 0 where none shows any.
fn finest(steps: impl IntoIterator<Item = Option<f64>>) -> f64 {
    steps.into_iter().flatten().reduce(f64::min).unwrap_or(0.0)
}

/// The step of finite numbers; `None` where there are too few different ones to show any.
fn step_of_column(values: &[f64]) -> Option<f64> {
    if are_several(values.iter().copied()) { common_step(values) } else { None }
}

/// Whether there are enough different numbers to show a step.
fn are_several(values: impl Iterator<Item = f64>) -> bool {
    let mut different: Vec<f64> = Vec::with_capacity(FEWEST_NUMBERS);
    for v in values {
        if !different.contains(&v) {
            different.push(v);
        }
        if different.len() == FEWEST_NUMBERS {
            return true;
        }
    }
    false
}

/// The step of finite numbers that are not all zero.
fn common_step(values: &[f64]) -> Option<f64> {
    let largest = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    if !largest.is_normal() {
        return None;
    }
    let tens = fixed(values, largest, 10.0);
    let found = [tens, fixed(values, largest, 2.0), digits(values, tens.unwrap_or(0.0)), single(values, largest)];
    found.into_iter().flatten().reduce(f64::max).or(Some(largest * f64::EPSILON))
}

/// The largest power of the base that all numbers are multiples of.
fn fixed(values: &[f64], largest: f64, base: f64) -> Option<f64> {
    let first = largest.log(base).ceil() as i32;
    let last = (largest * FINEST).log(base).ceil() as i32;
    (last..=first).rev().find(|&k| values.iter().all(|&v| is_whole(v, base, k))).map(|k| power(base, k))
}

/// `base^k`, to the last bit.
fn power(base: f64, k: i32) -> f64 {
    let exact = |k: i32| if base == 10.0 { format!("1e{k}").parse().unwrap_or(f64::NAN) } else { base.powi(k) };
    // powers of ten up to 22 are doubles, and so are their inverses to rounding
    if k.abs() <= 22 { base.powi(k) } else { exact(k) }
}

/// Whether `v / base^k` is an integer but for the rounding of a double.
fn is_whole(v: f64, base: f64, k: i32) -> bool {
    // negative powers of ten are no doubles, positive ones are
    let by = power(base, k.abs());
    let ratio = if k < 0 { v * by } else { v / by };
    (ratio - ratio.round()).abs() <= 2.0 * f64::EPSILON * ratio.abs()
}

/// Root mean square step of numbers that are all written in the same few digits; `None` where few different numbers show a coarser one than
/// `fixed`: the 1.0 among normals of one decimal is no number of one digit.
fn digits(values: &[f64], fixed: f64) -> Option<f64> {
    let exponent = |v: f64| v.abs().log10().floor() as i32;
    let written = |d: i32| values.iter().all(|&v| v == 0.0 || is_whole(v, 10.0, exponent(v) - d + 1));
    let d = (1..=MOST_DIGITS).find(|&d| written(d))?;
    let is_coarser = |v: &f64| *v != 0.0 && 10.0_f64.powi(exponent(*v) - d + 1) > 1.5 * fixed;
    if !are_several(values.iter().filter(|v| is_coarser(v)).map(|v| v.abs())) {
        return None;
    }
    Some(root_mean_square(values, |v| 10.0_f64.powi(exponent(v) - d + 1)))
}

/// Step of the largest of numbers of single precision.
fn single(values: &[f64], largest: f64) -> Option<f64> {
    let is_single = values.iter().all(|&v| f64::from(v as f32) == v);
    is_single.then(|| f64::from(f32::EPSILON) * largest.log2().floor().exp2())
}

fn root_mean_square(values: &[f64], step: impl Fn(f64) -> f64) -> f64 {
    let squares: f64 = values.iter().filter(|v| **v != 0.0).map(|&v| step(v).powi(2)).sum();
    (squares / values.len() as f64).sqrt()
}

/// How many contacts share one rounding on the mean: those of one number, beyond those that are one or two steps apart. Numbers that fall
/// together by chance, because there are few steps or because a sensor's errors spread them over several, have more such neighbours.
fn copies(values: &[f64], step: f64) -> f64 {
    // of very many some tell how many they are; by the golden section, with which no row of a grid is in step
    let count = values.len();
    let number = |k: usize| (evenly(k) * count as f64) as usize;
    let mut sorted: Vec<f64> =
        if count < 3 * COUNTED { values.to_vec() } else { (0..COUNTED).map(|k| values[number(k)]).collect() };
    sorted.sort_unstable_by(f64::total_cmp);
    let runs: Vec<(f64, f64)> =
        sorted.chunk_by(|a, b| b - a < 0.5 * step).map(|run| (run[0], run.len() as f64)).collect();
    let same: f64 = runs.iter().map(|(_, count)| 0.5 * count * (count - 1.0)).sum();
    let beside: f64 = (1..=2)
        .flat_map(|ahead| runs.iter().zip(runs.iter().skip(ahead)))
        .filter(|(low, high)| high.0 - low.0 < 2.5 * step)
        .map(|(low, high)| low.1 * high.1)
        .sum();
    let counted = sorted.len().max(1) as f64;
    1.0 + 2.0 * (same - beside).max(0.0) / counted * (count as f64 / counted)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roots() -> Vec<f64> {
        (2..60).map(|k| f64::from(k).sqrt() - 4.0).collect()
    }

    fn rounded(digits: i32) -> Vec<f64> {
        let unit = 10.0_f64.powi(digits);
        roots().iter().map(|v| (v * unit).round() / unit).collect()
    }

    #[test]
    fn decimals_show_their_step_in_every_unit() {
        for digits in 0..=9 {
            let expected = 10.0_f64.powi(-digits);
            for unit in [1.0, 1e-3, 1e3, 1e10, 1e-60] {
                let values: Vec<f64> = rounded(digits).iter().map(|v| v * unit).collect();
                let found = step_of_column(&values).unwrap();
                assert!((found / (expected * unit) - 1.0).abs() < 1e-9, "{digits} {unit}: {found}");
            }
        }
    }

    #[test]
    fn doubles_show_their_own_and_singles_theirs() {
        let largest = roots().iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        assert_eq!(step_of_column(&roots()), Some(largest * f64::EPSILON));
        let singles: Vec<f64> = roots().iter().map(|v| f64::from(*v as f32)).collect();
        let found = step_of_column(&singles).unwrap();
        assert!((0.3..=1.0).contains(&(found / (largest * f64::from(f32::EPSILON)))), "{found}");
        let binary: Vec<f64> = roots().iter().map(|v| (v * 64.0).round() / 64.0).collect();
        assert_eq!(step_of_column(&binary), Some(1.0 / 64.0));
    }

    /// `%g` writes six digits of every number, so that most are rounder than the smallest one.
    #[test]
    fn numbers_of_as_many_digits_show_the_step_of_the_larger_ones() {
        let values: Vec<f64> = roots().iter().map(|v| format!("{:.5e}", 3.0 * v).parse().unwrap()).collect();
        let found = step_of_column(&values).unwrap();
        assert!((1e-5..1e-4).contains(&found), "{found}");
    }

    #[test]
    fn columns_of_few_numbers_show_none() {
        assert_eq!([step_of_column(&[0.0; 9]), step_of_column(&[5.0; 9]), step_of_column(&[1.0, 2.0, 1.0])], [None; 3]);
    }

    /// Places on an even grid are integers although nothing was rounded there.
    #[test]
    fn round_places_under_heights_of_full_precision_are_exact() {
        let x: Vec<f64> = (0..49).map(|r| f64::from(r % 7)).collect();
        let y: Vec<f64> = (0..49).map(|r| f64::from(r / 7)).collect();
        let z: Vec<f64> = x.iter().map(|x| (225.0 - x * x).sqrt()).collect();
        let exact = Rounding::of_contacts(&Contacts::from_positions(x.clone(), y.clone(), z.clone()));
        assert!(exact.position.iter().all(|sd| *sd < 1e-14), "{exact:?}");
        let z = z.iter().map(|z| (z * 1e4).round() / 1e4).collect();
        let found = Rounding::of_contacts(&Contacts::from_positions(x, y, z));
        assert!(found.position.iter().all(|sd| (sd * 12.0_f64.sqrt() - 1e-4).abs() < 1e-12), "{found:?}");
        // seven heights, each seven times
        assert!((found.copies[0] - 7.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn heights_that_fall_together_by_chance_are_no_copies() {
        let heights: Vec<f64> = (0..2000).map(|k| (f64::from(k) * 0.618_034).fract() * 20.0).map(f64::round).collect();
        assert_eq!(copies(&heights, 1.0), 1.0);
    }

    /// A bar along y on an even grid: the heights and normals of a row are rounded alike, and so are those of the row across.
    #[test]
    fn contacts_of_a_row_share_their_roundings() {
        let rounded = |v: Vector| v.map(|v| (v * 1e3).round() / 1e3);
        let contact = |k: u32| {
            let [x, y] = [k % 8, k / 8].map(|k| f64::from(k) - 3.5);
            let height = (81.0 - x * x).sqrt();
            (rounded([x, y, height]), rounded([x / 9.0, 0.0, height / 9.0]))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..64).map(contact).unzip();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let found = Rounding::of_contacts(&contacts).among(&points, &normals);
        // rounded normals are not quite of length one
        let is = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-3;
        assert!(is(found.normal, 1e-3 / 12.0_f64.sqrt()) && found.largest()[0] < 1.01 * found.normal, "{found:?}");
        assert_eq!(found.copies, [16.0, 16.0]);
        let many = |of: &[Vector]| of.iter().copied().cycle().take(65_536).collect::<Vec<Vector>>();
        let found_of_many = found.among(&many(&points), &many(&normals));
        assert!(found_of_many.copies.iter().all(|copies| (copies / 16_384.0 - 1.0).abs() < 0.02), "{found_of_many:?}");
        let half = found.among(&points[..32], &normals[..32]);
        assert_eq!(half.copies, [8.0, 8.0]);
        assert!(is(half.variances()[1], 22.0 * half.normal.powi(2)), "{half:?}");
        assert!(is(found.per(2.0).position[2], 0.5 * found.position[2]));
    }

    /// The 1.00 of an axis has fewer digits than the 0.71 beside it, and is no coarser for that.
    #[test]
    fn normals_of_few_decimals_show_the_step_of_all() {
        for digits in [1, 2, 3] {
            let unit = 10.0_f64.powi(digits);
            let turned = (0..90).map(|k| (f64::from(k).to_radians().cos() * unit).round() / unit);
            let found = step_of_column(&turned.collect::<Vec<f64>>()).unwrap();
            assert!((found * unit - 1.0).abs() < 1e-9, "{digits}: {found}");
        }
    }
}
