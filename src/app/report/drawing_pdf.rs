//! A drawing as PDF: one page of the drawing's size, for LaTeX and for journals.
//!
//! ```text
//! 1 catalog   2 pages   3 page   4 contents (deflated)   5 Helvetica   6 ... one image each (deflated)      ISO 32000-1, 7.5
//! unit: COLUMN / width points a pixel, y up
//! ```
//!
//! Written by hand: pdf-writer would replace the objects and their table, forty of these lines, and leave the widths, the
//! encoding and the placing of words. Helvetica is one of the fonts that every reader has (9.6.2.2), so none is embedded;
//! letters beyond Latin-1 become question marks.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::drawing::{Anchor, Colour, Drawing, Shape};
use super::png::Raster;

/// Width of a page, points: one column of a paper, 85 mm.
const COLUMN: f64 = 85.0 / 25.4 * 72.0;
/// Half the height of Helvetica's capitals, in parts of the font size.
const HALF_CAPITAL: f64 = 0.36;
/// Widths of Helvetica's letters from the space to the tilde, thousandths of the font size (Adobe's Helvetica.afm).
#[rustfmt::skip]
const WIDTHS: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278,
    556, 556, 556, 556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556,
    1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833, 722, 778,
    667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556,
    333, 556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556,
    556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584,
];

impl Drawing {
    /// As PDF.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn write_pdf(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let [width, height] = self.size;
        let unit = COLUMN / width.max(1.0);
        let images: Vec<&Raster> = self.shapes.iter().filter_map(image).collect();
        let names: String = (0..images.len()).map(|k| format!("/I{k} {} 0 R ", 6 + k)).collect();
        let page = format!(
            "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.2} {:.2}] /Contents 4 0 R \
             /Resources << /Font << /F 5 0 R >> /XObject << {names}>> >> >>",
            unit * width,
            unit * height
        );
        let mut objects = vec![
            b"<< /Type /Catalog /Pages 2 0 R >>".to_vec(),
            b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>".to_vec(),
            page.into_bytes(),
            stream("", &self.contents(unit))?,
            b"<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>".to_vec(),
        ];
        for raster in images {
            let head = format!(
                "/Type /XObject /Subtype /Image /Width {} /Height {} /ColorSpace /DeviceRGB /BitsPerComponent 8 \
                 /Interpolate true ",
                raster.width, raster.height
            );
            objects.push(stream(&head, &raster.rgb)?);
        }
        write_objects(&objects, out)
    }

    /// What is drawn, in the words of a content stream.
    fn contents(&self, unit: f64) -> Vec<u8> {
        // pixels from the upper left corner to points from the lower left one; words are turned back
        let mut text = format!("{unit:.5} 0 0 {:.5} 0 {:.3} cm 1 j\n", -unit, unit * self.size[1]).into_bytes();
        let mut images = 0;
        for shape in &self.shapes {
            match shape {
                Shape::Image { corner: [x, y], size: [width, height], .. } => {
                    let place =
                        format!("q {width:.2} 0 0 {:.2} {x:.2} {:.2} cm /I{images} Do Q\n", -height, y + height);
                    text.extend(place.bytes());
                    images += 1;
                }
                Shape::Word { at, text: word, size, anchor, upwards } => {
                    text.extend(word_text(*at, word, *size, *anchor, *upwards));
                }
                Shape::Line { points, width, colour } => {
                    text.extend(format!("0 J {width} w {} RG {}S\n", rgb(*colour), path(points)).bytes());
                }
                Shape::Area { points, fill, rim } => {
                    text.extend(format!("1 w {} rg {} RG {}b\n", rgb(*fill), rgb(*rim), path(points)).bytes());
                }
                Shape::Dots { points, radius, colour } => {
                    let dots: String =
                        points.iter().map(|[x, y]| format!("{x:.1} {y:.1} m {x:.1} {y:.1} l ")).collect();
                    text.extend(format!("1 J {} w {} RG {dots}S\n", 2.0 * radius, rgb(*colour)).bytes());
                }
            }
        }
        text
    }
}

fn image(shape: &Shape) -> Option<&Raster> {
    match shape {
        Shape::Image { raster, .. } => Some(raster),
        _ => None,
    }
}

fn rgb(colour: Colour) -> String {
    let [r, g, b] = colour.map(|v| f64::from(v) / 255.0);
    format!("{r:.3} {g:.3} {b:.3}")
}

fn path(points: &[[f64; 2]]) -> String {
    let word = |k: usize| if k == 0 { "m" } else { "l" };
    points.iter().enumerate().map(|(k, [x, y])| format!("{x:.2} {y:.2} {} ", word(k))).collect()
}

/// Letters in WinAnsiEncoding, which is Latin-1 where it has letters.
fn encoded(text: &str) -> Vec<u8> {
    let byte = |c: char| u8::try_from(c).ok().filter(|b| (32..127).contains(b) || *b >= 160).unwrap_or(b'?');
    text.chars().map(byte).collect()
}

fn word_text([x, y]: [f64; 2], word: &str, size: f64, anchor: Anchor, upwards: bool) -> Vec<u8> {
    let letters = encoded(word);
    let of = |b: &u8| WIDTHS.get(usize::from(*b).wrapping_sub(32)).copied().unwrap_or(556);
    let width = size / 1000.0 * letters.iter().map(|b| f64::from(of(b))).sum::<f64>();
    let back = match anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => 0.5 * width,
        Anchor::End => width,
    };
    let down = HALF_CAPITAL * size;
    let place = if upwards {
        format!("0 -1 -1 0 {:.2} {:.2}", x + down, y + back)
    } else {
        format!("1 0 0 -1 {:.2} {:.2}", x - back, y + down)
    };
    let mut text = format!("BT 0 g /F {size} Tf {place} Tm (").into_bytes();
    for byte in letters {
        if matches!(byte, b'(' | b')' | b'\\') {
            text.push(b'\\');
        }
        text.push(byte);
    }
    text.extend_from_slice(b") Tj ET\n");
    text
}

/// A stream object: what stands in its dictionary, and its bytes, which are deflated here.
fn stream(head: &str, bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut deflated = ZlibEncoder::new(Vec::new(), Compression::best());
    deflated.write_all(bytes)?;
    let deflated = deflated.finish()?;
    let mut object = format!("<< {head}/Filter /FlateDecode /Length {} >>\nstream\n", deflated.len()).into_bytes();
    object.extend(deflated);
    object.extend_from_slice(b"\nendstream");
    Ok(object)
}

/// Header, objects, the table of their places, trailer.
fn write_objects(objects: &[Vec<u8>], out: &mut dyn Write) -> std::io::Result<()> {
    // the second line tells programs that copy files that this one is binary
    let mut file = b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n".to_vec();
    let mut table = format!("xref\n0 {}\n0000000000 65535 f \n", objects.len() + 1);
    for (k, object) in objects.iter().enumerate() {
        table.push_str(&format!("{:010} 00000 n \n", file.len()));
        file.extend(format!("{} 0 obj\n", k + 1).bytes());
        file.extend_from_slice(object);
        file.extend_from_slice(b"\nendobj\n");
    }
    let place = file.len();
    file.extend(table.bytes());
    let count = objects.len() + 1;
    file.extend(format!("trailer\n<< /Size {count} /Root 1 0 R >>\nstartxref\n{place}\n%%EOF\n").bytes());
    out.write_all(&file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_object_stands_where_the_table_says() {
        let mut drawing = Drawing::new(100.0, 50.0);
        drawing.word([50.0, 25.0], "a (b) \\ \u{1b}[31m<é>&漢", 10.0, Anchor::Middle);
        drawing.image([0.0, 0.0], [10.0, 10.0], Raster { width: 1, height: 1, rgb: vec![1, 2, 3] });
        drawing.dots(vec![[5.0, 5.0]], 2.0, [255, 0, 0]);
        let mut bytes = Vec::new();
        drawing.write_pdf(&mut bytes).unwrap();
        let text = String::from_utf8_lossy(&drawing.contents(1.0)).into_owned();
        assert!(text.contains(r"(a \(b\) \\ ?[31m<") && !text.contains('\u{1b}'), "{text}");
        let lossy: String = bytes.iter().map(|b| char::from(*b)).collect();
        let place: usize = lossy.lines().rev().nth(1).unwrap().parse().unwrap();
        let table: String = bytes[place..].iter().map(|b| char::from(*b)).collect();
        let table: Vec<&str> = table.lines().collect();
        assert_eq!(table[..2], ["xref", "0 7"]);
        for k in 1..7 {
            let at: usize = table[k + 2][..10].parse().unwrap();
            assert!(bytes[at..].starts_with(format!("{k} 0 obj").as_bytes()));
        }
    }
}
