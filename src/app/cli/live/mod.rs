//! `palpate live INPUT|SCENE`: touches come one by one, and each is answered on one line.
//!
//! ```text
//! line -> touch -> the touches that count -> look, or the last look is moved, or it stands -> one line -> goal?
//! ```
//!
//! A line is never an answer of touches that it has not seen: where the last look stands, the line says of how many touches
//! that look is. At the end all touches are looked at once more.

mod goal;
mod hearing;
mod latency;
mod line;
mod look;
mod next;
mod session;
mod source;
mod state;
mod store;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;

use crate::io::ColumnNames;
use crate::report::significant;

use super::failure::Failure;
use super::frontier::is_scene;
use super::options::OutputFlags;
use super::output::print;
use super::{interrupt, scene, values};

use latency::LatencyHistogram;
use line::LINE_SCHEMA;
use source::{Incoming, LineSource, SceneSource, TouchSource, say};

pub(super) use hearing::{TouchHeard, TouchHearing};
pub(super) use line::{json_line, text_line};
pub(super) use look::LookMaps;
pub(super) use next::TouchReach;
pub(super) use session::{LiveOptions, LiveSession};
pub(super) use state::{LiveState, checked};

/// Arguments of `palpate live`.
#[derive(Args)]
pub(super) struct LiveArgs {
    /// Lines of touches: a file, or - for standard input; or a scene, which plays the robot
    ///
    /// A table whose first line has names (x,y,z, perhaps nx,ny,nz, time), or one JSON object a line
    input: String,
    /// Stop when the radius is known to plus or minus this: half of its interval, at two answers in a row
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, allow_hyphen_values = true)]
    until_radius: Option<f64>,
    /// Stop when the standard uncertainty of S, in all, is at most this; R follows by --u-r
    #[arg(long, value_parser = values::positive, value_name = "U", allow_hyphen_values = true, requires = "u_r")]
    u_s: Option<f64>,
    /// Stop when the standard uncertainty of R, in all, is at most this share of R; S follows by --u-s
    #[arg(long, value_parser = values::positive, value_name = "SHARE", allow_hyphen_values = true, requires = "u_s")]
    u_r: Option<f64>,
    /// Only the last N touches count whenever all are looked at, and memory stays as it is however many come
    ///
    /// Between two looks (see --refresh) the touches that came since move the answer, and none leaves
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(3..))]
    window: Option<u32>,
    /// Look at all touches again when they have grown by this share, and whenever one disagrees; 0: after every touch
    ///
    /// Between two looks each touch moves the answer of the last one. Where that is no simple shape it stands, and a fifth of this share
    /// calls for a look, unless the touches are several things
    #[arg(long, value_name = "SHARE", default_value_t = 0.25, value_parser = share, allow_hyphen_values = true)]
    refresh: f64,
    /// Where touches may be made next; default: the rectangle of the touches so far, or of a scene's first sweep
    #[arg(long, value_parser = values::domain, value_name = "X0,X1,Y0,Y1", allow_hyphen_values = true)]
    pub(super) reach: Option<[f64; 4]>,
    /// Where the sensor stood: the side of the surface that it saw is the free side
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    viewpoint: Option<[f64; 3]>,
    /// Which columns are which, where their names do not tell: x=NAME,y=NAME,z=NAME
    #[arg(long, value_name = "x=NAME,..")]
    pub(super) columns: Option<ColumnNames>,
    /// Most touches of a scene, those of its own sweeps among them [default: 60]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=10_000), value_name = "N")]
    contacts: Option<u32>,
    /// Seed in place of the scene's
    #[arg(long)]
    seed: Option<u64>,
    /// Keep the touches in this file: at the end, on Ctrl-C, and about once a second
    #[arg(long, value_name = "STATE")]
    save: Option<PathBuf>,
    /// Go on after the touches that an earlier --save has kept
    #[arg(long, value_name = "STATE")]
    pub(super) resume: Option<PathBuf>,
    /// Print one JSON object a line
    #[arg(long)]
    json: bool,
    /// Do not say at the end how many touches came and how long answers took
    #[arg(long, short)]
    quiet: bool,
}

/// Touches of a scene where nothing is said, as in `palpate explore`.
const SCENE_CONTACTS: u32 = 60;

/// Least time between two savings on the way.
const SAVED_EVERY: Duration = Duration::from_secs(1);

/// A share of what there is.
fn share(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok().filter(|share| (0.0..=1e6).contains(share));
    number.ok_or_else(|| "a share such as 0.25; 0 is after every touch".into())
}

impl LiveArgs {
    /// How touches that can be made there are answered.
    pub(super) fn options(&self, reach: TouchReach) -> LiveOptions {
        LiveOptions {
            window: self.window.map(|window| window as usize),
            refresh: self.refresh,
            until_radius: self.until_radius,
            until_shape: self.u_s.zip(self.u_r).map(<[f64; 2]>::from),
            viewpoint: self.viewpoint,
            reach,
        }
    }

    fn source(&self, before: Option<&LiveState>) -> Result<TouchSource, Failure> {
        if self.input == "-" || !is_scene(&self.input) {
            let for_scenes = [(self.contacts.is_some(), "--contacts"), (self.seed.is_some(), "--seed")];
            return match for_scenes.iter().find(|(typed, _)| *typed) {
                Some((_, option)) => {
                    Err(Failure::Input(format!("{option} is for scenes, and {} has touches of its own", self.input)))
                }
                None => Ok(TouchSource::Lines(Box::new(LineSource::open(&self.input, self.columns.clone(), before)?))),
            };
        }
        if self.columns.is_some() {
            return Err(Failure::Input("--columns is for lines of touches, and a scene has none".into()));
        }
        let scene = scene::load(&self.input)?;
        if scene.names_a_model {
            say(&format!("{}: its [fit] is not used: what its touches show is recognised", scene.name));
        }
        let (seed, budget) = (self.seed.unwrap_or(scene.seed), self.contacts.unwrap_or(SCENE_CONTACTS) as usize);
        Ok(TouchSource::Scene(Box::new(SceneSource::new(scene, seed, self.reach, budget, before)?)))
    }
}

/// A session whose touches come from a source and whose answers are printed.
struct LiveRun<'a> {
    args: &'a LiveArgs,
    session: LiveSession,
    latencies: LatencyHistogram,
    saved: Instant,
}

pub(super) fn live(args: &LiveArgs) -> Result<(), Failure> {
    // a state that cannot be saved, or would be written over the touches, is no discovery for the end
    OutputFlags::default().prepare(&[args.input.as_ref()], args.save.as_slice())?;
    let before = args.resume.as_deref().map(LiveState::read).transpose()?;
    let mut source = args.source(before.as_ref())?;
    let session = LiveSession::new(args.options(source.reach(args.reach)), before);
    let mut run = LiveRun { args, session, latencies: LatencyHistogram::new(), saved: Instant::now() };
    // a scene that goes on touches where the touches before propose
    if matches!(source, TouchSource::Scene(_)) && run.session.touches() > 0 {
        run.session.look_again();
    }
    interrupt::gently();
    let outcome = run.run(&mut source);
    run.save(&source)?;
    run.end(&source, outcome?)
}

impl LiveRun<'_> {
    /// Answers until something ends it, and says what.
    fn run(&mut self, source: &mut TouchSource) -> Result<&'static str, Failure> {
        loop {
            match source.next(self.session.look())? {
                Incoming::Said(what) => say(&what),
                Incoming::Touch(touch) => {
                    let clock = Instant::now();
                    let is_reached = self.session.touch(&touch);
                    self.write_line(clock)?;
                    self.latencies.add(clock.elapsed());
                    if is_reached {
                        return Ok("goal");
                    }
                    if self.saved.elapsed() >= SAVED_EVERY {
                        self.save(source)?;
                    }
                }
                Incoming::End(why) => {
                    let clock = Instant::now();
                    if self.session.finish() {
                        self.write_line(clock)?;
                    }
                    return Ok(why);
                }
            }
        }
    }

    fn write_line(&self, clock: Instant) -> Result<(), Failure> {
        let Some(look) = self.session.look() else { return Ok(()) };
        let touch = self.session.touches();
        let line = match self.args.json {
            true => json_line(look, touch, clock.elapsed().as_secs_f64()).map_err(std::io::Error::from)?,
            false => text_line(look, touch),
        };
        print(&mut |out| writeln!(out, "{line}"))
    }

    fn save(&mut self, source: &TouchSource) -> Result<(), Failure> {
        let Some(path) = &self.args.save else { return Ok(()) };
        let mut state = self.session.state();
        source.remember(&mut state);
        self.saved = Instant::now();
        state.write(path)
    }

    /// Says how it ended.
    fn end(&self, source: &TouchSource, why: &'static str) -> Result<(), Failure> {
        let touches = self.session.touches();
        if self.args.json {
            let line = serde_json::json!({
                "schema": LINE_SCHEMA, "stopped": why, "touches": touches, "left_out": source.left_out(),
                "fresh": self.session.looks(), "p50_ms": self.latencies.quantile_ms(0.5),
                "p99_ms": self.latencies.quantile_ms(0.99), "answers_per_second": self.latencies.rate(),
            });
            print(&mut |out| writeln!(out, "{line}"))?;
        } else if !self.args.quiet {
            say(&self.last_words(source, why));
        }
        match why {
            "interrupted" => Err(Failure::Interrupted(format!("interrupted after {touches} touches"))),
            _ => Ok(()),
        }
    }

    fn last_words(&self, source: &TouchSource, why: &str) -> String {
        let times = &self.latencies;
        let [half, most] = [0.5, 0.99].map(|share| significant(times.quantile_ms(share), 3));
        let mut words = vec![format!("{} touches, {} lines left out", self.session.touches(), source.left_out())];
        if times.count() > 0 {
            let (looks, rate) = (self.session.looks(), significant(times.rate(), 3));
            words.push(format!(
                "{looks} looks at all of them; half of the answers within {half} ms, 99 % within {most} ms, {rate} a second"
            ));
        }
        words.extend(self.session.has_goal().then(|| self.of_goal(why)));
        words.join("; ")
    }

    fn of_goal(&self, why: &str) -> String {
        if why == "goal" {
            return "the goal is reached".into();
        }
        let half = self.session.half_towards_goal();
        let known = half.map_or(String::new(), |half| format!(": the radius is known to +- {}", significant(half, 2)));
        format!("the goal is not reached{known}")
    }
}
