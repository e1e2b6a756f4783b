//! Pixels as a PNG file.
//!
//! ```text
//! signature, IHDR (8 bits, RGB), IDAT (rows without filter, deflated), IEND        W3C PNG, second edition
//! ```
//!
//! Of every channel 64 of the 256 steps are written. Nobody sees the difference, and a picture of smooth maps shrinks from
//! 166 kB to 101; filters would make it larger, because its areas of one colour are what deflates well. A picture that would
//! still be [`LARGE`], as four maps of a rough surface are, is written with 32 steps: 207 kB become 150.

use std::io::Write;

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};

/// Bytes of pixels from which on a picture is written with fewer steps: papers and e-mails take 200 kB.
const LARGE: usize = 190_000;

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
        let fine = self.deflated(6)?;
        let pixels = if fine.len() > LARGE { self.deflated(5)? } else { fine };
        chunk(b"IDAT", &pixels, out)?;
        chunk(b"IEND", &[], out)
    }

    /// The rows with so many bits of every channel.
    fn deflated(&self, bits: u32) -> std::io::Result<Vec<u8>> {
        let mut deflated = ZlibEncoder::new(Vec::new(), Compression::best());
        for row in self.rgb.chunks_exact(3 * self.width.max(1)) {
            deflated.write_all(&[0])?;
            deflated.write_all(&row.iter().map(|v| coarse(*v, bits)).collect::<Vec<u8>>())?;
        }
        deflated.finish()
    }
}

/// The nearest of 2^bits steps below, spread so that black stays black and white stays white.
fn coarse(value: u8, bits: u32) -> u8 {
    let low = 8 - bits;
    (value >> low << low) | (value >> bits)
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
