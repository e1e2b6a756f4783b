//! The manual as text: all of it, or one topic.

use std::fmt::Write as _;

use super::super::section::nearest;
use super::entry::{Entry, Key};
use super::{entries, shared};

/// A whole scene to start from, the one that `palpate run` takes when none is named.
const EXAMPLE: &str = include_str!("../../scenes/bar.toml");

/// What can be asked for: sections, surfaces, effects.
pub(crate) fn scene_topics() -> Vec<&'static str> {
    entries().map(|entry| entry.name).filter(|topic| !topic.is_empty()).collect()
}

/// The manual of scene files, or of one topic.
///
/// # Errors
/// The topics that there are, where `asked` is none of them.
pub(crate) fn scene_manual(asked: Option<&str>) -> Result<String, String> {
    let mut text = String::new();
    match asked {
        None => whole(&mut text),
        Some(asked) => {
            let found: Vec<Entry> = entries().filter(|entry| entry.name == asked || entry.table() == asked).collect();
            if found.is_empty() {
                let topics = scene_topics();
                let close = nearest(asked, topics.iter().copied());
                return Err(format!("scenes have no {asked:?}{close} There are: {}", topics.join(", ")));
            }
            found.iter().for_each(|entry| section(entry, true, &mut text));
        }
    }
    Ok(text)
}

fn whole(text: &mut String) {
    text.push_str("A scene is a text file (TOML) that says which surface there is, how fingers sweep over it, which errors they\n");
    text.push_str("make and how the contacts are fitted. Start from this one, or from `palpate scenes NAME`:\n\n");
    text.extend(EXAMPLE.lines().map(|line| if line.is_empty() { "\n".into() } else { format!("    {line}\n") }));
    text.push_str("\nLengths are in any one unit, angles in degrees. An unknown key is refused, and the nearest known one named.\n");
    let mut group = None;
    for entry in entries() {
        if group != Some(entry.group) {
            heading(&entry, text);
            group = Some(entry.group);
        }
        section(&entry, false, text);
    }
}

/// The heading of a group, with the keys that all of it share.
fn heading(entry: &Entry, text: &mut String) {
    let (title, every) = match entry.group {
        "" => return text.push_str("\n# The file\n"),
        "surface" => ("# [surface]: what is touched", "Every surface also takes:\n"),
        "sweep" => return text.push_str("\n# [sweep]: how it is touched\n"),
        "fit" => return text.push_str("\n# [fit] and [study]: what is made of the contacts\n"),
        _ => (
            "# [effects.NAME]: errors; only those that stand in the file are simulated",
            "Effects with normal errors also take:\n",
        ),
    };
    let _ = writeln!(text, "\n{title}\n\n{every}");
    shared(entry).iter().for_each(|key| line(key, text));
}

fn section(entry: &Entry, with_shared: bool, text: &mut String) {
    let name = match entry.group {
        "surface" => format!("kind = \"{}\"", entry.name),
        "" => "name and seed".into(),
        _ => format!("[{}]", entry.table()),
    };
    let _ = writeln!(text, "\n{name}\n{}", entry.about);
    let also = if with_shared { shared(entry) } else { Vec::new() };
    entry.keys.iter().chain(&also).for_each(|key| line(key, text));
}

/// Key and example; then meaning, range and default below it.
fn line(key: &Key, text: &mut String) {
    let default = key.left_out().map_or("needed".into(), |value| format!("left out: {value}"));
    let _ = writeln!(text, "    {} = {}", key.name, key.example());
    let _ = writeln!(text, "        {}; {}; {default}", key.meaning(), key.range());
}
