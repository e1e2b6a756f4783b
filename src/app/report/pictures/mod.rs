//! Pictures of one surface for papers: maps, a section, the surface in perspective; each as SVG, PNG or PDF.
//!
//! ```text
//! SurfaceView -> Drawing -> shape.svg, section.pdf, perspective.png ...        one column wide (85 mm), below 200 kB each
//! ```
//!
//! They draw what the report page draws, so that both show the same numbers.

mod contour;
mod dots;
mod perspective;
mod scale;
mod section;
mod shape;

use std::io::Write;

use super::description::{Description, headline, shown_view};
use super::document::FitDocument;
use super::drawing::Drawing;
use super::surface_view::SurfaceView;

pub(super) use scale::{LARGE, fitting, foot, number_bar, picture, shape_bar, short};

/// How a picture is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureFormat {
    /// To be scaled, for pages and for drawing programs.
    Svg,
    /// Pixels, 300 an inch at 85 mm.
    Png,
    /// For LaTeX and journals.
    Pdf,
}

impl PictureFormat {
    /// All of them.
    pub(crate) const ALL: [PictureFormat; 3] = [PictureFormat::Svg, PictureFormat::Png, PictureFormat::Pdf];

    /// How the names of its files end.
    pub(crate) fn name(self) -> &'static str {
        match self {
            PictureFormat::Svg => "svg",
            PictureFormat::Png => "png",
            PictureFormat::Pdf => "pdf",
        }
    }
}

/// What is drawn of a surface.
pub(crate) struct SurfacePictures {
    view: SurfaceView,
    title: String,
    unit: Option<String>,
    /// Angle of the direction across which the surface bends most, from +x towards +y, degrees.
    across_deg: Option<f64>,
}

impl SurfacePictures {
    /// Names of the pictures.
    pub(crate) const NAMES: [&'static str; 3] = ["shape", "section", "perspective"];

    /// Of a described surface; `name` begins the titles.
    pub(crate) fn new(description: &Description, document: &FitDocument, name: &str) -> SurfacePictures {
        let part = &document.shape;
        SurfacePictures {
            view: shown_view(description),
            title: headline(name, document),
            unit: document.unit.clone(),
            // where several shapes stand side by side, the axis in the middle is that of no shape
            across_deg: part
                .axis_deg
                .map(|axis| (axis + 90.0) % 180.0)
                .or(part.direction_deg)
                .filter(|_| part.class_by_area.is_none()),
        }
    }

    /// Writes the picture of this name.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn write(&self, name: &str, format: PictureFormat, out: &mut dyn Write) -> std::io::Result<()> {
        let unit = self.unit.as_deref();
        let drawing = match name {
            "section" => section::section(&self.view, &self.title, unit, self.across_deg),
            "perspective" => perspective::perspective(&self.view, &self.title, unit),
            _ => shape::shape(&self.view, &self.title, unit),
        };
        write_drawing(&drawing, format, out)
    }
}

/// Writes a drawing in this format.
///
/// # Errors
/// What the system says.
pub(super) fn write_drawing(drawing: &Drawing, format: PictureFormat, out: &mut dyn Write) -> std::io::Result<()> {
    match format {
        PictureFormat::Svg => drawing.write_svg(out),
        PictureFormat::Png => drawing.write_png(out),
        PictureFormat::Pdf => drawing.write_pdf(out),
    }
}

#[cfg(test)]
mod tests;
