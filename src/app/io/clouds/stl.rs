//! STL: triangles, as text (`solid ... facet normal ... vertex x y z ... endsolid`) or binary (an 80-byte remark, a count,
//! 50 bytes a triangle). The facets' own normals are not read: they say no more than the order of the corners, and are
//! often zero. [`super::soup`] joins the corners and finds normals.

use crate::io::format_detection::is_binary_stl;
use crate::io::place::Unit;
use crate::io::{IoError, ReadOptions, Reading};

use super::soup::Soup;
use crate::io::read_progress::tell_line;

/// Bytes before the first triangle, and of each.
const START: usize = 84;
const TRIANGLE: usize = 50;

/// Contacts from the bytes of an STL file.
pub(in crate::io) fn read(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    let wrong = |what: String| IoError::Form { file: file.into(), form: "STL", what };
    // binary files may begin with the word, too
    let is_text = bytes.trim_ascii_start().starts_with(b"solid")
        && !is_binary_stl(bytes)
        && !bytes[..bytes.len().min(1024)].contains(&0);
    let mut soup = Soup::default();
    if is_text {
        read_text(file, bytes, &mut soup)?;
    } else {
        read_binary(bytes, &mut soup).map_err(wrong)?;
    }
    if let Some(contacts) = soup.sampled() {
        return contacts.into_reading(file, "STL", options);
    }
    let (columns, bare) = soup.into_columns(file)?;
    let rows = columns.len();
    let mut reading = columns.into_reading(file, ((0..rows).collect(), Unit::Vertex), options)?;
    reading.notes.push("STL: corners at one place are joined; normals are those of the triangles around each".into());
    if bare > 0 {
        reading.notes.push(format!("{bare} vertices whose triangles have no area left out"));
    }
    Ok(reading)
}

fn read_binary(bytes: &[u8], soup: &mut Soup) -> Result<(), String> {
    let Some(count) = bytes.get(80..START).and_then(|b| <[u8; 4]>::try_from(b).ok()).map(u32::from_le_bytes) else {
        return Err("it is shorter than its header of 84 bytes, and does not begin with the word solid".into());
    };
    let there = (bytes.len() - START) / TRIANGLE;
    if count as usize > there {
        return Err(format!("its header promises {count} triangles, but {there} follow; it may be cut short"));
    }
    for triangle in bytes[START..].chunks_exact(TRIANGLE).take(count as usize) {
        // the facet's normal comes first
        let number = |k: usize| {
            let at = 12 + 4 * k;
            let word = [triangle[at], triangle[at + 1], triangle[at + 2], triangle[at + 3]];
            f64::from(f32::from_le_bytes(word))
        };
        soup.add([0, 3, 6].map(|k| [number(k), number(k + 1), number(k + 2)]));
    }
    Ok(())
}

fn read_text(file: &str, bytes: &[u8], soup: &mut Soup) -> Result<(), IoError> {
    let wrong = |what: String| IoError::Form { file: file.into(), form: "STL", what };
    let text = std::str::from_utf8(bytes).map_err(|_| wrong("its text is not UTF-8".into()))?;
    let mut corners: Vec<[f64; 3]> = Vec::with_capacity(3);
    let mut ended = false;
    for (k, line) in text.lines().enumerate() {
        tell_line(text, line);
        let mut words = line.split_whitespace();
        match words.next() {
            Some("vertex") => {
                let place: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
                let place = place.and_then(|p| <[f64; 3]>::try_from(p).ok());
                corners.push(place.ok_or_else(|| wrong(format!("line {}: vertex needs three numbers", k + 1)))?);
            }
            Some("endfacet") => {
                let triangle = <[[f64; 3]; 3]>::try_from(std::mem::take(&mut corners));
                soup.add(triangle.map_err(|c| wrong(format!("line {}: a facet of {} corners", k + 1, c.len())))?);
            }
            Some("endsolid") => ended = true,
            _ => {}
        }
    }
    if ended { Ok(()) } else { Err(wrong("it ends before the word endsolid; it may be cut short".into())) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Input;
    use palpate_geometry::contact::{Contacts, Orientation};

    /// A roof of two triangles of different size that share the ridge from (0, 0, 1) to (0, 2, 1).
    const ROOF: [[[f32; 3]; 3]; 2] =
        [[[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 2.0, 1.0]], [[0.0, 2.0, 1.0], [-2.0, 0.0, 1.0], [-0.0, 0.0, 1.0]]];

    fn binary() -> Vec<u8> {
        let mut bytes = b"solid but binary all the same".to_vec();
        bytes.resize(80, 0);
        bytes.extend(2_u32.to_le_bytes());
        for triangle in ROOF {
            bytes.extend([0; 12]);
            bytes.extend(triangle.into_iter().flatten().flat_map(f32::to_le_bytes));
            bytes.extend([0; 2]);
        }
        bytes
    }

    fn text() -> String {
        let facet = |t: &[[f32; 3]; 3]| {
            let corners: String = t.iter().map(|v| format!("vertex {} {} {}\n", v[0], v[1], v[2])).collect();
            format!(" facet normal 0 0 0\n  outer loop\n{corners}  endloop\n endfacet\n")
        };
        format!("solid roof\n{}endsolid roof\n", ROOF.iter().map(facet).collect::<String>())
    }

    fn contacts(bytes: &[u8]) -> Contacts {
        match read("f", bytes, &ReadOptions::default()).unwrap().input {
            Input::Contacts(contacts) => contacts,
            Input::Grid(_) => panic!("a grid"),
        }
    }

    #[test]
    fn both_kinds_give_joined_vertices_with_normals_by_area() {
        let (a, b) = (contacts(&binary()), contacts(text().as_bytes()));
        assert_eq!(a, b);
        assert_eq!(a.len(), 4);
        let Orientation::Normals { nx, ny, nz } = a.orientation else { panic!("no normals") };
        // first (0, 0, 1): (2, 0, 2) of one triangle and (0, 0, 4) of the other
        assert_eq!([nx[0], ny[0], nz[0]], [2.0, 0.0, 6.0]);
        assert_eq!([nx[1], ny[1], nz[1]], [2.0, 0.0, 2.0]);
    }

    #[test]
    fn what_is_cut_short_says_so() {
        let whole = binary();
        for (bytes, words) in [
            (&whole[..whole.len() - 1], "promises 2 triangles, but 1"),
            (&whole[..40], "shorter than its header"),
            (&text().as_bytes()[..60], "endsolid"),
        ] {
            let message = read("f", bytes, &ReadOptions::default()).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
        assert!(read("f", b"solid\nendsolid\n", &ReadOptions::default()).unwrap_err().to_string().contains("no rows"));
    }
}
