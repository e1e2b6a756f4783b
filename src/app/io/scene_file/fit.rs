//! `[fit]`: the options of a fit, in the same words as on the command line.

use super::SceneFileError;
use super::section::{Section, as_array, as_count, as_number};
use crate::io::{MOST_GRID_POINTS, MOST_SEGMENTS, exceeds};
use palpate_fitting::fit::{
    FitOptions, FrameChoice, Method, NormalSigma, Objective, Robust, SlopeWeights, Smooth, SurfaceKind,
};
use palpate_numeric::bspline::MAX_DEGREE;

/// Options of a scene: those of a fit, but `tangent` weights when neither weights nor sigma stand there.
pub(super) fn read(section: Option<Section>) -> Result<FitOptions, SceneFileError> {
    let mut fit = FitOptions { objective: Objective::Slopes(SlopeWeights::Tangent), ..FitOptions::default() };
    let Some(section) = section else { return Ok(fit) };
    fit.surface = choice(&section, "surface", SurfaceKind::WORDS)?.unwrap_or_default();
    let closed = [("u", [true, false]), ("v", [false, true]), ("u,v", [true, true])];
    fit.closed = choice(&section, "closed", &closed)?.unwrap_or_default();
    if fit.surface == SurfaceKind::Parametric {
        fit.degree = [3, 3];
    }
    if let Some(degree) = one_or_pair(&section, "degree", 1, MAX_DEGREE as u64)? {
        fit.degree = degree;
    }
    if let Some(segments) = one_or_pair(&section, "segments", 1, u64::from(u32::MAX))? {
        fit.segments = held(&section, "segments", segments, MOST_SEGMENTS)?;
    }
    if let Some(grid) = one_or_pair(&section, "grid", 1, u64::from(u32::MAX))? {
        fit.grid = held(&section, "grid", grid, MOST_GRID_POINTS)?;
    }
    fit.domain = read_domain(&section)?;
    if let Some(objective) = read_objective(&section)? {
        fit.objective = objective;
    }
    fit.inset = read_inset(&section)?;
    fit.smooth = read_smooth(&section)?;
    fit.method = choice(&section, "method", Method::WORDS)?.unwrap_or_default();
    fit.robust = choice(&section, "robust", Robust::WORDS)?.unwrap_or_default();
    fit.sigma_xy = read_sigma_xy(&section)?;
    fit.frame = choice(&section, "frame", FrameChoice::WORDS)?;
    if let Some(level) = read_level(&section)? {
        fit.level = level;
    }
    section.finish("key")?;
    Ok(fit)
}

fn one_or_pair(
    section: &Section,
    key: &'static str,
    least: u64,
    most: u64,
) -> Result<Option<[usize; 2]>, SceneFileError> {
    let Some(value) = section.get(key) else { return Ok(None) };
    let pair = match as_array(value) {
        None => as_count(value).map(|n| [n, n]),
        Some(array) => {
            array.iter().map(as_count).collect::<Option<Vec<u64>>>().and_then(|list| <[u64; 2]>::try_from(list).ok())
        }
    };
    match pair {
        Some(pair) if pair.iter().all(|n| (least..=most).contains(n)) => Ok(Some(pair.map(|n| n as usize))),
        _ => {
            let range = if most < 100 { format!("from {least} to {most}") } else { format!("of at least {least}") };
            Err(section.value_error(key, value, format!("a whole number {range}, or a pair of them, is needed")))
        }
    }
}

/// A pair whose product is not too large to be meant.
fn held(section: &Section, key: &'static str, pair: [usize; 2], most: usize) -> Result<[usize; 2], SceneFileError> {
    match section.get(key) {
        Some(value) if exceeds(pair, most) => {
            Err(section.value_error(key, value, format!("both directions multiplied may make {most} at most")))
        }
        _ => Ok(pair),
    }
}

fn read_domain(section: &Section) -> Result<Option<[f64; 4]>, SceneFileError> {
    let domain: Option<[f64; 4]> = section.several("domain")?;
    if let (Some([x0, x1, y0, y1]), Some(value)) = (domain, section.get("domain"))
        && !(x0 < x1 && y0 < y1 && [x0, x1, y0, y1].iter().all(|v| v.is_finite()))
    {
        return Err(section.value_error("domain", value, "[x0, x1, y0, y1] with x0 < x1 and y0 < y1 is needed"));
    }
    Ok(domain)
}

fn read_objective(section: &Section) -> Result<Option<Objective>, SceneFileError> {
    let (weights, sigma) = (section.get("weights"), section.get("sigma"));
    if weights.is_some() && sigma.is_some() {
        return Err(section.clash("weights", "sigma"));
    }
    if let Some(value) = weights {
        if as_array(value).is_none() {
            return Ok(choice(section, "weights", SlopeWeights::WORDS)?.map(Objective::Slopes));
        }
        let numbers: Option<[f64; 3]> = section.several("weights")?;
        return match numbers.and_then(SlopeWeights::explicit) {
            Some(weights) => Ok(Some(Objective::Slopes(weights))),
            None => {
                Err(section.value_error("weights", value, "three weights of zero or more, not all zero, are needed"))
            }
        };
    }
    let Some(value) = sigma else { return Ok(None) };
    if as_array(value).is_none() {
        return Ok(choice(section, "sigma", NormalSigma::WORDS)?.map(Objective::Normals));
    }
    let known = section.several("sigma")?.and_then(|[z, normal_deg]| NormalSigma::known(z, normal_deg));
    match known {
        Some(sigma) => Ok(Some(Objective::Normals(sigma))),
        None => Err(section.value_error("sigma", value, "\"auto\" or [Z, DEG], both greater than zero, is needed")),
    }
}

fn read_inset(section: &Section) -> Result<f64, SceneFileError> {
    let inset = section.number_or("inset", 0.0)?;
    match section.get("inset") {
        Some(value) if !(0.0..0.5).contains(&inset) => {
            Err(section.value_error("inset", value, "a fraction from 0 to below 0.5 is needed"))
        }
        _ => Ok(inset),
    }
}

fn read_sigma_xy(section: &Section) -> Result<f64, SceneFileError> {
    let sigma_xy = section.number_or("sigma_xy", 0.0)?;
    match section.get("sigma_xy") {
        Some(value) if !(sigma_xy >= 0.0 && sigma_xy.is_finite()) => {
            Err(section.value_error("sigma_xy", value, "a length of zero or more is needed"))
        }
        _ => Ok(sigma_xy),
    }
}

fn read_smooth(section: &Section) -> Result<Smooth, SceneFileError> {
    let Some(value) = section.get("smooth") else { return Ok(Smooth::default()) };
    match as_number(value).map(Smooth::lambda) {
        Some(Some(smooth)) => Ok(smooth),
        Some(None) => Err(section.value_error("smooth", value, "a lambda of zero or more is needed")),
        None => Ok(choice(section, "smooth", Smooth::WORDS)?.unwrap_or_default()),
    }
}

pub(super) fn read_level(section: &Section) -> Result<Option<f64>, SceneFileError> {
    let Some(level) = section.number("level")? else { return Ok(None) };
    match section.get("level") {
        Some(value) if !(level > 0.0 && level < 1.0) => {
            Err(section.value_error("level", value, "a level between 0 and 1, as 0.95, is needed"))
        }
        _ => Ok(Some(level)),
    }
}

fn choice<T: Copy>(section: &Section, key: &'static str, words: &[(&str, T)]) -> Result<Option<T>, SceneFileError> {
    let Some((word, value)) = section.word(key)? else { return Ok(None) };
    match words.iter().find(|(known, _)| *known == word) {
        Some((_, meaning)) => Ok(Some(*meaning)),
        None => {
            let known: Vec<&str> = words.iter().map(|(known, _)| *known).collect();
            Err(section.unknown_word(&format!("value of {}", section.full(key)), value, word, &known))
        }
    }
}
