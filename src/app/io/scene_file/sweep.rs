//! `[sweep]` and `[sweep.second]`.

use palpate_world::scene::{MAX_TOUCHES, Sweep, SweepPath, linspace};
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::IgnoredAny;

use super::SceneFileError;
use super::keys::keys;
use super::manual::entry::Entry;
use super::section::Section;

/// How the fingers move: side by side, each stopping at every station.
#[derive(Deserialize, JsonSchema)]
struct SweepKeys {
    /// Offset of each finger across the sweep, units of length.
    #[schemars(example = [-4.0, 0.0, 4.0], extend("x-needed" = "give each finger's offset, as [-4.0, 0.0, 4.0]"))]
    fingers: Option<Vec<f64>>,
    /// Down onto the surface from above, around a cylinder or torus, or a scan of solids without fingers.
    #[schemars(with = "Option<String>", example = &"down", extend("default" = "down", "x-what" = "word"))]
    #[schemars(extend("enum" = ["down", "around", "scan"]))]
    path: Option<SweepPath>,
    /// The stations one by one, in place of from, to and stations, units of length.
    #[schemars(example = [-4.0, 0.0, 4.0], extend("x-left-out" = "from, to and stations"))]
    at: Option<Vec<f64>>,
    /// First station, units of length (around: degrees, 0 on top).
    #[schemars(example = -4.0, extend("x-needed" = STATIONS))]
    from: Option<f64>,
    /// Last station.
    #[schemars(example = 4.0, extend("x-needed" = STATIONS))]
    to: Option<f64>,
    /// How many, evenly spaced, both ends included.
    #[schemars(example = 9, range(min = 1), extend("x-needed" = STATIONS))]
    stations: Option<u64>,
    /// Touches at each station, each with fresh errors.
    #[schemars(example = 2, range(min = 1), extend("default" = 1))]
    repeats: Option<u64>,
    /// Turns the sweep about its centre, degrees; 0 slides along y.
    #[schemars(example = 45.0, extend("default" = 0.0))]
    angle_deg: Option<f64>,
    /// Radius of the round fingertips, units of length; 0 is a point.
    #[schemars(example = 0.5, range(min = 0), extend("default" = 0.0))]
    tip_radius: Option<f64>,
    /// Where fingers and stations are counted from, units of length.
    #[schemars(example = [1.0, 0.0], extend("default" = [0.0, 0.0]))]
    centre: Option<[f64; 2]>,
    /// Whether a station beside the surface is an error or is left out.
    #[schemars(with = "Option<String>", example = &"skip", extend("default" = "error", "x-what" = "word"))]
    #[schemars(extend("enum" = ["error", "skip"]))]
    unreachable: Option<Unreachable>,
    /// Of a scan: from point to point, units of length.
    #[schemars(example = 0.5, extend("x-range" = "a number above 0", "x-left-out" = "a scan needs one"))]
    spacing: Option<f64>,
    /// Of a scan: where the scanner stands, units of length.
    #[schemars(example = [50.0, 40.0, 45.0], extend("x-left-out" = "every side is seen"))]
    eye: Option<[f64; 3]>,
    /// A second sweep; what it leaves out is as in the first.
    #[schemars(with = "Option<serde_json::Map<String, serde_json::Value>>")]
    #[schemars(extend("x-example" = "{ angle_deg = 90.0 }", "x-left-out" = "one sweep"))]
    #[schemars(extend("x-range" = "a table [sweep.second] with the keys above"))]
    #[expect(dead_code, reason = "it is a section")]
    second: Option<IgnoredAny>,
}

const STATIONS: &str = "give from, to and stations, or at = [...]";

/// What becomes of stations beside the surface.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Unreachable {
    Error,
    Skip,
}

keys! { SweepKeys => SweepKeys }

/// The sweep for the manual.
pub(super) fn entry() -> Entry {
    Entry::of::<SweepKeys>("sweep", "sweep")
}

/// The sweep, and the second one where there is one: it inherits every key it does not name.
pub(super) fn read(section: Section) -> Result<Vec<Sweep>, SceneFileError> {
    let first = read_one(&section, None)?;
    let second = match section.section("second")? {
        Some(second) => {
            let sweep = read_one(&second, Some(&first))?;
            second.keep(|key| key != "second");
            second.finish("key")?;
            Some(sweep)
        }
        None => None,
    };
    section.finish("key")?;
    Ok(std::iter::once(first).chain(second).collect())
}

fn read_one(section: &Section, inherited: Option<&Sweep>) -> Result<Sweep, SceneFileError> {
    let keys = section.read::<SweepKeys>()?;
    let mut sweep = match (inherited, &keys.fingers, keys.path) {
        (None, _, Some(SweepPath::Scan)) => {
            section.keep(|key| ["path", "spacing", "eye", "second"].contains(&key));
            let missing = || section.missing("spacing", "the distance between the points of a scan is needed");
            return Ok(Sweep::scan(keys.spacing.ok_or_else(missing)?, keys.eye));
        }
        (Some(first), ..) => first.clone(),
        (None, Some(_), _) => Sweep::new(Vec::new(), Vec::new()),
        (None, None, _) => return Err(section.needed::<SweepKeys>("fingers")),
    };
    match (keys.path, section.get("path")) {
        (Some(SweepPath::Scan), Some(value)) => {
            return Err(section.unknown_word("word", value, "scan", &["down", "around"]));
        }
        (path, _) => sweep.path = path.unwrap_or(sweep.path),
    }
    if let Some(stations) = read_stations(section, &keys, inherited.is_some(), sweep.path)? {
        sweep.stations = stations;
    }
    sweep.fingers = keys.fingers.unwrap_or(sweep.fingers);
    sweep.repeats = keys.repeats.map_or(sweep.repeats, |repeats| repeats as usize);
    sweep.angle_deg = keys.angle_deg.unwrap_or(sweep.angle_deg);
    sweep.tip_radius = keys.tip_radius.unwrap_or(sweep.tip_radius);
    sweep.centre = keys.centre.unwrap_or(sweep.centre);
    sweep.skip_unreachable = keys.unreachable.map_or(sweep.skip_unreachable, |word| matches!(word, Unreachable::Skip));
    Ok(sweep)
}

/// `at = [...]`, or `from`, `to`, `stations`, or all the way round `stations` alone; `None` when nothing of it stands there
/// and may be inherited.
fn read_stations(
    section: &Section,
    keys: &SweepKeys,
    may_inherit: bool,
    path: SweepPath,
) -> Result<Option<Vec<f64>>, SceneFileError> {
    let (at, from, to, stations) = (&keys.at, keys.from, keys.to, keys.stations);
    let spaced = [("from", from.is_some()), ("to", to.is_some()), ("stations", stations.is_some())];
    if at.is_some()
        && let Some((key, _)) = spaced.iter().find(|(_, there)| *there)
    {
        return Err(section.clash("at", key));
    }
    if at.is_some() || (may_inherit && spaced.iter().all(|(_, there)| !there)) {
        return Ok(at.clone());
    }
    let round = path == SweepPath::Around && from.is_none() && to.is_none();
    if let Some(count) = stations.filter(|count| round && *count <= MAX_TOUCHES as u64) {
        return Ok(Some((0..count).map(|k| 360.0 * k as f64 / count as f64).collect()));
    }
    let (from, to) = if round { (Some(0.0), Some(360.0)) } else { (from, to) };
    let (Some(from), Some(to), Some(stations)) = (from, to, stations) else {
        let (key, _) = spaced.iter().find(|(_, there)| !there).unwrap_or(&spaced[0]);
        return Err(section.needed::<SweepKeys>(key));
    };
    // a world of so many is refused anyway, and a list of them takes memory first
    if let Some(value) = section.get("stations").filter(|_| stations > MAX_TOUCHES as u64) {
        return Err(section.value_error("stations", value, format!("at most {MAX_TOUCHES} are possible")));
    }
    Ok(Some(linspace(from, to, stations as usize)))
}
