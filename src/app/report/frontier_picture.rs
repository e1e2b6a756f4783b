//! `frontier.svg`, `solver.svg`, `interval.svg` and the same as PNG: error against time and against instructions.

use std::io::Write;

use super::charts::{FrontierFigure, FrontierKind, INSTRUCTIONS, LINE, TIME};
use super::drawing::{Anchor, Drawing, width_of};
use super::frontier::FrontierDocument;

const PANEL: [f64; 2] = [470.0, 400.0];

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
    let drawing = draw(&figure, &format!("{}: {}", document.scene, kind.frontier));
    if png { drawing.write_png(out) } else { drawing.write_svg(out) }
}

/// Whether this frontier has points.
pub(crate) fn has_picture(document: &FrontierDocument, kind: FrontierKind) -> bool {
    FrontierFigure::new(document, kind).is_some()
}

fn draw(figure: &FrontierFigure, title: &str) -> Drawing {
    let numbered = figure.numbered();
    let rows = numbered.len().div_ceil(2);
    let lines = (rows + figure.groups.len().div_ceil(5)) as f64;
    let mut drawing = Drawing::new(2.0 * PANEL[0], 40.0 + PANEL[1] + LINE * (lines + 3.0));
    drawing.word([14.0, 18.0], format!("{title}, {} points", figure.all.len()), 15.0, Anchor::Start);
    let counted = figure.all.iter().any(|record| record.instructions.is_some());
    for (k, cost) in [TIME, INSTRUCTIONS].into_iter().enumerate().filter(|(k, _)| *k == 0 || counted) {
        let left = PANEL[0] * k as f64;
        figure.draw(&mut drawing, [[left + 74.0, left + PANEL[0] - 22.0], [44.0, PANEL[1] - 16.0]], cost);
    }
    let top = figure.key(&mut drawing, 40.0 + PANEL[1] + LINE) + 0.5 * LINE;
    // what the numbers mean
    let column = 0.5 * (drawing.size[0] - 28.0);
    for (k, record) in numbered.iter().enumerate() {
        let at = [14.0 + column * (k / rows) as f64, top + LINE * (k % rows) as f64];
        let mut text = format!("{} {}", k + 1, figure.name(record));
        while width_of(&text, 10.0) > column - 6.0 && text.pop().is_some() {}
        drawing.word(at, text, 10.0, Anchor::Start);
    }
    drawing
}
