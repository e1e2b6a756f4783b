//! Values of options that are not one of a few words, as they are typed. Each message says what would be right. (The
//! words are those of [`palpate_fitting::fit`]'s options, which read themselves.)

use crate::io::{MOST_GRID_POINTS, MOST_SEGMENTS, exceeds};
use crate::report::PictureFormat;
use palpate_fitting::fit::{FitError, NormalSigma, Objective, SlopeWeights};
use palpate_studies::montecarlo::{Path, Tolerance};

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

/// Segments; no more than a machine can hold.
pub(super) fn segments(text: &str) -> Result<[usize; 2], String> {
    held(counts(text)?, MOST_SEGMENTS, "segments", "a patch rarely needs more than 20x20")
}

/// Points of a shape grid; no more than a machine can hold.
pub(super) fn grid_points(text: &str) -> Result<[usize; 2], String> {
    held(counts(text)?, MOST_GRID_POINTS, "points", "a picture needs some 100x100")
}

fn held(pair: [usize; 2], most: usize, what: &str, usual: &str) -> Result<[usize; 2], String> {
    if exceeds(pair, most) {
        let [n, m] = pair;
        return Err(format!("{n} x {m} {what} are more than {most}, which is the most; {usual}"));
    }
    Ok(pair)
}

/// A degree or two, 1 to 9.
pub(super) fn degrees(text: &str) -> Result<[usize; 2], String> {
    match counts(text) {
        Ok(pair) if pair.iter().all(|d| *d <= palpate_numeric::bspline::MAX_DEGREE) => Ok(pair),
        _ => Err(format!("degrees run from 1 to {}, one or two as in 2 or 2,3", palpate_numeric::bspline::MAX_DEGREE)),
    }
}

/// One kind of picture.
pub(super) fn picture_format(text: &str) -> Result<PictureFormat, String> {
    let found = PictureFormat::ALL.into_iter().find(|format| format.name() == text.trim());
    found.ok_or_else(|| "svg, png or pdf is needed, several between commas".into())
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

/// `X,Y,Z,R` with R > 0.
pub(super) fn ball(text: &str) -> Result<[f64; 4], String> {
    numbers::<4>(text)
        .filter(|ball| ball[3] > 0.0)
        .ok_or_else(|| "four numbers X,Y,Z,R with R > 0, such as 0,0,10,5".into())
}

/// `X0,X1,Y0,Y1,Z0,Z1`, each pair in order.
pub(super) fn bounds(text: &str) -> Result<[f64; 6], String> {
    numbers::<6>(text)
        .filter(|[x0, x1, y0, y1, z0, z1]| x0 <= x1 && y0 <= y1 && z0 <= z1)
        .ok_or_else(|| "six numbers X0,X1,Y0,Y1,Z0,Z1, each pair in order, such as -4,4,-4,4,0,10".into())
}

/// Longest name of a unit.
const LONGEST_UNIT: usize = 12;

/// The name of a unit of length.
pub(super) fn unit(text: &str) -> Result<String, String> {
    let fits = (1..=LONGEST_UNIT).contains(&text.chars().count());
    if fits && text.chars().all(char::is_alphanumeric) {
        return Ok(text.into());
    }
    Err(format!("a unit of length in at most {LONGEST_UNIT} letters, such as mm, m or inch"))
}

/// `X,Y,Z`.
pub(super) fn point(text: &str) -> Result<[f64; 3], String> {
    numbers::<3>(text).ok_or_else(|| "three numbers X,Y,Z, such as 0,0,0".into())
}

/// `auto`, a preset or `WZ,WX,WY`.
pub(super) fn weights(text: &str) -> Result<Objective, FitError> {
    text.parse::<SlopeWeights>().map(Objective::Slopes)
}

/// `auto` or `Z,DEG`.
pub(super) fn sigma(text: &str) -> Result<Objective, FitError> {
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

/// A length of zero or more.
pub(super) fn sigma_xy(text: &str) -> Result<f64, String> {
    match numbers::<1>(text) {
        Some([sigma_xy]) if sigma_xy >= 0.0 => Ok(sigma_xy),
        _ => Err("a length of zero or more, in the unit of the input, such as 0.3".into()),
    }
}

/// A count of replicates, as 10000 or 1e9.
pub(super) fn replicates(text: &str) -> Result<u64, String> {
    let wrong = || "a whole number from 1 to 2^40, such as 10000 or 1e9".to_string();
    let count = match text.parse::<u64>() {
        Ok(count) => count,
        Err(_) => match text.parse::<f64>() {
            Ok(v) if v.fract() == 0.0 && (1.0..=1e12).contains(&v) => v as u64,
            _ => return Err(wrong()),
        },
    };
    if (1..=1 << 40).contains(&count) { Ok(count) } else { Err(wrong()) }
}

/// A probability between 0 and 1, both excluded.
pub(super) fn level(text: &str) -> Result<f64, String> {
    match numbers::<1>(text) {
        Some([level]) if level > 0.0 && level < 1.0 => Ok(level),
        _ => Err("a probability between 0 and 1, such as 0.95".into()),
    }
}

/// A tolerance by its digits.
pub(super) type Rule = fn(u32) -> Tolerance;

/// `stein` or `adaptive`.
pub(super) fn rule(text: &str) -> Result<Rule, String> {
    match text {
        "stein" => Ok(Tolerance::Stein),
        "adaptive" => Ok(Tolerance::Adaptive),
        _ => Err("stein or adaptive".into()),
    }
}

/// A time greater than zero.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    match numbers::<1>(text) {
        Some([seconds]) if seconds > 0.0 => Ok(seconds),
        _ => Err("a number of seconds greater than 0".into()),
    }
}

/// A length of time as 50us, 2ms or 0.1s, in seconds.
pub(super) fn duration(text: &str) -> Result<f64, String> {
    let units = [("ns", 1e-9), ("us", 1e-6), ("ms", 1e-3), ("s", 1.0)];
    let parsed = units.iter().find_map(|(unit, seconds)| {
        let number = text.strip_suffix(unit)?.trim().parse::<f64>().ok()?;
        Some(number * seconds)
    });
    match parsed {
        Some(seconds) if seconds > 0.0 && seconds.is_finite() => Ok(seconds),
        _ => Err("a time greater than 0 with its unit, such as 50us, 2ms or 0.1s".into()),
    }
}

/// An error greater than zero.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    match numbers::<1>(text) {
        Some([error]) if error > 0.0 => Ok(error),
        _ => Err("a number greater than 0, such as 0.01".into()),
    }
}

/// `A:B` with A < B.
pub(super) fn range(text: &str) -> Result<[u64; 2], String> {
    let wrong = || "A:B with A < B, such as 0:5000".to_string();
    let (a, b) = text.split_once(':').ok_or_else(wrong)?;
    let count = |text: &str| if text == "0" { Ok(0) } else { replicates(text) };
    match (count(a), count(b)) {
        (Ok(a), Ok(b)) if a < b => Ok([a, b]),
        _ => Err(wrong()),
    }
}

/// A path that was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PathChoice {
    Auto,
    Only(Path),
}

/// `auto`, `refit` or `whole`.
pub(super) fn study_path(text: &str) -> Result<PathChoice, String> {
    match text {
        "auto" => Ok(PathChoice::Auto),
        "refit" => Ok(PathChoice::Only(Path::Refit)),
        "whole" => Ok(PathChoice::Only(Path::Whole)),
        _ => Err("auto, refit or whole".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_fitting::fit::Smooth;

    #[test]
    fn pairs_take_comma_or_x() {
        assert_eq!(counts("8"), Ok([8, 8]));
        assert_eq!(counts("60x50"), Ok([60, 50]));
        assert_eq!(counts("4, 5"), Ok([4, 5]));
        for wrong in ["", "0", "-1", "2,3,4", "2.5", "a", "8x", "999999999"] {
            assert!(counts(wrong).is_err(), "{wrong}");
        }
        assert_eq!((segments("512"), grid_points("2000x2000")), (Ok([512, 512]), Ok([2000, 2000])));
        for message in [segments("100000").unwrap_err(), grid_points("10000x10000").unwrap_err()] {
            assert!(message.contains("which is the most"), "{message}");
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
    fn studies_have_sound_numbers() {
        assert_eq!(replicates("1e9"), Ok(1_000_000_000));
        assert_eq!(replicates("12"), Ok(12));
        for wrong in ["0", "-1", "1.5", "1e20", "nan", "many"] {
            assert!(replicates(wrong).unwrap_err().contains("1e9"), "{wrong}");
        }
        assert_eq!(range("0:5000"), Ok([0, 5000]));
        for wrong in ["5", "5:5", "7:3", "a:b", "-1:4"] {
            assert!(range(wrong).is_err(), "{wrong}");
        }
        for wrong in ["0", "1", "95%", "nan", "-0.5"] {
            assert!(level(wrong).is_err(), "{wrong}");
        }
        assert!(seconds("0").is_err() && seconds("0.5").is_ok());
    }

    #[test]
    fn units_are_plain_words() {
        assert_eq!((unit("mm"), unit("µm")), (Ok("mm".into()), Ok("µm".into())));
        for wrong in ["", "<b>", "a b", "m\u{1b}[31m", "megaparsecsandmore"] {
            assert!(unit(wrong).unwrap_err().contains("such as mm"), "{wrong}");
        }
    }

    #[test]
    fn times_have_units() {
        assert_eq!((duration("50us"), duration("2ms"), duration("0.5s")), (Ok(50.0 * 1e-6), Ok(2.0 * 1e-3), Ok(0.5)));
        for wrong in ["50", "us", "-1us", "0s", "nans", "1 hour"] {
            assert!(duration(wrong).unwrap_err().contains("50us"), "{wrong}");
        }
        assert!(positive("0").is_err() && positive("0.01").is_ok());
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
