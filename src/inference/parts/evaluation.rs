//! Parts against what is known of every contact: which true face became which part, and how far boundaries are off.
//!
//! ```text
//! table[face][part] = contacts of the face in the part, the last column: in none
//! right   = contacts whose part is the one that holds most of their face, and whose face is the one that fills most of their part
//! boundary error = mean distance from a contact next to a change of part to the nearest one next to a change of face, and
//!                  the other way round, over the spacing
//! ```

use super::cloud::LINKED;
use super::ordered_contacts;
use super::result::Parts;
use palpate_geometry::contact::Contacts;
use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::vector::{Vector, minus, norm};

/// A segmentation beside the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// Contacts of each face in each part; the last column counts those in none.
    pub table: Vec<Vec<usize>>,
    /// The part that each face corresponds to, one to one.
    pub part_of_face: Vec<Option<usize>>,
    /// Share of the contacts that lie in their face's part.
    pub right: f64,
    /// In spacings; `None` where either side has no boundary.
    pub boundary_error: Option<f64>,
}

/// Compares parts with the true face of every contact.
pub fn against(contacts: &Contacts, parts: &Parts, faces: &[usize], kinds: usize) -> Agreement {
    let columns = parts.parts.len() + 1;
    let mut table = vec![vec![0_usize; columns]; kinds];
    let label = |i: usize| parts.labels[i].map_or(columns - 1, |l| l as usize);
    (0..faces.len()).for_each(|i| table[faces[i]][label(i)] += 1);
    let most_in = |counts: &mut dyn Iterator<Item = (usize, usize)>| {
        counts.filter(|(_, n)| *n > 0).max_by_key(|(k, n)| (*n, usize::MAX - k)).map(|(k, _)| k)
    };
    let part_of_face: Vec<Option<usize>> = (0..kinds)
        .map(|face| {
            let part = most_in(&mut table[face][..columns - 1].iter().copied().enumerate())?;
            let filled_by = most_in(&mut table.iter().map(|row| row[part]).enumerate())?;
            (filled_by == face).then_some(part)
        })
        .collect();
    let right = (0..faces.len()).filter(|&i| part_of_face[faces[i]] == Some(label(i))).count();
    let points: Vec<Vector> = ordered_contacts::places(contacts);
    let boundary_error = boundary_error(&points, &|i| faces[i], &label).map(|error| error / parts.spacing);
    Agreement { table, part_of_face, right: right as f64 / faces.len() as f64, boundary_error }
}

/// Which contacts have a neighbour in another part.
pub fn boundary(contacts: &Contacts, labels: &[Option<u32>]) -> Vec<bool> {
    let points: Vec<Vector> = ordered_contacts::places(contacts);
    let tree = Neighbours::new(&points);
    palpate_numeric::threads::map(points.len(), 256, |i| {
        tree.nearest(points[i], LINKED + 1).iter().any(|(_, j)| labels[*j as usize] != labels[i])
    })
}

/// Mean distance between the contacts next to a change of one labelling and those next to a change of the other.
fn boundary_error(points: &[Vector], one: &dyn Fn(usize) -> usize, two: &dyn Fn(usize) -> usize) -> Option<f64> {
    let tree = Neighbours::new(points);
    let (mut of_one, mut of_two) = (Vec::new(), Vec::new());
    for (i, p) in points.iter().enumerate() {
        let near = tree.nearest(*p, LINKED + 1);
        let changes = |label: &dyn Fn(usize) -> usize| near.iter().any(|(_, j)| label(*j as usize) != label(i));
        if changes(one) {
            of_one.push(*p);
        }
        if changes(two) {
            of_two.push(*p);
        }
    }
    if of_one.is_empty() || of_two.is_empty() {
        return None;
    }
    let mean = |from: &[Vector], to: &[Vector]| {
        let tree = Neighbours::new(to);
        let nearest = |p: &Vector| tree.nearest(*p, 1).first().map_or(0.0, |(_, j)| norm(minus(to[*j as usize], *p)));
        from.iter().map(nearest).sum::<f64>() / from.len() as f64
    };
    Some(0.5 * (mean(&of_one, &of_two) + mean(&of_two, &of_one)))
}
