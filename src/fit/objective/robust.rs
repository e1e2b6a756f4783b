//! Robust loss by iterative reweighting: slips and false contacts lose their say, the pattern of the equations stays.
//!
//! ```text
//! t = residual / scale        scale = 1.4826 median |r| of heights, median |r| / 1.1774 of normals (two dimensions)
//! Huber  w = min(1, 1.345/|t|)            Tukey  w = (1 - (t/4.685)^2)^2, 0 beyond;  Tukey starts from Huber
//! ```
//!
//! P. J. Huber, *Robust Statistics*, 1981; A. Beaton and J. Tukey, Technometrics 16 (1974). Both constants give 95 % of
//! least squares' efficiency under normal noise. A contact has two weights, one for its height, one for its slopes.
//! Where the noise levels are to be estimated, the scales are the estimate: variance components would believe the slips.

use crate::fit::notes::Note;
use crate::fit::objective::data::Data;
use crate::fit::objective::{Fitted, Levelled, fit_plain, noise_levels};
use crate::fit::{Declared, FitError, FitOptions, NoiseLevels, NormalSigma, Objective, Patch, Robust, SlopeWeights};
use crate::linalg::{SiteWeights, Sites, site_rows};
use crate::observation::angular_residual_squared;

const HUBER: f64 = 1.345;
const TUKEY: f64 = 4.685;
/// Median of |N(0, 1)| is 1/1.4826.
const OF_HEIGHTS: f64 = 1.482_6;
/// Median length of two independent N(0, 1) is 1.17741.
const OF_NORMALS: f64 = 1.0 / 1.177_41;
/// Scales below this in the patch frame (where data are of size 1) are rounding.
const NO_NOISE: f64 = 1e-13;
/// Weights that move by less than this change S and R in the fifth digit at most; Tukey takes some 20 steps to get there.
const STANDS: f64 = 1e-5;
const MAX_STEPS: usize = 60;

/// Residual sizes per site, `None` where the site has no such row.
struct Distances {
    z: Vec<Option<f64>>,
    slope: Vec<Option<f64>>,
}

/// Fits under the given loss.
pub fn fit_robust(patch: &Patch, data: &Data, options: &FitOptions, loss: Robust) -> Result<Fitted, FitError> {
    let plain = fit_plain(patch, data, options)?;
    let (mut fitted, mut weights, mut steps) = settle(patch, data, options, Robust::Huber, plain)?;
    if loss == Robust::Tukey {
        let more;
        (fitted, weights, more) = settle(patch, data, options, Robust::Tukey, fitted)?;
        steps += more;
    }
    // the rows carry square roots: half the weight is 0.5 in its square
    let lost = |r: usize| weights.iter().any(|w| w[r] * w[r] < 0.5);
    let sites = (0..weights[0].len()).filter(|&r| lost(r)).count();
    fitted.notes.push(Note::Outliers { sites, steps });
    Ok(fitted)
}

/// Reweights until the weights stand: the fit, the square roots of its weights, the steps.
fn settle(
    patch: &Patch,
    data: &Data,
    options: &FitOptions,
    loss: Robust,
    start: Fitted,
) -> Result<(Fitted, [Vec<f64>; 2], usize), FitError> {
    let mut fitted = start;
    let mut weights = [vec![1.0; fitted.equations.sites.len()], vec![1.0; fitted.equations.sites.len()]];
    for step in 1..=MAX_STEPS {
        let found = distances(data, options, &fitted);
        let next = [weigh(&found.z, OF_HEIGHTS, loss), weigh(&found.slope, OF_NORMALS, loss)];
        let moved =
            (0..2).flat_map(|b| next[b].iter().zip(&weights[b]).map(|(a, b)| (a - b).abs())).fold(0.0_f64, f64::max);
        weights = next;
        let declared = with_scales(patch, data, options, &found);
        fitted = fit_plain(patch, &data.reweighted(&weights[0], &weights[1]), &declared)?;
        if moved < STANDS || step == MAX_STEPS {
            if declared.objective != options.objective {
                let levels = NoiseLevels { declared: Declared::Estimated, ..noise_levels(&fitted) };
                fitted.levels = Levelled::Known(levels);
            }
            return Ok((fitted, weights, step));
        }
    }
    Ok((fitted, weights, MAX_STEPS))
}

/// Square roots of the loss's weights; a block whose scale is zero to rounding keeps its rows.
fn weigh(distances: &[Option<f64>], factor: f64, loss: Robust) -> Vec<f64> {
    let Some(scale) = scale(distances, factor) else { return vec![1.0; distances.len()] };
    let weight = |size: f64| {
        let t = size / scale;
        match loss {
            Robust::Tukey if t < TUKEY => (1.0 - (t / TUKEY).powi(2)).powi(2),
            Robust::Tukey => 0.0,
            _ => (HUBER / t).min(1.0),
        }
    };
    distances.iter().map(|d| d.map_or(1.0, |size| weight(size).sqrt())).collect()
}

/// Robust scale of a block; `None` without rows, or where residuals are rounding.
fn scale(distances: &[Option<f64>], factor: f64) -> Option<f64> {
    let mut sizes: Vec<f64> = distances.iter().flatten().copied().collect();
    if sizes.is_empty() {
        return None;
    }
    let middle = sizes.len() / 2;
    Some(factor * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1).filter(|s| *s > NO_NOISE)
}

/// The options with levels that are to be estimated declared as the robust scales.
fn with_scales(patch: &Patch, data: &Data, options: &FitOptions, found: &Distances) -> FitOptions {
    let (z, slope) = (scale(&found.z, OF_HEIGHTS), scale(&found.slope, OF_NORMALS));
    let (Some(z), Some(slope)) = (z, slope) else { return options.clone() };
    let z = z * patch.frame.scale;
    let normals = Objective::Normals(NormalSigma::Known { z, normal_deg: slope.to_degrees() });
    let objective = match options.objective {
        Objective::Auto if data.has_normals() => normals,
        Objective::Normals(NormalSigma::Auto) => normals,
        Objective::Auto | Objective::Slopes(SlopeWeights::Auto) => {
            Objective::Slopes(SlopeWeights::Explicit([1.0 / z, 1.0 / slope, 1.0 / slope]))
        }
        declared => declared,
    };
    FitOptions { objective, ..options.clone() }
}

fn distances(data: &Data, options: &FitOptions, fitted: &Fitted) -> Distances {
    let measured = data.measured();
    let sites = &fitted.equations.sites;
    let columns = sites.shape().basis[1];
    let by_angle = data.has_normals() && !matches!(options.objective, Objective::Slopes(_));
    let one = SiteWeights { z: 1.0, a: 1.0, b: 0.0, d: 1.0 };
    let mut found = Distances { z: vec![None; sites.len()], slope: vec![None; sites.len()] };
    sites.visit(|site| {
        let r = site.index;
        let [s, p, q] = site_rows(site, &one, &fitted.solution.coefficients, columns);
        if measured.z_weight[r] != 0.0 {
            found.z[r] = Some((measured.z[r] - s).abs());
        }
        if measured.normal_weight[r] != 0.0 {
            let n = measured.normals[r];
            found.slope[r] = Some(if by_angle {
                angular_residual_squared(n, p, q).sqrt()
            } else {
                (-n[0] / n[2] - p).hypot(-n[1] / n[2] - q)
            });
        }
    });
    found
}
