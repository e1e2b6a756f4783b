//! PLY: binary, little-endian, `double` for every number at a vertex.

use super::mesh::SurfaceMesh;

/// The whole file.
pub(super) fn write(mesh: &SurfaceMesh, title: &str) -> Vec<u8> {
    let mut head = String::from("ply\nformat binary_little_endian 1.0\ncomment surface fitted by palpate\n");
    // a comment is one line of ASCII
    let title: String = title.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).collect();
    head.push_str(&format!("comment {title}\nelement vertex {}\n", mesh.points.len()));
    for name in ["x", "y", "z", "nx", "ny", "nz"].into_iter().chain(mesh.fields.iter().map(|(name, _)| *name)) {
        head.push_str(&format!("property double {name}\n"));
    }
    head.push_str(&format!(
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.triangles.len()
    ));
    let mut bytes = head.into_bytes();
    for (k, (point, normal)) in mesh.points.iter().zip(&mesh.normals).enumerate() {
        let values = mesh.fields.iter().map(|(_, values)| values[k]);
        let all = point.iter().chain(normal).copied().chain(values);
        bytes.extend(all.flat_map(f64::to_le_bytes));
    }
    for triangle in &mesh.triangles {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|v| v.to_le_bytes()));
    }
    bytes
}
