//! A spline as CAD has it: clamped knots and control points in space, out of a saved surface and back.
//!
//! ```text
//! height field   P_ij = A' (g_i, g_j, c_ij)     g = (t_i+1 + ... + t_i+p)/p, for which sum_i g_i N_i(x) = x
//! in space       P_ij = c_ij
//! ```
//!
//! Read back, a surface whose control points stand at exactly the Greville abscissae over x and y is the height field that
//! was written, to the bit; any other is a surface in space.

use ndarray::Array2;

use crate::io::limits::{MOST_SEGMENTS, exceeds};
use crate::io::surface_file::{AnySurface, Saved};
use palpate_geometry::contact::Frame;
use palpate_geometry::shape::UvSupport;
use palpate_geometry::surface::{HeightField, Parametric};
use palpate_hierarchical::field::HierarchicalField;
use palpate_numeric::bspline::{Knots, MAX_DEGREE};

/// A non-rational tensor-product spline, open in both directions.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CadPatch {
    pub(super) degree: [usize; 2],
    /// Full knot vectors.
    pub(super) knots: [Vec<f64>; 2],
    /// n x m control points.
    pub(super) points: Array2<[f64; 3]>,
}

impl CadPatch {
    /// The spline of a saved surface.
    ///
    /// # Errors
    /// What CAD cannot hold, and what can.
    pub(super) fn of(saved: &Saved) -> Result<CadPatch, String> {
        if !saved.unsupported.is_empty() {
            return Err(format!(
                "the contacts leave a gap ({} coefficients without data), which a CAD spline would close with a made-up \
                 surface; save a mesh (.ply, .obj, .stl, .glb, .vtu), which is cut there, or fit fewer --segments",
                saved.unsupported.len()
            ));
        }
        match &saved.surface {
            AnySurface::Height(field) => Ok(CadPatch::of_height(field, &saved.frame)),
            AnySurface::Hierarchical(field) => Ok(CadPatch::of_height(&tensor(field)?, &saved.frame)),
            AnySurface::Parametric(map, _) => {
                let closed: Vec<&str> =
                    ["u", "v"].into_iter().zip(map.knots()).filter(|(_, k)| k.is_closed()).map(|(n, _)| n).collect();
                if !closed.is_empty() {
                    return Err(format!(
                        "the surface closes on itself in {}, and its spline is periodic; save a mesh (.ply, .obj, .stl, \
                         .glb, .vtu), or .npz or .json, which hold periodic splines",
                        closed.join(" and ")
                    ));
                }
                let (degree, knots) = degrees_and_knots(map.knots());
                Ok(CadPatch { degree, knots, points: map.coefficients().clone() })
            }
        }
    }

    /// A height field over the axes of a frame.
    pub(super) fn of_height(field: &HeightField, frame: &Frame) -> CadPatch {
        let (degree, knots) = degrees_and_knots(field.knots());
        let [x, y] = field.knots().each_ref().map(Knots::greville);
        let points = Array2::from_shape_fn(field.coefficients().dim(), |(i, j)| {
            in_space([x[i], y[j], field.coefficients()[[i, j]]], frame)
        });
        CadPatch { degree, knots, points }
    }

    /// The surface that a CAD file holds.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(super) fn into_saved(self, file: &str) -> Result<Saved, String> {
        let [n, m] = [0, 1].map(|k| self.knots[k].len());
        if exceeds([n, m], MOST_SEGMENTS) {
            return Err(format!("{n} x {m} knots are too many"));
        }
        let axis = |name: &str, k: usize| {
            if !(1..=MAX_DEGREE).contains(&self.degree[k]) {
                return Err(format!("degree {} in {name}; this program takes 1 to {MAX_DEGREE}", self.degree[k]));
            }
            Knots::new(self.degree[k], self.knots[k].clone()).map_err(|e| format!("knots in {name}: {e}"))
        };
        let knots = [axis("u", 0)?, axis("v", 1)?];
        let surface = match heights(&knots, &self.points) {
            Some(heights) => AnySurface::Height(HeightField::new(knots, heights).map_err(|e| e.to_string())?),
            None => {
                let [u, v] = knots.each_ref().map(Knots::domain);
                let whole =
                    vec![[[u[0], v[0]], [u[1], v[0]], [u[1], v[1]]], [[u[0], v[0]], [u[1], v[1]], [u[0], v[1]]]];
                let map = Parametric::new(knots, self.points).map_err(|e| e.to_string())?;
                AnySurface::Parametric(map, UvSupport::new(whole, [None; 2]))
            }
        };
        Ok(Saved {
            file: file.into(),
            frame: Frame::IDENTITY,
            surface,
            unsupported: Vec::new(),
            support_map: None,
            uncertainty: None,
        })
    }
}

/// Coefficients of a tensor spline that a file of text still holds and CAD still opens: some 100 MB.
pub(super) const MOST_COEFFICIENTS: usize = 1 << 20;

/// Whether the one spline of an adaptive surface has more coefficients than are written.
pub(super) fn is_too_large(field: &HierarchicalField) -> bool {
    let [n, m] = field.tensor_size();
    n.saturating_mul(m) > MOST_COEFFICIENTS
}

/// The tensor spline of the finest level, where it is not too large.
///
/// # Errors
/// What can be saved instead.
pub(crate) fn tensor(field: &HierarchicalField) -> Result<HeightField, String> {
    if is_too_large(field) {
        let [n, m] = field.tensor_size();
        return Err(format!(
            "as one spline the surface has {n} x {m} coefficients, at most {MOST_COEFFICIENTS} in all are written; .step and .igs hold it \
             as several, .json its cells as they are, and a mesh (.ply, .obj, .stl, .glb, .vtu) takes any surface"
        ));
    }
    field.to_tensor().map_err(|e| e.to_string())
}

/// A point of a height field in the input's own coordinates.
pub(super) fn in_space(point: [f64; 3], frame: &Frame) -> [f64; 3] {
    if frame.keeps_axes() { point } else { frame.rotate_back(point) }
}

fn degrees_and_knots(knots: &[Knots; 2]) -> ([usize; 2], [Vec<f64>; 2]) {
    ([0, 1].map(|k| knots[k].degree()), [0, 1].map(|k| knots[k].as_slice().to_vec()))
}

/// The heights of control points that stand over the Greville abscissae.
fn heights(knots: &[Knots; 2], points: &Array2<[f64; 3]>) -> Option<Array2<f64>> {
    let [x, y] = knots.each_ref().map(Knots::greville);
    let fits =
        points.dim() == (x.len(), y.len()) && points.indexed_iter().all(|((i, j), p)| p[0] == x[i] && p[1] == y[j]);
    fits.then(|| points.mapv(|p| p[2]))
}
