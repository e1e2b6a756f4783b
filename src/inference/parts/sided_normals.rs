//! Unit normals on one side: a file's own, or those of planes through neighbours.
//!
//! ```text
//! a file's normals agree with their neighbours, and contradict no places            the side of most of them
//! others           planes through neighbours (`estimated.rs`)                       outwards where they go all round, or upwards
//! ```

use super::against_places::contradict;
use super::cloud::NEAREST;
use super::error::PartsError;
use super::estimated;
use super::options::PartsOptions;
use palpate_geometry::neighbours::{NeighbourLists, Oriented, oriented_among};
use palpate_numeric::vector::{Vector, dot, minus, norm, scaled};

/// Unit normals on one side.
pub(super) struct Sided {
    pub(super) normals: Vec<Vector>,
    /// Why they are estimated from the places; `None` where they are the file's.
    pub(super) estimated: Option<&'static str>,
    /// Whether the file's tell which side is free.
    pub(super) side_known: bool,
}

/// Unit normals on one side, from the file or from the positions.
pub(super) fn normals(
    points: &[Vector],
    given: Option<Vec<Vector>>,
    near: &NeighbourLists<NEAREST>,
    options: &PartsOptions,
    notes: &mut Vec<String>,
) -> Result<Sided, PartsError> {
    let why = match given {
        Some(normals) if contradict(points, &normals, near, &options.tuning) => {
            "the file's normals contradict its places"
        }
        Some(normals) => return of_file(points, normals, near, notes),
        None => "there are no normals",
    };
    let mut normals = estimated::estimated(points, near, options.viewpoint, &options.tuning);
    if options.viewpoint.is_none() && points_inwards(points, &normals) {
        normals.iter_mut().for_each(|n| *n = scaled(-1.0, *n));
    }
    Ok(Sided { normals, estimated: Some(why), side_known: false })
}

/// Whether something tells which side of estimated normals is free, and a note that says which they point to.
pub(super) fn told_side(why: &str, normals: &[Vector], viewpoint: Option<Vector>, notes: &mut Vec<String>) -> bool {
    let (side_known, side) = match (viewpoint.is_some(), goes_round(normals)) {
        (true, _) => (true, "towards the viewpoint"),
        (false, true) => (true, "outwards"),
        (false, false) => (false, "upwards, though nothing tells which side is free"),
    };
    notes.push(format!(
        "{why}; they were estimated from planes through neighbours and point {side}; a convex and a concave joint \
         change places if that is the wrong side"
    ));
    side_known
}

/// The file's own, on one side.
fn of_file(
    points: &[Vector],
    normals: Vec<Vector>,
    near: &NeighbourLists<NEAREST>,
    notes: &mut Vec<String>,
) -> Result<Sided, PartsError> {
    let found = oriented_among(points, normals, None, near);
    let undecided = found.undecided();
    let Oriented { normals, consistent, flipped: turned, .. } = found;
    if !consistent {
        return Err(PartsError::Normals);
    }
    if turned > 0 {
        let of = points.len();
        notes
            .push(format!("{turned} of {of} normals point to the other side than their neighbours' and were reversed"));
    }
    if let Some(share) = undecided {
        notes.push(format!(
            "only {:.0} % of the signs of normals agree, so that nothing tells which side is free; a convex and a concave joint change \
             places if it is the other",
            100.0 * share
        ));
    }
    Ok(Sided { normals, estimated: None, side_known: undecided.is_none() })
}

/// Normals in all directions, as of a closed body.
fn goes_round(normals: &[Vector]) -> bool {
    let sum = normals.iter().fold([0.0; 3], |sum, n| [0, 1, 2].map(|k| sum[k] + n[k]));
    norm(sum) < 0.3 * normals.len() as f64
}

/// Whether normals go all round, and most of them into the body.
pub(super) fn points_inwards(points: &[Vector], normals: &[Vector]) -> bool {
    let count = points.len() as f64;
    let mean = points.iter().fold([0.0; 3], |sum, p| [0, 1, 2].map(|k| sum[k] + p[k] / count));
    let outwards = points.iter().zip(normals).map(|(p, n)| dot(minus(*p, mean), *n)).sum::<f64>();
    goes_round(normals) && outwards <= 0.0
}
