//! Options of reading a file of contacts.

use clap::Args;

use crate::io::{Input, Intrinsics, ReadOptions, Reading};
use palpate_geometry::contact::Orientation;

/// How the input is read.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Input")]
pub(super) struct ReadFlags {
    /// Camera of a depth image (PNG of 16 bits, NPY, NPZ with depth): focal lengths and centre in pixels, length of one unit of depth [default scale: 1]
    #[arg(long, value_name = "FX,FY,CX,CY[,SCALE]", allow_hyphen_values = true)]
    intrinsics: Option<Intrinsics>,
}

impl ReadFlags {
    /// A camera was typed.
    pub(super) fn has_intrinsics(&self) -> bool {
        self.intrinsics.is_some()
    }

    pub(super) fn options(&self, skip_invalid: bool) -> ReadOptions {
        ReadOptions { skip_invalid, intrinsics: self.intrinsics, ..ReadOptions::default() }
    }
}

/// Where the file says that the sensor stood. Normals say more of the free side than a viewpoint, which many programs write
/// into every file.
pub(super) fn seen_from(reading: &Reading) -> Option<[f64; 3]> {
    let has_normals = |input: &Input| matches!(input, Input::Contacts(c) if c.orientation != Orientation::None);
    reading.viewpoint.filter(|_| !has_normals(&reading.input))
}
