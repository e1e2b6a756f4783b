//! What is wrong with a scene file, and where.

use palpate_world::scene::SceneError;

/// A scene that cannot be read. Lines and columns count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneFileError {
    /// Not TOML.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line.
        line: usize,
        /// Column.
        column: usize,
        /// The parser's words.
        message: String,
    },
    /// A key, effect or word that nothing knows.
    #[error("line {line}, column {column}: unknown {what} `{name}`{nearest}; known here: {known}")]
    Unknown {
        /// Line.
        line: usize,
        /// Column.
        column: usize,
        /// Key of `[section]`, effect, surface, ...
        what: String,
        /// What stands there.
        name: String,
        /// ", did you mean `...`?" or empty.
        nearest: String,
        /// Everything that could stand there.
        known: String,
    },
    /// A value of the wrong type or out of range.
    #[error("line {line}, column {column}: {key} is {found}; {expected}")]
    Value {
        /// Line.
        line: usize,
        /// Column.
        column: usize,
        /// Full key.
        key: String,
        /// What stands there.
        found: String,
        /// What would be right.
        expected: String,
    },
    /// A key that must be there is not.
    #[error("line {line}, column {column}: [{section}] lacks `{key}`; {expected}")]
    Missing {
        /// Line of the section.
        line: usize,
        /// Column of the section.
        column: usize,
        /// Section.
        section: String,
        /// Key.
        key: &'static str,
        /// What would be right.
        expected: String,
    },
    /// Two keys that exclude each other.
    #[error("line {line}, column {column}: {first} and {second} contradict each other; give one")]
    Clash {
        /// Line of the second.
        line: usize,
        /// Column of the second.
        column: usize,
        /// One key with its value.
        first: String,
        /// The other.
        second: String,
    },
    /// Well written, but such a world cannot be.
    #[error(transparent)]
    World(#[from] SceneError),
    /// An imported surface could not be had.
    #[error("line {line}, column {column}: surface file {file}: {reason}")]
    Import {
        /// Line.
        line: usize,
        /// Column.
        column: usize,
        /// File named.
        file: String,
        /// What went wrong.
        reason: String,
    },
    /// No built-in scene of this name.
    #[error("there is no built-in scene `{name}`{nearest}; `palpate scenes` lists them")]
    NoSuchScene {
        /// What was asked for.
        name: String,
        /// ", did you mean `...`?" or empty.
        nearest: String,
    },
}
