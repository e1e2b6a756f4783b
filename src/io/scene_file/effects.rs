//! `[effects.NAME]`: one reader an effect, named as the effect is.

use super::SceneFileError;
use super::section::{Section, as_array, as_number};
use crate::scene::Effect;
use crate::scene::effects::*;

type Reader = fn(&Section) -> Result<Effect, SceneFileError>;

/// Every effect that a file can name.
const READERS: &[(&str, Reader)] = &[("position_noise", position_noise), ("row_noise", row_noise)];

pub(super) fn read(section: Section) -> Result<Vec<Effect>, SceneFileError> {
    let mut effects = Vec::new();
    for (name, reader) in READERS {
        if let Some(own) = section.section(name)? {
            effects.push(reader(&own)?);
            own.finish("key")?;
        }
    }
    section.finish("effect")?;
    Ok(effects)
}

fn row_noise(section: &Section) -> Result<Effect, SceneFileError> {
    let sigma_z = section.number_or("sigma_z", 0.0)?;
    let sigma_slope = section.number_or("sigma_slope", 0.0)?;
    Ok(RowNoise { sigma_z, sigma_slope }.into())
}

fn position_noise(section: &Section) -> Result<Effect, SceneFileError> {
    let sigma = section.one_or_three("sigma")?;
    let covariance = covariance(section)?;
    match (sigma, covariance) {
        (Some(_), Some(_)) => Err(section.clash("sigma", "covariance")),
        (Some(sigma), None) => Ok(PositionNoise::Sigma(sigma).into()),
        (None, Some(covariance)) => Ok(PositionNoise::Covariance(covariance).into()),
        (None, None) => Err(section.missing("sigma", "a number, three, or a covariance is needed")),
    }
}

fn covariance(section: &Section) -> Result<Option<[[f64; 3]; 3]>, SceneFileError> {
    let Some(value) = section.get("covariance") else { return Ok(None) };
    let row = |row: &super::section::Value| -> Option<[f64; 3]> {
        as_array(row)?.iter().map(as_number).collect::<Option<Vec<f64>>>()?.try_into().ok()
    };
    let rows = as_array(value).and_then(|rows| rows.iter().map(row).collect::<Option<Vec<_>>>());
    match rows.and_then(|rows| rows.try_into().ok()) {
        Some(matrix) => Ok(Some(matrix)),
        None => Err(section.value_error("covariance", value, "three rows of three numbers are needed")),
    }
}
