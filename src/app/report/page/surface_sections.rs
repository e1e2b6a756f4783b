//! The sections that a surface fills: the turning view, the maps, the numbers, the residuals, the certificate.

use std::fmt::Write as _;

use super::super::colour::{DIVERGING, Field, VIRIDIS, ends};
use super::figure::{chart, precise, shown};
use super::figures::{figure, thinned};
use super::html::text;
use super::lengths::Lengths;
use super::perspective::picture;
use super::tables::{bars, card, list, notes, table};
use super::view_data::STROKES;
use super::words::{apart, certificate, interval_of, named_level, noise};
use crate::report::charts::{Histogram, Style};
use crate::report::document::{FitDocument, MeasurePart, ShapePart, SpreadPart};
use crate::report::percent::percent;
use crate::report::radius::radius_bounds;
use crate::report::surface_view::{ContactsView, SurfaceView};
use crate::report::table::significant;
use crate::report::words::{OPEN, chance, flat_r, likelier, of_patch, radius_of_class};
use palpate_geometry::contact::counted;

/// What a surface can be coloured by: S where it has one, R, and their uncertainties where they are known.
pub(super) fn fields<'a>(view: &'a SurfaceView, document: &FitDocument) -> Vec<Field<'a>> {
    let largest = view.curvedness.iter().copied().filter(|r| r.is_finite()).fold(0.0, f64::max);
    let plane = document.shape.class.as_deref() == Some("plane");
    let inverse = Lengths::of(document).inverse();
    let mut all = Vec::new();
    if !plane {
        let fading = Some((&view.curvedness[..], largest));
        let (values, stops) = (&view.shape_index[..], &DIVERGING[..]);
        all.push(Field { key: "S", name: "shape index S".into(), values, ends: [-1.0, 1.0], stops, fading });
    }
    let values = &view.curvedness[..];
    let stops = &VIRIDIS[..];
    let name = format!("curvedness R ({inverse})");
    let from_zero = view.flat.map(|most| [0.0, most]);
    all.push(Field { key: "R", name, values, ends: from_zero.unwrap_or(ends(values)), stops, fading: None });
    if let Some([s, r]) = &view.uncertainty {
        let name = format!("uncertainty of R ({inverse})");
        let named = [("uS", "uncertainty of S".into(), &s[..]), ("uR", name, &r[..])];
        for (key, name, values) in named.into_iter().skip(usize::from(plane)) {
            all.push(Field { key, name, values, ends: ends(values), stops, fading: None });
        }
    }
    all
}

/// Large numbers at the top.
pub(super) fn cards(document: &FitDocument) -> String {
    let (shape, lengths) = (&document.shape, Lengths::of(document));
    let lines = |part: &MeasurePart| {
        let mut lines: Vec<String> =
            part.u.map(|u| format!("standard uncertainty {}", significant(u, 2))).into_iter().collect();
        lines.extend(interval_of(part));
        lines.extend(part.sd.map(|sd| variation(sd, part.mean)));
        lines
    };
    let mean = |part: &MeasurePart| part.mean.map_or("undefined".into(), shown);
    let mut out = String::from("<div class=\"cards\">\n");
    out.push_str(&class_card(shape));
    let r_name = format!("R, curvedness ({})", lengths.inverse());
    if let Some(r) = flat_r(shape) {
        let sure = shape.curvedness.level.map(|level| format!("{} sure", percent(level)));
        out.push_str(&card("S, shape index", "none", &["a flat surface has none".into()]));
        out.push_str(&card(&r_name, &r, &sure.into_iter().collect::<Vec<_>>()));
    } else {
        out.push_str(&card("S, shape index", &mean(&shape.shape_index), &lines(&shape.shape_index)));
        out.push_str(&card(&r_name, &mean(&shape.curvedness), &lines(&shape.curvedness)));
    }
    if let Some(radius) = radius_of_class(shape) {
        let level = named_level(shape.curvedness.level);
        let between = match radius_bounds(shape) {
            [Some(lo), Some(hi)] => apart([lo, hi]).map(|[lo, hi]| format!("{level} interval {lo} to {hi}")),
            [Some(lo), None] => Some(format!("{level} sure to be above {}", shown(lo))),
            _ => None,
        };
        out.push_str(&card(&lengths.along("Radius"), &shown(radius), &between.into_iter().collect::<Vec<_>>()));
    }
    out.push_str(&axis_card(shape).unwrap_or_default());
    out.push_str("</div>\n");
    out
}

/// The class with how sure it is; all of them where several stand side by side or the contacts leave it open.
fn class_card(shape: &ShapePart) -> String {
    if let Some(by_area) = &shape.class_by_area {
        let lines: Vec<String> = by_area.0.iter().map(|(name, share)| of_patch(name, *share)).collect();
        return card("Classes", "several", &lines);
    }
    let class = shape.class.as_deref().unwrap_or("none");
    if let Some((other, [own, likely])) = likelier(shape) {
        let lines = [(other, likely), (class, own)].map(|(name, share)| format!("{name} {}", chance(share)));
        return card("Class", &format!("{class} or {other}"), &lines);
    }
    let sure = shape.class_probability.as_ref().and_then(|shares| {
        let share = shares.0.iter().find(|(name, _)| name == class)?.1;
        Some(format!("{} sure", chance(share)))
    });
    card("Class", class, &sure.into_iter().collect::<Vec<_>>())
}

/// The way along a ridge or rut, and how well it is known.
fn axis_card(shape: &ShapePart) -> Option<String> {
    // where several shapes stand side by side, the axis in the middle is that of no shape
    if shape.class_by_area.is_some() {
        return None;
    }
    let level = named_level(shape.curvedness.level);
    let within = shape.axis_within_deg;
    let open = || "may run any way".to_string();
    let known = |words: &dyn Fn(f64) -> String| within.map(|w| if w > OPEN { open() } else { words(w) });
    if let Some(degrees) = shape.axis_deg {
        let between = known(&|w| {
            let ends = apart([degrees - w, degrees + w]);
            ends.map_or(String::new(), |[lo, hi]| format!("{level} interval {lo} to {hi}"))
        });
        let between = between.filter(|words| !words.is_empty());
        let lines: Vec<String> = between.into_iter().chain(["from x towards y".into()]).collect();
        return Some(card("Axis, degrees", &format!("{degrees:.1}"), &lines));
    }
    let [x, y, z] = shape.axis?;
    let between = known(&|w| format!("{level} sure within {} degrees", significant(w, 2)));
    Some(card("Axis, along x, y, z", &format!("{x:.2}, {y:.2}, {z:.2}"), &between.into_iter().collect::<Vec<_>>()))
}

/// A number that is rounding beside `size` is zero.
fn beside(value: f64, size: f64) -> f64 {
    if value.abs() <= 1e-9 * size.abs() { 0.0 } else { value }
}

/// How much a quantity differs from place to place; rounding is no variation.
fn variation(sd: f64, mean: Option<f64>) -> String {
    if beside(sd, mean.unwrap_or(0.0)) == 0.0 {
        return "the same all over the patch".into();
    }
    format!("varies by {} over the patch", significant(sd, 2))
}

/// A probability that does not claim certainty by rounding.
pub(super) fn probability(share: f64) -> String {
    match share {
        s if s > 0.9995 && s < 1.0 => "above 0.999".into(),
        s if s < 0.0005 && s > 0.0 => "below 0.001".into(),
        s => format!("{s:.3}"),
    }
}

/// The turning view, with a picture that stands there until it starts.
pub(super) fn stage(view: &SurfaceView, fields: &[Field]) -> String {
    let still = fields.first().map_or(String::new(), |field| picture(view, field));
    let mut hints = Vec::new();
    if let Some(contacts) = &view.contacts {
        let drawn = contacts.points.len();
        if drawn < contacts.all {
            hints.push(format!("{drawn} of the {} contacts are drawn, evenly chosen.", contacts.all));
        }
        let step = drawn.div_ceil(STROKES).max(1);
        if step > 1 {
            let strokes = drawn.div_ceil(step);
            hints.push(format!("Normals and residuals are drawn of {strokes} contacts, evenly chosen."));
        }
    }
    format!(
        "<section id=\"space\"><h2>The surface</h2>\n<div id=\"stage\" class=\"stage\">{still}\
         <p class=\"without\"><noscript>The turning view needs JavaScript and WebGL; this is a still picture of it.</noscript></p></div>\n\
         <div id=\"stage-controls\" class=\"controls\" hidden></div>\n<p class=\"hint\">{}</p></section>\n",
        text(&hints.join(" "))
    )
}

/// Maps of all that is known.
///
/// # Errors
/// What the system says of memory.
pub(super) fn maps(view: &SurfaceView, fields: &[Field], document: &FitDocument) -> std::io::Result<String> {
    let lengths = Lengths::of(document);
    let inverse = text(&lengths.inverse());
    let mut out = String::from("<section id=\"maps\"><h2>Maps over the patch</h2>\n<div class=\"figures\">\n");
    for (k, field) in fields.iter().enumerate() {
        let caption = match field.key {
            "S" => "<b>S, shape index.</b> Which shape: from cup over saddle to cap. It fades to grey where the surface is nearly flat.".into(),
            "R" => format!("<b>R, curvedness</b> ({inverse}). How strongly it is curved."),
            "uS" => "<b>Standard uncertainty of S</b>, point by point.".into(),
            _ => format!("<b>Standard uncertainty of R</b> ({inverse}), point by point."),
        };
        out.push_str(&figure(view, field, &caption, &view.axes.map(|name| lengths.along(name)), k == 0)?);
    }
    out.push_str("</div>\n");
    let mut hints = vec!["Grey: no contacts near enough to say anything.".to_string()];
    hints.extend(thinned(view));
    hints.push(format!("Uncertainty at single points: {}.", view.uncertainty_words));
    if view.uncertainty.is_some() {
        hints.push("A single point is known less well than the mean over the patch.".into());
    }
    let _ = writeln!(out, "<p class=\"hint\">{}</p></section>", text(&hints.join(" ")));
    Ok(out)
}

/// Every mean with what is known of it, and what the columns mean.
pub(super) fn numbers(document: &FitDocument) -> String {
    let (shape, inverse) = (&document.shape, Lengths::of(document).inverse());
    let number = |v: Option<f64>| v.map_or("-".into(), shown);
    // S runs from -1 to 1, curvatures are rounding where they are nothing beside R
    let size = shape.curvedness.mean.unwrap_or(0.0);
    let measured = |name: &str, part: &MeasurePart, size: f64, truth: Option<f64>| {
        let interval = part
            .interval
            .map_or("-".into(), |[lo, hi]| format!("{} to {}", precise(lo, hi - lo), precise(hi, hi - lo)));
        let u = part.u.map_or("-".into(), |u| significant(u, 2));
        vec![name.into(), number(part.mean), u, interval, number(part.sd.map(|v| beside(v, size))), number(truth)]
    };
    let curvature = |name: &str, part: &SpreadPart| {
        let [mean, sd] = [part.mean, part.sd].map(|value| number(value.map(|v| beside(v, size))));
        vec![name.into(), mean, "-".into(), "-".into(), sd, "-".into()]
    };
    let truth = document.truth.as_ref();
    let mut rows = vec![
        measured("S, shape index", &shape.shape_index, 1.0, truth.and_then(|t| t.shape_index)),
        measured(&format!("R, curvedness ({inverse})"), &shape.curvedness, size, truth.and_then(|t| t.curvedness)),
        curvature(&format!("k1, larger curvature ({inverse})"), &shape.k1),
        curvature(&format!("k2, smaller curvature ({inverse})"), &shape.k2),
    ];
    let interval =
        format!("{} interval", named_level(shape.curvedness.level.or(shape.shape_index.level).or(Some(0.95))));
    let mut head =
        vec!["", "Mean over the patch", "Standard uncertainty", &interval, "Variation over the patch", "Truth"];
    if truth.is_none() {
        head.pop();
        rows.iter_mut().for_each(|row| row.truncate(head.len()));
    }
    let mut out = format!("<section id=\"numbers\"><h2>Numbers</h2>\n{}", table(&head, &rows));
    out.push_str(
        "<dl class=\"terms\"><dt>Mean over the patch</dt><dd>the average over all points that contacts surround.</dd>\
         <dt>Standard uncertainty</dt><dd>how far the mean may be off, as a standard deviation.</dd>\
         <dt>Interval</dt><dd>holds the true mean with the probability that is named, if what it counts is all there is.</dd>\
         <dt>Variation over the patch</dt><dd>how much the surface itself differs from place to place. It is no uncertainty.</dd></dl>\n",
    );
    if let Some(probabilities) = &shape.class_probability {
        let mut rows: Vec<&(String, f64)> = probabilities.0.iter().filter(|(_, p)| *p > 0.0).collect();
        rows.sort_by(|a, b| b.1.total_cmp(&a.1));
        let rows: Vec<_> = rows.into_iter().map(|(name, p)| (name.clone(), *p, probability(*p))).collect();
        let _ = write!(out, "<h3>Probability of each class</h3>\n{}", bars(&rows));
    }
    out.push_str("</section>\n");
    out
}

/// How far the contacts lie off the surface.
pub(super) fn residuals(document: &FitDocument, contacts: &ContactsView) -> String {
    let belonging: Vec<f64> = contacts.belonging().collect();
    let Some(histogram) = Histogram::of(&belonging) else { return String::new() };
    let lengths = Lengths::of(document);
    let name = lengths.along(&format!("residual {}, contact less surface", contacts.measured));
    let chart = chart("Residuals of the contacts", |drawing, rect| {
        histogram.draw((drawing, rect), [&name, "contacts"], None, &[(Style::ZERO, 0.0)]);
    });
    let rms = &document.fit.rms;
    let mut said = Vec::new();
    let worst = belonging.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if let Some(z) = rms.z {
        said.push(format!(
            "Contacts lie {} off the surface (root mean square); the farthest {}.",
            lengths.of_size(significant(z, 3)),
            lengths.of_size(significant(worst, 3))
        ));
    }
    if let (Some(zx), Some(zy)) = (rms.zx, rms.zy) {
        said.push(format!("Their slopes are {} off in x and {} in y.", significant(zx, 3), significant(zy, 3)));
    }
    if let Some(angle) = rms.normal_deg {
        said.push(format!("Their normals are {} degrees off.", significant(angle, 3)));
    }
    said.extend(noise(document));
    let out = contacts.left_out.iter().filter(|out| **out).count();
    if out > 0 {
        let out = counted(out, "contact");
        said.push(format!("Too far off to belong to the surface, not counted here and drawn as crosses above: {out}."));
    }
    format!(
        "<section id=\"residuals\"><h2>Residuals</h2>\n<div class=\"figures\"><figure>{chart}</figure><div>{}</div></div></section>\n",
        list(&said)
    )
}

/// How far to trust all of it.
pub(super) fn trust(document: &FitDocument) -> String {
    let rest: Vec<String> = document.fit.notes.clone();
    format!(
        "<section id=\"certificate\"><h2>How far to trust it</h2>\n{}</section>\n{}",
        list(&certificate(document)),
        notes(&rest)
    )
}
