//! Keywords of a fit, the same words as on the command line, as the crate's options.
//!
//! ```text
//! fit(x, y, z, degree=(2, 3), sigma=(0.02, 5))      a keyword that is None says nothing
//! any keyword that fixes the model                  named: exactly that fit; otherwise the contacts are recognised
//! ```

use palpate::cli::embedded::{AskedSurface, TunedOption};
use palpate::fit::{
    FitOptions, FrameChoice, Method, NormalSigma, Objective, Robust, SlopeWeights, Smooth, SurfaceKind,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use super::arrays::Numbers;

/// Most segments and most grid points, those of the command line: more is a typing error that would take gigabytes.
const MOST_SEGMENTS: usize = 512 * 512;
const MOST_GRID_POINTS: usize = 2000 * 2000;

/// What the keywords say.
pub(crate) struct Keywords {
    pub(crate) options: FitOptions,
    /// Something fixes the model.
    pub(crate) named: bool,
    /// Small cells where the contacts ask for them, and numbers that decide about them.
    adaptive: bool,
    tuned: Vec<TunedOption>,
    /// Degrees and grid points that were given.
    given: [Option<[usize; 2]>; 2],
    pub(crate) viewpoint: Option<[f64; 3]>,
    pub(crate) bare: bool,
}

/// Keywords that change no surface, and so name no model.
const NAMELESS: [&str; 8] = ["grid", "inset", "frame", "robust", "level", "viewpoint", "bare", "sigma_xy"];

impl Keywords {
    /// Reads the keywords over `base`; an unknown one is a TypeError, as Python has it.
    pub(crate) fn read(given: Option<&Bound<'_, PyDict>>) -> PyResult<Keywords> {
        let mut found = Keywords {
            options: FitOptions::default(),
            named: false,
            adaptive: false,
            tuned: Vec::new(),
            given: [None; 2],
            viewpoint: None,
            bare: false,
        };
        let Some(given) = given else { return Ok(found) };
        // a parametric surface is of degree 3 unless a degree is named: a biquadratic bends too little to go round
        for (key, value) in given.iter() {
            if value.is_none() {
                continue;
            }
            let key = key.cast::<PyString>()?.to_str()?.to_owned();
            found.named |= !NAMELESS.contains(&key.as_str());
            found.take(&key, &value)?;
        }
        let options = &mut found.options;
        if options.surface == SurfaceKind::Parametric && found.given[0].is_none() {
            options.degree = options.degree.map(|p| p.max(3));
        }
        found.check_adaptive(given)?;
        if found.bare && !found.named {
            return Err(PyValueError::new_err(
                "bare: a recognition's intervals and probabilities are its answer; name a model beside it, as degree=2",
            ));
        }
        Ok(found)
    }

    /// An adaptive surface takes few of the other keywords.
    fn check_adaptive(&self, given: &Bound<'_, PyDict>) -> PyResult<()> {
        if !self.adaptive {
            return Ok(());
        }
        for key in
            ["surface", "closed", "segments", "knots", "weights", "method", "smooth", "robust", "frame", "sigma_xy"]
        {
            if given.get_item(key)?.is_some_and(|value| !value.is_none()) {
                return Err(PyValueError::new_err(format!(
                    "{key}: means nothing for an adaptive surface; leave it out"
                )));
            }
        }
        Ok(())
    }

    /// Degrees and grid points that were given.
    pub(crate) fn given(&self) -> [Option<[usize; 2]>; 2] {
        self.given
    }

    /// Numbers that decide about an adaptive surface.
    pub(crate) fn tuned(&self) -> Vec<TunedOption> {
        self.tuned.clone()
    }

    /// Which surface the keywords ask for.
    pub(crate) fn asked(&self) -> AskedSurface {
        match (self.adaptive, self.named) {
            (true, _) => {
                AskedSurface::Adaptive { degree: self.given[0], grid: self.given[1], tuned: self.tuned.clone() }
            }
            (false, true) => AskedSurface::Spline,
            (false, false) => AskedSurface::Recognised,
        }
    }

    fn take(&mut self, key: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let options = &mut self.options;
        match key {
            "surface" => options.surface = word::<SurfaceKind>(value, "surface")?,
            "closed" => options.closed = closed(value)?,
            "adaptive" => (self.adaptive, self.tuned) = (value.is_truthy()?, tuned(value)?),
            "degree" => {
                options.degree = pair(value, "degree", 9)?;
                self.given[0] = Some(options.degree);
            }
            "segments" => {
                options.segments = pair(value, "segments", MOST_SEGMENTS)?;
                within(options.segments, MOST_SEGMENTS, "segments")?;
            }
            "knots" => options.knots = Some(super::arrays::columns(value, "knots", ["knots[0]", "knots[1]"])?),
            "domain" => options.domain = Some(numbers::<4>(value, "domain")?),
            "weights" => options.objective = Objective::Slopes(weights(value)?),
            "sigma" => options.objective = Objective::Normals(sigma(value)?),
            "method" => options.method = word::<Method>(value, "method")?,
            "smooth" => options.smooth = smooth(value)?,
            "sigma_xy" => options.sigma_xy = number(value, "sigma_xy")?,
            "robust" => options.robust = word::<Robust>(value, "robust")?,
            "grid" => {
                options.grid = grid_points(value)?;
                self.given[1] = Some(options.grid);
            }
            "inset" => options.inset = number(value, "inset")?,
            "level" => options.level = number(value, "level")?,
            "frame" => {
                let frame = word::<FrameChoice>(value, "frame")?;
                options.frame = Some(frame);
            }
            "viewpoint" => self.viewpoint = Some(numbers::<3>(value, "viewpoint")?),
            "bare" => self.bare = value.is_truthy()?,
            other => return Err(PyTypeError::new_err(format!("fit() got an unexpected keyword argument '{other}'"))),
        }
        Ok(())
    }
}

/// Names and numbers of an adaptive surface's options, where a dict of them stands for `True`.
fn tuned(value: &Bound<'_, PyAny>) -> PyResult<Vec<TunedOption>> {
    let Ok(given) = value.cast::<PyDict>() else { return Ok(Vec::new()) };
    let wrong = || PyTypeError::new_err("adaptive: True, or a dict of names and numbers, wanted");
    let option = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let name = name.extract::<String>().map_err(|_| wrong())?;
        Ok(TunedOption { name, value: value.extract::<f64>().map_err(|_| wrong())? })
    };
    given.iter().map(option).collect()
}

/// A word of the command line.
fn word<T: std::str::FromStr<Err: std::fmt::Display>>(value: &Bound<'_, PyAny>, name: &str) -> PyResult<T> {
    let text = value.cast::<PyString>().map_err(|_| PyTypeError::new_err(format!("{name}: a word wanted")))?;
    let text = text.to_cow()?;
    text.parse().map_err(|expected: T::Err| PyValueError::new_err(format!("{name} is {text:?}: {expected}")))
}

/// One whole number for both directions, or two.
pub(crate) fn pair(value: &Bound<'_, PyAny>, name: &str, most: usize) -> PyResult<[usize; 2]> {
    let wrong = || PyValueError::new_err(format!("{name}: a whole number from 1 to {most}, or a pair of them, wanted"));
    let both = match value.extract::<i64>() {
        Ok(one) => [one, one],
        Err(_) => value.extract::<[i64; 2]>().map_err(|_| wrong())?,
    };
    let whole = both.map(|n| usize::try_from(n).ok().filter(|n| (1..=most).contains(n)));
    whole[0].zip(whole[1]).map(|(a, b)| [a, b]).ok_or_else(wrong)
}

/// Points of a shape grid in both directions.
pub(crate) fn grid_points(value: &Bound<'_, PyAny>) -> PyResult<[usize; 2]> {
    let points = pair(value, "grid", MOST_GRID_POINTS)?;
    within(points, MOST_GRID_POINTS, "grid")?;
    Ok(points)
}

fn within([n, m]: [usize; 2], most: usize, name: &str) -> PyResult<()> {
    if n.checked_mul(m).is_some_and(|product| product <= most) {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("{name}: {n} x {m} is more than {most}")))
}

fn number(value: &Bound<'_, PyAny>, name: &str) -> PyResult<f64> {
    value.extract().map_err(|_| PyTypeError::new_err(format!("{name}: a number wanted")))
}

/// Exactly `N` finite numbers.
pub(crate) fn numbers<const N: usize>(value: &Bound<'_, PyAny>, name: &'static str) -> PyResult<[f64; N]> {
    let column = Numbers::of(value, name)?.column()?;
    let array: Option<[f64; N]> = column.try_into().ok();
    array
        .filter(|array| array.iter().all(|v| v.is_finite()))
        .ok_or_else(|| PyValueError::new_err(format!("{name}: {N} finite numbers wanted")))
}

fn is_text(value: &Bound<'_, PyAny>) -> bool {
    value.is_instance_of::<PyString>()
}

fn weights(value: &Bound<'_, PyAny>) -> PyResult<SlopeWeights> {
    if is_text(value) {
        return word(value, "weights");
    }
    let explicit = SlopeWeights::explicit(numbers::<3>(value, "weights")?);
    explicit.ok_or_else(|| PyValueError::new_err("weights: three numbers, none negative and one at least above zero"))
}

fn sigma(value: &Bound<'_, PyAny>) -> PyResult<NormalSigma> {
    if is_text(value) {
        return word(value, "sigma");
    }
    let [z, normal_deg] = numbers::<2>(value, "sigma")?;
    let known = NormalSigma::known(z, normal_deg);
    known.ok_or_else(|| PyValueError::new_err("sigma: two numbers above zero wanted, a length and degrees"))
}

fn smooth(value: &Bound<'_, PyAny>) -> PyResult<Smooth> {
    if is_text(value) {
        return word(value, "smooth");
    }
    let lambda = Smooth::lambda(number(value, "smooth")?);
    lambda.ok_or_else(|| PyValueError::new_err("smooth: 'none', 'auto' or a number not below zero"))
}

fn closed(value: &Bound<'_, PyAny>) -> PyResult<[bool; 2]> {
    let wrong = || PyValueError::new_err("closed: 'u', 'v', 'u,v' or a pair of bools wanted");
    if let Ok(both) = value.extract::<[bool; 2]>() {
        return Ok(both);
    }
    match value.extract::<String>().map_err(|_| wrong())?.as_str() {
        "u" => Ok([true, false]),
        "v" => Ok([false, true]),
        "u,v" => Ok([true, true]),
        _ => Err(wrong()),
    }
}
