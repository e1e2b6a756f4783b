//! A saved surface at places of the user's choice, whatever kind of surface it is.

use std::io::Write;

/// Rows that can be written as CSV and as JSON.
pub(crate) trait PointTable {
    /// One row a point.
    ///
    /// # Errors
    /// What the system says.
    fn write_csv(&self, out: &mut dyn Write) -> std::io::Result<()>;

    /// One document.
    ///
    /// # Errors
    /// What the system says.
    fn write_json(&self, out: &mut dyn Write) -> std::io::Result<()>;
}
