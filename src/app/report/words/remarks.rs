//! How sure the values are and why, what else was noticed, and what to do next.

use super::super::document::{FitDocument, MeasurePart};
use super::super::table::{decimals, significant};
use super::Audience;
use super::class::{likelier, probability, radius_of_class, second};
use super::numbers::{DIGITS, chance};
use super::wrap::Labelled;

/// A class less likely than this is said to be open.
const SETTLED: f64 = 0.9;

/// Variation over the patch below this fraction of the mean (of R), or below this number (of S), is not worth a line.
const EVEN: f64 = 0.02;

/// Fraction of R beyond which its uncertainty asks for more contacts.
const WIDE: f64 = 0.1;

/// Below this p-value residuals hold a pattern.
const PATTERN: f64 = 0.05;

/// A pattern of less than so many per cent of the patch's rise is rounding, as in contacts without noise.
const UNSEEN: f64 = 1e-6;

/// A kind of surface less likely than this is not named beside the best one.
const NEAR: f64 = 0.005;

/// Less of the grid among the contacts than this is said.
const THIN: f64 = 0.2;

pub(super) fn remarks(document: &FitDocument, audience: Audience, text: &mut Labelled) {
    if let Some(words) = place(document) {
        text.add("place", words);
    }
    if let Some(words) = found_as(document) {
        text.add("found as", words);
    }
    if let Some(words) = varies(document) {
        text.add("varies", words);
    }
    if let Some((label, words)) = off(document) {
        text.add(label, words);
    }
    if let Some(words) = pattern(document) {
        text.add("pattern", words);
    }
    if let Some(words) = doubt(document) {
        text.add("doubt", words);
    }
    let shown = document.fit.notes.iter().filter(|note| !document.fit.technical_notes.contains(note));
    // without a result the first note says why, and what the fit lacked besides is for --verbose
    let most = match (audience.detailed, is_result(document)) {
        // the technical lines have all of them
        (true, _) => 0,
        (false, true) => usize::MAX,
        (false, false) => 1,
    };
    for note in shown.take(most) {
        text.add("note", note);
    }
    for words in next(document, audience) {
        text.add("next", words);
    }
}

/// Whether there is an answer: a class, or several that stand side by side.
fn is_result(document: &FitDocument) -> bool {
    document.shape.class.is_some() || document.shape.class_by_area.is_some()
}

/// Where a ball or a pipe lies.
fn place(document: &FitDocument) -> Option<String> {
    let shape = &document.shape;
    let (centre, radius) = (shape.centre?, radius_of_class(shape)?);
    let what = match shape.class.as_deref() {
        Some("cap" | "cup") => "the middle of the ball is at",
        Some("ridge" | "rut") => "the axis goes through",
        _ => return None,
    };
    // a place is known no better than the radius
    let places = decimals(radius, DIGITS);
    let [x, y, z] = centre.map(|v| {
        let text = format!("{v:.places$}");
        // no minus before a row of zeros
        if text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.')) { text.replace('-', "") } else { text }
    });
    let unit = document.unit.as_ref().map_or(String::new(), |unit| format!(" {unit}"));
    Some(format!("{what} x = {x}, y = {y}, z = {z}{unit}, in the coordinates of the input"))
}

/// The kind of surface that explains the contacts best, and the next best.
fn found_as(document: &FitDocument) -> Option<String> {
    let chosen = document.fit.chosen.as_ref()?;
    let hypothesis = chosen.hypothesis.as_deref()?;
    // whether it is flat, or bent so little that nobody can tell, is another question, which the first line answers
    let flat = document.shape.class.as_deref() == Some("plane");
    let known = |name: &str| chosen.tried.iter().find(|tried| tried.name == name).and_then(|tried| tried.probability);
    let sure = |name: &str| known(name).filter(|_| !flat);
    let said =
        |name: &str| format!("{}{}", in_words(name), sure(name).map_or(String::new(), |p| format!(" ({})", chance(p))));
    let count = chosen.tried.len();
    let Some(next) = chosen.tried.iter().find(|tried| tried.name != hypothesis) else {
        return Some(format!("{} explains the contacts, and no other kind of surface comes near", said(hypothesis)));
    };
    let best = said(hypothesis);
    // a plane is an answer only where it is likelier than all that bend
    if sure(&next.name).zip(sure(hypothesis)).is_some_and(|(of_next, of_best)| of_next > of_best) {
        let flat = said(&next.name);
        return Some(format!(
            "of {count} kinds of surface {flat} explains the contacts best, of those that bend {best}"
        ));
    }
    // what has next to no probability is worth no words
    let near = sure(&next.name).is_none_or(|p| p >= NEAR);
    let second = if near { format!("; next {}", said(&next.name)) } else { String::new() };
    Some(format!("of {count} kinds of surface {best} explains the contacts best{second}"))
}

/// What a kind of surface is.
fn in_words(hypothesis: &str) -> &str {
    match hypothesis {
        "plane" => "a plane",
        "sphere" => "a ball",
        "cylinder" => "a pipe or round bar",
        "general" => "an evenly bent surface",
        "paraboloid" => "a paraboloid",
        "quadric" => "an ellipsoid or another quadric",
        "torus" => "a ring (torus)",
        "cone" => "a cone",
        "surface of revolution" => "a curve turned about an axis",
        "extrusion" => "a curve drawn along a line",
        _ => "a free surface that follows the contacts",
    }
}

/// Variation from place to place, which is no uncertainty.
fn varies(document: &FitDocument) -> Option<String> {
    let shape = &document.shape;
    let of = |name: &str, part: &MeasurePart, least: f64| {
        let sd = part.sd.filter(|sd| *sd > least)?;
        Some(format!("{name} by {}", significant(sd, 4)))
    };
    let s = of("S", &shape.shape_index, EVEN);
    let r = of("R", &shape.curvedness, EVEN * shape.curvedness.mean.unwrap_or(0.0));
    let both: Vec<String> = s.into_iter().chain(r).collect();
    (!both.is_empty()).then(|| {
        format!(
            "from place to place {} (standard deviation); the values above are means over the patch",
            both.join(", ")
        )
    })
}

/// How far off the contacts are: the noise where the kind of surface was asked as well; of a model that was named, or of one
/// that only follows the contacts, a misfit, which holds what the model cannot bend to.
fn off(document: &FitDocument) -> Option<(&'static str, String)> {
    let fit = &document.fit;
    if !is_result(document) {
        return None;
    }
    let length = |value: f64| {
        let text = significant(value, 2);
        document.unit.as_ref().map_or(text.clone(), |unit| format!("{text} {unit}"))
    };
    let recognised = fit.chosen.as_ref().is_some_and(|chosen| chosen.hypothesis.is_some());
    if let (true, Some(sigma)) = (recognised, &fit.sigma) {
        let points = sigma.of_point().map(|sd| format!("measured points scatter by about {}", length(sd)));
        let normals = sigma.normal_deg.map(|v| format!("normals by about {} degrees", significant(v, 2)));
        let both: Vec<String> = points.into_iter().chain(normals).collect();
        let sds = if both.len() == 1 { "standard deviation" } else { "standard deviations" };
        let words = || format!("{} ({sds}, found from the contacts)", both.join(", "));
        return (!both.is_empty()).then(|| ("noise", words()));
    }
    let words = |rms| format!("the contacts lie {} off the surface on average (root mean square)", length(rms));
    fit.rms.z.map(|rms| ("misfit", words(rms)))
}

/// What neighbouring contacts are off by together.
fn pattern(document: &FitDocument) -> Option<String> {
    let lack = document.fit.lack_of_fit.as_ref().filter(|lack| lack.p.is_some_and(|p| p < PATTERN))?;
    if lack.percent_of_relief.is_some_and(|percent| percent < UNSEEN) {
        return None;
    }
    let size =
        lack.percent_of_relief.map_or(String::new(), |p| format!(", by {} % of the patch's rise", significant(p, 2)));
    Some(format!(
        "neighbouring contacts lie off the same way{size}: the bounds above allow for errors of the sensor, and details of the surface \
         that are as small are left out of S and R"
    ))
}

/// Where the uncertainty of R comes from, where it is worth a word.
fn doubt(document: &FitDocument) -> Option<String> {
    let part = &document.shape.curvedness;
    let (total, noise, model) = (part.u?, part.u_noise?, part.u_model?);
    let mean = part.mean.filter(|mean| *mean > 0.0)?;
    if noise.hypot(model) < 1e-3 * mean || document.shape.class.as_deref() == Some("plane") {
        return None;
    }
    let [total, noise, model] = [total, noise, model].map(|v| significant(v, 2));
    let beside = document.shape.intervals.as_ref().and_then(|part| part.beside.as_ref());
    let why = beside.map_or(String::new(), |other| {
        format!(
            ": {other} explains the contacts too and would differ; palpate fit without a named model chooses between them"
        )
    });
    Some(format!(
        "standard uncertainty of R {total}: {noise} from measuring noise, {model} from not knowing the kind of surface{why}"
    ))
}

/// What to do next.
fn next(document: &FitDocument, audience: Audience) -> Vec<String> {
    let shape = &document.shape;
    let mut next = Vec::new();
    if shape.class_by_area.is_some() {
        let draws =
            if audience.drawn { "are drawn place by place" } else { "change over the patch: --out DIR draws them" };
        next.push(format!("S and R {draws}; a smaller patch may show one shape alone"));
        return next;
    }
    let Some(class) = shape.class.as_deref() else {
        next.push("touch more places, a dozen or more, spread over the patch, with surface normals if you can".into());
        return next;
    };
    if class == "plane" {
        next.extend(flat(document));
        return next;
    }
    if let Some((other, _)) = likelier(shape) {
        next.push(format!(
            "whether it is a {other} or more of a {class} shows on a larger patch: touch farther out, or more densely"
        ));
    } else if let (Some(p), Some((other, q))) = (probability(shape, class).filter(|p| *p < SETTLED), second(shape)) {
        next.push(format!(
            "the contacts leave the class open: {class} {}, {other} {}; contacts over a larger patch would tell",
            chance(p),
            chance(q)
        ));
    }
    let wide = shape.curvedness.mean.zip(shape.curvedness.u).is_some_and(|(mean, u)| u > WIDE * mean);
    if wide && next.is_empty() {
        let model = shape.curvedness.u_model > shape.curvedness.u_noise;
        let what = if model {
            "contacts over a larger patch narrow the bounds of R"
        } else {
            "more contacts narrow the bounds of R"
        };
        next.push(what.into());
    }
    if shape.support < THIN {
        let [n, m] = shape.grid;
        let used = (shape.support * (n * m) as f64).round();
        next.push(format!(
            "only {used} of {n} x {m} grid points lie among the contacts, and S and R are means over those; \
             touch the patch more evenly"
        ));
    }
    next
}

/// What would still look flat.
fn flat(document: &FitDocument) -> Option<String> {
    let [_, most] = document.shape.curvedness.interval?;
    let ball = 1.0 / most;
    let pipe = std::f64::consts::FRAC_1_SQRT_2 / most;
    let unit = document.unit.as_ref().map_or(String::new(), |unit| format!(" {unit}"));
    ball.is_finite().then(|| {
        format!(
            "a pipe of radius {}{unit} or more, or a ball of radius {}{unit} or more, would look as flat as this; \
             touch a larger patch to tell",
            significant(pipe, 2),
            significant(ball, 2)
        )
    })
}
