//! `parts`: the contacts from two sides, each in its part's colour, with the parts' numbers and boundaries.
//!
//! ```text
//! across = right . p,  up = top . p,  depth = eye . p          eye: (1, -1, 0.8) and its opposite; far contacts first
//! ```
//!
//! A contact is drawn where its normal faces the eye; contacts without normals are all drawn. Those that have a neighbour in
//! another part are ringed in black.

use std::io::Write;

use palpate_geometry::contact::Contacts;
use palpate_inference::parts::Parts;
use palpate_numeric::vector::{Vector, cross, dot, unit};

use super::drawing::{Anchor, Colour, Drawing};
use super::pictures::{PictureFormat, write_drawing};

/// Pixels of one view.
const SIDE: f64 = 420.0;
/// Pixels at the top, for the title.
const TOP: f64 = 40.0;
/// Most contacts of one view: both views of so many stay below 200 kB.
const DOTS: usize = 8_000;
/// Layers from the farthest to the nearest; within one, the contacts of a part are one shape.
const LAYERS: usize = 24;

/// Colours that stay apart for most kinds of sight (P. Tol's bright and muted schemes).
const COLOURS: [Colour; 14] = [
    [0x44, 0x77, 0xaa],
    [0xee, 0x66, 0x77],
    [0x22, 0x88, 0x33],
    [0xcc, 0xbb, 0x44],
    [0x66, 0xcc, 0xee],
    [0xaa, 0x33, 0x77],
    [0xee, 0x88, 0x66],
    [0x33, 0x22, 0x88],
    [0x44, 0xaa, 0x99],
    [0x99, 0x99, 0x33],
    [0x88, 0x22, 0x55],
    [0xdd, 0xa0, 0xdd],
    [0x11, 0x77, 0x33],
    [0xaa, 0xaa, 0x00],
];
/// Contacts in no part.
const NONE: Colour = [0xbb; 3];
const BLACK: Colour = [0; 3];
const WHITE: Colour = [255; 3];

/// Draws the parts; `edge` says which contacts have a neighbour in another part.
///
/// # Errors
/// What the system says.
pub(crate) fn write_parts_picture(
    contacts: &Contacts,
    found: &Parts,
    edge: &[bool],
    format: PictureFormat,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let rows = found.parts.len().div_ceil(4) as f64;
    let mut drawing = Drawing::new(2.0 * SIDE, SIDE + TOP + 20.0 * rows + 10.0);
    let step = contacts.len().div_ceil(DOTS).max(1);
    let thinned = match step {
        1 => String::new(),
        _ => format!("; {} of {} contacts, evenly chosen", contacts.len().div_ceil(step), contacts.len()),
    };
    let title = format!("{} parts from both sides; black rings: contacts at a boundary{thinned}", found.parts.len());
    drawing.word([12.0, 18.0], title, 16.0, Anchor::Start);
    for (k, side) in [1.0, -1.0].into_iter().enumerate() {
        let eye = unit([side, -side, 0.8 * side]);
        View { contacts, found, edge, step }.draw(eye, k as f64 * SIDE, &mut drawing);
    }
    for (k, part) in found.parts.iter().enumerate() {
        let (x, y) = (12.0 + (k % 4) as f64 * 0.5 * SIDE, TOP + SIDE + 16.0 + 20.0 * (k / 4) as f64);
        drawing.dots(vec![[x, y]], 6.0, part_colour(Some(k as u32)));
        let words = format!("{} {}, {} contacts", part.id, part.kind.name(), part.points);
        drawing.word([x + 12.0, y], words, 12.0, Anchor::Start);
    }
    write_drawing(&drawing, format, out)
}

/// The colour of a part.
pub(super) fn part_colour(label: Option<u32>) -> Colour {
    label.map_or(NONE, |part| COLOURS[part as usize % COLOURS.len()])
}

/// What is drawn, every `step`-th contact.
struct View<'a> {
    contacts: &'a Contacts,
    found: &'a Parts,
    edge: &'a [bool],
    step: usize,
}

impl View<'_> {
    fn draw(&self, eye: Vector, left: f64, drawing: &mut Drawing) {
        let View { contacts, found, edge, step } = *self;
        let right = unit(cross([0.0, 0.0, 1.0], eye));
        let top = cross(eye, right);
        let place = |r: usize| [contacts.x[r], contacts.y[r], contacts.z[r]];
        let seen = |r: usize| contacts.unit_normal(r).is_none_or(|n| dot(n, eye) > 0.0);
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
        let radius = (1.4 * found.spacing * scale * (step as f64).sqrt()).clamp(0.8, 12.0);
        for layer in order.chunks(order.len().div_ceil(LAYERS).max(1)) {
            let points = |wanted: &dyn Fn(usize) -> bool| -> Vec<[f64; 2]> {
                layer.iter().filter(|(_, r)| wanted(*r)).map(|(_, r)| pixel(flat(*r))).collect()
            };
            let rings = points(&|r| edge.get(r).copied().unwrap_or(false));
            if !rings.is_empty() {
                drawing.dots(rings, radius + 0.8, BLACK);
            }
            for label in (0..found.parts.len() as u32).map(Some).chain([None]) {
                let dots = points(&|r| found.labels[r] == label);
                if !dots.is_empty() {
                    drawing.dots(dots, radius, part_colour(label));
                }
            }
        }
        for k in 0..found.parts.len() {
            let of_part: Vec<[f64; 2]> = order
                .iter()
                .filter(|(_, r)| found.labels[*r] == Some(k as u32))
                .map(|(_, r)| pixel(flat(*r)))
                .collect();
            if of_part.len() >= 12 {
                let middle = [0, 1].map(|axis| of_part.iter().map(|p| p[axis]).sum::<f64>() / of_part.len() as f64);
                drawing.dots(vec![middle], 10.5, BLACK);
                drawing.dots(vec![middle], 9.5, WHITE);
                drawing.word(middle, k.to_string(), 13.0, Anchor::Middle);
            }
        }
    }
}
