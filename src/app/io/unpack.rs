//! Compressed input: gzip, unpacked up to a limit.
//!
//! Deflate makes 1032 bytes of one at most (RFC 1951: 258 bytes from two bits), so that a file of three megabytes can ask
//! for three gigabytes. Measured data do not shrink to a hundredth: their last digits are noise. Whatever unpacks to more
//! than [`limit`] is refused while it is being read, not after.

use std::borrow::Cow;
use std::io::Read;

use flate2::read::MultiGzDecoder;

use super::IoError;
use super::read_progress::{Counted, ReadPhase};

/// Any small file may unpack to this much, whatever its ratio: a table of 60 MB is read in a second.
const ALWAYS: u64 = 64 << 20;
/// Ten times what the most regular tables of numbers shrink by, a tenth of what zeros do.
const MOST_RATIO: u64 = 100;

/// Bytes that `compressed` bytes may unpack to.
pub(super) fn limit(compressed: u64) -> u64 {
    ALWAYS.saturating_add(compressed.saturating_mul(MOST_RATIO))
}

/// The limit in words, for the message of whoever meets it.
pub(super) fn limit_words(compressed: u64) -> String {
    let unpacked = limit(compressed) >> 20;
    format!(
        "more than {unpacked} MB, a hundredfold and more, as measured data never do; unpack it and give the plain file"
    )
}

/// The content of a gzip file; other bytes as they are.
pub(super) fn unpacked<'a>(file: &str, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>, IoError> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(Cow::Borrowed(bytes));
    }
    let wrong = |what: String| IoError::Form { file: file.into(), form: "gzip file", what };
    let most = limit(bytes.len() as u64);
    let mut content = Vec::new();
    let outcome =
        MultiGzDecoder::new(Counted::new(bytes, ReadPhase::Unpacking)).take(most + 1).read_to_end(&mut content);
    outcome.map_err(|e| wrong(format!("it cannot be unpacked ({e}); it may be cut short")))?;
    if content.len() as u64 > most {
        return Err(wrong(format!("it unpacks to {}", limit_words(bytes.len() as u64))));
    }
    Ok(Cow::Owned(content))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn gzip(content: &[u8]) -> Vec<u8> {
        let mut out = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        out.write_all(content).unwrap();
        out.finish().unwrap()
    }

    #[test]
    fn gzip_is_unpacked_and_a_bomb_is_not() {
        assert_eq!(unpacked("f", &gzip(b"x,y,z\n")).unwrap().as_ref(), b"x,y,z\n");
        assert_eq!(unpacked("f", b"x,y,z\n").unwrap().as_ref(), b"x,y,z\n");
        let cut = gzip(b"x,y,z\n1,2,3\n");
        assert!(unpacked("f", &cut[..cut.len() - 9]).unwrap_err().to_string().contains("cut short"));
        let bomb = gzip(&vec![0; 200 << 20]);
        let refused = unpacked("f", &bomb).map(|content| content.len()).unwrap_err();
        assert!(refused.to_string().contains("hundredfold"));
    }
}
