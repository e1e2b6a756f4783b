//! How probable it is that contacts are divided among two things as they are: neighbours mostly belong to the same one.
//!
//! ```text
//! ln p = ln 1/2 + ln B(1 + changes, 1 + steps - changes)      steps from contact to contact along a curve that fills space
//! ```
//!
//! The first contact belongs to either thing, and every next one to the same as the one before it but with some probability, of which
//! nothing is known. The curve is that of G. Morton, *A Computer Oriented Geodetic Data Base*, IBM, 1966: the digits of the three
//! coordinates in turn.

use std::f64::consts::LN_2;

use statrs::function::beta::ln_beta;

use super::sample::BodySample;
use palpate_numeric::vector::Vector;

/// Binary digits of a coordinate.
const DIGITS: u32 = 16;

/// Log probability that these members belong to one thing and all others to the other.
pub(super) fn log_division(sample: &BodySample, members: &[usize]) -> f64 {
    let mut is_member = vec![false; sample.len()];
    members.iter().for_each(|i| is_member[*i] = true);
    let along = along_a_curve(&sample.points);
    let changes = along.windows(2).filter(|pair| is_member[pair[0]] != is_member[pair[1]]).count() as f64;
    let steps = along.len().saturating_sub(1) as f64;
    ln_beta(1.0 + changes, 1.0 + steps - changes) - LN_2
}

/// The contacts' numbers in the order of the curve through the box about them.
fn along_a_curve(points: &[Vector]) -> Vec<usize> {
    let corner = |better: fn(f64, f64) -> f64| {
        let meet = |sum: Vector, p: &Vector| [0, 1, 2].map(|k| better(sum[k], p[k]));
        points.iter().skip(1).fold(points.first().copied().unwrap_or_default(), meet)
    };
    let (least, most) = (corner(f64::min), corner(f64::max));
    let extent = (0..3).map(|k| most[k] - least[k]).fold(f64::MIN_POSITIVE, f64::max);
    let cells = f64::from((1_u32 << DIGITS) - 1);
    let place = |p: &Vector| {
        let whole = [0, 1, 2].map(|k| ((p[k] - least[k]) / extent * cells) as u64);
        (0..DIGITS).fold(0_u64, |code, digit| {
            (0..3).fold(code, |code, k| code | (whole[k] >> digit & 1) << (3 * digit + k as u32))
        })
    };
    let mut order: Vec<(u64, usize)> = points.iter().enumerate().map(|(i, p)| (place(p), i)).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, i)| i).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::contact::Rounding;

    /// A square of 20 times 20 places.
    fn square() -> BodySample {
        let points: Vec<Vector> = (0..400).map(|i| [f64::from(i % 20), f64::from(i / 20), 0.0]).collect();
        BodySample::new(&points, &[], Rounding::NONE).unwrap()
    }

    #[test]
    fn every_contact_is_passed_once() {
        let mut order = along_a_curve(&square().points);
        order.sort_unstable();
        assert!(order.into_iter().eq(0..400));
    }

    #[test]
    fn halves_are_more_probable_than_a_mixture() {
        let half: Vec<usize> = (0..200).collect();
        let mixture: Vec<usize> = (0..400).filter(|i| (i * 7919 + 13) % 400 < 200).collect();
        let (half, mixture) = (log_division(&square(), &half), log_division(&square(), &mixture));
        // a mixture costs about ln 2 a contact, a half no more than its border
        assert!(half > -100.0 && mixture < -230.0, "{half} {mixture}");
    }

    #[test]
    fn the_probabilities_of_all_divisions_are_one() {
        let points: Vec<Vector> = (0..9).map(|i: i32| [f64::from(i * i % 7), f64::from(i), 0.0]).collect();
        let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
        let of = |code: usize| (0..9).filter(|i| code >> i & 1 == 1).collect::<Vec<usize>>();
        let sum: f64 = (0..512).map(|code| log_division(&sample, &of(code)).exp()).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }
}
