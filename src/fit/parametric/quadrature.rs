//! Gauss points of every cell, p + 1 and q + 1 a direction, with the basis and its derivatives up to the third there.

use super::cells::{Cells, Row};
use crate::bspline::{Knots, gauss_legendre};

/// One point of the rule.
#[derive(Clone, Debug)]
pub struct GaussPoint {
    /// Its cell and basis.
    pub row: Row,
    /// Weight, with the cell's area.
    pub weight: f64,
}

/// The rule over the whole domain.
pub fn gauss_points(cells: &Cells) -> Vec<GaussPoint> {
    let [nodes_u, nodes_v] = [0, 1].map(|k| nodes(&cells.knots()[k]));
    let mut points = Vec::with_capacity(nodes_u.len() * nodes_v.len());
    for (u, wu) in &nodes_u {
        for (v, wv) in &nodes_v {
            points.push(GaussPoint { row: cells.row(*u, *v), weight: wu * wv });
        }
    }
    points
}

fn nodes(knots: &Knots) -> Vec<(f64, f64)> {
    let (nodes, weights) = gauss_legendre(knots.degree() + 1);
    (0..knots.n_segments())
        .flat_map(|s| {
            let [lo, hi] = knots.segment(s);
            let half = 0.5 * (hi - lo);
            nodes.iter().zip(&weights).map(move |(x, w)| (lo + half * (1.0 + x), half * w)).collect::<Vec<_>>()
        })
        .collect()
}
