//! A picture as a list of strokes, areas, dots, words and rasters, written as SVG or PDF or painted as PNG.
//!
//! ```text
//! Drawing -> write_svg   text, to be scaled           -> write_png (drawing_png.rs)   pixels, for where SVG is not shown
//!                                                     -> write_pdf (drawing_pdf.rs)   a page of its own size, for papers
//!                                                     -> inline    (page/inline.rs)   a part of the report page, with its hooks
//! ```

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write;

use super::colour::hex;
use super::png::Raster;

pub(super) use super::colour::Colour;

/// Where a word stands relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

impl Anchor {
    /// As SVG has it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        }
    }
}

/// One thing to draw; lengths in pixels from the upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// A line through points.
    Line { points: Vec<[f64; 2]>, width: f64, colour: Colour },
    /// An area within points, with its rim.
    Area { points: Vec<[f64; 2]>, fill: Colour, rim: Colour },
    /// Round dots of one radius.
    Dots { points: Vec<[f64; 2]>, radius: f64, colour: Colour },
    /// Pixels spread over a rectangle, smooth between them.
    Image { corner: [f64; 2], size: [f64; 2], raster: Raster },
    /// A word whose middle height is at the point.
    Word { at: [f64; 2], text: String, size: f64, anchor: Anchor, upwards: bool },
}

/// What the page makes of a shape; files leave it out.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Hook {
    /// Its class in the page's style sheet, which knows the colours of light and dark.
    pub class: String,
    /// What it says when it is pointed at.
    pub words: Option<String>,
    /// Whether the shape's own colour holds on the page too.
    pub own_colour: bool,
    /// Whether it is left out there.
    pub file_only: bool,
}

/// What is drawn, from the first to the last.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Drawing {
    /// Pixels.
    pub size: [f64; 2],
    /// Pixels of a screen for every pixel of the drawing.
    pub on_screen: f64,
    /// In order.
    pub shapes: Vec<Shape>,
    /// What the page makes of shapes, by their number.
    pub hooks: BTreeMap<usize, Hook>,
}

impl Drawing {
    /// An empty picture.
    pub(super) fn new(width: f64, height: f64) -> Drawing {
        Drawing { size: [width, height], on_screen: 1.0, ..Drawing::default() }
    }

    /// Adds a line.
    pub(super) fn line(&mut self, points: &[[f64; 2]], width: f64, colour: Colour) {
        self.shapes.push(Shape::Line { points: points.to_vec(), width, colour });
    }

    /// Adds an area.
    pub(super) fn area(&mut self, points: &[[f64; 2]], fill: Colour, rim: Colour) {
        self.shapes.push(Shape::Area { points: points.to_vec(), fill, rim });
    }

    /// Adds dots.
    pub(super) fn dots(&mut self, points: Vec<[f64; 2]>, radius: f64, colour: Colour) {
        self.shapes.push(Shape::Dots { points, radius, colour });
    }

    /// Adds pixels.
    pub(super) fn image(&mut self, corner: [f64; 2], size: [f64; 2], raster: Raster) {
        self.shapes.push(Shape::Image { corner, size, raster });
    }

    /// Adds a word.
    pub(super) fn word(&mut self, at: [f64; 2], text: impl Into<String>, size: f64, anchor: Anchor) {
        self.shapes.push(Shape::Word { at, text: text.into(), size, anchor, upwards: false });
    }

    /// Adds a word that runs upwards.
    pub(super) fn upward_word(&mut self, at: [f64; 2], text: impl Into<String>, size: f64) {
        self.shapes.push(Shape::Word { at, text: text.into(), size, anchor: Anchor::Middle, upwards: true });
    }

    /// Gives the last shape a class on the page.
    pub(super) fn on_page(&mut self, class: &str) {
        self.hook(Hook { class: class.into(), ..Hook::default() });
    }

    /// Gives the last shape a hook.
    pub(super) fn hook(&mut self, hook: Hook) {
        self.hooks.insert(self.shapes.len().saturating_sub(1), hook);
    }

    /// As SVG.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn write_svg(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let [width, height] = self.size;
        let [shown_width, shown_height] = self.size.map(|side| self.on_screen * side);
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{shown_width}\" height=\"{shown_height}\" \
             viewBox=\"0 0 {width} {height}\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
        );
        for shape in &self.shapes {
            svg_shape(shape, &mut text);
        }
        text.push_str("</svg>\n");
        out.write_all(text.as_bytes())
    }
}

/// About how wide a word is in a font without serifs, pixels.
pub(super) fn width_of(text: &str, size: f64) -> f64 {
    0.6 * size * text.chars().count() as f64
}

fn svg_shape(shape: &Shape, text: &mut String) {
    let list =
        |points: &[[f64; 2]]| points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect::<Vec<String>>().join(" ");
    // writing to a string cannot fail
    let _ = match shape {
        Shape::Line { points, width, colour } => writeln!(
            text,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"/>",
            list(points),
            hex(*colour)
        ),
        Shape::Area { points, fill, rim } => {
            writeln!(text, "<polygon points=\"{}\" fill=\"{}\" stroke=\"{}\"/>", list(points), hex(*fill), hex(*rim))
        }
        Shape::Dots { points, radius, colour } => text.write_str(&svg_dots(points, *radius, *colour)),
        Shape::Image { corner, size, raster } => text.write_str(&svg_image(*corner, *size, raster)),
        Shape::Word { at: [x, y], text: word, size, anchor, upwards } => {
            let anchor = anchor.name();
            let turned = if *upwards { format!(" transform=\"rotate(-90 {x:.1} {y:.1})\"") } else { String::new() };
            writeln!(
                text,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" font-family=\"sans-serif\" font-size=\"{size}\" text-anchor=\"{anchor}\" \
                 dominant-baseline=\"central\"{turned}>{}</text>",
                escaped(word)
            )
        }
    };
}

fn svg_dots(points: &[[f64; 2]], radius: f64, colour: Colour) -> String {
    // a line of no length has round ends
    let dots: String = points.iter().map(|[x, y]| format!("M{x:.1} {y:.1}h0")).collect();
    format!(
        "<path d=\"{dots}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\"/>\n",
        hex(colour),
        2.0 * radius
    )
}

fn svg_image([x, y]: [f64; 2], [width, height]: [f64; 2], raster: &Raster) -> String {
    format!(
        "<image x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" preserveAspectRatio=\"none\" \
         href=\"{}\"/>\n",
        raster.data_url()
    )
}

/// Text as XML has it; what XML cannot hold is shown as U+FFFD.
fn escaped(text: &str) -> String {
    let held = |c: char| if c.is_control() || ('\u{fffe}'..='\u{ffff}').contains(&c) { '\u{fffd}' } else { c };
    let text: String = text.chars().map(held).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
