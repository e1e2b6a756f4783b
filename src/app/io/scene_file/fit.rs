//! `[fit]` and `[study]`: the options of a fit, in the same words as on the command line, and how often a study repeats.

use palpate_fitting::fit::{
    FitOptions, FrameChoice, Method, NormalSigma, Objective, Robust, SlopeWeights, Smooth, SurfaceKind,
};
use palpate_numeric::bspline::MAX_DEGREE;
use palpate_studies::montecarlo::StudyOptions;
use schemars::JsonSchema;
use serde::Deserialize;

use super::SceneFileError;
use super::keys::keys;
use super::manual::entry::Entry;
use super::section::Section;
use crate::io::{MOST_GRID_POINTS, MOST_SEGMENTS, exceeds};

/// How the contacts are fitted; the words are those of the command line. Every key may be left out. Without a key that names a model palpate run tells what the contacts show, as palpate fit does.
#[derive(Default, Deserialize, JsonSchema)]
struct FitKeys {
    /// Heights over x and y, or a surface in space that may stand upright and close.
    #[schemars(with = "Option<String>", example = &"height", extend("default" = "height"))]
    #[schemars(extend("enum" = words(SurfaceKind::WORDS)))]
    surface: Option<SurfaceKind>,
    /// Directions in which a surface in space closes.
    #[schemars(with = "Option<String>", example = &"u", extend("x-left-out" = "open", "enum" = ["u", "v", "u,v"]))]
    closed: Option<Closed>,
    /// Degree of the pieces along x and y.
    #[schemars(example = 3, extend("default" = 2, "x-range" = "1 to 9, or a pair", "x-expected" = DEGREE))]
    degree: Option<OneOrPair>,
    /// Pieces along x and y.
    #[schemars(example = [2, 2], extend("default" = 1))]
    segments: Option<OneOrPair>,
    /// Points at which S and R are taken.
    #[schemars(example = [4, 4], extend("default" = 8))]
    grid: Option<OneOrPair>,
    /// Range of x and y that the surface covers, units of length.
    #[schemars(example = [-5.0, 5.0, -5.0, 5.0], extend("x-left-out" = "all contacts"))]
    #[schemars(extend("x-range" = "[x0, x1, y0, y1] in order"))]
    domain: Option<[f64; 4]>,
    /// How much heights and slopes count; not together with sigma.
    #[schemars(example = &"position", extend("default" = "tangent"))]
    #[schemars(extend("x-range" = "auto, tangent, position, equal, or [WZ, WX, WY]"))]
    weights: Option<WordOr<Vec<f64>>>,
    /// Noise of heights (units of length) and of normals (degrees).
    #[schemars(example = [0.02, 3.0], extend("x-left-out" = "weights", "x-range" = "auto, or [Z, DEG], both above 0"))]
    sigma: Option<WordOr<Vec<f64>>>,
    /// Known noise of the contacts in x and in y, units of length.
    #[schemars(example = 0.3, range(min = 0), extend("default" = 0.0))]
    sigma_xy: Option<f64>,
    /// Margin of the grid that is left out, a fraction of each side.
    #[schemars(example = 0.1, range(min = 0), extend("exclusiveMaximum" = 0.5, "default" = 0.0))]
    #[schemars(extend("x-range" = "0 to below 0.5"))]
    inset: Option<f64>,
    /// How much bending costs.
    #[schemars(example = &"auto", extend("default" = "none", "x-range" = "none, auto, or lambda, 0 or above"))]
    #[schemars(extend("x-expected" = "a string is needed"))]
    smooth: Option<WordOr<f64>>,
    /// How the equations are solved.
    #[schemars(with = "Option<String>", example = &"qr", extend("default" = "auto", "enum" = words(Method::WORDS)))]
    method: Option<Method>,
    /// How contacts that do not belong are treated.
    #[schemars(with = "Option<String>", example = &"huber", extend("default" = "none", "enum" = words(Robust::WORDS)))]
    robust: Option<Robust>,
    /// Axes of the input, or axes turned so that z points out of the patch.
    #[schemars(with = "Option<String>", example = &"auto", extend("enum" = words(FrameChoice::WORDS)))]
    #[schemars(extend("x-left-out" = "keep where that is possible"))]
    frame: Option<FrameChoice>,
    /// How often the bounds of S and R hold the truth.
    #[schemars(example = 0.99, extend("default" = 0.95, "x-range" = "above 0, below 1"))]
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    level: Option<f64>,
}

/// How often `palpate study` repeats the scene.
#[derive(Deserialize, JsonSchema)]
struct StudyKeys {
    /// Repetitions.
    #[schemars(example = 2000, range(min = 1), extend("x-left-out" = "10000, or as many as --tolerance needs"))]
    replicates: Option<u64>,
    /// How often the bounds of S and R hold a replicate.
    #[schemars(example = 0.9, extend("default" = 0.95, "x-range" = "above 0, below 1"))]
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    level: Option<f64>,
}

/// Directions that close.
#[derive(Clone, Copy, Deserialize)]
enum Closed {
    #[serde(rename = "u")]
    U,
    #[serde(rename = "v")]
    V,
    #[serde(rename = "u,v")]
    Both,
}

/// One whole number for both directions, or two.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(extend("x-range" = "a whole number, 1 or above, or a pair"))]
#[schemars(extend("x-expected" = COUNT))]
enum OneOrPair {
    One(u64),
    Pair([u64; 2]),
}

/// A word, or numbers in place of it.
#[derive(Clone, Deserialize, JsonSchema)]
#[serde(untagged)]
enum WordOr<T> {
    Word(String),
    Else(T),
}

keys! { FitKeys => FitKeys, StudyKeys => StudyKeys }

fn words<T>(words: &[(&'static str, T)]) -> Vec<&'static str> {
    words.iter().map(|(word, _)| *word).collect()
}

/// The fit and the study for the manual.
pub(super) fn entries() -> [Entry; 2] {
    [Entry::of::<FitKeys>("fit", "fit"), Entry::of::<StudyKeys>("fit", "study")]
}

pub(super) fn read_study(section: Section) -> Result<StudyOptions, SceneFileError> {
    let StudyKeys { replicates, level } = section.read::<StudyKeys>()?;
    let mut study = StudyOptions::default();
    study.replicates_given = replicates.is_some();
    study.replicates = replicates.unwrap_or(study.replicates);
    study.level = checked_level(&section, level)?.unwrap_or(study.level);
    section.finish("key")?;
    Ok(study)
}

impl FitKeys {
    /// Whether a model is named, by the rule of the command line: another loss, grid, inset or level, known errors of place and other
    /// axes change no surface.
    fn names_a_model(&self) -> bool {
        self.surface.is_some()
            || self.closed.is_some()
            || self.degree.is_some()
            || self.segments.is_some()
            || self.domain.is_some()
            || self.weights.is_some()
            || self.sigma.is_some()
            || self.smooth.is_some()
            || self.method.is_some()
    }
}

/// Options of a scene, and whether they name a model: those of a fit, but `tangent` weights when neither weights nor sigma
/// stand there.
pub(super) fn read(section: Option<Section>) -> Result<(FitOptions, bool), SceneFileError> {
    let mut fit = FitOptions { objective: Objective::Slopes(SlopeWeights::Tangent), ..FitOptions::default() };
    let Some(section) = section else { return Ok((fit, false)) };
    let keys = section.read::<FitKeys>()?;
    let named = keys.names_a_model();
    fit.surface = keys.surface.unwrap_or_default();
    fit.closed = keys.closed.map_or([false; 2], |way| [!matches!(way, Closed::V), !matches!(way, Closed::U)]);
    if fit.surface == SurfaceKind::Parametric {
        fit.degree = [3, 3];
    }
    fit.degree = pair(&section, "degree", keys.degree, MAX_DEGREE as u64)?.unwrap_or(fit.degree);
    if let Some(segments) = pair(&section, "segments", keys.segments, u64::from(u32::MAX))? {
        fit.segments = held(&section, "segments", segments, MOST_SEGMENTS)?;
    }
    if let Some(grid) = pair(&section, "grid", keys.grid, u64::from(u32::MAX))? {
        fit.grid = held(&section, "grid", grid, MOST_GRID_POINTS)?;
    }
    fit.domain = checked(&section, "domain", keys.domain, |[x0, x1, y0, y1]| {
        let ordered = x0 < x1 && y0 < y1 && [x0, x1, y0, y1].iter().all(|v| v.is_finite());
        ordered.then_some([x0, x1, y0, y1]).ok_or("[x0, x1, y0, y1] with x0 < x1 and y0 < y1 is needed")
    })?;
    fit.objective = objective(&section, &keys)?.unwrap_or(fit.objective);
    fit.inset = checked(&section, "inset", keys.inset, |inset| {
        (0.0..0.5).contains(&inset).then_some(inset).ok_or("a fraction from 0 to below 0.5 is needed")
    })?
    .unwrap_or(0.0);
    fit.smooth = smooth(&section, keys.smooth)?.unwrap_or_default();
    fit.method = keys.method.unwrap_or_default();
    fit.robust = keys.robust.unwrap_or_default();
    fit.sigma_xy = checked(&section, "sigma_xy", keys.sigma_xy, |sigma| {
        (sigma >= 0.0 && sigma.is_finite()).then_some(sigma).ok_or("a length of zero or more is needed")
    })?
    .unwrap_or(0.0);
    fit.frame = keys.frame;
    fit.level = checked_level(&section, keys.level)?.unwrap_or(fit.level);
    section.finish("key")?;
    Ok((fit, named))
}

/// A value that passes its check, or what the check says against it.
fn checked<T, U>(
    section: &Section,
    key: &'static str,
    value: Option<T>,
    check: impl Fn(T) -> Result<U, &'static str>,
) -> Result<Option<U>, SceneFileError> {
    let refused = |expected| match section.get(key) {
        Some(written) => section.value_error(key, written, expected),
        None => section.missing(key, expected),
    };
    value.map(check).transpose().map_err(refused)
}

fn checked_level(section: &Section, level: Option<f64>) -> Result<Option<f64>, SceneFileError> {
    let inside = |level| level > 0.0 && level < 1.0;
    checked(section, "level", level, |level| {
        inside(level).then_some(level).ok_or("a level between 0 and 1, as 0.95, is needed")
    })
}

fn pair(
    section: &Section,
    key: &'static str,
    given: Option<OneOrPair>,
    most: u64,
) -> Result<Option<[usize; 2]>, SceneFileError> {
    checked(section, key, given, |given| {
        let pair = match given {
            OneOrPair::One(both) => [both; 2],
            OneOrPair::Pair(pair) => pair,
        };
        let inside = pair.iter().all(|n| (1..=most).contains(n));
        inside.then_some(pair.map(|n| n as usize)).ok_or(if key == "degree" { DEGREE } else { COUNT })
    })
}

const DEGREE: &str = "a whole number from 1 to 9, or a pair of them, is needed";
const COUNT: &str = "a whole number of at least 1, or a pair of them, is needed";

/// A pair whose product is not too large to be meant.
fn held(section: &Section, key: &'static str, pair: [usize; 2], most: usize) -> Result<[usize; 2], SceneFileError> {
    match section.get(key) {
        Some(value) if exceeds(pair, most) => {
            Err(section.value_error(key, value, format!("both directions multiplied may make {most} at most")))
        }
        _ => Ok(pair),
    }
}

fn objective(section: &Section, keys: &FitKeys) -> Result<Option<Objective>, SceneFileError> {
    match (keys.weights.clone(), keys.sigma.clone()) {
        (None, None) => Ok(None),
        (Some(_), Some(_)) => Err(section.clash("weights", "sigma")),
        (Some(WordOr::Word(word)), _) => chosen(section, "weights", &word, SlopeWeights::WORDS, Objective::Slopes),
        (Some(WordOr::Else(weights)), _) => checked(section, "weights", Some(weights), |weights| {
            let weights = SlopeWeights::explicit(weights.try_into().map_err(|_| "3 numbers are needed")?);
            weights.map(Objective::Slopes).ok_or("three weights of zero or more, not all zero, are needed")
        }),
        (_, Some(WordOr::Word(word))) => chosen(section, "sigma", &word, NormalSigma::WORDS, Objective::Normals),
        (_, Some(WordOr::Else(sigma))) => checked(section, "sigma", Some(sigma), |sigma| {
            let [z, normal_deg] = sigma.try_into().map_err(|_| "2 numbers are needed")?;
            let known = NormalSigma::known(z, normal_deg).map(Objective::Normals);
            known.ok_or("\"auto\" or [Z, DEG], both greater than zero, is needed")
        }),
    }
}

fn smooth(section: &Section, given: Option<WordOr<f64>>) -> Result<Option<Smooth>, SceneFileError> {
    match given {
        None => Ok(None),
        Some(WordOr::Word(word)) => match word.parse() {
            Ok(smooth @ (Smooth::Third(_) | Smooth::Stretched { .. })) => Ok(Some(smooth)),
            _ => chosen(section, "smooth", &word, Smooth::WORDS, |smooth| smooth),
        },
        Some(WordOr::Else(lambda)) => checked(section, "smooth", Some(lambda), |lambda| {
            Smooth::lambda(lambda).ok_or("a lambda of zero or more is needed")
        }),
    }
}

/// What a word of these stands for.
fn chosen<T: Copy, U>(
    section: &Section,
    key: &'static str,
    word: &str,
    words: &[(&'static str, T)],
    meaning: impl Fn(T) -> U,
) -> Result<Option<U>, SceneFileError> {
    match (words.iter().find(|(known, _)| *known == word), section.get(key)) {
        (None, Some(value)) => {
            let known: Vec<&str> = words.iter().map(|(known, _)| *known).collect();
            Err(section.unknown_word(&format!("value of {}", section.full(key)), value, word, &known))
        }
        (found, _) => Ok(found.map(|(_, value)| meaning(*value))),
    }
}
