//! Options by their names, for command lines and other languages.

use super::options::{AdaptiveOptions, OutlierRule};
use crate::error::HierarchyError;

/// Where a number goes.
enum Tuned<'a> {
    Count(&'a mut usize),
    Small(&'a mut u32),
    Number(&'a mut f64),
    Switch(&'a mut bool),
}

impl AdaptiveOptions {
    /// All names that [`AdaptiveOptions::tune`] knows.
    pub const TUNABLE: [&str; 23] = [
        "false_discovery_rate",
        "significance_of_children",
        "least_contacts",
        "deepest_level",
        "base_segments",
        "last_halving",
        "noise_varies",
        "clip",
        "reject",
        "most_unknowns",
        "most_factor_entries",
        "posterior_draws",
        "most_boxes",
        "contacts_of_box",
        "reach_of_swings",
        "shade",
        "probes",
        "finer_roughness",
        "undersmoothing",
        "late_rounds",
        "most_first_fits",
        "most_last_fits",
        "settled_lambda",
    ];

    /// Sets an option by its name; of those that are on or off, 1 is on and 0 off.
    ///
    /// ```
    /// use palpate_hierarchical::adaptive::AdaptiveOptions;
    ///
    /// let mut options = AdaptiveOptions::default();
    /// options.tune("false_discovery_rate", 0.05)?;
    /// assert_eq!(options.false_discovery_rate, 0.05);
    /// assert!(options.tune("no_such_thing", 1.0).is_err());
    /// # Ok::<(), palpate_hierarchical::HierarchyError>(())
    /// ```
    ///
    /// # Errors
    /// [`HierarchyError::Option`] for a name that is none, and for a number that is of another kind. Ranges are checked by
    /// [`AdaptiveOptions::check`].
    pub fn tune(&mut self, name: &str, value: f64) -> Result<(), HierarchyError> {
        let Some(known) = AdaptiveOptions::TUNABLE.into_iter().find(|known| *known == name) else {
            let expected = "no such option; known are false_discovery_rate, deepest_level, last_halving and others";
            return Err(HierarchyError::Option {
                option: "an adaptive surface's option",
                value: name.into(),
                expected,
            });
        };
        let wrong = |expected| HierarchyError::Option { option: known, value: value.to_string(), expected };
        let whole = value.fract() == 0.0 && (0.0..=9e15).contains(&value);
        match self.named(known) {
            Some(Tuned::Number(target)) => *target = value,
            Some(Tuned::Count(target)) if whole => *target = value as usize,
            Some(Tuned::Small(target)) if whole && value <= f64::from(u32::MAX) => *target = value as u32,
            Some(Tuned::Switch(target)) if value == 0.0 || value == 1.0 => *target = value == 1.0,
            Some(Tuned::Count(_) | Tuned::Small(_)) => return Err(wrong("a whole number")),
            Some(Tuned::Switch(_)) => return Err(wrong("1 (on) or 0 (off)")),
            None => return Err(wrong("outliers that are rejected")),
        }
        Ok(())
    }

    fn named(&mut self, name: &str) -> Option<Tuned<'_>> {
        let (split, levels, rounds) = (&mut self.split, &mut self.levels, &mut self.rounds);
        Some(match name {
            "false_discovery_rate" => Tuned::Number(&mut self.false_discovery_rate),
            "significance_of_children" => Tuned::Number(&mut self.significance_of_children),
            "least_contacts" => Tuned::Count(&mut self.least_contacts),
            "deepest_level" => Tuned::Count(&mut self.deepest_level),
            "base_segments" => Tuned::Count(&mut self.base_segments),
            "last_halving" => Tuned::Switch(&mut self.last_halving),
            "noise_varies" => Tuned::Switch(&mut self.noise_varies),
            "most_unknowns" => Tuned::Count(&mut self.most_unknowns),
            "most_factor_entries" => Tuned::Count(&mut self.most_factor_entries),
            "posterior_draws" => Tuned::Count(&mut self.posterior_draws),
            "most_boxes" => Tuned::Count(&mut split.most_boxes),
            "contacts_of_box" => Tuned::Count(&mut split.contacts_of_box),
            "reach_of_swings" => Tuned::Small(&mut split.reach_of_swings),
            "shade" => Tuned::Number(&mut split.shade),
            "probes" => Tuned::Count(&mut levels.probes),
            "finer_roughness" => Tuned::Number(&mut levels.finer_roughness),
            "undersmoothing" => Tuned::Number(&mut levels.undersmoothing),
            "late_rounds" => Tuned::Count(&mut rounds.late_rounds),
            "most_first_fits" => Tuned::Count(&mut rounds.most_first_fits),
            "most_last_fits" => Tuned::Count(&mut rounds.most_last_fits),
            "settled_lambda" => Tuned::Number(&mut rounds.settled_lambda),
            outliers => match (&mut self.outliers, outliers) {
                (OutlierRule::Reject { clip, .. }, "clip") => Tuned::Number(clip),
                (OutlierRule::Reject { reject, .. }, "reject") => Tuned::Number(reject),
                _ => return None,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_moves_one_option_and_is_checked() {
        for name in AdaptiveOptions::TUNABLE {
            let mut options = AdaptiveOptions::default();
            let value =
                if ["last_halving", "noise_varies"].contains(&name) { f64::from(name == "last_halving") } else { 16.0 };
            options.tune(name, if name == "least_contacts" { 17.0 } else { value }).unwrap();
            assert_ne!(options, AdaptiveOptions::default(), "{name}");
            let refused = AdaptiveOptions::default().tune(name, -0.5).is_err() || {
                options.tune(name, f64::NAN).unwrap();
                options.check().is_err()
            };
            assert!(refused, "{name}");
        }
    }
}
