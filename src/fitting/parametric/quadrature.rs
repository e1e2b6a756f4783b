//! Gauss points of every cell, (p + 1) x (q + 1) of them, with the basis and its derivatives up to the third.

use super::cells::{Cells, Row};
use palpate_numeric::bspline::{Knots, gauss_legendre};

/// One point of the quadrature rule.
#[derive(Clone, Debug)]
pub(super) struct GaussPoint {
    /// Its cell and basis.
    pub row: Row,
    /// Weight, the area of the cell included.
    pub weight: f64,
}

/// The rule over the whole domain, cell after cell.
pub(super) fn gauss_points(cells: &Cells) -> Vec<GaussPoint> {
    let [nodes_u, nodes_v] = [0, 1].map(|k| nodes(&cells.knots()[k]));
    let [wide_u, wide_v] = [0, 1].map(|k| cells.knots()[k].degree() + 1);
    let mut points = Vec::with_capacity(nodes_u.len() * nodes_v.len());
    for across in nodes_u.chunks_exact(wide_u) {
        for along in nodes_v.chunks_exact(wide_v) {
            for (u, wu) in across {
                points.extend(along.iter().map(|(v, wv)| GaussPoint { row: cells.row(*u, *v, 3), weight: wu * wv }));
            }
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
