//! STL, binary: triangles alone, in float32, because the format knows nothing else.

use super::mesh::SurfaceMesh;
use palpate_numeric::vector::{cross, minus, unit};

/// Bytes of the header, which must not begin with `solid`: readers would take it for text.
const HEADER: usize = 80;

/// The whole file.
pub(super) fn write(mesh: &SurfaceMesh) -> Vec<u8> {
    let mut bytes = b"surface fitted by palpate, float32".to_vec();
    bytes.resize(HEADER, b' ');
    // the limit on grid points is far below 2^31
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for triangle in &mesh.triangles {
        let corners = triangle.map(|v| mesh.points[v as usize]);
        let normal = unit(cross(minus(corners[1], corners[0]), minus(corners[2], corners[0])));
        let normal = if normal.iter().all(|v| v.is_finite()) { normal } else { [0.0; 3] };
        for vector in [normal, corners[0], corners[1], corners[2]] {
            bytes.extend(vector.iter().flat_map(|v| (*v as f32).to_le_bytes()));
        }
        bytes.extend([0, 0]);
    }
    bytes
}
