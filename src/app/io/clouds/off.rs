//! OFF: `[ST][C][N]OFF`, the counts of vertices, faces and edges, then a line a vertex: place, normal where the word has
//! an N, colour where it has a C. Then a line a face: the number of its corners, their vertices, a colour. They are
//! [facets](crate::io::facets).
//!
//! Geomview, "OFF Files".

use crate::io::columns::{Column, Columns, Need};
use crate::io::facets::{PolygonList, sampled_polygons};
use crate::io::place::{Place, Runs, Unit};
use crate::io::read_progress::tell_line;
use crate::io::{IoError, ReadOptions, Reading};

const WITH_NORMALS: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// Contacts from the bytes of an OFF file.
pub(in crate::io) fn read(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    let wrong = |what: String| IoError::Form { file: file.into(), form: "OFF", what };
    let text = std::str::from_utf8(bytes).map_err(|_| wrong("it is not text; OFF BINARY is not read".into()))?;
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(k, line)| (k + 1, line.split('#').next().unwrap_or_default().trim()))
        .filter(|(_, line)| !line.is_empty());
    let (_, first) = lines.next().ok_or_else(|| IoError::Empty { file: file.into() })?;
    let (word, counts) = first.split_once(char::is_whitespace).unwrap_or((first, ""));
    let kind = word.strip_suffix("OFF").ok_or_else(|| wrong("it does not begin with the word OFF".into()))?;
    if kind.contains(['4', 'n']) || counts.trim() == "BINARY" {
        return Err(wrong(format!("{first} is not read; text of three coordinates a vertex is")));
    }
    let counts = if counts.trim().is_empty() { lines.next().map_or("", |(_, line)| line) } else { counts };
    let count = counts.split_whitespace().next().and_then(|n| n.parse::<usize>().ok());
    let count =
        count.ok_or_else(|| wrong("the counts of vertices, faces and edges must follow the first word".into()))?;
    let fields = if kind.contains('N') { 6 } else { 3 };
    let mut columns = Columns::named(file, &WITH_NORMALS[..fields], Need::Contacts)?;
    let mut numbers = Runs::default();
    for (line, row) in lines.by_ref().take(count) {
        tell_line(text, row);
        let mut words = row.split_whitespace();
        for name in &WITH_NORMALS[..fields] {
            let Some((column, values)) = Column::of(name).and_then(|c| Some((c, columns.get_mut(c)?))) else {
                continue;
            };
            let word = words.next().unwrap_or_default();
            match word.parse() {
                Ok(value) => values.push(value),
                Err(_) if options.skip_invalid => values.push(f64::NAN),
                Err(_) => {
                    let (file, place, column) = (file.into(), Place::Line(line), column.name());
                    return Err(IoError::NotANumber {
                        file,
                        place,
                        column: column.into(),
                        ours: column,
                        text: word.into(),
                    });
                }
            }
        }
        numbers.push(line);
    }
    if numbers.len() < count {
        return Err(wrong(format!("it ends after {} of {count} vertices; it may be cut short", numbers.len())));
    }
    if let Some(contacts) = faces(lines.map(|(_, row)| row)).and_then(|faces| sampled_polygons(&columns, &faces)) {
        return contacts.into_reading(file, "OFF", options);
    }
    let mut reading = columns.into_reading(file, (numbers, Unit::Line), options)?;
    if fields == 3 {
        reading.notes.push("OFF without normals: its faces are too few or too rough to tell any".into());
    }
    Ok(reading)
}

/// The faces of the rows that follow the vertices; `None` where one of them is no face.
fn faces<'a>(rows: impl Iterator<Item = &'a str>) -> Option<PolygonList> {
    let mut faces = PolygonList::default();
    for row in rows {
        let mut numbers = row.split_whitespace().map(|word| word.parse::<usize>().ok());
        let corners = numbers.next()??;
        let face: Option<Vec<usize>> = numbers.take(corners).collect();
        faces.push(face.filter(|face| face.len() == corners)?);
    }
    Some(faces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Input;
    use palpate_geometry::contact::Orientation;

    fn read_text(text: &str) -> Result<Reading, String> {
        read("f", text.as_bytes(), &ReadOptions::default()).map_err(|e| e.to_string())
    }

    #[test]
    fn places_normals_and_colours() {
        for text in [
            "OFF\n2 1 0\n# a remark\n1 2 3\n4 5 6\n3 0 1 0\n",
            "COFF 2 0 0\n1 2 3 255 0 0 255\n4 5 6 0.5 0 0 1\n",
            "NOFF\n2 0 0\n1 2 3 0 0 1\n4 5 6 0 1 0\n",
            "CNOFF\n2 0 0\n1 2 3 0 0 1 9 9 9\n4 5 6 0 1 0 9 9 9\n",
        ] {
            let Input::Contacts(contacts) = read_text(text).unwrap().input else { panic!("a grid") };
            assert_eq!((contacts.x, contacts.z), (vec![1.0, 4.0], vec![3.0, 6.0]));
            assert_eq!(contacts.orientation == Orientation::None, !text.contains('N'));
        }
    }

    #[test]
    fn every_fault_is_named() {
        for (text, words) in [
            ("", "empty"),
            ("OF\n", "does not begin"),
            ("OFF\n", "counts"),
            ("OFF\n3 0 0\n1 2 3\n", "after 1 of 3"),
            ("OFF\n99999999999 0 0\n1 2 3\n", "after 1 of"),
            ("OFF\n1 0 0\n1 b 3\n", "line 3, column y"),
            ("4OFF\n1 0 0\n1 2 3 4\n", "4OFF is not read"),
        ] {
            let message = read_text(text).unwrap_err();
            assert!(message.contains(words), "{message}");
        }
    }
}
