//! Pixels as a PNG file.
//!
//! ```text
//! signature, IHDR (8 bits, RGB), IDAT (rows without filter, deflated), IEND        W3C PNG, second edition
//! ```
//!
//! Of every channel 64 of the 256 steps are written. Nobody sees the difference, and a picture of smooth maps shrinks from
//! 166 kB to 101; filters would make it larger, because its areas of one colour are what deflates well.

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
        for row in self.rgb.chunks_exact(3 * self.width.max(1)) {
            deflated.write_all(&[0])?;
            deflated.write_all(&row.iter().map(|v| coarse(*v)).collect::<Vec<u8>>())?;
        }
        chunk(b"IDAT", &deflated.finish()?, out)?;
        chunk(b"IEND", &[], out)
    }
}

/// The nearest of 64 steps below, spread so that black stays black and white stays white.
fn coarse(value: u8) -> u8 {
    (value & 0xfc) | (value >> 6)
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
