//! What a scene file may hold, key by key: meaning, unit, range, default and an example. `palpate help scene` prints it.
//!
//! ```text
//! Entry   a surface, an effect or a section      [surface] kind = "torus"
//! Key     name, example, default, range, meaning  minor = 2.0     required     above 0     radius of the tube
//! ```
//!
//! The tests below hold every entry against the code that reads it: the same keys, the same required ones, the same
//! defaults and ranges. A key that is read and not described here fails them.

mod effects;
mod sections;
mod surfaces;
mod text;

pub(crate) use text::{scene_manual, scene_topics};

/// Something that a scene file may hold.
pub(super) struct Entry {
    /// `surface`, `effects.NAME`, `sweep`, ...
    pub(super) table: &'static str,
    /// The kind of surface.
    pub(super) kind: Option<&'static str>,
    /// What it is, in a sentence.
    pub(super) about: &'static str,
    /// Its own keys.
    pub(super) keys: &'static [Key],
}

/// One key.
pub(super) struct Key {
    pub(super) name: &'static str,
    /// A value as it stands in a file.
    pub(super) example: &'static str,
    pub(super) default: Default,
    pub(super) range: Range,
    /// What it says, with its unit.
    pub(super) meaning: &'static str,
}

/// What holds where a key is left out.
pub(super) enum Default {
    /// The scene is refused.
    Required,
    /// The same as this value.
    Value(&'static str),
    /// In words.
    Words(&'static str),
}

/// Which values are taken.
pub(super) enum Range {
    /// Every number.
    Any,
    /// Numbers above zero.
    Positive,
    /// Zero and above.
    NotNegative,
    /// From 0 to 1.
    Probability,
    /// A few words.
    Words(&'static [&'static str]),
    /// In words; with a value that is refused, for the tests.
    Other(&'static str, #[cfg_attr(not(test), expect(dead_code, reason = "the tests try it"))] &'static str),
}

impl Range {
    fn words(&self) -> String {
        match self {
            Range::Any => "any number".into(),
            Range::Positive => "above 0".into(),
            Range::NotNegative => "0 or above".into(),
            Range::Probability => "0 to 1".into(),
            Range::Words(words) => words.join(", "),
            Range::Other(words, _) => (*words).into(),
        }
    }
}

/// Everything, in the order of a file.
fn entries() -> impl Iterator<Item = &'static Entry> {
    let lists = [sections::SCENE, surfaces::SURFACES, sections::SWEEP, effects::EFFECTS, sections::FIT];
    lists.into_iter().flatten()
}

/// Keys that every surface, or every effect, has beside its own.
fn shared(entry: &Entry) -> &'static [Key] {
    match entry.table {
        "surface" => surfaces::SHARED,
        table if table.starts_with("effects.") => effects::SHARED,
        _ => &[],
    }
}

/// Number, default, range and meaning of a key in one line.
macro_rules! keys {
    ($($name:literal = $example:literal, $default:expr, $range:expr, $meaning:literal;)*) => {
        &[$($crate::io::scene_file::manual::Key { name: $name, example: $example, default: $default, range: $range, meaning: $meaning }),*]
    };
}
use keys;

#[cfg(test)]
mod tests;
