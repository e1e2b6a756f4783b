//! Contacts in the order of a curve that fills space, and what was found of each in the order of the input.
//!
//! The parts of a cloud are then the same in whatever order its contacts come, and what looks at neighbours finds them near in memory.

use palpate_geometry::contact::Contacts;
use palpate_geometry::neighbours::morton_order;
use palpate_numeric::vector::Vector;

/// Contacts along the curve.
pub(super) struct OrderedContacts {
    pub(super) places: Vec<Vector>,
    /// `None` where one has none.
    pub(super) normals: Option<Vec<Vector>>,
    /// Their numbers in the input.
    pub(super) numbers: Vec<u32>,
}

impl OrderedContacts {
    pub(super) fn new(contacts: &Contacts) -> OrderedContacts {
        let places = places(contacts);
        let numbers = morton_order(&places);
        let each = || numbers.iter().map(|r| *r as usize);
        let (places, normals) =
            (each().map(|r| places[r]).collect(), each().map(|r| contacts.unit_normal(r)).collect());
        OrderedContacts { places, normals, numbers }
    }
}

/// Places of all contacts, in the order of the input.
pub(super) fn places(contacts: &Contacts) -> Vec<Vector> {
    (0..contacts.len()).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]).collect()
}

/// What was found of every contact along the curve, in the order of the input.
pub(super) fn in_input_order<T: Clone>(numbers: &[u32], of_each: &[T]) -> Vec<T> {
    let mut place = vec![0; numbers.len()];
    numbers.iter().zip(0..).for_each(|(number, at)| place[*number as usize] = at);
    place.into_iter().map(|at: usize| of_each[at].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::{Parts, PartsOptions, PointShapes};

    /// A box of four faces, with and without normals: the answer for contacts in another order is the same, each with its own part.
    #[test]
    fn the_order_of_the_contacts_changes_no_number() {
        let place = |k: u32| (0.5 * f64::from(k % 17) + 0.013 * f64::from(k % 7), 0.5 * f64::from(k / 17 % 17));
        let of_face = |k: u32| {
            let (s, t) = place(k);
            let off = 0.01 * f64::from(k * 31 % 13);
            match k / 289 {
                0 => ([s, t, off], [0.0, 0.0, -1.0]),
                1 => ([s, t, 9.0 + off], [0.0, 0.0, 1.0]),
                2 => ([off - 0.2, t, s + 0.3], [-1.0, 0.0, 0.0]),
                _ => ([s, -0.3 + off, t + 0.4], [0.0, -1.0, 0.0]),
            }
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..1156).map(of_face).unzip();
        let other: Vec<u32> = (0..1156).map(|k| (k * 101 + 17) % 1156).collect();
        let bare = Contacts::from_points(&points);
        for contacts in [bare.clone().with_normal_vectors(&normals), bare] {
            let [one, two] = [&contacts, &contacts.in_order(&other)]
                .map(|contacts| Parts::of(contacts, &PartsOptions::default()).unwrap());
            assert_eq!(one.parts, two.parts);
            assert!(other.iter().zip(&two.labels).all(|(number, label)| one.labels[*number as usize] == *label));
            let [one, two] = [&contacts, &contacts.in_order(&other)]
                .map(|contacts| PointShapes::of(contacts, &PartsOptions::default()).unwrap());
            let same = |of: fn(&PointShapes) -> &[f64]| {
                other
                    .iter()
                    .zip(of(&two))
                    .all(|(number, value)| of(&one)[*number as usize].to_bits() == value.to_bits())
            };
            assert!(same(|found| &found.curvedness) && same(|found| &found.u_shape_index));
        }
    }
}
