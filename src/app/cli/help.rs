//! `palpate help [TOPIC]`: a command's help, or the manual of scene files.

use clap::Args;

use crate::io::scene_file::{scene_manual, scene_topics};
use crate::io::visible;
use crate::report::folded;

use super::command;
use super::failure::Failure;
use super::output::{columns, print, wants_colour};

/// Arguments of `palpate help`.
#[derive(Args)]
pub(super) struct HelpArgs {
    /// A command, or scene: what a scene file may hold
    topic: Option<String>,
    /// After scene: one section, surface or effect, such as sweep, torus or encoder
    about: Option<String>,
}

pub(super) fn help(args: &HelpArgs) -> Result<(), Failure> {
    let mut all = command();
    all.build();
    let (topic, about) = (args.topic.as_deref(), args.about.as_deref());
    if topic == Some("scene") {
        let text = folded(&scene_manual(about).map_err(Failure::Input)?, None, columns());
        return print(&mut |out| out.write_all(text.as_bytes()));
    }
    let verb = match topic {
        None => &mut all,
        Some(topic) => match all.find_subcommand_mut(topic) {
            Some(verb) => verb,
            None => return Err(unknown(&command(), topic)),
        },
    };
    let help = verb.render_long_help();
    let text = if wants_colour() { help.ansi().to_string() } else { help.to_string() };
    print(&mut |out| out.write_all(text.as_bytes()))
}

fn unknown(command: &clap::Command, topic: &str) -> Failure {
    let verbs: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
    let shown = visible(topic);
    let scene = if scene_topics().contains(&topic) {
        format!("; palpate help scene {shown} tells of it")
    } else {
        String::new()
    };
    Failure::Input(format!("no help on {shown:?}{scene}; there is help on scene, {}", verbs.join(", ")))
}
