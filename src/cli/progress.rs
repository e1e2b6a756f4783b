//! A bar for people who wait: replicates done, how fast, S and R so far, time left. Nothing unless standard error is a terminal.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::montecarlo::{Progress, Tally};
use crate::report::significant;

use super::options::OutputFlags;

/// Goes away when dropped.
pub(super) struct Bar(Option<ProgressBar>);

impl Bar {
    /// A bar of so many steps.
    pub(super) fn new(output: &OutputFlags, steps: u64, name: &str) -> Bar {
        if output.quiet || !std::io::stderr().is_terminal() {
            return Bar(None);
        }
        let bar = ProgressBar::new(steps).with_prefix(name.to_string());
        let template = "{prefix} {bar:24} {human_pos}/{human_len} {per_sec} {msg} {eta} left";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
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
