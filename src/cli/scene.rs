//! A scene by its built-in name, from a file, or from standard input.

use std::path::Path;

use crate::io::scene_file::{SceneFile, builtin, builtin_scenes, read_scene_with};
use crate::io::{import_surface, read_bytes};

use super::failure::Failure;

/// The scene that `run` takes when none is named.
pub(super) const DEFAULT: &str = "paper-cylinder";

/// Built-in names come first; a file of such a name is meant by `./name`.
pub(super) fn load(scene: &str) -> Result<SceneFile, Failure> {
    let wrong = |e: crate::io::scene_file::SceneFileError| Failure::Input(e.to_string());
    if builtin_scenes().iter().any(|known| known.name == scene) {
        return builtin(scene).map_err(wrong);
    }
    if scene != "-" && !Path::new(scene).exists() {
        let nearest = builtin(scene).err().map_or(String::new(), |e| e.to_string());
        return Err(Failure::Input(format!("{scene}: there is no such file; {nearest}")));
    }
    let (file, bytes) = read_bytes(Path::new(scene))?;
    let text = String::from_utf8(bytes).map_err(|_| Failure::Input(format!("{file}: not UTF-8 text, so no TOML")))?;
    // - has no folder: its surfaces are looked for where palpate was started
    let folder = Path::new(scene).parent().unwrap_or(Path::new(""));
    let mut read = read_scene_with(&text, &|name| import_surface(folder, name))
        .map_err(|e| Failure::Input(format!("{file}: {e}")))?;
    if read.name.is_empty() {
        read.name = file;
    }
    Ok(read)
}
