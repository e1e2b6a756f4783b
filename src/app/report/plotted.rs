//! Charts of plotters as a [`Drawing`], so that they are written as SVG, PNG and PDF like every other picture.
//!
//! ```text
//! line, path -> Line      rectangle, polygon -> Area      circle -> Dots      text -> Word
//! ```
//!
//! A drawing knows no transparency: a colour of strength a becomes what it looks like on white paper.

use plotters::prelude::DrawingBackend;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind, FontTransform};

use super::drawing::{Anchor, Colour, Drawing, width_of};

/// Letters of plotters are so much smaller than their line.
const LINE: f64 = 1.24;

/// A drawing that plotters draws into.
pub(super) struct Plotted<'a>(pub(super) &'a mut Drawing);

type Outcome = Result<(), DrawingErrorKind<std::io::Error>>;

fn on_paper(colour: BackendColor) -> Colour {
    let BackendColor { alpha, rgb: (r, g, b) } = colour;
    [r, g, b].map(|channel| (255.0 + alpha * (f64::from(channel) - 255.0)).round() as u8)
}

fn place((x, y): BackendCoord) -> [f64; 2] {
    [f64::from(x), f64::from(y)]
}

impl DrawingBackend for Plotted<'_> {
    type ErrorType = std::io::Error;

    fn get_size(&self) -> (u32, u32) {
        let [width, height] = self.0.size;
        (width as u32, height as u32)
    }

    fn ensure_prepared(&mut self) -> Outcome {
        Ok(())
    }

    fn present(&mut self) -> Outcome {
        Ok(())
    }

    fn draw_pixel(&mut self, point: BackendCoord, colour: BackendColor) -> Outcome {
        self.0.dots(vec![place(point)], 0.5, on_paper(colour));
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Outcome {
        self.draw_path([from, to], style)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Outcome {
        let points: Vec<[f64; 2]> = path.into_iter().map(place).collect();
        if style.color().alpha > 0.0 {
            self.0.line(&points, f64::from(style.stroke_width()), on_paper(style.color()));
        }
        Ok(())
    }

    fn draw_rect<S: BackendStyle>(&mut self, a: BackendCoord, b: BackendCoord, style: &S, fill: bool) -> Outcome {
        let corners = [a, (b.0, a.1), b, (a.0, b.1)];
        if fill { self.fill_polygon(corners, style) } else { self.draw_path(corners.into_iter().chain([a]), style) }
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Outcome {
        let corners: Vec<[f64; 2]> = corners.into_iter().map(place).collect();
        if style.color().alpha > 0.0 {
            let colour = on_paper(style.color());
            self.0.area(&corners, colour, colour);
        }
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(&mut self, at: BackendCoord, radius: u32, style: &S, _fill: bool) -> Outcome {
        self.0.dots(vec![place(at)], f64::from(radius), on_paper(style.color()));
        Ok(())
    }

    fn draw_text<T: BackendTextStyle>(&mut self, text: &str, style: &T, at: BackendCoord) -> Outcome {
        let size = style.size() / LINE;
        let ([x, y], anchor) = (place(at), style.anchor());
        if matches!(style.transform(), FontTransform::Rotate90 | FontTransform::Rotate270) {
            self.0.upward_word([x + 0.5 * size, y], text, size);
            return Ok(());
        }
        let below = match anchor.v_pos {
            VPos::Top => 0.5 * size,
            VPos::Center => 0.0,
            VPos::Bottom => -0.5 * size,
        };
        let side = match anchor.h_pos {
            HPos::Left => Anchor::Start,
            HPos::Center => Anchor::Middle,
            HPos::Right => Anchor::End,
        };
        self.0.word([x, y + below], text, size, side);
        Ok(())
    }

    fn estimate_text_size<T: BackendTextStyle>(
        &self,
        text: &str,
        style: &T,
    ) -> Result<(u32, u32), DrawingErrorKind<std::io::Error>> {
        let size = style.size() / LINE;
        Ok((width_of(text, size).ceil() as u32, size.ceil() as u32))
    }
}
