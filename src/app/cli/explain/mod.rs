//! `palpate explain WORD`: what a word of the output means, from the page of words beside this file.
//!
//! ```text
//! # group      ## word      Also: other words      paragraph
//! ```

use std::io::Write;

use clap::Args;
use serde::Serialize;

use crate::io::visible;
use crate::report::{folded, write_json};

use super::failure::Failure;
use super::options::OutputFlags;
use super::output::{columns, print};

/// All entries.
const PAGE: &str = include_str!("glossary.md");

/// Words closer than this, of 1, are proposed for one that is not known.
const CLOSE: f64 = 0.75;

/// Arguments of `palpate explain`.
#[derive(Args)]
pub(super) struct ExplainArgs {
    /// A word of the output, such as S, R, bounds, support; without one, the list of words
    word: Vec<String>,
    #[command(flatten)]
    output: OutputFlags,
}

/// One entry.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Entry {
    group: &'static str,
    word: &'static str,
    also: Vec<&'static str>,
    text: &'static str,
}

#[derive(Serialize)]
struct ExplainDocument<'a> {
    schema: &'static str,
    entries: &'a [Entry],
}

pub(super) fn explain(args: &ExplainArgs) -> Result<(), Failure> {
    let mut entries = entries();
    let asked = args.word.join(" ");
    if !asked.is_empty() {
        entries = find(entries, &asked)?;
    }
    args.output.prepare(&[], &[])?;
    args.output.file("glossary.md", &mut |out| out.write_all(PAGE.as_bytes()))?;
    args.output.publish()?;
    if args.output.json {
        let document = ExplainDocument { schema: "palpate.explain/1", entries: &entries };
        return print(&mut |out| write_json(&document, out));
    }
    if args.output.quiet {
        return Ok(());
    }
    print(&mut |out| if asked.is_empty() { list(&entries, out) } else { entries.iter().try_for_each(|e| show(e, out)) })
}

/// The page, entry by entry.
fn entries() -> Vec<Entry> {
    let mut found = Vec::new();
    for group in PAGE.split("\n# ").skip(1) {
        let (group, rest) = group.split_once('\n').unwrap_or((group, ""));
        for entry in rest.split("## ").skip(1) {
            let (word, rest) = entry.split_once('\n').unwrap_or((entry, ""));
            let (also, text) = match rest.strip_prefix("Also: ").and_then(|rest| rest.split_once('\n')) {
                Some((also, text)) => (also.split(", ").collect(), text),
                None => (Vec::new(), rest),
            };
            found.push(Entry { group, word, also, text: text.trim() });
        }
    }
    found
}

/// The entries of a word: those that it heads, or else those that name it, in any case.
fn find(entries: Vec<Entry>, asked: &str) -> Result<Vec<Entry>, Failure> {
    let same = |word: &str| word.eq_ignore_ascii_case(asked);
    let heads = |entry: &Entry| entry.word == asked;
    let names = |entry: &Entry| same(entry.word) || entry.also.iter().any(|also| same(also));
    for holds in [&heads as &dyn Fn(&Entry) -> bool, &names] {
        let found: Vec<Entry> = entries.iter().filter(|entry| holds(entry)).cloned().collect();
        if !found.is_empty() {
            return Ok(found);
        }
    }
    let lower = asked.to_lowercase();
    let words = entries.iter().flat_map(|entry| entry.also.iter().chain([&entry.word]));
    let close = words.map(|word| (strsim::jaro_winkler(&lower, &word.to_lowercase()), *word));
    let close = close.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(score, _)| *score >= CLOSE);
    let close = close.map_or(";".into(), |(_, word)| format!("; did you mean {word:?}?"));
    let asked = visible(asked);
    Err(Failure::Input(format!("no word {asked:?} is explained{close} palpate explain lists all words")))
}

fn list(entries: &[Entry], out: &mut dyn Write) -> std::io::Result<()> {
    let mut group = "";
    for entry in entries {
        if entry.group != group {
            group = entry.group;
            writeln!(out, "{}{group}", if entry == &entries[0] { "" } else { "\n" })?;
        }
        let first = entry.text.split_inclusive(['.', ':']).next().unwrap_or(entry.text);
        let line = format!("  {:<16}{}", entry.word, first.trim_end_matches(['.', ':']));
        out.write_all(folded(&line, Some(18), columns()).as_bytes())?;
    }
    writeln!(out, "\npalpate explain WORD says more")
}

fn show(entry: &Entry, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(out, "{}", entry.word)?;
    if !entry.also.is_empty() {
        let also = format!("also: {}", entry.also.join(", "));
        out.write_all(folded(&also, None, columns()).as_bytes())?;
    }
    writeln!(out)?;
    out.write_all(folded(entry.text, None, columns()).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_has_a_group_a_word_and_a_text() {
        let all = entries();
        assert!(all.len() > 25);
        for entry in &all {
            assert!(!entry.word.is_empty() && entry.text.len() > 60 && entry.text.ends_with('.'), "{entry:?}");
            assert!(!entry.text.contains('#') && !entry.also.iter().any(|word| word.is_empty()), "{entry:?}");
        }
        let mut heads: Vec<&str> = all.iter().map(|entry| entry.word).collect();
        heads.sort_unstable();
        heads.dedup();
        assert_eq!(heads.len(), all.len(), "a word heads two entries");
    }

    /// Whoever asks for a word gets one entry.
    #[test]
    fn every_word_stands_once() {
        let all = entries();
        let words = all.iter().flat_map(|entry| entry.also.iter().chain([&entry.word]));
        // S is no s: case tells R from r
        let mut words: Vec<&str> = words.copied().collect();
        words.sort_unstable();
        let twice: Vec<&[&str]> = words.windows(2).filter(|pair| pair[0] == pair[1]).collect();
        assert!(twice.is_empty(), "{twice:?}");
    }

    #[test]
    fn words_of_the_output_are_found() {
        for word in
            ["S", "R", "u", "support", "bounds", "95 %", "plane", "digits", "axis", "cup", "varies", "doubt", "pattern"]
        {
            assert!(find(entries(), word).is_ok(), "{word}");
        }
        assert_eq!(find(entries(), "shape index").unwrap()[0].word, "S");
        let Failure::Input(message) = find(entries(), "curvednes").unwrap_err() else { panic!("another failure") };
        assert!(message.contains("curvedness"), "{message}");
    }
}
