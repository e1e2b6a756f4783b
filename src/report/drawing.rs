//! A picture as a list of strokes, areas and words, written as SVG or painted as PNG.
//!
//! ```text
//! Drawing -> write_svg   text, to be scaled           -> write_png (drawing_png.rs)   pixels, for where SVG is not shown
//! ```

use std::fmt::Write as _;
use std::io::Write;

/// Red, green, blue.
pub(super) type Colour = [u8; 3];

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

/// One thing to draw; lengths in pixels from the upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// A line through points.
    Line { points: Vec<[f64; 2]>, width: f64, colour: Colour },
    /// An area within points, with its rim.
    Area { points: Vec<[f64; 2]>, fill: Colour, rim: Colour },
    /// A word whose middle height is at the point.
    Word { at: [f64; 2], text: String, size: f64, anchor: Anchor, upwards: bool },
}

/// What is drawn, from the first to the last.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Drawing {
    /// Pixels.
    pub size: [f64; 2],
    /// In order.
    pub shapes: Vec<Shape>,
}

impl Drawing {
    /// An empty picture.
    pub(super) fn new(width: f64, height: f64) -> Drawing {
        Drawing { size: [width, height], shapes: Vec::new() }
    }

    /// Adds a line.
    pub(super) fn line(&mut self, points: &[[f64; 2]], width: f64, colour: Colour) {
        self.shapes.push(Shape::Line { points: points.to_vec(), width, colour });
    }

    /// Adds an area.
    pub(super) fn area(&mut self, points: &[[f64; 2]], fill: Colour, rim: Colour) {
        self.shapes.push(Shape::Area { points: points.to_vec(), fill, rim });
    }

    /// Adds a word.
    pub(super) fn word(&mut self, at: [f64; 2], text: impl Into<String>, size: f64, anchor: Anchor) {
        self.shapes.push(Shape::Word { at, text: text.into(), size, anchor, upwards: false });
    }

    /// Adds a word that runs upwards.
    pub(super) fn upward_word(&mut self, at: [f64; 2], text: impl Into<String>, size: f64) {
        self.shapes.push(Shape::Word { at, text: text.into(), size, anchor: Anchor::Middle, upwards: true });
    }

    /// As SVG.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn write_svg(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let [width, height] = self.size;
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
        );
        self.shapes.iter().for_each(|shape| svg_shape(shape, &mut text));
        text.push_str("</svg>\n");
        out.write_all(text.as_bytes())
    }
}

/// About how wide a word is in a font without serifs, pixels.
pub(super) fn width_of(text: &str, size: f64) -> f64 {
    0.6 * size * text.chars().count() as f64
}

fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
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
        Shape::Word { at: [x, y], text: word, size, anchor, upwards } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
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

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
