//! `parts.svg`: the contacts from two sides, each in its part's colour, with the parts' numbers and boundaries.
//!
//! ```text
//! across = right . p,  up = top . p,  depth = eye . p          eye: (1, -1, 0.8) and its opposite; far contacts first
//! ```
//!
//! A contact is drawn where its normal faces the eye; contacts without normals are all drawn. Those that have a neighbour in
//! another part are ringed in black.

use std::fmt::Write as _;
use std::io::Write;

use crate::contact::Contacts;
use crate::parts::Parts;
use crate::vector::{Vector, cross, dot, unit};

/// Pixels of one view.
const SIDE: f64 = 520.0;
/// Pixels at the top, for the title.
const TOP: f64 = 40.0;
/// Most contacts of one view; more only make the file large.
const DOTS: usize = 20_000;

/// Colours that stay apart for most kinds of sight (P. Tol's bright and muted schemes).
const COLOURS: [&str; 14] = [
    "#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#ee8866", "#332288", "#44aa99", "#999933",
    "#882255", "#dda0dd", "#117733", "#aaaa00",
];
/// Contacts in no part.
const NONE: &str = "#bbbbbb";

/// Draws the parts as an SVG; `edge` says which contacts have a neighbour in another part.
///
/// # Errors
/// What the system says.
pub(crate) fn write_parts_picture(
    contacts: &Contacts,
    found: &Parts,
    edge: &[bool],
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let (width, height) = (2.0 * SIDE, SIDE + TOP + 20.0 * (found.parts.len().div_ceil(4) as f64) + 10.0);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"sans-serif\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n\
         <text x=\"12\" y=\"24\" font-size=\"16\">{} parts from both sides; black rings: contacts at a boundary</text>\n",
        found.parts.len()
    );
    for (k, side) in [1.0, -1.0].into_iter().enumerate() {
        let eye = unit([side, -side, 0.8 * side]);
        view(contacts, found, edge, eye, k as f64 * SIDE, &mut text);
    }
    for (k, part) in found.parts.iter().enumerate() {
        let (x, y) = (12.0 + (k % 4) as f64 * 0.5 * SIDE, TOP + SIDE + 16.0 + 20.0 * (k / 4) as f64);
        let _ = writeln!(
            text,
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"6\" fill=\"{}\"/><text x=\"{}\" y=\"{}\" font-size=\"13\">{} {}, {} contacts</text>",
            colour(Some(k as u32)),
            x + 12.0,
            y + 4.5,
            part.id,
            part.kind.name(),
            part.points
        );
    }
    text.push_str("</svg>\n");
    out.write_all(text.as_bytes())
}

fn colour(label: Option<u32>) -> &'static str {
    label.map_or(NONE, |part| COLOURS[part as usize % COLOURS.len()])
}

fn view(contacts: &Contacts, found: &Parts, edge: &[bool], eye: Vector, left: f64, text: &mut String) {
    let right = unit(cross([0.0, 0.0, 1.0], eye));
    let top = cross(eye, right);
    let place = |r: usize| [contacts.x[r], contacts.y[r], contacts.z[r]];
    let seen = |r: usize| contacts.unit_normal(r).is_none_or(|n| dot(n, eye) > 0.0);
    let step = contacts.len().div_ceil(DOTS).max(1);
    let flat = |r: usize| [dot(right, place(r)), dot(top, place(r))];
    let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for r in 0..contacts.len() {
        let at = flat(r);
        (0..2).for_each(|k| (lo[k], hi[k]) = (lo[k].min(at[k]), hi[k].max(at[k])));
    }
    let span = (hi[0] - lo[0]).max(hi[1] - lo[1]).max(f64::MIN_POSITIVE);
    let scale = 0.92 * SIDE / span;
    let pixel = |[x, y]: [f64; 2]| {
        let middle = [0.5 * (lo[0] + hi[0]), 0.5 * (lo[1] + hi[1])];
        [left + 0.5 * SIDE + scale * (x - middle[0]), TOP + 0.5 * SIDE - scale * (y - middle[1])]
    };
    let mut order: Vec<(f64, usize)> =
        (0..contacts.len()).step_by(step).filter(|&r| seen(r)).map(|r| (dot(eye, place(r)), r)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let radius = (0.85 * found.spacing * scale * (step as f64).sqrt()).clamp(0.8, 9.0);
    let mut sums = vec![([0.0; 2], 0.0); found.parts.len()];
    for (_, r) in order {
        let [x, y] = pixel(flat(r));
        let ring = if edge.get(r).copied().unwrap_or(false) { " stroke=\"#000000\" stroke-width=\"0.8\"" } else { "" };
        let _ = writeln!(
            text,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\" fill=\"{}\"{ring}/>",
            colour(found.labels[r])
        );
        if let Some((sum, count)) = found.labels[r].and_then(|part| sums.get_mut(part as usize)) {
            *sum = [sum[0] + x, sum[1] + y];
            *count += 1.0;
        }
    }
    for (k, (sum, count)) in sums.iter().enumerate().filter(|(_, (_, count))| *count >= 12.0) {
        let [x, y] = [sum[0] / count, sum[1] / count];
        let _ = writeln!(
            text,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"10\" fill=\"#ffffff\" stroke=\"#000000\"/>\
             <text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"13\" text-anchor=\"middle\">{k}</text>",
            y + 4.5
        );
    }
}
