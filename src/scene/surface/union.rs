//! Several surfaces at once: the upper envelope `z = max_i z_i(x, y)`; normal and curvature are those of the part touched.
//!
//! On a crease, where two parts are equally high, the earlier part is touched.

use super::Surface;

/// Parts in the union's frame, each with its own pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Union {
    /// At least one.
    pub parts: Vec<Surface>,
}

impl Union {
    /// The part met first by `hit` (greatest value), with that value.
    pub(crate) fn uppermost(&self, hit: impl Fn(&Surface) -> Option<f64>) -> Option<(f64, &Surface)> {
        let mut best: Option<(f64, &Surface)> = None;
        for part in &self.parts {
            if let Some(t) = hit(part)
                && best.is_none_or(|(top, _)| t > top)
            {
                best = Some((t, part));
            }
        }
        best
    }

    /// The part that a point of the envelope lies on.
    pub(crate) fn touched(&self, p: [f64; 3]) -> Option<&Surface> {
        self.uppermost(|part| part.height(p[0], p[1]).map(|z| -(z - p[2]).abs())).map(|(_, part)| part)
    }
}
