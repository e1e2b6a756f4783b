//! `frontier.svg`, `solver.svg`, `interval.svg` and the same as PNG: error against time and against instructions.

use std::io::Write;

use super::charts::{FrontierFigure, FrontierKind, INSTRUCTIONS, LINE, TIME};
use super::drawing::{Anchor, Drawing};
use super::frontier::FrontierDocument;

const PANEL: [f64; 2] = [560.0, 400.0];

/// Draws one frontier as SVG or, with `png`, as PNG; nothing where it has no points.
///
/// # Errors
/// What the system says.
pub(crate) fn write_frontier_picture(
    document: &FrontierDocument,
    kind: FrontierKind,
    png: bool,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let Some(figure) = FrontierFigure::new(document, kind) else { return Ok(()) };
    let drawing = draw(&figure, &format!("{}: {}", document.scene, kind.title.to_lowercase()));
    if png { drawing.write_png(out) } else { drawing.write_svg(out) }
}

/// Whether this frontier has points.
pub(crate) fn has_picture(document: &FrontierDocument, kind: FrontierKind) -> bool {
    FrontierFigure::new(document, kind).is_some()
}

fn draw(figure: &FrontierFigure, title: &str) -> Drawing {
    let counted = figure.all.iter().any(|record| record.instructions.is_some());
    let costs = if counted { vec![TIME, INSTRUCTIONS] } else { vec![TIME] };
    let mut drawing = Drawing::new(PANEL[0] * costs.len() as f64, PANEL[1] + LINE + 12.0);
    drawing.word(
        [14.0, 18.0],
        format!("{title}, {} of them; a line down is a digit", figure.all.len()),
        15.0,
        Anchor::Start,
    );
    for (k, cost) in costs.into_iter().enumerate() {
        let left = PANEL[0] * k as f64;
        figure.draw(&mut drawing, [[left + 74.0, left + PANEL[0] - 22.0], [44.0, PANEL[1] - 16.0]], cost);
    }
    drawing
}
