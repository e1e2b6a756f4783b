//! What lines come to: touches, and words about lines that are none, about a sensor that was started anew and about touches that
//! come late.

use std::cmp::Ordering;

use palpate_geometry::contact::Contacts;

use crate::io::{ColumnNames, LineHeard, TouchLines};

use super::state::LiveState;

/// What was heard: a touch, or something to be said in one line, or both, or nothing.
#[derive(Debug, Default)]
pub(in crate::cli) struct TouchHeard {
    /// One contact.
    pub(in crate::cli) touch: Option<Box<Contacts>>,
    /// What is to be said before the touch is answered.
    pub(in crate::cli) said: Option<String>,
}

/// Reads touches and keeps count of what was none.
#[derive(Debug)]
pub(in crate::cli) struct TouchHearing {
    reader: TouchLines,
    /// Time of the last touch.
    time: Option<f64>,
    /// Lines that were no touch.
    left_out: u64,
    /// Lines in a row of which something was to be said.
    in_a_row: u64,
}

/// Lines in a row of which something is said: of a million without a place people read none.
const TOLD_IN_A_ROW: u64 = 5;

impl TouchHearing {
    /// Of lines by their name; it goes on by the names of columns and the time of an earlier run.
    pub(in crate::cli) fn new(name: &str, columns: Option<ColumnNames>, before: Option<&LiveState>) -> TouchHearing {
        let mut reader = TouchLines::new(name, columns);
        if let Some(header) = before.and_then(|before| before.header.as_ref()) {
            reader.inherit(header);
        }
        TouchHearing { reader, time: before.and_then(|before| before.time), left_out: 0, in_a_row: 0 }
    }

    /// The name for messages.
    pub(in crate::cli) fn name(&self) -> &str {
        self.reader.file()
    }

    /// Lines that were no touch.
    pub(in crate::cli) fn left_out(&self) -> u64 {
        self.left_out
    }

    /// Adds what the next run needs to go on.
    pub(in crate::cli) fn remember(&self, state: &mut LiveState) {
        (state.header, state.time) = (self.reader.header(), self.time);
    }

    /// The next line, without its end.
    pub(in crate::cli) fn hear(&mut self, line: &[u8]) -> TouchHeard {
        let heard = match self.reader.hear(line) {
            Ok(LineHeard::Nothing) => return TouchHeard::default(),
            Ok(LineHeard::Names { again, note }) => TouchHeard { touch: None, said: self.named(again, note) },
            Ok(LineHeard::Touch { contact, time, note }) => {
                let place = self.place();
                let late = self.is_late(&place, time);
                TouchHeard { touch: Some(contact), said: note.or(late) }
            }
            Err(error) => self.fault(&error.to_string()),
        };
        TouchHeard { said: self.first_of_a_row(heard.said), ..heard }
    }

    /// What is said of the first lines of a row of which there is something to say.
    fn first_of_a_row(&mut self, said: Option<String>) -> Option<String> {
        self.in_a_row = if said.is_some() { self.in_a_row + 1 } else { 0 };
        match self.in_a_row.cmp(&TOLD_IN_A_ROW) {
            Ordering::Less => said,
            Ordering::Equal => said.map(|said| format!("{said}; of those that follow in a row nothing more is said")),
            Ordering::Greater => None,
        }
    }

    /// A line of which nothing was read, and why: it counts as a line.
    pub(in crate::cli) fn hear_nothing(&mut self, why: &str) -> TouchHeard {
        let _ = self.reader.hear(b"");
        let heard = self.fault(why);
        TouchHeard { said: self.first_of_a_row(heard.said), ..heard }
    }

    /// A touch that was no line, and when it was made: what is to be said of it.
    pub(in crate::cli) fn hear_contact(&mut self, place: &str, time: Option<f64>) -> Option<String> {
        let late = self.is_late(place, time);
        self.first_of_a_row(late)
    }

    /// Says that a touch is earlier than the one before it, and takes its time.
    fn is_late(&mut self, place: &str, time: Option<f64>) -> Option<String> {
        let before = self.time.zip(time).filter(|(before, time)| time < before);
        self.time = time.or(self.time);
        let (before, time) = before?;
        Some(format!("{place}: a touch of time {time} comes after one of {before}; it counts all the same"))
    }

    fn named(&mut self, again: bool, note: Option<String>) -> Option<String> {
        let place = self.place();
        if again {
            // its clock may have started anew, too
            self.time = None;
            let what = "names of columns again: the sensor was started anew, and its touches go on counting";
            return Some(format!("{place}: {what}"));
        }
        note.map(|note| format!("{place}: {note}"))
    }

    fn fault(&mut self, what: &str) -> TouchHeard {
        self.left_out += 1;
        let (file, place) = (self.reader.file(), self.place());
        let what = what.strip_prefix(&place).unwrap_or(what.strip_prefix(file).unwrap_or(what));
        // a line is left out as it is
        let what = what.trim_start_matches([':', ',', ' ']).replace(" (or skip_invalid)", "");
        TouchHeard { touch: None, said: Some(format!("{place}: {what}; no touch, left out")) }
    }

    fn place(&self) -> String {
        format!("{}, line {}", self.reader.file(), self.reader.line())
    }
}
