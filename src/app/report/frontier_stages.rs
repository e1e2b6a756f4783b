//! `stages.svg` and `stages.png`: where the time of a fit and of a replicate goes, as one bar each.

use std::io::Write;

use super::drawing::{Anchor, Colour, Drawing};
use super::frontier::{FrontierDocument, StagePart};
use super::table::significant;

/// Shades that alternate, so that neighbours differ in grey as well.
const SHADES: [Colour; 7] =
    [[0, 114, 178], [230, 159, 0], [0, 90, 70], [240, 228, 66], [213, 94, 0], [86, 180, 233], [120, 60, 100]];
const WIDTH: f64 = 860.0;
const LEFT: f64 = 40.0;

/// Draws the bars.
///
/// # Errors
/// What the system says.
pub(crate) fn write_stages_picture(document: &FrontierDocument, png: bool, out: &mut dyn Write) -> std::io::Result<()> {
    let drawing = draw(document);
    if png { drawing.write_png(out) } else { drawing.write_svg(out) }
}

fn draw(document: &FrontierDocument) -> Drawing {
    let bars: Vec<Vec<&StagePart>> = ["fit", "replicate"]
        .iter()
        .map(|of| document.stages.iter().filter(|stage| stage.of == *of).collect())
        .filter(|stages: &Vec<&StagePart>| !stages.is_empty())
        .collect();
    let lines: usize = bars.iter().map(|stages| stages.len() + 5).sum();
    let mut drawing = Drawing::new(WIDTH + 2.0 * LEFT, 40.0 + 17.0 * lines as f64);
    drawing.word([14.0, 18.0], format!("{}: where the time goes", document.scene), 15.0, Anchor::Start);
    let mut top = 46.0;
    for stages in bars {
        bar(&mut drawing, top, &stages);
        top += 17.0 * (stages.len() + 5) as f64;
    }
    drawing
}

fn bar(drawing: &mut Drawing, top: f64, stages: &[&StagePart]) {
    let time = |stage: &StagePart| stage.seconds.median.max(0.0);
    let whole: f64 = stages.iter().map(|stage| time(stage)).sum();
    let of = stages.first().map_or("", |stage| &stage.of);
    drawing.word([LEFT, top], format!("a {of}: {} us", significant(1e6 * whole, 3)), 12.0, Anchor::Start);
    let mut left = LEFT;
    for (k, stage) in stages.iter().enumerate() {
        let colour = SHADES[k % SHADES.len()];
        let right = left + WIDTH * stage.share;
        let (y0, y1) = (top + 12.0, top + 40.0);
        drawing.area(&[[left, y0], [right, y0], [right, y1], [left, y1]], colour, [0; 3]);
        left = right;
        let y = top + 56.0 + 17.0 * k as f64;
        let corners = [[LEFT, y - 5.0], [LEFT + 10.0, y - 5.0], [LEFT + 10.0, y + 5.0], [LEFT, y + 5.0]];
        drawing.area(&corners, colour, [0; 3]);
        let percent = 100.0 * stage.share;
        let saved = if stage.saved_by.is_empty() { String::new() } else { format!("   saved by {}", stage.saved_by) };
        let micro = significant(1e6 * time(stage), 3);
        drawing.word([LEFT + 18.0, y], &stage.stage, 11.0, Anchor::Start);
        drawing.word([LEFT + 190.0, y], format!("{micro} us"), 11.0, Anchor::End);
        drawing.word([LEFT + 250.0, y], format!("{percent:.1} %"), 11.0, Anchor::End);
        drawing.word([LEFT + 256.0, y], saved, 11.0, Anchor::Start);
    }
}
