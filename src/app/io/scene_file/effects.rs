//! `[effects.NAME]`: one reader an effect, named as the effect is.

use super::SceneFileError;
use super::section::{Section, as_array, as_number};
use palpate_numeric::draws::NoiseLaw;
use palpate_world::scene::Effect;
use palpate_world::scene::effects::*;
use toml::de::DeValue;

type Reader = fn(&Section) -> Result<Effect, SceneFileError>;

/// Every effect that a file can name.
const READERS: &[(&str, Reader)] = &[
    ("tip_radius_error", tip_radius_error),
    ("indentation", indentation),
    ("friction", friction),
    ("force_noise", force_noise),
    ("position_noise", position_noise),
    ("normal_noise", normal_noise),
    ("slope_gain", slope_gain),
    ("encoder", encoder),
    ("misalignment", misalignment),
    ("latency", latency),
    ("finger_noise", finger_noise),
    // the name that finger_noise had first
    ("lane_noise", finger_noise),
    ("slip", slip),
    ("dropout", dropout),
    ("row_noise", row_noise),
];

/// Effects, and the laws of those whose errors are not normal.
pub(super) type Effects = (Vec<Effect>, Vec<(&'static str, NoiseLaw)>);

pub(super) fn read(section: Section) -> Result<Effects, SceneFileError> {
    let (mut effects, mut laws) = (Vec::new(), Vec::new());
    for (name, reader) in READERS {
        if let Some(own) = section.section(name)? {
            effects.push(reader(&own)?);
            if let Some(law) = law(&own)? {
                laws.push((*name, law));
            }
            own.finish("key")?;
        }
    }
    section.finish("effect")?;
    Ok((effects, laws))
}

/// `distribution`, and `dof` where it is Student's.
fn law(section: &Section) -> Result<Option<NoiseLaw>, SceneFileError> {
    let Some((word, value)) = section.word("distribution")? else { return Ok(None) };
    let law = match word {
        "normal" => NoiseLaw::Normal,
        "uniform" => NoiseLaw::Uniform,
        "laplace" => NoiseLaw::Laplace,
        "triangular" => NoiseLaw::Triangular,
        "student_t" => {
            let dof = section.number_or("dof", 5.0)?;
            if let (Some(value), false) = (section.get("dof"), dof > 2.0 && dof.is_finite()) {
                return Err(section.value_error("dof", value, "more than 2 degrees of freedom are needed for an sd"));
            }
            NoiseLaw::StudentT { dof }
        }
        other => return Err(section.unknown_word("distribution", value, other, &NoiseLaw::NAMES)),
    };
    Ok(Some(law))
}

fn tip_radius_error(section: &Section) -> Result<Effect, SceneFileError> {
    let error = section.required("error", "the believed less the true radius is needed")?;
    Ok(TipRadiusError { error }.into())
}

fn indentation(section: &Section) -> Result<Effect, SceneFileError> {
    let modulus = section.required("modulus", "the contact modulus E*, force per length squared, is needed")?;
    let threshold = section.required("threshold", "the force that triggers a reading is needed")?;
    let overshoot = section.number_or("overshoot", 0.0)?;
    Ok(Indentation { modulus, threshold, overshoot }.into())
}

fn friction(section: &Section) -> Result<Effect, SceneFileError> {
    let mu = section.required("mu", "the coefficient of friction is needed")?;
    let sigma = section.number_or("sigma", 0.0)?;
    Ok(Friction { mu, sigma }.into())
}

fn force_noise(section: &Section) -> Result<Effect, SceneFileError> {
    let none = ForceNoise::default();
    let noise = ForceNoise {
        sigma: section.number_or("sigma", none.sigma)?,
        bias: section.one_or_three("bias")?.unwrap_or(none.bias),
        drift: section.number_or("drift", none.drift)?,
        quantum: section.number_or("quantum", none.quantum)?,
        load: section.number_or("load", none.load)?,
    };
    Ok(noise.into())
}

fn normal_noise(section: &Section) -> Result<Effect, SceneFileError> {
    let sigma_deg = section.required("sigma_deg", "the sd per tangent axis, degrees, is needed")?;
    Ok(NormalNoise { sigma_deg }.into())
}

fn slope_gain(section: &Section) -> Result<Effect, SceneFileError> {
    let relative = section.required("relative", "by how much slopes are too steep is needed: 0.3 is 30 %")?;
    Ok(SlopeGain { relative }.into())
}

fn encoder(section: &Section) -> Result<Effect, SceneFileError> {
    let resolution_deg = section.number_or("resolution_deg", 0.0)?;
    let sigma_deg = section.number_or("sigma_deg", 0.0)?;
    let base: Option<[f64; 3]> = section.several("base")?;
    let links = links(section)?;
    let arm = match (base, links) {
        (None, None) => None,
        (Some(base), Some(links)) => Some(Arm { base, links }),
        (Some(_), None) => return Err(section.missing("links", "an arm with a base needs its links too")),
        (None, Some(_)) => return Err(section.missing("base", "an arm with links needs its base too")),
    };
    Ok(Encoder { resolution_deg, sigma_deg, arm }.into())
}

/// `links = [{ a, alpha_deg, d, theta_deg }, ...]`; what is left out is zero.
fn links(section: &Section) -> Result<Option<Vec<Link>>, SceneFileError> {
    const EXPECTED: &str = "a list of tables { a, alpha_deg, d, theta_deg } is needed";
    let Some(value) = section.get("links") else { return Ok(None) };
    let Some(array) = as_array(value) else { return Err(section.value_error("links", value, EXPECTED)) };
    let mut links = Vec::new();
    for entry in array.iter() {
        let DeValue::Table(table) = entry.get_ref() else {
            return Err(section.value_error("links", entry, EXPECTED));
        };
        let own = Section::new(section.source, &section.full("links"), table, entry.span().start);
        links.push(Link {
            a: own.number_or("a", 0.0)?,
            alpha_deg: own.number_or("alpha_deg", 0.0)?,
            d: own.number_or("d", 0.0)?,
            theta_deg: own.number_or("theta_deg", 0.0)?,
        });
        own.finish("key")?;
    }
    Ok(Some(links))
}

fn misalignment(section: &Section) -> Result<Effect, SceneFileError> {
    let rotation_deg = section.several("rotation_deg")?.unwrap_or([0.0; 3]);
    let translation = section.several("translation")?.unwrap_or([0.0; 3]);
    Ok(Misalignment { rotation_deg, translation }.into())
}

fn latency(section: &Section) -> Result<Effect, SceneFileError> {
    Ok(Latency { distance: section.number_or("distance", 0.0)?, jitter: section.number_or("jitter", 0.0)? }.into())
}

fn finger_noise(section: &Section) -> Result<Effect, SceneFileError> {
    let sigma = section.one_or_three("sigma")?.unwrap_or([0.0; 3]);
    let sigma_deg = section.number_or("sigma_deg", 0.0)?;
    let length = section.required("length", "the correlation length along the finger is needed")?;
    Ok(FingerNoise { sigma, sigma_deg, length }.into())
}

fn slip(section: &Section) -> Result<Effect, SceneFileError> {
    let probability = section.required("probability", "how often a finger slips is needed")?;
    let size = section.required("size", "how far it slips is needed")?;
    Ok(Slip { probability, size }.into())
}

fn dropout(section: &Section) -> Result<Effect, SceneFileError> {
    Ok(Dropout { probability: section.required("probability", "how often a reading is lost is needed")? }.into())
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
