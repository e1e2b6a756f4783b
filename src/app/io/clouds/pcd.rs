//! PCD, the Point Cloud Library's format: a header of words, then points as text, as binary rows, or as packed columns.
//!
//! ```text
//! FIELDS x y z normal_x ...   SIZE 4 4 4 4   TYPE F F F F   COUNT 1 1 1 1   WIDTH n   HEIGHT m
//! VIEWPOINT tx ty tz qw qx qy qz   POINTS n m   DATA ascii | binary | binary_compressed
//! ```
//!
//! A point whose x, y and z are all NaN is a pixel without a measurement: it is left out and counted. Packed columns follow
//! each other (all x, then all y, ...), under [`super::lzf`]. Point Cloud Library, "The PCD file format", 0.7.

use crate::io::columns::{Column, Columns, Need};
use crate::io::names::in_our_words;
use crate::io::place::{Place, Runs, Unit};
use crate::io::read_progress::tell_line;
use crate::io::{IoError, ReadOptions, Reading};

use super::lzf;

/// Longest header that is believed; that of a file with a hundred fields has 2 KB.
const MOST_HEADER: usize = 64 << 10;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Number {
    Float,
    Signed,
    Unsigned,
}

#[derive(Debug)]
struct Field {
    name: String,
    size: usize,
    number: Number,
    count: usize,
}

#[derive(Debug, Default)]
struct Header {
    fields: Vec<Field>,
    points: usize,
    viewpoint: Option<[f64; 3]>,
    data: String,
    lines: usize,
}

/// Contacts from the bytes of a PCD file.
pub(in crate::io) fn read(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    let wrong = |what: String| IoError::Form { file: file.into(), form: "PCD", what };
    let (header, body) = read_header(bytes).map_err(wrong)?;
    let theirs: Vec<&str> = header.fields.iter().map(|f| f.name.as_str()).collect();
    let ours = in_our_words(file, &theirs, options.columns.as_ref())?;
    let names: Vec<&str> = ours.iter().map(|name| name.as_ref()).filter(|name| !name.is_empty()).collect();
    let mut columns = Columns::named(file, &names, Need::Contacts)?;
    let wanted: Vec<Option<Column>> =
        ours.iter().map(|name| Column::of(name).filter(|column| columns.has(*column))).collect();
    one_number_each(&header, &wanted).map_err(wrong)?;
    let (numbers, unit) = match header.data.as_str() {
        "ascii" => (read_ascii(file, &header, body, &wanted, &mut columns, options)?, Unit::Line),
        "binary" => {
            read_binary(&header, body, &wanted, &mut columns).map_err(wrong)?;
            ((0..header.points).collect(), Unit::Point)
        }
        "binary_compressed" => {
            read_compressed(&header, body, &wanted, &mut columns).map_err(wrong)?;
            ((0..header.points).collect(), Unit::Point)
        }
        other => return Err(wrong(format!("its DATA is {other:?}; ascii, binary and binary_compressed are read"))),
    };
    let (numbers, missing) = leave_out_missing(&mut columns, numbers);
    let mut reading = columns.into_reading(file, (numbers, unit), options)?;
    reading.viewpoint = header.viewpoint;
    if missing > 0 {
        reading.notes.push(format!("{missing} points without a measurement (x, y, z all NaN) left out"));
    }
    Ok(reading)
}

/// Refuses a coordinate with more or fewer numbers than one a point: which of them would be the coordinate is not said.
fn one_number_each(header: &Header, wanted: &[Option<Column>]) -> Result<(), String> {
    match header.fields.iter().zip(wanted).find(|(field, column)| column.is_some() && field.count != 1) {
        Some((field, _)) => Err(format!("the COUNT of {} is {}; it must be 1", field.name, field.count)),
        None => Ok(()),
    }
}

/// The rows that hold a measurement, and the number of the others.
fn leave_out_missing(columns: &mut Columns, numbers: Runs) -> (Runs, usize) {
    let places = [Column::X, Column::Y, Column::Z];
    let is_there =
        |row: usize| places.iter().any(|c| columns.get(*c).is_none_or(|v| v.get(row).is_some_and(|v| !v.is_nan())));
    let kept: Vec<usize> = (0..numbers.len()).filter(|&row| is_there(row)).collect();
    let missing = numbers.len() - kept.len();
    if missing == 0 {
        return (numbers, 0);
    }
    columns.keep(&kept);
    (kept.iter().map(|&row| numbers.get(row)).collect(), missing)
}

fn read_header(bytes: &[u8]) -> Result<(Header, &[u8]), String> {
    let mut header = Header::default();
    let (mut sizes, mut types, mut counts) = (Vec::new(), Vec::new(), Vec::new());
    let (mut names, mut area) = (Vec::new(), [None, None]);
    let mut points = None;
    let mut rest = bytes;
    while header.data.is_empty() {
        let end = rest.iter().position(|b| *b == b'\n').ok_or("its header has no line DATA")?;
        if bytes.len() - rest.len() + end > MOST_HEADER {
            return Err("its header has no line DATA in its first 64 KB".into());
        }
        let line = std::str::from_utf8(&rest[..end]).map_err(|_| "its header is not text")?;
        rest = &rest[end + 1..];
        header.lines += 1;
        let words: Vec<&str> = line.split_whitespace().collect();
        let [key, values @ ..] = &words[..] else { continue };
        let whole = || -> Result<Vec<usize>, String> {
            values.iter().map(|v| v.parse().map_err(|_| format!("its {key} {v:?} is no count"))).collect()
        };
        match *key {
            "FIELDS" | "COLUMNS" => names = values.iter().map(ToString::to_string).collect(),
            "SIZE" => sizes = whole()?,
            "TYPE" => types = values.to_vec(),
            "COUNT" => counts = whole()?,
            "WIDTH" => area[0] = whole()?.first().copied(),
            "HEIGHT" => area[1] = whole()?.first().copied(),
            "POINTS" => points = whole()?.first().copied(),
            "VIEWPOINT" => header.viewpoint = viewpoint(values),
            "DATA" => header.data = values.first().ok_or("its line DATA is empty")?.to_string(),
            _ => {}
        }
    }
    header.fields = fields(names, &sizes, &types, &counts)?;
    let area = area[0].zip(area[1]).and_then(|(w, h)| w.checked_mul(h));
    header.points = points.or(area).ok_or("its header has no line POINTS")?;
    Ok((header, rest))
}

/// Where the scanner stood. Zeros are what every program writes that knows nothing of it.
fn viewpoint(values: &[&str]) -> Option<[f64; 3]> {
    let place: Option<Vec<f64>> = values.iter().take(3).map(|v| v.parse().ok()).collect();
    place.and_then(|p| <[f64; 3]>::try_from(p).ok()).filter(|p| p.iter().all(|v| v.is_finite()) && *p != [0.0; 3])
}

fn fields(names: Vec<String>, sizes: &[usize], types: &[&str], counts: &[usize]) -> Result<Vec<Field>, String> {
    if sizes.len() != names.len() || types.len() != names.len() || !(counts.is_empty() || counts.len() == names.len()) {
        return Err("its lines FIELDS, SIZE, TYPE and COUNT are not of one length".into());
    }
    let field = |(k, name): (usize, String)| {
        let number = match types[k] {
            "F" => Number::Float,
            "I" => Number::Signed,
            "U" => Number::Unsigned,
            other => return Err(format!("the TYPE of {name} is {other:?}; F, I and U are read")),
        };
        let size = sizes[k];
        if !matches!((number, size), (Number::Float, 4 | 8) | (Number::Signed | Number::Unsigned, 1 | 2 | 4 | 8)) {
            return Err(format!("the SIZE of {name} is {size}; F is 4 or 8 bytes, I and U 1, 2, 4 or 8"));
        }
        // a field of padding is called _ and may stand several times
        let name = if name == "_" { String::new() } else { name };
        Ok(Field { name, size, number, count: counts.get(k).copied().unwrap_or(1) })
    };
    names.into_iter().enumerate().map(field).collect()
}

impl Field {
    fn bytes(&self) -> Option<usize> {
        self.size.checked_mul(self.count)
    }

    /// The number in exactly `size` little-endian bytes.
    fn decode(&self, bytes: &[u8]) -> f64 {
        let mut wide = [0; 8];
        wide[..bytes.len()].copy_from_slice(bytes);
        let word = u64::from_le_bytes(wide);
        let unused = 64 - 8 * self.size as u32;
        match (self.number, self.size) {
            (Number::Float, 4) => f64::from(f32::from_bits(word as u32)),
            (Number::Float, _) => f64::from_bits(word),
            (Number::Signed, _) => ((word << unused) as i64 >> unused) as f64,
            (Number::Unsigned, _) => word as f64,
        }
    }
}

impl Header {
    fn row_bytes(&self) -> Option<usize> {
        self.fields.iter().try_fold(0_usize, |sum, field| sum.checked_add(field.bytes()?))
    }

    /// Bytes of all points, which `there` must hold.
    fn body_bytes(&self, there: usize) -> Result<(usize, usize), String> {
        let row = self.row_bytes().filter(|row| *row > 0).ok_or("its fields have no size")?;
        match row.checked_mul(self.points).filter(|all| *all <= there) {
            Some(all) => Ok((row, all)),
            None => Err(format!(
                "its header promises {} points of {row} bytes, but {there} bytes follow; it may be cut short",
                self.points
            )),
        }
    }
}

fn read_binary(header: &Header, body: &[u8], wanted: &[Option<Column>], columns: &mut Columns) -> Result<(), String> {
    let (row_bytes, all) = header.body_bytes(body.len())?;
    let mut start = 0;
    for (field, column) in header.fields.iter().zip(wanted) {
        if let Some(column) = *column {
            let value = |row: &[u8]| field.decode(&row[start..start + field.size]);
            columns.set(column, body[..all].chunks_exact(row_bytes).map(value).collect());
        }
        start += field.size * field.count;
    }
    Ok(())
}

fn read_compressed(
    header: &Header,
    body: &[u8],
    wanted: &[Option<Column>],
    columns: &mut Columns,
) -> Result<(), String> {
    let size = |at: usize| body.get(at..at + 4).and_then(|b| <[u8; 4]>::try_from(b).ok()).map(u32::from_le_bytes);
    let (Some(packed), Some(plain)) = (size(0), size(4)) else { return Err("it ends before its packed data".into()) };
    let packed = body.get(8..8 + packed as usize).ok_or_else(|| {
        format!("its header promises {packed} packed bytes, but {} follow; it may be cut short", body.len() - 8)
    })?;
    let (_, all) = header.body_bytes(plain as usize)?;
    let content = lzf::unpack(packed, plain as usize)?;
    let mut start = 0;
    for (field, column) in header.fields.iter().zip(wanted) {
        let bytes = field.size * field.count * header.points;
        if let Some(column) = *column {
            let values = content[..all][start..start + bytes].chunks_exact(field.size);
            columns.set(column, values.map(|value| field.decode(value)).collect());
        }
        start += bytes;
    }
    Ok(())
}

fn read_ascii(
    file: &str,
    header: &Header,
    body: &[u8],
    wanted: &[Option<Column>],
    columns: &mut Columns,
    options: &ReadOptions,
) -> Result<Runs, IoError> {
    let wrong = |what: String| IoError::Form { file: file.into(), form: "PCD", what };
    let text = std::str::from_utf8(body).map_err(|_| wrong("its ascii body is not text".into()))?;
    let mut numbers = Runs::default();
    let rows = text.lines().enumerate().map(|(k, row)| (header.lines + 1 + k, row.trim()));
    for (line, row) in rows.filter(|(_, row)| !row.is_empty()).take(header.points) {
        tell_line(text, row);
        let words: Vec<&str> = row.split_whitespace().collect();
        let mut at = 0_usize;
        for (field, column) in header.fields.iter().zip(wanted) {
            let word = words.get(at).copied();
            at = at.saturating_add(field.count);
            let Some(values) = column.and_then(|column| columns.get_mut(column)) else { continue };
            let value = word.and_then(|word| word.parse().ok());
            match value {
                Some(value) => values.push(value),
                None if options.skip_invalid => values.push(f64::NAN),
                None => {
                    let (place, text) = (Place::Line(line), word.unwrap_or_default().into());
                    let column = column.map_or("", Column::name);
                    return Err(IoError::NotANumber {
                        file: file.into(),
                        place,
                        column: column.into(),
                        ours: column,
                        text,
                    });
                }
            }
        }
        numbers.push(line);
    }
    if numbers.len() < header.points {
        return Err(wrong(format!("it ends after {} of {} points", numbers.len(), header.points)));
    }
    Ok(numbers)
}
