//! Several surfaces at once: the upper envelope `z = max_i z_i(x, y)`; normal and curvature are those of the part touched.
//!
//! On a crease, where two parts are equally high, the earlier part is touched.

use super::geometry::Geometry;
use super::local::Local;
use super::{Body, Surface};
use crate::scene::error::SceneError;

/// Parts in the union's frame, each with its own pose.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Union {
    /// At least one.
    pub parts: Vec<Surface>,
}

impl Surface {
    /// The upper envelope of several surfaces, `z = max_i z_i(x, y)`, each where its own pose puts it. Range: at least one.
    pub fn union(parts: Vec<Surface>) -> Surface {
        Surface::new(Body::Union(Union { parts }), 0.0)
    }
}

impl Union {
    /// The part met first by `hit` (greatest value), with that value.
    fn uppermost(&self, hit: impl Fn(&Surface) -> Option<f64>) -> Option<(f64, &Surface)> {
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
    fn touched(&self, p: [f64; 3]) -> Option<&Surface> {
        self.uppermost(|part| part.height(p[0], p[1]).map(|z| -(z - p[2]).abs())).map(|(_, part)| part)
    }
}

impl Geometry for Union {
    fn check(&self) -> Result<(), SceneError> {
        if self.parts.is_empty() {
            return Err(SceneError::List { key: "surface.parts".into(), expected: "at least one part is needed" });
        }
        self.parts.iter().try_for_each(Surface::check)
    }

    fn height(&self, x: f64, y: f64) -> Option<f64> {
        self.uppermost(|part| part.height(x, y)).map(|(z, _)| z)
    }

    fn local(&self, p: [f64; 3]) -> Option<Local> {
        self.touched(p)?.local(p)
    }

    fn hit(&self, o: [f64; 3], d: [f64; 3]) -> Option<f64> {
        self.uppermost(|part| part.hit(o, d)).map(|(t, _)| t)
    }
}
