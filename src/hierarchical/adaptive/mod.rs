//! Knots where the contacts ask for them: fits that split cells by evidence and stop at the noise.
//!
//! ```text
//! minimise  sum wz^2 (z - S)^2 + sigma_z^2/sigma_n^2 sum (slope or normal rows)^2 + lambda integral of S's derivatives of order 2 or 3, squared
//! ```
//!
//! Which cells are split is decided by a test with a controlled rate of false splits, lambda and both variances by restricted maximum
//! likelihood, outliers by local scales. Nothing is asked of the user but contacts.

mod answer;
mod certificate;
mod contact_passes;
mod ground;
mod held_contacts;
mod local_scale;
mod marginal_likelihood;
mod options;
mod plan;
mod plane;
mod refinement;
mod rules;
mod shape;
mod split_test;
mod system;
#[cfg(test)]
mod tests;
pub mod tiles;
mod tuning;
mod unresolved;

pub use answer::{AdaptiveFit, AdaptiveReport};
pub use ground::ContactBounds;
pub use options::{AdaptiveOptions, OutlierRule, RowVariances};
pub use plan::{AdaptivePlan, RepeatedHeights, plan_adaptive};
pub use refinement::RefinementRound;
pub use rules::{DetailRule, LevelRule, RoundRule, SplitRule};
pub use shape::ShapeQuestion;
pub use system::FitWork;

use std::time::Duration;

use crate::equations::{BlockWeights, CellSums, LoadLaw, SortedContacts};
use crate::error::HierarchyError;
use crate::factor::{PointInverse, SparseCholesky};
use crate::field::HierarchicalField;
use certificate::backward_error;
use contact_passes::ContactPasses;
use ground::FitGround;
use held_contacts::HeldContacts;
use palpate_geometry::contact::{Contacts, Frame};
use palpate_numeric::statistics::VarianceComponent;
use plane::plane_probability;
use refinement::{MeshRefinement, components};
use system::{System, timed};

/// Fits a height field to contacts with or without slopes or normals.
///
/// ```
/// use palpate_geometry::contact::Contacts;
/// use palpate_hierarchical::adaptive::{AdaptiveOptions, fit_adaptive};
///
/// // a plain with one narrow dimple
/// let (x, y): (Vec<f64>, Vec<f64>) = (0..10_000).map(|r| ((r % 100) as f64 / 50.0 - 1.0, (r / 100) as f64 / 50.0 - 1.0)).unzip();
/// let dimple = |x: f64, y: f64| -0.1 * (-((x - 0.3).powi(2) + (y + 0.2).powi(2)) / 0.005).exp();
/// let z = x.iter().zip(&y).enumerate().map(|(r, (x, y))| dimple(*x, *y) + 1e-3 * (r as f64 * 12.9898).sin()).collect();
/// let fit = fit_adaptive(&Contacts::from_positions(x, y, z), &AdaptiveOptions::default())?;
/// assert!((fit.at(0.3, -0.2).z + 0.1).abs() < 0.005);
/// assert!(fit.at(0.3, -0.2).derivatives().principal().unwrap().shape_index().unwrap() < -0.8);
/// # Ok::<(), palpate_hierarchical::error::HierarchyError>(())
/// ```
///
/// # Errors
/// Faulty contacts or options, contacts outside of a given domain, contacts and roughness that leave a function undetermined.
pub fn fit_adaptive(contacts: &Contacts, options: &AdaptiveOptions) -> Result<AdaptiveFit, HierarchyError> {
    let mut given = PreparedContacts::of(contacts, options)?;
    let (refinement, system) = refined(&given.ground, &mut given.held, options, given.sorting)?;
    answered(refinement, system, given.ground.frame)
}

/// Contacts in the order of the cells of a base grid, with what is known of their variances.
struct PreparedContacts {
    ground: FitGround,
    held: HeldContacts,
    sorting: Duration,
}

impl PreparedContacts {
    fn of(contacts: &Contacts, options: &AdaptiveOptions) -> Result<PreparedContacts, HierarchyError> {
        contacts.check()?;
        let ground = FitGround::of(&ContactBounds::of(contacts), options)?;
        let mut sorting = Duration::ZERO;
        let sorted = timed(&mut sorting, || SortedContacts::new(contacts, &ground.frame, &ground.mesh))?;
        let held = HeldContacts::new(sorted, ground.mesh.levels().degree());
        Ok(PreparedContacts { ground, held, sorting })
    }
}

/// Cells split until nothing but noise is left.
fn refined<'a>(
    ground: &FitGround,
    passes: &'a mut dyn ContactPasses,
    options: &'a AdaptiveOptions,
    sorting: Duration,
) -> Result<(MeshRefinement<'a>, System), HierarchyError> {
    let FitGround { mesh, weights, declared, .. } = ground;
    let mut refinement = MeshRefinement::begin(options, passes, mesh.clone(), *weights, *declared)?;
    refinement.work.sorting = sorting;
    let system = refinement.run()?;
    Ok((refinement, system))
}

/// The answer from the last fit.
fn answered(mut refinement: MeshRefinement<'_>, system: System, frame: Frame) -> Result<AdaptiveFit, HierarchyError> {
    let uncertainty = refinement.options.uncertainty;
    // of the last residuals, once for all that is told of the fit
    let sums = timed(&mut refinement.work.passes, || refinement.passes.sums(&refinement.field))?;
    let inverse = if uncertainty { point_inverse(&mut refinement, &system, &sums) } else { None };
    let traces = inverse.as_ref().map(|inverse| traces(&refinement, &system, &sums, inverse));
    let [heights, slopes] = components(sums.totals(), traces.unwrap_or_default());
    let columns = refinement.passes.columns();
    let outliers = refinement.passes.outliers(&refinement.field)?;
    let counted = columns.count - outliers.len();
    let certified = uncertainty.then(|| backward_error(&refinement, &system, &sums));
    let plane_p = match traces {
        Some([z, s]) => plane_probability(&mut refinement, z + s)?,
        None => None,
    };
    let smoothing = inverse.as_ref().map(|_| smoothing_bias(&refinement, &system)).transpose()?;
    let draws_error = inverse.as_ref().and_then(PointInverse::error);
    Ok(AdaptiveFit {
        inverse,
        smoothing,
        variance: refinement.variance,
        slope_sd: columns.layout.oriented.then(|| slope_sd(refinement.options, &slopes)),
        report: AdaptiveReport {
            rounds: refinement.rounds,
            outliers,
            lambdas: refinement.lambdas,
            freedom: traces.map(|[z, s]| z + s),
            normals: columns.normals,
            counted,
            plane_p,
            rms: (heights.squares / heights.rows.max(1.0)).sqrt() * frame.scale,
            backward_error: certified,
            condition: system.factor.whole().map_or(f64::NAN, SparseCholesky::condition),
            factor_entries: system.factor.factor_entries(),
            by_gradients: system.factor.whole().is_none(),
            draws_error,
            work: refinement.work,
        },
        factor: system.factor,
        field: refinement.field,
        frame,
    })
}

/// What variances at points follow from: of the whole where that was factored, else by random draws of the surface.
fn point_inverse(refinement: &mut MeshRefinement<'_>, system: &System, sums: &CellSums) -> Option<PointInverse> {
    let MeshRefinement { options, weights, lambdas, work, .. } = refinement;
    let law = LoadLaw { space: &system.space, sums, weights: *weights, order: options.roughness, lambdas };
    timed(&mut work.inverse, || PointInverse::of(&system.factor, || law.draw(options.posterior_draws)))
}

/// Of slopes or normals, as it was declared or found.
fn slope_sd(options: &AdaptiveOptions, slopes: &VarianceComponent) -> f64 {
    match options.noise {
        RowVariances::Known { slopes, .. } => slopes,
        RowVariances::Estimated => slopes.sd_of_one_at_least(),
    }
}

/// What roughness takes off a surface like the one that was found: `(A + P)^-1 P c`.
fn smoothing_bias(refinement: &MeshRefinement<'_>, system: &System) -> Result<HierarchicalField, HierarchyError> {
    let c = refinement.field.coefficients();
    let mut bias = vec![0.0; c.len()];
    system.pattern.multiply(&system.rough(&refinement.lambdas), c, &mut bias);
    system.factor.solve(&mut bias);
    HierarchicalField::new(system.space.clone(), bias)
}

/// Degrees of freedom that the surface takes of the heights and of the slopes: `tr (A + lambda P)^-1 A_k`.
fn traces(refinement: &MeshRefinement<'_>, system: &System, sums: &CellSums, inverse: &PointInverse) -> [f64; 2] {
    let weights = refinement.weights;
    let trace = |weights: BlockWeights| {
        let (values, _) = system.pattern.assemble(&system.space, sums, weights);
        inverse.trace_with(system.pattern.starts(), system.pattern.rows(), &values)
    };
    let heights = trace(BlockWeights { slopes: 0.0, ..weights });
    let slopes = if sums.layout().oriented { trace(BlockWeights { heights: 0.0, ..weights }) } else { 0.0 };
    [heights, slopes]
}
