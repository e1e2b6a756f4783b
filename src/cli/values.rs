//! Values of options that are not one of a few words, as they are typed. Each message says what would be right. (The
//! words are those of [`crate::fit`]'s options, which read themselves.)

use crate::fit::{NormalSigma, Objective, SlopeWeights, UnknownWord};

/// Largest count of segments or grid points per direction. A larger number is more likely a typing error.
const MAX_COUNT: usize = 100_000;

/// `2`, `2,3` or `2x3`: one count for both directions or one for each.
pub(super) fn counts(text: &str) -> Result<[usize; 2], String> {
    let wrong = || format!("a whole number from 1 to {MAX_COUNT}, or two as in 2,3 or 2x3");
    let parsed: Result<Vec<usize>, _> = text.split([',', 'x']).map(|n| n.trim().parse()).collect();
    let pair = match parsed.as_deref() {
        Ok(&[n]) => [n, n],
        Ok(&[n, m]) => [n, m],
        _ => return Err(wrong()),
    };
    if pair.iter().all(|n| (1..=MAX_COUNT).contains(n)) { Ok(pair) } else { Err(wrong()) }
}

/// A degree or two, 1 to 9.
pub(super) fn degrees(text: &str) -> Result<[usize; 2], String> {
    match counts(text) {
        Ok(pair) if pair.iter().all(|d| *d <= crate::bspline::MAX_DEGREE) => Ok(pair),
        _ => Err(format!("degrees run from 1 to {}, one or two as in 2 or 2,3", crate::bspline::MAX_DEGREE)),
    }
}

/// Finite numbers between commas.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let parsed: Result<Vec<f64>, _> = text.split(',').map(|n| n.trim().parse::<f64>()).collect();
    let array: [f64; N] = parsed.ok()?.try_into().ok()?;
    array.iter().all(|v| v.is_finite()).then_some(array)
}

/// `X0,X1,Y0,Y1` with X0 < X1 and Y0 < Y1.
pub(super) fn domain(text: &str) -> Result<[f64; 4], String> {
    numbers::<4>(text)
        .filter(|[x0, x1, y0, y1]| x0 < x1 && y0 < y1)
        .ok_or_else(|| "four numbers X0,X1,Y0,Y1 with X0 < X1 and Y0 < Y1, such as -4,4,-4,4".into())
}

/// `auto`, a preset or `WZ,WX,WY`.
pub(super) fn weights(text: &str) -> Result<Objective, UnknownWord> {
    text.parse::<SlopeWeights>().map(Objective::Slopes)
}

/// `auto` or `Z,DEG`.
pub(super) fn sigma(text: &str) -> Result<Objective, UnknownWord> {
    text.parse::<NormalSigma>().map(Objective::Normals)
}

/// `u`, `v` or `u,v`.
pub(super) fn closed(text: &str) -> Result<[bool; 2], String> {
    match text {
        "u" => Ok([true, false]),
        "v" => Ok([false, true]),
        "u,v" | "v,u" => Ok([true, true]),
        _ => Err("u, v or u,v".into()),
    }
}

/// A fraction from 0 to below 1/2.
pub(super) fn inset(text: &str) -> Result<f64, String> {
    match numbers::<1>(text) {
        Some([inset]) if (0.0..0.5).contains(&inset) => Ok(inset),
        _ => Err("a fraction of each side, from 0 to below 0.5, such as 0.25".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Smooth;

    #[test]
    fn pairs_take_comma_or_x() {
        assert_eq!(counts("8"), Ok([8, 8]));
        assert_eq!(counts("60x50"), Ok([60, 50]));
        assert_eq!(counts("4, 5"), Ok([4, 5]));
        for wrong in ["", "0", "-1", "2,3,4", "2.5", "a", "8x", "999999999"] {
            assert!(counts(wrong).is_err(), "{wrong}");
        }
        assert_eq!(degrees("2,3"), Ok([2, 3]));
        assert!(degrees("10").unwrap_err().contains("1 to 9"));
        assert!(degrees("0").is_err());
    }

    #[test]
    fn weights_and_sigma_are_presets_or_numbers() {
        assert_eq!(weights("tangent"), Ok(Objective::Slopes(SlopeWeights::Tangent)));
        assert_eq!(weights("1,10,10"), Ok(Objective::Slopes(SlopeWeights::Explicit([1.0, 10.0, 10.0]))));
        for wrong in ["tangents", "1,2", "1,2,-3", "0,0,0", "1,nan,1", "1,inf,1"] {
            assert!(weights(wrong).unwrap_err().to_string().contains("WZ,WX,WY"), "{wrong}");
        }
        assert_eq!(sigma("1,15"), Ok(Objective::Normals(NormalSigma::Known { z: 1.0, normal_deg: 15.0 })));
        assert_eq!(sigma("auto"), Ok(Objective::Normals(NormalSigma::Auto)));
        for wrong in ["1", "0,5", "1,0", "-1,5", "a,b", "1,5,5"] {
            assert!(sigma(wrong).unwrap_err().to_string().contains("Z,DEG"), "{wrong}");
        }
    }

    #[test]
    fn ranges_are_held() {
        assert_eq!(domain("-4,4,-1e1,.5"), Ok([-4.0, 4.0, -10.0, 0.5]));
        for wrong in ["4,-4,0,1", "0,1,1,1", "0,1,0", "0,1,0,inf"] {
            assert!(domain(wrong).is_err(), "{wrong}");
        }
        assert_eq!(inset("0.25"), Ok(0.25));
        for wrong in ["0.5", "-0.1", "25%", "nan"] {
            assert!(inset(wrong).is_err(), "{wrong}");
        }
        assert_eq!("1e-6".parse(), Ok(Smooth::Lambda(1e-6)));
        assert!("-1".parse::<Smooth>().is_err() && "inf".parse::<Smooth>().is_err());
    }
}
