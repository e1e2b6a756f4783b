//! PNG with one channel of 8 or 16 bits: what depth cameras write, interlaced or not. Colours are refused: they are no depths.

use std::io::Cursor;

use png::{BitDepth, ColorType, DecodingError, Limits};

use crate::io::unpack::{limit, limit_words};

use super::DepthImage;

/// Deflate makes this many bytes of one at most (RFC 1951: 258 bytes from two bits).
const MOST_RATIO: usize = 1032;

/// The stored numbers of a PNG.
///
/// # Errors
/// What is wrong and what would be right, in words.
pub(in crate::io) fn read_png(bytes: &[u8]) -> Result<DepthImage, String> {
    let most = limit(bytes.len() as u64);
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: most as usize });
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info().map_err(in_words)?;
    let (width, height, bits) = (header.width, header.height, header.bit_depth);
    if header.color_type != ColorType::Grayscale || !matches!(bits, BitDepth::Eight | BitDepth::Sixteen) {
        return Err(format!(
            "it holds {} of {} bits; a depth image has one channel of 16 (or 8) bits",
            colours(header.color_type),
            bits as u8
        ));
    }
    let size = header.raw_bytes();
    if size as u64 > most {
        let words = limit_words(bytes.len() as u64);
        return Err(format!("it claims {width} x {height} pixels, which unpack to {words}"));
    }
    // no memory is asked for that the file cannot fill
    if size > MOST_RATIO.saturating_mul(bytes.len()) {
        return Err(format!("it claims {width} x {height} pixels, more than it can hold; it may be cut short"));
    }
    let mut reader = decoder.read_info().map_err(in_words)?;
    let mut data = vec![0; reader.output_buffer_size().unwrap_or(0)];
    reader.next_frame(&mut data).and_then(|_| reader.finish()).map_err(in_words)?;
    let stored = match bits {
        BitDepth::Eight => data.iter().map(|b| f64::from(*b)).collect(),
        _ => data.chunks_exact(2).map(|b| f64::from(u16::from_be_bytes([b[0], b[1]]))).collect(),
    };
    Ok(DepthImage { width: width as usize, stored })
}

fn colours(kind: ColorType) -> &'static str {
    match kind {
        ColorType::Grayscale => "grey",
        ColorType::Rgb => "colour",
        ColorType::Indexed => "a palette",
        ColorType::GrayscaleAlpha => "grey with transparency",
        ColorType::Rgba => "colour with transparency",
    }
}

fn in_words(error: DecodingError) -> String {
    match error {
        DecodingError::IoError(_) => "it ends within a chunk; it may be cut short".into(),
        DecodingError::Format(wrong) if wrong.to_string().starts_with("CRC") => {
            format!("the check sum of a chunk does not hold ({})", wrong.to_string().trim_end_matches('.'))
        }
        DecodingError::LimitsExceeded => "one of its chunks is larger than a depth image needs".into(),
        other => format!("{}; it may be cut short", other.to_string().trim_end_matches('.')),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
        let mut sum = flate2::Crc::new();
        sum.update(kind);
        sum.update(data);
        [&(data.len() as u32).to_be_bytes()[..], kind, data, &sum.sum().to_be_bytes()].concat()
    }

    /// A PNG of the given header and filtered rows.
    fn png(width: u32, height: u32, bits: u8, colour: u8, rows: &[u8]) -> Vec<u8> {
        let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[bits, colour, 0, 0, 0]].concat();
        let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
        zlib.write_all(rows).unwrap();
        let packed = zlib.finish().unwrap();
        let (a, b) = packed.split_at(packed.len() / 2);
        let parts = [chunk(b"IHDR", &header), chunk(b"IDAT", a), chunk(b"IDAT", b), chunk(b"IEND", b"")];
        [b"\x89PNG\r\n\x1a\n".to_vec(), parts.concat()].concat()
    }

    #[test]
    fn every_filter_is_undone() {
        // the same two pixels, 300 and 400, in every row
        let plain = [1, 44, 1, 144];
        let rows = [
            vec![0, 1, 44, 1, 144],
            vec![1, 1, 44, 0, 100],
            vec![2, 0, 0, 0, 0],
            vec![3, 1, 22, 1 - 1, 144 - 94],
            vec![4, 0, 0, 0, 0],
        ];
        assert_eq!(u16::from_be_bytes([plain[0], plain[1]]), 300);
        let image = read_png(&png(2, 5, 16, 0, &rows.concat())).unwrap();
        assert_eq!((image.width, image.stored.len()), (2, 10));
        assert_eq!(image.stored, [300.0, 400.0].repeat(5));
        assert_eq!(read_png(&png(2, 1, 8, 0, &[0, 7, 9])).unwrap().stored, [7.0, 9.0]);
    }

    #[test]
    fn interlaced_rows_stand_where_they_belong() {
        let mut bytes = png(2, 2, 8, 0, &[0, 1, 0, 2, 0, 3, 4]);
        // the header's last byte says so; its check sum follows
        bytes[28] = 1;
        let mut sum = flate2::Crc::new();
        sum.update(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&sum.sum().to_be_bytes());
        assert_eq!(read_png(&bytes).unwrap().stored, [1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn every_fault_is_named() {
        let good = png(2, 1, 16, 0, &[0, 1, 44, 1, 144]);
        let mut flipped = good.clone();
        flipped[20] ^= 1;
        let cases: [(&[u8], &str); 7] = [
            (&good[..good.len() - 20], "cut short"),
            (&good[..4], "cut short"),
            (&flipped, "check sum"),
            (&png(1, 1, 8, 2, &[0, 1, 2, 3]), "colour of 8 bits"),
            (&png(4_000_000, 4_000_000, 16, 0, &[]), "4000000 x 4000000"),
            (&png(5_000, 5_000, 16, 0, &[]), "5000 x 5000"),
            (&png(2, 2, 16, 0, &[0, 1, 44, 1, 144]), "enough data"),
        ];
        for (bytes, words) in cases {
            let message = read_png(bytes).unwrap_err();
            assert!(message.contains(words), "{message}");
        }
    }
}
