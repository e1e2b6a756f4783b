//! A saved fit as a surface to be touched: `z = S(x, y)` of a height field read back from its JSON.
//!
//! Its derivatives are the spline's own, so a fit of the contacts made on it has no model error by construction. That is
//! an inverse crime, and every output of such a scene says so. The surface lies where it was fitted, in input units; one
//! that was fitted in a rotated frame is touched along that frame's axes.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use palpate_geometry::surface::Heights;
use palpate_world::scene::surface::ImportedSurface;

use super::{AnySurface, read_surface};

#[derive(Debug)]
struct SavedHeights {
    label: String,
    surface: Box<dyn Heights + Send + Sync>,
}

impl ImportedSurface for SavedHeights {
    fn label(&self) -> &str {
        &self.label
    }

    fn jet(&self, x: f64, y: f64) -> Option<[f64; 6]> {
        let [[x0, x1], [y0, y1]] = self.surface.domain();
        // the end polynomials go on outside, where no contact ever was
        if !((x0..=x1).contains(&x) && (y0..=y1).contains(&y)) {
            return None;
        }
        let at = self.surface.height_at(x, y);
        Some([at.z, at.zx, at.zy, at.zxx, at.zxy, at.zyy])
    }
}

/// Files of surfaces that scenes have named in this process: inputs, which no output may replace.
static IMPORTED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// The files of surfaces that the scenes read so far have named.
pub(crate) fn imported_files() -> Vec<PathBuf> {
    IMPORTED.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Finds the surface that a scene names as `file`: a path relative to the folder of the scene.
///
/// # Errors
/// In words, why it could not be had.
pub(crate) fn import_surface(scene_folder: &Path, file: &str) -> Result<Arc<dyn ImportedSurface>, String> {
    if file == "-" {
        return Err("a scene cannot take its surface from standard input".into());
    }
    let path: PathBuf = scene_folder.join(file);
    let saved = read_surface(&path).map_err(|e| e.to_string())?;
    IMPORTED.lock().unwrap_or_else(PoisonError::into_inner).push(path);
    if !saved.unsupported.is_empty() {
        return Err(format!(
            "{} of its coefficients are held by no data; there is no surface there",
            saved.unsupported.len()
        ));
    }
    let surface: Box<dyn Heights + Send + Sync> = match saved.surface {
        AnySurface::Height(surface) => Box::new(surface),
        AnySurface::Hierarchical(surface) => surface,
        AnySurface::Parametric(..) => {
            let what = "a parametric surface has not one height over each x and y; save a fit whose surface is of the kind height";
            return Err(what.into());
        }
    };
    Ok(Arc::new(SavedHeights { label: file.to_string(), surface }))
}
