//! `sweep`: S and R against the last key of a sweep.

use std::io::Write;

use super::charts::{SMALL, SWEPT, legend, series, sweep_panel};
use super::drawing::Anchor;
use super::percent::percent;
use super::pictures::{LARGE, PictureFormat, fitting, foot, picture, write_drawing};
use super::sweep::SweepPoint;

/// Edges of the two panels.
const SIDES: [f64; 2] = [66.0, 486.0];
const PANELS: [[f64; 2]; 2] = [[34.0, 204.0], [258.0, 428.0]];

/// Draws a sweep; `level` is that of the bars.
///
/// # Errors
/// What the system says.
pub(crate) fn write_sweep_picture(
    title: &str,
    keys: &[&str],
    points: &[SweepPoint],
    level: f64,
    format: PictureFormat,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let all = series(keys, points);
    let mut drawing = picture(if all.len() > 1 { 488.0 } else { 472.0 });
    drawing.word([8.0, 14.0], fitting(title, 70), LARGE, Anchor::Start);
    let key = fitting(keys.last().copied().unwrap_or(""), 60);
    for (swept, edges) in SWEPT.into_iter().zip(PANELS) {
        if !sweep_panel((&mut drawing, [SIDES, edges]), swept, &key, &all) {
            let at = [0.5 * (SIDES[0] + SIDES[1]), 0.5 * (edges[0] + edges[1])];
            drawing.word(at, format!("{}: undefined everywhere", swept.0), SMALL, Anchor::Middle);
        }
    }
    if all.len() > 1 {
        let marks: Vec<_> = all.iter().map(|series| (series.colour, series.words.clone())).collect();
        let y = drawing.size[1] - 16.0;
        legend(&mut drawing, SIDES, y, &marks);
    }
    foot(&mut drawing, &[format!("dots: mean; bars: {} of the replicates; lines: truth", percent(level))]);
    write_drawing(&drawing, format, out)
}
