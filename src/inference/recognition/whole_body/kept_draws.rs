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
/// the likeliest primitive's kind; a free surface is of its symmetry, whatever it is counted from, and has none. `scale` is the sample's unit of length.
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
            hypothesis: drawn.symmetry().map_or(Hypothesis::from(drawn.primitive.kind), Hypothesis::from),
            component: component_of(drawn),
            shape_index: (!is_flat(drawn)).then_some(s),
            curvedness: r / scale,
            radius: (drawn.primitive.kind == likeliest.kind && !drawn.is_level_set())
                .then_some(drawn.primitive.sizes[0] * scale),
        }
    };
    let mut shapes: Vec<DrawnShape> = draws.iter().zip(shapes).map(one).collect();
    normalise(&mut shapes.iter_mut().map(|shape| &mut shape.shares).collect::<Vec<&mut [f64; 2]>>());
    PosteriorDraws { shapes, lattice: None }
}

/// Draws that differ by numbers alone: of one primitive, and departing from it in one way.
fn component_of(drawn: &DrawnBase) -> usize {
    let way = match drawn.symmetry() {
        None => usize::from(drawn.departs()),
        Some(symmetry) => 2 + symmetry as usize,
    };
    5 * drawn.primitive.kind as usize + way
}

#[cfg(test)]
mod tests {
    use crate::recognition::{Hypothesis, Recognition, RecognitionOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::Lcg;
    use palpate_numeric::vector::{Vector, along, unit};

    /// An elliptic tube: what later touches move are draws of an extrusion, and not of the pipe that it is counted from.
    #[test]
    fn draws_of_a_free_surface_are_of_its_symmetry_and_have_no_radius() {
        let mut generator = Lcg::new(91);
        let one = |_| {
            let (sin, cos) = (std::f64::consts::TAU * generator.uniform()).sin_cos();
            let normal = unit([cos / 2.0, sin / 1.2, 0.0]);
            let place = [2.0 * cos, 1.2 * sin, 4.0 * generator.uniform()];
            (along(place, 0.01 * (generator.uniform() - 0.5), normal), normal)
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..120).map(one).unzip();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let found = Recognition::of(&contacts, &RecognitionOptions::default()).unwrap();
        assert_eq!((found.hypothesis, found.radius), (Hypothesis::Extrusion, None));
        assert!(!found.draws.shapes.is_empty());
        for drawn in &found.draws.shapes {
            assert!(drawn.hypothesis == Hypothesis::Extrusion && drawn.radius.is_none(), "{drawn:?}");
        }
    }
}
