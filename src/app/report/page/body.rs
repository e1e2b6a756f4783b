//! A body in space: its contacts in the colours of their parts, as data of the turning view and as a still picture.
//!
//! ```text
//! contacts, normals, label of the part (none: 65535), at a boundary or not  ->  palpate-view, svg.perspective
//! ```

use serde_json::json;

use palpate_geometry::contact::Contacts;
use palpate_inference::parts::Parts;
use palpate_numeric::vector::{Vector, dot, unit};

use super::super::colour::{hex, mix};
use super::super::parts_picture::part_colour;
use super::camera::Camera;
use super::view_data::singles;

/// Contacts that the page holds; of more, every so many-th.
const MOST_CONTACTS: usize = 300_000;
/// Contacts of the still picture.
const DOTS: usize = 6_000;
/// Layers of the still picture from the farthest to the nearest.
const LAYERS: usize = 16;
/// Width of a dot in distances between neighbours, as in the turning view: so wide that nothing shows between them.
const COVER: f64 = 3.2;
/// Label of a contact in no part.
const NONE: f64 = 65_535.0;

/// What was cut into parts.
pub(crate) struct PartsBody<'a> {
    /// The contacts.
    pub contacts: &'a Contacts,
    /// Their parts.
    pub found: &'a Parts,
    /// Which contacts have a neighbour in another part.
    pub edge: &'a [bool],
}

impl PartsBody<'_> {
    fn every(&self, most: usize) -> impl Iterator<Item = usize> + use<'_> {
        (0..self.contacts.len()).step_by(self.contacts.len().div_ceil(most).max(1))
    }

    fn place(&self, r: usize) -> Vector {
        [self.contacts.x[r], self.contacts.y[r], self.contacts.z[r]]
    }

    fn normal(&self, r: usize) -> Option<Vector> {
        self.contacts.unit_normal(r).filter(|normal| normal.iter().all(|v| v.is_finite()))
    }

    /// How many contacts are in the page, where not all.
    pub(super) fn thinned(&self) -> Option<String> {
        let (held, all) = (self.every(MOST_CONTACTS).count(), self.contacts.len());
        (held < all).then(|| format!("{held} of the {all} contacts are drawn, evenly chosen."))
    }

    /// The data of the turning view; `names` of the parts are what the switches and the pointer say.
    pub(super) fn data(&self, names: &[String]) -> String {
        let all: Vec<usize> = self.every(MOST_CONTACTS).collect();
        let camera = Camera::new(&all.iter().map(|r| self.place(*r)).collect::<Vec<_>>());
        let centre = camera.centre();
        let label = |r: usize| self.found.labels[r].map_or(NONE, f64::from);
        let colours: Vec<_> = (0..names.len()).map(|k| part_colour(Some(k as u32))).collect();
        let normals: Option<Vec<Vector>> = all.iter().map(|r| self.normal(*r)).collect();
        let left = all.iter().any(|r| self.found.labels[*r].is_none());
        let (none, spacing) = (part_colour(None), self.found.spacing);
        json!({
            "body": {"names": names, "colours": colours, "none": none, "left": left, "spacing": spacing},
            "centre": centre,
            "points": singles(all.iter().flat_map(|r| [0, 1, 2].map(|k| self.place(*r)[k] - centre[k]))),
            "normals": normals.map(|normals| singles(normals.iter().flatten().copied())),
            "labels": singles(all.iter().map(|r| label(*r))),
            "edges": singles(all.iter().map(|r| f64::from(u8::from(self.edge.get(*r).copied().unwrap_or(false))))),
        })
        .to_string()
    }

    /// The still picture, from the eye of the turning view.
    pub(super) fn picture(&self) -> String {
        let all: Vec<usize> = self.every(DOTS).collect();
        let camera = Camera::new(&all.iter().map(|r| self.place(*r)).collect::<Vec<_>>());
        let canvas = camera.canvas();
        let mut order: Vec<(f64, usize)> = all.iter().map(|r| (camera.turned(self.place(*r))[2], *r)).collect();
        order.retain(|(_, r)| self.normal(*r).is_none_or(|normal| camera.faces(self.place(*r), normal)));
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut out = canvas.begin("The body in perspective, coloured by part");
        out.push_str(&canvas.edges(&camera, true));
        let light = unit([-0.25, -0.45, 1.0]);
        let apart = self.found.spacing * (self.contacts.len() as f64 / all.len().max(1) as f64).sqrt();
        let width = canvas.width(&camera, COVER * apart).clamp(3.0, 60.0);
        for layer in order.chunks(order.len().div_ceil(LAYERS).max(1)) {
            // a few shades for each part, so that few shapes hold all contacts
            let mut groups = std::collections::BTreeMap::<String, String>::new();
            for (_, r) in layer {
                let lit = self.normal(*r).map_or(1.0, |n| 0.62 + 0.38 * (4.0 * dot(n, light)).round() / 4.0);
                let shade = if self.edge.get(*r).copied().unwrap_or(false) { 0.3 } else { lit };
                let colour = mix([0; 3], part_colour(self.found.labels[*r]), shade.clamp(0.3, 1.0));
                groups
                    .entry(hex(colour))
                    .or_default()
                    .push_str(&format!("M{}h0", canvas.place(&camera, self.place(*r))));
            }
            for (colour, path) in groups {
                out.push_str(&format!(
                    "<path class=\"mark\" stroke=\"{colour}\" stroke-width=\"{width:.0}\" d=\"{path}\"/>\n"
                ));
            }
        }
        out.push_str(&canvas.edges(&camera, false));
        out + "</svg>\n"
    }
}
