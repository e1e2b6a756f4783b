//! Robust loss by iterative reweighting: slips and false contacts lose their weight, the pattern of the equations stays.
//!
//! ```text
//! t = residual / scale        scale = c median |r|,  c = MAD_TO_SD of heights, RAYLEIGH_TO_SD of normals (two dimensions)
//! w = w(t) of Huber or Tukey; Tukey starts from Huber         [`palpate_numeric::statistics::Loss`]
//! ```
//!
//! A contact has two weights, one for its height, one for its slopes.
//! Where the noise sds are to be estimated, the robust scales are the estimate, because variance components count the slips.

use crate::fit::noise::record::NoiseRecord;
use crate::fit::noise::sds::{MEDIAN_EFFICIENCY, NoiseSds, NoiseSource};
use crate::fit::noise::traces::hat_traces;
use crate::fit::notes::Note;
use crate::fit::objective::budget::Budget;
use crate::fit::objective::extrapolation::LastStep;
use crate::fit::objective::fitted::Fitted;
use crate::fit::objective::{Course, PlainFit};
use crate::fit::placing::Patch;
use crate::fit::{FitError, FitOptions, NormalSigma, Objective, Robust, SlopeWeights};
use crate::observation::{Data, angular_residual_squared};
use palpate_numeric::linalg::{Sites, visit_values};
use palpate_numeric::statistics::{Loss, MAD_TO_SD, RAYLEIGH_TO_SD, upper_median};

/// Scales below this in the patch frame (where data are of size 1) are rounding.
const NO_NOISE: f64 = 1e-13;
/// Weights that move by less than this change S and R in the fifth digit at most; Tukey's take some 20 steps to do so.
const CONVERGED: f64 = 1e-5;
const MAX_STEPS: usize = 60;
/// Weights that move by less than this go the way that they have gone: no loss has then taken or given back most of a contact's weight.
const SETTLING: f64 = 0.1;

/// Residual sizes per site, `None` where the site has no such row.
struct Distances {
    z: Vec<Option<f64>>,
    slope: Vec<Option<f64>>,
}

/// A fit whose weights have stopped moving.
struct Reweighted {
    fitted: Fitted,
    /// Square roots of the weights of every site, `[heights, slopes]`.
    weights: [Vec<f64>; 2],
    steps: usize,
    /// Largest move of a weight's root in the last step.
    moved: f64,
}

/// Fits under the loss of the options.
///
/// # Errors
/// Those of the plain fit.
pub(super) fn fit_with_loss(
    patch: &Patch,
    data: &Data,
    options: &FitOptions,
    (plain, budget): (PlainFit, &Budget),
) -> Result<Fitted, FitError> {
    let start = plain(patch, data, options, budget, Course::Answer)?;
    if options.robust == Robust::None {
        return Ok(start);
    }
    let mut found = reweight(patch, data, options, (Loss::Huber, plain, budget), start)?;
    if options.robust == Robust::Tukey {
        let steps = found.steps;
        found = reweight(patch, data, options, (Loss::Tukey, plain, budget), found.fitted)?;
        found.steps += steps;
    }
    let Reweighted { mut fitted, weights, steps, moved } = found;
    // these are square roots: half the weight is 0.5 in the square
    let is_outlier = |r: usize| weights.iter().any(|w| w[r] * w[r] < 0.5);
    let sites = (0..weights[0].len()).filter(|&r| is_outlier(r)).count();
    fitted.notes.push(Note::Outliers { sites, steps });
    if moved >= CONVERGED {
        fitted.notes.push(Note::Unsettled { moved });
    }
    fitted.loss_weights = Some(weights);
    Ok(fitted)
}

/// Reweights and fits again until no weight moves.
fn reweight(
    patch: &Patch,
    data: &Data,
    options: &FitOptions,
    (loss, plain, budget): (Loss, PlainFit, &Budget),
    start: Fitted,
) -> Result<Reweighted, FitError> {
    let sites = start.equations.sites.len();
    let mut found = Reweighted { fitted: start, weights: [vec![1.0; sites], vec![1.0; sites]], steps: 0, moved: 0.0 };
    let mut before = LastStep::default();
    for step in 1..=MAX_STEPS {
        let distances = distances(data, options, &found.fitted);
        let scales = [scale(&distances.z, 0), scale(&distances.slope, 1)];
        // where most numbers fit exactly the median residual is 0, and the rounding of the others would be slips
        let scales = [0, 1].map(|k| at_least(scales[k], patch.rounding[k]));
        let next = [weigh(&distances.z, scales[0], loss), weigh(&distances.slope, scales[1], loss)];
        let moves = (0..2).flat_map(|b| next[b].iter().zip(&found.weights[b]).map(|(a, b)| (a - b).abs()));
        let moved = moves.fold(0.0_f64, f64::max);
        let declared = with_scales(patch, data, options, scales);
        let is_last = moved < CONVERGED || step == MAX_STEPS || budget.is_spent();
        // weights that still move need no digits that the next ones change
        let course = if is_last { Course::Answer } else { Course::From(&found.fitted.solution.coefficients) };
        let refitted = plain(patch, &data.reweighted(&next[0], &next[1]), &declared, budget, course);
        let mut fitted = refitted.map_err(|fault| too_few_left(fault, loss))?;
        if is_last {
            let estimated = declared.objective != options.objective;
            fitted.noise = NoiseRecord::Known(robust_noise(&fitted, &distances, scales, loss, estimated));
        }
        if !is_last {
            if moved >= SETTLING {
                before = LastStep::default();
            }
            let (to, from) = (&mut fitted.solution.coefficients, &found.fitted.solution.coefficients);
            let step = to.iter().zip(from).map(|(a, b)| a - b).collect();
            before.extrapolate(to, step);
        }
        found = Reweighted { fitted, weights: next, steps: step, moved };
        if is_last {
            break;
        }
    }
    Ok(found)
}

/// More contacts would not help where it is the loss that has taken their weight.
fn too_few_left(fault: FitError, loss: Loss) -> FitError {
    match (fault, loss) {
        (FitError::TooFew { equations, unknowns, .. }, Loss::Tukey) => FitError::Option {
            option: "robust",
            value: format!("tukey, which leaves {equations} equations of some weight for {unknowns} unknowns"),
            expected: "take huber, under which every contact keeps some weight, or lower degree or segments",
        },
        (fault, _) => fault,
    }
}

/// What the residuals say of one kind of rows under a loss, by sums over its rows.
struct LossSums {
    /// Variance for the sandwich of weighted rows.
    variance: f64,
    /// By which factor the sum of weighted squares is too small for an F ratio.
    efficiency: f64,
    /// Degrees of freedom.
    dof: f64,
    /// Factor of the sd for the unknowns that the residuals have spent.
    freedom: f64,
}

/// P. J. Huber, *Ann. Stat.* 1 (1973) 799, for one kind of rows:
///
/// ```text
/// cov c = A^-1 (sum_b v_b E_b'W_b E_b) A^-1,     A = E'W E,     v = K^2 [sum psi^2/(rows - trace)] mean w/(mean psi')^2
/// K = 1 + trace/rows var(psi')/(mean psi')^2
/// ```
///
/// A normal has two rows: the mean of psi' over directions is (psi' + w)/2.
fn loss_sums(distances: &[Option<f64>], scale: f64, loss: Loss, components: f64, trace: f64) -> LossSums {
    let (mut count, mut sums) = (0.0, [0.0; 5]);
    for t in distances.iter().flatten().map(|d| d / scale) {
        let [w, slope] = loss.weight_and_slope(t);
        let slope = if components > 1.0 { 0.5 * (slope + w) } else { slope };
        count += 1.0;
        [w, slope, slope * slope, (w * t).powi(2), w * t * t].iter().zip(&mut sums).for_each(|(v, sum)| *sum += v);
    }
    let rows = components * count;
    let [weight, slope, slope_squares] = [0, 1, 2].map(|k| sums[k] / count);
    let dof = rows - trace;
    let spread = (slope_squares - slope * slope).max(0.0) / (slope * slope);
    let correction = 1.0 + trace / rows * spread;
    let variance = correction.powi(2) * sums[3] / dof * weight / (slope * slope);
    LossSums {
        variance,
        efficiency: sums[4] / dof / variance,
        dof: (dof * weight * MEDIAN_EFFICIENCY).max(1.0),
        freedom: (rows / dof).sqrt(),
    }
}

/// The noise of a reweighted fit. Scales by medians are those of residuals, which are smaller than the errors by the
/// unknowns that they have spent; what is said of the noise is corrected for that, the weights are not.
fn robust_noise(
    fitted: &Fitted,
    distances: &Distances,
    scales: [Option<f64>; 2],
    loss: Loss,
    estimated: bool,
) -> NoiseSds {
    let mut sds = fitted.noise.sds(&fitted.equations, &fitted.solution);
    let traces = hat_traces(&fitted.equations, &fitted.solution);
    let squares = fitted.equations.residual_squares(&fitted.solution.coefficients);
    let kinds = [(&distances.z, 1.0), (&distances.slope, 2.0)];
    let mut efficiency = [0.0; 2];
    for (b, (sizes, components)) in kinds.into_iter().enumerate() {
        let Some(scale) = scales[b] else { continue };
        let found = loss_sums(sizes, scale, loss, components, traces[b]);
        // the rows need not be divided by this scale: their own sum of squares tells their unit
        let unit = squares[b] / weighted_squares(sizes, scale, loss);
        if !(found.variance * unit).is_finite() || found.variance <= 0.0 {
            continue;
        }
        (sds.row_variances[b], sds.dof[b]) = (found.variance * unit, found.dof);
        efficiency = [efficiency[0] + found.dof * found.efficiency, efficiency[1] + found.dof];
        if estimated && b == 0 {
            sds.sigma_z = sds.sigma_z.map(|sd| sd * found.freedom);
        } else if estimated {
            sds.sigma_normal_deg = sds.sigma_normal_deg.map(|sd| sd * found.freedom);
            sds.sigma_slope = sds.sigma_slope.map(|sd| sd * found.freedom);
        }
    }
    if efficiency[1] > 0.0 {
        sds.efficiency = efficiency[0] / efficiency[1];
    }
    if estimated {
        sds.source = NoiseSource::Estimated;
    }
    sds
}

fn weighted_squares(distances: &[Option<f64>], scale: f64, loss: Loss) -> f64 {
    distances.iter().flatten().map(|d| d / scale).map(|t| loss.weight_and_slope(t)[0] * t * t).sum()
}

/// Square roots of the loss's weights; rows whose scale is zero to rounding keep their weight.
fn weigh(distances: &[Option<f64>], scale: Option<f64>, loss: Loss) -> Vec<f64> {
    let Some(scale) = scale else { return vec![1.0; distances.len()] };
    distances.iter().map(|d| d.map_or(1.0, |size| loss.root_weight(size / scale))).collect()
}

/// Robust scale of one kind of rows, 0 for heights and 1 for slopes or normals; `None` without rows, or where residuals are
/// rounding.
pub(in crate::fit) fn scale(distances: &[Option<f64>], kind: usize) -> Option<f64> {
    let sizes: Vec<f64> = distances.iter().flatten().copied().collect();
    let factor = if kind == 0 { MAD_TO_SD } else { RAYLEIGH_TO_SD };
    upper_median(sizes).map(|median| factor * median).filter(|s| *s > NO_NOISE)
}

/// A scale that is no smaller than the rounding of its numbers; `None` where both are nothing.
fn at_least(scale: Option<f64>, rounding: f64) -> Option<f64> {
    scale.map(|s| s.max(rounding)).or(Some(rounding).filter(|s| *s > NO_NOISE))
}

/// The options with the robust scales declared as noise sds, where sds were to be estimated.
fn with_scales(patch: &Patch, data: &Data, options: &FitOptions, scales: [Option<f64>; 2]) -> FitOptions {
    let [Some(z), Some(slope)] = scales else { return options.clone() };
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
    let readings = data.readings();
    let sites = &fitted.equations.sites;
    let by_angle = data.has_normals() && !matches!(options.objective, Objective::Slopes(_));
    let mut found = Distances { z: vec![None; sites.len()], slope: vec![None; sites.len()] };
    let is_grid = sites.grid_axes().is_some();
    // where errors in x and y make some rows worse than others, each counts in its own sd
    let unequal = options.sigma_xy > 0.0;
    let in_units = |distance: f64, weight: f64| if unequal { distance * weight } else { distance };
    visit_values(sites, &fitted.solution.coefficients, |r, [s, p, q]| {
        let (z, z_weight) = readings.height(r);
        if z_weight != 0.0 {
            found.z[r] = Some(in_units((z - s).abs(), z_weight));
        }
        if is_grid {
            found.slope[r] = readings.slopes(r).map(|[zx, zy]| ((zx - p).powi(2) + (zy - q).powi(2)).sqrt());
            return;
        }
        let measured = readings.at(r);
        if measured.normal_weight != 0.0 {
            let n = measured.normal;
            let distance = if by_angle {
                angular_residual_squared(n, p, q).sqrt()
            } else {
                (-n[0] / n[2] - p).hypot(-n[1] / n[2] - q)
            };
            found.slope[r] = Some(in_units(distance, measured.normal_weight));
        }
    });
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::fit_contacts;
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::Lcg;

    /// Touches of a bar with normals, of which every eighth slips.
    fn slipping(generator: &mut Lcg) -> Contacts {
        let one = |k: usize| {
            let (a, y) = (1.6 * generator.uniform() - 0.8, 4.0 * generator.uniform());
            let mut err = |sd: f64| sd * generator.normal();
            let slip = if k.is_multiple_of(8) { 0.3 } else { 0.0 };
            let point = [5.0 * a.sin(), y, 5.0 * a.cos() + err(0.02) + slip];
            (point, [a.sin() + err(0.03), err(0.03) + slip, a.cos()])
        };
        let (points, normals): (Vec<[f64; 3]>, Vec<[f64; 3]>) = (0..160).map(one).unzip();
        Contacts::from_points(&points).with_normal_vectors(&normals)
    }

    /// Fits between two reweightings are rough, and weights run ahead of them: what is reached is what the answer's own residuals say.
    #[test]
    fn weights_of_an_answer_are_those_of_its_residuals() {
        let contacts = slipping(&mut Lcg::new(5));
        for (robust, loss) in [(Robust::Huber, Loss::Huber), (Robust::Tukey, Loss::Tukey)] {
            for objective in [Objective::Auto, Objective::Slopes(SlopeWeights::Auto)] {
                let options = FitOptions::default().with_robust(robust).with_objective(objective);
                let fit = fit_contacts(&contacts, &options).unwrap();
                let (data, fitted) = (&fit.solved.data, &fit.solved.fitted);
                let found = distances(data, &options, fitted);
                let kinds = [&found.z, &found.slope];
                let expected = [0, 1].map(|k| weigh(kinds[k], scale(kinds[k], k), loss));
                let weights = fit.loss_weights().unwrap();
                for k in 0..2 {
                    let off = weights[k].iter().zip(&expected[k]).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
                    assert!(off < 2.0 * CONVERGED, "{robust:?} {objective:?}: {off}");
                    assert!(weights[k].iter().any(|w| *w < 0.7), "no slip has lost weight");
                }
            }
        }
    }
}
