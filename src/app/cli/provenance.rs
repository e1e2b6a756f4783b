//! The command of this process, as a page shows it.

use crate::report::Provenance;

/// Where the numbers of a page about `subject` come from; `scene` is its TOML.
pub(super) fn provenance(subject: &str, scene: Option<String>, seed: Option<u64>) -> Provenance {
    let words = std::env::args_os().skip(1).map(|word| quoted(&word.to_string_lossy()));
    let command = std::iter::once("palpate".to_string()).chain(words).collect::<Vec<_>>().join(" ");
    Provenance { command, subject: subject.into(), scene, seed }
}

/// A word as a shell takes it back.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.into() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_spaces_are_quoted() {
        assert_eq!(["a.csv", "", "it's"].map(quoted), ["a.csv", "''", "'it'\\''s'"]);
    }
}
