//! Contacts at the vertices of a fine mesh, each with the normal of the facets around it.
//!
//! ```text
//! n      mean of the facets' normals as [`super::sectors`] weighs them
//! edge   two facets meet at 40 degrees or more, or one leans as much away from n: the vertex has no one normal, and is left out
//! ```
//!
//! The places say where the surface lies; which side of it is free is said by the order of the corners alone. Where half of the vertices
//! have no one normal the facets follow the noise of a scan, and say nothing of the surface.

use super::seams::{SHARP, SeamKind, Seams, angle};
use super::sectors::Sectors;
use super::{FacetContacts, Facets, Sampling, samples::FacetSample, winding};

/// All vertices that have one normal; `None` where these are the fewer.
pub(super) fn at_vertices(mut facets: Facets) -> Option<FacetContacts> {
    let mut seams = Seams::between(&facets);
    winding::unify(&mut facets, &mut seams);
    for seam in &mut seams.all {
        // at a rim the surface goes on, though the facets do not
        let is_sharp = angle(&facets, seam.facets[0], seam.facets[1]) >= SHARP;
        seam.kind = if is_sharp { SeamKind::Joint } else { SeamKind::Smooth };
    }
    let sectors = Sectors::of(&facets, &seams);
    let mut samples: Vec<Option<FacetSample>> = (0..facets.places.len()).map(|_| None).collect();
    let mut several = vec![false; facets.places.len()];
    for (facet, corners) in facets.corners.iter().enumerate() {
        for &vertex in corners {
            let sector = sectors.at(&facets, facet, vertex);
            let normal = sectors.normal(sector);
            // two sheets that touch in a vertex alone are two sectors of it
            several[vertex] |=
                sectors.is_broken(sector) || samples[vertex].as_ref().is_some_and(|s| s.normal != normal);
            samples[vertex].get_or_insert(FacetSample { place: facets.places[vertex], normal, facet });
        }
    }
    let touched = samples.iter().flatten().count();
    let kept = samples.into_iter().zip(&several).filter(|(_, several)| !**several).filter_map(|(sample, _)| sample);
    let samples: Vec<FacetSample> = kept.collect();
    let on_edges = touched - samples.len();
    (samples.len() > on_edges).then(|| FacetContacts {
        vertices: samples.len(),
        samples,
        has_edges: on_edges > 0,
        sampling: Sampling::AtVertices { on_edges },
    })
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use palpate_geometry::contact::Orientation;
    use palpate_numeric::vector::{Vector, dot, unit};

    use crate::io::{Input, ReadOptions, Reading, read_input_bytes};

    /// A ball by rings of squares, open at its poles.
    fn ball(rings: usize, sides: usize) -> (Vec<Vector>, Vec<[usize; 4]>) {
        let pi = std::f64::consts::PI;
        let place = |ring: usize, side: usize| {
            let (down, round) = (pi * (ring as f64 + 0.5) / rings as f64, 2.0 * pi * side as f64 / sides as f64);
            [down.sin() * round.cos(), down.sin() * round.sin(), down.cos()]
        };
        let places = (0..rings * sides).map(|k| place(k / sides, k % sides)).collect();
        let squares = (0..(rings - 1) * sides).map(|k| {
            let (ring, side) = (k / sides, k % sides);
            let next = (side + 1) % sides;
            [(ring, side), (ring + 1, side), (ring + 1, next), (ring, next)].map(|(ring, side)| ring * sides + side)
        });
        (places, squares.collect())
    }

    fn read(places: &[Vector], squares: &[[usize; 4]]) -> Reading {
        let mut text = String::new();
        places.iter().for_each(|[x, y, z]| writeln!(text, "v {x} {y} {z}").unwrap());
        squares.iter().for_each(|s| writeln!(text, "f {} {} {} {}", s[0] + 1, s[1] + 1, s[2] + 1, s[3] + 1).unwrap());
        read_input_bytes("f.obj", text.as_bytes(), &ReadOptions::default()).unwrap()
    }

    /// Places and unit normals.
    fn contacts(reading: &Reading) -> Vec<(Vector, Vector)> {
        let Input::Contacts(contacts) = &reading.input else { panic!("a grid") };
        let Orientation::Normals { .. } = contacts.orientation else { panic!("no normals: {:?}", reading.notes) };
        let at = |r: usize| ([contacts.x[r], contacts.y[r], contacts.z[r]], contacts.unit_normal(r).unwrap());
        (0..contacts.len()).map(at).collect()
    }

    #[test]
    fn normals_of_a_fine_ball_point_outwards_however_its_faces_are_wound() {
        let (places, mut squares) = ball(40, 80);
        squares.iter_mut().step_by(3).for_each(|square| square.reverse());
        let found = contacts(&read(&places, &squares));
        assert_eq!(found.len(), places.len());
        assert!(found.iter().all(|(place, normal)| dot(unit(*place), *normal) > 0.99));
    }

    #[test]
    fn vertices_on_an_edge_are_left_out() {
        let (mut places, squares) = ball(40, 80);
        let above = places.iter().filter(|p| p[2] > 0.5).count();
        places.iter_mut().filter(|p| p[2] > 0.5).for_each(|p| p[2] = 0.5);
        let reading = read(&places, &squares);
        let found = contacts(&reading);
        assert!(found.iter().all(|(place, normal)| {
            let expected = if place[2] == 0.5 { [0.0, 0.0, 1.0] } else { unit(*place) };
            dot(expected, *normal) > 0.9
        }));
        let left = places.len() - found.len();
        assert!(left >= 80 && left < above, "{left} of {above}");
        assert!(reading.notes[0].contains(&format!("{left} on edges")), "{:?}", reading.notes);
    }

    #[test]
    fn facets_that_follow_the_noise_of_a_scan_tell_no_normals() {
        let (mut places, squares) = ball(60, 120);
        let mut generator = palpate_numeric::draws::Lcg::new(5);
        places.iter_mut().for_each(|p| *p = p.map(|v| v * (1.0 + 0.2 * (generator.uniform() - 0.5))));
        let reading = read(&places, &squares);
        let Input::Contacts(contacts) = &reading.input else { panic!("a grid") };
        assert_eq!(contacts.orientation, Orientation::None);
        assert!(reading.notes[0].contains("too rough"), "{:?}", reading.notes);
    }
}
