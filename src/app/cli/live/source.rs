//! Where touches come from: lines that a robot writes, or a scene that plays the robot.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};

use palpate_geometry::contact::Contacts;
use palpate_studies::explore::Hand;

use crate::cli::explore::refused;
use crate::cli::failure::Failure;
use crate::cli::interrupt;
use crate::cli::until::LOOK;
use crate::io::scene_file::SceneFile;
use crate::io::{ColumnNames, IoError, visible};

use super::hearing::{TouchHeard, TouchHearing};
use super::look::LiveLook;
use super::next::TouchReach;
use super::state::LiveState;

/// What comes next.
#[derive(Debug)]
pub(super) enum Incoming {
    /// A touch.
    Touch(Box<Contacts>),
    /// Something that is no touch, to be said in one line.
    Said(String),
    /// Nothing more, and why.
    End(&'static str),
}

/// Lines that may wait to be read: a robot that writes faster than it is answered waits for its answers.
const LINES_AHEAD: usize = 1024;

/// Longest line, bytes. What is longer is no touch and would only fill the memory.
const LONGEST_LINE: usize = 1 << 20;

/// One line, or why there is none.
type Line = std::io::Result<Option<Vec<u8>>>;

/// Touches from lines. A thread waits for them, so that an interrupt ends the waiting.
pub(super) struct LineSource {
    lines: Receiver<Line>,
    hearing: TouchHearing,
}

impl LineSource {
    /// Of a file, or of standard input where `input` is `-`.
    pub(super) fn open(input: &str, columns: Option<ColumnNames>, before: Option<&LiveState>) -> Result<Self, Failure> {
        let (name, bytes): (String, Box<dyn Read + Send>) = if input == "-" {
            ("standard input".into(), Box::new(std::io::stdin()))
        } else {
            let file = visible(input);
            let opened = File::open(Path::new(input)).and_then(|opened| match opened.metadata()?.is_dir() {
                true => Err(std::io::ErrorKind::IsADirectory.into()),
                false => Ok(opened),
            });
            (file.clone(), Box::new(opened.map_err(|source| IoError::Read { file, source })?))
        };
        let (send, lines) = sync_channel(LINES_AHEAD);
        std::thread::spawn(move || {
            let mut bytes = BufReader::new(bytes);
            while let Some(line) = next_line(&mut bytes).transpose() {
                let failed = line.is_err();
                // whoever asked may have gone
                if send.send(line).is_err() || failed {
                    return;
                }
            }
        });
        Ok(LineSource { lines, hearing: TouchHearing::new(&name, columns, before) })
    }

    fn heard(&mut self, line: Line) -> Option<Incoming> {
        let heard = match line {
            Ok(Some(line)) => self.hearing.hear(&line),
            Ok(None) => self.hearing.hear_nothing(&format!("longer than {LONGEST_LINE} bytes")),
            Err(error) => return Some(Incoming::Said(format!("{}: cannot be read on: {error}", self.hearing.name()))),
        };
        match heard {
            TouchHeard { touch: Some(touch), said } => {
                said.iter().for_each(|said| say(said));
                Some(Incoming::Touch(touch))
            }
            TouchHeard { touch: None, said } => said.map(Incoming::Said),
        }
    }
}

/// Where touches come from.
pub(super) enum TouchSource {
    /// From lines.
    Lines(Box<LineSource>),
    /// From a simulated world.
    Scene(Box<SceneSource>),
}

impl TouchSource {
    /// What comes next; a scene touches where the last look proposes.
    pub(super) fn next(&mut self, look: Option<&LiveLook>) -> Result<Incoming, Failure> {
        match self {
            TouchSource::Scene(source) => source.next(look),
            TouchSource::Lines(source) => loop {
                match source.lines.recv_timeout(LOOK) {
                    Ok(line) => {
                        if let Some(heard) = source.heard(line) {
                            return Ok(heard);
                        }
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => return Ok(Incoming::End("input")),
                }
                if interrupt::asked() {
                    return Ok(Incoming::End("interrupted"));
                }
            },
        }
    }

    /// Where it can be touched.
    pub(super) fn reach(&self, asked: Option<[f64; 4]>) -> TouchReach {
        match self {
            TouchSource::Scene(source) => TouchReach::Places(source.hand.candidates.clone()),
            TouchSource::Lines(_) => TouchReach::Rectangle(asked),
        }
    }

    /// Lines that were no touch.
    pub(super) fn left_out(&self) -> u64 {
        match self {
            TouchSource::Lines(source) => source.hearing.left_out(),
            TouchSource::Scene(_) => 0,
        }
    }

    /// Adds what the next run needs to go on.
    pub(super) fn remember(&self, state: &mut LiveState) {
        match self {
            TouchSource::Lines(source) => source.hearing.remember(state),
            TouchSource::Scene(source) => state.planned.clone_from(&source.hand.touches),
        }
    }
}

/// A scene that is touched: its own sweeps first, then wherever the answer proposes.
pub(super) struct SceneSource {
    scene: SceneFile,
    hand: Hand,
    /// Contacts of the scene's own sweeps.
    swept: Contacts,
    /// Touches made.
    made: usize,
    budget: usize,
}

impl SceneSource {
    /// With at most `budget` touches in all, those of an earlier run among them.
    pub(super) fn new(
        scene: SceneFile,
        seed: u64,
        reach: Option<[f64; 4]>,
        budget: usize,
        before: Option<&LiveState>,
    ) -> Result<SceneSource, Failure> {
        let mut hand = Hand::new(&scene.world, seed, reach).map_err(|error| refused(&scene, &error))?;
        let (swept, _) = hand.feel().map_err(|error| refused(&scene, &error))?;
        let made = before.map_or(0, |before| usize::try_from(before.touches).unwrap_or(usize::MAX));
        if let Some(before) = before {
            hand.touches.clone_from(&before.planned);
        }
        if made.saturating_sub(swept.len()) != hand.touches.len() {
            let what = "--resume: its touches are not those of this scene";
            return Err(Failure::Input(format!("{}: {what}", scene.name)));
        }
        Ok(SceneSource { scene, hand, swept, made, budget })
    }

    fn next(&mut self, look: Option<&LiveLook>) -> Result<Incoming, Failure> {
        if interrupt::asked() {
            return Ok(Incoming::End("interrupted"));
        }
        if self.made >= self.budget {
            return Ok(Incoming::End("contacts"));
        }
        let row = |contacts: &Contacts, k: usize| {
            let number = u32::try_from(k).unwrap_or(u32::MAX);
            Incoming::Touch(Box::new(contacts.in_order(&[number])))
        };
        if self.made < self.swept.len() {
            self.made += 1;
            return Ok(row(&self.swept, self.made - 1));
        }
        let Some(next) = look.and_then(|look| look.next.as_ref()) else { return Ok(Incoming::End("places")) };
        self.hand.touches.push(next.at);
        let (contacts, _) = self.hand.feel().map_err(|error| refused(&self.scene, &error))?;
        self.made += 1;
        Ok(row(&contacts, contacts.len() - 1))
    }
}

/// The next line without its end; `None` within is one that is too long, `None` without the end of the input.
fn next_line(bytes: &mut impl BufRead) -> std::io::Result<Option<Option<Vec<u8>>>> {
    let (mut line, mut too_long, mut any) = (Vec::new(), false, false);
    loop {
        let part = bytes.fill_buf()?;
        if part.is_empty() {
            return Ok(any.then_some(if too_long { None } else { Some(line) }));
        }
        any = true;
        let end = part.iter().position(|byte| *byte == b'\n');
        let taken = &part[..end.unwrap_or(part.len())];
        too_long |= line.len() + taken.len() > LONGEST_LINE;
        if too_long {
            line = Vec::new();
        } else {
            line.extend_from_slice(taken);
        }
        let used = taken.len() + usize::from(end.is_some());
        bytes.consume(used);
        if end.is_some() {
            return Ok(Some((!too_long).then_some(line)));
        }
    }
}

/// One line on standard error, where it can still be written.
pub(super) fn say(what: &str) {
    let line = format!("palpate: {}\n", visible(what));
    // nobody is left to tell
    let _ = std::io::Write::write_all(&mut std::io::stderr(), line.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_whole_and_never_too_long() {
        let mut text = b"a\n\nlast".to_vec();
        text.splice(2..2, [vec![b'x'; LONGEST_LINE + 1], vec![b'\n']].concat());
        // a small buffer, so that lines are put together
        let mut bytes = BufReader::with_capacity(7, text.as_slice());
        let mut next = || next_line(&mut bytes).unwrap();
        let of = |text: &str| Some(Some(text.as_bytes().to_vec()));
        assert_eq!([next(), next(), next(), next(), next()], [of("a"), Some(None), of(""), of("last"), None]);
    }
}
