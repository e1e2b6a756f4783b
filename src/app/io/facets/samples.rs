//! Where a coarse mesh is sampled, evenly by area and the same every time.
//!
//! ```text
//! places  2000 over the whole, and up to 10000 for the pieces between sharp edges to have 48, twice what a part needs; but for
//!         the smallest, which are a hundredth of the area
//! along   p = a + (k + u) / m (b - a)         m by the share of the area, u another for every seam
//! within  (u, v) = frac(k (0.7549, 0.5698)), folded into the triangle
//! normal  A_m n + A_n m of the facets beside a seam, A their areas: that of the circle through three corners
//! open    sagitta   |seam| |l_a + l_b| / 8 of bent seams, width angle / 8 across straight ones
//! ```
//!
//! `l` is the lean of [`super::straight`], measured from each end into the seam. Places along seams are shifted from seam to seam, because
//! rings at equal heights would look like a file written in coarse steps. The two numbers are M. Roberts' R2 sequence (2018).

use palpate_numeric::vector::{Vector, along, minus, norm, scaled, unit_or_zero};

use super::faces::judge;
use super::seams::{Seam, SeamKind, Seams, angle};
use super::sectors::Sectors;
use super::straight::{apart, leans};
use super::winding;
use super::{FacetContacts, Facets, PLACES, Sampling};

/// Contacts along a seam for each width of the facets beside it: more would stand in lines, not on a surface.
const ALONG: f64 = 2.0;

/// Contacts of a piece of the surface at least: twice as many as a part has, for those at its rims may be taken for others'.
const OF_PIECE: f64 = 48.0;

/// Contacts in all at most, which parts take two seconds for.
const MOST_PLACES: f64 = 10_000.0;

/// Share of the area in the smallest pieces, which may have fewer.
const SLIVERS: f64 = 0.01;

/// Fractions whose multiples fill a square evenly.
const R2: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];

/// One contact and the facet that it stands on.
pub(super) struct FacetSample {
    pub(super) place: Vector,
    pub(super) normal: Vector,
    pub(super) facet: usize,
}

/// Contacts that stand for a unit of area: so many that the smaller pieces have some, too.
fn density(facets: &Facets, seams: &Seams) -> f64 {
    let mut areas: Vec<f64> =
        pieces(facets, seams).into_iter().map(|piece| piece.into_iter().map(|f| facets.areas[f]).sum()).collect();
    areas.sort_by(f64::total_cmp);
    let mut left = SLIVERS * facets.area();
    let small = areas.iter().copied().find(|area| {
        left -= area;
        left < 0.0
    });
    (OF_PIECE / small.unwrap_or(f64::INFINITY)).clamp(PLACES / facets.area(), MOST_PLACES / facets.area())
}

/// Facets that go over into each other without a joint.
fn pieces(facets: &Facets, seams: &Seams) -> Vec<Vec<usize>> {
    let mut is_taken = vec![false; facets.len()];
    let mut found = Vec::new();
    for first in 0..facets.len() {
        if std::mem::replace(&mut is_taken[first], true) {
            continue;
        }
        let mut piece = vec![first];
        let mut at = 0;
        while let Some(&facet) = piece.get(at) {
            at += 1;
            let goes_on = seams.of[facet].map(|seam| seams.all[seam]).into_iter();
            for next in goes_on.filter(|seam| seam.kind != SeamKind::Joint).filter_map(|seam| seam.other(facet)) {
                if !std::mem::replace(&mut is_taken[next], true) {
                    piece.push(next);
                }
            }
        }
        found.push(piece);
    }
    found
}

/// Gives out contacts as what stands for them adds up.
struct Allotment {
    sum: f64,
}

impl Allotment {
    fn new() -> Allotment {
        Allotment { sum: 0.5 }
    }

    /// Contacts of the next stretch, at most `most`.
    fn take(&mut self, contacts: f64, most: f64) -> usize {
        self.sum += contacts.min(most);
        let whole = self.sum.floor();
        self.sum -= whole;
        whole as usize
    }
}

/// All contacts of a mesh: along straight seams, at the ends of bent ones, within flat faces.
pub(super) fn of(mut facets: Facets) -> FacetContacts {
    let mut seams = Seams::between(&facets);
    winding::unify(&mut facets, &mut seams);
    let flat = judge(&facets, &mut seams);
    let sectors = Sectors::of(&facets, &seams);
    let smooth: Vec<Seam> = seams.all.iter().filter(|seam| seam.kind == SeamKind::Smooth).copied().collect();
    let (bent, straight) = apart(&facets, &sectors, smooth);
    let density = density(&facets, &seams);
    let sampling = Sampling::Between { open: 0.0 };
    let mut found = FacetContacts { samples: Vec::new(), vertices: 0, has_edges: false, sampling };
    found.has_edges = seams.all.iter().any(|seam| seam.kind == SeamKind::Joint && seam.facets[0] != seam.facets[1]);
    let beside = along_seams((&facets, density), &straight, &mut found);
    let open = beside.max(at_ends(&facets, &sectors, [&bent, &straight], &mut found));
    found.sampling = Sampling::Between { open };
    within_faces((&facets, density), &flat, &mut found);
    found
}

/// Gives back how far the facets are from the surface beside the seams.
fn along_seams((facets, density): (&Facets, f64), straight: &[Seam], found: &mut FacetContacts) -> f64 {
    let mut open: f64 = 0.0;
    let length = |seam: &Seam| norm(minus(facets.places[seam.ends[1]], facets.places[seam.ends[0]]));
    // a facet's area is that of its straight seams, by their lengths
    let mut lengths = vec![0.0; facets.len()];
    straight.iter().for_each(|seam| seam.facets.iter().for_each(|&f| lengths[f] += length(seam)));
    let mut allotment = Allotment::new();
    for (number, seam) in straight.iter().enumerate() {
        let [a, b] = seam.ends.map(|end| facets.places[end]);
        let length = length(seam);
        let area: f64 = seam.facets.iter().map(|&f| facets.areas[f] * length / lengths[f]).sum();
        let width = seam.facets.iter().map(|&f| facets.areas[f]).sum::<f64>() / length;
        let count = allotment.take(area * density, ALONG * length / width);
        let [n, m] = seam.facets.map(|f| facets.normals[f]);
        // on a circle through three corners a chord's normal is off by half its own angle
        let [of_n, of_m] = seam.facets.map(|f| facets.areas[f]);
        let shift = (0.5 + number as f64 * R2[0]).fract();
        found.samples.extend((0..count).map(|k| FacetSample {
            place: along(a, (k as f64 + shift) / count as f64, minus(b, a)),
            normal: unit_or_zero(along(scaled(of_m, n), of_n, m)),
            facet: seam.facets[0],
        }));
        open = open.max(width * angle(facets, seam.facets[0], seam.facets[1]) / 8.0);
    }
    open
}

/// Gives back how far the facets are from the surface beneath the seams. Vertices stand densely where a mesh is fine, and are taken as the
/// area asks for, lest a few details be most of the contacts.
fn at_ends(facets: &Facets, sectors: &Sectors, [bent, straight]: [&[Seam]; 2], found: &mut FacetContacts) -> f64 {
    let mut open: f64 = 0.0;
    let mut areas = vec![0.0; 3 * facets.len()];
    for (facet, corners) in facets.corners.iter().enumerate() {
        corners.iter().for_each(|&v| areas[sectors.at(facets, facet, v)] += facets.areas[facet] / 3.0);
    }
    // where a straight surface goes over into a bent one, the normal is a mean of both
    let mut taken = vec![false; 3 * facets.len()];
    for seam in straight {
        seam.ends.iter().for_each(|&end| taken[sectors.at(facets, seam.facets[0], end)] = true);
    }
    let mut allotment = Allotment::new();
    for seam in bent {
        let [from, to] = leans(facets, sectors, seam);
        let length = norm(minus(facets.places[seam.ends[1]], facets.places[seam.ends[0]]));
        open = open.max(length * (from + to).abs() / 8.0);
        for end in seam.ends {
            let facet = seam.facets[0];
            let sector = sectors.at(facets, facet, end);
            if sectors.is_broken(sector) || std::mem::replace(&mut taken[sector], true) {
                continue;
            }
            if allotment.take(areas[sector] / facets.area_of_one(), 1.0) > 0 {
                found.vertices += 1;
                found.samples.push(FacetSample { place: facets.places[end], normal: sectors.normal(sector), facet });
            }
        }
    }
    open
}

fn within_faces((facets, density): (&Facets, f64), flat: &[bool], found: &mut FacetContacts) {
    let mut allotment = Allotment::new();
    let mut number = 0;
    for facet in (0..facets.len()).filter(|&f| flat[f]) {
        let [a, b, c] = facets.corners[facet].map(|v| facets.places[v]);
        for _ in 0..allotment.take(facets.areas[facet] * density, f64::INFINITY) {
            number += 1;
            let [u, v] = R2.map(|r| (f64::from(number) * r).fract());
            let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
            let place = along(along(a, u, minus(b, a)), v, minus(c, a));
            found.samples.push(FacetSample { place, normal: facets.normals[facet], facet });
        }
    }
}

#[cfg(test)]
mod tests {
    use palpate_numeric::vector::{dot, unit};

    use super::*;

    /// A box of these sides; its faces are wound outwards.
    fn box_of(at: Vector, [a, b, c]: [f64; 3]) -> (Vec<Vector>, Vec<[usize; 3]>) {
        let corner =
            |k: usize| [at[0] + a * (k & 1) as f64, at[1] + b * (k >> 1 & 1) as f64, at[2] + c * (k >> 2 & 1) as f64];
        let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = squares.iter().flat_map(|[p, q, r, s]| [[*p, *q, *r], [*p, *r, *s]]).collect();
        ((0..8).map(corner).collect(), triangles)
    }

    #[test]
    fn small_faces_have_contacts_for_a_part_and_a_cube_has_no_more_for_it() {
        let (places, triangles) = box_of([0.0; 3], [1.0; 3]);
        assert_eq!(of(Facets::of(places.clone(), &triangles)).samples.len(), PLACES as usize);
        // drawn from both sides it is the same
        let other_side = triangles.iter().map(|[a, b, c]| [*a, *c, *b]);
        let both: Vec<[usize; 3]> = triangles.iter().copied().chain(other_side).collect();
        assert_eq!(of(Facets::of(places, &both)).samples.len(), PLACES as usize);
        let (mut places, mut triangles) = box_of([0.0; 3], [1.0, 1.0, 1.0]);
        let (others, small) = box_of([2.0, 0.0, 0.0], [0.2, 0.2, 0.2]);
        let before = places.len();
        places.extend(others);
        triangles.extend(small.iter().map(|corners| corners.map(|v| v + before)));
        let found = of(Facets::of(places, &triangles));
        let on_top = found.samples.iter().filter(|s| s.place[0] >= 2.0 && s.normal[2] > 0.9).count();
        assert!((40..=60).contains(&on_top) && found.samples.len() < MOST_PLACES as usize, "{on_top}");
    }

    #[test]
    fn normals_of_a_bar_with_sides_of_unequal_widths_are_its_own() {
        let turns: Vec<f64> = (0..17).map(|k| f64::from(22 * k).to_radians()).collect();
        let rim = |height: f64| turns.iter().map(move |turn| [turn.cos(), turn.sin(), height]);
        let places: Vec<Vector> = rim(0.0).chain(rim(8.0)).collect();
        let sides = turns.len();
        let triangles: Vec<[usize; 3]> = (0..sides)
            .flat_map(|k| {
                let next = (k + 1) % sides;
                [[k, next, sides + next], [k, sides + next, sides + k]]
            })
            .collect();
        let found = of(Facets::of(places, &triangles));
        assert!(found.samples.len() > 500);
        let off = |sample: &FacetSample| {
            let [x, y, _] = sample.place;
            1.0 - dot(unit([x, y, 0.0]), sample.normal)
        };
        assert!(found.samples.iter().all(|sample| off(sample) < 1e-12));
    }
}
