//! Remarks that a user should see beside the answer.
//!
//! ```text
//! what the data lack (heights, noise, support)      what was done about it (steps, smoothing, reweighting, rotated axes)
//! ```

use palpate_geometry::contact::counted;

use super::Smooth;

/// Remarks that belong to the answer.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// There are no heights, so the mean height is fixed to zero.
    SlopesOnly,
    /// The data have no noise beyond rounding, so all rows weigh the same.
    NoNoise,
    /// The surface meets the heights, or the slopes or normals, exactly, so their noise has no estimate.
    NoiseVanished,
    /// The axes of the patch differ from those of the input.
    Rotated,
    /// Gauss-Newton steps, over all noise estimates that were tried.
    GaussNewton {
        /// Steps taken, polishing included.
        steps: usize,
    },
    /// Some coefficients lack data.
    Unsupported {
        /// How many.
        coefficients: usize,
    },
    /// The smoothing parameter was chosen by the data.
    Smoothed {
        /// What was chosen, by which the same fit is had again.
        chosen: Smooth,
    },
    /// Errors in x and y were known, and contacts were moved to where they most likely lie.
    Located {
        /// Root mean square of the moves, input units.
        moved: f64,
        /// Fits until contacts and weights stood still, or were given up.
        fits: usize,
    },
    /// A full step of Gauss-Newton on the normals still moves the surface where it was given up: nothing is guaranteed of it.
    NotAtRest {
        /// By how much it moves a coefficient, over the largest one.
        moved: f64,
    },
    /// All loops together (places, smoothing, reweighting, noise, normals) took the steps that the options allow, and were cut
    /// short.
    StepsSpent {
        /// The steps allowed.
        steps: usize,
    },
    /// Contacts that lost more than half their weight to the robust loss.
    Outliers {
        /// How many.
        sites: usize,
        /// Reweightings until the weights stood still, or until they were given up.
        steps: usize,
    },
    /// The weights of the robust loss did not stand still: two sets of outliers explain the data nearly as well.
    Unsettled {
        /// By how much the last reweighting moved a weight's root, at most.
        moved: f64,
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
                    "one of the two noise estimates vanished: the surface meets those rows exactly, which few contacts cannot \
                     contradict; give sigma or weights as numbers"
                )
            }
            Note::Rotated => write!(f, "the patch has its own axes, with z across it"),
            Note::GaussNewton { steps } => write!(f, "normal rows settled in {steps} Gauss-Newton steps"),
            Note::Unsupported { coefficients } => {
                write!(f, "{coefficients} coefficients lack data; their part of the surface is masked")
            }
            Note::Located { moved, fits } => write!(
                f,
                "errors in x and y are counted: contacts were moved by {moved:.2e} (root mean square) to where they most \
                 likely lie ({fits} fits)"
            ),
            Note::NotAtRest { moved } => write!(
                f,
                "Gauss-Newton on the normals did not come to rest: a full step still moves a coefficient by {moved:.1e} of the \
                 largest one, and two surfaces explain the normals nearly as well; lower degree or segments, or add contacts"
            ),
            Note::StepsSpent { steps } => write!(
                f,
                "the noise, weights or smoothing had not settled when all {steps} steps of a fit were taken: S, R and their \
                 intervals depend on where that was; check that heights, places and normals are in one unit, give sigma or \
                 weights as numbers, or lower degree or segments"
            ),
            Note::Outliers { sites, steps } => {
                let [sites, steps] = [(*sites, "contact"), (*steps, "reweighting")].map(|(n, noun)| counted(n, noun));
                write!(f, "the robust loss took more than half of the weight from {sites} ({steps})")
            }
            Note::Unsettled { moved } => write!(
                f,
                "the weights of the robust loss did not stand still: the last step moved one by {moved:.1e}, and what is \
                 said of S and R depends on where it stopped; lower degree or segments, or add contacts"
            ),
            Note::Smoothed { chosen } => {
                write!(
                    f,
                    "the surface is as smooth as makes the contacts likeliest, each of which is taken to err for itself: "
                )?;
                match chosen {
                    Smooth::Lambda(lambda) => write!(f, "--smooth {lambda:.3e}")?,
                    _ => write!(f, "--smooth {chosen}")?,
                }
                match chosen {
                    Smooth::Stretched { aspect, .. } if *aspect > 1.0 => {
                        write!(f, "; bends are taken for {aspect:.2} times as long along x as along y")
                    }
                    Smooth::Stretched { aspect, .. } if *aspect < 1.0 => {
                        write!(f, "; bends are taken for {:.2} times as long along y as along x", 1.0 / aspect)
                    }
                    _ => Ok(()),
                }
            }
        }
    }
}
