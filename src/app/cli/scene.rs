//! A scene by its built-in name, from a file, or from standard input.

use std::path::{Path, PathBuf};

use crate::io::scene_file::{SceneFile, SceneFileError, builtin, builtin_text, read_scene_with};
use crate::io::{import_surface, read_bytes, visible};

use super::failure::Failure;

/// The scene that `run` takes when none is named.
pub(super) const DEFAULT: &str = "bar";

/// A scene as text, with where its imported surfaces are looked for.
pub(super) struct Source {
    /// Built-in name or file.
    pub(super) name: String,
    /// TOML.
    pub(super) text: String,
    folder: PathBuf,
}

impl Source {
    /// The text of a scene that stood in the file `name`.
    pub(super) fn of_text(name: &str, text: String) -> Source {
        // - has no folder: its surfaces are looked for where palpate was started
        let folder = Path::new(name).parent().unwrap_or(Path::new("")).to_path_buf();
        Source { name: name.into(), text, folder }
    }

    /// The same scene written otherwise.
    pub(super) fn with_text(&self, text: String) -> Source {
        Source { name: self.name.clone(), text, folder: self.folder.clone() }
    }

    /// The scene it describes, or what to say to whoever named another kind of file.
    pub(super) fn scene(&self) -> Result<SceneFile, Failure> {
        self.read().map_err(|e| Failure::Input(format!("{}: {e}{}", self.name, for_contacts(&self.name))))
    }

    /// The scene it describes.
    pub(super) fn read(&self) -> Result<SceneFile, SceneFileError> {
        let mut read = read_scene_with(&self.text, &|name| import_surface(&self.folder, name))?;
        if read.name.is_empty() {
            read.name.clone_from(&self.name);
        }
        read.name = visible(&read.name);
        Ok(read)
    }
}

/// Built-in names come first; a file of such a name is meant by `./name`.
pub(super) fn source(scene: &str) -> Result<Source, Failure> {
    if let Some(known) = builtin_text(scene) {
        return Ok(Source { name: scene.into(), text: known.into_owned(), folder: PathBuf::new() });
    }
    if scene != "-" && !Path::new(scene).exists() {
        let beside = format!("{scene}.toml");
        let beside = if Path::new(&beside).exists() { format!(", but there is {beside}") } else { String::new() };
        let nearest = builtin(scene).err().map_or(String::new(), |e| e.to_string());
        return Err(Failure::Input(format!("{scene}: there is no such file{beside}; {nearest}")));
    }
    let (file, bytes) = read_bytes(Path::new(scene))?;
    let text = String::from_utf8(bytes)
        .map_err(|_| Failure::Input(format!("{file}: not UTF-8 text, so no TOML{}", for_contacts(scene))))?;
    Ok(Source { name: file, ..Source::of_text(scene, text) })
}

/// The scene of this name or file.
pub(super) fn load(scene: &str) -> Result<SceneFile, Failure> {
    load_with_text(scene).map(|(scene, _)| scene)
}

/// The same with its TOML.
pub(super) fn load_with_text(scene: &str) -> Result<(SceneFile, String), Failure> {
    let source = source(scene)?;
    Ok((source.scene()?, source.text))
}

/// What to do with a file that may hold contacts and no scene, by its name.
fn for_contacts(scene: &str) -> String {
    let ending = Path::new(scene).extension().map(|ending| ending.to_ascii_lowercase());
    match ending {
        Some(ending) if ending != "toml" => {
            format!(
                "; a scene is a TOML file (palpate help scene), and contacts are fitted by palpate fit {}",
                visible(scene)
            )
        }
        _ => String::new(),
    }
}
