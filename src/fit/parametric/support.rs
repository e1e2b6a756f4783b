//! Where contacts reach in (u, v): the cells of their lanes, or their hull. S and R are taken nowhere else.

use super::flattening::hull;
use super::lanes::Flat;
use crate::bspline::Knots;

/// A point this share of the domain outside still counts: its own rounding must not decide.
const RIM: f64 = 1e-9;

/// Triangles in (u, v) that contacts span.
#[derive(Clone, Debug)]
pub struct Support {
    triangles: Vec<[[f64; 2]; 3]>,
    period: [Option<f64>; 2],
}

impl Support {
    /// Of contacts at these feet.
    pub fn new(flat: &Flat, places: &[[f64; 2]], knots: &[Knots; 2]) -> Support {
        let period = [0, 1].map(|k| {
            let [lo, hi] = knots[k].domain();
            knots[k].is_closed().then_some(hi - lo)
        });
        let corners: Vec<[usize; 3]> = if flat.triangles.is_empty() {
            let rim = hull(places);
            (1..rim.len().saturating_sub(1)).map(|k| [rim[0], rim[k], rim[k + 1]]).collect()
        } else {
            flat.triangles.clone()
        };
        let near = |from: [f64; 2], to: [f64; 2]| {
            [0, 1].map(|k| period[k].map_or(to[k], |p| to[k] - p * ((to[k] - from[k]) / p).round()))
        };
        let triangles = corners.iter().map(|[a, b, c]| {
            let first = places[*a];
            [first, near(first, places[*b]), near(first, places[*c])]
        });
        Support { triangles: triangles.collect(), period }
    }

    /// Whether contacts surround (u, v).
    pub fn holds(&self, u: f64, v: f64) -> bool {
        self.triangles.iter().any(|t| {
            let middle = [0, 1].map(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0);
            let at = [u, v];
            let p = [0, 1].map(|k| self.period[k].map_or(at[k], |q| at[k] - q * ((at[k] - middle[k]) / q).round()));
            inside(t, p)
        })
    }
}

fn inside(t: &[[f64; 2]; 3], p: [f64; 2]) -> bool {
    let turn = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let area = turn(t[0], t[1], t[2]);
    let rim = -RIM * area.abs();
    let sign = area.signum();
    (0..3).all(|k| sign * turn(t[k], t[(k + 1) % 3], p) >= rim)
}
