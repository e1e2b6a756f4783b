//! The page of a sweep: S and R with their intervals against a key of the scene.

use std::io::Write;

use super::chart::{Axis, Chart, precise, shown};
use super::html::{short, text};
use super::provenance::Provenance;
use super::shell::Page;
use super::tables::{key, table};
use crate::report::percent::percent;
use crate::report::study::QuantityPart;
use crate::report::sweep::{SweepPoint, write_sweep_table};

/// A sweep as its page shows it.
pub(crate) struct SweepPage<'a> {
    /// Name of the scene.
    pub scene: &'a str,
    /// The keys.
    pub keys: &'a [&'a str],
    /// The points, in the order in which they were computed.
    pub points: &'a [SweepPoint],
    /// Points that were asked for.
    pub asked: usize,
    /// Level of the intervals.
    pub level: f64,
    /// The document, as `--json` prints it.
    pub document: &'a [u8],
}

/// Writes the page of a sweep.
///
/// # Errors
/// What the system says.
pub(crate) fn write_sweep_page(
    sweep: &SweepPage<'_>,
    provenance: &Provenance,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut words = Vec::new();
    write_sweep_table(sweep.keys, sweep.points, &mut words)?;
    let mut sections = String::new();
    if let [only] = sweep.keys {
        sections.push_str(&charts(sweep, only));
    }
    sections.push_str(&points(sweep));
    let done = sweep.points.len();
    let cut = (done < sweep.asked)
        .then(|| format!("Interrupted: {done} of {} points are done, and only these are shown.", sweep.asked));
    let failed: u64 = sweep.points.iter().map(|point| point.failed).sum();
    let failed = (failed > 0).then(|| format!("{failed} replicates could not be fitted and are left out."));
    let page = Page {
        kind: "a sweep: one study for every value",
        title: short(sweep.scene),
        lead: text(&format!(
            "How S and R follow {}: {done} studies, each with its own interval.",
            sweep.keys.join(" and ")
        )),
        notices: cut.into_iter().chain(failed).collect(),
        sections,
        document: sweep.document,
        table: &words,
        view: None,
    };
    page.write(provenance, out)
}

fn charts(sweep: &SweepPage<'_>, name: &str) -> String {
    let across: Vec<f64> = sweep.points.iter().filter_map(|point| point.at.first().copied()).collect();
    let least = across.iter().copied().fold(f64::INFINITY, f64::min);
    let most = across.iter().copied().fold(0.0, f64::max);
    // values over more than a decade were meant to be seen by their ratios
    let logarithmic = least > 0.0 && most > 10.0 * least;
    let one = |title: &str, of: fn(&SweepPoint) -> &QuantityPart| {
        let parts = || sweep.points.iter().filter_map(|p| Some((*p.at.first()?, of(p))));
        let values = parts().flat_map(|(_, part)| [part.lo, part.hi, part.mean, part.truth]).flatten();
        let values: Vec<f64> = values.collect();
        let x = if logarithmic {
            Axis::logarithmic(name, across.iter().copied())
        } else {
            Axis::holding(name, across.iter().copied())
        };
        let mut chart = Chart::new(&format!("{title} against {name}"), x, Axis::holding(title, values.into_iter()));
        let band: Vec<[f64; 3]> = parts().filter_map(|(x, part)| Some([x, part.lo?, part.hi?])).collect();
        chart.band("", &band);
        chart.line("truth", &parts().filter_map(|(x, part)| Some([x, part.truth?])).collect::<Vec<_>>());
        let means: Vec<[f64; 2]> = parts().filter_map(|(x, part)| Some([x, part.mean?])).collect();
        chart.line("", &means);
        for (x, part) in parts() {
            let Some(mean) = part.mean else { continue };
            let interval =
                part.lo.zip(part.hi).map_or(String::new(), |(lo, hi)| format!("\n{} to {}", shown(lo), shown(hi)));
            chart.dot("", [x, mean], 3.5, &format!("{name} {}\nmean {}{interval}", shown(x), shown(mean)));
        }
        format!("<figure><figcaption><b>{}</b></figcaption>{}</figure>", text(title), chart.svg())
    };
    let interval = format!("{} of the measurements", percent(sweep.level));
    let marks = key(&[("line", "--accent", "mean"), ("", "--band", &interval), ("line dashed", "--second", "truth")]);
    format!(
        "<section id=\"charts\"><h2>S and R</h2>\n<div class=\"figures\">{}{}</div>{marks}</section>\n",
        one("S, shape index", |p| &p.shape_index),
        one("R, curvedness", |p| &p.curvedness)
    )
}

fn points(sweep: &SweepPage<'_>) -> String {
    let of = |part: &QuantityPart| {
        let number = |v: Option<f64>| v.map_or("-".into(), shown);
        let interval = part
            .lo
            .zip(part.hi)
            .map_or("-".into(), |(lo, hi)| format!("{} to {}", precise(lo, hi - lo), precise(hi, hi - lo)));
        [number(part.mean), interval, number(part.truth)]
    };
    let rows: Vec<Vec<String>> = sweep
        .points
        .iter()
        .map(|point| {
            let best = point.class.0.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            let class = best.map_or("-".into(), |(name, share)| format!("{name} {share:.3}"));
            let keys = point.at.iter().map(|v| shown(*v));
            keys.chain(of(&point.shape_index)).chain(of(&point.curvedness)).chain([class]).collect()
        })
        .collect();
    let mut head: Vec<&str> = sweep.keys.to_vec();
    head.extend(["S", "Interval", "Truth", "R", "Interval", "Truth", "Commonest class"]);
    format!("<section id=\"points\"><h2>Every point</h2>\n{}</section>\n", table(&head, &rows))
}
