//! Numbers of things in words: `1 contact`, `2 contacts`.

/// A number with its noun, which takes an `s` unless there is one.
pub fn counted(count: usize, noun: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{ending}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_no_plural() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "contact")), ["0 contacts", "1 contact", "2 contacts"]);
    }
}
