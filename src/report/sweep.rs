//! A sweep: S, R and class shares against keys of the scene, as table, CSV and picture.

use std::fmt::Write as _;
use std::io::Write;

use plotters::prelude::*;
use serde::Serialize;

use super::study::{NamedShares, QuantityPart, StudyDocument};
use super::table::significant;

/// One point of a sweep.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct SweepPoint {
    /// Values of the keys.
    pub at: Vec<f64>,
    /// S.
    #[serde(rename = "S")]
    pub shape_index: QuantityPart,
    /// R.
    #[serde(rename = "R")]
    pub curvedness: QuantityPart,
    /// Class shares.
    pub class: NamedShares,
    /// Replicates whose fit failed.
    pub failed: u64,
}

impl SweepPoint {
    /// From a study at these values of the keys.
    pub(crate) fn new(at: Vec<f64>, study: &StudyDocument) -> SweepPoint {
        SweepPoint {
            at,
            shape_index: study.shape_index.clone(),
            curvedness: study.curvedness.clone(),
            class: study.class.clone(),
            failed: study.failed,
        }
    }

    fn best(&self) -> Option<&(String, f64)> {
        self.class.0.iter().max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// A table for people.
///
/// # Errors
/// What the system says.
pub(crate) fn write_sweep_table(keys: &[&str], points: &[SweepPoint], out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = keys.join("  ");
    let _ = writeln!(
        text,
        "\n{:<width$} {:>10} {:>22} {:>9}   {:>10} {:>24} {:>9}   class",
        "",
        "S",
        "interval",
        "truth",
        "R",
        "interval",
        "truth",
        width = 12 * keys.len()
    );
    for point in points {
        let at: String = point.at.iter().map(|v| format!("{:<12}", significant(*v, 4))).collect();
        let word = |v: Option<f64>| v.map_or("-".into(), |v| significant(v, 4));
        let interval = |part: &QuantityPart| format!("[{}, {}]", word(part.lo), word(part.hi));
        let (s, r) = (&point.shape_index, &point.curvedness);
        let class = point.best().map_or(String::new(), |(name, share)| format!("{name} {share:.3}"));
        let _ = writeln!(
            text,
            "{at} {:>10} {:>22} {:>9}   {:>10} {:>24} {:>9}   {class}",
            word(s.mean),
            interval(s),
            word(s.truth),
            word(r.mean),
            interval(r),
            word(r.truth)
        );
    }
    out.write_all(text.as_bytes())
}

/// Names and columns of the table of a sweep: the keys, what S and R came to, failed replicates, class shares; NaN where
/// undefined.
pub(crate) fn sweep_columns(keys: &[&str], points: &[SweepPoint]) -> (Vec<String>, Vec<Vec<f64>>) {
    let of = |name: &str| ["mean", "sd", "bias", "lo", "hi", "truth"].map(|what| format!("{name}_{what}"));
    let mut names: Vec<String> = keys.iter().map(ToString::to_string).collect();
    names.extend(of("S").into_iter().chain(of("R")).chain(["failed".to_string()]));
    names.extend(points.iter().take(1).flat_map(|point| point.class.0.iter().map(|(name, _)| name.replace(' ', "_"))));
    let mut columns = vec![Vec::with_capacity(points.len()); names.len()];
    for point in points {
        let parts = [&point.shape_index, &point.curvedness];
        let values = parts.into_iter().flat_map(|part| [part.mean, part.sd, part.bias, part.lo, part.hi, part.truth]);
        let values = values.map(|v| v.unwrap_or(f64::NAN)).chain([point.failed as f64]);
        let values = point.at.iter().copied().chain(values).chain(point.class.0.iter().map(|(_, share)| *share));
        columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
    }
    (names, columns)
}

/// One line a point.
///
/// # Errors
/// What the system says.
pub(crate) fn write_sweep_csv(keys: &[&str], points: &[SweepPoint], out: &mut dyn Write) -> std::io::Result<()> {
    let (names, columns) = sweep_columns(keys, points);
    writeln!(out, "{}", names.join(","))?;
    for k in 0..points.len() {
        let words: Vec<String> = columns.iter().map(|column| column[k].to_string()).collect();
        writeln!(out, "{}", words.join(","))?;
    }
    Ok(())
}

/// S and R against the last key, with bands; one line for each value of the keys before it.
///
/// # Errors
/// What the system says.
pub(crate) fn write_sweep_picture(
    title: &str,
    keys: &[&str],
    points: &[SweepPoint],
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut svg = String::new();
    draw(title, keys, points, &mut svg).map_err(|e| std::io::Error::other(e.to_string()))?;
    out.write_all(svg.as_bytes())
}

type Part = fn(&SweepPoint) -> &QuantityPart;

fn draw(title: &str, keys: &[&str], points: &[SweepPoint], svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, (960, 420)).into_drawing_area();
    root.fill(&WHITE)?;
    let (head, body) = root.split_vertically(30);
    head.draw(&Text::new(title.to_string(), (12, 8), ("sans-serif", 16)))?;
    let (left, right) = body.split_horizontally(480);
    let xs: Vec<f64> = points.iter().filter_map(|point| point.at.last().copied()).collect();
    let (x0, x1) = xs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(*x), hi.max(*x)));
    // ten times and more is read on a logarithmic axis
    let logarithmic = x0 > 0.0 && x1 / x0 > 9.0;
    let place = |x: f64| if logarithmic { x.log10() } else { x };
    let parts: [(&str, Part); 2] = [("S", |p| &p.shape_index), ("R", |p| &p.curvedness)];
    for ((name, part), area) in parts.into_iter().zip([&left, &right]) {
        let ends = points.iter().flat_map(|p| [part(p).lo, part(p).hi, part(p).truth]).flatten();
        let (lo, hi) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        if !(lo.is_finite() && hi.is_finite() && x0 < x1) {
            continue;
        }
        let margin = 0.05 * (hi - lo).max(1e-12);
        let mut chart = ChartBuilder::on(area)
            .caption(name, ("sans-serif", 14))
            .margin(10)
            .x_label_area_size(36)
            .y_label_area_size(60)
            .build_cartesian_2d(place(x0)..place(x1), lo - margin..hi + margin)?;
        let label = |x: &f64| significant(if logarithmic { 10.0_f64.powf(*x) } else { *x }, 3);
        let key = keys.last().copied().unwrap_or("");
        chart.configure_mesh().light_line_style(WHITE).x_desc(key).x_label_formatter(&label).x_labels(5).draw()?;
        for (k, line) in lines(points).into_iter().enumerate() {
            let colour = Palette99::pick(k).to_rgba();
            let known = line.iter().filter_map(|p| Some((place(*p.at.last()?), part(p))));
            let known: Vec<_> = known.filter_map(|(x, q)| Some((x, q.mean?, q.lo?, q.hi?, q.truth))).collect();
            let band = known.iter().map(|(x, _, lo, ..)| (*x, *lo));
            let band: Vec<(f64, f64)> = band.chain(known.iter().rev().map(|(x, _, _, hi, _)| (*x, *hi))).collect();
            chart.draw_series(std::iter::once(Polygon::new(band, colour.mix(0.2).filled())))?;
            chart
                .draw_series(LineSeries::new(known.iter().map(|(x, mean, ..)| (*x, *mean)), colour.stroke_width(2)))?;
            let truth = known.iter().filter_map(|(x, .., truth)| Some((*x, (*truth)?)));
            chart.draw_series(LineSeries::new(truth, BLACK.stroke_width(1)))?;
        }
    }
    root.present()?;
    Ok(())
}

/// Points that differ in the last key alone.
fn lines(points: &[SweepPoint]) -> Vec<&[SweepPoint]> {
    points.chunk_by(|a, b| a.at.split_last().map(|(_, rest)| rest) == b.at.split_last().map(|(_, rest)| rest)).collect()
}
