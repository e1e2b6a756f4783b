//! A surface, an effect or a section of a scene with its keys, as the schema of its type tells them.

use serde_json::Value as Json;
use toml::de::DeTable;

use crate::io::scene_file::keys::{Keys, schema_of};
use crate::io::scene_file::section::Section;

/// Something that a scene file may hold.
pub(in crate::io::scene_file) struct Entry {
    /// `surface`, `sweep`, `effects`, `fit` or, for the top of the file, nothing.
    pub(super) group: &'static str,
    /// The kind of surface, the name of the effect or of the section.
    pub(super) name: &'static str,
    /// What it is, in a sentence.
    pub(super) about: String,
    /// Its own keys.
    pub(super) keys: Vec<Key>,
}

/// One key.
pub(in crate::io::scene_file) struct Key {
    pub(super) name: &'static str,
    pub(super) schema: Json,
}

impl Entry {
    /// What the type `K` describes.
    pub(in crate::io::scene_file) fn of<K: Keys>(group: &'static str, name: &'static str) -> Entry {
        Entry { group, name, about: description(&schema_of::<K>()), keys: Key::all::<K>() }
    }

    /// `surface`, `effects.NAME`, `sweep`, ...
    pub(super) fn table(&self) -> String {
        match self.group {
            "surface" => "surface".into(),
            "effects" => format!("effects.{}", self.name),
            _ => self.name.into(),
        }
    }
}

impl Key {
    /// The keys of the type `K`, in the order of its fields.
    pub(in crate::io::scene_file) fn all<K: Keys>() -> Vec<Key> {
        let schema = schema_of::<K>();
        let key = |name| Key { name, schema: schema["properties"][name].clone() };
        names::<K>().into_iter().map(key).collect()
    }

    /// A value as it stands in a file.
    pub(super) fn example(&self) -> String {
        let written = self.schema["x-example"].as_str().map(String::from);
        written.unwrap_or_else(|| toml_of(&self.schema["examples"][0]))
    }

    /// What holds where the key is left out; `None` where the scene is refused.
    pub(super) fn left_out(&self) -> Option<String> {
        match (&self.schema["x-left-out"], &self.schema["default"]) {
            (Json::String(words), _) => Some(words.clone()),
            (_, Json::Null) => None,
            (_, value) => Some(toml_of(value)),
        }
    }

    /// What it says, with its unit: the doc comment, within a sentence.
    pub(super) fn meaning(&self) -> String {
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
    pub(super) fn range(&self) -> String {
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
