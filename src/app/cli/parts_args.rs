//! Arguments of `palpate parts`.

use std::path::PathBuf;

use clap::Args;

use super::options::{OutputFlags, PictureFlags};
use super::preparation::PreparationFlags;
use super::reading::ReadFlags;

/// Arguments of `palpate parts`.
#[derive(Args)]
pub(super) struct PartsArgs {
    /// A file of contacts, a mesh or a grid; or a built-in scene (palpate scenes) or a scene file ending in .toml
    pub(super) input: String,
    /// Departures from a primitive that make no part of their own [default: a tenth of the spacing or 0.3 % of the body; 1 or 3 % of one that departs from its parts by as much]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(super) tolerance: Option<f64>,
    /// Write x, y, z, normal, k1, k2, S, R, u_S and u_R at every point to .csv, .npz, .ply or .parquet (- for CSV on standard output); without --out, --json and --library, nothing is cut into parts
    #[arg(long, value_name = "FILE")]
    pub(super) points: Option<PathBuf>,
    /// Known objects, one file of the directory each: a parts.json of an earlier run, or a scan, mesh or scene; tells which of them the body is, and how probably
    #[arg(long, value_name = "DIR")]
    pub(super) library: Option<PathBuf>,
    /// Seed in place of the scene's
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// Leave out rows with missing or non-finite numbers and count them, instead of refusing the file
    #[arg(long)]
    pub(super) skip_invalid: bool,
    #[command(flatten)]
    pub(super) preparation: PreparationFlags,
    #[command(flatten)]
    pub(super) reading: ReadFlags,
    #[command(flatten)]
    pub(super) pictures: PictureFlags,
    #[command(flatten)]
    pub(super) output: OutputFlags,
}
