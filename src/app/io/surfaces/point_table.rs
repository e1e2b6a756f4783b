//! The mesh's points as a table in Parquet: number, x, y, z, normal, S, R, k1, k2 and uncertainties, all DOUBLE.

use crate::io::records::write_parquet;

use super::mesh::SurfaceMesh;

/// The whole file.
///
/// # Errors
/// What the writer says.
pub(super) fn write(mesh: &SurfaceMesh) -> std::io::Result<Vec<u8>> {
    let part = |vectors: &[[f64; 3]], k: usize| vectors.iter().map(|v| v[k]).collect::<Vec<f64>>();
    let positions = ["x", "y", "z"].into_iter().enumerate().map(|(k, name)| (name, part(&mesh.points, k)));
    let normals = ["nx", "ny", "nz"].into_iter().enumerate().map(|(k, name)| (name, part(&mesh.normals, k)));
    let (names, columns): (Vec<String>, Vec<Vec<f64>>) = positions
        .chain(normals)
        .chain(mesh.fields.iter().cloned())
        .map(|(name, values)| (name.to_string(), values))
        .unzip();
    let mut bytes = Vec::new();
    write_parquet("point", &names, &columns, &mut bytes)?;
    Ok(bytes)
}
