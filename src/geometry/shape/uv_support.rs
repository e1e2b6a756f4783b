//! The region of (u, v) that contacts surround, as triangles between them. S and R are evaluated nowhere else.

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
}

impl UvSupport {
    /// The support made of these triangles; `period` is that of the closed directions.
    pub fn new(triangles: Vec<[[f64; 2]; 3]>, period: [Option<f64>; 2]) -> UvSupport {
        let near = |from: [f64; 2], to: [f64; 2]| {
            [0, 1].map(|k| period[k].map_or(to[k], |p| to[k] - p * ((to[k] - from[k]) / p).round()))
        };
        // the corners of a triangle across the seam are moved to the same side of it
        let triangles = triangles.into_iter().map(|[a, b, c]| [a, near(a, b), near(a, c)]).collect();
        UvSupport { triangles, period }
    }

    /// The triangles.
    pub fn triangles(&self) -> &[[[f64; 2]; 3]] {
        &self.triangles
    }

    /// The same support with u and v multiplied by `scale`.
    pub fn scaled(&self, scale: f64) -> UvSupport {
        UvSupport {
            triangles: self.triangles.iter().map(|t| t.map(|p| p.map(|v| v * scale))).collect(),
            period: self.period.map(|p| p.map(|p| p * scale)),
        }
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
    let twice_area =
        |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let area = twice_area(t[0], t[1], t[2]);
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
}
