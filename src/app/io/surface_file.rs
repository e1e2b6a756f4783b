//! The saved surface: `frame` and `surface` of a `palpate.fit/1` document, out and back.
//!
//! Where the frame's axes are those of the input, `knots` and `coefficients` are in the input's own coordinates, so
//! that SciPy's `bisplev` reproduces z(x, y) without a thought for the frame. Where they are not, the surface is a
//! height field along the frame's axes A, in input units from the input's origin: `P = A' (u, v, S(u, v))`. A surface in
//! space has three numbers a coefficient, input units, and u, v are lengths of the input; its knots are SciPy's too, those
//! of a closed direction going on beyond both ends.

use std::sync::Arc;

use ndarray::Array2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use palpate_geometry::contact::Frame;
use palpate_geometry::shape::{ShapeGrid, UvSupport};
use palpate_geometry::surface::{HeightField, Parametric, Surface};
use palpate_hierarchical::field::HierarchicalField;
use palpate_hierarchical::mesh::{CellId, Mesh};
use palpate_hierarchical::space::HierarchicalSpace;
use palpate_numeric::bspline::Knots;

use super::IoError;
use super::page_file::document_bytes;
use super::support_map::SupportMap;
use super::uncertainty_map::UncertaintyMap;

/// `frame` of the document.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct SavedFrame {
    /// Point of the input frame that is the patch's origin.
    pub origin: [f64; 3],
    /// Rows are the patch's x, y, z directions in the input frame.
    pub axes: [[f64; 3]; 3],
    /// Length of the input that is 1 in the patch.
    pub scale: f64,
}

/// `surface` of the document.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct SavedSurface {
    /// `height`: z over x, y; `parametric`: Q over u, v; `adaptive`: z over x, y with knots where the contacts asked for them.
    pub kind: String,
    /// Degrees in x and y.
    pub degree: [usize; 2],
    /// Full knot vectors, clamped in open directions.
    pub knots: [Vec<f64>; 2],
    /// `coefficients[i][j]` of `N_i(x) M_j(y)`; of an adaptive surface one list, by level and then as in the level's spline.
    pub coefficients: Vec<Vec<Coefficient>>,
    /// Directions that close (`parametric`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closed: Option<[bool; 2]>,
    /// Triangles of (u, v) that contacts span (`parametric`); elsewhere S and R are masked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub support: Option<Vec<[[f64; 2]; 3]>>,
    /// Where contacts support a height field, where they do not support all of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) support_map: Option<SupportMap>,
    /// Cells `[level, i, j]` that are split into four (`adaptive`); `knots` are those of level 0, and every level halves their
    /// segments.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) splits: Option<Vec<[u32; 3]>>,
    /// Coefficients (number `i m + j`) that no data hold; where they matter, S and R are masked.
    #[serde(default)]
    pub unsupported: Vec<usize>,
}

/// One coefficient: a height, or a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Coefficient {
    /// Of a height field.
    Height(f64),
    /// Of a parametric surface.
    Space([f64; 3]),
}

/// A surface of either kind.
#[derive(Clone, Debug, PartialEq)]
pub enum AnySurface {
    /// Input units, along the frame's axes.
    Height(HeightField),
    /// Input units, with the part of (u, v) that contacts reach.
    Parametric(Parametric, UvSupport),
    /// Input units, over the input's x and y.
    Hierarchical(Box<HierarchicalField>),
}

/// The part of a document that a surface is made from; what else stands in it is left alone.
#[derive(Clone, Debug, Deserialize)]
struct Document {
    schema: String,
    frame: SavedFrame,
    surface: SavedSurface,
    #[serde(default)]
    uncertainty: Option<UncertaintyMap>,
}

/// The only schema that is read.
pub(crate) const FIT_SCHEMA: &str = "palpate.fit/1";

/// A surface that was read back.
#[derive(Clone, Debug, PartialEq)]
pub struct Saved {
    /// Name of the file, for messages.
    pub file: String,
    /// The patch frame it was fitted in.
    pub frame: Frame,
    /// The surface.
    pub surface: AnySurface,
    /// Coefficients that no data hold.
    pub unsupported: Vec<usize>,
    /// Where contacts support a height field, where they do not support all of it.
    pub support_map: Option<SupportMap>,
    /// Standard uncertainties over the domain, where they are known.
    pub uncertainty: Option<UncertaintyMap>,
}

impl SavedFrame {
    /// As it is written.
    pub(crate) fn of(frame: &Frame) -> SavedFrame {
        SavedFrame { origin: frame.origin, axes: frame.axes, scale: frame.scale }
    }
}

impl SavedSurface {
    /// As it is written.
    pub(crate) fn of(surface: &HeightField, unsupported: &[usize]) -> SavedSurface {
        let [x, y] = surface.knots();
        SavedSurface {
            kind: "height".into(),
            degree: [x.degree(), y.degree()],
            knots: [x.as_slice().to_vec(), y.as_slice().to_vec()],
            coefficients: rows(surface.coefficients(), |c| Coefficient::Height(*c)),
            closed: None,
            support: None,
            support_map: None,
            splits: None,
            unsupported: unsupported.to_vec(),
        }
    }

    /// As it is written.
    pub(crate) fn of_parametric(surface: &Parametric, support: &UvSupport) -> SavedSurface {
        let [u, v] = surface.knots();
        SavedSurface {
            kind: "parametric".into(),
            degree: [u.degree(), v.degree()],
            knots: [u.as_slice().to_vec(), v.as_slice().to_vec()],
            coefficients: rows(surface.coefficients(), |c| Coefficient::Space(*c)),
            closed: Some([u.is_closed(), v.is_closed()]),
            support: Some(support.triangles().to_vec()),
            support_map: None,
            splits: None,
            unsupported: Vec::new(),
        }
    }

    /// As it is written.
    pub(crate) fn of_hierarchical(surface: &HierarchicalField) -> SavedSurface {
        let mesh = surface.space().mesh();
        let knots = mesh.levels().at(0).map(|level| level.knots());
        let split = |cell: CellId| [u32::from(cell.level), cell.place[0], cell.place[1]];
        SavedSurface {
            kind: "adaptive".into(),
            degree: knots.map(Knots::degree),
            knots: knots.map(|axis| axis.as_slice().to_vec()),
            coefficients: vec![surface.coefficients().iter().map(|c| Coefficient::Height(*c)).collect()],
            closed: None,
            support: None,
            support_map: None,
            splits: Some(mesh.splits().map(split).collect()),
            unsupported: Vec::new(),
        }
    }

    fn surface(self) -> Result<AnySurface, String> {
        match self.kind.as_str() {
            "height" => self.height_field().map(AnySurface::Height),
            "parametric" => self.parametric(),
            "adaptive" => self.hierarchical().map(|field| AnySurface::Hierarchical(Box::new(field))),
            other => Err(format!(
                "surface.kind is {other:?}; this version reads \"height\", \"parametric\" and \"adaptive\""
            )),
        }
    }

    fn height_field(self) -> Result<HeightField, String> {
        let knots = self.read_knots([false; 2])?;
        let coefficients = self.array(|c| match c {
            Coefficient::Height(z) => Some(z),
            Coefficient::Space(_) => None,
        })?;
        HeightField::new(knots, coefficients).map_err(|e| e.to_string())
    }

    fn parametric(self) -> Result<AnySurface, String> {
        let knots = self.read_knots(self.closed.unwrap_or_default())?;
        let period = [0, 1].map(|k: usize| {
            let [lo, hi] = knots[k].domain();
            knots[k].is_closed().then_some(hi - lo)
        });
        let triangles = self.support.clone().unwrap_or_default();
        if triangles.iter().flatten().flatten().any(|t| !t.is_finite()) {
            return Err("surface.support has a number that is not finite".into());
        }
        let coefficients = self.array(|c| match c {
            Coefficient::Height(_) => None,
            Coefficient::Space(p) => Some(p),
        })?;
        let surface = Parametric::new(knots, coefficients).map_err(|e| e.to_string())?;
        Ok(AnySurface::Parametric(surface, UvSupport::new(triangles, period)))
    }

    fn hierarchical(self) -> Result<HierarchicalField, String> {
        let cell = |[level, i, j]: &[u32; 3]| {
            let level = u8::try_from(*level).map_err(|_| format!("surface.splits has a cell of level {level}"))?;
            Ok(CellId { level, place: [*i, *j] })
        };
        let splits: Result<Vec<CellId>, String> = self.splits.iter().flatten().map(cell).collect();
        let mesh = Mesh::of_splits(self.read_knots([false; 2])?, splits?).map_err(|e| e.to_string())?;
        let coefficients = self.array(|c| match c {
            Coefficient::Height(z) => Some(z),
            Coefficient::Space(_) => None,
        })?;
        let space = Arc::new(HierarchicalSpace::new(mesh));
        HierarchicalField::new(space, coefficients.into_iter().collect()).map_err(|e| e.to_string())
    }

    fn read_knots(&self, closed: [bool; 2]) -> Result<[Knots; 2], String> {
        let axis = |name: &str, k: usize| {
            let (degree, knots) = (self.degree[k], &self.knots[k]);
            let made = if closed[k] { Knots::closed_from(degree, knots) } else { Knots::new(degree, knots.clone()) };
            made.map_err(|e| format!("knots in {name}: {e}"))
        };
        Ok([axis("x", 0)?, axis("y", 1)?])
    }

    /// Coefficients as an array, every one of the kind that `take` takes.
    fn array<T: Clone>(&self, take: impl Fn(Coefficient) -> Option<T>) -> Result<Array2<T>, String> {
        let (n, m) = (self.coefficients.len(), self.coefficients.first().map_or(0, Vec::len));
        if let Some(row) = self.coefficients.iter().position(|row| row.len() != m) {
            return Err(format!("row {row} of surface.coefficients has not the {m} entries of row 0"));
        }
        let flat: Option<Vec<T>> = self.coefficients.iter().flatten().map(|c| take(*c)).collect();
        let flat = flat.ok_or_else(|| format!("surface.coefficients are not those of kind {:?}", self.kind))?;
        Array2::from_shape_vec((n, m), flat).map_err(|e| e.to_string())
    }
}

fn rows<T>(array: &Array2<T>, make: impl Fn(&T) -> Coefficient) -> Vec<Vec<Coefficient>> {
    array.rows().into_iter().map(|row| row.iter().map(&make).collect()).collect()
}

impl SavedFrame {
    fn frame(&self) -> Result<Frame, String> {
        let Frame { origin, axes, scale } = Frame { origin: self.origin, axes: self.axes, scale: self.scale };
        let finite = origin.iter().chain(axes.iter().flatten()).all(|v| v.is_finite());
        let dot = |a: usize, b: usize| (0..3).map(|k| axes[a][k] * axes[b][k]).sum::<f64>();
        let orthonormal = (0..3).all(|a| (0..=a).all(|b| (dot(a, b) - f64::from(u8::from(a == b))).abs() < 1e-9));
        if finite && orthonormal && scale.is_finite() && scale > 0.0 {
            Ok(Frame { origin, axes, scale })
        } else {
            Err("frame must have a finite origin, orthonormal axes and a scale above zero".into())
        }
    }
}

impl Saved {
    /// The surface of a document, checked; `file` names it in messages.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(crate) fn of(
        file: &str,
        frame: &SavedFrame,
        surface: SavedSurface,
        uncertainty: Option<UncertaintyMap>,
    ) -> Result<Saved, String> {
        let frame = frame.frame()?;
        let (unsupported, support_map) = (surface.unsupported.clone(), surface.support_map.clone());
        support_map.as_ref().map_or(Ok(()), SupportMap::check)?;
        uncertainty.as_ref().map_or(Ok(()), UncertaintyMap::check)?;
        let surface = surface.surface()?;
        let count = match &surface {
            AnySurface::Height(field) => field.coefficients().len(),
            AnySurface::Parametric(map, _) => map.coefficients().len(),
            AnySurface::Hierarchical(field) => field.coefficients().len(),
        };
        match unsupported.iter().find(|u| **u >= count) {
            Some(u) => Err(format!("surface.unsupported names coefficient {u} of {count}")),
            None => Ok(Saved { file: file.into(), frame, surface, unsupported, support_map, uncertainty }),
        }
    }
}

impl Saved {
    /// Whether contacts support a place of the surface's own domain, and data every coefficient that it depends on.
    pub(crate) fn supports(&self, place: [f64; 2]) -> bool {
        let [u, v] = place;
        let holds = |domain: [[f64; 2]; 2]| {
            let within = (0..2).all(|k| (domain[k][0]..=domain[k][1]).contains(&place[k]));
            within && self.support_map.as_ref().is_none_or(|map| map.holds(domain, place))
        };
        match &self.surface {
            AnySurface::Height(field) => holds(field.domain()) && self.is_determined(field, u, v),
            AnySurface::Parametric(_, support) => support.holds(u, v),
            AnySurface::Hierarchical(field) => holds(field.domain()),
        }
    }

    fn is_determined(&self, field: &HeightField, u: f64, v: f64) -> bool {
        let grid = ShapeGrid { x: vec![u], y: vec![v] };
        self.unsupported.is_empty() || field.shape_maps(grid, &self.unsupported).supported[[0, 0]]
    }
}

/// Reads a saved surface from the bytes of its document.
///
/// # Errors
/// Every fault of the document, with its place.
pub(super) fn read_document_bytes(file: &str, bytes: &[u8]) -> Result<Saved, IoError> {
    let wrong = |what: String| IoError::Surface { file: file.into(), what };
    let bytes = document_bytes(file, bytes)?;
    let document: Document = serde_json::from_slice(&bytes).map_err(|e| wrong(e.to_string()))?;
    if document.schema != FIT_SCHEMA {
        return Err(wrong(format!("schema is {:?}, not {FIT_SCHEMA:?}", document.schema)));
    }
    Saved::of(file, &document.frame, document.surface, document.uncertainty).map_err(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document(change: impl Fn(&mut serde_json::Value)) -> Result<Saved, String> {
        let knots = [0.0, 0.0, 0.5, 1.0, 1.0];
        let mut value = serde_json::json!({
            "schema": "palpate.fit/1", "contacts": 9,
            "frame": {"origin": [0.0, 0.0, 0.0], "axes": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "scale": 1.0},
            "surface": {"kind": "height", "degree": [1, 1], "knots": [knots, knots],
                        "coefficients": [[0.1, 0.2, 0.3], [1.0, 2.0, 3.0], [7.0, 8.0, 9.5]]},
        });
        change(&mut value);
        read_document_bytes("s.json", value.to_string().as_bytes()).map_err(|e| e.to_string())
    }

    #[test]
    fn a_surface_comes_back_to_the_bit() {
        let AnySurface::Height(field) = document(|_| ()).unwrap().surface else { panic!("a height field") };
        assert_eq!(field.coefficients()[[2, 1]], 8.0);
        let text = serde_json::to_string(&SavedSurface::of(&field, &[])).unwrap();
        assert_eq!(serde_json::from_str::<SavedSurface>(&text).unwrap().height_field().unwrap(), field);
    }

    #[test]
    fn a_closed_surface_in_space_comes_back_to_the_bit() {
        let knots = [Knots::closed(2, 5, 0.0, 0.7).unwrap(), Knots::new(1, vec![-1.0, -1.0, 1.0, 1.0]).unwrap()];
        let free: Vec<[f64; 3]> = (0..10).map(|k| [0.1 * k as f64, (k as f64).sin(), 1.0 / 3.0]).collect();
        let surface = Parametric::from_free(knots, &free).unwrap();
        let support = UvSupport::new(vec![[[0.0, 0.0], [0.1, 0.0], [0.0, 0.3]]], [Some(0.7), None]);
        let text = serde_json::to_string(&SavedSurface::of_parametric(&surface, &support)).unwrap();
        let again = serde_json::from_str::<SavedSurface>(&text).unwrap().surface().unwrap();
        assert_eq!(again, AnySurface::Parametric(surface, support));
    }

    #[test]
    fn every_broken_surface_is_refused_with_a_reason() {
        type Change = fn(&mut serde_json::Value);
        let cases: [(Change, &str); 9] = [
            (|v| v["schema"] = "palpate.fit/2".into(), "palpate.fit/1"),
            (|v| v["surface"]["kind"] = "blob".into(), "height"),
            (|v| v["surface"]["kind"] = "parametric".into(), "not those of kind"),
            (|v| v["surface"]["degree"][0] = 12.into(), "knots in x"),
            (|v| v["surface"]["knots"][1][2] = (-1.0).into(), "knots in y"),
            (|v| v["surface"]["coefficients"][1] = serde_json::json!([1.0]), "row 1"),
            (|v| v["surface"]["unsupported"] = serde_json::json!([9]), "coefficient 9 of 9"),
            (|v| v["frame"]["scale"] = 0.0.into(), "scale"),
            (|v| v["surface"] = serde_json::Value::Null, "surface"),
        ];
        for (change, word) in cases {
            let message = document(change).unwrap_err();
            assert!(message.contains(word) && message.starts_with("s.json"), "{message}");
        }
        assert!(read_document_bytes("s.json", b"x,y,z\n").unwrap_err().to_string().contains("--save"));
    }
}
