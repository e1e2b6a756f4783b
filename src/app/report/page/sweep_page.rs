//! The page of a sweep: S and R with their intervals against a key of the scene.

use std::io::Write;

use super::figure::{chart, precise, shown};
use super::html::{short, text};
use super::provenance::Provenance;
use super::shell::Page;
use super::tables::{coloured_key, table};
use crate::report::charts::{SWEPT, series, sweep_panel};
use crate::report::colour::hex;
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
    sections.push_str(&charts(sweep));
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

fn charts(sweep: &SweepPage<'_>) -> String {
    let all = series(sweep.keys, sweep.points);
    let last = sweep.keys.last().copied().unwrap_or("");
    let figures = SWEPT.map(|swept| {
        let name = text(swept.0);
        let mut known = false;
        let label = format!("{} against {last}", swept.0);
        let chart = chart(&label, |drawing, rect| known = sweep_panel((drawing, rect), swept, last, &all));
        match known {
            true => format!("<figure><figcaption><b>{name}</b></figcaption>{chart}</figure>"),
            false => format!("<figure><figcaption><b>{name}</b> is undefined everywhere.</figcaption></figure>"),
        }
    });
    let interval = format!("{} of the measurements", percent(sweep.level));
    let mut marks = vec![("line dashed".to_string(), "var(--second)".to_string(), "truth".to_string())];
    if let [_] = &all[..] {
        marks.insert(0, (String::new(), "var(--accent)".into(), "mean".into()));
        marks.insert(1, ("line".into(), "var(--accent)".into(), interval));
    } else {
        marks.extend(all.iter().map(|series| (String::new(), hex(series.colour), series.words.clone())));
        marks.push((String::new(), "none".into(), format!("bars: {interval}")));
    }
    let marks: Vec<_> = marks.iter().map(|(style, colour, words)| (&style[..], &colour[..], &words[..])).collect();
    format!(
        "<section id=\"charts\"><h2>S and R</h2>\n<div class=\"figures\">{}</div>{}</section>\n",
        figures.concat(),
        coloured_key(&marks)
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
