//! A drawing as PNG: areas, lines and letters in proportion to what they cover of a pixel, along four level lines.

use std::io::Write;

use super::drawing::{Anchor, Colour, Drawing, Shape};
use super::glyphs::glyph;
use super::png::Raster;

/// Pixels for every pixel of the drawing: a picture of one column (85 mm, 500 pixels) then has 300 an inch.
const ZOOM: usize = 2;
/// Level lines of a pixel; along them what is covered is exact.
const SAMPLES: usize = 4;
/// Pixels by which the pieces of a line reach beyond their ends.
const OVERLAP: f64 = 0.5;
/// Height of capitals in hundredths of the font size: words stand with its middle at their point.
const CAPITAL: f64 = 73.0;
/// Corners of the polygon that stands for a dot.
const CORNERS: usize = 12;

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
        Raster { width, height, rgb: pixels.rgb }.write_png(out)
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
                self.fill(std::slice::from_ref(&points), *fill);
                points.extend(points.first().copied());
                self.stroke(&points, ZOOM as f64, *rim);
            }
            Shape::Dots { points, radius, colour } => zoomed(points).iter().for_each(|[x, y]| {
                let radius = radius * ZOOM as f64;
                // small dots stand on whole pixels: all alike, they are sharp, and deflate well
                let [x, y] = [x, y].map(|v| if radius < 2.5 { v.floor() + 0.5 } else { *v });
                let corner = |k: usize| {
                    let (sine, cosine) = (std::f64::consts::TAU * k as f64 / CORNERS as f64).sin_cos();
                    [x + radius * cosine, y + radius * sine]
                };
                self.fill(&[(0..CORNERS).map(corner).collect()], *colour);
            }),
            Shape::Image { corner, size, raster } => {
                self.image(corner.map(|v| v * ZOOM as f64), size.map(|v| v * ZOOM as f64), raster);
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
                // pieces overlap by a little, or their seams would shine through
                let [u, v] = [OVERLAP * (c - a) / length, OVERLAP * (d - b) / length];
                let ([a, b], [c, d]) = ([a - u, b - v], [c + u, d + v]);
                self.fill(&[vec![[a + x, b + y], [c + x, d + y], [c - x, d - y], [a - x, b - y]]], colour);
            }
        }
    }

    /// Paints the inside of polygons together (even-odd), pixel by pixel in proportion to what it covers.
    fn fill(&mut self, polygons: &[Vec<[f64; 2]>], colour: Colour) {
        let ends = |k: usize, most: usize| {
            let range = polygons.iter().flatten().map(|p| p[k]);
            let (lo, hi) = range.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
            (lo.floor().max(0.0) as usize, (hi.ceil().max(0.0) as usize).min(most))
        };
        let ((x0, x1), (y0, y1)) = (ends(0, self.width), ends(1, self.height));
        let mut share = vec![0.0; x1.saturating_sub(x0)];
        for y in y0..y1 {
            share.fill(0.0);
            for sample in 0..SAMPLES {
                let height = y as f64 + (sample as f64 + 0.5) / SAMPLES as f64;
                add_row(&crossings(polygons, height), x0, &mut share);
            }
            for (k, share) in share.iter().enumerate().filter(|(_, share)| **share > 0.0) {
                self.blend(x0 + k, y, colour, share.min(1.0));
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
        let point = size / 100.0;
        let width: f64 = text.chars().map(|character| f64::from(glyph(character).0) * point).sum();
        let mut left = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * width,
            Anchor::End => -width,
        };
        for character in text.chars() {
            let (advance, contours) = glyph(character);
            let place = |[x, y]: [i8; 2]| {
                let (u, v) = (left + point * f64::from(x), point * (0.5 * CAPITAL - f64::from(y)));
                if upwards { [at[0] + v, at[1] - u] } else { [at[0] + u, at[1] + v] }
            };
            let outline: Vec<Vec<[f64; 2]>> = contours.iter().map(|c| c.iter().map(|p| place(*p)).collect()).collect();
            self.fill(&outline, [0; 3]);
            left += point * f64::from(advance);
        }
    }

    /// Spreads pixels over a rectangle, linear between their centres.
    fn image(&mut self, corner: [f64; 2], size: [f64; 2], raster: &Raster) {
        let [x0, y0] = corner.map(|v| v.round().max(0.0) as usize);
        let far = |k: usize, most: usize| ((corner[k] + size[k]).round().max(0.0) as usize).min(most);
        let sampled = |t: f64, count: usize| {
            let t = (t * count as f64 - 0.5).clamp(0.0, count as f64 - 1.0);
            (t as usize, (t as usize + 1).min(count - 1), t.fract())
        };
        if raster.width == 0 || raster.height == 0 {
            return;
        }
        for y in y0..far(1, self.height) {
            let (above, below, s) = sampled((y as f64 + 0.5 - corner[1]) / size[1], raster.height);
            for x in x0..far(0, self.width) {
                let (left, right, t) = sampled((x as f64 + 0.5 - corner[0]) / size[0], raster.width);
                let value = |i: usize, j: usize, k: usize| f64::from(raster.rgb[3 * (i * raster.width + j) + k]);
                let row = |i: usize, k: usize| (1.0 - t) * value(i, left, k) + t * value(i, right, k);
                let colour = [0, 1, 2].map(|k| ((1.0 - s) * row(above, k) + s * row(below, k)).round() as u8);
                self.blend(x, y, colour, 1.0);
            }
        }
    }
}

/// Where a level line enters and leaves the polygons, ascending.
fn crossings(polygons: &[Vec<[f64; 2]>], y: f64) -> Vec<f64> {
    let mut crossings = Vec::new();
    for points in polygons {
        let Some(mut last) = points.last() else { continue };
        for point in points {
            let ([ax, ay], [bx, by]) = (*point, *last);
            if (ay > y) != (by > y) {
                crossings.push(ax + (y - ay) / (by - ay) * (bx - ax));
            }
            last = point;
        }
    }
    crossings.sort_by(f64::total_cmp);
    crossings
}

/// Adds what one of [`SAMPLES`] level lines covers of the pixels from `first` on.
fn add_row(crossings: &[f64], first: usize, share: &mut [f64]) {
    for pair in crossings.chunks_exact(2) {
        let [lo, hi] = [pair[0], pair[1]].map(|x| (x - first as f64).clamp(0.0, share.len() as f64));
        let last = (hi.ceil() as usize).min(share.len());
        for (k, share) in share.iter_mut().enumerate().take(last).skip(lo as usize) {
            let covered = hi.min(k as f64 + 1.0) - lo.max(k as f64);
            *share += covered.max(0.0) / SAMPLES as f64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_cover_their_pixels_and_the_file_is_a_png() {
        let mut pixels = Pixels { width: 8, height: 8, rgb: vec![255; 192] };
        pixels.fill(&[vec![[2.0, 2.0], [4.5, 2.0], [4.5, 4.0], [2.0, 4.0]]], [0; 3]);
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
