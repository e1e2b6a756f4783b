//! `diff.svg`: where two surfaces differ, in height, normal, S and R, in units of the uncertainty where there is one.
//!
//! Blue is below zero, red above, white none; grey is where the two are not compared. Cells of one colour that follow each
//! other are drawn as one.

use std::io::Write;

use crate::comparison::{ComparedPoint, Comparison, QUANTITIES};

use super::diff::DiffDocument;
use super::drawing::{Anchor, Colour, Drawing};
use super::table::significant;

/// Pixels of a panel's longer side.
const SIDE: f64 = 300.0;
/// Space around panels.
const MARGIN: f64 = 60.0;
/// Most cells each way: more would not be seen.
const CELLS: usize = 60;
/// Steps of the colour scale to each side of white.
const STEPS: i32 = 12;
/// Where nothing is compared.
const UNKNOWN: Colour = [225, 225, 225];
const ENDS: [Colour; 2] = [[24, 54, 130], [158, 24, 32]];

/// What the panels are called, with and without uncertainties.
const NAMES: [[&str; 2]; QUANTITIES] =
    [["height / u", "height"], ["angle of normals / u", "angle of normals, degrees"], ["S / u", "S"], ["R / u", "R"]];

/// Draws the maps.
///
/// # Errors
/// What the system says.
pub(crate) fn write_diff_picture(
    document: &DiffDocument,
    found: &Comparison,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let spans = found.at.each_ref().map(|axis| axis[axis.len() - 1] - axis[0]);
    let longer = spans[0].max(spans[1]);
    // a sliver would leave no room for its labels
    let size = spans.map(|span| (SIDE * span / longer).max(0.2 * SIDE));
    let panel = [size[0] + 2.0 * MARGIN, size[1] + MARGIN + 30.0];
    let mut drawing = Drawing::new(2.0 * panel[0], 2.0 * panel[1] + 50.0);
    let name =
        |file: &str| std::path::Path::new(file).file_name().map_or(file.into(), |n| n.to_string_lossy().into_owned());
    drawing.word(
        [12.0, 16.0],
        format!("{} less {}", name(&document.b.file), name(&document.a.file)),
        15.0,
        Anchor::Start,
    );
    drawing.word([12.0, 36.0], document.verdict(), 11.0, Anchor::Start);
    let axes = if document.a.kind == "height" { ["x", "y"] } else { ["u of A", "v of A"] };
    for quantity in 0..QUANTITIES {
        let corner = [(quantity % 2) as f64 * panel[0] + MARGIN, (quantity / 2) as f64 * panel[1] + 80.0];
        panel_of(&mut drawing, found, quantity, axes, [corner, size]);
    }
    drawing.write_svg(out)
}

fn panel_of(
    drawing: &mut Drawing,
    found: &Comparison,
    quantity: usize,
    axes: [&str; 2],
    [corner, size]: [[f64; 2]; 2],
) {
    let judged = found.quantities[quantity].beyond[1] > 0;
    let value = |point: &ComparedPoint| {
        let difference = point.difference[quantity]?;
        if judged { point.ratio(quantity).map(|r| r.copysign(difference)) } else { Some(difference) }
    };
    let all = || found.points.iter().flatten().filter_map(value);
    let largest = all().map(f64::abs).filter(|v| v.is_finite()).fold(0.0, f64::max);
    let end = if judged { largest.max(found.threshold) } else { largest };
    let step = |point: Option<&ComparedPoint>| {
        let v = point.and_then(value)?;
        Some(if end > 0.0 { (f64::from(STEPS) * (v / end).clamp(-1.0, 1.0)).round() as i32 } else { 0 })
    };
    drawing.word([corner[0], corner[1] - 12.0], NAMES[quantity][usize::from(!judged)], 12.0, Anchor::Start);
    cells(drawing, found, &step, corner, size);
    let [x0, y1] = [corner[0], corner[1] + size[1]];
    let along = &found.at[0];
    drawing.word([x0, y1 + 12.0], significant(along[0], 3), 10.0, Anchor::Start);
    drawing.word([x0 + size[0], y1 + 12.0], significant(along[along.len() - 1], 3), 10.0, Anchor::End);
    drawing.word([x0 + 0.5 * size[0], y1 + 12.0], axes[0], 10.0, Anchor::Middle);
    drawing.upward_word([x0 - 12.0, corner[1] + 0.5 * size[1]], axes[1], 10.0);
    let places = &found.at[1];
    drawing.word([x0 - 4.0, y1], significant(places[0], 3), 10.0, Anchor::End);
    drawing.word([x0 - 4.0, corner[1]], significant(places[places.len() - 1], 3), 10.0, Anchor::End);
    scale(drawing, [corner[0] + size[0] + 10.0, corner[1]], size[1], end);
}

/// Cells around the points, those of one colour in a column as one.
fn cells(
    drawing: &mut Drawing,
    found: &Comparison,
    step: &dyn Fn(Option<&ComparedPoint>) -> Option<i32>,
    corner: [f64; 2],
    size: [f64; 2],
) {
    let counts = [found.at[0].len(), found.at[1].len()];
    let shown = counts.map(|n| n.min(CELLS));
    let source = |k: usize, cell: usize| (2 * cell + 1) * counts[k] / (2 * shown[k]);
    for i in 0..shown[0] {
        let at = |j: usize| found.points[source(0, i) * counts[1] + source(1, j)].as_ref();
        let colours: Vec<Option<i32>> = (0..shown[1]).map(|j| step(at(j))).collect();
        let mut from = 0;
        for run in colours.chunk_by(|a, b| a == b) {
            let to = from + run.len();
            let x = [i, i + 1].map(|k| corner[0] + size[0] * k as f64 / shown[0] as f64);
            // upwards in the picture is upwards on the axis
            let y = [from, to].map(|k| corner[1] + size[1] * (1.0 - k as f64 / shown[1] as f64));
            let fill = run[0].map_or(UNKNOWN, colour);
            drawing.area(&[[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]], fill, fill);
            from = to;
        }
    }
}

fn scale(drawing: &mut Drawing, [x, y]: [f64; 2], height: f64, end: f64) {
    let count = 2 * STEPS + 1;
    for k in 0..count {
        let [top, bottom] = [k + 1, k].map(|k| y + height * (1.0 - f64::from(k) / f64::from(count)));
        let fill = colour(k - STEPS);
        drawing.area(&[[x, bottom], [x + 10.0, bottom], [x + 10.0, top], [x, top]], fill, fill);
    }
    for (value, share) in [(-end, 1.0), (0.0, 0.5), (end, 0.0)] {
        drawing.word([x + 14.0, y + share * height], significant(value, 2), 10.0, Anchor::Start);
    }
}

/// White in the middle, blue below, red above.
fn colour(step: i32) -> Colour {
    let share = (f64::from(step.abs()) / f64::from(STEPS)).sqrt();
    let end = ENDS[usize::from(step > 0)];
    [0, 1, 2].map(|k| (250.0 + share * (f64::from(end[k]) - 250.0)).round() as u8)
}
