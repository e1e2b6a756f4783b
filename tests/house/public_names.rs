//! The public interface is a list that people can learn: `public_names.txt` names every item that a user of the
//! crate can reach, and this test compares it with what the sources declare public.
//!
//! ```text
//! names(crate) = { items of lib.rs } + { items of every public module }        without what is hidden from the documentation
//! ```

use std::path::{Path, PathBuf};

use syn::{Attribute, Item, UseTree, Visibility};

/// More names than this are too many to learn.
const MOST_NAMES: usize = 110;

/// The public names below one module, each with its whole path.
fn names_of(file: &Path, children: &Path, path: &str, found: &mut Vec<String>) {
    let source = std::fs::read_to_string(file).expect("the module's file is readable");
    let parsed = syn::parse_file(&source).expect("the module parses");
    items_of(&parsed.items, children, path, found);
}

fn items_of(items: &[Item], children: &Path, path: &str, found: &mut Vec<String>) {
    for item in items {
        let (attributes, visibility, name) = match item {
            Item::Use(item) if is_public(&item.vis) && !is_hidden(&item.attrs) => {
                used(&item.tree, path, found);
                continue;
            }
            Item::Mod(item) if is_public(&item.vis) && !is_hidden(&item.attrs) => {
                let inner = format!("{path}::{}", item.ident);
                match &item.content {
                    Some((_, items)) => items_of(items, &children.join(item.ident.to_string()), &inner, found),
                    None => {
                        let (file, folder) = place(children, &item.ident.to_string());
                        names_of(&file, &folder, &inner, found);
                    }
                }
                continue;
            }
            Item::Const(item) => (&item.attrs, &item.vis, item.ident.to_string()),
            Item::Enum(item) => (&item.attrs, &item.vis, item.ident.to_string()),
            Item::Fn(item) => (&item.attrs, &item.vis, item.sig.ident.to_string()),
            Item::Struct(item) => (&item.attrs, &item.vis, item.ident.to_string()),
            Item::Trait(item) => (&item.attrs, &item.vis, item.ident.to_string()),
            Item::Type(item) => (&item.attrs, &item.vis, item.ident.to_string()),
            _ => continue,
        };
        if is_public(visibility) && !is_hidden(attributes) {
            found.push(format!("{path}::{name}"));
        }
    }
}

/// The file of a module, and the folder of its own modules.
fn place(children: &Path, module: &str) -> (PathBuf, PathBuf) {
    let folder = children.join(module);
    let inside = folder.join("mod.rs");
    if inside.exists() { (inside, folder) } else { (children.join(format!("{module}.rs")), folder) }
}

fn used(tree: &UseTree, path: &str, found: &mut Vec<String>) {
    match tree {
        UseTree::Path(inner) => used(&inner.tree, path, found),
        UseTree::Name(name) => found.push(format!("{path}::{}", name.ident)),
        UseTree::Rename(rename) => found.push(format!("{path}::{}", rename.rename)),
        UseTree::Group(group) => group.items.iter().for_each(|inner| used(inner, path, found)),
        UseTree::Glob(_) => found.push(format!("{path}::*")),
    }
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// `#[doc(hidden)]`, or compiled for tests and documentation alone.
fn is_hidden(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let syn::Meta::List(list) = &attribute.meta else { return false };
        let words = list.tokens.to_string();
        (list.path.is_ident("doc") && words == "hidden")
            || (list.path.is_ident("cfg") && ["test", "doctest", "doc"].contains(&words.as_str()))
    })
}

#[test]
fn the_public_names_are_those_of_the_list() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    names_of(&root.join("src/lib.rs"), &root.join("src"), "palpate", &mut found);
    found.sort();
    let listed: Vec<&str> = include_str!("public_names.txt").lines().collect();
    let missing: Vec<&String> = found.iter().filter(|name| !listed.contains(&name.as_str())).collect();
    let gone: Vec<&&str> = listed.iter().filter(|name| !found.iter().any(|f| f == *name)).collect();
    assert!(
        missing.is_empty() && gone.is_empty(),
        "not in public_names.txt: {missing:#?}\nno longer public: {gone:#?}"
    );
    assert!(found.len() <= MOST_NAMES, "{} public names are more than {MOST_NAMES}", found.len());
    assert!(!found.iter().any(|name| name.ends_with('*')), "a glob makes names public that nobody listed");
}

#[test]
fn a_new_public_name_is_noticed() {
    let fixture: syn::File = syn::parse_str(
        "pub use a::{B, c as D}; pub(crate) use e::F; #[doc(hidden)] pub mod g { pub fn h() {} } pub mod i { pub fn j() {} fn k() {} }",
    )
    .expect("the fixture parses");
    let mut found = Vec::new();
    items_of(&fixture.items, Path::new("nowhere"), "crate", &mut found);
    assert_eq!(found, ["crate::B", "crate::D", "crate::i::j"]);
}
