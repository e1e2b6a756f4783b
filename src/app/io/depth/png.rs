//! PNG with one channel of 8 or 16 bits: what depth cameras write. Colours and interlacing are refused.
//!
//! ```text
//! \x89PNG\r\n\x1a\n   { length (u32)  kind  data  CRC }*        IHDR: width, height, bits, colour kind, ...   IDAT: zlib
//! row of the unpacked data:  filter  bytes
//! ```
//!
//! W3C, "Portable Network Graphics (PNG) Specification (Third Edition)", 2025.

use std::io::Read;

use flate2::read::ZlibDecoder;

use crate::io::unpack::{limit, limit_words};

use super::DepthImage;

struct Header {
    width: usize,
    height: usize,
    /// Bytes of one pixel.
    bytes: usize,
}

/// The stored numbers of a PNG.
///
/// # Errors
/// What is wrong and what would be right, in words.
pub(in crate::io) fn read_png(bytes: &[u8]) -> Result<DepthImage, String> {
    let (header, packed) = chunks(bytes)?;
    let row = header.width * header.bytes;
    let size = (row + 1).saturating_mul(header.height);
    if size as u64 > limit(bytes.len() as u64) {
        let (width, height) = (header.width, header.height);
        return Err(format!(
            "it claims {width} x {height} pixels, which unpack to {}",
            limit_words(bytes.len() as u64)
        ));
    }
    let mut data = Vec::new();
    let cut = |_| "its pixels cannot be unpacked; it may be cut short".to_string();
    ZlibDecoder::new(&packed[..]).take(size as u64).read_to_end(&mut data).map_err(cut)?;
    if data.len() < size {
        return Err(format!("it holds {} of {size} bytes of pixels; it may be cut short", data.len()));
    }
    let mut before = vec![0; row];
    let mut stored = Vec::with_capacity(header.width * header.height);
    for line in data.chunks_exact_mut(row + 1) {
        let (filter, line) = (line[0], &mut line[1..]);
        undo(filter, line, &before, header.bytes)?;
        match header.bytes {
            1 => stored.extend(line.iter().map(|b| f64::from(*b))),
            _ => stored.extend(line.chunks_exact(2).map(|b| f64::from(u16::from_be_bytes([b[0], b[1]])))),
        }
        before.copy_from_slice(line);
    }
    Ok(DepthImage { width: header.width, stored })
}

/// The header, and the packed pixels of all IDAT chunks.
fn chunks(bytes: &[u8]) -> Result<(Header, Vec<u8>), String> {
    let cut = || "it ends within a chunk; it may be cut short".to_string();
    let mut rest = bytes.get(8..).ok_or_else(cut)?;
    let (mut header, mut packed) = (None, Vec::new());
    loop {
        let length = rest.first_chunk::<4>().map(|b| u32::from_be_bytes(*b) as usize).ok_or_else(cut)?;
        let kind = rest.get(4..8).ok_or_else(cut)?;
        let end = length.checked_add(12).ok_or_else(cut)?;
        let chunk = rest.get(..end).ok_or_else(cut)?;
        let data = &chunk[8..8 + length];
        let mut sum = flate2::Crc::new();
        sum.update(&chunk[4..8 + length]);
        if chunk[8 + length..] != sum.sum().to_be_bytes() {
            return Err(format!("the check sum of its chunk {} does not hold", kind.escape_ascii()));
        }
        match kind {
            b"IHDR" => header = Some(read_header(data)?),
            b"IDAT" => packed.extend_from_slice(data),
            b"IEND" => break,
            _ => {}
        }
        rest = &rest[end..];
    }
    Ok((header.ok_or("it has no header")?, packed))
}

fn read_header(data: &[u8]) -> Result<Header, String> {
    let &[w0, w1, w2, w3, h0, h1, h2, h3, bits, kind, _, _, interlaced] = data else {
        return Err("its header is broken".into());
    };
    let [width, height] = [[w0, w1, w2, w3], [h0, h1, h2, h3]].map(|b| u32::from_be_bytes(b) as usize);
    if kind != 0 || !matches!(bits, 8 | 16) || interlaced != 0 {
        let colours = ["grey", "", "colour", "a palette", "grey with transparency", "", "colour with transparency"];
        let kind = colours.get(usize::from(kind)).copied().unwrap_or_default();
        let woven = if interlaced == 0 { "" } else { ", interlaced" };
        return Err(format!(
            "it holds {kind} of {bits} bits{woven}; a depth image has one channel of 16 (or 8) bits, not interlaced"
        ));
    }
    if width == 0 || height == 0 {
        return Err(format!("it claims {width} x {height} pixels"));
    }
    Ok(Header { width, height, bytes: usize::from(bits / 8) })
}

/// Undoes the filter of one row; `before` is the row above it, `step` the bytes of a pixel.
fn undo(filter: u8, line: &mut [u8], before: &[u8], step: usize) -> Result<(), String> {
    for k in 0..line.len() {
        let left = if k >= step { line[k - step] } else { 0 };
        let corner = if k >= step { before[k - step] } else { 0 };
        let predicted = match filter {
            0 => 0,
            1 => left,
            2 => before[k],
            3 => ((u16::from(left) + u16::from(before[k])) / 2) as u8,
            4 => nearest(left, before[k], corner),
            _ => return Err(format!("its rows have a filter {filter}, which PNG does not know")),
        };
        line[k] = line[k].wrapping_add(predicted);
    }
    Ok(())
}

/// Paeth's predictor: whichever of the three is nearest to `left + up - corner`.
fn nearest(left: u8, up: u8, corner: u8) -> u8 {
    let [a, b, c] = [left, up, corner].map(i16::from);
    let [da, db, dc] = [(b - c).abs(), (a - c).abs(), (a + b - 2 * c).abs()];
    if da <= db && da <= dc {
        left
    } else if db <= dc {
        up
    } else {
        corner
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
    fn every_fault_is_named() {
        let good = png(2, 1, 16, 0, &[0, 1, 44, 1, 144]);
        let mut flipped = good.clone();
        flipped[20] ^= 1;
        let cases: [(&[u8], &str); 6] = [
            (&good[..good.len() - 20], "cut short"),
            (&good[..4], "cut short"),
            (&flipped, "check sum"),
            (&png(1, 1, 8, 2, &[0, 1, 2, 3]), "colour of 8 bits"),
            (&png(4_000_000, 4_000_000, 16, 0, &[]), "4000000 x 4000000"),
            (&png(2, 2, 16, 0, &[0, 1, 44, 1, 144]), "5 of 10 bytes"),
        ];
        for (bytes, words) in cases {
            let message = read_png(bytes).unwrap_err();
            assert!(message.contains(words), "{message}");
        }
    }
}
