//! A surface for other tools: as a spline (STEP, IGES, NPZ), or as a mesh with its shape (PLY, OBJ, STL, glTF, VTK) or a
//! table of points (Parquet).
//!
//! ```text
//! .step .stp   AP214, B_SPLINE_SURFACE_WITH_KNOTS in a shell of one face     decimals that read back to the bit
//! .igs .iges   entity 128, no trimming                                       decimals that read back to the bit
//!              (of an adaptive surface with very small cells several faces, sewn along their edges in STEP)
//! .npz         tx, ty, c, degree: SciPy's bisplev, NdBSpline                 float64
//! .ply .vtu    triangles where contacts support the surface, with S, R, ...  float64
//! .obj         the same triangles with normals                               decimals that read back to the bit
//! .stl .glb    the same triangles                                            float32: the formats know no other
//! .parquet     the mesh's points as a table                                  float64
//! ```
//!
//! What a format cannot say is refused by name: a spline that closes on itself has no ends for CAD, and one with
//! coefficients that no data hold would show a made-up surface in the gap, which CAD could not tell from the touched one.

mod cad;
mod cad_shell;
mod glb;
mod iges_reader;
mod iges_writer;
mod mesh;
mod obj_mesh;
mod part21;
mod ply_mesh;
mod point_table;
mod scipy_npz;
mod step_primitives;
mod step_reader;
mod step_writer;
mod stl_mesh;
mod trimmed_primitive;
mod vtu;

use std::path::Path;

use super::IoError;
use super::surface_file::{AnySurface, Saved};

pub(crate) use cad::tensor;
use mesh::SurfaceMesh;
pub(crate) use step_primitives::write_primitives;
pub(crate) use trimmed_primitive::trimmed_primitives;

/// Every ending, for messages.
const ENDINGS: &str = ".json, .step, .igs, .npz, .ply, .obj, .stl, .glb, .vtu or .parquet";

/// Which kind of file a surface is saved in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SurfaceFormat {
    /// The whole document.
    Json,
    /// Spline for CAD.
    Step,
    /// Spline for CAD.
    Iges,
    /// Spline for SciPy.
    Npz,
    /// Mesh.
    Ply,
    /// Mesh.
    Obj,
    /// Mesh, float32.
    Stl,
    /// Mesh, float32.
    Glb,
    /// Mesh with fields.
    Vtu,
    /// Points as a table.
    Parquet,
}

impl SurfaceFormat {
    /// By the name's ending; standard output, devices and names without an ending take JSON.
    ///
    /// # Errors
    /// [`IoError::Extension`].
    pub(crate) fn of(path: &Path) -> Result<SurfaceFormat, IoError> {
        let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        Ok(match ending.as_deref() {
            None | Some("json") => SurfaceFormat::Json,
            Some("step" | "stp" | "p21") => SurfaceFormat::Step,
            Some("igs" | "iges") => SurfaceFormat::Iges,
            Some("npz") => SurfaceFormat::Npz,
            Some("ply") => SurfaceFormat::Ply,
            Some("obj") => SurfaceFormat::Obj,
            Some("stl") => SurfaceFormat::Stl,
            Some("glb") => SurfaceFormat::Glb,
            Some("vtu") => SurfaceFormat::Vtu,
            Some("parquet") => SurfaceFormat::Parquet,
            Some(_) => return Err(IoError::Extension { path: path.into(), expected: ENDINGS }),
        })
    }

    /// Its name in messages.
    fn name(self) -> &'static str {
        match self {
            SurfaceFormat::Json => "JSON",
            SurfaceFormat::Step => "STEP",
            SurfaceFormat::Iges => "IGES",
            SurfaceFormat::Npz => "NPZ",
            SurfaceFormat::Ply => "PLY",
            SurfaceFormat::Obj => "OBJ",
            SurfaceFormat::Stl => "STL",
            SurfaceFormat::Glb => "glTF",
            SurfaceFormat::Vtu => "VTU",
            SurfaceFormat::Parquet => "Parquet",
        }
    }
}

/// A surface as the bytes of a file, and what the user should know about them.
#[derive(Clone, Debug)]
pub(crate) struct Encoded {
    /// The whole file.
    pub(crate) bytes: Vec<u8>,
    /// What the format leaves out, in whole sentences.
    pub(crate) notes: Vec<String>,
}

/// The surface in one of the formats besides JSON; meshes have `points` vertices each way before they are cut at the
/// support. `title` goes where the format has room for one.
///
/// # Errors
/// [`IoError::Unholdable`]: what the format cannot hold, and which can.
pub(crate) fn encode_surface(
    saved: &Saved,
    format: SurfaceFormat,
    points: [usize; 2],
    title: &str,
) -> Result<Encoded, IoError> {
    let refused = |what: String| IoError::Unholdable { format: format.name(), what };
    let mesh = || SurfaceMesh::of(saved, points).map_err(refused);
    let title: String = title.chars().filter(|c| !c.is_control()).take(LONGEST_TITLE).collect();
    match format {
        SurfaceFormat::Step | SurfaceFormat::Iges => {
            let step = format == SurfaceFormat::Step;
            let mut notes = cad_notes(saved, format);
            let text = match shell_of(saved).map_err(refused)? {
                Some(shell) => {
                    let faces = shell.faces.len();
                    notes.push(format!("as one spline it would be too large: it is written as {faces} that adjoin"));
                    if step {
                        step_writer::write_shell(&shell, &title)
                    } else {
                        iges_writer::write(&shell.faces, &title)
                    }
                }
                None => {
                    let patch = cad::CadPatch::of(saved).map_err(refused)?;
                    if step { step_writer::write(&patch, &title) } else { iges_writer::write(&[patch], &title) }
                }
            };
            Ok(Encoded { bytes: text.into_bytes(), notes })
        }
        SurfaceFormat::Npz => {
            let bytes = scipy_npz::write(saved).map_err(|e| refused(e.to_string()))?;
            Ok(Encoded { bytes, notes: Vec::new() })
        }
        SurfaceFormat::Ply => mesh()?.encoded(|mesh| ply_mesh::write(mesh, &title)),
        SurfaceFormat::Obj => mesh()?.encoded(|mesh| obj_mesh::write(mesh, &title)),
        SurfaceFormat::Vtu => mesh()?.encoded(vtu::write),
        SurfaceFormat::Stl => {
            let mesh = mesh()?;
            let notes = single_precision(&mesh, "STL", 0.0).into_iter().collect();
            Ok(Encoded { bytes: stl_mesh::write(&mesh), notes })
        }
        SurfaceFormat::Glb => {
            let mesh = mesh()?;
            Ok(Encoded { bytes: glb::write(&mesh, &title).map_err(|e| refused(e.to_string()))?, notes: Vec::new() })
        }
        SurfaceFormat::Parquet => {
            let bytes = point_table::write(&mesh()?).map_err(|e| refused(e.to_string()))?;
            Ok(Encoded { bytes, notes: Vec::new() })
        }
        SurfaceFormat::Json => Err(refused("the document is written by whoever has it; name another ending".into())),
    }
}

/// The faces of an adaptive surface whose one spline would be too large.
fn shell_of(saved: &Saved) -> Result<Option<cad_shell::CadShell>, String> {
    match &saved.surface {
        AnySurface::Hierarchical(field) if cad::is_too_large(field) => {
            cad_shell::CadShell::of(field, &saved.frame).map(Some)
        }
        _ => Ok(None),
    }
}

/// Letters of a title that are kept: more than any name of a scene or file needs.
const LONGEST_TITLE: usize = 200;

impl SurfaceMesh {
    fn encoded(&self, write: impl Fn(&SurfaceMesh) -> Vec<u8>) -> Result<Encoded, IoError> {
        Ok(Encoded { bytes: write(self), notes: Vec::new() })
    }
}

/// Share of the domain without contacts from which on a note says so: less is the outline's raggedness.
const NOTABLE: f64 = 0.02;

fn cad_notes(saved: &Saved, format: SurfaceFormat) -> Vec<String> {
    let beyond = 1.0 - mesh::supported_share(saved);
    let name = format.name();
    let mut notes = vec![format!("{name} has to name a unit: one of the input is written as 1 mm")];
    if beyond > NOTABLE {
        notes.push(format!(
            "{name} holds the spline's whole domain, of which {:.0} % lie beyond the contacts; a mesh (.ply, .vtu) is cut there",
            100.0 * beyond
        ));
    }
    notes
}

/// Rounding of float32 beyond which a note says so, as a share of the mesh's size.
const VISIBLE_ROUNDING: f64 = 1e-6;

/// What float32 costs coordinates far from the origin.
fn single_precision(mesh: &SurfaceMesh, name: &str, moved: f64) -> Option<String> {
    let [lo, hi] = mesh.bounds();
    let far = (0..3).map(|k| lo[k].abs().max(hi[k].abs())).fold(0.0, f64::max) - moved;
    let size = (0..3).map(|k| hi[k] - lo[k]).fold(0.0, f64::max);
    let rounding = far * f64::from(f32::EPSILON) / 2.0;
    (rounding > VISIBLE_ROUNDING * size).then(|| {
        format!("{name} holds float32: coordinates are rounded by up to {rounding:.1e}; .ply and .vtu keep float64")
    })
}

/// Whether the bytes are those of a STEP or IGES file.
pub(crate) fn is_cad(bytes: &[u8]) -> bool {
    part21::looks_like(bytes) || iges_reader::looks_like(bytes)
}

/// Reads a surface in STEP or IGES, known by its first bytes; `None` where it is neither.
///
/// # Errors
/// [`IoError::Form`] with what the file holds instead and what would be right.
pub(super) fn read_cad(file: &str, bytes: &[u8]) -> Option<Result<Saved, IoError>> {
    let (form, patch) = if part21::looks_like(bytes) {
        ("STEP", step_reader::read(bytes))
    } else if iges_reader::looks_like(bytes) {
        ("IGES", iges_reader::read(bytes))
    } else {
        return None;
    };
    let saved = patch.and_then(|patch| patch.into_saved(file));
    Some(saved.map_err(|what| IoError::Form { file: file.into(), form, what }))
}
