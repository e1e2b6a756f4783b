//! Colours of a map as a PNG inside the page: one pixel a point, transparent where nothing is known.
//!
//! ```text
//! signature, IHDR (8 bits, RGBA), IDAT (rows without filter, deflated), IEND        W3C PNG, second edition
//! ```

use std::io::Write;

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};

use super::super::colour::Colour;
use crate::io::base64;

/// A picture of `width` x `height` pixels as a `data:` address; `colour(column, row)` counts rows from the top.
///
/// # Errors
/// What the system says of memory.
pub(super) fn data_url(
    width: usize,
    height: usize,
    colour: impl Fn(usize, usize) -> Option<Colour>,
) -> std::io::Result<String> {
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut head = Vec::new();
    head.extend_from_slice(&(width as u32).to_be_bytes());
    head.extend_from_slice(&(height as u32).to_be_bytes());
    // 8 bits, RGBA, the only compression and filter there are, not interlaced
    head.extend_from_slice(&[8, 6, 0, 0, 0]);
    chunk(b"IHDR", &head, &mut png);
    let mut deflated = ZlibEncoder::new(Vec::new(), Compression::best());
    for row in 0..height {
        let pixels = (0..width).flat_map(|column| match colour(column, row) {
            Some([r, g, b]) => [r, g, b, 255],
            None => [0; 4],
        });
        deflated.write_all(&std::iter::once(0).chain(pixels).collect::<Vec<u8>>())?;
    }
    chunk(b"IDAT", &deflated.finish()?, &mut png);
    chunk(b"IEND", &[], &mut png);
    Ok(format!("data:image/png;base64,{}", base64(&png)))
}

fn chunk(name: &[u8; 4], content: &[u8], png: &mut Vec<u8>) {
    let mut crc = Crc::new();
    crc.update(name);
    crc.update(content);
    png.extend_from_slice(&(content.len() as u32).to_be_bytes());
    png.extend_from_slice(name);
    png.extend_from_slice(content);
    png.extend_from_slice(&crc.sum().to_be_bytes());
}
