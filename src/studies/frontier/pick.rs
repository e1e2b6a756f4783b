//! The cheapest configuration that meets a request, or the most accurate within a budget.
//!
//! ```text
//! meets      in 95 of 100 fresh replicates, with 95 % confidence:   error_S <= asked and error_R <= asked, both at once
//!            and time_hi * SPARE <= budget
//! errors only      the least time among those that meet            budget      the least error among those within it
//! nothing meets    the nearest: the least of the largest ratio found/asked
//! ```

use palpate_fitting::fit::FitOptions;
use palpate_world::scene::World;

use super::FrontierError;
use super::clock::Clocked;
use super::discretisation::{Measured, Subject};
use super::errors::upper;

/// A budget is met with so much to spare: between two runs clocks drift by some per cent.
const SPARE: f64 = 1.1;
/// Seconds below which the clock itself is a tenth of what it measures.
const RESOLUTION: f64 = 250e-9;
/// Seconds that a request may take to be answered.
const SECONDS: f64 = 20.0;

/// What is asked of a fit: errors that it keeps, a time that it keeps, or both.
///
/// Errors are root mean squares over the shape grid, those that `palpate run` prints as `truth`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Largest error of S.
    pub error_s: Option<f64>,
    /// Largest error of R, 1/length.
    pub error_r: Option<f64>,
    /// Most seconds for a fit with S and R.
    pub budget: Option<f64>,
    /// The scene's stations stay as they are; otherwise half and twice as many are tried too.
    pub keep_stations: bool,
}

impl Request {
    /// With this as the largest error of S.
    pub fn with_error_s(mut self, error: f64) -> Request {
        self.error_s = Some(error);
        self
    }

    /// With this as the largest error of R, 1/length.
    pub fn with_error_r(mut self, error: f64) -> Request {
        self.error_r = Some(error);
        self
    }

    /// With this many seconds as the most for a fit with S and R.
    pub fn with_budget(mut self, seconds: f64) -> Request {
        self.budget = Some(seconds);
        self
    }

    /// With the scene's stations kept, or varied.
    pub fn with_stations_kept(mut self, kept: bool) -> Request {
        self.keep_stations = kept;
        self
    }

    /// Checks the numbers themselves.
    ///
    /// # Errors
    /// [`FrontierError::Request`] and [`FrontierError::Empty`].
    pub fn check(&self) -> Result<(), FrontierError> {
        for (what, error) in [("error_s", self.error_s), ("error_r", self.error_r)] {
            if let Some(value) = error.filter(|value| !(value.is_finite() && *value > 0.0)) {
                let expected = "a number greater than 0".into();
                return Err(FrontierError::Request { what, value: value.to_string(), expected });
            }
        }
        if let Some(value) = self.budget.filter(|value| !(value.is_finite() && *value >= RESOLUTION)) {
            let least = RESOLUTION * 1e9;
            let expected = format!("at least {least} ns are needed, below which the clock cannot tell times apart");
            return Err(FrontierError::Request { what: "budget", value: format!("{value} s"), expected });
        }
        if self.error_s.is_none() && self.error_r.is_none() && self.budget.is_none() {
            return Err(FrontierError::Empty);
        }
        Ok(())
    }
}

/// The answer to a [`Request`].
#[derive(Clone, Debug)]
pub struct Choice {
    /// The options of the fit.
    pub options: FitOptions,
    /// Stations of each finger, where others than the scene's were chosen.
    pub stations: Option<usize>,
    /// The configuration in words.
    pub label: String,
    /// Errors of S and R that at most 5 of 100 fresh replicates exceed; NaN where there is none.
    pub errors: [f64; 2],
    /// Median seconds of a fit with S and R.
    pub seconds: f64,
    /// Whether it meets the request. Otherwise it is the nearest there is.
    pub met: bool,
    /// What stands in the way of a request that nothing meets.
    pub obstacle: Option<String>,
}

impl Request {
    /// Measures the ways of fitting a scene on this machine, and picks one.
    ///
    /// ```
    /// # use palpate_studies::facade as palpate;
    /// use palpate::FitOptions;
    /// use palpate::frontier::Request;
    /// use palpate::scene::{Surface, Sweep, World};
    ///
    /// // a ball of radius 10 under three fingers
    /// let surface = Surface::sphere(10.0);
    /// let sweep = Sweep::new(vec![-2.0, 0.0, 2.0], vec![-2.0, -1.0, 0.0, 1.0, 2.0]);
    /// let world = World { surface, sweeps: vec![sweep], effects: vec![], laws: vec![] };
    /// let request = Request::default().with_error_s(0.01).with_stations_kept(true);
    /// let choice = request.pick(&world, &FitOptions::default().with_grid(4, 4), 1997)?;
    /// assert!(choice.met && choice.errors[0] <= 0.01);
    /// # Ok::<(), palpate::frontier::FrontierError>(())
    /// ```
    ///
    /// # Errors
    /// A scene that cannot be simulated, or a request that cannot be understood.
    pub fn pick(&self, world: &World, own: &FitOptions, seed: u64) -> Result<Choice, FrontierError> {
        self.check()?;
        let subject = Subject::new(world, own, seed, !self.keep_stations)?.bare();
        check_truth(&subject, self)?;
        choose(&subject.measure(SECONDS, &|_, _| true), self)
    }
}

/// Refuses errors of what the truth does not have.
pub fn check_truth(subject: &Subject, request: &Request) -> Result<(), FrontierError> {
    if request.error_s.is_some() && !subject.defined()[0] {
        let possible = "a plane has no shape index; an error of R or a budget can be asked for";
        return Err(FrontierError::Truth { quantity: "S", possible });
    }
    Ok(())
}

/// Picks from what was measured.
///
/// # Errors
/// [`FrontierError::Nothing`] where every way of fitting failed.
pub fn choose(measured: &[Measured], request: &Request) -> Result<Choice, FrontierError> {
    let sound: Vec<&Measured> = measured.iter().filter(|m| m.point.failed.is_none()).collect();
    let time = |m: &Measured| m.point.seconds.map_or(f64::INFINITY, |time| time.median);
    let ratios = |m: &Measured| [error_ratio(m, request), time_ratio(m, request)];
    let meets = |m: &&&Measured| ratios(m).iter().all(|ratio| *ratio <= 1.0);
    let found = sound.iter().filter(meets);
    let best = if request.error_s.is_none() && request.error_r.is_none() {
        let error = |m: &Measured| m.point.error.unwrap_or(f64::INFINITY);
        found.min_by(|a, b| error(a).total_cmp(&error(b)).then(time(a).total_cmp(&time(b))))
    } else {
        found.min_by(|a, b| time(a).total_cmp(&time(b)))
    };
    if let Some(best) = best {
        return Ok(choice(best, true, None));
    }
    let worst = |m: &Measured| ratios(m).into_iter().fold(0.0, f64::max);
    let nearest = sound.iter().min_by(|a, b| worst(a).total_cmp(&worst(b)).then(time(a).total_cmp(&time(b))));
    let Some(nearest) = nearest else {
        let why = measured.first().and_then(|m| m.point.failed.clone()).unwrap_or_default();
        return Err(FrontierError::Nothing { why });
    };
    Ok(choice(nearest, false, Some(obstacle(&sound, nearest, request))))
}

/// The errors that are kept over those that are asked for, the larger of both; 0 where none is asked for.
fn error_ratio(m: &Measured, request: &Request) -> f64 {
    let asked = [request.error_s, request.error_r];
    if asked == [None, None] {
        return 0.0;
    }
    let ratio = |run: &[f64; 2]| {
        let each = [0, 1].map(|q| asked[q].map_or(0.0, |asked| run[q] / asked));
        if each.iter().any(|ratio| ratio.is_nan()) { f64::INFINITY } else { each[0].max(each[1]) }
    };
    upper(m.runs.iter().map(ratio).collect())
}

fn time_ratio(m: &Measured, request: &Request) -> f64 {
    let hi = m.point.seconds.map_or(f64::INFINITY, |time: Clocked| time.hi);
    request.budget.map_or(0.0, |budget| SPARE * hi / budget)
}

fn choice(m: &Measured, met: bool, obstacle: Option<String>) -> Choice {
    Choice {
        options: m.configuration.options.clone(),
        stations: m.configuration.stations,
        label: m.point.label.clone(),
        errors: [0, 1].map(|q| m.point.errors[q].map_or(f64::NAN, |errors| errors.upper)),
        seconds: m.point.seconds.map_or(f64::NAN, |time| time.median),
        met,
        obstacle,
    }
}

/// What stands in the way: the budget, the noise, the surface's own form, or too few data.
fn obstacle(sound: &[&Measured], nearest: &Measured, request: &Request) -> String {
    let accurate = sound.iter().filter(|m| error_ratio(m, request) <= 1.0);
    let hi = |m: &Measured| m.point.seconds.map_or(f64::INFINITY, |time| time.hi);
    if let Some(cheapest) = accurate.min_by(|a, b| hi(a).total_cmp(&hi(b))) {
        let (needed, label) = (1e6 * SPARE * hi(cheapest), &cheapest.point.label);
        return format!(
            "the budget: the errors asked for take {needed:.1} us ({label}); with less time they are larger"
        );
    }
    if sound.iter().all(|m| time_ratio(m, request) > 1.0) {
        let least = sound.iter().map(|m| 1e6 * SPARE * hi(m)).fold(f64::INFINITY, f64::min);
        return format!("the budget: no way of fitting takes less than {least:.1} us here");
    }
    let quantity = if request.error_s.is_some() { 0 } else { 1 };
    let name = ["S", "R"][quantity];
    let Some(errors) = nearest.point.errors[quantity] else {
        return format!("data: {name} is undefined in some replicates, which cannot be told from a plane");
    };
    if errors.sd > errors.bias.abs() && errors.sd > 0.0 {
        let asked = [request.error_s, request.error_r][quantity].unwrap_or(errors.rms);
        let times = (errors.upper / asked).powi(2);
        return format!(
            "noise: it alone moves the mean {name} by {:.2e}; some {times:.0} times as many contacts would be needed",
            errors.sd
        );
    }
    let points = nearest.point.contacts;
    format!(
        "the surface's own form: {points} contacts leave an error of {name} of {:.2e} without noise; a higher degree or more segments than were tried need more contacts",
        errors.rms
    )
}
