//! OBJ: text, each number with the fewest digits that read back to the same bits. It has no room for S and R.

use std::fmt::Write as _;

use super::mesh::SurfaceMesh;

/// The whole file.
pub(super) fn write(mesh: &SurfaceMesh, title: &str) -> Vec<u8> {
    let title: String = title.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).collect();
    let mut text = format!("# surface fitted by palpate: {title}\n");
    // writing to a string cannot fail
    for [x, y, z] in &mesh.points {
        let _ = writeln!(text, "v {x:e} {y:e} {z:e}");
    }
    for [x, y, z] in &mesh.normals {
        let _ = writeln!(text, "vn {x:e} {y:e} {z:e}");
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| v + 1);
        let _ = writeln!(text, "f {a}//{a} {b}//{b} {c}//{c}");
    }
    text.into_bytes()
}
