//! Which file imports which: every `crate::`, `super::` and `self::` path and every `use` is resolved to the file that
//! defines what it names, through re-exports.
//!
//! What is not resolved: paths that begin with an imported name (the import itself is), method calls, macros' products.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// One module: its file, and the names that its `use` declarations bring in.
struct Module {
    file: String,
    imports: BTreeMap<String, Vec<String>>,
    globs: Vec<Vec<String>>,
}

/// A path as it stands in a file, and the module that it stands in.
struct Mention {
    file: String,
    module: Vec<String>,
    path: Vec<String>,
}

/// All modules of a crate by their paths, and all paths that its files mention.
#[derive(Default)]
struct Crate {
    modules: BTreeMap<Vec<String>, Module>,
    mentions: Vec<Mention>,
}

/// Files that import each other, parent and child aside, directly or by way of others: each circle once, its files in order;
/// `sources` are `(path below src, text)`.
pub(super) fn circles(sources: &[(String, String)]) -> Vec<Vec<String>> {
    let edges = edges(sources);
    let files: BTreeSet<&String> = edges.iter().map(|[from, _]| from).collect();
    let reach: BTreeMap<&String, BTreeSet<&String>> = files.iter().map(|from| (*from, reached(from, &edges))).collect();
    let meets = |a: &String, b: &String| reach.get(a).is_some_and(|far| far.contains(b));
    let circle = |a: &String| files.iter().filter(|b| meets(a, b) && meets(b, a)).map(ToString::to_string).collect();
    let found: BTreeSet<Vec<String>> = files.iter().map(|a| circle(a)).collect();
    found.into_iter().filter(|circle| !circle.is_empty()).collect()
}

/// All files that imports lead to from here; itself where they lead back.
fn reached<'a>(from: &'a String, edges: &'a BTreeSet<[String; 2]>) -> BTreeSet<&'a String> {
    let mut found = BTreeSet::new();
    let mut open = vec![from];
    while let Some(next) = open.pop() {
        open.extend(edges.iter().filter(|[a, _]| a == next).map(|[_, b]| b).filter(|b| found.insert(*b)));
    }
    found
}

/// `[importer, imported]` for every pair of files that are not parent and child.
fn edges(sources: &[(String, String)]) -> BTreeSet<[String; 2]> {
    let is_kin = |a: &[String], b: &[String]| a.len() == b.len() + 1 && a.starts_with(b);
    let mut found = imports(sources);
    found.retain(|[from, to]| {
        let [from, to] = [module_of(from), module_of(to)];
        !is_kin(&from, &to) && !is_kin(&to, &from)
    });
    found
}

/// `[importer, imported]` for every pair of files; `sources` are `(path below src, text)`.
pub(super) fn imports(sources: &[(String, String)]) -> BTreeSet<[String; 2]> {
    let mut found = Crate::default();
    for (file, text) in sources {
        let tokens: TokenStream = text.parse().expect("the file parses");
        found.read(file, module_of(file), tokens.into_iter().collect());
    }
    let resolved = found.mentions.iter().filter_map(|mention| {
        let target = found.resolve(&mention.module, &mention.path, 0)?;
        (target != mention.file).then(|| [mention.file.clone(), target])
    });
    resolved.collect()
}

/// The module path of a file: `fit/linear/mod.rs` and `fit/linear.rs` are both `fit::linear`.
fn module_of(file: &str) -> Vec<String> {
    let mut parts: Vec<String> = file.trim_end_matches(".rs").split('/').map(String::from).collect();
    if parts.last().is_some_and(|last| last == "mod") || parts == ["lib"] {
        parts.pop();
    }
    parts
}

impl Crate {
    /// Reads the items of one module, inline ones included; `mod tests` is left out.
    fn read(&mut self, file: &str, module: Vec<String>, tokens: Vec<TokenTree>) {
        let empty = Module { file: file.into(), imports: BTreeMap::new(), globs: Vec::new() };
        self.modules.entry(module.clone()).or_insert(empty);
        let mut k = 0;
        while k < tokens.len() {
            if let (Some(name), Some(TokenTree::Group(body))) = (inline_module(&tokens[k..]), tokens.get(k + 2)) {
                if name != "tests" {
                    let path = [module.clone(), vec![name]].concat();
                    self.read(file, path, body.stream().into_iter().collect());
                }
                k += 3;
            } else if is_word(tokens.get(k), "use") {
                let end = (k..tokens.len()).find(|&e| is_mark(tokens.get(e), ';')).unwrap_or(tokens.len());
                self.read_use(file, &module, &tokens[k + 1..end], Vec::new());
                k = end + 1;
            } else {
                k += self.read_path(file, &module, &tokens[k..]);
            }
        }
    }

    /// A path from here on, or the contents of a group; the number of tokens read.
    fn read_path(&mut self, file: &str, module: &[String], tokens: &[TokenTree]) -> usize {
        match &tokens[0] {
            TokenTree::Group(group) => {
                let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                // `pub(in crate::room)` says who may look, and imports nothing
                if !is_word(inner.first(), "in") {
                    self.read(file, module.to_vec(), inner);
                }
                1
            }
            TokenTree::Ident(first) if ["crate", "super", "self"].contains(&first.to_string().as_str()) => {
                let mut path = vec![first.to_string()];
                let mut k = 1;
                while is_mark(tokens.get(k), ':')
                    && is_mark(tokens.get(k + 1), ':')
                    && let Some(TokenTree::Ident(next)) = tokens.get(k + 2)
                {
                    path.push(next.to_string());
                    k += 3;
                }
                if path.len() > 1 {
                    self.mention(file, module, path);
                }
                k
            }
            _ => 1,
        }
    }

    /// One `use` tree below `prefix`.
    fn read_use(&mut self, file: &str, module: &[String], tokens: &[TokenTree], prefix: Vec<String>) {
        let mut path = prefix;
        let mut alias = None;
        for (k, token) in tokens.iter().enumerate() {
            match token {
                TokenTree::Ident(_) if is_word(Some(token), "as") => alias = tokens.get(k + 1).map(ToString::to_string),
                TokenTree::Ident(name) if alias.is_none() => path.push(name.to_string()),
                TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => {
                    let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                    for branch in inner.split(|t| is_mark(Some(t), ',')).filter(|b| !b.is_empty()) {
                        self.read_use(file, module, branch, path.clone());
                    }
                    return;
                }
                TokenTree::Punct(mark) if mark.as_char() == '*' => {
                    self.mention(file, module, path.clone());
                    if let Some(module) = self.modules.get_mut(module) {
                        module.globs.push(path);
                    }
                    return;
                }
                _ => {}
            }
        }
        if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
            path.pop();
        }
        self.mention(file, module, path.clone());
        if let Some(name) = alias.or_else(|| path.last().cloned())
            && let Some(module) = self.modules.get_mut(module)
        {
            module.imports.insert(name, path);
        }
    }

    fn mention(&mut self, file: &str, module: &[String], path: Vec<String>) {
        self.mentions.push(Mention { file: file.into(), module: module.to_vec(), path });
    }

    /// The file that defines what a path names in a module; `None` for other crates.
    fn resolve(&self, module: &[String], path: &[String], depth: usize) -> Option<String> {
        // a re-export of a re-export of itself, as only code that does not compile has it
        if depth > 16 {
            return None;
        }
        let mut at = module.to_vec();
        for (k, word) in path.iter().enumerate() {
            let here = self.modules.get(&at)?;
            match word.as_str() {
                "crate" if k == 0 => at.clear(),
                "self" if k == 0 => {}
                "super" => {
                    at.pop();
                }
                name if self.is_module(&at, name) => at.push(name.into()),
                name => {
                    let import = here.imports.get(name).filter(|import| k > 0 || import.as_slice() != path);
                    if let Some(import) = import {
                        let whole = [import.as_slice(), &path[k + 1..]].concat();
                        return self.resolve(&at, &whole, depth + 1);
                    }
                    let rest = &path[k..];
                    let from_glob = here.globs.iter().find_map(|glob| {
                        let inside = self.module_at(&at, glob)?;
                        self.has(&inside, name).then(|| self.resolve(&inside, rest, depth + 1))?
                    });
                    // the first word of a `use` that is no module of ours is another crate
                    return from_glob.or_else(|| (k > 0).then(|| here.file.clone()));
                }
            }
        }
        self.modules.get(&at).map(|module| module.file.clone())
    }

    /// The module that a path of modules leads to.
    fn module_at(&self, from: &[String], path: &[String]) -> Option<Vec<String>> {
        let mut at = from.to_vec();
        for word in path {
            match word.as_str() {
                "crate" => at.clear(),
                "self" => {}
                "super" => {
                    at.pop();
                }
                name => at.push(name.into()),
            }
        }
        self.modules.contains_key(&at).then_some(at)
    }

    fn is_module(&self, parent: &[String], name: &str) -> bool {
        self.modules.contains_key(&[parent, &[name.to_string()]].concat())
    }

    /// Whether a module has a child or an import of this name.
    fn has(&self, module: &[String], name: &str) -> bool {
        self.is_module(module, name) || self.modules.get(module).is_some_and(|m| m.imports.contains_key(name))
    }
}

/// The name of a `mod name { .. }` that begins here.
fn inline_module(tokens: &[TokenTree]) -> Option<String> {
    match tokens {
        [TokenTree::Ident(word), TokenTree::Ident(name), TokenTree::Group(body), ..]
            if word == "mod" && body.delimiter() == Delimiter::Brace =>
        {
            Some(name.to_string())
        }
        _ => None,
    }
}

fn is_word(token: Option<&TokenTree>, word: &str) -> bool {
    matches!(token, Some(TokenTree::Ident(found)) if found == word)
}

fn is_mark(token: Option<&TokenTree>, mark: char) -> bool {
    matches!(token, Some(TokenTree::Punct(found)) if found.as_char() == mark)
}
