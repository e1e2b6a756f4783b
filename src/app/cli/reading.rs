//! Options of reading a file of contacts.

use clap::Args;

use crate::io::{ColumnNames, Input, Intrinsics, IoError, ReadOptions, Reading};
use palpate_geometry::contact::Orientation;

use super::failure::Failure;

/// How the input is read.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Input")]
pub(super) struct ReadFlags {
    /// Camera of a depth image (PNG of 16 bits, NPY, NPZ with depth): focal lengths and centre in pixels, length of one unit of depth [default scale: 1]
    #[arg(long, hide_short_help = true, value_name = "FX,FY,CX,CY[,SCALE]", allow_hyphen_values = true)]
    intrinsics: Option<Intrinsics>,
    /// Which columns are which, where their names do not tell: x=NAME,y=NAME,z=NAME
    ///
    /// nx, ny, nz (or zx, zy), finger, station and weights may be named, too; columns that are not named are found by their usual names
    #[arg(long, value_name = "x=NAME,..")]
    columns: Option<ColumnNames>,
}

impl ReadFlags {
    /// A camera was typed.
    pub(super) fn has_intrinsics(&self) -> bool {
        self.intrinsics.is_some()
    }

    /// Columns were named.
    pub(super) fn has_columns(&self) -> bool {
        self.columns.is_some()
    }

    /// Why a file was not read; of one whose columns have other names, what to type.
    pub(super) fn refused(error: IoError) -> Failure {
        match &error {
            IoError::MissingColumn { needed, .. } if needed.starts_with("x,y,z;") => {
                Failure::Input(format!("{error}; --columns x=NAME,y=NAME,z=NAME says which is which"))
            }
            _ => error.into(),
        }
    }

    pub(super) fn options(&self, skip_invalid: bool) -> ReadOptions {
        let columns = self.columns.clone();
        ReadOptions { skip_invalid, intrinsics: self.intrinsics, columns, ..ReadOptions::default() }
    }
}

/// Where the file says that the sensor stood. Normals say more of the free side than a viewpoint, which many programs write
/// into every file.
pub(super) fn seen_from(reading: &Reading) -> Option<[f64; 3]> {
    let has_normals = |input: &Input| matches!(input, Input::Contacts(c) if c.orientation != Orientation::None);
    reading.viewpoint.filter(|_| !has_normals(&reading.input))
}
