//! `study`: histograms of S and R with interval and truth, shares of the classes, shares of the effects.

use std::io::Write;

use plotters::coord::Shift;
use plotters::prelude::*;

use super::drawing::Drawing;
use super::pictures::{PictureFormat, write_drawing};
use super::plotted::Plotted;
use super::study::{QuantityPart, StudyDocument};
use super::table::significant;
use palpate_studies::montecarlo::Ranked;

/// Bars of a histogram.
const BARS: usize = 60;
/// Share of the replicates that is left out on either side: one wild replicate would squeeze all others into a bar.
const CUT: f64 = 0.001;

type Area<'a> = DrawingArea<Plotted<'a>, Shift>;
type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Draws a study; `ranked` are the values of S and of R.
///
/// # Errors
/// What the system says.
pub(crate) fn write_study_picture(
    document: &StudyDocument,
    ranked: &[Ranked<'_>; 2],
    format: PictureFormat,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut drawing = Drawing::new(960.0, 700.0);
    draw(document, ranked, &mut drawing).map_err(|e| std::io::Error::other(e.to_string()))?;
    write_drawing(&drawing, format, out)
}

fn draw(document: &StudyDocument, ranked: &[Ranked<'_>; 2], drawing: &mut Drawing) -> Outcome {
    let root = Plotted(drawing).into_drawing_area();
    let (head, body) = root.split_vertically(30);
    let title = format!("{}: {} replicates", document.scene, document.replicates);
    head.draw(&Text::new(title, (12, 8), ("sans-serif", 16)))?;
    let panels = body.split_evenly((2, 2));
    histogram(&panels[0], "S, shape index", &document.shape_index, &ranked[0])?;
    histogram(&panels[1], "R, curvedness", &document.curvedness, &ranked[1])?;
    let classes = document.class.0.iter().filter(|(_, share)| *share > 0.0);
    let classes: Vec<_> = classes.map(|(name, share)| (name.clone(), [Some(*share), None])).collect();
    bars(&panels[2], "share of each class", &classes)?;
    let effects: Vec<_> =
        document.effects.iter().map(|effect| (effect.name.clone(), [effect.share_S, effect.share_R])).collect();
    bars(&panels[3], "share of the variance of S (blue) and of R (red)", &effects)
}

fn histogram(area: &Area, caption: &str, part: &QuantityPart, ranked: &Ranked<'_>) -> Outcome {
    let (Some(lo), Some(hi)) = (ranked.quantile(CUT), ranked.quantile(1.0 - CUT)) else {
        return Ok(area.draw(&Text::new(format!("{caption}: undefined"), (20, 20), ("sans-serif", 14)))?);
    };
    let [lo, hi] = match part.truth {
        Some(truth) => [lo.min(truth), hi.max(truth)],
        None => [lo, hi],
    };
    let [lo, hi] = if lo < hi { [lo, hi] } else { [lo - 0.5, hi + 0.5] };
    let edge = |k: usize| lo + (hi - lo) * k as f64 / BARS as f64;
    // the number below a value, by halving: ranks rise with values
    let below = |value: f64| {
        let (mut a, mut b) = (0_u64, ranked.len());
        while a < b {
            let middle = a + (b - a) / 2;
            if ranked.at(middle as f64 + 1.0) < value { a = middle + 1 } else { b = middle }
        }
        a as f64
    };
    let counts: Vec<f64> = (0..BARS).map(|k| below(edge(k + 1)) - below(edge(k))).collect();
    let most = counts.iter().fold(1.0_f64, |m, c| m.max(*c));
    let mut chart = ChartBuilder::on(area)
        .caption(caption, ("sans-serif", 14))
        .margin(10)
        .x_label_area_size(30)
        .build_cartesian_2d(lo..hi, 0.0..1.1 * most)?;
    chart.configure_mesh().disable_mesh().x_labels(5).x_label_formatter(&|x| significant(*x, 3)).draw()?;
    if let (Some(a), Some(b)) = (part.lo, part.hi) {
        let band = Rectangle::new([(a.max(lo), 0.0), (b.min(hi), 1.1 * most)], RGBColor(225, 234, 245).filled());
        chart.draw_series(std::iter::once(band))?;
    }
    let bars = counts.iter().enumerate();
    chart.draw_series(
        bars.map(|(k, count)| Rectangle::new([(edge(k), 0.0), (edge(k + 1), *count)], BLUE.mix(0.5).filled())),
    )?;
    for (value, colour) in [(part.mean, BLUE), (part.truth, BLACK)] {
        if let Some(value) = value {
            chart.draw_series(LineSeries::new([(value, 0.0), (value, 1.1 * most)], colour.stroke_width(2)))?;
        }
    }
    Ok(())
}

fn bars(area: &Area, caption: &str, rows: &[(String, [Option<f64>; 2])]) -> Outcome {
    area.draw(&Text::new(caption.to_string(), (20, 10), ("sans-serif", 14)))?;
    let (width, height) = area.dim_in_pixel();
    let step = ((height as i32 - 50) / rows.len().max(1) as i32).min(34);
    for (k, (name, shares)) in rows.iter().enumerate() {
        let top = 40 + step * k as i32;
        area.draw(&Text::new(name.clone(), (20, top), ("sans-serif", 12)))?;
        let thickness = (step / 3).max(3);
        for (which, (share, colour)) in shares.iter().zip([BLUE, RED]).enumerate() {
            let Some(share) = share else { continue };
            let length = (f64::from(width as i32 - 240) * share.clamp(0.0, 1.0)) as i32;
            let (left, y) = (150, top + thickness * which as i32);
            area.draw(&Rectangle::new([(left, y), (left + length, y + thickness - 1)], colour.mix(0.6).filled()))?;
            area.draw(&Text::new(format!("{share:.3}"), (left + length + 6, y - 2), ("sans-serif", 10)))?;
        }
    }
    Ok(())
}
