//! Which format bytes are in, by the first of them; the name's ending decides only where the bytes cannot.
//!
//! What is of no format that is read is told what it looks like: whoever typed the wrong name wants to hear "a JPEG image",
//! not "line 1 is not a header".

use super::separator::declared_separator;

/// A format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Npz,
    Npy,
    Ply,
    Pcd,
    Off,
    Obj,
    Stl,
    Png,
    /// Names and rows; whatever nothing else claims.
    Table,
}

/// Every format of contacts, for whoever came with another one.
pub(super) const READ: &str = "tables of text with a header such as x,y,z,nx,ny,nz (CSV, XYZ, PTS), NPZ, NPY, PLY, PCD, OBJ, OFF, STL, \
                    depth images (PNG, NPZ), each also as .gz";

/// First bytes of formats that are not read, and their names.
const STRANGERS: [(&[u8], &str); 28] = [
    (b"\xff\xd8\xff", "a JPEG image"),
    (b"GIF8", "a GIF image"),
    (b"II*\0", "a TIFF image"),
    (b"MM\0*", "a TIFF image"),
    (b"RIFF", "a sound, a film or a WebP image"),
    (b"v/1\x01", "an OpenEXR image"),
    (b"%PDF", "a PDF document"),
    (b"\x89HDF", "HDF5 data"),
    (b"CDF\x01", "NetCDF data"),
    (b"CDF\x02", "NetCDF data"),
    (b"MATLAB 5.0", "a MATLAB file"),
    (b"LASF", "a LAS point cloud"),
    (b"ASTM-E57", "an E57 point cloud"),
    (b"glTF", "a glTF model"),
    (b"Kaydara FBX", "an FBX model"),
    (b"# vtk DataFile", "a VTK file"),
    (b"#ROSBAG", "a ROS bag"),
    (b"\x89MCAP", "an MCAP recording"),
    (b"SQLite format 3", "an SQLite database"),
    (b"PAR1", "a Parquet table"),
    (b"ARROW1", "an Arrow table"),
    (b"\x80\x04\x95", "a Python pickle"),
    (b"BZh", "data packed by bzip2"),
    (b"\xfd7zXZ", "data packed by xz"),
    (b"\x28\xb5\x2f\xfd", "data packed by zstd"),
    (b"7z\xbc\xaf", "a 7-Zip archive"),
    (b"\x7fELF", "a program"),
    (b"\xd0\xcf\x11\xe0", "an old Excel or Word document"),
];

/// How much of a file is looked at.
const HEAD: usize = 4096;

/// The format of `bytes`; `ending` is the file name's, in lower case, without `.gz`.
///
/// # Errors
/// What the bytes look like, in words, where that is no format that is read.
pub(super) fn form_of(bytes: &[u8], ending: &str) -> Result<Form, &'static str> {
    if let Some(form) = by_magic(bytes) {
        return Ok(form);
    }
    if let Some((_, name)) = STRANGERS.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Err(name);
    }
    // two letters alone may be the start of a column's name
    if bytes.starts_with(b"BM") && bytes.get(6..10) == Some(&[0; 4]) {
        return Err("a BMP image");
    }
    if is_binary_stl(bytes) {
        return Ok(Form::Stl);
    }
    if let Some(form) = by_ending(ending).filter(|_| !bytes.is_empty()) {
        return Ok(form);
    }
    let head = &bytes[..bytes.len().min(HEAD)];
    if head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff") {
        return Err("text in UTF-16 (save it as UTF-8)");
    }
    if head.contains(&0) {
        return Err("binary data of a kind that is not known here");
    }
    let text = String::from_utf8_lossy(head);
    match by_words(&text) {
        Some(form) => Ok(form),
        None => strange_text(&text).map_or(Ok(Form::Table), Err),
    }
}

fn by_magic(bytes: &[u8]) -> Option<Form> {
    let starts: [(&[u8], Form); 7] = [
        (b"PK\x03\x04", Form::Npz),
        (b"PK\x05\x06", Form::Npz),
        (b"\x93NUMPY", Form::Npy),
        (b"ply\n", Form::Ply),
        (b"ply\r", Form::Ply),
        (b"# .PCD", Form::Pcd),
        (b"\x89PNG\r\n\x1a\n", Form::Png),
    ];
    starts.into_iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, form)| form)
}

fn by_ending(ending: &str) -> Option<Form> {
    let endings = [
        ("npz", Form::Npz),
        ("npy", Form::Npy),
        ("ply", Form::Ply),
        ("pcd", Form::Pcd),
        ("off", Form::Off),
        ("obj", Form::Obj),
        ("stl", Form::Stl),
        ("png", Form::Png),
    ];
    endings.into_iter().find(|(known, _)| *known == ending).map(|(_, form)| form)
}

/// A binary STL has no magic, but its length follows from its count: 84 bytes and 50 for each triangle.
pub(super) fn is_binary_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(80..84).and_then(|b| <[u8; 4]>::try_from(b).ok()).map(u32::from_le_bytes);
    count.is_some_and(|n| n > 0 && bytes.len() as u64 == 84 + 50 * u64::from(n))
}

/// Formats that begin with words.
fn by_words(text: &str) -> Option<Form> {
    let line = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'))?;
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |word: &&str| word.parse::<f64>().is_ok();
    match words[..] {
        ["VERSION" | "FIELDS", ..] => Some(Form::Pcd),
        [word, ..] if word.len() <= 8 && word.trim_start_matches(['S', 'T', 'C', 'N', '4', 'n']) == "OFF" => {
            Some(Form::Off)
        }
        ["solid", ..] if text.contains("facet") => Some(Form::Stl),
        ["v" | "vn", ref rest @ ..] if rest.len() >= 3 && rest.iter().all(number) => Some(Form::Obj),
        ["mtllib" | "o" | "g", _] if text.lines().any(|line| line.starts_with("v ")) => Some(Form::Obj),
        _ => None,
    }
}

/// Text that is no table.
fn strange_text(text: &str) -> Option<&'static str> {
    let start = text.trim_start_matches('\u{feff}').trim_start();
    let lower = start.get(..start.len().min(64)).unwrap_or_default().to_ascii_lowercase();
    let starts = [
        ("<!doctype html", "HTML: a web page, perhaps an error page of the server it was fetched from"),
        ("<html", "HTML: a web page, perhaps an error page of the server it was fetched from"),
        ("<?xml", "XML"),
        ("<svg", "an SVG picture"),
        ("iso-10303-21", "a STEP file (palpate show and palpate diff take surfaces)"),
        ("{", "JSON (palpate show and palpate diff take saved surfaces)"),
        ("[{", "JSON"),
        ("[[", "JSON"),
        ("version https://git-lfs", "a Git LFS pointer: the data themselves were not fetched"),
        ("%yaml", "YAML"),
    ];
    let known = starts.into_iter().find(|(known, _)| lower.starts_with(known)).map(|(_, name)| name);
    known.or_else(|| is_toml(start).then_some("TOML: a scene, perhaps, which palpate run and palpate simulate take"))
}

/// The first line that says something is a table's name in brackets, or a name, an equals sign and a value.
fn is_toml(text: &str) -> bool {
    let Some(line) = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#')) else {
        return false;
    };
    let name = |word: &str| !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || "_-.".contains(c));
    if declared_separator(line).is_some() {
        return false;
    }
    let table = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    table.is_some_and(name) || line.split_once('=').is_some_and(|(key, value)| name(key.trim()) && !value.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_known_by_their_first_bytes() {
        let cases: [(&[u8], Form); 15] = [
            (b"BM,x,y,z\n1,2,3,4\n", Form::Table),
            (b"x,y,z\n", Form::Table),
            (b"", Form::Table),
            (b"# a remark\nx y z\n", Form::Table),
            (b"# .PCD v0.7\n", Form::Pcd),
            (b"# made elsewhere\nVERSION .7\nFIELDS x y z\n", Form::Pcd),
            (b"COFF\n1 0 0\n", Form::Off),
            (b"OFF 1 0 0\n", Form::Off),
            (b"solid a\n facet normal 0 0 1\n", Form::Stl),
            (b"# Blender\nmtllib a.mtl\nv 1 2 3\n", Form::Obj),
            (b"v 1 2 3\n", Form::Obj),
            (b"\x93NUMPY\x01\0", Form::Npy),
            (b"off,on,x\n", Form::Table),
            (b"[x],[y],[z]\n", Form::Table),
            (b"sep=;\nx;y;z\n", Form::Table),
        ];
        for (bytes, form) in cases {
            assert_eq!(form_of(bytes, ""), Ok(form), "{:?}", String::from_utf8_lossy(bytes));
        }
        assert_eq!(form_of(b"nonsense", "obj"), Ok(Form::Obj));
        assert_eq!(form_of(b"", "ply"), Ok(Form::Table));
    }

    #[test]
    fn strangers_are_named() {
        let cases: [(&[u8], &str); 9] = [
            (b"# mine\n\n[surface]\nkind = \"sphere\"\n", "TOML"),
            (b"name = \"a bar\"\n", "palpate run"),
            (b"ISO-10303-21;\n", "STEP"),
            (b"\xff\xd8\xff\xe0", "JPEG"),
            (b"\n<!DOCTYPE HTML>", "HTML"),
            (b"{\"x\": 1}", "JSON"),
            (b"\xff\xfex\0,\0", "UTF-16"),
            (b"\x01\x02\0\0", "binary"),
            (b"version https://git-lfs.github.com/spec/v1", "Git LFS"),
        ];
        for (bytes, word) in cases {
            assert!(form_of(bytes, "csv").unwrap_err().contains(word), "{word}");
        }
    }
}
