//! What a table of a scene holds, as a type says it: serde reads the table into the type, and the schema of the type
//! (its fields, their attributes and doc comments) tells which keys are needed, what is expected of each, and what the
//! manual prints.
//!
//! ```text
//! doc comment     what the table is; what the key means, with its unit
//! range, enum     which values are taken       x-range     ... in words, where numbers do not say it
//! default         what holds without the key   x-left-out  ... in words
//! example         as it stands in a file       x-example   ... where TOML writes it otherwise than we would
//! x-needed        the refusal where the key is missing; of a key that may be missing, where others stand for it
//! x-expected      the refusal of a value that is of the wrong kind
//! x-what          what a word is called that is none of the enum
//! ```

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::Deserialize;
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, IntoDeserializer, MapAccess, Visitor};
use serde::forward_to_deserialize_any;
use serde_json::Value as Json;
use toml::de::ValueDeserializer;

use super::SceneFileError;
use super::section::{Section, Value, as_array, as_count, as_number};

/// A type that describes a table.
pub(super) trait Keys: JsonSchema {
    /// What the table is read into.
    type Read;

    fn read(table: SceneTable) -> Result<Self::Read, Fault>;
}

/// Which types describe tables, and what those are read into.
macro_rules! keys {
    ($($keys:ident => $read:ty),* $(,)?) => {$(
        impl $crate::io::scene_file::keys::Keys for $keys {
            type Read = $read;

            fn read(
                table: $crate::io::scene_file::keys::SceneTable,
            ) -> Result<$read, $crate::io::scene_file::keys::Fault> {
                $keys::deserialize(table)
            }
        }
    )*};
}
pub(super) use keys;

/// The schema of a table. TOML has no null, so what may be null in JSON is simply left out here.
pub(super) fn schema_of<K: JsonSchema>() -> Json {
    let mut settings = SchemaSettings::draft2020_12();
    (settings.inline_subschemas, settings.meta_schema) = (true, None);
    let mut schema = settings.into_generator().into_root_schema_for::<K>().to_value();
    for (_, key) in schema["properties"].as_object_mut().into_iter().flatten() {
        if let Some(kinds) = key["type"].as_array() {
            key["type"] = kinds[0].clone();
        }
        if key["anyOf"][1]["type"] == "null"
            && let Json::Object(inner) = key["anyOf"][0].take()
            && let Some(own) = key.as_object_mut()
        {
            own.remove("anyOf");
            inner.into_iter().for_each(|(word, value)| _ = own.entry(word).or_insert(value));
        }
    }
    schema
}

impl Section<'_> {
    /// The table as the type `K` describes it; its keys are known from now on.
    pub(super) fn read<K: Keys>(&self) -> Result<K::Read, SceneFileError> {
        let schema = schema_of::<K>();
        K::read(SceneTable::new(self, &schema)).map_err(|fault| match fault {
            Fault::Placed(error) => error,
            Fault::Wrong => self.unread(),
        })
    }

    /// The table as a whole is none that the type could be; a table with keys always is one.
    fn unread(&self) -> SceneFileError {
        let (line, column) = self.place();
        SceneFileError::Syntax { line, column, message: format!("[{}] cannot be read", self.path) }
    }

    /// The refusal of a table of type `K` in which this key is needed after all.
    pub(super) fn needed<K: Keys>(&self, key: &'static str) -> SceneFileError {
        self.missing(key, needed(&schema_of::<K>(), key))
    }
}

/// What stops serde.
#[derive(Debug, thiserror::Error)]
pub(super) enum Fault {
    /// All is known of it.
    #[error(transparent)]
    Placed(#[from] SceneFileError),
    /// A value of the wrong kind: whoever knows its key says where.
    #[error("a value of another kind is needed")]
    Wrong,
}

impl serde::de::Error for Fault {
    fn custom<T: std::fmt::Display>(_: T) -> Fault {
        Fault::Wrong
    }
}

/// A table, for serde: keys in the order of the type's fields, whatever their order in the file. So the first fault is
/// the same one however the keys are shuffled. Keys that are no fields are left to [`Section::finish`].
pub(super) struct SceneTable<'s, 'de> {
    section: &'s Section<'de>,
    schema: &'s Json,
    fields: std::slice::Iter<'static, &'static str>,
    held: Option<(&'static str, &'de Value<'de>)>,
}

impl<'s, 'de> SceneTable<'s, 'de> {
    pub(super) fn new(section: &'s Section<'de>, schema: &'s Json) -> SceneTable<'s, 'de> {
        SceneTable { section, schema, fields: [].iter(), held: None }
    }
}

impl<'de> Deserializer<'de> for SceneTable<'_, 'de> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Fault> {
        Err(Fault::Wrong)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        mut self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        self.section.know(fields);
        self.fields = fields.iter();
        visitor.visit_map(self)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit unit_struct newtype_struct
        seq tuple tuple_struct map enum identifier ignored_any
    }
}

impl<'de> MapAccess<'de> for SceneTable<'_, 'de> {
    type Error = Fault;

    fn next_key_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, Fault> {
        for key in self.fields.by_ref() {
            if let Some(value) = self.section.get(key) {
                self.held = Some((key, value));
                let key: StrDeserializer<Fault> = key.into_deserializer();
                return seed.deserialize(key).map(Some);
            }
            if self.schema["required"].as_array().is_some_and(|needed| needed.iter().any(|name| name == key)) {
                return Err(self.section.missing(key, needed(self.schema, key)).into());
            }
        }
        Ok(None)
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, Fault> {
        let Some((key, value)) = self.held.take() else { return Err(Fault::Wrong) };
        let schema = &self.schema["properties"][key];
        if let (Some(words), Some(word)) = (schema["enum"].as_array(), value.get_ref().as_str())
            && !words.iter().any(|known| known == word)
        {
            let known: Vec<&str> = words.iter().filter_map(Json::as_str).collect();
            let what =
                schema["x-what"].as_str().map_or_else(|| format!("value of {}", self.section.full(key)), Into::into);
            return Err(self.section.unknown_word(&what, value, word, &known).into());
        }
        let wrong = || Fault::from(self.section.value_error(key, value, expected(schema, value)));
        if !fits(schema, value) {
            return Err(wrong());
        }
        seed.deserialize(ValueDeserializer::from(value.clone())).map_err(|_| wrong())
    }
}

/// Why a key is needed.
pub(super) fn needed<'j>(schema: &'j Json, key: &str) -> &'j str {
    schema["properties"][key]["x-needed"].as_str().unwrap_or("it is needed")
}

/// Whether a value is of the kind of the schema, or of one of its kinds.
fn fits(schema: &Json, value: &Value) -> bool {
    if let Some(kinds) = schema["anyOf"].as_array() {
        return kinds.iter().any(|kind| fits(kind, value));
    }
    match schema["type"].as_str() {
        Some("string") => value.get_ref().is_str(),
        Some("boolean") => value.get_ref().is_bool(),
        Some("number") => as_number(value).is_some(),
        Some("integer") => as_count(value).is_some_and(|count| count >= schema["minimum"].as_u64().unwrap_or(0)),
        Some("array") => as_array(value).is_some_and(|list| {
            let length = schema["minItems"].as_u64().unwrap_or(list.len() as u64);
            list.len() as u64 == length && list.iter().all(|entry| fits(&schema["items"], entry))
        }),
        _ => true,
    }
}

/// What would be right in place of a value of the wrong kind.
fn expected(schema: &Json, value: &Value) -> String {
    let list = as_array(value);
    let numbers = list.is_some_and(|list| list.iter().all(|entry| as_number(entry).is_some()));
    match (schema["x-expected"].as_str(), schema["type"].as_str(), schema["minItems"].as_u64()) {
        (Some(expected), ..) => expected.into(),
        (_, Some("number"), _) => "a number is needed".into(),
        (_, Some("integer"), _) => format!("a whole number of at least {} is needed", schema["minimum"]),
        (_, Some("boolean"), _) => "true or false is needed".into(),
        (_, Some("array"), Some(length)) if numbers => format!("{length} numbers are needed"),
        (_, Some("array"), _) => "a list of numbers is needed".into(),
        // a word or numbers
        (_, None, _) if list.is_some() => "a list of numbers is needed".into(),
        _ => "a string is needed".into(),
    }
}

/// One number for all three axes, or three.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(extend("x-range" = "a number, or three", "x-expected" = "a number or three (x, y, z) are needed"))]
pub(super) enum OneOrThree {
    One(f64),
    Three([f64; 3]),
}

impl OneOrThree {
    pub(super) fn three(self) -> [f64; 3] {
        match self {
            OneOrThree::One(number) => [number; 3],
            OneOrThree::Three(numbers) => numbers,
        }
    }

    /// The three numbers, for fields that hold them.
    pub(super) fn numbers<'de, D: Deserializer<'de>>(reader: D) -> Result<[f64; 3], D::Error> {
        OneOrThree::deserialize(reader).map(OneOrThree::three)
    }
}
