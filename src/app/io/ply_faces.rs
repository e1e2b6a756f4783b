//! The faces of a PLY file, where they follow the vertices: `property list ... vertex_indices` of the element `face`.
//!
//! ```text
//! ascii     count v_1 ... v_count, among the other properties in the header's order
//! binary    the same, by `ply-rs-bw`
//! ```
//!
//! Faces that cannot be read are none: the vertices alone are contacts, too.

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType};

use super::facets::PolygonList;
use super::read_progress::Counted;

/// What programs call the corners of a face.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// The corners of one face; none where they are no indices.
#[derive(Default)]
struct CornerList(Option<Vec<usize>>);

impl PropertyAccess for CornerList {
    fn new() -> CornerList {
        CornerList::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !CORNERS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        self.0 = match property {
            Property::ListChar(v) => indices(v),
            Property::ListUChar(v) => indices(v),
            Property::ListShort(v) => indices(v),
            Property::ListUShort(v) => indices(v),
            Property::ListInt(v) => indices(v),
            Property::ListUInt(v) => indices(v),
            _ => None,
        };
        PropertyAccessResult::Set
    }
}

fn indices<T: TryInto<usize>>(values: Vec<T>) -> Option<Vec<usize>> {
    values.into_iter().map(|v| v.try_into().ok()).collect()
}

/// The element of the faces, if it stands next after the vertices.
fn next_after_vertices(header: &Header) -> Option<&ElementDef> {
    let next = header.elements.iter().skip_while(|(name, _)| *name != "vertex").nth(1);
    next.filter(|(name, _)| *name == "face").map(|(_, element)| element)
}

/// The faces of a binary file that has been read up to its vertices.
pub(super) fn binary(reader: &mut Reader<Counted<'_>>, header: &Header) -> PolygonList {
    let mut found = PolygonList::default();
    let Some(element) = next_after_vertices(header) else { return found };
    let faces = Parser::<CornerList>::new().read_payload_for_element(reader, element, header);
    let polygons: Option<Vec<Vec<usize>>> = faces.unwrap_or_default().into_iter().map(|face| face.0).collect();
    polygons.into_iter().flatten().for_each(|polygon| found.push(polygon));
    found
}

/// The faces in the rows that follow the vertices.
pub(super) fn ascii<'a>(mut rows: impl Iterator<Item = &'a str>, header: &Header) -> PolygonList {
    let mut found = PolygonList::default();
    let Some(element) = next_after_vertices(header) else { return found };
    for _ in 0..element.count {
        match rows.next().and_then(|row| corners(row, element)) {
            Some(polygon) => found.push(polygon),
            None => return PolygonList::default(),
        }
    }
    found
}

fn corners(row: &str, element: &ElementDef) -> Option<Vec<usize>> {
    let mut words = row.split_whitespace();
    for (name, property) in &element.properties {
        let word = words.next()?;
        let PropertyType::List(..) = property.data_type else { continue };
        let count: usize = word.parse().ok()?;
        let mut list = words.by_ref().take(count);
        if CORNERS.contains(&name.as_str()) {
            let found: Option<Vec<usize>> = list.map(|word| word.parse().ok()).collect();
            return found.filter(|corners| corners.len() == count);
        }
        list.by_ref().for_each(drop);
    }
    None
}

#[cfg(test)]
mod tests {
    use crate::io::{ReadOptions, Reading, read_input_bytes};

    const PLACES: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const FACES: [[i32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    fn header(encoding: &str, face: &str) -> String {
        format!(
            "ply\nformat {encoding} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             element face 4\nproperty uchar red\nproperty list uchar int {face}\nend_header\n"
        )
    }

    fn binary(face: &str) -> Vec<u8> {
        let mut bytes = header("binary_little_endian", face).into_bytes();
        PLACES.into_iter().flatten().for_each(|v| bytes.extend(v.to_le_bytes()));
        for corners in FACES {
            bytes.extend([9, 3]);
            corners.into_iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        }
        bytes
    }

    fn ascii(face: &str) -> String {
        let places: String = PLACES.iter().map(|p| format!("{} {} {}\n", p[0], p[1], p[2])).collect();
        let faces: String = FACES.iter().map(|f| format!("9 3 {} {} {}\n", f[0], f[1], f[2])).collect();
        header("ascii", face) + &places + &faces
    }

    fn read(bytes: &[u8]) -> Reading {
        read_input_bytes("f.ply", bytes, &ReadOptions::default()).unwrap()
    }

    #[test]
    fn faces_are_found_in_both_encodings() {
        for face in ["vertex_indices", "vertex_index"] {
            let (a, b) = (read(&binary(face)), read(ascii(face).as_bytes()));
            assert_eq!(a.input, b.input);
            assert!(a.notes[0].contains("facets are sampled at 2000 places"), "{:?}", a.notes);
        }
    }

    #[test]
    fn what_is_no_face_leaves_the_vertices() {
        let unknown = binary("neighbours");
        let far = ascii("vertex_index").replace("9 3 1 2 3", "9 3 1 2 4");
        let negative = ascii("vertex_index").replace("9 3 1 2 3", "9 3 1 2 -3");
        let short = ascii("vertex_index").replace("9 3 1 2 3", "9 3 1 2");
        for bytes in [&unknown[..], far.as_bytes(), negative.as_bytes(), short.as_bytes()] {
            let reading = read(bytes);
            assert!(reading.notes.is_empty(), "{:?}", reading.notes);
        }
    }
}
