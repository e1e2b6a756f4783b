//! `[effects.NAME]`: the errors that are simulated, one type an effect, named as the effect is. Only what stands in the
//! scene is. Types that are `remote` are read straight into the effect of the simulated world.

use palpate_numeric::draws::NoiseLaw;
use palpate_world::scene::Effect;
use palpate_world::scene::effects as world;
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::IgnoredAny;

use super::SceneFileError;
use super::keys::{Keys, OneOrThree, keys};
use super::manual::entry::Entry;
use super::section::Section;

/// The robot believes its round fingertips larger or smaller than they are.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::TipRadiusError")]
struct TipRadiusErrorKeys {
    /// Believed less true radius, units of length.
    #[schemars(example = 0.1, extend("x-needed" = "the believed less the true radius is needed"))]
    error: f64,
}

/// Soft tips sink in before they are read (Hertz contact).
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Indentation")]
struct IndentationKeys {
    /// Contact modulus, force per length squared.
    #[schemars(example = 100.0, extend("exclusiveMinimum" = 0))]
    #[schemars(extend("x-needed" = "the contact modulus E*, force per length squared, is needed"))]
    modulus: f64,
    /// Force at which a reading is taken.
    #[schemars(example = 0.5, range(min = 0), extend("x-needed" = "the force that triggers a reading is needed"))]
    threshold: f64,
    /// Force by which it is exceeded at most.
    #[serde(default)]
    #[schemars(example = 0.1, range(min = 0))]
    overshoot: f64,
}

/// Friction tilts the felt force, and with it the normal.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Friction")]
struct FrictionKeys {
    /// Coefficient of friction, no unit.
    #[schemars(example = 0.2, range(min = 0), extend("x-needed" = "the coefficient of friction is needed"))]
    mu: f64,
    /// Its standard deviation from contact to contact.
    #[serde(default)]
    #[schemars(example = 0.02, range(min = 0))]
    sigma: f64,
}

/// The force sensor that tells the normal is noisy, biased, drifts and has steps.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::ForceNoise")]
struct ForceNoiseKeys {
    /// Standard deviation per axis, units of force.
    #[serde(default)]
    #[schemars(example = 0.02, range(min = 0))]
    sigma: f64,
    /// Constant error, for all axes or for x, y, z, units of force.
    #[serde(default, deserialize_with = "OneOrThree::numbers")]
    #[schemars(with = "OneOrThree", example = [0.0, 0.01, 0.0], extend("default" = 0.0))]
    bias: [f64; 3],
    /// Standard deviation of its wandering from contact to contact, units of force.
    #[serde(default)]
    #[schemars(example = 0.001, range(min = 0))]
    drift: f64,
    /// Step of its converter, units of force.
    #[serde(default)]
    #[schemars(example = 0.01, range(min = 0))]
    quantum: f64,
    /// Force of a contact, where indentation sets none.
    #[serde(default = "one")]
    #[schemars(example = 1.0, extend("exclusiveMinimum" = 0))]
    load: f64,
}

fn one() -> f64 {
    1.0
}

/// Positions are off by chance.
#[derive(Deserialize, JsonSchema)]
struct PositionNoiseKeys {
    /// Standard deviation, for all axes or for x, y, z, units of length.
    #[schemars(example = 0.02, extend("x-needed" = "a number, three, or a covariance is needed"))]
    sigma: Option<OneOrThree>,
    /// Covariance of x, y, z, units of length squared.
    #[schemars(extend("x-example" = "[[4e-4, 0.0, 0.0], [0.0, 4e-4, 0.0], [0.0, 0.0, 1e-4]]", "x-left-out" = "sigma"))]
    #[schemars(extend("x-range" = "three rows of three numbers, in place of sigma"))]
    #[schemars(extend("x-expected" = "three rows of three numbers are needed"))]
    covariance: Option<[[f64; 3]; 3]>,
}

/// Normals are off by chance, and all alike where a sensor sits askew.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::NormalNoise")]
struct NormalNoiseKeys {
    /// Standard deviation per tangent axis, degrees.
    #[schemars(example = 3.0, range(min = 0), extend("x-needed" = "the sd per tangent axis, degrees, is needed"))]
    sigma_deg: f64,
    /// Angles about x, y, z by which all normals are turned, degrees.
    #[serde(default)]
    #[schemars(example = [2.0, 0.0, 0.0])]
    tilt_deg: [f64; 3],
}

/// All slopes are measured too steep, or too flat, by one factor.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::SlopeGain")]
struct SlopeGainKeys {
    /// By how much, relative to the slope: 0.3 is 30 % too steep, -0.2 is 20 % too flat.
    #[schemars(example = 0.3, extend("x-needed" = "by how much slopes are too steep is needed: 0.3 is 30 %"))]
    relative: f64,
}

/// Joint encoders of the arm have steps and noise.
#[derive(Deserialize, JsonSchema)]
struct EncoderKeys {
    /// Step of every encoder, degrees.
    #[serde(default)]
    #[schemars(example = 0.05, range(min = 0))]
    resolution_deg: f64,
    /// Standard deviation of every joint angle, degrees.
    #[serde(default)]
    #[schemars(example = 0.01, range(min = 0))]
    sigma_deg: f64,
    /// Where the arm stands, units of length.
    #[schemars(example = [-30.0, 0.0, 0.0], extend("x-left-out" = "three joints beside the patch"))]
    #[schemars(extend("x-range" = "three numbers; needs links"))]
    base: Option<[f64; 3]>,
    /// Denavit-Hartenberg links: lengths a and d, angles alpha_deg and theta_deg; what is left out is 0.
    #[schemars(with = "Option<Vec<LinkKeys>>", extend("x-example" = LINKS, "x-left-out" = "three joints beside the patch"))]
    #[schemars(extend("x-range" = "a list of tables; needs base"))]
    #[schemars(extend("x-expected" = LIST_OF_LINKS))]
    links: Option<IgnoredAny>,
}

const LINKS: &str = "[{ a = 20.0, alpha_deg = 90.0, d = 10.0, theta_deg = 0.0 }, { a = 20.0 }, { a = 15.0 }]";

const LIST_OF_LINKS: &str = "a list of tables { a, alpha_deg, d, theta_deg } is needed";

/// A joint and the link behind it.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Link")]
struct LinkKeys {
    /// Length along the link's x axis, units of length.
    #[serde(default)]
    a: f64,
    /// Twist about the link's x axis, degrees.
    #[serde(default)]
    alpha_deg: f64,
    /// Offset along the joint's axis, units of length.
    #[serde(default)]
    d: f64,
    /// Joint angle at encoder zero, degrees.
    #[serde(default)]
    theta_deg: f64,
}

/// The robot's frame is not where it believes.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Misalignment")]
struct MisalignmentKeys {
    /// Angles about x, y, z in this order, degrees.
    #[serde(default)]
    #[schemars(example = [0.0, 1.0, 0.0])]
    rotation_deg: [f64; 3],
    /// Shift, units of length.
    #[serde(default)]
    #[schemars(example = [0.1, 0.0, 0.0])]
    translation: [f64; 3],
}

/// The position that is read with a normal is an older one.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Latency")]
struct LatencyKeys {
    /// How far back on its path the finger was, units of length.
    #[serde(default)]
    #[schemars(example = 0.1)]
    distance: f64,
    /// How much that varies either way, units of length.
    #[serde(default)]
    #[schemars(example = 0.02, range(min = 0))]
    jitter: f64,
}

/// Errors that change slowly along the path of a finger.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::FingerNoise")]
struct FingerNoiseKeys {
    /// Standard deviation of the position, for all axes or for x, y, z, units of length.
    #[serde(default, deserialize_with = "OneOrThree::numbers")]
    #[schemars(with = "OneOrThree", example = 0.05, extend("default" = 0.0))]
    sigma: [f64; 3],
    /// Standard deviation of the normal per tangent axis, degrees.
    #[serde(default)]
    #[schemars(example = 1.0, range(min = 0))]
    sigma_deg: f64,
    /// Distance over which errors fade by a factor e, units of length.
    #[schemars(example = 3.0, extend("exclusiveMinimum" = 0))]
    #[schemars(extend("x-needed" = "the correlation length along the finger is needed"))]
    length: f64,
}

/// Now and then a finger slips and the reading is gross.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Slip")]
struct SlipKeys {
    /// How often.
    #[schemars(example = 0.05, range(min = 0, max = 1), extend("x-needed" = "how often a finger slips is needed"))]
    probability: f64,
    /// How far, units of length.
    #[schemars(example = 1.0, range(min = 0), extend("x-needed" = "how far it slips is needed"))]
    size: f64,
}

/// Readings that never arrive.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::Dropout")]
struct DropoutKeys {
    /// How often.
    #[schemars(example = 0.1, range(min = 0, max = 1), extend("x-needed" = "how often a reading is lost is needed"))]
    probability: f64,
}

/// Errors of the heights and slopes that the fit sees; x and y stay exact.
#[derive(Deserialize, JsonSchema)]
#[serde(remote = "world::RowNoise")]
struct RowNoiseKeys {
    /// Standard deviation of z, units of length.
    #[serde(default)]
    #[schemars(example = 0.02, range(min = 0))]
    sigma_z: f64,
    /// Standard deviation of each slope, no unit.
    #[serde(default)]
    #[schemars(example = 0.01, range(min = 0))]
    sigma_slope: f64,
}

/// Key of every effect that draws normal errors.
#[derive(Deserialize, JsonSchema)]
pub(super) struct LawKeys {
    /// Law of its errors, their standard deviation unchanged; student_t takes dof beside it (above 2; left out: 5).
    #[schemars(with = "Option<String>", example = &"laplace", extend("default" = "normal", "enum" = NoiseLaw::NAMES))]
    #[schemars(extend("x-what" = "distribution", "x-range" = "normal, uniform, laplace, triangular, student_t"))]
    distribution: Option<Distribution>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Distribution {
    Normal,
    Uniform,
    Laplace,
    Triangular,
    StudentT,
}

/// Key of Student's law.
#[derive(Deserialize, JsonSchema)]
struct StudentT {
    /// Degrees of freedom.
    #[schemars(example = 5.0, extend("default" = 5.0, "exclusiveMinimum" = 2))]
    dof: Option<f64>,
}

keys! {
    TipRadiusErrorKeys => world::TipRadiusError,
    IndentationKeys => world::Indentation,
    FrictionKeys => world::Friction,
    ForceNoiseKeys => world::ForceNoise,
    PositionNoiseKeys => PositionNoiseKeys,
    NormalNoiseKeys => world::NormalNoise,
    SlopeGainKeys => world::SlopeGain,
    EncoderKeys => EncoderKeys,
    LinkKeys => world::Link,
    MisalignmentKeys => world::Misalignment,
    LatencyKeys => world::Latency,
    FingerNoiseKeys => world::FingerNoise,
    SlipKeys => world::Slip,
    DropoutKeys => world::Dropout,
    RowNoiseKeys => world::RowNoise,
    LawKeys => LawKeys,
    StudentT => StudentT,
}

type Reader = fn(&Section) -> Result<Effect, SceneFileError>;
type Describer = fn(&'static str, &'static str) -> Entry;

/// Every effect that a file can name.
const EFFECTS: &[(&str, Reader, Describer)] = &[
    ("tip_radius_error", plain::<TipRadiusErrorKeys>, Entry::of::<TipRadiusErrorKeys>),
    ("indentation", plain::<IndentationKeys>, Entry::of::<IndentationKeys>),
    ("friction", plain::<FrictionKeys>, Entry::of::<FrictionKeys>),
    ("force_noise", plain::<ForceNoiseKeys>, Entry::of::<ForceNoiseKeys>),
    ("position_noise", position_noise, Entry::of::<PositionNoiseKeys>),
    ("normal_noise", plain::<NormalNoiseKeys>, Entry::of::<NormalNoiseKeys>),
    ("slope_gain", plain::<SlopeGainKeys>, Entry::of::<SlopeGainKeys>),
    ("encoder", encoder, Entry::of::<EncoderKeys>),
    ("misalignment", plain::<MisalignmentKeys>, Entry::of::<MisalignmentKeys>),
    ("latency", plain::<LatencyKeys>, Entry::of::<LatencyKeys>),
    ("finger_noise", plain::<FingerNoiseKeys>, Entry::of::<FingerNoiseKeys>),
    // the name that finger_noise had first
    (FIRST_NAME, plain::<FingerNoiseKeys>, Entry::of::<FingerNoiseKeys>),
    ("slip", plain::<SlipKeys>, Entry::of::<SlipKeys>),
    ("dropout", plain::<DropoutKeys>, Entry::of::<DropoutKeys>),
    ("row_noise", plain::<RowNoiseKeys>, Entry::of::<RowNoiseKeys>),
];

const FIRST_NAME: &str = "lane_noise";

/// The effects for the manual.
pub(super) fn entries() -> impl Iterator<Item = Entry> {
    EFFECTS.iter().filter(|(name, ..)| *name != FIRST_NAME).map(|(name, _, describe)| describe("effects", name))
}

/// Effects, and the laws of those whose errors are not normal.
pub(super) type Effects = (Vec<Effect>, Vec<(&'static str, NoiseLaw)>);

pub(super) fn read(section: Section) -> Result<Effects, SceneFileError> {
    let (mut effects, mut laws) = (Vec::new(), Vec::new());
    for (name, reader, _) in EFFECTS {
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

/// An effect whose keys in a file are its own.
fn plain<K: Keys<Read: Into<Effect>>>(section: &Section) -> Result<Effect, SceneFileError> {
    section.read::<K>().map(Into::into)
}

/// `distribution`, and `dof` where it is Student's.
fn law(section: &Section) -> Result<Option<NoiseLaw>, SceneFileError> {
    let law = match section.read::<LawKeys>()?.distribution {
        None => return Ok(None),
        Some(Distribution::Normal) => NoiseLaw::Normal,
        Some(Distribution::Uniform) => NoiseLaw::Uniform,
        Some(Distribution::Laplace) => NoiseLaw::Laplace,
        Some(Distribution::Triangular) => NoiseLaw::Triangular,
        Some(Distribution::StudentT) => {
            let dof = section.read::<StudentT>()?.dof.unwrap_or(5.0);
            if let (Some(value), false) = (section.get("dof"), dof > 2.0 && dof.is_finite()) {
                return Err(section.value_error("dof", value, "more than 2 degrees of freedom are needed for an sd"));
            }
            NoiseLaw::StudentT { dof }
        }
    };
    Ok(Some(law))
}

fn position_noise(section: &Section) -> Result<Effect, SceneFileError> {
    let read = section.read::<PositionNoiseKeys>()?;
    match (read.sigma.map(OneOrThree::three), read.covariance) {
        (Some(_), Some(_)) => Err(section.clash("sigma", "covariance")),
        (Some(sigma), None) => Ok(Effect::position_noise(sigma)),
        (None, Some(covariance)) => Ok(Effect::position_covariance(covariance)),
        (None, None) => Err(section.needed::<PositionNoiseKeys>("sigma")),
    }
}

fn encoder(section: &Section) -> Result<Effect, SceneFileError> {
    let EncoderKeys { resolution_deg, sigma_deg, base, links } = section.read::<EncoderKeys>()?;
    let links = match links {
        Some(_) => Some(section.tables("links", LIST_OF_LINKS)?.into_iter().map(link).collect::<Result<_, _>>()?),
        None => None,
    };
    match (base, links) {
        (None, None) => Ok(Effect::encoder(resolution_deg, sigma_deg)),
        (Some(base), Some(links)) => {
            Ok(world::Encoder { resolution_deg, sigma_deg, arm: Some(world::Arm { base, links }) }.into())
        }
        (Some(_), None) => Err(section.missing("links", "an arm with a base needs its links too")),
        (None, Some(_)) => Err(section.missing("base", "an arm with links needs its base too")),
    }
}

fn link(section: Section) -> Result<world::Link, SceneFileError> {
    let link = section.read::<LinkKeys>()?;
    section.finish("key")?;
    Ok(link)
}
