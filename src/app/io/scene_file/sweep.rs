//! `[sweep]` and `[sweep.second]`.

use super::SceneFileError;
use super::section::Section;
use palpate_world::scene::{MAX_TOUCHES, Sweep, SweepPath, linspace};

/// The sweep, and the second one where there is one: it inherits every key it does not name.
pub(super) fn read(section: Section) -> Result<Vec<Sweep>, SceneFileError> {
    let first = read_one(&section, None)?;
    let second = match section.section("second")? {
        Some(second) => {
            let sweep = read_one(&second, Some(&first))?;
            second.finish("key")?;
            Some(sweep)
        }
        None => None,
    };
    section.finish("key")?;
    Ok(std::iter::once(first).chain(second).collect())
}

fn read_one(section: &Section, inherited: Option<&Sweep>) -> Result<Sweep, SceneFileError> {
    let (spacing, eye) = (section.number("spacing")?, section.several("eye")?);
    if let (Some(("scan", _)), None) = (section.word("path")?, inherited) {
        let missing = || section.missing("spacing", "the distance between the points of a scan is needed");
        return Ok(Sweep::scan(spacing.ok_or_else(missing)?, eye));
    }
    let fingers = match (section.numbers("fingers")?, inherited) {
        (Some(fingers), _) => fingers,
        (None, Some(first)) => first.fingers.clone(),
        (None, None) => return Err(section.missing("fingers", "give each finger's offset, as [-4.0, 0.0, 4.0]")),
    };
    let mut sweep = match inherited {
        Some(first) => Sweep { fingers, ..first.clone() },
        None => Sweep::new(fingers, Vec::new()),
    };
    let paths = ["down", "around", "scan"];
    match section.word("path")? {
        None => {}
        Some(("down", _)) => sweep.path = SweepPath::Down,
        Some(("around", _)) => sweep.path = SweepPath::Around,
        Some((other, value)) => return Err(section.unknown_word("word", value, other, &paths)),
    }
    if let Some(stations) = read_stations(section, inherited.is_some(), sweep.path)? {
        sweep.stations = stations;
    }
    if let Some(repeats) = section.count("repeats", 1)? {
        sweep.repeats = repeats as usize;
    }
    sweep.angle_deg = section.number_or("angle_deg", sweep.angle_deg)?;
    sweep.tip_radius = section.number_or("tip_radius", sweep.tip_radius)?;
    if let Some(centre) = section.several("centre")? {
        sweep.centre = centre;
    }
    match section.word("unreachable")? {
        None => {}
        Some(("error", _)) => sweep.skip_unreachable = false,
        Some(("skip", _)) => sweep.skip_unreachable = true,
        Some((other, value)) => return Err(section.unknown_word("word", value, other, &["error", "skip"])),
    }
    Ok(sweep)
}

/// `at = [...]`, or `from`, `to`, `stations`, or all the way round `stations` alone; `None` when nothing of it stands there
/// and may be inherited.
fn read_stations(section: &Section, may_inherit: bool, path: SweepPath) -> Result<Option<Vec<f64>>, SceneFileError> {
    let at = section.numbers("at")?;
    let (from, to, stations) = (section.number("from")?, section.number("to")?, section.count("stations", 1)?);
    let spaced = [("from", from.is_some()), ("to", to.is_some()), ("stations", stations.is_some())];
    if at.is_some()
        && let Some((key, _)) = spaced.iter().find(|(_, there)| *there)
    {
        return Err(section.clash("at", key));
    }
    if at.is_some() || (may_inherit && spaced.iter().all(|(_, there)| !there)) {
        return Ok(at);
    }
    let round = path == SweepPath::Around && from.is_none() && to.is_none();
    if let Some(count) = stations.filter(|count| round && *count <= MAX_TOUCHES as u64) {
        return Ok(Some((0..count).map(|k| 360.0 * k as f64 / count as f64).collect()));
    }
    let (from, to) = if round { (Some(0.0), Some(360.0)) } else { (from, to) };
    let (Some(from), Some(to), Some(stations)) = (from, to, stations) else {
        let (key, _) = spaced.iter().find(|(_, there)| !there).unwrap_or(&spaced[0]);
        return Err(section.missing(key, "give from, to and stations, or at = [...]"));
    };
    // a world of so many is refused anyway, and a list of them takes memory first
    if let Some(value) = section.get("stations").filter(|_| stations > MAX_TOUCHES as u64) {
        return Err(section.value_error("stations", value, format!("at most {MAX_TOUCHES} are possible")));
    }
    Ok(Some(linspace(from, to, stations as usize)))
}
