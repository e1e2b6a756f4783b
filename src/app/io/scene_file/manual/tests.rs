//! The manual against the reader.

use super::super::{SceneFile, SceneFileError, read_scene_with};
use super::*;

const BODY: &str = "kind = \"plane\"\n";
const FINGERS: &str =
    "fingers = [-4.0, 0.0, 4.0]\nfrom = -4.0\nto = 4.0\nstations = 9\nunreachable = \"skip\"\ntip_radius = 0.5\n";

/// A scene with these lines in the entry's table, and nothing else that is not needed.
fn scene(entry: &Entry, lines: &str) -> String {
    let kind = kind(entry).map_or(String::new(), |kind| format!("kind = \"{kind}\"\n"));
    let table = entry.table();
    let other = |name: &str, text: &str| if table == name { String::new() } else { format!("[{name}]\n{text}") };
    let own = if table.is_empty() { String::new() } else { format!("[{table}]\n{kind}{lines}") };
    let top = if table.is_empty() { lines } else { "" };
    format!("{top}\n{}{}{own}", other("surface", BODY), other("sweep", FINGERS))
}

fn kind(entry: &Entry) -> Option<&'static str> {
    (entry.group == "surface").then_some(entry.name)
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
    format!("{} = {}\n", key.name, key.example())
}

/// The keys that are needed, without `but`.
fn needed(entry: &Entry, but: &str) -> String {
    entry.keys.iter().filter(|key| key.left_out().is_none() && key.name != but).map(written).collect()
}

fn all(entry: &Entry) -> Vec<Key> {
    let own = entry.keys.iter().map(|key| Key { name: key.name, schema: key.schema.clone() });
    own.chain(shared(entry)).collect()
}

/// A law is refused where nothing is drawn: an effect of constants alone.
fn draws(entry: &Entry) -> bool {
    entry.keys.iter().any(|key| key.name.starts_with("sigma") && key.left_out().is_none())
}

#[test]
fn every_kind_and_effect_is_described() {
    let kinds: Vec<&str> = entries().filter_map(|entry| kind(&entry)).collect();
    assert_eq!(kinds, palpate_world::scene::surface::Body::KINDS);
    let error = read(&super::super::fit::entries()[1], "[effects.zzz]\n").unwrap_err();
    let SceneFileError::Unknown { known, .. } = error else { panic!("{error}") };
    let mut names: Vec<&str> = super::super::effects::entries().map(|entry| entry.name).chain(["lane_noise"]).collect();
    names.sort_unstable();
    assert_eq!(known, names.join(", "));
}

#[test]
fn the_keys_are_those_that_are_read() {
    for entry in entries().filter(|entry| !entry.name.is_empty()) {
        let error = read(&entry, &(needed(&entry, "") + "zzz = 1\n")).unwrap_err();
        let SceneFileError::Unknown { known, .. } = error else { panic!("{}: {error}", entry.about) };
        let mut names: Vec<&str> = all(&entry).iter().map(|key| key.name).chain(kind(&entry).map(|_| "kind")).collect();
        names.sort_unstable();
        assert_eq!(known, names.join(", "), "{}", entry.about);
    }
}

#[test]
fn examples_are_read_and_needed_keys_are_needed() {
    for entry in entries() {
        let (entry, name) = (&entry, entry.name);
        read(entry, &needed(entry, "")).unwrap_or_else(|error| panic!("{name}: {error}"));
        for key in entry.keys.iter().filter(|key| key.left_out().is_none()) {
            assert!(read(entry, &needed(entry, key.name)).is_err(), "{name}.{} is not needed", key.name);
        }
        for key in all(entry).iter().filter(|key| key.name != "distribution" || draws(entry)) {
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
        let entry = &entry;
        let without = read(entry, &needed(entry, "")).unwrap();
        for key in all(entry).iter().filter(|key| key.schema.get("x-left-out").is_none()) {
            if let Some(value) = key.left_out() {
                let with = read(entry, &(needed(entry, "") + &format!("{} = {value}\n", key.name))).unwrap();
                let mut world = with.world.clone();
                // that a law is named is kept, and the normal one is what is drawn without
                world.laws.clone_from(&without.world.laws);
                // a default that is written out names a model, and is the same one
                // an imported surface is another one each time
                if entry.name != "imported" {
                    let place = format!("{} {}.{}", entry.group, entry.name, key.name);
                    let names_a_model = without.names_a_model;
                    assert_eq!(SceneFile { world, names_a_model, ..with }, without, "{place}");
                }
            }
        }
    }
}

/// A value that the key's range excludes.
fn wrong(key: &Key) -> &'static str {
    match (key.range().as_str(), key.name) {
        ("any number" | "a number above 0", _) => "\"word\"",
        ("above 0", _) => "0.0",
        ("a whole number, 1 or above" | "a whole number, 1 or above, or a pair", _) => "0",
        ("0 or above", _) => "-1.0",
        ("0 to 1", _) => "1.5",
        ("a whole number, 0 or above", _) => "-1",
        ("text in quotes" | "true, false" | "the name of a file, beside the scene", _) => "1",
        ("three numbers" | "two numbers" | "a list of numbers" | "three numbers; needs links", _) => "1.0",
        ("a number, or three" | "three rows of three numbers, in place of sigma", _) => "[1.0, 2.0]",
        ("three numbers above 0", _) => "[1.0, 1.0, -1.0]",
        ("two numbers, neither 0", _) => "[0.0, 1.0]",
        ("two numbers above 0, at most 1", _) => "[0.5, 2.0]",
        ("a list of tables; needs base", _) => "[1.0]",
        ("1 to 9, or a pair", _) => "10",
        ("[x0, x1, y0, y1] in order", _) => "[1.0, 0.0, 0.0, 1.0]",
        ("auto, tangent, position, equal, or [WZ, WX, WY]", _) => "\"heavy\"",
        ("auto, or [Z, DEG], both above 0", _) => "[0.0, 1.0]",
        ("0 to below 0.5", _) => "0.5",
        ("none, auto, or lambda, 0 or above", _) => "-1.0",
        ("above 0, below 1", _) => "1.0",
        (_, "parts") => "[]",
        (_, "second") => "1",
        (words, _) => {
            assert!(key.schema.get("enum").is_some(), "{}: {words}: which value is none of those?", key.name);
            "\"zzz\""
        }
    }
}

#[test]
fn what_is_out_of_range_is_refused() {
    for entry in entries() {
        let entry = &entry;
        for key in &all(entry) {
            let wrong = wrong(key);
            let lines = needed(entry, key.name) + &format!("{} = {wrong}\n", key.name);
            assert!(read(entry, &lines).is_err(), "{}: {} = {wrong} is taken", entry.name, key.name);
            if let Some(words) = key.schema["enum"].as_array() {
                // a plane has nothing to go around
                let possible = key.name != "path" && (key.name != "distribution" || draws(entry));
                for word in words.iter().filter(|_| possible) {
                    let lines = needed(entry, key.name) + &format!("{} = {word}\n", key.name);
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
