//! `palpate scenes [NAME]`: the built-in scenes, or one of them as TOML to start from.

use clap::Args;
use serde::Serialize;

use crate::io::scene_file::{BuiltinScene, builtin, builtin_scenes, family_members};
use crate::report::write_json;

use super::failure::Failure;
use super::options::OutputFlags;
use super::output::print;

/// Arguments of `palpate scenes`.
#[derive(Args)]
pub(super) struct ScenesArgs {
    /// Print this scene as TOML
    name: Option<String>,
    #[command(flatten)]
    output: OutputFlags,
}

#[derive(Serialize)]
struct Listed<'a> {
    name: &'a str,
    line: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    toml: Option<&'a str>,
}

#[derive(Serialize)]
struct ScenesDocument<'a> {
    schema: &'static str,
    scenes: Vec<Listed<'a>>,
}

pub(super) fn scenes(args: &ScenesArgs) -> Result<(), Failure> {
    let mut found = builtin_scenes();
    if args.name.is_some() {
        found.extend(family_members());
    }
    if let Some(name) = &args.name {
        found.retain(|scene| scene.name == *name);
        if found.is_empty() {
            let why = builtin(name).err().map_or(String::new(), |e| e.to_string());
            return Err(Failure::Input(why));
        }
    }
    args.output.prepare(&[], &[])?;
    for scene in &found {
        args.output.file(&format!("{}.toml", scene.name), &mut |out| out.write_all(scene.toml.as_bytes()))?;
    }
    args.output.publish()?;
    if args.output.json {
        let listed = |scene| listed(scene, args.name.is_some());
        let document = ScenesDocument { schema: "palpate.scenes/1", scenes: found.iter().map(listed).collect() };
        return print(&mut |out| write_json(&document, out));
    }
    if args.name.is_some() {
        return print(&mut |out| out.write_all(found[0].toml.as_bytes()));
    }
    if args.output.quiet {
        return Ok(());
    }
    let width = found.iter().map(|scene| scene.name.len()).max().unwrap_or(0);
    print(&mut |out| found.iter().try_for_each(|scene| writeln!(out, "{:width$}  {}", scene.name, scene.line)))
}

fn listed(scene: &BuiltinScene, whole: bool) -> Listed<'_> {
    Listed { name: &scene.name, line: &scene.line, toml: whole.then_some(&scene.toml) }
}
