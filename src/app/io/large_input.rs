//! Whether an input is read whole or in pieces, by what it would take in memory.
//!
//! ```text
//! a file of B bytes takes 4 B        packed by gzip 16 B        of a pipe that is known only when so much has come
//! ```
//!
//! Numbers of text take as many bytes as the text, the copies that a fit sorts and weighs as many again. Text of numbers shrinks to a half or
//! a third, and may to a quarter. Only tables of text come in pieces: their rows stand one behind the other.

use std::io::Read;
use std::path::Path;

use super::format_detection::{Form, form_of};
use super::read_progress::fetch_up_to;
use super::table_pieces::TablePieces;
use super::{IoError, ReadOptions, Reading, ending, read_input_bytes, visible};

/// Bytes in memory for a byte of a table: 3.4 were measured of ten million contacts with a thousand features.
const BYTES_OF_BYTE: u64 = 4;
/// Bytes of a table for a byte that is packed.
const UNPACKED: u64 = 4;
/// So much tells the format.
const HEAD: usize = 1 << 16;
/// Least and largest piece.
const PIECE: [usize; 2] = [1 << 16, 1 << 25];
/// Pieces that the memory would hold.
const PIECES: u64 = 64;

/// An input, read or to be read.
pub(crate) enum OpenedInput {
    /// All of it.
    Whole(Box<Reading>),
    /// A table, a piece at a time.
    Pieces(Box<TablePieces>),
    /// No table, and it would take more; its name.
    TooLarge(String),
}

/// How pieces are to be read, and when.
#[derive(Clone, Debug)]
pub(crate) struct PieceRule {
    /// Bytes that the contacts may take.
    pub(crate) memory: u64,
    /// How pieces are read.
    pub(crate) options: ReadOptions,
    /// Whether what is no table is refused where it would take more.
    pub(crate) strict: bool,
}

/// What is read from: a file or a pipe.
struct OpenedFile {
    name: String,
    source: Box<dyn Read>,
    size: Option<usize>,
}

fn opened(path: &Path) -> Result<OpenedFile, IoError> {
    if path == Path::new("-") {
        let (name, source) = ("standard input".to_string(), Box::new(std::io::stdin().lock()));
        return Ok(OpenedFile { name, source, size: None });
    }
    let name = visible(&path.display().to_string());
    match std::fs::File::open(path).and_then(|file| Ok((file.metadata()?, file))) {
        Ok((about, file)) => {
            let size = about.is_file().then(|| usize::try_from(about.len()).ok()).flatten();
            Ok(OpenedFile { name, source: Box::new(file), size })
        }
        Err(source) => Err(IoError::Read { file: name, source }),
    }
}

/// Opens an input: read where it takes no more than the memory that the rule allows, in pieces where it is a table that takes more.
///
/// # Errors
/// Those of reading; of pieces the first is not looked at yet.
pub(crate) fn open_input(path: &Path, options: &ReadOptions, rule: &PieceRule) -> Result<OpenedInput, IoError> {
    let OpenedFile { name, mut source, size } = opened(path)?;
    let read_error = |source: std::io::Error| IoError::Read { file: name.clone(), source };
    let mut bytes = Vec::new();
    let mut ended = fetch_up_to(&mut source, size, HEAD, &mut bytes).map_err(read_error)?;
    let is_packed = bytes.starts_with(&[0x1f, 0x8b]);
    let most = rule.memory / (BYTES_OF_BYTE * if is_packed { UNPACKED } else { 1 });
    let most = usize::try_from(most).unwrap_or(usize::MAX);
    // what is known to be larger needs no more than its head to be known
    if !ended && size.is_none_or(|size| size <= most) {
        ended = fetch_up_to(&mut source, size, most, &mut bytes).map_err(read_error)?;
    }
    if ended && bytes.len() <= most {
        return read_input_bytes(&name, &bytes, options).map(|reading| OpenedInput::Whole(Box::new(reading)));
    }
    if form_of(&head_of(&bytes, is_packed), &ending(&name)) == Ok(Form::Table) {
        let piece = usize::try_from(rule.memory / PIECES).unwrap_or(usize::MAX).clamp(PIECE[0], PIECE[1]);
        let all = Box::new(std::io::Cursor::new(bytes).chain(source));
        let pieces = TablePieces::new(name, all, size, rule.options.clone(), piece, is_packed);
        return Ok(OpenedInput::Pieces(Box::new(pieces)));
    }
    if rule.strict {
        return Ok(OpenedInput::TooLarge(name));
    }
    fetch_up_to(&mut source, size, usize::MAX, &mut bytes).map_err(read_error)?;
    read_input_bytes(&name, &bytes, options).map(|reading| OpenedInput::Whole(Box::new(reading)))
}

/// The beginning of the content.
fn head_of(bytes: &[u8], is_packed: bool) -> Vec<u8> {
    if !is_packed {
        return bytes[..bytes.len().min(HEAD)].to_vec();
    }
    let mut head = Vec::new();
    // what is broken is said when it is read
    let _ = flate2::read::MultiGzDecoder::new(bytes).take(HEAD as u64).read_to_end(&mut head);
    head
}
