//! One array of an NPZ. The `.npy` header is read here, so that the size it announces is checked before it is believed.
//!
//! ```text
//! \x93NUMPY  major minor  header length (u16 | u32, little endian)  {'descr': '<f4', 'fortran_order': False, 'shape': (616, 514), }  data
//! ```
//!
//! NumPy Enhancement Proposal 1 ("A Simple File Format for NumPy Arrays"), versions 1 to 3.

/// Memory layout of the numbers of one array.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    kind: Kind,
    size: usize,
    big_endian: bool,
    pub(super) fortran_order: bool,
    pub(super) shape: Vec<usize>,
    /// Bytes before the data.
    pub(super) data_start: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Float,
    Signed,
    Unsigned,
}

impl Header {
    /// Reads a header from the first bytes of a member.
    ///
    /// # Errors
    /// What is wrong and what would be right, in words.
    pub(super) fn parse(bytes: &[u8]) -> Result<Header, String> {
        let broken = || "its .npy header is broken; np.savez writes a good one".to_string();
        let (prefix, wide) = match bytes.get(..8) {
            Some([0x93, b'N', b'U', b'M', b'P', b'Y', 1, _]) => (10, false),
            Some([0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, _]) => (12, true),
            _ => return Err(broken()),
        };
        let length = match (bytes.get(8..prefix), wide) {
            (Some(&[a, b]), false) => usize::from(u16::from_le_bytes([a, b])),
            (Some(&[a, b, c, d]), true) => u32::from_le_bytes([a, b, c, d]) as usize,
            _ => return Err(broken()),
        };
        let data_start = prefix.saturating_add(length);
        let text = bytes.get(prefix..data_start).and_then(|t| std::str::from_utf8(t).ok()).ok_or_else(broken)?;
        let descr = value_of(text, "descr").ok_or_else(broken)?;
        let order = value_of(text, "fortran_order").ok_or_else(broken)?;
        let shape = value_of(text, "shape").and_then(parse_shape).ok_or_else(broken)?;
        let fortran_order = match order {
            o if o.starts_with("True") => true,
            o if o.starts_with("False") => false,
            _ => return Err(broken()),
        };
        let (kind, size, big_endian) = parse_descr(descr)?;
        Ok(Header { kind, size, big_endian, fortran_order, shape, data_start })
    }

    /// The header and all numbers of a file that is one array.
    ///
    /// # Errors
    /// What is wrong and what would be right, in words.
    pub(super) fn read_whole(bytes: &[u8]) -> Result<(Header, Vec<f64>), String> {
        let header = Header::parse(bytes)?;
        let there = bytes.len() - header.data_start;
        match header.data_bytes().filter(|promised| *promised <= there) {
            Some(promised) => {
                let values = header.decode(&bytes[header.data_start..header.data_start + promised]);
                Ok((header, values))
            }
            None => Err(format!(
                "its header promises {:?} numbers, but {there} bytes follow; it may be cut short",
                header.shape
            )),
        }
    }

    /// Bytes of data that the header promises; `None` where that is more than any memory.
    pub(super) fn data_bytes(&self) -> Option<usize> {
        self.shape.iter().try_fold(self.size, |bytes, n| bytes.checked_mul(*n))
    }

    /// All numbers in file order. `data` holds exactly [`Header::data_bytes`].
    pub(super) fn decode(&self, data: &[u8]) -> Vec<f64> {
        let read: fn([u8; 8]) -> f64 = match (self.kind, self.size) {
            (Kind::Float, 4) => |b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            (Kind::Float, _) => f64::from_le_bytes,
            (Kind::Signed, 1) => |b| f64::from(b[0] as i8),
            (Kind::Signed, 2) => |b| f64::from(i16::from_le_bytes([b[0], b[1]])),
            (Kind::Signed, 4) => |b| f64::from(i32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            (Kind::Signed, _) => |b| i64::from_le_bytes(b) as f64,
            (Kind::Unsigned, _) => |b| u64::from_le_bytes(b) as f64,
        };
        data.chunks_exact(self.size)
            .map(|chunk| {
                let mut little = [0; 8];
                little[..self.size].copy_from_slice(chunk);
                if self.big_endian {
                    little[..self.size].reverse();
                }
                read(little)
            })
            .collect()
    }
}

/// Magic, version, length and text of the header of a row-major array of float64, as NumPy writes it: padded with blanks
/// so that the data start at a multiple of 64 bytes.
pub(super) fn float64_header(shape: &[usize]) -> Vec<u8> {
    const ALIGNMENT: usize = 64;
    /// Magic, version and the u16 of the length.
    const BEFORE_TEXT: usize = 10;
    let sizes: String = match shape {
        [only] => format!("{only},"),
        _ => shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", "),
    };
    let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({sizes})}}");
    let length = (BEFORE_TEXT + text.len() + 1).next_multiple_of(ALIGNMENT) - BEFORE_TEXT;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.resize(BEFORE_TEXT + length - 1, b' ');
    bytes.push(b'\n');
    bytes
}

/// The text after `'key':`, blanks taken off.
fn value_of<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    [format!("'{key}'"), format!("\"{key}\"")].iter().find_map(|quoted| {
        let after = &text[text.find(quoted.as_str())? + quoted.len()..];
        Some(after.trim_start().strip_prefix(':')?.trim_start())
    })
}

fn parse_shape(text: &str) -> Option<Vec<usize>> {
    let inner = text.strip_prefix('(')?.split(')').next()?;
    inner.split(',').map(str::trim).filter(|n| !n.is_empty()).map(|n| n.parse().ok()).collect()
}

fn parse_descr(text: &str) -> Result<(Kind, usize, bool), String> {
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'));
    let name = quote.and_then(|q| text[1..].split(q).next()).unwrap_or("structured");
    let wrong = || format!("its type is {name:?}; use float64, float32 or integers");
    let mut letters = name.chars();
    let big_endian = match letters.next() {
        Some('<' | '|' | '=') => false,
        Some('>') => true,
        _ => return Err(wrong()),
    };
    match (letters.next(), letters.as_str()) {
        (Some('f'), "4") => Ok((Kind::Float, 4, big_endian)),
        (Some('f'), "8") => Ok((Kind::Float, 8, big_endian)),
        (Some(sign @ ('i' | 'u')), size @ ("1" | "2" | "4" | "8")) => {
            let kind = if sign == 'i' { Kind::Signed } else { Kind::Unsigned };
            Ok((kind, size.parse().map_err(|_| wrong())?, big_endian))
        }
        _ => Err(wrong()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(dict: &str) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((dict.len() as u16).to_le_bytes());
        bytes.extend(dict.as_bytes());
        bytes
    }

    #[test]
    fn numpys_own_header_is_read() {
        let bytes = header("{'descr': '>f4', 'fortran_order': True, 'shape': (616, 514), }     \n");
        let h = Header::parse(&bytes).unwrap();
        assert_eq!((h.kind, h.size, h.big_endian, h.fortran_order), (Kind::Float, 4, true, true));
        assert_eq!((h.shape.clone(), h.data_start, h.data_bytes()), (vec![616, 514], bytes.len(), Some(616 * 514 * 4)));
        assert_eq!(h.decode(&1.5_f32.to_be_bytes()), [1.5]);
    }

    #[test]
    fn a_written_header_is_aligned_and_read_back() {
        for shape in [vec![3], vec![616, 514], vec![0, 4], vec![usize::MAX; 3]] {
            let bytes = float64_header(&shape);
            let h = Header::parse(&bytes).unwrap();
            assert_eq!((h.kind, h.size, h.big_endian, h.fortran_order), (Kind::Float, 8, false, false));
            assert_eq!((&h.shape, h.data_start, bytes.len() % 64), (&shape, bytes.len(), 0));
        }
    }

    #[test]
    fn promises_beyond_memory_are_seen_and_not_kept() {
        let bytes = header("{'descr': '<f8', 'fortran_order': False, 'shape': (9999999999999, 9999999999), }\n");
        assert_eq!(Header::parse(&bytes).unwrap().data_bytes(), None);
    }

    #[test]
    fn other_types_say_what_would_do() {
        for descr in ["'|O'", "'<c16'", "'<f2'", "'<U5'", "[('a', '<f8')]"] {
            let bytes = header(&format!("{{'descr': {descr}, 'fortran_order': False, 'shape': (3,), }}\n"));
            assert!(Header::parse(&bytes).unwrap_err().contains("float64"), "{descr}");
        }
    }

    #[test]
    fn every_integer_reads_in_both_byte_orders() {
        let cases: [(&str, Vec<u8>, f64); 6] = [
            ("|i1", vec![0xff], -1.0),
            ("|u1", vec![0xff], 255.0),
            ("<i2", (-2_i16).to_le_bytes().to_vec(), -2.0),
            (">u2", 65535_u16.to_be_bytes().to_vec(), 65535.0),
            (">i4", (-70000_i32).to_be_bytes().to_vec(), -70000.0),
            ("<i8", (-5_i64).to_le_bytes().to_vec(), -5.0),
        ];
        for (descr, data, value) in cases {
            let bytes = header(&format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (1,), }}\n"));
            assert_eq!(Header::parse(&bytes).unwrap().decode(&data), [value], "{descr}");
        }
    }
}
