//! `--tune NAME=VALUE,..`: numbers that decide about an adaptive surface.

use palpate_hierarchical::HierarchyError;
use palpate_hierarchical::adaptive::AdaptiveOptions;

/// A number with its option's name.
#[derive(Clone, Debug, PartialEq)]
pub struct TunedOption {
    /// The name, as [`AdaptiveOptions::TUNABLE`] has it.
    pub name: String,
    /// The number; 1 and 0 for on and off.
    pub value: f64,
}

impl TunedOption {
    /// Sets the option.
    ///
    /// # Errors
    /// A name that is none, a number of another kind.
    pub(super) fn set(&self, options: &mut AdaptiveOptions) -> Result<(), HierarchyError> {
        options.tune(&self.name, self.value)
    }
}

/// One of them as it is typed.
pub(super) fn tuned_option(text: &str) -> Result<TunedOption, String> {
    let (name, value) = text.split_once('=').ok_or("NAME=VALUE, as in last_halving=on")?;
    let number = match value.trim() {
        "on" | "true" => 1.0,
        "off" | "false" => 0.0,
        number => number.parse().map_err(|_| format!("{number:?} is no number, and neither on nor off"))?,
    };
    let found = TunedOption { name: name.trim().into(), value: number };
    match found.set(&mut AdaptiveOptions::default()) {
        Ok(()) => Ok(found),
        Err(_) if !AdaptiveOptions::TUNABLE.contains(&found.name.as_str()) => {
            Err(format!("no such option; there are {}", AdaptiveOptions::TUNABLE.join(", ")))
        }
        Err(error) => Err(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_are_read_and_others_refused() {
        let expected = TunedOption { name: "last_halving".into(), value: 1.0 };
        assert_eq!(tuned_option("last_halving=on"), Ok(expected));
        assert_eq!(tuned_option("shade = 0.2").unwrap().value, 0.2);
        for (text, word) in
            [("shade", "NAME=VALUE"), ("shade=x", "no number"), ("shine=1", "shade"), ("probes=1.5", "whole")]
        {
            assert!(tuned_option(text).unwrap_err().contains(word), "{text}");
        }
    }
}
