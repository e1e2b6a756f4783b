//! The page of a body: its parts in space, what each is and how well it is known, how they adjoin.

use std::fmt::Write as _;
use std::io::Write;

use super::body::PartsBody;
use super::figure::{precise, shown};
use super::html::{heading, short, text};
use super::provenance::Provenance;
use super::shell::Page;
use super::tables::{list, notes, table};
use crate::report::fold::PAGE_WIDTH;
use crate::report::json::write_json;
use crate::report::parts::{PartRecord, PartsDocument, write_parts_table};
use crate::report::relations::relation_lines;
use crate::report::table::significant;
use crate::report::words::like;
use palpate_geometry::contact::counted;

/// Half of a 95 % interval in standard uncertainties, of many contacts.
const FACTOR: f64 = 1.96;

/// Writes the page of a body.
///
/// # Errors
/// What the system says.
pub(crate) fn write_parts_page(
    document: &PartsDocument,
    body: &PartsBody<'_>,
    provenance: &Provenance,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let (mut json, mut words) = (Vec::new(), Vec::new());
    write_json(document, &mut json)?;
    write_parts_table(document, PAGE_WIDTH, &mut words)?;
    let names: Vec<String> = document.parts.iter().map(|part| format!("{} {}", part.id, kind(part))).collect();
    let mut sections = stage(body);
    sections.push_str(&parts(document));
    sections.push_str(&sizes(document));
    sections.push_str(&joints(document));
    sections.push_str(&relations(document));
    sections.push_str(&trust(document));
    sections.push_str(&notes(&document.notes));
    let page = Page {
        kind: "a body cut into parts",
        title: if provenance.scene.is_some() { short(&document.input) } else { heading(&document.input) },
        lead: text(&lead(document)),
        notices: Vec::new(),
        sections,
        document: &json,
        table: &words,
        view: (!document.parts.is_empty() || document.contacts > 0).then(|| body.data(&names)),
    };
    page.write(provenance, out)
}

/// `plane`, `cylinder, hollow`.
fn kind(part: &PartRecord) -> String {
    if part.hollow { format!("{}, seen from inside", part.kind) } else { part.kind.clone() }
}

/// Two planes and a cylinder.
fn lead(document: &PartsDocument) -> String {
    let mut kinds: Vec<(&str, usize)> = Vec::new();
    for part in &document.parts {
        match kinds.iter_mut().find(|(name, _)| *name == part.kind) {
            Some((_, count)) => *count += 1,
            None => kinds.push((&part.kind, 1)),
        }
    }
    let words: Vec<String> =
        kinds.iter().map(|(name, n)| format!("{n} {name}{}", if *n == 1 { "" } else { plural(name) })).collect();
    let named = match &words[..] {
        [] => "no part at all".to_string(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    };
    let left = match document.unassigned {
        0 => String::new(),
        n => format!(" In no part: {}.", counted(n, "contact")),
    };
    format!("The {} contacts show {named}.{left}", document.contacts)
}

fn plural(kind: &str) -> &'static str {
    if kind.ends_with("us") || kind.ends_with("ch") { "es" } else { "s" }
}

fn stage(body: &PartsBody<'_>) -> String {
    format!(
        "<section id=\"space\"><h2>The body</h2>\n<div id=\"stage\" class=\"stage\">{}\
         <p class=\"without\"><noscript>The turning view needs JavaScript and WebGL; this is a still picture of it.</noscript></p></div>\n\
         <div id=\"stage-controls\" class=\"controls\" hidden></div>\n<p class=\"hint\">{}</p></section>\n",
        body.picture(),
        text(&body.thinned().unwrap_or_default())
    )
}

/// What each part is, and whether the contacts agree.
fn parts(document: &PartsDocument) -> String {
    let rows: Vec<Vec<String>> = document
        .parts
        .iter()
        .map(|part| {
            let class = part.class.as_deref();
            let looks = class.map_or("-".into(), |class| match like(class) {
                "" => class.to_string(),
                like => {
                    part.other_class.as_ref().map_or(format!("{class}: {like}"), |other| format!("{class} or {other}"))
                }
            });
            let s = part.shape_index.map_or("-".into(), |s| format!("{s:.4}"));
            vec![
                part.id.to_string(),
                kind(part),
                looks,
                part.points.to_string(),
                s,
                significant(part.curvedness, 4),
                agreement(part),
            ]
        })
        .collect();
    let head = ["Part", "Kind", "Class", "Contacts", "S", "R (1/length)", "Do its contacts agree?"];
    format!("<section id=\"parts\"><h2>Parts</h2>\n{}</section>\n", table(&head, &rows))
}

fn agreement(part: &PartRecord) -> String {
    let off = significant(part.misfit, 2);
    let departure = significant(part.departure, 2);
    match part.rejected {
        Some(true) => format!(
            "No: they lie {off} off (root mean square), and noise alone would not leave that. The part departs from its kind by about {departure}."
        ),
        Some(false) => format!("Yes: they lie {off} off (root mean square), no more than their noise."),
        None if part.kind == "patch" => {
            format!("It is none of the simple kinds; its contacts lie {off} off a smooth surface.")
        }
        None => format!("They lie {off} off (root mean square); they are too few for a test."),
    }
}

/// Where every part lies and how large it is.
fn sizes(document: &PartsDocument) -> String {
    let mut rows = Vec::new();
    for part in &document.parts {
        let (g, u) = (&part.parameters, &part.u);
        let name = format!("{} {}", part.id, part.kind);
        let mut number = |what: &str, value: Option<f64>, u: Option<f64>| {
            let Some(value) = value else { return };
            let (sd, interval) = u.map_or(("-".into(), "-".into()), |u| {
                let [lo, hi] = [value - FACTOR * u, value + FACTOR * u];
                (significant(u, 2), format!("{} to {}", precise(lo, hi - lo), precise(hi, hi - lo)))
            });
            let value = u.map_or_else(|| shown(value), |u| precise(value, 2.0 * FACTOR * u));
            rows.push(vec![name.clone(), what.into(), value, sd, interval]);
        };
        number(if g.minor_radius.is_some() { "radius of the ring" } else { "radius" }, g.radius, u.radius);
        number("radius of the tube", g.minor_radius, u.minor_radius);
        number("half angle, degrees", g.half_angle_deg, u.half_angle_deg);
        // what is known of the coordinates, in their own unit, and how that is said
        let mut place = |what: &str, at: Option<[f64; 3]>, known: Option<f64>, said: Option<String>| {
            let Some(at) = at else { return };
            let places = known.filter(|u| *u > 0.0).map(|u| (1.0 - u.log10().floor()).clamp(0.0, 12.0) as usize);
            let at = at.map(|v| places.map_or_else(|| shown(v), |places| rounded(v, places))).join(", ");
            rows.push(vec![name.clone(), what.into(), at, said.unwrap_or("-".into()), "-".into()]);
        };
        let length = |u: Option<f64>| u.map(|u| significant(u, 2));
        let turned = u.axis_deg.map(|u| significant(u, 2) + " degrees");
        let direction = if part.kind == "plane" { "normal" } else { "direction of the axis" };
        place(direction, g.axis, u.axis_deg.map(f64::to_radians), turned);
        let point = match part.kind.as_str() {
            "sphere" | "torus" => "centre",
            "cylinder" | "cone" => "a point on the axis",
            _ => "a point on it",
        };
        place(point, Some(g.point), u.point, length(u.point));
        place("apex", g.apex, None, None);
    }
    let head = ["Part", "", "Value", "Standard uncertainty", "95 % interval"];
    let words = "Places and directions are x, y, z in the input's coordinates. The uncertainties count noise alone, also of parts \
                 whose contacts do not agree with their kind.";
    format!(
        "<section id=\"sizes\"><h2>Where they lie and how large they are</h2>\n{}<p class=\"hint\">{words}</p></section>\n",
        table(&head, &rows)
    )
}

/// A number with so many decimals; without a minus before a row of zeros.
fn rounded(value: f64, places: usize) -> String {
    let words = format!("{value:.places$}");
    if words.bytes().any(|digit| (b'1'..=b'9').contains(&digit)) { words } else { words.replace('-', "") }
}

fn joints(document: &PartsDocument) -> String {
    if document.joints.is_empty() {
        return String::new();
    }
    let name = |id: usize| {
        document.parts.iter().find(|part| part.id == id).map_or(id.to_string(), |part| format!("{id} {}", part.kind))
    };
    let rows: Vec<Vec<String>> = document
        .joints
        .iter()
        .map(|joint| {
            let like = match joint.kind.as_str() {
                "convex" => "convex: an edge that stands out",
                "concave" => "concave: an inner corner",
                _ => "smooth: one goes over into the other",
            };
            let [a, b] = joint.parts;
            vec![format!("{} and {}", name(a), name(b)), like.into(), joint.angle_words()]
        })
        .collect();
    let head = ["Parts", "How they meet", "The normal turns by, degrees"];
    format!("<section id=\"joints\"><h2>Joints</h2>\n{}</section>\n", table(&head, &rows))
}

fn relations(document: &PartsDocument) -> String {
    let lines: Vec<String> = relation_lines(&document.relations).iter().map(|line| text(line)).collect();
    if lines.is_empty() {
        return String::new();
    }
    let words = "A relation is probable where it holds more closely than chance would have it.";
    format!(
        "<section id=\"relations\"><h2>What ties them</h2>\n{}<p class=\"hint\">{words}</p></section>\n",
        list(&lines)
    )
}

fn trust(document: &PartsDocument) -> String {
    let noise = &document.noise;
    let mut said = vec![
        format!("Neighbouring contacts are some {} apart.", significant(document.spacing, 2)),
        format!(
            "Noise of one contact (standard deviation): {} along the normal, {} degrees in the normal.",
            significant(noise.distance, 2),
            significant(noise.normal_deg, 2)
        ),
        format!(
            "Departures from a simple kind of up to {} make no part of their own.",
            significant(document.tolerance, 2)
        ),
    ];
    if let Some(truth) = &document.truth {
        let mut words = format!(
            "Of this simulated body {:.2} % of the contacts are in the part of their face",
            100.0 * truth.right
        );
        if let Some(error) = truth.boundary_error {
            let _ = write!(words, "; boundaries are {} spacings off in the mean", significant(error, 2));
        }
        said.push(words + ".");
    }
    format!("<section id=\"certificate\"><h2>How far to trust it</h2>\n{}</section>\n", list(&said))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_have_no_sign() {
        assert_eq!([rounded(-3.4e-6, 4), rounded(-0.25, 1), rounded(12.345, 0)], ["0.0000", "-0.2", "12"]);
    }
}
