//! Values of options as they are typed, with a message that says what would be right.

use crate::montecarlo::{Path, StoppingRule};

use super::study::Way;

use crate::fit::{FrameChoice, Method, NormalSigma, Objective, Robust, SlopeWeights, Smooth, SurfaceKind};

/// Largest count of segments or grid points per direction that is taken; beyond it a typing error is likelier.
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
pub(super) fn weights(text: &str) -> Result<Objective, String> {
    let weights = match text {
        "auto" => SlopeWeights::Auto,
        "tangent" => SlopeWeights::Tangent,
        "position" => SlopeWeights::Position,
        "equal" => SlopeWeights::Equal,
        _ => {
            let explicit = numbers::<3>(text).filter(|w| w.iter().all(|w| *w >= 0.0) && w.iter().any(|w| *w > 0.0));
            SlopeWeights::Explicit(explicit.ok_or("auto, tangent, position, equal or WZ,WX,WY such as 1,10,10")?)
        }
    };
    Ok(Objective::Slopes(weights))
}

/// `auto` or `Z,DEG`.
pub(super) fn sigma(text: &str) -> Result<Objective, String> {
    if text == "auto" {
        return Ok(Objective::Normals(NormalSigma::Auto));
    }
    let [z, normal_deg] = numbers::<2>(text)
        .filter(|s| s.iter().all(|v| *v > 0.0))
        .ok_or("auto, or Z,DEG: the sd of z in input units and of the normals in degrees, such as 0.02,5")?;
    Ok(Objective::Normals(NormalSigma::Known { z, normal_deg }))
}

/// `height`, `parametric` or `auto`.
pub(super) fn surface(text: &str) -> Result<SurfaceKind, String> {
    match text {
        "height" => Ok(SurfaceKind::Height),
        "parametric" => Ok(SurfaceKind::Parametric),
        "auto" => Ok(SurfaceKind::Auto),
        _ => Err("height, parametric or auto".into()),
    }
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

/// `auto`, `cholesky`, `qr`, `kronecker` or `pcg`.
pub(super) fn method(text: &str) -> Result<Method, String> {
    match text {
        "auto" => Ok(Method::Auto),
        "cholesky" => Ok(Method::Cholesky),
        "qr" => Ok(Method::Qr),
        "kronecker" => Ok(Method::Kronecker),
        "pcg" => Ok(Method::Pcg),
        _ => Err("auto, cholesky, qr, kronecker or pcg".into()),
    }
}

/// `none`, `auto` or a number >= 0.
pub(super) fn smooth(text: &str) -> Result<Smooth, String> {
    match text {
        "none" => Ok(Smooth::None),
        "auto" => Ok(Smooth::Auto),
        _ => match numbers::<1>(text) {
            Some([lambda]) if lambda >= 0.0 => Ok(Smooth::Lambda(lambda)),
            _ => Err("none, auto or LAMBDA >= 0 such as 1e-6".into()),
        },
    }
}

/// `none`, `huber` or `tukey`.
pub(super) fn robust(text: &str) -> Result<Robust, String> {
    match text {
        "none" => Ok(Robust::None),
        "huber" => Ok(Robust::Huber),
        "tukey" => Ok(Robust::Tukey),
        _ => Err("none, huber or tukey".into()),
    }
}

/// A fraction from 0 to below 1/2.
pub(super) fn inset(text: &str) -> Result<f64, String> {
    match numbers::<1>(text) {
        Some([inset]) if (0.0..0.5).contains(&inset) => Ok(inset),
        _ => Err("a fraction of each side, from 0 to below 0.5, such as 0.25".into()),
    }
}

/// `keep` or `auto`.
pub(super) fn frame(text: &str) -> Result<FrameChoice, String> {
    match text {
        "keep" => Ok(FrameChoice::Keep),
        "auto" => Ok(FrameChoice::Auto),
        _ => Err("keep or auto".into()),
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

/// `stein` or `adaptive`.
pub(super) fn rule(text: &str) -> Result<StoppingRule, String> {
    match text {
        "stein" => Ok(StoppingRule::Stein),
        "adaptive" => Ok(StoppingRule::Adaptive),
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

/// `auto`, `refit` or `whole`.
pub(super) fn way(text: &str) -> Result<Way, String> {
    match text {
        "auto" => Ok(Way::Auto),
        "refit" => Ok(Way::Only(Path::Refit)),
        "whole" => Ok(Way::Only(Path::Whole)),
        _ => Err("auto, refit or whole".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            assert!(weights(wrong).unwrap_err().contains("WZ,WX,WY"), "{wrong}");
        }
        assert_eq!(sigma("1,15"), Ok(Objective::Normals(NormalSigma::Known { z: 1.0, normal_deg: 15.0 })));
        assert_eq!(sigma("auto"), Ok(Objective::Normals(NormalSigma::Auto)));
        for wrong in ["1", "0,5", "1,0", "-1,5", "a,b", "1,5,5"] {
            assert!(sigma(wrong).unwrap_err().contains("Z,DEG"), "{wrong}");
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
    fn ranges_are_held() {
        assert_eq!(domain("-4,4,-1e1,.5"), Ok([-4.0, 4.0, -10.0, 0.5]));
        for wrong in ["4,-4,0,1", "0,1,1,1", "0,1,0", "0,1,0,inf"] {
            assert!(domain(wrong).is_err(), "{wrong}");
        }
        assert_eq!(inset("0.25"), Ok(0.25));
        for wrong in ["0.5", "-0.1", "25%", "nan"] {
            assert!(inset(wrong).is_err(), "{wrong}");
        }
        assert_eq!(smooth("1e-6"), Ok(Smooth::Lambda(1e-6)));
        assert!(smooth("-1").is_err() && smooth("inf").is_err());
    }
}
