//! PLY: the `vertex` element with `x y z` and, if present, `nx ny nz` and the other known names, ascii or binary.
//!
//! `ply-rs-bw` reads the header and binary payloads. Ascii rows are read here: its grammar knows neither `nan` nor
//! `.5`, and a message should name the line. Faces behind the vertices are [facets](super::facets).

use std::io::Write;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    Addable, DefaultElement, ElementDef, Encoding, Header, Ply, Property, PropertyAccess, PropertyAccessResult,
    PropertyDef, PropertyType, ScalarType,
};
use ply_rs_bw::writer::Writer;

use palpate_geometry::contact::Contacts;

use super::columns::{COLUMNS, Column, Columns, Need, columns_of};
use super::facets::{PolygonList, sampled_polygons};
use super::names::{ColumnNames, in_our_words};
use super::place::{Place, Runs, Unit};
use super::ply_faces;
use super::read_progress::{Counted, ReadPhase, tell_line};
use super::{IoError, ReadOptions, Reading};

/// The known columns of one vertex, NaN where the file has none.
struct Vertex([f64; COLUMNS.len()]);

impl Vertex {
    fn set(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        match Column::of(name) {
            Some(column) => {
                self.0[column as usize] = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::Ignored,
        }
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Vertex {
        Vertex([f64::NAN; COLUMNS.len()])
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let value = match property {
            Property::Char(v) => f64::from(v),
            Property::UChar(v) => f64::from(v),
            Property::Short(v) => f64::from(v),
            Property::UShort(v) => f64::from(v),
            Property::Int(v) => f64::from(v),
            Property::UInt(v) => f64::from(v),
            Property::Float(v) => f64::from(v),
            Property::Double(v) => v,
            _ => return PropertyAccessResult::Ignored,
        };
        self.set(name, value)
    }
}

/// Contacts from the bytes of a PLY file.
pub(super) fn read(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    let wrong = |what: String| IoError::Ply { file: file.into(), what };
    check_header_size(bytes).map_err(wrong)?;
    let mut reader = Reader::new(Counted::new(bytes, ReadPhase::Parsing));
    let parser = Parser::<Vertex>::new();
    let mut header = parser.read_header(&mut reader).map_err(|e| wrong(super::remark::one_line(&e.to_string())))?;
    let header_lines = reader.line();
    let payload = reader.get_ref().rest();
    check_header(&bytes[..bytes.len() - payload.len()], &header, payload.len() as u64).map_err(wrong)?;
    let vertex = header.elements.get_mut("vertex").ok_or_else(|| wrong("there is no element vertex".into()))?;
    rename_properties(file, vertex, options.columns.as_ref())?;
    let count = vertex.count;
    let names: Vec<&str> = vertex.properties.keys().map(String::as_str).collect();
    let columns = Columns::named(file, &names, Need::Contacts)?;
    let (columns, faces, numbers, unit) = match header.encoding {
        Encoding::Ascii => {
            let first_line = header_lines.max(1);
            let (columns, faces, lines) = read_ascii(file, payload, first_line, &header, columns, options)?;
            (columns, faces, lines, Unit::Line)
        }
        _ => {
            let (columns, faces) = read_binary(&mut reader, &parser, &header, columns).map_err(wrong)?;
            (columns, faces, (0..count).collect::<Runs>(), Unit::Vertex)
        }
    };
    match sampled_polygons(&columns, &faces) {
        Some(contacts) => contacts.into_reading(file, "PLY", options),
        None => columns.into_reading(file, (numbers, unit), options),
    }
}

/// The parser takes seconds over tens of thousands of elements: such headers are refused by their length.
fn check_header_size(bytes: &[u8]) -> Result<(), String> {
    /// Longest header that is believed; that of a mesh with colours and normals has 1 KB.
    const MOST_BYTES: usize = 64 << 10;
    /// Most lines of it, comments included.
    const MOST_LINES: usize = 1000;
    let head = &bytes[..bytes.len().min(MOST_BYTES)];
    let end = head.windows(10).position(|word| word == b"end_header");
    if end.is_none() && bytes.len() > MOST_BYTES {
        return Err(format!("its header does not end within {MOST_BYTES} bytes"));
    }
    let lines = head[..end.unwrap_or(head.len())].iter().filter(|b| **b == b'\n').count();
    if lines > MOST_LINES { Err(format!("its header has more than {MOST_LINES} lines")) } else { Ok(()) }
}

/// Gives the vertices' properties our names, where other programs have names of their own for them.
fn rename_properties(file: &str, vertex: &mut ElementDef, said: Option<&ColumnNames>) -> Result<(), IoError> {
    let theirs: Vec<&str> = vertex.properties.keys().map(String::as_str).collect();
    let ours = in_our_words(file, &theirs, said)?;
    let mut renamed = ElementDef::new(vertex.name.clone());
    renamed.count = vertex.count;
    for (name, property) in ours.iter().zip(vertex.properties.values()) {
        renamed.properties.add(PropertyDef::new(name.to_string(), property.data_type.clone()));
    }
    *vertex = renamed;
    Ok(())
}

/// What the parser would swallow: names standing twice, and counts that the file is too short for.
fn check_header(text: &[u8], header: &Header, payload: u64) -> Result<(), String> {
    let text = String::from_utf8_lossy(text);
    let mut seen: Vec<&str> = Vec::new();
    let mut elements: Vec<&str> = Vec::new();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        let (names, name) = match (words.next(), words.next()) {
            (Some("element"), Some(name)) => {
                seen.clear();
                (&mut elements, name)
            }
            (Some("property"), _) => (&mut seen, line.split_whitespace().next_back().unwrap_or_default()),
            _ => continue,
        };
        if names.contains(&name) {
            return Err(format!("its header names {name} twice"));
        }
        names.push(name);
    }
    for element in header.elements.values() {
        let least = element.properties.values().map(|p| least_bytes(&p.data_type, header.encoding)).sum::<u64>();
        let promised = (element.count as u64).saturating_mul(least.max(1));
        // the last line of an ascii file may lack its newline
        if promised > payload + 1 {
            let (count, name) = (element.count, &element.name);
            return Err(format!(
                "its header promises {count} of element {name}, more than its {payload} bytes can hold"
            ));
        }
    }
    Ok(())
}

/// Fewest bytes that one property takes; in ascii a digit and a blank.
fn least_bytes(data_type: &PropertyType, encoding: Encoding) -> u64 {
    let scalar = |s: &ScalarType| match s {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    match (encoding, data_type) {
        (Encoding::Ascii, _) => 2,
        (_, PropertyType::Scalar(s)) => scalar(s),
        (_, PropertyType::List(count, _)) => scalar(count),
    }
}

fn read_binary(
    reader: &mut Reader<Counted<'_>>,
    parser: &Parser<Vertex>,
    header: &Header,
    mut columns: Columns,
) -> Result<(Columns, PolygonList), String> {
    for (name, element) in &header.elements {
        let rows = parser
            .read_payload_for_element(reader, element, header)
            .map_err(|e| super::remark::one_line(&e.to_string()))?;
        if name == "vertex" {
            for column in COLUMNS {
                if let Some(values) = columns.get_mut(column) {
                    *values = rows.iter().map(|row| row.0[column as usize]).collect();
                }
            }
            let faces = ply_faces::binary(reader, header);
            return Ok((columns, faces));
        }
    }
    Ok((columns, PolygonList::default()))
}

fn read_ascii(
    file: &str,
    payload: &[u8],
    first_line: usize,
    header: &Header,
    mut columns: Columns,
    options: &ReadOptions,
) -> Result<(Columns, PolygonList, Runs), IoError> {
    let wrong = |what: String| IoError::Ply { file: file.into(), what };
    let whole = std::str::from_utf8(payload).map_err(|_| wrong("its ascii body is not text".into()))?;
    let mut lines = whole.lines().enumerate().map(|(k, l)| (first_line + k, l.trim())).filter(|(_, l)| !l.is_empty());
    let mut numbers = Runs::default();
    for element in header.elements.values() {
        let is_vertex = element.name == "vertex";
        for row in 0..element.count {
            let (line, text) = lines.next().ok_or_else(|| {
                wrong(format!("it ends after {row} of {} rows of element {}", element.count, element.name))
            })?;
            tell_line(whole, text);
            if is_vertex {
                read_ascii_vertex(file, line, text, element, &mut columns, options)?;
                numbers.push(line);
            }
        }
        if is_vertex {
            break;
        }
    }
    let faces = ply_faces::ascii(lines.map(|(_, text)| text), header);
    Ok((columns, faces, numbers))
}

fn read_ascii_vertex(
    file: &str,
    line: usize,
    text: &str,
    vertex: &ElementDef,
    columns: &mut Columns,
    options: &ReadOptions,
) -> Result<(), IoError> {
    let mut words = text.split_whitespace();
    let expected = vertex.properties.len();
    for (k, (name, property)) in vertex.properties.iter().enumerate() {
        let word = words.next();
        if word.is_none() && !options.skip_invalid {
            return Err(IoError::FieldCount { file: file.into(), line, found: k, expected });
        }
        if let PropertyType::List(..) = property.data_type {
            let entries = word.and_then(|w| w.parse::<usize>().ok()).unwrap_or(0);
            words.by_ref().take(entries).for_each(drop);
            continue;
        }
        let Some(values) = Column::of(name).and_then(|column| columns.get_mut(column)) else { continue };
        let value = word.unwrap_or_default().parse().or_else(|_| {
            if options.skip_invalid {
                return Ok(f64::NAN);
            }
            let column = Column::of(name).map_or("", Column::name);
            let text = word.unwrap_or_default().into();
            Err(IoError::NotANumber {
                file: file.into(),
                place: Place::Line(line),
                column: column.into(),
                ours: column,
                text,
            })
        })?;
        values.push(value);
    }
    Ok(())
}

/// Writes contacts as binary little-endian PLY, `double` throughout.
pub(super) fn write(contacts: &Contacts, remark: Option<&str>, out: &mut dyn Write) -> std::io::Result<()> {
    let columns = columns_of(contacts);
    let mut vertex = ElementDef::new("vertex".into());
    vertex.count = contacts.len();
    for (column, _) in &columns {
        vertex.properties.add(PropertyDef::new(column.name().into(), PropertyType::Scalar(ScalarType::Double)));
    }
    let mut ply = Ply::<DefaultElement>::new();
    ply.header.encoding = Encoding::BinaryLittleEndian;
    ply.header.comments.push("contacts of palpate".into());
    ply.header.comments.extend(remark.map(super::remark::one_line));
    ply.header.elements.add(vertex);
    let mut bytes = Vec::new();
    Writer::<DefaultElement>::new().write_header(&mut bytes, &ply.header)?;
    for row in 0..contacts.len() {
        columns.iter().for_each(|(_, values)| bytes.extend(values[row].to_le_bytes()));
    }
    out.write_all(&bytes)
}
