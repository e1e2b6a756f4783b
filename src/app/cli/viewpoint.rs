//! The side that a viewpoint says is free: the sensor that stood there saw it.
//!
//! ```text
//! n . (eye - p) > 0        for the normal n of every contact p that the eye saw
//! ```

use palpate_geometry::contact::{Contacts, Orientation};
use palpate_numeric::vector::{Vector, dot, minus};

/// The contacts with their normals on the side of `eye`; notes say how many were not. Slopes become normals where one of them
/// has to be turned, because slopes have the side of +z.
pub(super) fn turned_towards(contacts: Contacts, eye: Vector, notes: &mut Vec<String>) -> Contacts {
    let count = contacts.len();
    let at = |r: usize| [contacts.x[r], contacts.y[r], contacts.z[r]];
    let away = |r: usize| contacts.unit_normal(r).is_some_and(|n| dot(n, minus(eye, at(r))) < 0.0);
    let turned: Vec<usize> = (0..count).filter(|r| away(*r)).collect();
    if turned.is_empty() {
        return contacts;
    }
    let mut normals: Vec<Vector> = match &contacts.orientation {
        Orientation::None => return contacts,
        Orientation::Normals { nx, ny, nz } => (0..count).map(|r| [nx[r], ny[r], nz[r]]).collect(),
        Orientation::Slopes { .. } => (0..count).filter_map(|r| contacts.unit_normal(r)).collect(),
    };
    turned.iter().for_each(|r| normals[*r] = normals[*r].map(|v| -v));
    notes.push(format!("{} of {count} normals point away from the viewpoint and were reversed", turned.len()));
    contacts.with_normal_vectors(&normals)
}

/// Whether `eye` is below the plane that comes nearest to the points along z.
pub(super) fn sees_from_below(contacts: &Contacts, eye: Vector) -> bool {
    let count = contacts.len() as f64;
    let mean = [&contacts.x, &contacts.y, &contacts.z].map(|column| column.iter().map(|v| v / count).sum::<f64>());
    let (mut xx, mut xy, mut yy, mut xz, mut yz) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for r in 0..contacts.len() {
        let [x, y, z] = minus([contacts.x[r], contacts.y[r], contacts.z[r]], mean);
        (xx, xy, yy, xz, yz) = (xx + x * x, xy + x * y, yy + y * y, xz + x * z, yz + y * z);
    }
    let determinant = xx * yy - xy * xy;
    let slopes = [(xz * yy - yz * xy) / determinant, (yz * xx - xz * xy) / determinant];
    // points in one row have no such plane, and are refused anyway
    let [zx, zy] = if slopes.iter().all(|v| v.is_finite()) { slopes } else { [0.0; 2] };
    dot([-zx, -zy, 1.0], minus(eye, mean)) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The plane z = x, which has an eye above it at x = -1 and one below it at x = 1.
    fn slope() -> Contacts {
        Contacts::from_points(&[[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1.0]])
    }

    #[test]
    fn the_eye_is_below_a_tilted_plane_and_above_its_mean() {
        let eyes = [[-5.0, 0.0, 0.0], [5.0, 0.0, 1.0]];
        assert_eq!(eyes.map(|eye| sees_from_below(&slope(), eye)), [false, true]);
    }

    #[test]
    fn slopes_that_are_seen_from_below_become_normals() {
        let sloped = slope().with_slopes(vec![1.0; 4], vec![0.0; 4]);
        let mut notes = Vec::new();
        assert_eq!(turned_towards(sloped.clone(), [-5.0, 0.0, 0.0], &mut notes), sloped);
        assert!(notes.is_empty());
        let turned = turned_towards(sloped, [5.0, 0.0, 1.0], &mut notes);
        let Orientation::Normals { nz, .. } = &turned.orientation else { panic!("no normals") };
        assert!(nz.iter().all(|nz| *nz < 0.0));
        assert_eq!(notes, ["4 of 4 normals point away from the viewpoint and were reversed"]);
    }
}
