//! Whether the normals that a file gives its vertices are those of its facets.
//!
//! ```text
//! spread       twice the largest angle between one facet around a vertex and the others: no two of them differ by more
//! of others    the vertex's normal is more than that, and a degree, from the nearest of them
//! ```
//!
//! A normal of a smooth surface lies among those of the facets around it, and a mean over an edge does, too. Some programs write directions
//! from the middle of a body instead, which are its normals only where it is a ball.

use palpate_numeric::vector::{Vector, cross, dot, norm};

use super::Facets;

/// Angle, in radians, that means nothing: facets of six digits turn by a degree where they are ten thousand times as long as high.
const SLACK: f64 = std::f64::consts::PI / 180.0;

/// Whether most of the vertices that have facets have normals of another surface; which of its two sides they name does not matter.
pub(super) fn are_of_others(facets: &Facets, normals: &[Vector]) -> bool {
    let mut around: Vec<(usize, usize)> =
        facets.corners.iter().enumerate().flat_map(|(facet, corners)| corners.map(|vertex| (vertex, facet))).collect();
    around.sort_unstable();
    let (mut of_others, mut all) = (0_usize, 0_usize);
    for star in around.chunk_by(|a, b| a.0 == b.0) {
        let Some(normal) = normals.get(star[0].0).filter(|normal| norm(**normal) > 0.0) else { continue };
        let to = |facet: usize, direction: &Vector| angle(facets.normals[facet], *direction);
        let nearest = star.iter().map(|(_, facet)| to(*facet, normal)).fold(f64::INFINITY, f64::min);
        let first = facets.normals[star[0].1];
        let spread = 2.0 * star.iter().map(|(_, facet)| to(*facet, &first)).fold(0.0, f64::max);
        all += 1;
        of_others += usize::from(nearest > spread + SLACK);
    }
    2 * of_others > all
}

/// Angle between two lines.
fn angle(a: Vector, b: Vector) -> f64 {
    norm(cross(a, b)).atan2(dot(a, b).abs())
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use palpate_geometry::contact::{Contacts, Orientation};
    use palpate_numeric::vector::{dot, minus, unit};

    use crate::io::{Input, ReadOptions, read_input_bytes};

    const SIDES: usize = 60;
    const RINGS: usize = 15;

    /// A bar of radius 1 and length 3 with half a ball at either end, each vertex with the normal that `normal` gives it.
    fn capsule(normal: impl Fn([f64; 3]) -> [f64; 3]) -> Contacts {
        let mut text = String::new();
        for ring in 0..2 * RINGS {
            let (upper, number) = (ring / RINGS, ring % RINGS);
            let down = std::f64::consts::FRAC_PI_2 * (number as f64 + 0.5 * (1 - upper) as f64) / (RINGS as f64 - 0.5);
            let (radius, height) =
                if upper == 0 { (down.sin(), -1.5 - down.cos()) } else { (down.cos(), 1.5 + down.sin()) };
            for side in 0..SIDES {
                let round = std::f64::consts::TAU * side as f64 / SIDES as f64;
                let place = [radius.max(0.02) * round.cos(), radius.max(0.02) * round.sin(), height];
                let [nx, ny, nz] = normal(place);
                writeln!(text, "v {} {} {}\nvn {nx} {ny} {nz}", place[0], place[1], place[2]).unwrap();
            }
        }
        for ring in 0..2 * RINGS - 1 {
            for side in 0..SIDES {
                let at = |ring: usize, side: usize| ring * SIDES + side % SIDES + 1;
                let [a, b] = [at(ring, side), at(ring, side + 1)];
                let [c, d] = [at(ring + 1, side + 1), at(ring + 1, side)];
                writeln!(text, "f {a}//{a} {b}//{b} {c}//{c} {d}//{d}").unwrap();
            }
        }
        match read_input_bytes("f.obj", text.as_bytes(), &ReadOptions::default()).unwrap().input {
            Input::Contacts(contacts) => contacts,
            Input::Grid(_) => panic!("a grid"),
        }
    }

    /// The normal of the capsule at a place.
    fn true_normal(place: [f64; 3]) -> [f64; 3] {
        unit(minus(place, [0.0, 0.0, place[2].clamp(-1.5, 1.5)]))
    }

    /// Contacts on the bar between its rims, and the least cosine between a contact's normal and the true one.
    fn told(contacts: &Contacts) -> (usize, f64) {
        assert!(matches!(contacts.orientation, Orientation::Normals { .. }));
        let place = |r: usize| [contacts.x[r], contacts.y[r], contacts.z[r]];
        let on_bar = (0..contacts.len()).filter(|r| contacts.z[*r].abs() < 1.4).count();
        let cosines = (0..contacts.len()).map(|r| dot(contacts.unit_normal(r).unwrap(), true_normal(place(r))));
        (on_bar, cosines.fold(1.0, f64::min))
    }

    #[test]
    fn a_bar_without_vertices_between_its_rims_is_sampled_whatever_normals_the_file_has() {
        for contacts in [capsule(true_normal), capsule(unit)] {
            let (on_bar, least) = told(&contacts);
            assert!(3 * on_bar > contacts.len(), "{on_bar} of {}", contacts.len());
            assert!(least > 0.99, "{least}");
        }
    }
}
