//! What a scene file may hold, key by key: meaning, unit, range, default and an example. `palpate help scene` prints it.
//!
//! ```text
//! Entry   a surface, an effect or a section      [surface] kind = "torus"
//! Key     name, example, default, range, meaning  minor = 2.0     required     above 0     radius of the tube
//! ```
//!
//! All of it comes from the types that the reader reads into, see [`super::keys`]. The tests below hold every entry
//! against the reader: its examples, defaults and ranges are what is read, what holds and what is taken.

pub(super) mod entry;
mod text;

pub(crate) use text::{scene_manual, scene_topics};

use entry::{Entry, Key};

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
        "effects" => Key::all::<super::effects::LawKeys>(),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests;
