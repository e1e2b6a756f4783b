//! OBJ: `v x y z`, `vn x y z`, and faces `f v/vt/vn ...`, which are [facets](crate::io::facets), and say which normal belongs to which
//! vertex.
//!
//! A vertex that several normals belong to gets their mean direction. Without faces the k-th normal belongs to the k-th
//! vertex, where there are as many of both. Wavefront Technologies, "Object Files (.obj)".

use crate::io::columns::{Column, Columns, Need};
use crate::io::facets::{PolygonList, sampled};
use crate::io::place::{Runs, Unit};
use crate::io::read_progress::tell_line;
use crate::io::{IoError, ReadOptions, Reading};

#[derive(Default)]
struct Model {
    places: Vec<[f64; 3]>,
    /// Line of each vertex.
    lines: Vec<usize>,
    normals: Vec<[f64; 3]>,
    /// (vertex, normal) of every corner that names both.
    pairs: Vec<(usize, usize)>,
    faces: usize,
    polygons: PolygonList,
}

/// Contacts from the bytes of an OBJ file.
pub(in crate::io) fn read(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    let wrong = |what: String| IoError::Form { file: file.into(), form: "OBJ", what };
    let text = std::str::from_utf8(bytes).map_err(|_| wrong("it is not text".into()))?;
    let model = parse(text).map_err(wrong)?;
    if model.places.is_empty() {
        return Err(wrong("it has no line v x y z".into()));
    }
    let normals = model.vertex_normals();
    let triangles = model.polygons.triangles(&model.places);
    if let Some(contacts) = sampled(&model.places, &triangles, normals.as_deref()) {
        return contacts.into_reading(file, "OBJ", options);
    }
    let names = ["x", "y", "z", "nx", "ny", "nz"];
    let fields = if normals.is_some() { 6 } else { 3 };
    let mut columns = Columns::named(file, &names[..fields], Need::Contacts)?;
    let has_normal = |v: &usize| normals.as_ref().is_none_or(|n| n[*v].iter().any(|c| *c != 0.0));
    let kept: Vec<usize> = (0..model.places.len()).filter(has_normal).collect();
    for (k, column) in [Column::X, Column::Y, Column::Z].into_iter().enumerate() {
        columns.set(column, kept.iter().map(|&v| model.places[v][k]).collect());
    }
    if let Some(normals) = &normals {
        for (k, column) in [Column::Nx, Column::Ny, Column::Nz].into_iter().enumerate() {
            columns.set(column, kept.iter().map(|&v| normals[v][k]).collect());
        }
    }
    let lines: Runs = kept.iter().map(|&v| model.lines[v]).collect();
    let mut reading = columns.into_reading(file, (lines, Unit::Line), options)?;
    match model.places.len() - kept.len() {
        0 if normals.is_none() && model.faces > 0 => {
            reading.notes.push("OBJ without vertex normals: its faces are too few or too rough to tell any".into());
        }
        0 => {}
        bare => reading.notes.push(format!("{bare} vertices that no normal belongs to left out")),
    }
    Ok(reading)
}

fn parse(text: &str) -> Result<Model, String> {
    let mut model = Model::default();
    let mut begun = String::new();
    for (k, line) in text.lines().enumerate() {
        tell_line(text, line);
        match line.trim_end().strip_suffix('\\') {
            // a backslash at the end of a line lets it go on in the next one
            Some(start) if !line.starts_with('#') => {
                begun.push_str(start);
                begun.push(' ');
            }
            _ if begun.is_empty() => model.add(line, k + 1)?,
            _ => {
                begun.push_str(line);
                model.add(&std::mem::take(&mut begun), k + 1)?;
            }
        }
    }
    model.add(&begun, text.lines().count())?;
    Ok(model)
}

/// The index from 0 that `text` names among `count`: from 1, or backwards from -1.
fn index(text: &str, count: usize) -> Option<usize> {
    let number: i64 = text.parse().ok()?;
    let index = if number < 0 { i64::try_from(count).ok()?.checked_add(number)? } else { number - 1 };
    usize::try_from(index).ok().filter(|index| *index < count)
}

impl Model {
    /// Adds what a statement that ends in this line says.
    fn add(&mut self, statement: &str, line: usize) -> Result<(), String> {
        let mut words = statement.split_whitespace();
        let key = words.next();
        let mut three = || -> Result<[f64; 3], String> {
            let numbers: Option<Vec<f64>> = words.by_ref().take(3).map(|word| word.parse().ok()).collect();
            let numbers = numbers.and_then(|n| <[f64; 3]>::try_from(n).ok());
            numbers.ok_or_else(|| format!("line {line}: {} needs three numbers", key.unwrap_or_default()))
        };
        match key {
            Some("v") => {
                self.places.push(three()?);
                self.lines.push(line);
            }
            Some("vn") => self.normals.push(three()?),
            Some("f") => {
                self.faces += 1;
                let mut polygon = Vec::with_capacity(4);
                for corner in words {
                    let vertex = self.corner(corner);
                    polygon.push(vertex.ok_or_else(|| format!("line {line}: there is no corner {corner:?}"))?);
                }
                self.polygons.push(polygon);
            }
            _ => {}
        }
        Ok(())
    }

    /// The vertex of `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&mut self, corner: &str) -> Option<usize> {
        let mut parts = corner.split('/');
        let vertex = index(parts.next()?, self.places.len())?;
        if let Some(normal) = parts.nth(1).filter(|text| !text.is_empty()) {
            let normal = index(normal, self.normals.len())?;
            self.pairs.push((vertex, normal));
        }
        Some(vertex)
    }

    /// The normal of every vertex, zero where none belongs to it; `None` where the file pairs none.
    fn vertex_normals(&self) -> Option<Vec<[f64; 3]>> {
        if self.pairs.is_empty() {
            let one_each = self.faces == 0 && self.normals.len() == self.places.len();
            return one_each.then(|| self.normals.clone());
        }
        let mut sums = vec![[0.0; 3]; self.places.len()];
        let mut pairs = self.pairs.clone();
        // a normal that many faces name counts once
        pairs.sort_unstable();
        pairs.dedup();
        for (vertex, normal) in pairs {
            let normal = self.normals[normal];
            let length = normal.iter().map(|v| v * v).sum::<f64>().sqrt();
            if length > 0.0 {
                sums[vertex] = [0, 1, 2].map(|k| sums[vertex][k] + normal[k] / length);
            }
        }
        Some(sums)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Input;
    use palpate_geometry::contact::{Contacts, Orientation};

    fn read_text(text: &str) -> Result<Reading, String> {
        read("f", text.as_bytes(), &ReadOptions::default()).map_err(|e| e.to_string())
    }

    fn contacts(text: &str) -> Contacts {
        match read_text(text).unwrap().input {
            Input::Contacts(contacts) => contacts,
            Input::Grid(_) => panic!("a grid"),
        }
    }

    #[test]
    fn faces_pair_vertices_with_normals() {
        let text = "# made elsewhere\nv 1 2 3 0.5 0.5 0.5\nv 4 5 6\nv 7 8 9\nv 0 0 0\nvt 0 0\nvn 0 0 2\nvn 0 1 0\n\
                    f 1//1 2/1/2 -2//-1\nf 1//1 2//1 3//2\n";
        let reading = read_text(text).unwrap();
        assert!(reading.notes[0].contains("1 vertices"), "{:?}", reading.notes);
        let contacts = contacts(text);
        assert_eq!((contacts.len(), contacts.x.clone()), (3, vec![1.0, 4.0, 7.0]));
        let normals = Orientation::Normals { nx: vec![0.0; 3], ny: vec![0.0, 1.0, 1.0], nz: vec![1.0, 1.0, 0.0] };
        assert_eq!(contacts.orientation, normals);
    }

    #[test]
    fn without_faces_normals_go_by_their_order() {
        let pair = contacts("v 1 2 3\nvn 0 0 1\nv 4 5 6\nvn 0 1 0\n");
        assert_eq!(pair.orientation, Orientation::Normals { nx: vec![0.0; 2], ny: vec![0.0, 1.0], nz: vec![1.0, 0.0] });
        assert_eq!(contacts("v 1 2 3\nv 1 2 3\nv 2 2 2\nf 1 2 3\n").orientation, Orientation::None);
    }

    #[test]
    fn a_face_goes_on_in_the_next_line_after_a_backslash() {
        let whole = contacts("v 1 2 3\nv 4 5 6\nv 7 8 9\nvn 0 0 1\nf 1//1 2//1 3//1\n");
        let cut = contacts("# not \\\nv 1 2 3\nv 4 5 6\nv 7 8 \\\n9\nvn 0 0 1\nf 1//1 2//1 \\\n3//1\n");
        assert_eq!(whole, cut);
    }

    #[test]
    fn every_fault_is_named() {
        for (text, words) in [
            ("vn 0 0 1\n", "no line v"),
            ("v 1 2\n", "line 1: v needs three"),
            ("v 1 2 3\nf 1 2\n", "line 2: there is no corner \"2\""),
            ("v 1 2 3\nvn 0 0 1\nf 1//7\n", "1//7"),
            ("v 1 2 3\nf 0\n", "\"0\""),
        ] {
            let message = read_text(text).unwrap_err();
            assert!(message.contains(words), "{message}");
        }
    }
}
