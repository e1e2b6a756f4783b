//! The drawn surfaces that are kept with the answer, for touches that come later.
//!
//! ```text
//! offset of a draw at a point of the map = (height over the reported surface, slopes a, b)  ->  (height, a t1 + b t2)
//! ```

use crate::recognition::kinds::Kind;
use crate::recognition::region::{DrawnLattice, DrawnOffset, DrawnShape, Place, PosteriorDraws, normalise};
use palpate_numeric::vector::along;

use super::posterior_samples::Drawn;

/// The draws whose offsets over the map are known; in the patch's units, without lines.
pub(super) fn kept_draws(found: &[Drawn], reference: &[Place]) -> PosteriorDraws {
    let (mut shapes, mut offsets): (Vec<DrawnShape>, Vec<Vec<DrawnOffset>>) = (Vec::new(), Vec::new());
    for (component, drawn) in found.iter().enumerate() {
        let shares = drawn.weights.map(|weight| weight / drawn.over_map.len().max(1) as f64);
        for (field, measured) in drawn.draws.iter().zip(&drawn.over_map) {
            let shape_index = (drawn.kind != Kind::Plane).then_some(field.s);
            let (hypothesis, curvedness) = (drawn.hypothesis, field.r);
            shapes.push(DrawnShape { shares, hypothesis, component, shape_index, curvedness, radius: None });
            offsets.push(reference.iter().zip(measured).map(|(place, at)| offset(place, at)).collect());
        }
    }
    normalise(&mut shapes.iter_mut().map(|shape| &mut shape.shares).collect::<Vec<&mut [f64; 2]>>());
    PosteriorDraws { shapes, lattice: Some(DrawnLattice { offsets, ..DrawnLattice::default() }) }
}

fn offset(place: &Place, [height, first, second]: &[f64; 3]) -> DrawnOffset {
    let [t1, t2] = place.tangents();
    let [x, y, z] = along(t1.map(|t| t * first), *second, t2);
    [*height, x, y, z]
}
