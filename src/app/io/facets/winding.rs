//! All facets of one piece are wound the same way: that of most of its area.

use palpate_numeric::vector::scaled;

use super::Facets;
use super::seams::Seams;

/// Turns facets over that are wound against their neighbours.
pub(super) fn unify(facets: &mut Facets, seams: &mut Seams) {
    if seams.all.iter().all(|seam| !seam.against) {
        return;
    }
    let mut turned: Vec<Option<bool>> = vec![None; facets.len()];
    for first in 0..facets.len() {
        if turned[first].is_some() {
            continue;
        }
        turned[first] = Some(false);
        let mut piece = vec![first];
        let mut at = 0;
        while let Some(&facet) = piece.get(at) {
            at += 1;
            for seam in seams.of[facet].map(|seam| seams.all[seam]) {
                if let Some(next) = seam.other(facet).filter(|&next| turned[next].is_none()) {
                    turned[next] = turned[facet].map(|turned| turned ^ seam.against);
                    piece.push(next);
                }
            }
        }
        let balance: f64 =
            piece.iter().map(|&f| if turned[f] == Some(true) { facets.areas[f] } else { -facets.areas[f] }).sum();
        if balance > 0.0 {
            piece.iter().for_each(|&f| turned[f] = turned[f].map(|turned| !turned));
        }
    }
    for facet in (0..facets.len()).filter(|&f| turned[f] == Some(true)) {
        facets.corners[facet].swap(0, 1);
        facets.normals[facet] = scaled(-1.0, facets.normals[facet]);
    }
    // corners and sides have changed their order
    *seams = Seams::between(facets);
}
