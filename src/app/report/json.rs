//! One JSON document, every number with the fewest digits that read back to the same bits; NaN and infinity as `null`.

use std::io::Write;

use serde::Serialize;

/// Writes `document` on lines of its own, indented, with a newline at the end.
///
/// # Errors
/// What the system says.
pub(crate) fn write_json(document: &impl Serialize, out: &mut dyn Write) -> std::io::Result<()> {
    let mut whole = serde_json::to_vec_pretty(document).map_err(std::io::Error::from)?;
    whole.push(b'\n');
    out.write_all(&whole)
}
