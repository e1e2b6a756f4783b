//! What roughness costs.
//!
//! ```text
//! none    LAMBDA (second derivatives)    third=LAMBDA (alike in all directions)    third=LAMBDA,ASPECT (stretched)    auto: one of these
//! ```

use crate::observation::RoughnessOrder;

/// Weight of a faint roughness: its share of what data tell is rounding, and the matrix is still far from singular where they tell nothing.
const FAINT: f64 = 1e-9;

/// Thin-plate roughness penalty of a height field; of a parametric surface the weight of its fairness, in patch units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Smooth {
    /// No penalty; a parametric surface, which needs some, takes `Auto` (`Lambda(0.0)` is none there too).
    #[default]
    None,
    /// Chosen by the data: `Stretched`, or `Lambda` of splines below degree 3, by restricted maximum likelihood.
    Auto,
    /// `lambda * integral (S_xx^2 + 2 S_xy^2 + S_yy^2)` added to the weighted sum of squares.
    Lambda(f64),
    /// `lambda * integral (S_xxx^2 + 3 S_xxy^2 + 3 S_xyy^2 + S_yyy^2)` instead, x and y over the patch's length; height fields of degree 3
    /// and more.
    Third(f64),
    /// `lambda * integral (a^3 S_xxx^2 + a S_xxy^2 + S_xyy^2 / a + S_yyy^2 / a^3)` with `a = aspect`: bends are so many times as long along
    /// x as along y. Every derivative counts once, without the factor 3 of `Third`.
    Stretched {
        /// Weight of the roughness.
        lambda: f64,
        /// Length of bends along x over that along y.
        aspect: f64,
    },
}

impl Smooth {
    /// So little roughness that it moves nothing that data tell, and continues a spline of these degrees where they tell nothing.
    pub fn faint(degree: [usize; 2]) -> Smooth {
        match RoughnessOrder::of_degrees(degree) {
            RoughnessOrder::Second => Smooth::Lambda(FAINT),
            RoughnessOrder::Third => Smooth::Third(FAINT),
        }
    }
}
