//! What `palpate live` answers, for a program that holds the touches.
//!
//! ```text
//! a line, or one contact  ->  LiveLoop  ->  LiveReply: what is to be said, the line of `palpate live --json`, the goal
//! ```

use std::path::Path;
use std::time::Instant;

use palpate_geometry::contact::{ContactError, Contacts};

use crate::report::write_json;

use super::failure::Failure;
use super::live::{
    LiveArgs, LiveSession, LiveState, LookMaps, TouchHeard, TouchHearing, TouchReach, checked, json_line, text_line,
};

/// What the lines are called in messages.
const LINES: &str = "touches";

/// Touches that come one by one, and what is known of them.
#[derive(Debug)]
pub struct LiveLoop {
    session: LiveSession,
    hearing: TouchHearing,
}

/// One answer.
#[derive(Debug)]
pub struct LiveAnswer {
    /// The line of `palpate live --json`.
    pub json: String,
    /// The line of `palpate live`.
    pub words: String,
    /// The goal is reached.
    pub is_reached: bool,
}

/// What one line or one touch came to.
#[derive(Debug, Default)]
pub struct LiveReply {
    /// What is no touch, is late, or was assumed.
    pub said: Option<String>,
    /// The answer, where it was a touch.
    pub answer: Option<LiveAnswer>,
}

impl LiveLoop {
    /// From the arguments of `palpate live`, `-` first, read already.
    ///
    /// # Errors
    /// What the command line would say.
    pub(super) fn of(args: &LiveArgs) -> Result<LiveLoop, String> {
        let before = args.resume.as_deref().map(LiveState::read).transpose().map_err(Failure::into_message)?;
        let hearing = TouchHearing::new(LINES, args.columns.clone(), before.as_ref());
        let session = LiveSession::new(args.options(TouchReach::Rectangle(args.reach)), before);
        Ok(LiveLoop { session, hearing })
    }

    /// A line of a table, its names, or a JSON object.
    ///
    /// # Errors
    /// Why there is no line for an answer.
    pub fn hear(&mut self, line: &[u8]) -> Result<LiveReply, String> {
        let clock = Instant::now();
        let TouchHeard { touch, said } = self.hearing.hear(line);
        let answer = touch.map(|touch| self.answered(&touch, clock)).transpose()?;
        Ok(LiveReply { said, answer })
    }

    /// One contact, and when it was made. A normal of zeros is one that is not known.
    ///
    /// # Errors
    /// Why there is no line for an answer.
    pub fn touch(&mut self, touch: &Contacts, time: Option<f64>) -> Result<LiveReply, String> {
        let clock = Instant::now();
        let place = format!("{LINES}, touch {}", self.session.touches() + 1);
        let said = self.hearing.hear_contact(&place, time);
        Ok(LiveReply { said, answer: Some(self.answered(touch, clock)?) })
    }

    /// Looks once more where touches came since the last look.
    ///
    /// # Errors
    /// Why there is no line for an answer.
    pub fn finish(&mut self) -> Result<Option<LiveAnswer>, String> {
        let clock = Instant::now();
        if self.session.finish() { self.answer(clock, false).map(Some) } else { Ok(None) }
    }

    fn answered(&mut self, touch: &Contacts, clock: Instant) -> Result<LiveAnswer, String> {
        let is_reached = self.session.touch(touch);
        self.answer(clock, is_reached)
    }

    fn answer(&self, clock: Instant, is_reached: bool) -> Result<LiveAnswer, String> {
        let (look, touch) = (self.session.look().ok_or("there was no touch")?, self.session.touches());
        let json = json_line(look, touch, clock.elapsed().as_secs_f64()).map_err(|error| error.to_string())?;
        Ok(LiveAnswer { json, words: text_line(look, touch), is_reached })
    }

    /// Writes the file that `palpate live --save` writes.
    ///
    /// # Errors
    /// What the command line would say.
    pub fn save(&self, path: &Path) -> Result<(), String> {
        let mut state = self.session.state();
        self.hearing.remember(&mut state);
        state.write(path).map_err(Failure::into_message)
    }

    /// Touches that ever came.
    pub fn touches(&self) -> u64 {
        self.session.touches()
    }

    /// How often all touches were looked at.
    pub fn looks(&self) -> u64 {
        self.session.looks()
    }

    /// Lines that were no touch.
    pub fn left_out(&self) -> u64 {
        self.hearing.left_out()
    }

    /// The touches that count.
    pub fn contacts(&self) -> Contacts {
        self.session.contacts()
    }

    /// The document that `palpate fit --save` writes, of the last look; `None` where there is no answer.
    ///
    /// # Errors
    /// Why there is none.
    pub fn document(&self) -> Result<Option<Vec<u8>>, String> {
        let Some(look) = self.session.look() else { return Ok(None) };
        Ok(look.saved()?.map(|document| {
            let mut json = Vec::new();
            // a Vec takes every byte
            let _ = write_json(&document, &mut json);
            json
        }))
    }

    /// The axes and the arrays of `maps.npz` of the last look; `None` where there is no answer.
    ///
    /// # Errors
    /// Why there are none.
    pub fn maps(&self, points: Option<[usize; 2]>) -> Result<Option<LookMaps>, String> {
        self.session.look().map_or(Ok(None), |look| look.maps(points))
    }
}

/// Whether a touch can be one.
///
/// # Errors
/// What is wrong with it.
pub fn check_touch(touch: &Contacts) -> Result<(), ContactError> {
    checked(touch)
}
