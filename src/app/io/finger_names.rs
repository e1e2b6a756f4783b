//! Fingers that a table names by words: `f1`, `index` and `thumb` become 0, 1 and 2, in the order in which they appear.

use std::collections::HashMap;

use super::escape_control_chars::visible;

/// Fingers of which all names are said in the note; of more, the first ones.
const SAID: usize = 6;

/// How the fingers of one table are named.
#[derive(Debug)]
pub(super) enum FingerNames {
    /// By whole numbers.
    Numbers,
    /// By words, each with its number.
    Words(HashMap<String, usize>),
}

impl FingerNames {
    /// The first finger of a table decides how all are named; `number` is what it reads as.
    pub(super) fn begun_by(number: Option<f64>) -> FingerNames {
        if number.is_some() { FingerNames::Numbers } else { FingerNames::Words(HashMap::new()) }
    }

    /// The number of the finger in a field that reads as `number`; `None` where it names no finger.
    pub(super) fn number_of(&mut self, field: &str, number: Option<f64>) -> Option<f64> {
        match self {
            FingerNames::Numbers => number,
            FingerNames::Words(_) if field.is_empty() => None,
            FingerNames::Words(names) => {
                let next = names.len();
                Some(*names.entry(field.to_string()).or_insert(next) as f64)
            }
        }
    }

    /// What became of the words.
    pub(super) fn note(&self) -> Option<String> {
        let FingerNames::Words(names) = self else { return None };
        let mut names: Vec<(usize, &str)> = names.iter().map(|(name, number)| (*number, name.as_str())).collect();
        names.sort_unstable();
        let said = names.iter().take(SAID).map(|(number, name)| format!("{} = {number}", visible(name)));
        let more = if names.len() > SAID { ", ..." } else { "" };
        Some(format!(
            "the column finger holds words, numbered as they appear: {}{more}",
            said.collect::<Vec<_>>().join(", ")
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_numbered_as_they_appear_and_numbers_stay() {
        let mut words = FingerNames::begun_by(None);
        let numbers = ["f1", "index", "f1", "7"].map(|name| words.number_of(name, name.parse().ok()));
        assert_eq!(numbers, [Some(0.0), Some(1.0), Some(0.0), Some(2.0)]);
        assert_eq!(words.number_of("", None), None);
        assert!(words.note().is_some_and(|note| note.ends_with("f1 = 0, index = 1, 7 = 2")));
        let mut numbers = FingerNames::begun_by(Some(3.0));
        assert_eq!((numbers.number_of("4", Some(4.0)), numbers.number_of("f1", None)), (Some(4.0), None));
        assert_eq!(numbers.note(), None);
    }
}
