//! A bar for people who wait: replicates done, how fast, time left, S and R so far. Nothing unless standard error is a terminal.
//!
//! The bar takes one line of the terminal, however narrow: a line that wraps could not be taken away again.

use std::fmt::Write;
use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{HumanCount, ProgressBar, ProgressState, ProgressStyle};

use crate::report::significant;
use palpate_studies::montecarlo::{Progress, Tally};

use super::options::OutputFlags;
use super::output::brief;
use super::time_left::said_left;

/// How fast, and for how long still; nothing before the first step is done.
fn pace(done: u64, a_second: f64, left: Duration) -> String {
    if done == 0 || !a_second.is_finite() || a_second <= 0.0 {
        return String::new();
    }
    // of thousands, digits beyond the second only flicker
    let unit = 10_f64.powf((a_second.log10().floor() - 1.0).max(0.0));
    let rate = if a_second < 10.0 {
        significant(a_second, 2)
    } else {
        HumanCount(((a_second / unit).round() * unit) as u64).to_string()
    };
    format!(", {rate} a second{}", said_left(", ", left))
}

/// Goes away when dropped.
pub(super) struct Bar(Option<ProgressBar>);

impl Bar {
    /// A bar of so many steps.
    pub(super) fn new(output: &OutputFlags, steps: u64, name: &str) -> Bar {
        if output.quiet || !std::io::stderr().is_terminal() {
            return Bar(None);
        }
        let bar = ProgressBar::new(steps).with_prefix(brief(name));
        let template = "{prefix} {bar:20} {human_pos}/{human_len}{pace}  {wide_msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.with_key("pace", |state: &ProgressState, out: &mut dyn Write| {
                let _ = out.write_str(&pace(state.pos(), state.per_sec(), state.eta()));
            }));
        }
        bar.enable_steady_tick(Duration::from_millis(250));
        Bar(Some(bar))
    }

    /// Where the study stands.
    pub(super) fn show(&self, progress: &Progress<'_>, _seconds: f64) {
        let Some(bar) = &self.0 else { return };
        bar.set_length(progress.end - progress.state.from);
        bar.set_position(progress.state.done());
        let so_far = |name: &str, tally: Option<&Tally>| {
            let (mean, sd) = tally.and_then(|t| t.mean().zip(t.sd()))?;
            // the ends themselves need a sort of all replicates
            Some(format!("{name} {} +- {}", significant(mean, 4), significant(sd, 2)))
        };
        let tallies = &progress.state.tallies;
        let words = [so_far("S", tallies.first()), so_far("R", tallies.get(1))];
        bar.set_message(words.into_iter().flatten().collect::<Vec<_>>().join("  "));
    }

    /// So many more steps that need no words.
    pub(super) fn steps(&self, count: u64) {
        if let Some(bar) = &self.0 {
            bar.inc(count);
        }
    }

    /// One more step of a list.
    pub(super) fn step(&self, words: String) {
        if let Some(bar) = &self.0 {
            bar.inc(1);
            bar.set_message(words);
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pace_is_said_once_there_is_one_and_in_few_digits() {
        assert_eq!(pace(0, 0.0, Duration::ZERO), "");
        assert_eq!(pace(147_456, 36_853.988, Duration::from_secs(840)), ", 37,000 a second, 14m left");
        assert_eq!(pace(3, 0.4567, Duration::from_secs(9)), ", 0.46 a second, 9s left");
    }
}
