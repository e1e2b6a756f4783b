//! `explore`: where it touched and in which order; u(S) and u(R)/R against the contacts.

use std::io::Write;

use plotters::coord::Shift;
use plotters::prelude::*;

use super::drawing::Drawing;
use super::explore::{ExploreDocument, KnownPart};
use super::pictures::{PictureFormat, write_drawing};
use super::plotted::Plotted;
use super::table::significant;

type Area<'a> = DrawingArea<Plotted<'a>, Shift>;
type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Touches that are numbered; more numbers than these would lie over each other.
const NUMBERED: usize = 120;

/// Draws an exploration.
///
/// # Errors
/// What the system says.
pub(crate) fn write_explore_picture(
    document: &ExploreDocument,
    format: PictureFormat,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut drawing = Drawing::new(1040.0, 560.0);
    draw(document, &mut drawing).map_err(|e| std::io::Error::other(e.to_string()))?;
    write_drawing(&drawing, format, out)
}

fn draw(document: &ExploreDocument, drawing: &mut Drawing) -> Outcome {
    let root = Plotted(drawing).into_drawing_area();
    let (head, body) = root.split_vertically(34);
    let title = format!(
        "{}: {} contacts by {}, stopped by {}",
        document.scene, document.contacts, document.strategy, document.stopped
    );
    head.draw(&Text::new(title, (12, 10), ("sans-serif", 16)))?;
    let (left, right) = body.split_horizontally(540);
    touches(&left, document)?;
    let (upper, lower) = right.split_vertically(263);
    let goal = document.goal;
    uncertainty(&upper, "u(S)", document, goal.map(|g| g.u_S), |step| step.shape_index.u)?;
    let share = |p: &KnownPart| p.u.zip(p.mean).map(|(u, mean)| u / mean);
    uncertainty(&lower, "u(R)/R", document, goal.map(|g| g.u_R), |step| share(&step.curvedness))
}

/// The places in x and y: grey those of the first sweep, then from light to dark in the order of the rounds, numbered.
fn touches(area: &Area, document: &ExploreDocument) -> Outcome {
    let all = document.steps.iter().flat_map(|step| &step.touched);
    let range = |k: usize| {
        let ends = all.clone().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], p| [lo.min(p[k]), hi.max(p[k])]);
        if ends[0] < ends[1] { ends } else { [ends[0] - 0.5, ends[0] + 0.5] }
    };
    let [[x0, x1], [y0, y1]] = [range(0), range(1)];
    // one scale for both axes
    let half = 0.54 * (x1 - x0).max(y1 - y0);
    let (cx, cy) = (0.5 * (x0 + x1), 0.5 * (y0 + y1));
    let mut chart = ChartBuilder::on(area)
        .caption("touches in their order (grey: the first sweep)", ("sans-serif", 14))
        .margin(10)
        .x_label_area_size(36)
        .y_label_area_size(50)
        .build_cartesian_2d(cx - half..cx + half, cy - half..cy + half)?;
    let label = |v: &f64| significant(*v, 2);
    let mut mesh = chart.configure_mesh();
    mesh.light_line_style(WHITE).x_desc("x").y_desc("y").x_labels(7).y_labels(7);
    mesh.x_label_formatter(&label).y_label_formatter(&label).draw()?;
    let rounds = (document.steps.len().max(2) - 1) as f64;
    let mut number = 0;
    for (round, step) in document.steps.iter().enumerate() {
        let colour = if round == 0 {
            RGBColor(150, 150, 150)
        } else {
            let t = round as f64 / rounds;
            let mix = |light: f64, dark: f64| (light + t * (dark - light)) as u8;
            RGBColor(mix(120.0, 10.0), mix(190.0, 30.0), mix(255.0, 120.0))
        };
        for place in &step.touched {
            number += 1;
            let at = (place[0], place[1]);
            chart.draw_series(std::iter::once(Circle::new(at, 5, colour.filled())))?;
            // the first sweep has an order of its own, and its repeats lie on one another
            if round > 0 && number <= NUMBERED {
                let text = EmptyElement::at(at) + Text::new(number.to_string(), (5, -14), ("sans-serif", 11));
                chart.draw_series(std::iter::once(text))?;
            }
        }
    }
    Ok(())
}

fn uncertainty(
    area: &Area,
    caption: &str,
    document: &ExploreDocument,
    goal: Option<f64>,
    of: impl Fn(&super::explore::StepPart) -> Option<f64>,
) -> Outcome {
    /// Smallest u that is drawn: a surface found to be a sphere has an S without any.
    const LEAST_U: f64 = 1e-6;
    let known = document.steps.iter().filter_map(|step| Some((step.contacts as f64, of(step)?.max(LEAST_U))));
    let known: Vec<(f64, f64)> = known.collect();
    let values = known.iter().map(|(_, u)| *u).chain(goal);
    let (lo, hi) = values.fold((f64::INFINITY, 0.0_f64), |(lo, hi), u| (lo.min(u), hi.max(u)));
    let last = document.steps.last().map_or(1.0, |step| step.contacts as f64);
    if known.is_empty() || !(lo > 0.0 && hi.is_finite()) {
        return Ok(area.draw(&Text::new(format!("{caption}: undefined"), (20, 20), ("sans-serif", 14)))?);
    }
    let mut chart = ChartBuilder::on(area)
        .caption(format!("{caption} after so many contacts"), ("sans-serif", 14))
        .margin(10)
        .x_label_area_size(30)
        .y_label_area_size(60)
        .build_cartesian_2d(0.0..1.05 * last, (0.7 * lo..1.4 * hi).log_scale())?;
    let label = |v: &f64| significant(*v, 2);
    let mut mesh = chart.configure_mesh();
    mesh.light_line_style(WHITE).x_labels(6).y_labels(5).x_label_formatter(&|v| format!("{v:.0}"));
    mesh.y_label_formatter(&label).draw()?;
    if let Some(goal) = goal {
        chart.draw_series(LineSeries::new([(0.0, goal), (1.05 * last, goal)], RED.stroke_width(1)))?;
    }
    chart.draw_series(LineSeries::new(known.iter().copied(), BLUE.stroke_width(2)))?;
    chart.draw_series(known.iter().map(|at| Circle::new(*at, 3, BLUE.filled())))?;
    Ok(())
}
