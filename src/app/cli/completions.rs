//! `palpate completions SHELL` and `palpate man`: what a shell and a manual reader want of the command line, made from it.

use std::io::Write;

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::Line;
use super::failure::Failure;
use super::output::print;

/// Arguments of `palpate completions`.
#[derive(Args)]
pub(super) struct CompletionsArgs {
    /// The shell
    shell: Shell,
}

pub(super) fn completions(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Line::command(), "palpate", &mut script);
    print(&mut |out| out.write_all(&script))
}

/// The manual page, all commands in one.
pub(super) fn man() -> Result<(), Failure> {
    let mut command = Line::command();
    command.build();
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone()).render(&mut page)?;
    for verb in command.get_subcommands().filter(|verb| !verb.is_hide_set()) {
        let name = verb.get_name().to_uppercase();
        writeln!(page, ".SH \"PALPATE {name}\"")?;
        let part = clap_mangen::Man::new(verb.clone());
        part.render_synopsis_section(&mut page)?;
        part.render_description_section(&mut page)?;
        part.render_options_section(&mut page)?;
    }
    // every command stands on this page, and has none of its own
    let page = String::from_utf8_lossy(&page).replace("palpate\\-", "palpate ").replace("(1)\n", "\n");
    print(&mut |out| out.write_all(page.as_bytes()))
}
