//! VTK's unstructured grid in XML (.vtu): triangles with S, R, k1, k2, uncertainties and normals at their points, Float64.
//!
//! ```text
//! <DataArray type="Float64" Name="S" format="binary"> base64(bytes as UInt64, data) </DataArray>
//! ```

use std::fmt::Write as _;

use super::mesh::SurfaceMesh;
use crate::io::base64;

/// VTK's number of a triangle.
const TRIANGLE: u8 = 5;

/// The whole file.
pub(super) fn write(mesh: &SurfaceMesh) -> Vec<u8> {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<UnstructuredGrid>\n",
    );
    let (points, cells) = (mesh.points.len(), mesh.triangles.len());
    let doubles = |values: &mut dyn Iterator<Item = f64>| values.flat_map(f64::to_le_bytes).collect::<Vec<u8>>();
    // writing to a string cannot fail
    let _ = writeln!(text, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">");
    text.push_str("<PointData Scalars=\"S\" Normals=\"Normals\">\n");
    for (name, values) in &mesh.fields {
        array(&mut text, "Float64", name, 1, &doubles(&mut values.iter().copied()));
    }
    array(&mut text, "Float64", "Normals", 3, &doubles(&mut mesh.normals.iter().flatten().copied()));
    text.push_str("</PointData>\n<Points>\n");
    array(&mut text, "Float64", "Points", 3, &doubles(&mut mesh.points.iter().flatten().copied()));
    text.push_str("</Points>\n<Cells>\n");
    let corners: Vec<u8> = mesh.triangles.iter().flatten().flat_map(|v| i64::from(*v).to_le_bytes()).collect();
    array(&mut text, "Int64", "connectivity", 1, &corners);
    let ends: Vec<u8> = (1..=cells as i64).flat_map(|k| (3 * k).to_le_bytes()).collect();
    array(&mut text, "Int64", "offsets", 1, &ends);
    array(&mut text, "UInt8", "types", 1, &vec![TRIANGLE; cells]);
    text.push_str("</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    text.into_bytes()
}

fn array(text: &mut String, kind: &str, name: &str, components: usize, bytes: &[u8]) {
    let parts = format!(" NumberOfComponents=\"{components}\"");
    let parts = if components > 1 { &parts[..] } else { "" };
    let _ = writeln!(text, "<DataArray type=\"{kind}\" Name=\"{name}\"{parts} format=\"binary\">");
    let mut whole = (bytes.len() as u64).to_le_bytes().to_vec();
    whole.extend_from_slice(bytes);
    text.push_str(&base64(&whole));
    text.push_str("\n</DataArray>\n");
}
