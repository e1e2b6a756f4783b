//! Between crates the compiler holds that imports go downwards. Inside a crate this test does: every `crate::room` path is parsed
//! and held against the floors. So do the inner rooms of a room that has some, whichever way their paths are written. No two
//! files import each other.

mod files;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// The crates, each a folder under `src/`.
const CRATES: [&str; 8] = ["numeric", "geometry", "world", "fitting", "hierarchical", "inference", "studies", "app"];

/// Floor of every room inside its crate; siblings on one floor do not import each other.
const FLOORS: [(&str, u8); 41] = [
    ("simd", 0),
    ("threads", 0),
    ("vector", 0),
    ("work", 0),
    ("error", 0),
    ("statistics", 1),
    ("levenberg_marquardt", 1),
    ("brent", 1),
    ("convex_hull", 1),
    ("dense", 1),
    ("contact", 1),
    ("bspline", 1),
    ("linalg", 1),
    ("curvature", 1),
    ("mesh", 1),
    ("draws", 1),
    ("scene", 2),
    ("observation", 2),
    ("solve", 2),
    ("surface", 2),
    ("neighbours", 2),
    ("primitives", 2),
    ("factor", 2),
    ("space", 2),
    ("shape", 3),
    ("field", 3),
    ("bodies", 4),
    ("fit", 4),
    ("comparison", 4),
    ("equations", 4),
    ("parametric", 5),
    ("plans", 5),
    ("recognition", 5),
    ("montecarlo", 6),
    ("explore", 6),
    ("parts", 6),
    ("adaptive", 6),
    ("frontier", 7),
    ("io", 7),
    ("report", 8),
    ("cli", 9),
];

/// Floors of the inner rooms, of rooms that have some; a file that stands beside them is held like an inner room. The room's own
/// `mod.rs` stands above all of them, and only tests stand above that.
const INNER: [(&str, &[(&str, u8)]); 1] = [(
    "recognition",
    &[
        ("error", 0),
        ("hypothesis", 0),
        ("options", 0),
        ("remark", 0),
        ("kinds", 1),
        ("contacts", 2),
        ("discrepancy", 3),
        ("start", 4),
        ("equations", 4),
        ("noise", 5),
        ("evidence", 6),
        ("region", 7),
        ("result", 8),
        ("answer", 9),
        ("sequential", 9),
        ("shape_report", 9),
        ("free_form", 10),
        ("whole_body", 11),
        ("mod", 12),
        ("tests", 13),
    ],
)];

/// Every `crate::room` named in a file, `use crate::{a, b}` included; a `mod tests` may look anywhere for its oracle.
fn rooms_named(source: &str) -> Vec<String> {
    let file: TokenStream = source.parse().expect("the file parses");
    let mut found = Vec::new();
    collect(file, &mut found);
    found
}

fn collect(stream: TokenStream, found: &mut Vec<String>) {
    let tokens: Vec<TokenTree> = stream.into_iter().collect();
    for (k, token) in tokens.iter().enumerate() {
        let word = |at: usize, expected: &str| matches!(&tokens[at], TokenTree::Ident(i) if i == expected);
        let in_tests = k >= 2 && word(k - 2, "mod") && word(k - 1, "tests");
        if let TokenTree::Group(group) = token
            && !in_tests
        {
            collect(group.stream(), found);
        }
        let is_crate = matches!(token, TokenTree::Ident(i) if i == "crate");
        let colons = |at: usize| matches!(tokens.get(at), Some(TokenTree::Punct(p)) if p.as_char() == ':');
        if !(is_crate && colons(k + 1) && colons(k + 2)) {
            continue;
        }
        match tokens.get(k + 3) {
            Some(TokenTree::Ident(room)) => found.push(room.to_string()),
            Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace => {
                let mut first = true;
                for inner in group.stream() {
                    match inner {
                        TokenTree::Ident(room) if first => {
                            found.push(room.to_string());
                            first = false;
                        }
                        TokenTree::Punct(p) if p.as_char() == ',' => first = true,
                        _ => first = false,
                    }
                }
            }
            _ => {}
        }
    }
}

/// Imports that do not go strictly downwards.
fn faults(room: &str, source: &str) -> Vec<String> {
    let floors: BTreeMap<&str, u8> = FLOORS.into_iter().collect();
    let Some(own) = floors.get(room) else { return vec![format!("room {room} stands on no floor")] };
    rooms_named(source)
        .into_iter()
        .filter(|other| other != room)
        .filter_map(|other| match floors.get(other.as_str()) {
            Some(floor) if floor < own => None,
            Some(_) => Some(format!("{room} imports {other}, which is not below it")),
            None => Some(format!("{room} imports crate::{other}, which is no room")),
        })
        .collect()
}

/// Imports between the inner rooms of a room that do not go strictly downwards; `sources` are `(path below src, text)`.
fn inner_faults(room: &str, floors: &[(&str, u8)], sources: &[(String, String)]) -> Vec<String> {
    let inner = |file: &str| {
        let inside = file.strip_prefix(room)?.strip_prefix('/')?;
        inside.split('/').next().map(|first| first.trim_end_matches(".rs").to_string())
    };
    let floor = |name: &str| floors.iter().find(|(known, _)| *known == name).map(|(_, floor)| *floor);
    let standing: BTreeSet<String> = sources.iter().filter_map(|(file, _)| inner(file)).collect();
    let nowhere = standing.iter().filter(|name| floor(name).is_none());
    let mut found: Vec<String> = nowhere.map(|name| format!("{room}/{name} stands on no floor")).collect();
    for [from, to] in files::imports(sources) {
        let (Some(own), Some(other)) = (inner(&from), inner(&to)) else { continue };
        if own != other && floor(&other) >= floor(&own) {
            found.push(format!("{from} imports {to}, which is not below {room}/{own}"));
        }
    }
    found
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("src is there") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Imports of all files of a crate that do not go strictly downwards between its rooms.
fn faults_of_crate(name: &str) -> Vec<String> {
    let room = |file: &str| file.split('/').next().unwrap_or(file).trim_end_matches(".rs").to_string();
    let files = files_of(name);
    assert!(files.len() > 10, "the walk of {name} found only {} files", files.len());
    let standing = files.iter().filter(|(file, _)| file != "lib.rs");
    standing
        .flat_map(|(file, source)| {
            faults(&room(file), source).into_iter().map(move |fault| format!("{name}/{file}: {fault}"))
        })
        .collect()
}

#[test]
fn imports_go_strictly_downwards() {
    let all: Vec<String> = CRATES.into_iter().flat_map(faults_of_crate).collect();
    assert!(all.is_empty(), "{all:#?}");
}

#[test]
fn an_upward_import_is_caught() {
    let fixture = include_str!("../fixtures/upward_import.rs.txt");
    assert_eq!(
        faults("solve", fixture),
        ["solve imports fit, which is not below it", "solve imports observation, which is not below it"]
    );
    assert!(faults("cli", fixture).is_empty());
    assert_eq!(faults("cellar", "").len(), 1);
}

/// All files of a crate as `(path below the crate's folder, text)`.
fn files_of(name: &str) -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(name);
    let mut paths = Vec::new();
    sources(&folder, &mut paths);
    paths.sort();
    let read = |path: &PathBuf| {
        let inside = path.strip_prefix(&folder).expect("below the crate").to_string_lossy().replace('\\', "/");
        (inside, std::fs::read_to_string(path).expect("readable"))
    };
    paths.iter().map(read).collect()
}

/// The files of a fixture, each behind a line `// file: NAME`.
fn fixture_files(fixture: &str) -> Vec<(String, String)> {
    let named = |part: &str| {
        let (name, text) = part.split_once('\n').expect("a name and a text");
        (name.trim().to_string(), text.to_string())
    };
    fixture.split("// file: ").skip(1).map(named).collect()
}

#[test]
fn inner_rooms_import_strictly_downwards() {
    let library = files_of("inference");
    for (room, floors) in INNER {
        let found = inner_faults(room, floors, &library);
        assert!(found.is_empty(), "{found:#?}");
        let gone = floors.iter().filter(|(name, _)| {
            let [folder, file] = [format!("{room}/{name}/mod.rs"), format!("{room}/{name}.rs")];
            !library.iter().any(|(path, _)| *path == folder || *path == file)
        });
        assert_eq!(gone.count(), 0, "a floor of {room} on which nothing stands");
    }
}

#[test]
fn an_upward_import_between_inner_rooms_is_caught() {
    let files = fixture_files(include_str!("../fixtures/inner_upward_import.rs.txt"));
    let floors = [("cellar", 0), ("stairs", 1), ("hall", 1), ("attic", 2), ("mod", 3)];
    let expected = [
        "house/cellar/stone.rs imports house/attic/roof.rs, which is not below house/cellar",
        "house/cellar/stone.rs imports house/hall.rs, which is not below house/cellar",
        "house/hall.rs imports house/stairs.rs, which is not below house/hall",
        "house/stairs.rs imports house/mod.rs, which is not below house/stairs",
    ];
    assert_eq!(inner_faults("house", &floors, &files), expected);
    assert!(inner_faults("house", &floors[..4], &files).contains(&"house/mod stands on no floor".to_string()));
}

#[test]
fn no_two_files_import_each_other() {
    for name in CRATES {
        let found = files::circles(&files_of(name));
        assert!(found.is_empty(), "{name}: {found:#?}");
    }
}

#[test]
fn files_that_import_each_other_are_caught() {
    let found = files::circles(&fixture_files(include_str!("../fixtures/file_circle.rs.txt")));
    let expected: [&[&str]; 3] = [
        &["chain/first.rs", "chain/second.rs", "chain/third.rs"],
        &["ring/driver.rs", "ring/loss.rs"],
        &["ring/outer.rs", "ring/shared.rs"],
    ];
    assert_eq!(found, expected);
}

#[test]
fn unsafe_code_stays_in_its_room() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src, &mut files);
    for path in files {
        let source = std::fs::read_to_string(&path).expect("readable");
        let tokens: TokenStream = source.parse().expect("the file parses");
        let inside = path.strip_prefix(&src).expect("below src");
        let may = ["numeric/simd", "capi"].iter().any(|room| inside.starts_with(room));
        assert!(may || !has_unsafe(tokens), "{}", inside.display());
    }
}

fn has_unsafe(stream: TokenStream) -> bool {
    stream.into_iter().any(|token| match token {
        TokenTree::Ident(word) => word == "unsafe",
        TokenTree::Group(group) => has_unsafe(group.stream()),
        _ => false,
    })
}
