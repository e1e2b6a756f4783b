//! glTF 2.0 in one binary file (.glb): float32, because the format knows nothing else.
//!
//! ```text
//! "glTF" 2 length   JSON chunk, padded with blanks   BIN chunk: positions, normals, fields, indices
//! ```
//!
//! Positions are differences from the middle of the mesh, and the node's translation brings them back: a surface of size 1
//! at 1e8 keeps its shape. Fields such as S stand as attributes of their own (`_S`), which viewers pass over.

use serde_json::{Value, json};

use super::mesh::SurfaceMesh;

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The binary chunk with what tells its parts apart.
#[derive(Default)]
struct Parts {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Parts {
    /// Adds an array of `count` items and returns its accessor's number.
    fn add(&mut self, bytes: impl Iterator<Item = u8>, target: u32, mut accessor: Value) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        let length = self.bytes.len() - offset;
        self.views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": length, "target": target }));
        accessor["bufferView"] = (self.views.len() - 1).into();
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn vectors(&mut self, vectors: &[[f32; 3]]) -> usize {
        let bound = |from: f32, pick: fn(f32, f32) -> f32| {
            vectors.iter().fold([from; 3], |b, v| [0, 1, 2].map(|k| pick(b[k], v[k])))
        };
        let accessor = json!({
            "componentType": FLOAT, "count": vectors.len(), "type": "VEC3",
            "min": bound(f32::INFINITY, f32::min), "max": bound(f32::NEG_INFINITY, f32::max),
        });
        self.add(vectors.iter().flatten().flat_map(|v| v.to_le_bytes()), ARRAY_BUFFER, accessor)
    }
}

/// The whole file.
///
/// # Errors
/// Where the file would be longer than the format's four gigabytes.
pub(super) fn write(mesh: &SurfaceMesh, title: &str) -> Result<Vec<u8>, String> {
    let [lo, hi] = mesh.bounds();
    let middle = [0, 1, 2].map(|k| 0.5 * lo[k] + 0.5 * hi[k]);
    let single = |v: &[f64; 3], from: [f64; 3]| [0, 1, 2].map(|k| (v[k] - from[k]) as f32);
    let points: Vec<[f32; 3]> = mesh.points.iter().map(|p| single(p, middle)).collect();
    let normals: Vec<[f32; 3]> = mesh.normals.iter().map(|n| single(n, [0.0; 3])).collect();
    let mut parts = Parts::default();
    let mut attributes = json!({ "POSITION": parts.vectors(&points), "NORMAL": parts.vectors(&normals) });
    for (name, values) in &mesh.fields {
        // NaN is no number of glTF
        if values.iter().all(|v| v.is_finite()) {
            let accessor = json!({ "componentType": FLOAT, "count": values.len(), "type": "SCALAR" });
            let bytes = values.iter().flat_map(|v| (*v as f32).to_le_bytes());
            attributes[format!("_{}", name.to_uppercase())] = parts.add(bytes, ARRAY_BUFFER, accessor).into();
        }
    }
    let accessor = json!({ "componentType": UNSIGNED_INT, "count": 3 * mesh.triangles.len(), "type": "SCALAR" });
    let corners = mesh.triangles.iter().flatten().flat_map(|v| v.to_le_bytes());
    let indices = parts.add(corners, ELEMENT_ARRAY_BUFFER, accessor);
    let document = json!({
        "asset": { "version": "2.0", "generator": format!("palpate {}", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": title, "translation": middle }],
        "meshes": [{ "primitives": [{ "attributes": attributes, "indices": indices, "material": 0 }] }],
        "materials": [{ "doubleSided": true, "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 0.8 } }],
        "buffers": [{ "byteLength": parts.bytes.len() }],
        "bufferViews": parts.views,
        "accessors": parts.accessors,
    });
    chunks(document.to_string().into_bytes(), parts.bytes)
}

fn chunks(mut document: Vec<u8>, binary: Vec<u8>) -> Result<Vec<u8>, String> {
    document.resize(document.len().next_multiple_of(4), b' ');
    let whole = 12 + 8 + document.len() + 8 + binary.len();
    let length = |n: usize| u32::try_from(n).map_err(|_| "more than 4 GB; give fewer --grid points".to_string());
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2u32.to_le_bytes());
    bytes.extend(length(whole)?.to_le_bytes());
    for (kind, chunk) in [(b"JSON", document), (b"BIN\0", binary)] {
        bytes.extend(length(chunk.len())?.to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    Ok(bytes)
}
