//! The manual against the reader.

use super::super::{SceneFile, SceneFileError, read_scene_with};
use super::*;

const BODY: &str = "kind = \"plane\"\n";
const FINGERS: &str =
    "fingers = [-4.0, 0.0, 4.0]\nfrom = -4.0\nto = 4.0\nstations = 9\nunreachable = \"skip\"\ntip_radius = 0.5\n";

/// A scene with these lines in the entry's table, and nothing else that is not needed.
fn scene(entry: &Entry, lines: &str) -> String {
    let kind = entry.kind.map_or(String::new(), |kind| format!("kind = \"{kind}\"\n"));
    let other =
        |table: &str, text: &str| if entry.table == table { String::new() } else { format!("[{table}]\n{text}") };
    let own = if entry.table.is_empty() { String::new() } else { format!("[{}]\n{kind}{lines}", entry.table) };
    let top = if entry.table.is_empty() { lines } else { "" };
    format!("{top}\n{}{}{own}", other("surface", BODY), other("sweep", FINGERS))
}

fn read(entry: &Entry, lines: &str) -> Result<SceneFile, SceneFileError> {
    let sphere = || -> std::sync::Arc<dyn palpate_world::scene::surface::ImportedSurface> { std::sync::Arc::new(Flat) };
    read_scene_with(&scene(entry, lines), &|_| Ok(sphere()))
}

/// A surface that was saved.
#[derive(Debug)]
struct Flat;

impl palpate_world::scene::surface::ImportedSurface for Flat {
    fn label(&self) -> &str {
        "flat"
    }

    fn jet(&self, _: f64, _: f64) -> Option<[f64; 6]> {
        Some([0.0; 6])
    }
}

fn written(key: &Key) -> String {
    format!("{} = {}\n", key.name, key.example)
}

/// The keys that are needed, without `but`.
fn needed(entry: &Entry, but: &str) -> String {
    entry.keys.iter().filter(|key| matches!(key.default, Default::Required) && key.name != but).map(written).collect()
}

fn all(entry: &'static Entry) -> impl Iterator<Item = &'static Key> {
    entry.keys.iter().chain(shared(entry))
}

/// A law is refused where nothing is drawn: an effect of constants alone.
fn draws(entry: &Entry) -> bool {
    entry.keys.iter().any(|key| key.name.starts_with("sigma") && matches!(key.default, Default::Required))
}

#[test]
fn every_kind_and_effect_is_described() {
    let kinds: Vec<&str> = surfaces::SURFACES.iter().filter_map(|entry| entry.kind).collect();
    assert_eq!(kinds, palpate_world::scene::surface::Body::KINDS);
    let error = read(&sections::FIT[1], "[effects.zzz]\n").unwrap_err();
    let SceneFileError::Unknown { known, .. } = error else { panic!("{error}") };
    let mut names: Vec<&str> = effects::EFFECTS.iter().map(topic_of).chain(["lane_noise"]).collect();
    names.sort_unstable();
    assert_eq!(known, names.join(", "));
}

fn topic_of(entry: &Entry) -> &'static str {
    entry.table.trim_start_matches("effects.")
}

#[test]
fn the_keys_are_those_that_are_read() {
    for entry in entries().filter(|entry| !entry.table.is_empty()) {
        let error = read(entry, &(needed(entry, "") + "zzz = 1\n")).unwrap_err();
        let SceneFileError::Unknown { known, .. } = error else { panic!("{}: {error}", entry.about) };
        let mut names: Vec<&str> = all(entry).map(|key| key.name).chain(entry.kind.map(|_| "kind")).collect();
        names.sort_unstable();
        assert_eq!(known, names.join(", "), "{}", entry.about);
    }
}

#[test]
fn examples_are_read_and_needed_keys_are_needed() {
    for entry in entries() {
        let name = entry.kind.unwrap_or(entry.table);
        read(entry, &needed(entry, "")).unwrap_or_else(|error| panic!("{name}: {error}"));
        for key in entry.keys.iter().filter(|key| matches!(key.default, Default::Required)) {
            assert!(read(entry, &needed(entry, key.name)).is_err(), "{name}.{} is not needed", key.name);
        }
        for key in all(entry).filter(|key| key.name != "distribution" || draws(entry)) {
            // these two stand in place of others
            let lines = match key.name {
                "at" => "fingers = [0.0]\nat = [-4.0, 0.0, 4.0]\n".to_string(),
                "covariance" => written(key),
                "base" | "links" => entry.keys[2..].iter().map(written).collect(),
                _ => needed(entry, key.name) + &written(key),
            };
            read(entry, &lines).unwrap_or_else(|error| panic!("{name}.{}: {error}", key.name));
        }
    }
}

#[test]
fn defaults_are_those_of_the_reader() {
    for entry in entries() {
        let without = read(entry, &needed(entry, "")).unwrap();
        for key in all(entry) {
            if let Default::Value(value) = key.default {
                let with = read(entry, &(needed(entry, "") + &format!("{} = {value}\n", key.name))).unwrap();
                let mut world = with.world.clone();
                // that a law is named is kept, and the normal one is what is drawn without
                world.laws.clone_from(&without.world.laws);
                // an imported surface is another one each time
                if entry.kind != Some("imported") {
                    let place = format!("{}{:?}.{}", entry.table, entry.kind, key.name);
                    assert_eq!(SceneFile { world, ..with }, without, "{place}");
                }
            }
        }
    }
}

#[test]
fn what_is_out_of_range_is_refused() {
    for entry in entries() {
        for key in all(entry) {
            let wrong = match key.range {
                Range::Any => "\"word\"",
                Range::Positive => "0.0",
                Range::NotNegative => "-1.0",
                Range::Probability => "1.5",
                Range::Words(_) => "\"zzz\"",
                Range::Other(_, wrong) => wrong,
            };
            let lines = needed(entry, key.name) + &format!("{} = {wrong}\n", key.name);
            assert!(read(entry, &lines).is_err(), "{}{:?}: {} = {wrong} is taken", entry.table, entry.kind, key.name);
            if let Range::Words(words) = key.range {
                // a plane has nothing to go around
                let possible = key.name != "path" && (key.name != "distribution" || draws(entry));
                for word in words.iter().filter(|_| possible) {
                    let lines = needed(entry, key.name) + &format!("{} = \"{word}\"\n", key.name);
                    read(entry, &lines).unwrap_or_else(|error| panic!("{} = {word}: {error}", key.name));
                }
            }
        }
    }
}

#[test]
fn topics_are_found_and_others_have_a_neighbour() {
    assert!(scene_manual(None).unwrap().contains("minor = 5.0"));
    let torus = scene_manual(Some("torus")).unwrap();
    assert!(torus.contains("minor") && torus.contains("offset") && !torus.contains("semi_axes"), "{torus}");
    assert!(scene_manual(Some("encoders")).unwrap_err().contains("`encoder`"));
    assert!(scene_topics().contains(&"sweep"));
}

#[test]
fn the_example_is_a_scene() {
    let text = scene_manual(None).unwrap();
    let example: String = text
        .lines()
        .skip(3)
        .take_while(|line| !line.starts_with("Lengths"))
        .map(|l| format!("{}\n", l.trim()))
        .collect();
    super::super::read_scene(&example).unwrap();
}
