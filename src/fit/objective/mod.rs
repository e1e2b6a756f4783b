//! Step 3: which rows with which weights, solved; what the noise levels were.
//!
//! Presets hold in patch units, where the height residual is in units of half the domain's larger side; explicit
//! weights and sigmas apply to input units, so a length takes the patch's scale.

pub(super) mod data;
pub(super) mod equations;
pub(super) mod normals;
pub(super) mod robust;
pub(super) mod smoothing;

use crate::fit::linear::{self, Solution};
use crate::fit::noise::{Asked, Trial, hat_traces, variance_components};
use crate::fit::notes::Note;
use crate::fit::objective::data::{Data, Measured};
use crate::fit::objective::equations::Equations;
use crate::fit::objective::normals::{Levels, NormalProblem, SETTLED, Settled};
use crate::fit::{
    Fit, FitError, FitOptions, Method, NormalSigma, Objective, Observed, Patch, Robust, SlopeWeights, Smooth,
};
use crate::linalg::{RowWeights, SiteWeights, Sites, StencilMatrix};
use crate::observation::{angular_residual_squared, roughness_matrix};

/// What the rows were weighted by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Declared {
    /// Block weights of slope rows `[wz, wx, wy]`, input units.
    Weights([f64; 3]),
    /// Levels that the user declared.
    Sigma,
    /// Levels estimated with the fit.
    Estimated,
}

/// Noise levels and where they come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseLevels {
    /// Weights given, sigmas given, or both estimated.
    pub declared: Declared,
    /// The weights' word: `tangent`, `position`, `equal`, `auto` or `explicit`; `None` with normal rows.
    pub weights: Option<SlopeWeights>,
    /// Sd of a height, input units.
    pub sigma_z: Option<f64>,
    /// Sd of a normal per tangent axis, degrees.
    pub sigma_normal_deg: Option<f64>,
    /// Sd of a slope.
    pub sigma_slope: Option<f64>,
    /// Variances of the weighted rows per block, `[heights, slopes]`: 1 for whitened rows.
    pub block_variance: [f64; 2],
}

/// Root mean square residuals of the rows that count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rms {
    /// Heights, input units.
    pub z: Option<f64>,
    /// Slopes in x; `None` also where a normal has no slope.
    pub zx: Option<f64>,
    /// Slopes in y.
    pub zy: Option<f64>,
    /// Normals: rms angle, degrees.
    pub normal_deg: Option<f64>,
}

/// Noise levels: found with the fit, or had from its residuals by whoever asks first (they cost a trace of the hat matrix).
#[derive(Debug)]
pub enum Levelled {
    /// Declared, or estimated with the fit.
    Known(NoiseLevels),
    /// Weights that are no noise levels; `scale` is the patch's, `unit` what extreme weights were divided by.
    Weights { word: SlopeWeights, used: [f64; 3], unit: f64, squares: [f64; 2] },
}

/// Equations, solution, levels.
#[derive(Debug)]
pub struct Fitted {
    pub equations: Equations,
    pub solution: Solution,
    pub levels: Levelled,
    pub notes: Vec<Note>,
    /// Relative move of the last Gauss-Newton step; zero for slope rows.
    pub settled: f64,
}

/// Which objective the data and options call for.
fn resolve(data: &Data, options: &FitOptions) -> Result<Objective, FitError> {
    let resolved = match options.objective {
        Objective::Auto if data.has_normals() => Objective::Normals(NormalSigma::Auto),
        Objective::Auto => Objective::Slopes(SlopeWeights::Auto),
        other => other,
    };
    if matches!(resolved, Objective::Normals(_)) && !data.has_orientation() {
        return Err(FitError::Objective { objective: "--sigma", needed: "normals or slopes" });
    }
    Ok(resolved)
}

/// Forms and solves the rows, with the loss and the smoothing that the options ask for.
pub fn fit_rows(patch: &Patch, data: &Data, options: &FitOptions) -> Result<Fitted, FitError> {
    if options.smooth == Smooth::Auto {
        return crate::fit::objective::smoothing::fit_smoothed(patch, data, options);
    }
    match options.robust {
        Robust::None => fit_plain(patch, data, options),
        loss => crate::fit::objective::robust::fit_robust(patch, data, options, loss),
    }
}

/// One plain least squares fit.
pub fn fit_plain(patch: &Patch, data: &Data, options: &FitOptions) -> Result<Fitted, FitError> {
    check_method(data, options)?;
    let sites = data.sites(patch);
    let roughness = roughness(patch, options);
    let mut fitted = match resolve(data, options)? {
        Objective::Normals(sigma) => fit_normals(patch, data, &sites, sigma, options.method, roughness)?,
        Objective::Slopes(weights) => {
            data.check_slopes()?;
            fit_slopes(patch, data, &sites, weights, options.method, roughness)?
        }
        Objective::Auto => return Err(FitError::NoWeight),
    };
    if !patch.frame.keeps_axes() {
        fitted.notes.push(Note::Turned);
    }
    if !fitted.solution.unsupported.is_empty() {
        fitted.notes.push(Note::Unsupported { coefficients: fitted.solution.unsupported.len() });
    }
    Ok(fitted)
}

fn check_method(data: &Data, options: &FitOptions) -> Result<(), FitError> {
    match (options.method, data) {
        (Method::Kronecker, Data::Scattered { .. }) => {
            Err(FitError::Method { method: "kronecker", why: "needs a complete grid" })
        }
        (Method::Pcg, Data::Scattered { .. }) => Err(FitError::Method { method: "pcg", why: "needs a grid" }),
        _ => Ok(()),
    }
}

/// The penalty is the same number in patch and input units: S_xx scales by 1/L, squared, times the area L^2.
fn roughness(patch: &Patch, options: &FitOptions) -> Option<(f64, StencilMatrix)> {
    match options.smooth {
        Smooth::Lambda(lambda) if lambda > 0.0 => Some((lambda, roughness_matrix(&patch.knots))),
        _ => None,
    }
}

fn too_few(equations: &Equations) -> Result<(), FitError> {
    let [z, slopes] = equations.row_weights.row_counts(equations.sites.len());
    if z + slopes == 0 {
        return Err(FitError::NoWeight);
    }
    if z + slopes < equations.unknowns() && equations.roughness.is_none() {
        return Err(FitError::TooFew {
            contacts: equations.sites.len(),
            equations: z + slopes,
            unknowns: equations.unknowns(),
        });
    }
    Ok(())
}

/// Block weights in patch units: presets as they are, explicit ones with the height's length.
fn block_weights(weights: SlopeWeights, scale: f64) -> [f64; 3] {
    match weights {
        SlopeWeights::Auto | SlopeWeights::Equal => [1.0, 1.0, 1.0],
        SlopeWeights::Tangent => [1.0, 10.0, 10.0],
        SlopeWeights::Position => [10.0, 1.0, 1.0],
        SlopeWeights::Explicit([z, x, y]) => [z * scale, x, y],
    }
}

fn fit_slopes(
    patch: &Patch,
    data: &Data,
    sites: &Observed,
    weights: SlopeWeights,
    method: Method,
    roughness: Option<(f64, StencilMatrix)>,
) -> Result<Fitted, FitError> {
    let scale = patch.frame.scale;
    let unit = std::cell::Cell::new(1.0);
    let trial_at = |block: [f64; 3]| -> Result<Trial, FitError> {
        let (mut row_weights, mut targets) = data.slope_rows(block);
        unit.set(balance(&row_weights));
        if unit.get() != 1.0 {
            (row_weights, targets) = data.slope_rows(block.map(|w| w * unit.get()));
        }
        let roughness = roughness.clone().map(|(lambda, p)| (lambda * unit.get() * unit.get(), p));
        let equations = Equations::new(sites.clone(), row_weights, targets, roughness);
        too_few(&equations)?;
        let solution = linear::solve(&equations, method)?;
        let squares = equations.residual_squares(&solution.coefficients);
        Ok(Trial { equations, solution, squares, moved: 0.0 })
    };
    let mut notes = Vec::new();
    let block = block_weights(weights, scale);
    let (trial, levels) = if weights == SlopeWeights::Auto && data.has_orientation() {
        let (levels, trial, note) =
            variance_components(|Asked { levels: l, .. }| trial_at([1.0 / l.z, 1.0 / l.slope, 1.0 / l.slope]))?;
        notes.extend(note);
        (trial, Some(levels))
    } else {
        (trial_at(block)?, None)
    };
    let [heights, _] = trial.equations.row_weights.row_counts(sites.len());
    if heights == 0 {
        notes.push(Note::SlopesOnly);
    }
    let levels = match levels {
        Some(l) => {
            let used = [1.0 / (l.z * scale), 1.0 / l.slope, 1.0 / l.slope];
            let counts = trial.equations.row_weights.row_counts(sites.len());
            Levelled::Known(NoiseLevels {
                declared: Declared::Estimated,
                ..of_weights(weights, used, 1.0, [1.0, 1.0], counts)
            })
        }
        None => {
            let used = [block[0] / scale, block[1], block[2]];
            Levelled::Weights { word: weights, used, unit: unit.get(), squares: trial.squares }
        }
    };
    Ok(Fitted { equations: trial.equations, solution: trial.solution, levels, notes, settled: 0.0 })
}

/// Levels of weighted rows with these variances.
fn of_weights(word: SlopeWeights, used: [f64; 3], unit: f64, variance: [f64; 2], rows: [usize; 2]) -> NoiseLevels {
    let sd = |b: usize| (rows[b] > 0 && used[b] > 0.0).then(|| variance[b].sqrt() / unit / used[b]);
    NoiseLevels {
        declared: Declared::Weights(used),
        weights: Some(word),
        sigma_z: sd(0),
        sigma_normal_deg: None,
        sigma_slope: sd(1),
        block_variance: variance,
    }
}

/// The levels that the rows were, or turn out to be, weighted by.
pub fn noise_levels(fitted: &Fitted) -> NoiseLevels {
    match &fitted.levels {
        Levelled::Known(levels) => *levels,
        Levelled::Weights { word, used, unit, squares } => {
            let rows = fitted.equations.row_weights.row_counts(fitted.equations.sites.len());
            let variance = residual_variances(&fitted.equations, &fitted.solution, *squares);
            of_weights(*word, *used, *unit, variance, rows)
        }
    }
}

/// Weights beyond this (or below its inverse) have squares near overflow (or underflow).
const EXTREME: f64 = 1e100;

/// The power of two that brings extreme weights near one; 1 for all others, whose bits it leaves alone. Weights say
/// what counts more, so that a common factor changes nothing.
fn balance(row_weights: &RowWeights) -> f64 {
    let of = |m: &SiteWeights| m.z.abs().max(m.a.abs()).max(m.d.abs());
    let largest = match row_weights {
        RowWeights::Uniform(m) => of(m),
        RowWeights::PerSite(all) => all.iter().fold(0.0_f64, |most, m| most.max(of(m))),
    };
    if largest == 0.0 || !largest.is_finite() || (1.0 / EXTREME..EXTREME).contains(&largest) {
        1.0
    } else {
        (-largest.log2().round()).exp2()
    }
}

/// Variance of the weighted rows of each block, from its residuals and its share of the unknowns.
fn residual_variances(equations: &Equations, solution: &Solution, squares: [f64; 2]) -> [f64; 2] {
    let rows = equations.row_weights.row_counts(equations.sites.len()).map(|r| r as f64);
    let traces = hat_traces(equations, solution);
    [0, 1].map(|b| {
        let freedom = rows[b] - traces[b];
        if freedom > 1e-9 * rows[b].max(1.0) { squares[b] / freedom } else { 0.0 }
    })
}

fn fit_normals(
    patch: &Patch,
    data: &Data,
    sites: &Observed,
    sigma: NormalSigma,
    method: Method,
    roughness: Option<(f64, StencilMatrix)>,
) -> Result<Fitted, FitError> {
    data.check_normals()?;
    let measured = data.measured();
    let scale = patch.frame.scale;
    let steps = std::cell::Cell::new(0);
    let at = |levels: Levels| problem(sites, &measured, levels, &roughness, method);
    let trial_at = |Asked { levels, start, within }: Asked| -> Result<Trial, FitError> {
        let problem = at(levels);
        let settled = problem.minimise(start, within)?;
        steps.set(steps.get() + settled.steps);
        let squares = problem.squares(&settled.solution.coefficients);
        Ok(Trial { equations: settled.equations, solution: settled.solution, squares, moved: settled.moved })
    };
    too_few(&at(Levels { z: 1.0, slope: 1.0 }).linearised(&vec![0.0; sites.shape().unknowns()]))?;
    let mut notes = Vec::new();
    let (levels, trial, declared) = match sigma {
        NormalSigma::Known { z, normal_deg } => {
            let levels = Levels { z: z / scale, slope: normal_deg.to_radians() };
            (levels, trial_at(Asked { levels, start: None, within: SETTLED })?, Declared::Sigma)
        }
        NormalSigma::Auto => {
            let (levels, trial, note) = variance_components(trial_at)?;
            notes.extend(note);
            (levels, trial, Declared::Estimated)
        }
    };
    let unpolished = Settled { equations: trial.equations, solution: trial.solution, steps: 0, moved: 0.0 };
    let Settled { equations, solution, steps: polishing, moved } = at(levels).polish(unpolished)?;
    if measured.z_weight.iter().all(|w| *w == 0.0) {
        notes.push(Note::SlopesOnly);
    }
    notes.push(Note::GaussNewton { steps: steps.get() + polishing });
    let noise = NoiseLevels {
        declared,
        weights: None,
        sigma_z: Some(levels.z * scale),
        sigma_normal_deg: Some(levels.slope.to_degrees()),
        sigma_slope: None,
        block_variance: [1.0, 1.0],
    };
    Ok(Fitted { equations, solution, levels: Levelled::Known(noise), notes, settled: moved })
}

fn problem<'a>(
    sites: &'a Observed,
    measured: &'a Measured,
    levels: Levels,
    roughness: &Option<(f64, StencilMatrix)>,
    method: Method,
) -> NormalProblem<'a> {
    NormalProblem { sites, measured, levels, roughness: roughness.clone(), method }
}

/// Unweighted residuals of the final surface.
pub fn rms(fit: &Fit) -> Rms {
    let sites = &fit.fitted.equations.sites;
    let columns = sites.shape().basis[1];
    let measured = fit.data.measured();
    let one = crate::linalg::SiteWeights { z: 1.0, a: 1.0, b: 0.0, d: 1.0 };
    let (mut sums, mut counts) = ([0.0; 4], [0usize; 4]);
    sites.visit(|site| {
        let r = site.index;
        let [s, p, q] = crate::linalg::site_rows(site, &one, &fit.fitted.solution.coefficients, columns);
        let mut add = |k: usize, square: f64| {
            sums[k] += square;
            counts[k] += 1;
        };
        if measured.z_weight[r] != 0.0 {
            add(0, (measured.z[r] - s).powi(2));
        }
        if measured.normal_weight[r] != 0.0 {
            let n = measured.normals[r];
            add(1, (-n[0] / n[2] - p).powi(2));
            add(2, (-n[1] / n[2] - q).powi(2));
            add(3, angular_residual_squared(n, p, q));
        }
    });
    let root = |k: usize| {
        let mean = sums[k] / counts[k] as f64;
        (counts[k] > 0 && mean.is_finite()).then(|| mean.sqrt())
    };
    Rms {
        z: root(0).map(|v| v * fit.patch.frame.scale),
        zx: root(1),
        zy: root(2),
        normal_deg: root(3).map(f64::to_degrees),
    }
}
