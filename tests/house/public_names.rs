//! The public interface is a list that people can learn: `public_names.txt` names every item that a user of the crate can
//! reach, and this test compares it with what the sources declare public.
//!
//! ```text
//! names(crate) = { items of lib.rs } + { items of every public module }        without what is hidden from the documentation
//! ```
//!
//! An item has one public path. Only what a first program needs stands in its room and at the crate's root; such an item is
//! listed once, by its path at the root.

use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// The list may not grow beyond this.
const MOST_NAMES: usize = 110;

/// Names that do not count: the two crates whose types stand in signatures and are handed on whole.
const APART: [&str; 2] = ["palpate::nalgebra_sparse", "palpate::ndarray"];

/// A walk over the items of one module.
struct Walk<'a> {
    /// Where the files of its own modules lie.
    children: &'a Path,
    /// Its path, `palpate::fit`.
    path: &'a str,
}

/// The public names of the module in `file` and below.
fn names_of(file: &Path, children: &Path, path: &str, found: &mut Vec<String>) {
    let source = std::fs::read_to_string(file).expect("the module's file is readable");
    items_of(source.parse().expect("the module parses"), &Walk { children, path }, found);
}

fn items_of(stream: TokenStream, walk: &Walk, found: &mut Vec<String>) {
    let tokens: Vec<TokenTree> = stream.into_iter().collect();
    let mut hidden = false;
    let mut at = 0;
    while at < tokens.len() {
        match &tokens[at] {
            TokenTree::Punct(mark) if mark.as_char() == '#' => {
                hidden |= tokens.get(at + 1).is_some_and(hides);
                at += 2;
                continue;
            }
            TokenTree::Ident(word)
                if !hidden && *word == "pub" && !is_group(tokens.get(at + 1), Delimiter::Parenthesis) =>
            {
                item(&tokens[at + 1..], walk, found);
            }
            _ => {}
        }
        // what follows an item's end is free of its attributes
        if is_end(&tokens[at]) {
            hidden = false;
        }
        at += 1;
    }
}

fn is_group(token: Option<&TokenTree>, delimiter: Delimiter) -> bool {
    matches!(token, Some(TokenTree::Group(group)) if group.delimiter() == delimiter)
}

fn is_end(token: &TokenTree) -> bool {
    matches!(token, TokenTree::Punct(mark) if mark.as_char() == ';') || is_group(Some(token), Delimiter::Brace)
}

/// `[doc(hidden)]`, or compiled for tests and documentation alone.
fn hides(attribute: &TokenTree) -> bool {
    let words: String = attribute.to_string().split_whitespace().collect();
    ["[doc(hidden)]", "[cfg(test)]", "[cfg(any(doc,doctest))]"].contains(&words.as_str())
}

/// One public item; `tokens` follow the word `pub`.
fn item(tokens: &[TokenTree], walk: &Walk, found: &mut Vec<String>) {
    let word = |at: usize| tokens.get(at).map(ToString::to_string).unwrap_or_default();
    match word(0).as_str() {
        "use" => {
            let end = tokens.iter().position(is_end_of_use).unwrap_or(tokens.len());
            used(&tokens[1..end], walk.path, found);
        }
        "mod" => {
            let path = format!("{}::{}", walk.path, word(1));
            match &tokens[2] {
                TokenTree::Group(group) => {
                    let children = walk.children.join(word(1));
                    items_of(group.stream(), &Walk { children: &children, path: &path }, found);
                }
                _ => {
                    let (file, folder) = place(walk.children, &word(1));
                    names_of(&file, &folder, &path, found);
                }
            }
        }
        "const" if word(1) == "fn" => found.push(format!("{}::{}", walk.path, word(2))),
        "const" | "enum" | "fn" | "static" | "struct" | "trait" | "type" => {
            found.push(format!("{}::{}", walk.path, word(1)));
        }
        other => panic!("{}: the kind of item `pub {other}` is not known here", walk.path),
    }
}

fn is_end_of_use(token: &TokenTree) -> bool {
    matches!(token, TokenTree::Punct(mark) if mark.as_char() == ';')
}

/// The file of a module, and the folder of its own modules.
fn place(children: &Path, module: &str) -> (PathBuf, PathBuf) {
    let folder = children.join(module);
    let inside = folder.join("mod.rs");
    if inside.exists() { (inside, folder) } else { (children.join(format!("{module}.rs")), folder) }
}

/// The names that `a::{B, c as D}` brings in.
fn used(tokens: &[TokenTree], path: &str, found: &mut Vec<String>) {
    for part in tokens.split(|token| matches!(token, TokenTree::Punct(mark) if mark.as_char() == ',')) {
        match part.last() {
            Some(TokenTree::Group(group)) => used(&group.stream().into_iter().collect::<Vec<_>>(), path, found),
            Some(name) => found.push(format!("{path}::{name}")),
            None => {}
        }
    }
}

/// Without the paths of items that also stand at the crate's root.
fn canonical(mut found: Vec<String>) -> Vec<String> {
    let at_root: Vec<String> = found.iter().filter(|path| path.matches("::").count() == 1).cloned().collect();
    found.retain(|path| at_root.contains(path) || !at_root.iter().any(|root| last(root) == last(path)));
    found.sort();
    found
}

fn last(path: &str) -> &str {
    path.rsplit("::").next().unwrap_or(path)
}

#[test]
fn the_public_names_are_those_of_the_list() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    names_of(&root.join("src/lib.rs"), &root.join("src"), "palpate", &mut found);
    let found = canonical(found);
    let listed: Vec<&str> = include_str!("public_names.txt").lines().collect();
    let missing: Vec<&String> = found.iter().filter(|name| !listed.contains(&name.as_str())).collect();
    let gone: Vec<&&str> = listed.iter().filter(|name| !found.iter().any(|f| f == *name)).collect();
    assert!(
        missing.is_empty() && gone.is_empty(),
        "not in public_names.txt: {missing:#?}\nno longer public: {gone:#?}"
    );
    let twice: Vec<&String> = found.iter().filter(|a| found.iter().any(|b| *a != b && last(a) == last(b))).collect();
    assert!(twice.is_empty(), "one name, two public paths: {twice:#?}");
    let count = found.iter().filter(|name| !APART.iter().any(|apart| name.starts_with(apart))).count();
    assert!(count <= MOST_NAMES, "{count} public names are more than {MOST_NAMES}");
    assert!(!found.iter().any(|name| name.ends_with('*')), "a glob makes names public that nobody listed");
}

#[test]
fn a_new_public_name_is_noticed() {
    let fixture = "pub use a::{B, c as D}; pub(crate) use e::F; #[doc(hidden)] pub mod g { pub fn h() {} }
                   #[derive(Debug)] pub struct S { pub field: f64 } pub mod i { pub fn j() {} fn k() {} }";
    let mut found = Vec::new();
    let walk = Walk { children: Path::new("nowhere"), path: "palpate" };
    items_of(fixture.parse().expect("the fixture parses"), &walk, &mut found);
    assert_eq!(found, ["palpate::B", "palpate::D", "palpate::S", "palpate::i::j"]);
}

#[test]
fn an_item_at_the_root_is_listed_once() {
    let found = ["palpate::fit::Fit", "palpate::Fit", "palpate::fit::Rms"].map(String::from).to_vec();
    assert_eq!(canonical(found), ["palpate::Fit", "palpate::fit::Rms"]);
}
