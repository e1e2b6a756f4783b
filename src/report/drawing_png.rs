//! A drawing as PNG: areas and lines by coverage of four samples a pixel each way, words in letters of 5 x 7 points.
//!
//! ```text
//! signature, IHDR (8 bits, RGB), IDAT (rows without filter, deflated), IEND        W3C PNG, second edition
//! ```

use std::io::Write;

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};

use super::drawing::{Anchor, Colour, Drawing, Shape};
use super::letters::letter;

/// Pixels for every pixel of the drawing, so that small letters stay readable.
const ZOOM: usize = 2;
/// Samples of a pixel each way.
const SAMPLES: usize = 4;
/// Columns from one letter to the next, and rows of a line.
const ADVANCE: f64 = 6.0;
const ROWS: f64 = 7.0;

struct Pixels {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Drawing {
    /// As PNG.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn write_png(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let [width, height] = self.size.map(|side| side as usize * ZOOM);
        let mut pixels = Pixels { width, height, rgb: vec![255; 3 * width * height] };
        self.shapes.iter().for_each(|shape| pixels.paint(shape));
        pixels.write(out)
    }
}

impl Pixels {
    fn paint(&mut self, shape: &Shape) {
        let zoomed =
            |points: &[[f64; 2]]| -> Vec<[f64; 2]> { points.iter().map(|p| p.map(|v| v * ZOOM as f64)).collect() };
        match shape {
            Shape::Line { points, width, colour } => self.stroke(&zoomed(points), width * ZOOM as f64, *colour),
            Shape::Area { points, fill, rim } => {
                let mut points = zoomed(points);
                self.fill(&points, *fill);
                points.extend(points.first().copied());
                self.stroke(&points, ZOOM as f64, *rim);
            }
            Shape::Word { at, text, size, anchor, upwards } => {
                self.word(at.map(|v| v * ZOOM as f64), text, size * ZOOM as f64, *anchor, *upwards);
            }
        }
    }

    /// Every piece of the line as a rectangle.
    fn stroke(&mut self, points: &[[f64; 2]], width: f64, colour: Colour) {
        for pair in points.windows(2) {
            let ([a, b], [c, d]) = (pair[0], pair[1]);
            let length = (c - a).hypot(d - b);
            if length > 0.0 {
                let (x, y) = (0.5 * width * (b - d) / length, 0.5 * width * (c - a) / length);
                self.fill(&[[a + x, b + y], [c + x, d + y], [c - x, d - y], [a - x, b - y]], colour);
            }
        }
    }

    /// Paints the inside of a polygon (even-odd), pixel by pixel in proportion to what it covers.
    fn fill(&mut self, points: &[[f64; 2]], colour: Colour) {
        let ends = |k: usize, most: usize| {
            let range = points.iter().map(|p| p[k]);
            let (lo, hi) = range.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
            (lo.floor().max(0.0) as usize, (hi.ceil().max(0.0) as usize).min(most))
        };
        let ((x0, x1), (y0, y1)) = (ends(0, self.width), ends(1, self.height));
        for y in y0..y1 {
            for x in x0..x1 {
                let inside = (0..SAMPLES * SAMPLES).filter(|sample| {
                    let place = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
                    holds(points, x as f64 + place(sample % SAMPLES), y as f64 + place(sample / SAMPLES))
                });
                let share = inside.count() as f64 / (SAMPLES * SAMPLES) as f64;
                self.blend(x, y, colour, share);
            }
        }
    }

    fn blend(&mut self, x: usize, y: usize, colour: Colour, share: f64) {
        let at = 3 * (y * self.width + x);
        for (own, new) in self.rgb[at..at + 3].iter_mut().zip(colour) {
            *own = (f64::from(*own) + share * (f64::from(new) - f64::from(*own))).round() as u8;
        }
    }

    fn word(&mut self, at: [f64; 2], text: &str, size: f64, anchor: Anchor, upwards: bool) {
        // a letter of 7 rows stands for the capitals of the font, seven tenths of its size
        let dot = (0.7 * size / ROWS).max(1.0);
        let width = dot * ADVANCE * text.chars().count() as f64;
        let left = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * width,
            Anchor::End => -width,
        };
        for (k, character) in text.chars().enumerate() {
            for (column, bits) in letter(character).iter().enumerate() {
                for row in (0..8).filter(|row| bits >> row & 1 == 1) {
                    let u = left + dot * (ADVANCE * k as f64 + column as f64);
                    let v = dot * (f64::from(row) - 0.5 * ROWS);
                    let corner = |u: f64, v: f64| {
                        if upwards { [at[0] + v, at[1] - u] } else { [at[0] + u, at[1] + v] }
                    };
                    let square = [corner(u, v), corner(u + dot, v), corner(u + dot, v + dot), corner(u, v + dot)];
                    self.fill(&square, [0; 3]);
                }
            }
        }
    }

    fn write(&self, out: &mut dyn Write) -> std::io::Result<()> {
        out.write_all(b"\x89PNG\r\n\x1a\n")?;
        let mut head = Vec::new();
        head.extend_from_slice(&(self.width as u32).to_be_bytes());
        head.extend_from_slice(&(self.height as u32).to_be_bytes());
        // 8 bits, RGB, the only compression and filter there are, not interlaced
        head.extend_from_slice(&[8, 2, 0, 0, 0]);
        chunk(b"IHDR", &head, out)?;
        let mut deflated = ZlibEncoder::new(Vec::new(), Compression::default());
        for row in self.rgb.chunks_exact(3 * self.width.max(1)) {
            deflated.write_all(&[0])?;
            deflated.write_all(row)?;
        }
        chunk(b"IDAT", &deflated.finish()?, out)?;
        chunk(b"IEND", &[], out)
    }
}

fn chunk(name: &[u8; 4], content: &[u8], out: &mut dyn Write) -> std::io::Result<()> {
    let mut crc = Crc::new();
    crc.update(name);
    crc.update(content);
    out.write_all(&(content.len() as u32).to_be_bytes())?;
    out.write_all(name)?;
    out.write_all(content)?;
    out.write_all(&crc.sum().to_be_bytes())
}

/// Whether a point lies inside, by how often a ray to the right meets the rim.
fn holds(points: &[[f64; 2]], x: f64, y: f64) -> bool {
    let mut inside = false;
    let mut last = points.len().wrapping_sub(1);
    for k in 0..points.len() {
        let ([ax, ay], [bx, by]) = (points[k], points[last]);
        if (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax) {
            inside = !inside;
        }
        last = k;
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_cover_their_pixels_and_the_file_is_a_png() {
        let mut pixels = Pixels { width: 8, height: 8, rgb: vec![255; 192] };
        pixels.fill(&[[2.0, 2.0], [4.5, 2.0], [4.5, 4.0], [2.0, 4.0]], [0; 3]);
        let at = |x: usize, y: usize| pixels.rgb[3 * (8 * y + x)];
        assert_eq!((at(2, 2), at(3, 3), at(5, 3), at(1, 2)), (0, 0, 255, 255));
        assert!(at(4, 3).abs_diff(128) < 2);
        let mut drawing = Drawing::new(40.0, 20.0);
        drawing.word([20.0, 10.0], "S, R", 10.0, Anchor::Middle);
        let mut bytes = Vec::new();
        drawing.write_png(&mut bytes).unwrap();
        assert!(bytes.starts_with(b"\x89PNG") && bytes.ends_with(&[0xae, 0x42, 0x60, 0x82]));
    }
}
