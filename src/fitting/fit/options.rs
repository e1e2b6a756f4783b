//! What a user may choose about a fit. The words are the same on the command line, in a scene's `[fit]` and here.

#[macro_use]
mod words;
pub(super) mod method;
mod smooth;
mod surface_kind;

pub use method::Method;
pub use smooth::Smooth;
pub use surface_kind::SurfaceKind;

use super::FitError;

/// Most points of a shape grid. A larger number is a typing error: the maps alone would take gigabytes.
const MAX_GRID_POINTS: usize = 100_000_000;

/// Aspects whose sixth power, which is the ratio of the largest factor of the roughness to the least, leaves some of a number's digits.
const ASPECTS: [f64; 2] = [0.01, 100.0];

/// Weights of the slope rows (paper Eq. 14). They multiply residuals, not their squares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum SlopeWeights {
    /// Two variance components, heights and slopes, estimated with the fit.
    Auto,
    /// 1, 10, 10 with the height residual in units of half the domain's larger side.
    #[default]
    Tangent,
    /// 10, 1, 1 in the same unit.
    Position,
    /// 1, 1, 1 in the same unit.
    Equal,
    /// Applied to heights and slopes as they are.
    Explicit([f64; 3]),
}

/// Noise of the normal rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum NormalSigma {
    /// Two variance components, heights and normals, estimated with the fit.
    #[default]
    Auto,
    /// Known standard deviations.
    Known {
        /// Sd of z at exact x, y, input units.
        z: f64,
        /// Sd of the normal per tangent axis, degrees.
        normal_deg: f64,
    },
}

/// Which of the two objectives is minimised. One fit never mixes them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Objective {
    /// `Normals(Auto)` with normals, `Slopes(Auto)` with slopes, heights alone without either.
    #[default]
    Auto,
    /// Slope rows, linear (the paper).
    Slopes(SlopeWeights),
    /// Normal rows, maximum likelihood by Gauss-Newton.
    Normals(NormalSigma),
}

/// Robust loss, by iterative reweighting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Robust {
    /// Plain least squares.
    #[default]
    None,
    /// Huber's loss.
    Huber,
    /// Tukey's biweight.
    Tukey,
}

/// Which axes the patch has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum FrameChoice {
    /// Those of the input.
    Keep,
    /// Those of the input, unless the patch leans by more than 45 degrees there or some nz <= 0: then from the mean normal
    /// (without normals the direction of least spread) and the sweep.
    Auto,
}

/// What becomes of contacts outside a given domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum OutsideDomain {
    /// They are refused.
    #[default]
    Refuse,
    /// The end polynomial is evaluated there, as a study does whose noise carries contacts over the edge.
    Extend,
}

/// Everything that decides a fit, with the design's defaults.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct FitOptions {
    /// Height field, parametric surface, or whichever the contacts call for. Default: height field.
    pub surface: SurfaceKind,
    /// Directions u, v of a parametric surface in which it closes on itself. Default: none.
    pub closed: [bool; 2],
    /// Degrees p (x) and q (y), 1 to 9. Default 2.
    pub degree: [usize; 2],
    /// Uniform segments per direction. Default 1.
    pub segments: [usize; 2],
    /// Full clamped knot vectors in input units, instead of `segments`. Default: none, so `segments` counts.
    pub knots: Option<[Vec<f64>; 2]>,
    /// `[x0, x1, y0, y1]`, input units. Default: bounding box of the contacts.
    pub domain: Option<[f64; 4]>,
    /// Contacts outside a given domain. Default: refused.
    pub outside: OutsideDomain,
    /// What is minimised. Default: normal rows with normals, slope rows with slopes, their noise estimated.
    pub objective: Objective,
    /// How it is solved. Default: the cheapest method that applies and is accurate enough.
    pub method: Method,
    /// Roughness penalty. Default: none.
    pub smooth: Smooth,
    /// Loss. Default: squares, so that every contact counts fully.
    pub robust: Robust,
    /// Known sd of the contacts' errors in x and in y, input units, along the patch's own axes where those are rotated.
    /// Default 0: contacts lie where they are said to lie.
    pub sigma_xy: f64,
    /// Points of the shape grid per direction. Default 8 x 8.
    pub grid: [usize; 2],
    /// Fraction of each side cut at every edge of the shape grid, 0 to below 1/2. Default 0.
    pub inset: f64,
    /// Axes of the patch. Default `None`: those of the input however steep, or from the mean normal where some nz <= 0;
    /// normals that all point down are refused as inward.
    pub frame: Option<FrameChoice>,
    /// Confidence level of the intervals. Default 0.95.
    pub level: f64,
    /// Least squares problems that all loops of one fit may solve together: places, smoothing, reweighting, noise, normals. Default
    /// 4,000; ordinary fits take 5 to 400, and factorisations of large rows count for several.
    pub steps: usize,
}

impl Default for FitOptions {
    fn default() -> FitOptions {
        FitOptions {
            surface: SurfaceKind::default(),
            closed: [false; 2],
            degree: [2, 2],
            segments: [1, 1],
            knots: None,
            domain: None,
            outside: OutsideDomain::default(),
            objective: Objective::default(),
            method: Method::default(),
            smooth: Smooth::default(),
            robust: Robust::default(),
            sigma_xy: 0.0,
            grid: [8, 8],
            inset: 0.0,
            frame: None,
            level: 0.95,
            steps: 4_000,
        }
    }
}

/// Every option has a method that changes it, so that options can be written in one expression:
///
/// ```
/// # use palpate_fitting::facade as palpate;
/// use palpate::fit::{FitOptions, Method, Objective, SlopeWeights};
///
/// let options = FitOptions::default()
///     .with_degree(3)
///     .with_segments(4, 4)
///     .with_objective(Objective::Slopes(SlopeWeights::Tangent))
///     .with_method(Method::Qr)
///     .with_grid(16, 16);
/// assert_eq!((options.degree, options.grid), ([3, 3], [16, 16]));
/// ```
impl FitOptions {
    /// With this degree in both directions; [`FitOptions::with_degrees`] takes two.
    pub fn with_degree(self, degree: usize) -> FitOptions {
        self.with_degrees(degree, degree)
    }

    /// With these degrees in x and y.
    pub fn with_degrees(mut self, x: usize, y: usize) -> FitOptions {
        self.degree = [x, y];
        self
    }

    /// With this many uniform segments in x and y; knots given before are dropped.
    pub fn with_segments(mut self, x: usize, y: usize) -> FitOptions {
        self.segments = [x, y];
        self.knots = None;
        self
    }

    /// With these full clamped knot vectors in x and y, input units, instead of uniform segments.
    pub fn with_knots(mut self, x: Vec<f64>, y: Vec<f64>) -> FitOptions {
        self.knots = Some([x, y]);
        self
    }

    /// With this domain `[x0, x1, y0, y1]`, input units, instead of the contacts' bounding box.
    pub fn with_domain(mut self, domain: [f64; 4]) -> FitOptions {
        self.domain = Some(domain);
        self
    }

    /// With this as what becomes of contacts outside the domain.
    pub fn with_outside(mut self, outside: OutsideDomain) -> FitOptions {
        self.outside = outside;
        self
    }

    /// With this many points of the shape grid in x and y.
    pub fn with_grid(mut self, x: usize, y: usize) -> FitOptions {
        self.grid = [x, y];
        self
    }

    /// With these axes of the patch.
    pub fn with_frame(mut self, frame: FrameChoice) -> FitOptions {
        self.frame = Some(frame);
        self
    }

    /// With this as the kind of surface.
    pub fn with_surface(mut self, surface: SurfaceKind) -> FitOptions {
        self.surface = surface;
        self
    }

    /// With these as the directions u, v in which a parametric surface closes on itself.
    pub fn with_closed(mut self, closed: [bool; 2]) -> FitOptions {
        self.closed = closed;
        self
    }

    /// With this as what is minimised.
    pub fn with_objective(mut self, objective: Objective) -> FitOptions {
        self.objective = objective;
        self
    }

    /// With this as how the least squares problem is solved.
    pub fn with_method(mut self, method: Method) -> FitOptions {
        self.method = method;
        self
    }

    /// With this as the roughness penalty.
    pub fn with_smooth(mut self, smooth: Smooth) -> FitOptions {
        self.smooth = smooth;
        self
    }

    /// With this as the loss.
    pub fn with_robust(mut self, robust: Robust) -> FitOptions {
        self.robust = robust;
        self
    }

    /// With this as the known sd of the contacts' errors in x and in y, input units.
    pub fn with_sigma_xy(mut self, sigma_xy: f64) -> FitOptions {
        self.sigma_xy = sigma_xy;
        self
    }

    /// With this as the fraction of each side cut at every edge of the shape grid.
    pub fn with_inset(mut self, inset: f64) -> FitOptions {
        self.inset = inset;
        self
    }

    /// With this as the confidence level of the intervals.
    pub fn with_level(mut self, level: f64) -> FitOptions {
        self.level = level;
        self
    }

    /// With this as how many least squares problems all loops of one fit may solve together.
    pub fn with_steps(mut self, steps: usize) -> FitOptions {
        self.steps = steps;
        self
    }
}

impl FitOptions {
    /// Checks what the data cannot: grid, inset, level, sigmas, weights, smoothing.
    ///
    /// # Errors
    /// [`FitError::Option`] with what would be right.
    pub fn check(&self) -> Result<(), FitError> {
        let fault = |option, value: String, expected| Err(FitError::Option { option, value, expected });
        if self.grid.contains(&0) || self.grid[0].saturating_mul(self.grid[1]) > MAX_GRID_POINTS {
            let value = format!("{}x{}", self.grid[0], self.grid[1]);
            return fault("grid", value, "at least 1x1 and at most 10^8 points");
        }
        if !(0.0..0.5).contains(&self.inset) {
            return fault("inset", self.inset.to_string(), "a fraction from 0 to below 0.5");
        }
        if !(self.level > 0.0 && self.level < 1.0) {
            return fault("level", self.level.to_string(), "a probability between 0 and 1");
        }
        if !(self.sigma_xy >= 0.0 && self.sigma_xy.is_finite()) {
            return fault("sigma_xy", self.sigma_xy.to_string(), "a length, 0 or above");
        }
        match self.objective {
            Objective::Normals(NormalSigma::Known { z, normal_deg }) if !is_positive(z) || !is_positive(normal_deg) => {
                fault("sigma", format!("{z},{normal_deg}"), "two positive numbers: a length, degrees")
            }
            Objective::Slopes(SlopeWeights::Explicit(w)) if w.iter().any(|v| !v.is_finite() || *v < 0.0) => {
                fault("weights", format!("{},{},{}", w[0], w[1], w[2]), "three finite numbers, none negative")
            }
            _ => self.check_smooth(),
        }
    }

    /// Checks the roughness penalty against degrees and kind of surface.
    fn check_smooth(&self) -> Result<(), FitError> {
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

    /// Refuses what only a parametric surface has.
    pub(super) fn check_height_field(&self) -> Result<(), FitError> {
        if self.surface == SurfaceKind::Parametric {
            return Err(FitError::HeightField { option: "surface kind `parametric`" });
        }
        if self.closed != [false; 2] {
            return Err(FitError::HeightField { option: "closed direction" });
        }
        Ok(())
    }
}

fn is_positive(v: f64) -> bool {
    v.is_finite() && v > 0.0
}
