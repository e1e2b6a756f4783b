//! What a user may choose about a fit; the same words on the command line, in a scene's `[fit]` and here.

use std::fmt;

use super::FitError;

/// Shape grids beyond this many points are typing errors: their maps alone would take gigabytes.
const MAX_GRID_POINTS: usize = 100_000_000;

/// Weights of the slope rows (paper Eq. 14). They multiply residuals, not their squares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

/// Noise level of the normal rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum NormalSigma {
    /// Two variance components, heights and normals, estimated with the fit.
    #[default]
    Auto,
    /// Known levels.
    Known {
        /// Sd of z at exact x, y, input units.
        z: f64,
        /// Sd of the normal per tangent axis, degrees.
        normal_deg: f64,
    },
}

/// Which of the two objectives is minimised; never mixed in one fit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Objective {
    /// `Normals(Auto)` with normals, `Slopes(Auto)` with slopes, heights alone without either.
    #[default]
    Auto,
    /// Slope rows, linear (the paper).
    Slopes(SlopeWeights),
    /// Normal rows, maximum likelihood by Gauss-Newton.
    Normals(NormalSigma),
}

/// How the least squares problem is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Cheapest first, moving on when its own estimate calls for it; every move is reported.
    #[default]
    Auto,
    /// Cholesky of the normal matrix.
    Cholesky,
    /// QR of the rows.
    Qr,
    /// Fast diagonalisation of a complete grid.
    Kronecker,
    /// Conjugate gradients preconditioned by fast diagonalisation.
    Pcg,
}

/// Thin-plate roughness penalty of a height field; of a surface in space the weight of its fairness, in patch units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Smooth {
    /// No penalty; a surface in space, which needs some, takes `Auto` (`Lambda(0.0)` is none there too).
    #[default]
    None,
    /// Chosen by the data.
    Auto,
    /// `lambda * integral (S_xx^2 + 2 S_xy^2 + S_yy^2)` added to the weighted sum of squares.
    Lambda(f64),
}

/// Robust loss, by iterative reweighting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
pub enum FrameChoice {
    /// Those of the input.
    Keep,
    /// Those of the input when all nz > 0 or without normals, else from the mean normal and the sweep.
    Auto,
}

/// Which kind of surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SurfaceKind {
    /// `z = S(x, y)`.
    #[default]
    Height,
    /// `Q(u, v)`.
    Parametric,
    /// Whichever the contacts call for.
    Auto,
}

impl SurfaceKind {
    /// The word on the command line, in scenes and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            SurfaceKind::Height => "height",
            SurfaceKind::Parametric => "parametric",
            SurfaceKind::Auto => "auto",
        }
    }
}

impl fmt::Display for SurfaceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What becomes of contacts outside a given domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OutsideDomain {
    /// They are refused.
    #[default]
    Refuse,
    /// The end polynomial is evaluated there, as a study does whose noise carries contacts over the edge.
    Extend,
}

/// Everything that decides a fit, with the design's defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct FitOptions {
    /// Height field, surface in space, or whichever the contacts call for. Default: height field.
    pub surface: SurfaceKind,
    /// Directions u, v of a surface in space in which it closes on itself.
    pub closed: [bool; 2],
    /// Degrees p (x) and q (y), 1 to 9. Default 2.
    pub degree: [usize; 2],
    /// Uniform segments per direction. Default 1.
    pub segments: [usize; 2],
    /// Full clamped knot vectors in input units, instead of `segments`.
    pub knots: Option<[Vec<f64>; 2]>,
    /// `[x0, x1, y0, y1]`, input units. Default: bounding box of the contacts.
    pub domain: Option<[f64; 4]>,
    /// Contacts outside a given domain. Default: refused.
    pub outside: OutsideDomain,
    /// What is minimised.
    pub objective: Objective,
    /// How it is solved.
    pub method: Method,
    /// Roughness penalty.
    pub smooth: Smooth,
    /// Loss.
    pub robust: Robust,
    /// Points of the shape grid per direction. Default 8 x 8.
    pub grid: [usize; 2],
    /// Fraction of each side cut at every edge of the shape grid, 0 to below 1/2. Default 0.
    pub inset: f64,
    /// Axes of the patch. `None`: as `Auto`, but normals that all point down are refused as inward.
    pub frame: Option<FrameChoice>,
    /// Level of the intervals. Default 0.95.
    pub level: f64,
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
            grid: [8, 8],
            inset: 0.0,
            frame: None,
            level: 0.95,
        }
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
        match self.objective {
            Objective::Normals(NormalSigma::Known { z, normal_deg }) if !is_positive(z) || !is_positive(normal_deg) => {
                fault("sigma", format!("{z},{normal_deg}"), "two positive numbers: a length, degrees")
            }
            Objective::Slopes(SlopeWeights::Explicit(w)) if w.iter().any(|v| !v.is_finite() || *v < 0.0) => {
                fault("weights", format!("{},{},{}", w[0], w[1], w[2]), "three finite numbers, none negative")
            }
            _ => match self.smooth {
                Smooth::Lambda(lambda) if !lambda.is_finite() || lambda < 0.0 => {
                    fault("smooth", lambda.to_string(), "a finite number, not negative")
                }
                _ => Ok(()),
            },
        }
    }
}

fn is_positive(v: f64) -> bool {
    v.is_finite() && v > 0.0
}
