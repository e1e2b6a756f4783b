//! LZF, the packing of compressed PCD files: runs of literal bytes and copies of what was already written.
//!
//! ```text
//! 000LLLLL                     L + 1 literal bytes follow
//! LLLddddd dddddddd            copy L + 2 bytes from d + 1 back,  L = 1 .. 6
//! 111ddddd LLLLLLLL dddddddd   copy L + 9 bytes from d + 1 back
//! ```
//!
//! M. Lehmann, liblzf.

/// Most bytes that one byte of LZF can make: three make 264.
const MOST_RATIO: usize = 88;

/// Unpacks to exactly `size` bytes.
///
/// # Errors
/// In words, where the packed bytes do not make them.
pub(super) fn unpack(packed: &[u8], size: usize) -> Result<Vec<u8>, String> {
    if size > packed.len().saturating_mul(MOST_RATIO) {
        return Err(format!("its header promises {size} bytes, more than {} packed ones can make", packed.len()));
    }
    let broken = || "its packed data are broken".to_string();
    let mut out: Vec<u8> = Vec::with_capacity(size);
    let mut at = 0;
    let next = |at: &mut usize| {
        *at += 1;
        packed.get(*at - 1).map(|b| usize::from(*b)).ok_or_else(broken)
    };
    while at < packed.len() {
        let control = next(&mut at)?;
        if control < 32 {
            let literal = packed.get(at..at + control + 1).ok_or_else(broken)?;
            out.extend_from_slice(literal);
            at += control + 1;
        } else {
            let length = match control >> 5 {
                7 => next(&mut at)? + 9,
                short => short + 2,
            };
            let back = ((control & 31) << 8) + next(&mut at)? + 1;
            let start = out.len().checked_sub(back).ok_or_else(broken)?;
            // a copy may reach into what it writes
            for k in start..start + length {
                out.push(out[k]);
            }
        }
        if out.len() > size {
            return Err(broken());
        }
    }
    if out.len() == size {
        Ok(out)
    } else {
        Err(format!("it unpacks to {} bytes, its header promises {size}", out.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_copies_and_overlaps() {
        // "abc", then 5 bytes from 3 back, then 12 from 1 back
        let packed = [2, b'a', b'b', b'c', 3 << 5, 2, 7 << 5, 3, 0];
        assert_eq!(unpack(&packed, 20).unwrap(), b"abcabcabbbbbbbbbbbbb");
    }

    #[test]
    fn broken_bytes_are_refused() {
        let cases: [(&[u8], usize); 6] = [
            (&[5, 1], 6),
            (&[1 << 5, 9], 3),
            (&[7 << 5], 9),
            (&[0, 1], 2),
            (&[0, 1, 1 << 5, 0], 2),
            (&[0, 1], 1 << 40),
        ];
        for (packed, size) in cases {
            assert!(unpack(packed, size).is_err(), "{packed:?}");
        }
    }
}
