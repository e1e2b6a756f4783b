//! Smooth seams that lie on the surface, and those that are chords of it.
//!
//! ```text
//! lean     l = n . e           n normal of the sector at an end of the seam, e its direction; 0 at both ends of a generator
//! bent     |l| > 0.25 degrees at both ends, or at one end where other seams are
//! joint    where the seam that goes on bends 4 times as much, a straight one may lean: a cylinder that ends in a ball
//! turning  where the next seam of no lean goes on to the side by more than 0.6 degrees
//! ```
//!
//! At a rim all facets of an end may contain the seam, which then leans there by nothing: that is why one end may decide. The apex of
//! a cone leans, too, but at every one of its seams the other end does not. Turning are the seams around the top of a ring, where
//! the surface bends across them only.

use palpate_numeric::vector::{Vector, cross, dot, minus, norm, scaled, unit_or_zero};

use super::Facets;
use super::seams::Seam;
use super::sectors::Sectors;

/// Sine of the lean from which on a seam is bent: one that leans less at both ends stays within 0.1 % of its length.
const BENT: f64 = 0.0044;

/// Sine of the turn from which on a row of seams is no straight line.
const TURN: f64 = 0.01;

/// Cosine below which a seam goes on from another, and does not branch off.
const ONWARD: f64 = -0.7;

/// A seam whose neighbour bends this many times more is straight up to there: the seams of one bent surface differ by less.
const BEGINS: f64 = 4.0;

/// At a vertex of more seams no two are looked for that go on from each other.
const MOST_AT_VERTEX: usize = 1000;

/// What a seam leans at its two ends.
pub(super) fn leans(facets: &Facets, sectors: &Sectors, seam: &Seam) -> [f64; 2] {
    ends(facets, sectors, seam).map(|(sector, outward)| dot(sectors.normal(sector), outward))
}

/// The sectors at both ends, and the direction from each into the seam.
fn ends(facets: &Facets, sectors: &Sectors, seam: &Seam) -> [(usize, Vector); 2] {
    let [a, b] = seam.ends.map(|end| facets.places[end]);
    let direction = unit_or_zero(minus(b, a));
    let at = seam.ends.map(|end| sectors.at(facets, seam.facets[0], end));
    [(at[0], direction), (at[1], scaled(-1.0, direction))]
}

/// Smooth seams that are chords, and those that lie on the surface.
pub(super) fn apart(facets: &Facets, sectors: &Sectors, smooth: Vec<Seam>) -> (Vec<Seam>, Vec<Seam>) {
    let leaning: Vec<[bool; 2]> =
        smooth.iter().map(|seam| leans(facets, sectors, seam).map(|lean| lean.abs() > BENT)).collect();
    let mut on_bent = vec![false; 3 * facets.len()];
    for (seam, _) in smooth.iter().zip(&leaning).filter(|(_, leaning)| **leaning == [true; 2]) {
        ends(facets, sectors, seam).into_iter().for_each(|(sector, _)| on_bent[sector] = true);
    }
    let between = between_joints(facets, sectors, &smooth, &leaning);
    let (mut bent, mut straight) = (Vec::new(), Vec::new());
    for (k, seam) in smooth.into_iter().enumerate() {
        let ends = ends(facets, sectors, &seam);
        let is_bent = (0..2).any(|end| leaning[k][end] && on_bent[ends[end].0]) && !between[k];
        if is_bent { &mut bent } else { &mut straight }.push(seam);
    }
    let turning = turning(facets, sectors, &straight);
    let (turned, straight): (Vec<_>, Vec<_>) = straight.into_iter().zip(turning).partition(|(_, turns)| *turns);
    bent.extend(turned.into_iter().map(|(seam, _)| seam));
    (bent, straight.into_iter().map(|(seam, _)| seam).collect())
}

/// The seam that goes on from each end of every seam, and its direction.
fn onward(facets: &Facets, sectors: &Sectors, seams: &[Seam]) -> Vec<[Option<(usize, Vector)>; 2]> {
    let both = |(number, seam)| {
        let [(a, d), (b, e)] = ends(facets, sectors, seam);
        [(a, number, 0, d), (b, number, 1, e)]
    };
    let mut outward: Vec<(usize, usize, usize, Vector)> = seams.iter().enumerate().flat_map(both).collect();
    outward.sort_by_key(|(sector, number, end, _)| (*sector, *number, *end));
    let mut found = vec![[None; 2]; seams.len()];
    for star in outward.chunk_by(|a, b| a.0 == b.0).filter(|star| star.len() <= MOST_AT_VERTEX) {
        for (_, number, end, d) in star {
            let others = star.iter().map(|(_, other, _, e)| (*other, *e));
            let next = others.min_by(|a, b| dot(a.1, *d).total_cmp(&dot(b.1, *d)));
            found[*number][*end] = next.filter(|next| dot(next.1, *d) < ONWARD);
        }
    }
    found
}

/// Which seams lean at their ends only because a bent surface begins there.
fn between_joints(facets: &Facets, sectors: &Sectors, seams: &[Seam], leaning: &[[bool; 2]]) -> Vec<bool> {
    let bend = |seam: &Seam| {
        let [a, b] = leans(facets, sectors, seam);
        (a + b).abs() / norm(minus(facets.places[seam.ends[1]], facets.places[seam.ends[0]]))
    };
    let bends: Vec<f64> = seams.iter().map(bend).collect();
    let onward = onward(facets, sectors, seams);
    let begins = |k: usize, end: usize| {
        !leaning[k][end] || onward[k][end].is_some_and(|(next, _)| bends[next] > BEGINS * bends[k])
    };
    (0..seams.len()).map(|k| begins(k, 0) && begins(k, 1)).collect()
}

/// Which seams go on to the side.
fn turning(facets: &Facets, sectors: &Sectors, seams: &[Seam]) -> Vec<bool> {
    let onward = onward(facets, sectors, seams);
    let turns = |(seam, next): (&Seam, &[Option<(usize, Vector)>; 2])| {
        ends(facets, sectors, seam).into_iter().zip(next).any(|((sector, d), next)| {
            let normal = sectors.normal(sector);
            let level = dot(normal, d).abs() <= BENT;
            level && next.is_some_and(|(_, next)| dot(cross(normal, d), next).abs() > TURN)
        })
    };
    seams.iter().zip(&onward).map(turns).collect()
}
