//! One name, one thing: no two types of `src` have the same name, but for those of a list that only shrinks. No constant is
//! called by a bare bound: it says of what. No comment names a file that is not there.
//!
//! `shared_names.txt` has the names that stand for several things today, each with how many; whoever renames one writes the list anew:
//! `PALPATE_WRITE_NAMES=1 cargo test --test house names` lowers its numbers and raises none.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use proc_macro2::{TokenStream, TokenTree};

/// Names that are no whole name of a constant: most of what?
const BARE: [&str; 6] = ["MOST", "FEWEST", "STEP", "LEAST", "ENOUGH", "FEW"];

/// The list, and where it stands.
const SHARED: (&str, &str) = (include_str!("shared_names.txt"), "tests/house/shared_names.txt");

/// Every `.rs` file below a folder of the repository.
fn files(folder: &str) -> Vec<PathBuf> {
    fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).expect("the folder is there") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                walk(&path, found);
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    walk(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut found);
    found
}

fn tokens(path: &Path) -> TokenStream {
    std::fs::read_to_string(path).expect("readable").parse().expect("the file parses")
}

/// Names that are defined behind one of these words; a `mod tests` may have types of its own.
fn defined(stream: TokenStream, words: &[&str], with_tests: bool, found: &mut Vec<String>) {
    let tokens: Vec<TokenTree> = stream.into_iter().collect();
    let is = |at: usize, expected: &str| matches!(&tokens[at], TokenTree::Ident(word) if word == expected);
    for (k, token) in tokens.iter().enumerate() {
        let in_tests = k >= 2 && is(k - 2, "mod") && is(k - 1, "tests");
        match (token, tokens.get(k + 1)) {
            (TokenTree::Group(group), _) if with_tests || !in_tests => {
                defined(group.stream(), words, with_tests, found)
            }
            (TokenTree::Ident(word), Some(TokenTree::Ident(name))) if words.iter().any(|known| word == known) => {
                found.push(name.to_string());
            }
            _ => {}
        }
    }
}

/// Types by their name, with how many there are.
fn types(streams: impl Iterator<Item = TokenStream>) -> BTreeMap<String, usize> {
    let mut found = Vec::new();
    streams.for_each(|stream| defined(stream, &["struct", "enum", "trait"], false, &mut found));
    let mut counts = BTreeMap::new();
    found.into_iter().for_each(|name| *counts.entry(name).or_insert(0) += 1);
    counts
}

#[test]
fn a_type_name_stands_for_one_thing() {
    let is_test = |path: &PathBuf| path.file_name().is_some_and(|name| name == "tests.rs");
    let files = files("src").into_iter().filter(|path| !is_test(path));
    let shared: BTreeMap<String, usize> =
        types(files.map(|path| tokens(&path))).into_iter().filter(|(_, count)| *count > 1).collect();
    let listed: BTreeMap<String, usize> = SHARED.0.lines().map(name_and_count).collect();
    let more: Vec<_> = shared.iter().filter(|(name, count)| listed.get(*name).is_none_or(|l| l < count)).collect();
    assert!(more.is_empty(), "one name, several things: {more:?}");
    if std::env::var_os("PALPATE_WRITE_NAMES").is_some() {
        let lines: String = shared.iter().map(|(name, count)| format!("{name} {count}\n")).collect();
        std::fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join(SHARED.1), lines).expect("the list is written");
        return;
    }
    let gone: Vec<_> = listed.iter().filter(|(name, count)| shared.get(*name).is_none_or(|s| s < count)).collect();
    assert!(gone.is_empty(), "fewer share these names than the list says, write it anew: {gone:?}");
}

fn name_and_count(line: &str) -> (String, usize) {
    let (name, count) = line.split_once(' ').expect("a name and a count");
    (name.to_string(), count.parse().expect("a count"))
}

#[test]
fn a_constant_says_what_it_bounds() {
    let mut bare = Vec::new();
    for path in ["src", "tests", "benches"].into_iter().flat_map(files) {
        let mut names = Vec::new();
        defined(tokens(&path), &["const", "static"], true, &mut names);
        bare.extend(names.into_iter().filter(|name| BARE.contains(&name.as_str())).map(|name| (path.clone(), name)));
    }
    assert!(bare.is_empty(), "bounds of what? {bare:#?}");
}

/// Files that are renamed leave comments behind.
#[test]
fn a_file_that_a_comment_names_is_there() {
    let there: Vec<PathBuf> = ["src", "tests", "benches"].into_iter().flat_map(files).collect();
    let mut gone = Vec::new();
    for path in files("src") {
        let text = std::fs::read_to_string(&path).expect("readable");
        for comment in text.lines().filter_map(|line| line.split_once("//")) {
            let words = comment.1.split(|c: char| !(c.is_ascii_alphanumeric() || "_/.".contains(c)));
            let named = words.map(|word| word.trim_end_matches('.')).filter(|word| word.ends_with(".rs"));
            gone.extend(named.filter(|name| !there.iter().any(|file| file.ends_with(name))).map(String::from));
        }
    }
    assert!(gone.is_empty(), "no such file: {gone:?}");
}

#[test]
fn shared_and_bare_names_are_caught() {
    let source = "struct A; mod b { pub(crate) enum A { B } trait C {} } impl C for A {} mod tests { struct C; }
                  const MOST: usize = 3; const fn most() {} mod tests { const STEP: f64 = 0.1; const MOST_STEPS: u8 = 1; }";
    let stream = || source.parse::<TokenStream>().expect("the fixture parses");
    let counts = types(std::iter::once(stream()));
    assert_eq!(counts.into_iter().collect::<Vec<_>>(), [("A".to_string(), 2), ("C".to_string(), 1)]);
    let mut constants = Vec::new();
    defined(stream(), &["const"], true, &mut constants);
    assert_eq!(constants, ["MOST", "fn", "STEP", "MOST_STEPS"]);
}
