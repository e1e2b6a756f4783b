//! The committed header is current: every function and every field of the border stands in it, in order, and nothing else does.
//! `src/capi/header.sh --check` compares the bytes where cbindgen is installed.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// Parameters of every `extern "C"` function, and fields or variants of every type of the border.
fn border() -> (BTreeMap<String, Vec<String>>, BTreeMap<String, Vec<String>>) {
    let (mut functions, mut types) = (BTreeMap::new(), BTreeMap::new());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    for name in ["border", "contacts", "fit", "recognition", "shape", "stream"] {
        let source = std::fs::read_to_string(folder.join(format!("{name}.rs"))).unwrap();
        let tokens: Vec<TokenTree> = source.parse::<TokenStream>().unwrap().into_iter().collect();
        let word = |k: usize| tokens.get(k).map_or(String::new(), ToString::to_string);
        for k in 0..tokens.len() {
            if word(k) == "extern" && word(k + 1) == "\"C\"" && word(k + 2) == "fn" {
                functions.insert(word(k + 3), names_in(&tokens[k + 4]));
            }
            // `#[repr(C)]` stands before those that C may look into
            let shown = word(k) == "pub" && ["struct", "enum"].contains(&word(k + 1).as_str());
            let seen =
                (k.saturating_sub(8)..k).any(|back| word(back).contains("repr (C)") || word(back).contains("repr(C)"));
            if shown && seen {
                types.insert(word(k + 2), names_in(&tokens[k + 3]));
            }
        }
    }
    (functions, types)
}

/// Names before a colon, or of variants before `=`.
fn names_in(group: &TokenTree) -> Vec<String> {
    let TokenTree::Group(group) = group else { return Vec::new() };
    assert!(matches!(group.delimiter(), Delimiter::Parenthesis | Delimiter::Brace));
    let tokens: Vec<TokenTree> = group.stream().into_iter().collect();
    let names = tokens.windows(2).filter_map(|pair| match pair {
        [TokenTree::Ident(name), TokenTree::Punct(mark)] if [':', '='].contains(&mark.as_char()) => {
            Some(name.to_string())
        }
        _ => None,
    });
    names.collect()
}

/// The header without comments, as one line.
fn header() -> String {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("include/palpate.h")).unwrap();
    let code: Vec<&str> = text.lines().map(|line| line.split("//").next().unwrap().trim()).collect();
    code.join(" ")
}

/// Names of a comma-separated list of C parameters, or of the fields of a struct.
fn names_of(list: &str, separator: char) -> Vec<String> {
    let name = |entry: &str| {
        let entry = entry.split(['[', '=']).next().unwrap().trim();
        entry.rsplit([' ', '*']).next().unwrap().to_string()
    };
    list.split(separator).map(str::trim).filter(|entry| !entry.is_empty() && *entry != "void").map(name).collect()
}

#[test]
fn the_header_is_that_of_the_border() {
    let (functions, types) = border();
    assert!(functions.len() >= 25 && types.len() >= 9, "{functions:?} {types:?}");
    let header = header();
    for (name, parameters) in &functions {
        let at = header.find(&format!("{name}(")).unwrap_or_else(|| panic!("{name} is not in the header"));
        let list = &header[at + name.len() + 1..];
        assert_eq!(&names_of(&list[..list.find(')').unwrap()], ','), parameters, "{name}");
    }
    let declared = header.matches(");").count();
    assert_eq!(declared, functions.len(), "the header has functions that the library has not");
    for (name, fields) in &types {
        let at = header.find(&format!(" {name} {{")).unwrap_or_else(|| panic!("{name} is not in the header"));
        let list = &header[at + name.len() + 3..];
        let list = &list[..list.find('}').unwrap()];
        let is_enum = !list.contains(';');
        let names = names_of(list, if is_enum { ',' } else { ';' });
        let own: Vec<String> =
            fields.iter().map(|field| if is_enum { variant(name, field) } else { field.clone() }).collect();
        assert_eq!(names, own, "{name}");
    }
}

/// `SaddleRut` of `PalpateClass` is `PALPATE_CLASS_SADDLE_RUT`.
fn variant(of: &str, name: &str) -> String {
    let apart = |word: &str| {
        word.chars()
            .map(|c| if c.is_uppercase() { format!("_{c}") } else { c.to_uppercase().to_string() })
            .collect::<String>()
    };
    format!("{}{}", apart(of).trim_start_matches('_'), apart(name))
}

#[test]
fn cbindgen_makes_the_same_bytes() {
    let there = Command::new("cbindgen").arg("--version").output().is_ok_and(|output| output.status.success());
    if !there || !cfg!(unix) {
        println!("not checked: there is no cbindgen; 'cargo install cbindgen' brings it");
        return;
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("header.sh");
    let output = Command::new(script).arg("--check").output().unwrap();
    assert!(
        output.status.success(),
        "src/capi/header.sh makes another header: {}",
        String::from_utf8_lossy(&output.stdout)
    );
}
