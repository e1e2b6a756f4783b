//! NPY: one array of n x 3 or n x 6 numbers, a contact in every row.

use crate::io::columns::{Column, Columns, Need};
use crate::io::npy::Header;
use crate::io::place::Unit;
use crate::io::{IoError, ReadOptions, Reading};

/// Contacts from the bytes of an NPY file.
pub(in crate::io) fn read(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    let wrong = |what: String| IoError::Form { file: file.into(), form: "NPY", what };
    let (header, values) = Header::read_whole(bytes).map_err(wrong)?;
    let (rows, fields) = match header.shape[..] {
        [rows, fields @ (3 | 6)] => (rows, fields),
        _ => {
            return Err(wrong(format!(
                "its shape is {:?}; contacts are n x 3 (x, y, z) or n x 6 (and nx, ny, nz); \
                 heights on a grid need axes: np.savez(F, x=..., y=..., z=...); a depth image needs its intrinsics",
                header.shape
            )));
        }
    };
    let known = [Column::X, Column::Y, Column::Z, Column::Nx, Column::Ny, Column::Nz];
    let names: Vec<&str> = known[..fields].iter().map(|column| column.name()).collect();
    let mut columns = Columns::named(file, &names, Need::Contacts)?;
    for (k, column) in known[..fields].iter().enumerate() {
        let at = |row: usize| if header.fortran_order { k * rows + row } else { row * fields + k };
        columns.set(*column, (0..rows).map(|row| values[at(row)]).collect());
    }
    columns.into_reading(file, ((0..rows).collect(), Unit::Entry), options)
}
