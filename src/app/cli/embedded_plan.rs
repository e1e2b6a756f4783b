//! Adaptive fits of places that are measured again and again: the first one, and a plan for new heights.
//!
//! ```text
//! contacts -> FitAnswer, RepeatedPlaces        RepeatedPlaces, heights -> spline, noise
//! ```

use std::time::Instant;

use super::adaptive_model::{GRID, TypedForAdaptive, adaptive_found, adaptive_options, refused};
use super::embedded_fits::{FitAnswer, FitRefusal};
use super::tuned::TunedOption;
use crate::io::tensor;
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::Contacts;
use palpate_geometry::surface::HeightField;
use palpate_hierarchical::adaptive::{AdaptivePlan, plan_adaptive};

/// The cells, weights and factor of a first measurement.
#[derive(Debug)]
pub struct RepeatedPlaces {
    plan: AdaptivePlan,
}

impl RepeatedPlaces {
    /// Fits the first measurement, and keeps what others at the same places need.
    ///
    /// # Errors
    /// Those of an adaptive fit; contacts with normals.
    pub fn new(
        contacts: &Contacts,
        [degree, grid]: [Option<[usize; 2]>; 2],
        tuned: Vec<TunedOption>,
        options: &FitOptions,
        bare: bool,
    ) -> Result<(FitAnswer, RepeatedPlaces), FitRefusal> {
        let clock = Instant::now();
        options.check().map_err(FitRefusal::Fit)?;
        let asked =
            adaptive_options(&TypedForAdaptive { degree, grid, tuned }, options, bare).map_err(FitRefusal::Fit)?;
        let wrong = |error| FitRefusal::from(refused(error, contacts.len(), options));
        let (fit, plan) = plan_adaptive(contacts, &asked).map_err(wrong)?;
        let found = adaptive_found(fit, contacts, options, grid.unwrap_or(GRID));
        let answer = FitAnswer::without_contacts(found, bare, clock.elapsed().as_secs_f64());
        Ok((answer, RepeatedPlaces { plan }))
    }

    /// The spline through other heights at the same places, and the noise of one of them; slopes where the first contacts had some.
    ///
    /// # Errors
    /// Columns of another length, numbers that are not finite, slopes that are missing or have no place; a surface of so small cells that
    /// it is too large for one spline.
    pub fn fit(&mut self, heights: &[f64], slopes: Option<[&[f64]; 2]>) -> Result<(HeightField, f64), String> {
        let repeated = self.plan.fit(heights, slopes).map_err(|error| error.to_string())?;
        let field = repeated.input_field().map_err(|error| error.to_string())?;
        Ok((tensor(&field)?, repeated.height_noise))
    }
}
