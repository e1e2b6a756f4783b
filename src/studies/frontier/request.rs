//! What is asked of a fit, and whether it can be asked.

use super::FrontierError;

/// Seconds below which the clock itself is a tenth of what it measures.
const RESOLUTION: f64 = 250e-9;

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
