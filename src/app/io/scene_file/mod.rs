//! Scene files: TOML to a world, the fit of its contacts, and the study of its noise.
//!
//! ```toml
//! [surface]              # kind, its sizes, axis_deg, rotation_deg, offset, concave
//! [sweep]                # fingers, from, to, stations (or at = [...]), repeats, angle_deg, centre, tip_radius
//! [effects.NAME]         # only what stands here is simulated
//! [fit]                  # the words of the command line
//! [study]                # replicates, level
//! ```
//!
//! `manual` describes every key. Everything is checked before anything is simulated. An unknown key, effect or surface names the nearest known one
//! with line and column.

mod builtin;
mod effects;
mod error;
mod fit;
mod keys;
mod manual;
mod section;
mod surface;
mod sweep;

use std::sync::Arc;

use schemars::JsonSchema;
use serde::Deserialize;
use toml::de::DeTable;

pub(crate) use builtin::{BuiltinScene, builtin_text};
pub use builtin::{builtin, builtin_scenes, family_members};
pub use error::SceneFileError;
pub(crate) use manual::{scene_manual, scene_topics};

use palpate_fitting::fit::FitOptions;
use palpate_studies::montecarlo::StudyOptions;
use palpate_world::scene::World;
use palpate_world::scene::surface::ImportedSurface;
use section::{Section, place};

/// A scene as it was written, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFile {
    /// `name`; empty when the file has none.
    pub name: String,
    /// `seed`. Default 1997, the paper's year.
    pub seed: u64,
    /// What the fingers meet, how they move, what comes between.
    pub world: World,
    /// How the contacts are fitted. Weights default to `tangent` in scenes.
    pub fit: FitOptions,
    /// Whether `[fit]` names a model; where it does not, `palpate run` asks what the contacts show, as `palpate fit` does.
    pub names_a_model: bool,
    /// How often a study repeats.
    pub study: StudyOptions,
}

/// At the top of the file, before any [section].
#[derive(Deserialize, JsonSchema)]
struct Top {
    /// Printed with the results.
    #[serde(default)]
    #[schemars(example = &"my scene")]
    name: String,
    /// Where the random draws start: the same seed gives the same numbers.
    #[serde(default = "paper_year")]
    #[schemars(example = 1)]
    seed: u64,
}

fn paper_year() -> u64 {
    1997
}

keys::keys! { Top => Top }

/// How an imported surface is found: `file` as it stands in the scene, or why not.
pub(crate) type Importer<'a> = dyn Fn(&str) -> Result<Arc<dyn ImportedSurface>, String> + 'a;

/// Reads a scene without imported surfaces.
///
/// # Errors
/// As [`read_scene_with`].
pub fn read_scene(text: &str) -> Result<SceneFile, SceneFileError> {
    read_scene_with(text, &|_| Err("surfaces cannot be imported here".into()))
}

/// Reads a scene and checks the world it describes, imported surfaces by `importer`.
///
/// # Errors
/// The first fault found, with line and column where it has one.
pub fn read_scene_with(text: &str, importer: &Importer) -> Result<SceneFile, SceneFileError> {
    let document = DeTable::parse(text).map_err(|error| {
        let (line, column) = place(text, error.span().map_or(0, |span| span.start));
        SceneFileError::Syntax { line, column, message: error.message().to_string() }
    })?;
    let root = Section::new(text, "", document.get_ref(), 0);
    let Top { name, seed } = root.read::<Top>()?;
    let surface = match root.section("surface")? {
        Some(section) => surface::read(section, importer)?,
        None => return Err(root.missing("surface", "a scene needs a [surface] with its kind")),
    };
    let sweeps = match root.section("sweep")? {
        Some(section) => sweep::read(section)?,
        None => return Err(root.missing("sweep", "a scene needs a [sweep] with fingers and stations")),
    };
    let (effects, laws) = root.section("effects")?.map_or(Ok(Default::default()), effects::read)?;
    let (fit, names_a_model) = fit::read(root.section("fit")?)?;
    let study = root.section("study")?.map_or(Ok(StudyOptions::default()), fit::read_study)?;
    root.finish("key")?;
    let world = World { surface, sweeps, effects, laws };
    world.compile()?;
    Ok(SceneFile { name, seed, world, fit, names_a_model, study })
}
