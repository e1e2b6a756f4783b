//! Pixels as a PNG file.
//!
//! Of every channel 64 of the 256 steps are written. Nobody sees the difference, and a picture of smooth maps shrinks from
//! 166 kB to 101; filters would make it larger, because its areas of one colour are what deflates well. A picture that would
//! still be [`LARGE`], as four maps of a rough surface are, is written with 32 steps: 207 kB become 150.

use std::io::Write;

use crate::io::base64;
use png::{BitDepth, ColorType, DeflateCompression, Encoder, Filter};

/// Bytes of a file from which on a picture is written with fewer steps: papers and e-mails take 200 kB.
const LARGE: usize = 190_000;
/// The best that deflate does.
const BEST: DeflateCompression = DeflateCompression::Level(9);

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
        let fine = self.encoded(6)?;
        out.write_all(&if fine.len() > LARGE { self.encoded(5)? } else { fine })
    }

    /// As a `data:` address; of no pixels an empty one.
    pub(super) fn data_url(&self) -> String {
        let mut file = Vec::new();
        match self.write_png(&mut file) {
            Ok(()) => format!("data:image/png;base64,{}", base64(&file)),
            // memory takes every byte, so that the picture has none
            Err(_) => "data:,".into(),
        }
    }

    /// The file with so many bits of every channel.
    fn encoded(&self, bits: u32) -> std::io::Result<Vec<u8>> {
        let pixels: Vec<u8> = self.rgb.iter().map(|v| coarse(*v, bits)).collect();
        encoded([self.width, self.height], ColorType::Rgb, &pixels)
    }
}

/// Pixels of 8 bits a channel, row by row from the top, as the bytes of a PNG file.
///
/// # Errors
/// A side of no pixels, and what the system says.
pub(super) fn encoded([width, height]: [usize; 2], kind: ColorType, pixels: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(kind);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_filter(Filter::NoFilter);
    encoder.set_deflate_compression(BEST);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(file)
}

/// The nearest of 2^bits steps below, spread so that black stays black and white stays white.
fn coarse(value: u8, bits: u32) -> u8 {
    let low = 8 - bits;
    (value >> low << low) | (value >> bits)
}
