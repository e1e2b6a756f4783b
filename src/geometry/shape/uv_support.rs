//! The region of (u, v) that contacts surround, as triangles between them. S and R are evaluated nowhere else.

use super::triangle_bins::TriangleBins;

/// A point counts as inside up to this share of a triangle beyond its edge, so that rounding does not decide.
const RIM: f64 = 1e-9;

/// Triangles in (u, v) between contacts.
///
/// ```
/// use palpate_geometry::shape::UvSupport;
///
/// // u is closed with period 10, and the triangle crosses the seam
/// let support = UvSupport::new(vec![[[9.0, 0.0], [1.0, 0.0], [0.0, 2.0]]], [Some(10.0), None]);
/// assert!(support.holds(9.5, 0.2) && support.holds(0.5, 0.2) && !support.holds(5.0, 0.2));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UvSupport {
    triangles: Vec<[[f64; 2]; 3]>,
    period: [Option<f64>; 2],
    /// The triangles by place, where there are enough of them.
    bins: Option<TriangleBins>,
}

impl UvSupport {
    /// The support made of these triangles; `period` is that of the closed directions.
    pub fn new(triangles: Vec<[[f64; 2]; 3]>, period: [Option<f64>; 2]) -> UvSupport {
        let near = |from: [f64; 2], to: [f64; 2]| {
            [0, 1].map(|k| period[k].map_or(to[k], |p| to[k] - p * ((to[k] - from[k]) / p).round()))
        };
        // the corners of a triangle across the seam are moved to the same side of it
        let triangles = triangles.into_iter().map(|[a, b, c]| [a, near(a, b), near(a, c)]).collect();
        UvSupport::of_near_corners(triangles, period)
    }

    /// The corners of every triangle stand on the same side of a seam.
    fn of_near_corners(triangles: Vec<[[f64; 2]; 3]>, period: [Option<f64>; 2]) -> UvSupport {
        let bins = TriangleBins::new(&triangles, period);
        UvSupport { triangles, period, bins }
    }

    /// The triangles.
    pub fn triangles(&self) -> &[[[f64; 2]; 3]] {
        &self.triangles
    }

    /// The same support with u and v multiplied by `scale`.
    pub fn scaled(&self, scale: f64) -> UvSupport {
        let triangles = self.triangles.iter().map(|t| t.map(|p| p.map(|v| v * scale))).collect();
        UvSupport::of_near_corners(triangles, self.period.map(|p| p.map(|p| p * scale)))
    }

    /// Whether contacts surround (u, v).
    pub fn holds(&self, u: f64, v: f64) -> bool {
        match &self.bins {
            Some(bins) => bins.near([u, v]).any(|t| self.holds_in(&self.triangles[t], [u, v])),
            None => self.triangles.iter().any(|t| self.holds_in(t, [u, v])),
        }
    }

    /// Whether this triangle holds the place or one that is periods on.
    fn holds_in(&self, t: &[[f64; 2]; 3], at: [f64; 2]) -> bool {
        let middle = [0, 1].map(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0);
        let p = [0, 1].map(|k| self.period[k].map_or(at[k], |q| at[k] - q * ((at[k] - middle[k]) / q).round()));
        inside(t, p)
    }
}

fn inside(t: &[[f64; 2]; 3], p: [f64; 2]) -> bool {
    let twice_area =
        |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let area = twice_area(t[0], t[1], t[2]);
    if area == 0.0 {
        // rounding decides on which side of a line a place lies, and a triangle that is a point would hold the plane
        return false;
    }
    let rim = -RIM * area.abs();
    let sign = area.signum();
    (0..3).all(|k| sign * twice_area(t[k], t[(k + 1) % 3], p) >= rim)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_across_the_seam_holds_points_on_both_sides() {
        let support = UvSupport::new(vec![[[9.0, 0.0], [1.0, 0.0], [0.0, 2.0]]], [Some(10.0), None]);
        assert!(support.holds(9.5, 0.2) && support.holds(0.5, 0.2) && support.holds(10.0, 1.0));
        assert!(!support.holds(5.0, 0.2) && !support.holds(9.5, -0.2));
    }

    /// Triangles small and large, slivers, across seams, of no extent and over many periods: sorted into cells they hold what all of them
    /// held one by one, at places in them, on their rims, at their corners and periods on.
    #[test]
    fn triangles_by_place_hold_what_all_of_them_hold() {
        let share = |i: usize, by: f64| (i as f64 * by).fract();
        let small = |i: usize| {
            let a = [10.0 * share(i, 0.754_877), 4.0 * share(i, 0.569_840)];
            [a, [a[0] + 0.7, a[1] + 0.1], [a[0] + 0.1, a[1] + 0.6]]
        };
        let sliver = |i: usize| [[0.0, share(i, 0.31)], [9.9, share(i, 0.77)], [5.0, share(i, 0.31) + 1e-3]];
        let sets: [Vec<[[f64; 2]; 3]>; 6] = [
            (0..90).map(small).collect(),
            (0..40).map(sliver).collect(),
            (0..60).map(|i| if i % 3 == 0 { sliver(i) } else { small(i) }).collect(),
            vec![[[0.0, 0.0], [10.0, 0.0], [0.0, 4.0]], [[10.0, 4.0], [10.0, 0.0], [0.0, 4.0]]],
            (0..30).map(|i| [[share(i, 0.31), 1.0], [share(i, 0.77), 1.0], [2.0, 1.0]]).collect(),
            (0..30).map(|i| small(i).map(|p| [p[0] + 1e6 * i as f64, p[1]])).collect(),
        ];
        let mut held = 0;
        for (triangles, period) in sets.iter().flat_map(|set| {
            [[None, None], [Some(10.0), None], [Some(10.0), Some(4.0)], [None, Some(1.5)]].map(|period| (set, period))
        }) {
            let support = UvSupport::new(triangles.clone(), period);
            let plain = UvSupport { bins: None, ..support.clone() };
            let corners = support.triangles.iter().flatten().copied();
            let edges = support.triangles.iter().map(|t| [0, 1].map(|k| 0.5 * (t[0][k] + t[1][k])));
            let anywhere = (0..500).map(|i| [14.0 * share(i, 0.618) - 2.0, 6.0 * share(i, 0.414) - 1.0]);
            for [u, v] in corners.chain(edges).chain(anywhere) {
                let wanted = plain.holds(u, v);
                assert_eq!(support.holds(u, v), wanted, "({u}, {v}) with periods {period:?}");
                held += usize::from(wanted);
            }
        }
        assert!(held > 1000, "{held}");
    }
}
