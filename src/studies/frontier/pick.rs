//! The cheapest configuration that meets a request, or the most accurate within a budget.
//!
//! ```text
//! meets      in 95 of 100 fresh replicates, with 95 % confidence:   error_S <= asked and error_R <= asked, both at once (`kept`)
//!            and time_hi * SPARE <= budget
//! errors only      the least time among those that meet            budget      the least error among those within it
//! nothing meets    the nearest: the least of the largest ratio found/asked
//! ```
//!
//! Of ways that are alike the simplest is taken, so that no noise of the clock decides. Few replicates widen what is said to be kept, and
//! too few meet no request for an error.

use palpate_fitting::fit::FitOptions;
use palpate_world::scene::World;

use super::FrontierError;
use super::contenders::{SPARE, error_ratio, time_ratio};
use super::discretisation::Subject;
use super::kept::LEAST_REPLICATES;
use super::measured::Measured;
use super::preference::Preference;
use super::request::Request;

/// Times and errors that differ by less are alike: the simplest way among them is taken.
const ALIKE: f64 = 1.08;
/// Seconds that a request may take to be answered.
const SECONDS: f64 = 20.0;

/// The answer to a [`Request`].
#[derive(Clone, Debug)]
pub struct Choice {
    /// The options of the fit.
    pub options: FitOptions,
    /// Stations of each finger, where others than the scene's were chosen.
    pub stations: Option<usize>,
    /// No model is to be named: the contacts are recognised. `options` then say where S and R are wanted.
    pub recognised: bool,
    /// The configuration in words.
    pub label: String,
    /// Errors of S and R that at most 5 of 100 fresh replicates exceed; NaN where there is none, or where too few were judged.
    pub errors: [f64; 2],
    /// Replicates that the errors rest on; 1 where nothing is random.
    pub replicates: u64,
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
        let subject = Subject::new(world, own, seed, !self.keep_stations)?.bare().asked(Some(self));
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
    let sound: Vec<usize> = (0..measured.len()).filter(|k| measured[*k].point.failed.is_none()).collect();
    let time = |k: &usize| measured[*k].point.seconds.map_or(f64::INFINITY, |time| time.median);
    let ratios: Vec<[f64; 2]> =
        measured.iter().map(|m| [error_ratio(m, request).unwrap_or(f64::INFINITY), time_ratio(m, request)]).collect();
    let meets: Vec<usize> = sound.iter().copied().filter(|k| ratios[*k].iter().all(|ratio| *ratio <= 1.0)).collect();
    let of_these = if request.error_s.is_none() && request.error_r.is_none() {
        let error = |k: &usize| measured[*k].point.error.unwrap_or(f64::INFINITY);
        let least = meets.iter().map(error).fold(f64::INFINITY, f64::min);
        meets.into_iter().filter(|k| error(k) <= ALIKE * least).collect()
    } else {
        meets
    };
    if let Some(best) = Preference::new(measured).taken(&of_these, ALIKE) {
        return Ok(choice(&measured[best], true, None));
    }
    let worst = |k: &usize| ratios[*k].into_iter().fold(0.0, f64::max);
    let nearest = sound.iter().min_by(|a, b| worst(a).total_cmp(&worst(b)).then(time(a).total_cmp(&time(b))));
    let Some(nearest) = nearest else {
        let why = measured.first().and_then(|m| m.point.failed.clone()).unwrap_or_default();
        return Err(FrontierError::Nothing { why });
    };
    let sound: Vec<&Measured> = sound.iter().map(|k| &measured[*k]).collect();
    let nearest = &measured[*nearest];
    Ok(choice(nearest, false, Some(obstacle(&sound, nearest, request))))
}

fn choice(m: &Measured, met: bool, obstacle: Option<String>) -> Choice {
    Choice {
        options: m.configuration.options.clone(),
        stations: m.configuration.stations,
        recognised: m.configuration.recognised,
        label: m.point.label.clone(),
        errors: [0, 1].map(|q| m.point.errors[q].and_then(|errors| errors.upper).unwrap_or(f64::NAN)),
        replicates: m.point.replicates,
        seconds: m.point.seconds.map_or(f64::NAN, |time| time.median),
        met,
        obstacle,
    }
}

/// What stands in the way: the budget, the noise, the surface's own form, or too few data.
fn obstacle(sound: &[&Measured], nearest: &Measured, request: &Request) -> String {
    if sound.iter().all(|m| error_ratio(m, request).is_none()) {
        let most = sound.iter().map(|m| m.runs.len()).max().unwrap_or(0);
        return format!(
            "time: {most} runs of a way were judged, and fewer than {LEAST_REPLICATES} promise nothing; more seconds are needed"
        );
    }
    let accurate = sound.iter().filter(|m| error_ratio(m, request).is_some_and(|ratio| ratio <= 1.0));
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
        let Some(kept) = errors.upper else {
            return format!("noise: it alone moves the mean {name} by {:.2e}", errors.sd);
        };
        let times = (kept / asked).powi(2);
        return format!(
            "noise: it alone moves the mean {name} by {:.2e}, and {kept:.2e} is the least error that is kept; \
             some {times:.0} times as many contacts would be needed",
            errors.sd
        );
    }
    let points = nearest.point.contacts;
    format!(
        "the surface's own form: {points} contacts leave an error of {name} of {:.2e} without noise; a higher degree or more segments than were tried need more contacts",
        errors.rms
    )
}
