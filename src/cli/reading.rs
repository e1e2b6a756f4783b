//! Options of reading a file of contacts.

use clap::Args;

use crate::io::{Intrinsics, ReadOptions};

/// How the input is read.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Input")]
pub(super) struct ReadFlags {
    /// Camera of a depth image (PNG of 16 bits, NPY, NPZ with depth): focal lengths and centre in pixels, length of one unit of depth [default scale: 1]
    #[arg(long, value_name = "FX,FY,CX,CY[,SCALE]", allow_hyphen_values = true)]
    intrinsics: Option<Intrinsics>,
}

impl ReadFlags {
    pub(super) fn options(&self, skip_invalid: bool) -> ReadOptions {
        ReadOptions { skip_invalid, intrinsics: self.intrinsics, ..ReadOptions::default() }
    }
}
