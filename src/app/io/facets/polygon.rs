//! A polygon as triangles: a fan where it is convex, ears cut off one after the other where it is not.
//!
//! ```text
//! n ~ sum of p_k x p_(k+1)                       Newell's normal
//! ear (a, b, c)    (b - a) x (c - b) . n > 0, and no other corner inside
//! ```
//!
//! G. Meisters, "Polygons have ears", American Mathematical Monthly 82(6), 1975.

use palpate_numeric::vector::{Vector, cross, dot, minus};

/// Polygons as a file lists them, each by its corners among the vertices.
#[derive(Debug, Default)]
pub(in crate::io) struct PolygonList {
    corners: Vec<usize>,
    /// Where each ends.
    ends: Vec<usize>,
}

impl PolygonList {
    pub(in crate::io) fn push(&mut self, corners: impl IntoIterator<Item = usize>) {
        self.corners.extend(corners);
        self.ends.push(self.corners.len());
    }

    /// All polygons as triangles; `places` are the vertices.
    pub(in crate::io) fn triangles(&self, places: &[Vector]) -> Vec<[usize; 3]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).flat_map(|(start, &end)| triangles(&self.corners[start..end], places)).collect()
    }
}

/// More corners than this are not searched for ears, which takes the cube of their number.
const MOST_EARS: usize = 500;

/// Triangles of `polygon`, corners among `places`; none where it has fewer than three corners.
fn triangles(polygon: &[usize], places: &[Vector]) -> Vec<[usize; 3]> {
    if polygon.len() <= 3 || polygon.iter().any(|&v| v >= places.len()) {
        return <[usize; 3]>::try_from(polygon).into_iter().collect();
    }
    let origin = places[polygon[0]];
    let corners: Vec<Vector> = polygon.iter().map(|&v| minus(places[v], origin)).collect();
    let count = corners.len();
    let normal = (0..count).map(|k| cross(corners[k], corners[(k + 1) % count])).fold([0.0; 3], plus);
    let turn = |[a, b, c]: [usize; 3]| dot(cross(minus(corners[b], corners[a]), minus(corners[c], corners[b])), normal);
    let convex = (0..count).all(|k| turn([k, (k + 1) % count, (k + 2) % count]) >= 0.0);
    if convex || count > MOST_EARS {
        return (1..count - 1).map(|k| [polygon[0], polygon[k], polygon[k + 1]]).collect();
    }
    let mut left: Vec<usize> = (0..count).collect();
    let mut found = Vec::with_capacity(count - 2);
    while left.len() > 3 {
        let around = |k: usize| [(k + left.len() - 1) % left.len(), k, (k + 1) % left.len()].map(|k| left[k]);
        let is_ear = |k: &usize| {
            let ear = around(*k);
            let inside = |v: &usize| !ear.contains(v) && (0..3).all(|s| turn([ear[s], ear[(s + 1) % 3], *v]) >= 0.0);
            turn(ear) > 0.0 && !left.iter().any(inside)
        };
        // what crosses itself has no ear: any corner will do
        let ear = (0..left.len()).find(is_ear).unwrap_or(0);
        found.push(around(ear).map(|k| polygon[k]));
        left.remove(ear);
    }
    found.push([left[0], left[1], left[2]].map(|k| polygon[k]));
    found
}

fn plus(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|k| a[k] + b[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_notched_polygon_is_cut_within_itself() {
        // an L of area 3, begun at the corner beside its notch, where a fan would leave it
        let outline = [[2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0], [0.0, 0.0], [2.0, 0.0]];
        let places: Vec<Vector> = outline.iter().map(|p| [p[0], p[1], 5.0]).collect();
        let found = triangles(&[0, 1, 2, 3, 4, 5], &places);
        let areas = found.iter().map(|t| {
            let [a, b, c] = t.map(|v| places[v]);
            cross(minus(b, a), minus(c, a))[2] / 2.0
        });
        let areas: Vec<f64> = areas.collect();
        assert_eq!(found.len(), 4);
        assert!(areas.iter().all(|a| *a > 0.0), "{areas:?}");
        assert!((areas.iter().sum::<f64>() - 3.0).abs() < 1e-12);
    }

    #[test]
    fn few_corners_and_unknown_ones_are_no_polygon() {
        let places = [[0.0; 3]; 3];
        assert!(triangles(&[0, 1], &places).is_empty());
        assert_eq!(triangles(&[0, 1, 2], &places), [[0, 1, 2]]);
        assert!(triangles(&[0, 1, 2, 3], &places).is_empty());
    }
}
