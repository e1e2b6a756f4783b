//! What the drawn bodies say, kept with the answer for touches that come later.

use crate::bodies::DrawnBase;
use crate::primitives::placed::{PartKind, Primitive};
use crate::recognition::Hypothesis;
use crate::recognition::region::{DrawnShape, PosteriorDraws, normalise};

/// A plane that departs from nothing.
pub(super) fn is_flat(drawn: &DrawnBase) -> bool {
    drawn.primitive.kind == PartKind::Plane && !drawn.departs()
}

/// Every draw with its means of S and R, in the order of the draws; one without means has no share. Radii are those of draws that are of
/// the likeliest primitive's kind. `scale` is the sample's unit of length.
pub(super) fn kept_draws(
    draws: &[DrawnBase],
    shapes: &[Option<[f64; 2]>],
    likeliest: &Primitive,
    scale: f64,
) -> PosteriorDraws {
    let one = |(drawn, shape): (&DrawnBase, &Option<[f64; 2]>)| {
        let [s, r] = shape.unwrap_or_default();
        DrawnShape {
            shares: [shape.map_or(0.0, |_| drawn.share); 2],
            hypothesis: Hypothesis::from(drawn.primitive.kind),
            component: 2 * drawn.primitive.kind as usize + usize::from(drawn.departs()),
            shape_index: (!is_flat(drawn)).then_some(s),
            curvedness: r / scale,
            radius: (drawn.primitive.kind == likeliest.kind).then_some(drawn.primitive.sizes[0] * scale),
        }
    };
    let mut shapes: Vec<DrawnShape> = draws.iter().zip(shapes).map(one).collect();
    normalise(&mut shapes.iter_mut().map(|shape| &mut shape.shares).collect::<Vec<&mut [f64; 2]>>());
    PosteriorDraws { shapes, lattice: None }
}
