//! Pixels as a PNG file.
//!
//! ```text
//! signature, IHDR (8 bits, RGB), IDAT (filtered rows, deflated), IEND        W3C PNG, second edition
//! filter of a row: the one of none, left, above whose differences are smallest in sum (its section 12.8)
//! ```

use std::io::Write;

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};

/// Pixels, row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Raster {
    /// Pixels of a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of every pixel.
    pub rgb: Vec<u8>,
}

impl Raster {
    /// As a PNG file.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn write_png(&self, out: &mut dyn Write) -> std::io::Result<()> {
        out.write_all(b"\x89PNG\r\n\x1a\n")?;
        let mut head = Vec::new();
        head.extend_from_slice(&(self.width as u32).to_be_bytes());
        head.extend_from_slice(&(self.height as u32).to_be_bytes());
        // 8 bits, RGB, the only compression and filter method there are, not interlaced
        head.extend_from_slice(&[8, 2, 0, 0, 0]);
        chunk(b"IHDR", &head, out)?;
        let mut deflated = ZlibEncoder::new(Vec::new(), Compression::best());
        let length = 3 * self.width.max(1);
        let mut above = vec![0; length];
        for row in self.rgb.chunks_exact(length) {
            deflated.write_all(&filtered(row, &above))?;
            above.copy_from_slice(row);
        }
        chunk(b"IDAT", &deflated.finish()?, out)?;
        chunk(b"IEND", &[], out)
    }
}

/// A row behind the number of its filter.
fn filtered(row: &[u8], above: &[u8]) -> Vec<u8> {
    let left = std::iter::repeat_n(0, 3).chain(row.iter().copied());
    let size = |v: &[u8]| v[1..].iter().map(|d| u32::from(d.min(&d.wrapping_neg()).to_owned())).sum::<u32>();
    let plain: Vec<u8> = std::iter::once(0).chain(row.iter().copied()).collect();
    let sub: Vec<u8> = std::iter::once(1).chain(row.iter().zip(left).map(|(v, l)| v.wrapping_sub(l))).collect();
    let up: Vec<u8> = std::iter::once(2).chain(row.iter().zip(above).map(|(v, a)| v.wrapping_sub(*a))).collect();
    [plain, sub, up].into_iter().min_by_key(|v| size(v)).unwrap_or_default()
}

fn chunk(name: &[u8; 4], content: &[u8], out: &mut dyn Write) -> std::io::Result<()> {
    let mut crc = Crc::new();
    crc.update(name);
    crc.update(content);
    out.write_all(&(content.len() as u32).to_be_bytes())?;
    out.write_all(name)?;
    out.write_all(content)?;
    out.write_all(&crc.sum().to_be_bytes())
}
