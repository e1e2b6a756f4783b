//! Options that several verbs share, and how they change a fit's options.

use std::path::PathBuf;

use clap::Args;

use palpate_fitting::fit::{FitOptions, FrameChoice, Method, Objective, Robust, Smooth, SurfaceKind};
use palpate_geometry::contact::Orientation;

use super::failure::Failure;
use super::gathered::Gathered;
use crate::io::Input;
use crate::report::{Answer, PictureFormat};

use super::values;

/// How the surface is fitted; the same words as in a scene's `[fit]`.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Fit")]
pub(super) struct FitFlags {
    /// Kind of surface: height, parametric or auto
    ///
    /// height: z over x, y; parametric: a map into space, which can go round a body; auto: whichever the contacts call for
    #[arg(long, value_name = "KIND")]
    surface: Option<SurfaceKind>,
    /// Directions in which a parametric surface closes on itself: u (across the fingers), v (along them) or u,v
    #[arg(long, hide_short_help = true, value_name = "U,V", value_parser = values::closed)]
    closed: Option<[bool; 2]>,
    /// Degree of the splines in x and y, 1 to 9 [default: 2; of a parametric surface 3]
    #[arg(long, value_name = "P[,Q]", value_parser = values::degrees)]
    degree: Option<[usize; 2]>,
    /// Uniform segments in x and y [default: 1]
    #[arg(long, value_name = "N[,M]", value_parser = values::segments)]
    segments: Option<[usize; 2]>,
    /// Domain of the surface [default: the contacts' bounding box]
    #[arg(long, hide_short_help = true, value_name = "X0,X1,Y0,Y1", allow_hyphen_values = true, value_parser = values::domain)]
    domain: Option<[f64; 4]>,
    /// Slope rows: auto, tangent, position, equal or WZ,WX,WY
    ///
    /// Weights multiply the residuals of heights and of slopes in x and y
    #[arg(long, value_name = "WEIGHTS", allow_hyphen_values = true, conflicts_with = "sigma", value_parser = values::weights)]
    weights: Option<Objective>,
    /// Normal rows: auto, or sd of z and of normals in degrees, as 0.02,5
    #[arg(long, value_name = "Z,DEG", allow_hyphen_values = true, value_parser = values::sigma)]
    sigma: Option<Objective>,
    /// Known sd of the contacts' errors in x and in y, as of an arm; in the unit of the input, and beside any other option
    #[arg(long, hide_short_help = true, value_name = "LENGTH", allow_hyphen_values = true, value_parser = values::sigma_xy)]
    sigma_xy: Option<f64>,
    #[arg(long, hide_short_help = true, help = help("How the least squares problem is solved", Method::WORDS))]
    method: Option<Method>,
    /// Roughness penalty: none, auto, LAMBDA, third=LAMBDA or third=LAMBDA,ASPECT
    #[arg(long, hide_short_help = true, value_name = "LAMBDA", allow_hyphen_values = true)]
    smooth: Option<Smooth>,
    #[arg(long, hide_short_help = true, value_name = "LOSS", help = help("What large residuals count", Robust::WORDS))]
    robust: Option<Robust>,
    #[command(flatten)]
    grid: GridFlags,
    /// Axes of the patch: keep the input's, or auto from the mean normal where needed
    #[arg(long, hide_short_help = true, value_name = "FRAME")]
    frame: Option<FrameChoice>,
}

/// Where S and R are taken.
#[derive(Args, Clone, Debug, Default)]
pub(super) struct GridFlags {
    /// Points of the shape grid in x and y [default: 8x8]
    #[arg(long, value_name = "NxM", value_parser = values::grid_points)]
    grid: Option<[usize; 2]>,
    /// Fraction of each side cut at every edge of the shape grid [default: 0]
    #[arg(long, hide_short_help = true, value_name = "FRACTION", allow_hyphen_values = true, value_parser = values::inset)]
    inset: Option<f64>,
}

impl GridFlags {
    /// Something was typed.
    pub(super) fn any(&self) -> bool {
        self.grid.is_some() || self.inset.is_some()
    }

    /// Points each way, where they were typed.
    pub(super) fn points(&self) -> Option<[usize; 2]> {
        self.grid
    }

    pub(super) fn apply(&self, options: &mut FitOptions) {
        set(&mut options.grid, self.grid);
        set(&mut options.inset, self.inset);
    }
}

impl FitFlags {
    /// Whether anything was typed that changes the surface, so that nothing is chosen. Another loss, grid or inset and other axes
    /// change none.
    pub(super) fn names_a_model(&self) -> bool {
        self.surface.is_some()
            || self.closed.is_some()
            || self.degree.is_some()
            || self.segments.is_some()
            || self.domain.is_some()
            || self.weights.is_some()
            || self.sigma.is_some()
            || self.method.is_some()
            || self.smooth.is_some()
    }

    /// Degrees, where they were typed.
    pub(super) fn typed_degree(&self) -> Option<[usize; 2]> {
        self.degree
    }

    /// Axes of the patch's own were asked for.
    pub(super) fn asks_own_axes(&self) -> bool {
        self.frame == Some(FrameChoice::Auto)
    }

    /// Points of the shape grid, where they were typed.
    pub(super) fn typed_grid(&self) -> Option<[usize; 2]> {
        self.grid.points()
    }

    /// What was typed and means nothing for the kind of surface that was fitted.
    pub(super) fn without_effect(&self, answer: &Answer, input: &Input) -> Vec<String> {
        let gridded = matches!(input, Input::Grid(_));
        let heights = "an input of heights alone, without a roughness penalty";
        let unsmoothed = matches!(self.smooth, None | Some(Smooth::None));
        let parametric = answer.is_parametric();
        let in_space = "a parametric surface";
        let on_grid = "a grid, which keeps its axes";
        let typed = [
            (parametric && self.method.is_some(), "--method", in_space),
            (parametric && self.domain.is_some(), "--domain", in_space),
            (parametric && self.smooth.is_some(), "--smooth", in_space),
            (parametric && self.frame.is_some(), "--frame", in_space),
            (parametric && self.sigma_xy.is_some(), "--sigma-xy", in_space),
            (gridded && self.frame.is_some(), "--frame", on_grid),
            (unsmoothed && is_of_heights(input) && self.weights.is_some(), "--weights", heights),
        ];
        let empty = typed.iter().filter(|(is, _, _)| *is);
        empty.map(|(_, option, what)| format!("{option} has no effect on {what}")).collect()
    }

    /// The options with everything that was typed put in.
    pub(super) fn over(&self, mut options: FitOptions) -> FitOptions {
        set(&mut options.surface, self.surface);
        set(&mut options.closed, self.closed);
        if self.surface == Some(SurfaceKind::Parametric) && self.degree.is_none() {
            // a biquadratic bends too little to go round
            options.degree = options.degree.map(|p| p.max(3));
        }
        set(&mut options.degree, self.degree);
        if let Some(segments) = self.segments {
            options.segments = segments;
            options.knots = None;
        }
        options.domain = self.domain.or(options.domain);
        set(&mut options.objective, self.weights.or(self.sigma));
        set(&mut options.method, self.method);
        set(&mut options.smooth, self.smooth);
        set(&mut options.robust, self.robust);
        set(&mut options.sigma_xy, self.sigma_xy);
        self.grid.apply(&mut options);
        options.frame = self.frame.or(options.frame);
        options
    }
}

/// Neither normals nor slopes.
fn is_of_heights(input: &Input) -> bool {
    match input {
        Input::Contacts(contacts) => contacts.orientation == Orientation::None,
        Input::Grid(grid) => grid.zx.is_none() && grid.zy.is_none(),
    }
}

/// What an option is for, and its words.
fn help<T>(what: &str, words: &[(&str, T)]) -> String {
    let words: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
    format!("{what}: {}", words.join(", "))
}

fn set<T>(place: &mut T, value: Option<T>) {
    if let Some(value) = value {
        *place = value;
    }
}

/// What comes out, and where.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Output")]
pub(super) struct OutputFlags {
    /// Print one JSON document and nothing else
    #[arg(long)]
    pub(super) json: bool,
    /// Write pictures, tables and records into this directory
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// What goes into the directory, until it is published.
    #[arg(skip)]
    pub(super) gathered: Gathered,
    /// No tables for people and no progress
    #[arg(long, short)]
    pub(super) quiet: bool,
}

/// What people read and see, and in which unit.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Output")]
pub(super) struct WordsFlags {
    /// Add the technical lines
    ///
    /// They say how the surface was found, and how far to trust the arithmetic
    #[arg(long, short)]
    pub(super) verbose: bool,
    /// Unit of the lengths in the input, such as mm
    ///
    /// It is said beside every length, and nothing is converted. A unit that stands in the names of a table's columns needs no option
    #[arg(long, value_parser = values::unit)]
    pub(super) unit: Option<String>,
    #[command(flatten)]
    pub(super) pictures: PictureFlags,
}

/// Kinds of pictures.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Output")]
pub(super) struct PictureFlags {
    /// Kinds of pictures in the directory of --out, several as svg,png,pdf [default: svg]
    #[arg(long = "pictures", hide_short_help = true, value_name = "KIND,..", value_delimiter = ',', value_parser = values::picture_format, requires = "out")]
    asked: Vec<PictureFormat>,
}

impl PictureFlags {
    /// Kinds were typed.
    pub(super) fn any(&self) -> bool {
        !self.asked.is_empty()
    }

    /// Writes the picture of this name in every kind that was asked for, SVG where none was.
    pub(super) fn write(
        &self,
        output: &OutputFlags,
        name: &str,
        picture: &dyn Fn(PictureFormat, &mut dyn std::io::Write) -> std::io::Result<()>,
    ) -> Result<(), Failure> {
        let formats = if self.asked.is_empty() { &[PictureFormat::Svg][..] } else { &self.asked };
        formats
            .iter()
            .enumerate()
            // a kind that is named twice is written once
            .filter(|(k, format)| !formats[..*k].contains(format))
            .try_for_each(|(_, format)| {
                output.file(&format!("{name}.{}", format.name()), &mut |out| picture(*format, out))
            })
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use palpate_fitting::fit::{NormalSigma, SlopeWeights};

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        fit: FitFlags,
    }

    fn typed(line: &[&str]) -> Result<FitOptions, String> {
        let line = std::iter::once("palpate").chain(line.iter().copied());
        Line::try_parse_from(line).map(|l| l.fit.over(FitOptions::default())).map_err(|e| e.to_string())
    }

    #[test]
    fn nothing_typed_changes_nothing() {
        assert_eq!(typed(&[]), Ok(FitOptions::default()));
    }

    #[test]
    fn every_option_reaches_the_fit() {
        let line = "--degree 2,3 --segments 4x5 --domain -1,1,-2,2 --sigma 1,15 --method qr --smooth 1e-6 \
                    --robust huber --sigma-xy 0.3 --grid 6x7 --inset 0.25 --frame auto";
        let options = typed(&line.split_whitespace().collect::<Vec<_>>()).unwrap();
        let expected = FitOptions {
            degree: [2, 3],
            segments: [4, 5],
            domain: Some([-1.0, 1.0, -2.0, 2.0]),
            objective: Objective::Normals(NormalSigma::Known { z: 1.0, normal_deg: 15.0 }),
            method: Method::Qr,
            smooth: Smooth::Lambda(1e-6),
            robust: Robust::Huber,
            sigma_xy: 0.3,
            grid: [6, 7],
            inset: 0.25,
            frame: Some(FrameChoice::Auto),
            ..FitOptions::default()
        };
        assert_eq!(options, expected);
        let space = typed(&["--surface", "parametric", "--closed", "u"]).unwrap();
        assert_eq!((space.surface, space.closed, space.degree), (SurfaceKind::Parametric, [true, false], [3, 3]));
        assert_eq!(typed(&["--surface", "parametric", "--degree", "2"]).unwrap().degree, [2, 2]);
        let weights = typed(&["--weights", "position"]).unwrap();
        assert_eq!(weights.objective, Objective::Slopes(SlopeWeights::Position));
    }

    #[test]
    fn both_objectives_are_refused_and_messages_name_the_option() {
        assert!(typed(&["--weights", "auto", "--sigma", "auto"]).unwrap_err().contains("--sigma"));
        let message = typed(&["--degree", "12"]).unwrap_err();
        assert!(message.contains("--degree") && message.contains("1 to 9"), "{message}");
    }
}
