//! Smooth seams that lie on the surface, and those that are chords of it.
//!
//! ```text
//! lean     l = n . e           n normal of the sector at an end of the seam, e its direction; 0 at both ends of a generator
//! bent     |l| > 0.25 degrees at both ends, or at one end where other seams are
//! turning  where the next seam of no lean goes on to the side by more than 0.6 degrees
//! ```
//!
//! At a rim all facets of an end may contain the seam, which then leans there by nothing: that is why one end may decide. The apex of
//! a cone leans, too, but at every one of its seams the other end does not. Turning are the seams around the top of a ring, where
//! the surface bends across them only.

use palpate_numeric::vector::{Vector, cross, dot, minus, scaled, unit_or_zero};

use super::Facets;
use super::seams::Seam;
use super::sectors::Sectors;

/// Sine of the lean from which on a seam is bent: one that leans less at both ends stays within 0.1 % of its length.
const BENT: f64 = 0.0044;

/// Sine of the turn from which on a row of seams is no straight line.
const TURN: f64 = 0.01;

/// Cosine below which a seam goes on from another, and does not branch off.
const ONWARD: f64 = -0.7;

/// More seams of no lean at one vertex are no rows.
const MOST_AT_VERTEX: usize = 64;

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
    let leaning = |seam: &Seam| leans(facets, sectors, seam).map(|lean| lean.abs() > BENT);
    let mut on_bent = vec![false; 3 * facets.len()];
    for seam in smooth.iter().filter(|seam| leaning(seam) == [true; 2]) {
        ends(facets, sectors, seam).into_iter().for_each(|(sector, _)| on_bent[sector] = true);
    }
    let (mut bent, straight): (Vec<Seam>, Vec<Seam>) = smooth.into_iter().partition(|seam| {
        let (leaning, ends) = (leaning(seam), ends(facets, sectors, seam));
        (0..2).any(|k| leaning[k] && on_bent[ends[k].0])
    });
    let turning = turning(facets, sectors, &straight);
    let (turned, straight): (Vec<_>, Vec<_>) = straight.into_iter().zip(turning).partition(|(_, turns)| *turns);
    bent.extend(turned.into_iter().map(|(seam, _)| seam));
    (bent, straight.into_iter().map(|(seam, _)| seam).collect())
}

/// Which seams go on to the side.
fn turning(facets: &Facets, sectors: &Sectors, seams: &[Seam]) -> Vec<bool> {
    let both = |(number, seam)| ends(facets, sectors, seam).map(|(sector, outward)| (sector, number, outward));
    let mut outward: Vec<(usize, usize, Vector)> = seams.iter().enumerate().flat_map(both).collect();
    outward.retain(|(sector, _, d)| dot(sectors.normal(*sector), *d).abs() <= BENT);
    outward.sort_by_key(|(sector, number, _)| (*sector, *number));
    let mut found = vec![false; seams.len()];
    for row in outward.chunk_by(|a, b| a.0 == b.0).filter(|row| row.len() <= MOST_AT_VERTEX) {
        for (sector, number, d) in row {
            let others = row.iter().map(|(_, _, other)| *other);
            let next = others.min_by(|a, b| dot(*a, *d).total_cmp(&dot(*b, *d)));
            let Some(next) = next.filter(|next| dot(*next, *d) < ONWARD) else { continue };
            found[*number] |= dot(cross(sectors.normal(*sector), *d), next).abs() > TURN;
        }
    }
    found
}
