//! What roughness costs.
//!
//! ```text
//! none    LAMBDA (second derivatives)    third=LAMBDA (alike in all directions)    third=LAMBDA,ASPECT (stretched)    auto: one of these
//! ```

use super::{FitOptions, SurfaceKind};
use crate::fit::FitError;

/// Aspects whose sixth power, which is the ratio of the largest factor of the roughness to the least, leaves some of a number's digits.
const ASPECTS: [f64; 2] = [0.01, 100.0];

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

impl FitOptions {
    /// Checks the roughness penalty against degrees and kind of surface.
    pub(super) fn check_smooth(&self) -> Result<(), FitError> {
        let fault = |expected| Err(FitError::Option { option: "smooth", value: self.smooth.to_string(), expected });
        let (lambda, aspect) = match self.smooth {
            Smooth::None | Smooth::Auto => return Ok(()),
            Smooth::Lambda(lambda) | Smooth::Third(lambda) => (lambda, 1.0),
            Smooth::Stretched { lambda, aspect } => (lambda, aspect),
        };
        if !matches!(self.smooth, Smooth::Lambda(_)) {
            if self.surface == SurfaceKind::Parametric {
                return fault("a parametric surface takes auto or a number");
            }
            if self.degree[0].min(self.degree[1]) < 3 {
                return fault("third=LAMBDA needs degree 3 or more, since other splines have no third derivative");
            }
        }
        if !lambda.is_finite() || lambda < 0.0 {
            return fault("a finite number, not negative");
        }
        if !(ASPECTS[0]..=ASPECTS[1]).contains(&aspect) {
            return fault("third=LAMBDA,ASPECT with an aspect from 0.01 to 100");
        }
        Ok(())
    }
}
