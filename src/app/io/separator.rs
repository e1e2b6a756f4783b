//! What separates the fields of a row of text, and the numbers between the separators.
//!
//! ```text
//! 1,2,3     1;2;3     1,5;2,5;3,5 (decimal commas)     "a, b",2     1 2   3     sep=; (a line that names the separator)
//! ```

use std::borrow::Cow;

/// What stands between two fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    Comma,
    Semicolon,
    Tab,
    /// Any run of blanks and tabs.
    Blank,
}

/// In the order in which they are tried.
pub(super) const SEPARATORS: [Separator; 4] =
    [Separator::Comma, Separator::Semicolon, Separator::Tab, Separator::Blank];

impl Separator {
    /// The character, but for blanks.
    pub(super) fn character(self) -> Option<char> {
        match self {
            Separator::Comma => Some(','),
            Separator::Semicolon => Some(';'),
            Separator::Tab => Some('\t'),
            Separator::Blank => None,
        }
    }

    /// Fields of one row, trimmed; separators between double quotes do not separate.
    pub(super) fn fields(self, row: &str) -> Vec<Cow<'_, str>> {
        let mut quoted = false;
        let between = |c: char| {
            quoted ^= c == '"';
            !quoted && self.character().map_or(c.is_whitespace(), |separator| c == separator)
        };
        let fields = row.split(between).map(|field| {
            let field = field.trim();
            match field.strip_prefix('"').and_then(|f| f.strip_suffix('"')) {
                Some(inner) => Cow::Owned(inner.replace("\"\"", "\"")),
                None => Cow::Borrowed(field),
            }
        });
        // a run of blanks is one separator
        fields.filter(|field| self != Separator::Blank || !field.is_empty()).collect()
    }

    /// A number; with a decimal comma where the comma separates nothing.
    pub(super) fn number(self, text: &str) -> Option<f64> {
        // most fields have no blanks to trim
        let plain = text.parse().or_else(|_| text.trim().parse()).ok();
        if plain.is_some() || self == Separator::Comma {
            return plain;
        }
        let (whole, fraction) = text.trim().split_once(',')?;
        let is_decimal = !whole.contains('.') && !fraction.contains([',', '.']);
        is_decimal.then(|| format!("{whole}.{fraction}").parse().ok()).flatten()
    }
}

/// The separator that a line such as `sep=;` names, quoted or not. A tab at the end of a line may have been trimmed.
pub(super) fn declared_separator(line: &str) -> Option<Separator> {
    let line = line.trim().trim_matches('"');
    let (key, character) = line.split_at_checked(4)?;
    match character {
        _ if !key.eq_ignore_ascii_case("sep=") => None,
        "," => Some(Separator::Comma),
        ";" => Some(Separator::Semicolon),
        "" | "\t" => Some(Separator::Tab),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_commas_are_numbers_where_commas_separate_nothing() {
        assert_eq!(Separator::Semicolon.number(" -1,25e1"), Some(-12.5));
        assert_eq!(Separator::Blank.number("1.25"), Some(1.25));
        for (separator, text) in [(Separator::Comma, "1,5"), (Separator::Tab, "1.234,5"), (Separator::Tab, "1,2,3")] {
            assert_eq!(separator.number(text), None, "{text}");
        }
    }
}
