//! Remarks that a user should see beside the answer.
//!
//! ```text
//! what the data lack (heights, noise, support)      what was done about it (steps, smoothing, reweighting, turned axes)
//! ```

/// Remarks that belong to the answer.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// No height rows: the mean height is fixed to zero.
    SlopesOnly,
    /// Noise-free to rounding: equal weights.
    NoNoise,
    /// One block of rows is met exactly, so its noise level has no estimate.
    NoiseVanished,
    /// Axes of the patch differ from the input's.
    Rotated,
    /// Gauss-Newton steps, at all levels that were tried.
    GaussNewton {
        /// Steps taken, polishing included.
        steps: usize,
    },
    /// Coefficients without data.
    Unsupported {
        /// How many.
        coefficients: usize,
    },
    /// Smoothing parameter chosen by the data.
    Smoothed {
        /// lambda.
        lambda: f64,
    },
    /// Robust loss: contacts whose rows lost more than half their weight.
    Outliers {
        /// How many.
        sites: usize,
        /// Reweightings until the weights stood.
        steps: usize,
    },
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Note::SlopesOnly => write!(f, "no heights: the mean height is fixed to zero"),
            Note::NoNoise => write!(f, "residuals are rounding: equal weights"),
            Note::NoiseVanished => {
                write!(
                    f,
                    "one of the two noise levels vanished: the surface meets those rows exactly, declare --sigma or --weights"
                )
            }
            Note::Rotated => write!(f, "the patch has its own axes, z along the mean normal"),
            Note::GaussNewton { steps } => write!(f, "normal rows settled in {steps} Gauss-Newton steps"),
            Note::Unsupported { coefficients } => {
                write!(f, "{coefficients} coefficients lack data; their part of the surface is masked")
            }
            Note::Outliers { sites, steps } => {
                write!(f, "{sites} contacts lost more than half their weight to the robust loss ({steps} reweightings)")
            }
            Note::Smoothed { lambda } => write!(
                f,
                "smoothing parameter {lambda:.3e} chosen by generalised cross-validation, which assumes independent rows"
            ),
        }
    }
}
