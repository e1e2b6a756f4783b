//! Lines of one level through a grid of values, by marching squares.
//!
//! ```text
//! a cell's edge is crossed where its ends lie on two sides of the level, at the place linear between them;
//! the crossings of a cell are joined in pairs, and pieces that share a crossing make one line
//! ```
//!
//! W. E. Lorensen, H. E. Cline: Marching cubes, SIGGRAPH 1987, in the plane. A cell with four crossings is a saddle: its
//! middle value says which pairs belong together.

use std::collections::HashMap;

/// An edge of the grid: the point that it starts from, and whether it runs along the second direction.
type Edge = (usize, usize, bool);

/// Lines of `level`, in places of the grid: row and column, with parts. `values` holds `n` rows of `m`; cells with a value
/// that is not a number hold no line.
pub(super) fn contours(values: &[f64], [n, m]: [usize; 2], level: f64) -> Vec<Vec<[f64; 2]>> {
    let mut joined: HashMap<Edge, Vec<Edge>> = HashMap::new();
    for i in 0..n.saturating_sub(1) {
        for j in 0..m.saturating_sub(1) {
            for (a, b) in pieces(values, m, [i, j], level) {
                joined.entry(a).or_default().push(b);
                joined.entry(b).or_default().push(a);
            }
        }
    }
    let place = |(i, j, along): Edge| {
        let from = values[i * m + j];
        let to = if along { values[i * m + j + 1] } else { values[(i + 1) * m + j] };
        let t = (level - from) / (to - from);
        if along { [i as f64, j as f64 + t] } else { [i as f64 + t, j as f64] }
    };
    let mut starts: Vec<Edge> = joined.keys().copied().collect();
    // lines that end come first; what is left are rings. Sorted, so that the same values give the same bytes
    starts.sort_by_key(|edge| (joined[edge].len() != 1, *edge));
    let mut lines = Vec::new();
    for start in starts {
        let mut line = vec![place(start)];
        let mut here = start;
        while let Some(next) = joined.get_mut(&here).and_then(Vec::pop) {
            if let Some(back) = joined.get_mut(&next) {
                back.retain(|edge| *edge != here);
            }
            line.push(place(next));
            here = next;
        }
        if line.len() > 1 {
            lines.push(line);
        }
    }
    lines
}

/// Pairs of edges that a line joins in one cell.
fn pieces(values: &[f64], m: usize, [i, j]: [usize; 2], level: f64) -> Vec<(Edge, Edge)> {
    let at = |i: usize, j: usize| values[i * m + j];
    let corners = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
    if corners.iter().any(|v| v.is_nan()) {
        return Vec::new();
    }
    let above = corners.map(|v| v > level);
    let edges = [(i, j, true), (i, j + 1, false), (i + 1, j, true), (i, j, false)];
    let crossed: Vec<Edge> = (0..4).filter(|k| above[*k] != above[(k + 1) % 4]).map(|k| edges[k]).collect();
    match crossed[..] {
        [a, b] => vec![(a, b)],
        [a, b, c, d] if above[0] == (corners.iter().sum::<f64>() > 4.0 * level) => vec![(a, b), (c, d)],
        [a, b, c, d] => vec![(a, d), (b, c)],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hill_has_a_ring_and_a_slope_a_line() {
        let hill: Vec<f64> =
            (0..441).map(|k| -((k / 21) as f64 - 10.0).powi(2) - ((k % 21) as f64 - 10.0).powi(2)).collect();
        let rings = contours(&hill, [21, 21], -36.5);
        assert_eq!(rings.len(), 1);
        assert_eq!(rings[0].first(), rings[0].last());
        for [i, j] in &rings[0] {
            assert!(((i - 10.0).hypot(j - 10.0) - 36.5_f64.sqrt()).abs() < 0.05);
        }
        let slope: Vec<f64> = (0..12).map(|k| (k / 4) as f64).collect();
        assert_eq!(contours(&slope, [3, 4], 0.25), [vec![[0.25, 0.0], [0.25, 1.0], [0.25, 2.0], [0.25, 3.0]]]);
        assert!(contours(&[f64::NAN; 12], [3, 4], 0.0).is_empty());
    }
}
