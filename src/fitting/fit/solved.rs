//! What steps 2 and 3 leave for the steps after them: the patch, the data in it, the rows solved, the surface.

use std::sync::OnceLock;

use crate::fit::noise::fingers::Fingers;
use crate::fit::noise::sds::{NoiseSds, NoiseSource};
use crate::fit::noise::variance_ratio_posterior::Levels;
use crate::fit::objective::fitted::Fitted;
use crate::fit::placing::Patch;
use crate::fit::{FitOptions, Robust};
use crate::observation::Data;
use palpate_geometry::surface::HeightField;

/// A solved fit before anything is asked of it.
#[derive(Clone, Debug)]
pub(super) struct Solved {
    /// The options it was fitted with.
    pub options: FitOptions,
    /// Frame and knots.
    pub patch: Patch,
    /// The data in the patch frame.
    pub data: Data,
    /// Equations, solution and notes.
    pub fitted: Fitted,
    /// The surface in patch coordinates.
    pub surface: HeightField,
    noise: OnceLock<NoiseSds>,
    condition: OnceLock<f64>,
    levels: OnceLock<Option<Levels>>,
}

impl Solved {
    /// All that steps 2 and 3 found.
    pub(super) fn new(patch: Patch, data: Data, fitted: Fitted, surface: HeightField, options: FitOptions) -> Solved {
        let (noise, condition, levels) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
        Solved { options, patch, data, fitted, surface, noise, condition, levels }
    }

    /// Noise sds; where weights were given they are computed from the residuals on first access.
    pub(super) fn noise(&self) -> &NoiseSds {
        let Fitted { equations, solution, noise, .. } = &self.fitted;
        self.noise.get_or_init(|| noise.sds(equations, solution))
    }

    /// What few contacts leave open about the two noise sds, and what the touches of a finger share; `None` of many contacts
    /// with independent errors, and where [`Levels::new`] says so.
    pub(super) fn levels(&self) -> Option<&Levels> {
        let found = || {
            let are_known = self.fitted.noise.source() == NoiseSource::Sigma;
            Levels::new(&self.fitted.equations, &self.fitted.solution, self.fingers(), are_known)
        };
        self.levels.get_or_init(found).as_ref()
    }

    /// The order of touch, where contacts say which finger made them. Under a robust loss the rows left out break it.
    fn fingers(&self) -> Option<Fingers> {
        match &self.data {
            Data::Scattered { contacts, numbers } if self.options.robust == Robust::None => {
                Fingers::of(contacts, numbers.as_deref())
            }
            _ => None,
        }
    }

    /// 1-norm condition estimate of the equilibrated weighted rows; computed on first access.
    pub(super) fn condition(&self) -> f64 {
        *self.condition.get_or_init(|| self.fitted.solution.factor.condition())
    }

    /// Height of the patch's origin along the frame's z axis, input units.
    pub(super) fn origin_height(&self) -> f64 {
        let frame = &self.patch.frame;
        if frame.keeps_axes() { frame.origin[2] } else { frame.rotate(frame.origin)[2] }
    }
}
