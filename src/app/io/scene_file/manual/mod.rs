//! What a scene file may hold, key by key: meaning, unit, range, default and an example. `palpate help scene` prints it.
//!
//! ```text
//! Entry   a surface, an effect or a section      [surface] kind = "torus"
//! Key     name, example, default, range, meaning  minor = 2.0     required     above 0     radius of the tube
//! ```
//!
//! All of it comes from the types that the reader reads into, see [`super::keys`]. The tests below hold every entry
//! against the reader: its examples, defaults and ranges are what is read, what holds and what is taken.

mod text;

pub(crate) use text::{scene_manual, scene_topics};

use serde_json::Value as Json;
use toml::de::DeTable;

use super::keys::{Keys, schema_of};
use super::section::Section;

/// Something that a scene file may hold.
pub(super) struct Entry {
    /// `surface`, `sweep`, `effects`, `fit` or, for the top of the file, nothing.
    group: &'static str,
    /// The kind of surface, the name of the effect or of the section.
    name: &'static str,
    /// What it is, in a sentence.
    about: String,
    /// Its own keys.
    keys: Vec<Key>,
}

/// One key.
pub(super) struct Key {
    name: &'static str,
    schema: Json,
}

impl Entry {
    /// What the type `K` describes.
    pub(super) fn of<K: Keys>(group: &'static str, name: &'static str) -> Entry {
        Entry { group, name, about: description(&schema_of::<K>()), keys: Key::all::<K>() }
    }

    /// `surface`, `effects.NAME`, `sweep`, ...
    fn table(&self) -> String {
        match self.group {
            "surface" => "surface".into(),
            "effects" => format!("effects.{}", self.name),
            _ => self.name.into(),
        }
    }
}

impl Key {
    /// The keys of the type `K`, in the order of its fields.
    pub(super) fn all<K: Keys>() -> Vec<Key> {
        let schema = schema_of::<K>();
        let key = |name| Key { name, schema: schema["properties"][name].clone() };
        names::<K>().into_iter().map(key).collect()
    }

    /// A value as it stands in a file.
    fn example(&self) -> String {
        let written = self.schema["x-example"].as_str().map(String::from);
        written.unwrap_or_else(|| toml_of(&self.schema["examples"][0]))
    }

    /// What holds where the key is left out; `None` where the scene is refused.
    fn left_out(&self) -> Option<String> {
        match (&self.schema["x-left-out"], &self.schema["default"]) {
            (Json::String(words), _) => Some(words.clone()),
            (_, Json::Null) => None,
            (_, value) => Some(toml_of(value)),
        }
    }

    /// What it says, with its unit: the doc comment, within a sentence.
    fn meaning(&self) -> String {
        let text = description(&self.schema);
        let text = text.trim_end_matches('.');
        let first = text.split(' ').next().unwrap_or("");
        // a name, such as Denavit-Hartenberg, stays as it is
        if first.chars().skip(1).any(char::is_uppercase) {
            return text.into();
        }
        let mut letters = text.chars();
        letters.next().into_iter().flat_map(char::to_lowercase).chain(letters).collect()
    }

    /// Which values are taken.
    fn range(&self) -> String {
        let (schema, length) = (&self.schema, self.schema["minItems"].as_u64());
        let above_0 = schema["exclusiveMinimum"] == 0;
        let bounds = (schema["minimum"].as_f64(), schema["maximum"].as_f64());
        if let Some(words) = schema["x-range"].as_str() {
            return words.into();
        }
        if let Some(words) = schema["enum"].as_array() {
            return words.iter().filter_map(Json::as_str).collect::<Vec<_>>().join(", ");
        }
        match (schema["type"].as_str(), bounds, length) {
            (Some("string"), ..) => "text in quotes".into(),
            (Some("boolean"), ..) => "true, false".into(),
            (Some("integer"), ..) => format!("a whole number, {} or above", schema["minimum"]),
            (Some("array"), _, Some(2)) => "two numbers".into(),
            (Some("array"), _, Some(3)) => "three numbers".into(),
            (Some("array"), ..) => "a list of numbers".into(),
            (_, (Some(0.0), Some(1.0)), _) => "0 to 1".into(),
            (_, (Some(0.0), _), _) => "0 or above".into(),
            _ if above_0 => "above 0".into(),
            _ => "any number".into(),
        }
    }
}

/// A doc comment in one line.
fn description(schema: &Json) -> String {
    schema["description"].as_str().unwrap_or("").replace('\n', " ")
}

/// A value as TOML writes it.
fn toml_of(value: &Json) -> String {
    toml::Value::try_from(value).map_or_else(|_| value.to_string(), |value| value.to_string())
}

/// The names of the keys: what is known of an empty table once it has been read. That keys are missing does not matter.
fn names<K: Keys>() -> Vec<&'static str> {
    let table = DeTable::new();
    let section = Section::new("", "", &table, 0);
    let _ = section.read::<K>();
    section.known()
}

/// Everything, in the order of a file.
fn entries() -> impl Iterator<Item = Entry> {
    let top = Entry::of::<super::Top>("", "");
    let rest = super::surface::entries().chain([super::sweep::entry()]).chain(super::effects::entries());
    std::iter::once(top).chain(rest).chain(super::fit::entries())
}

/// Keys that every surface, or every effect, has beside its own.
fn shared(entry: &Entry) -> Vec<Key> {
    match entry.group {
        "surface" => super::surface::shared(),
        "effects" => Key::all::<super::effects::Law>(),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests;
