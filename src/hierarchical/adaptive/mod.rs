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
mod local_scale;
mod marginal_likelihood;
mod options;
mod plan;
mod plane;
mod refinement;
mod shape;
mod split_test;
mod system;
#[cfg(test)]
mod tests;

pub use answer::{AdaptiveFit, AdaptiveReport};
pub use options::{AdaptiveOptions, OutlierRule, RowVariances};
pub use plan::{AdaptivePlan, RepeatedHeights, plan_adaptive};
pub use refinement::RefinementRound;
pub use shape::ShapeQuestion;
pub use system::FitWork;

use std::time::Duration;

use crate::equations::{BlockWeights, CellSums, SortedContacts, patch_frame};
use crate::error::HierarchyError;
use crate::factor::SelectedInverse;
use crate::mesh::Mesh;
use certificate::backward_error;
use palpate_geometry::contact::{Contacts, Frame};
use palpate_numeric::bspline::Knots;
use plane::plane_probability;
use refinement::MeshRefinement;
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
    let given = PreparedContacts::of(contacts, options)?;
    let (refinement, system) = given.refined(options)?;
    Ok(answered(refinement, system, given.frame))
}

/// Contacts in the order of the cells of a base grid, with what is known of their variances.
struct PreparedContacts {
    frame: Frame,
    mesh: Mesh,
    sorted: SortedContacts,
    weights: BlockWeights,
    declared: Option<f64>,
    sorting: Duration,
}

impl PreparedContacts {
    fn of(contacts: &Contacts, options: &AdaptiveOptions) -> Result<PreparedContacts, HierarchyError> {
        options.check()?;
        contacts.check()?;
        let domain = options.domain.unwrap_or_else(|| [ends(&contacts.x), ends(&contacts.y)]);
        let frame = patch_frame(domain, ends(&contacts.z));
        let mesh = base_mesh(domain, &frame, contacts.len(), options)?;
        let mut sorting = Duration::ZERO;
        let sorted = timed(&mut sorting, || SortedContacts::new(contacts, &frame, &mesh))?;
        let (weights, declared) = match options.noise {
            RowVariances::Known { heights, slopes } => {
                let heights = heights / frame.scale;
                (BlockWeights { heights: 1.0, slopes: (heights / slopes).powi(2) }, Some(heights * heights))
            }
            RowVariances::Estimated => (BlockWeights { heights: 1.0, slopes: 1.0 }, None),
        };
        Ok(PreparedContacts { frame, mesh, sorted, weights, declared, sorting })
    }

    /// Cells split until nothing but noise is left.
    fn refined<'a>(&'a self, options: &'a AdaptiveOptions) -> Result<(MeshRefinement<'a>, System), HierarchyError> {
        let PreparedContacts { mesh, sorted, weights, declared, .. } = self;
        let mut refinement = MeshRefinement::begin(options, sorted, mesh.clone(), *weights, *declared)?;
        refinement.work.sorting = self.sorting;
        let system = refinement.run()?;
        Ok((refinement, system))
    }
}

/// Least and largest number.
fn ends(column: &[f64]) -> [f64; 2] {
    column.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(*v), hi.max(*v)])
}

/// The base grid of nearly square cells in the patch's frame, no more of them than contacts can tell about.
fn base_mesh(
    domain: [[f64; 2]; 2],
    frame: &Frame,
    contacts: usize,
    options: &AdaptiveOptions,
) -> Result<Mesh, HierarchyError> {
    let [x, y] = domain;
    let sides = domain.map(|[lo, hi]| hi - lo);
    if !sides.iter().all(|side| side.is_finite() && *side > 0.0) {
        return Err(HierarchyError::Flat { x0: x[0], x1: x[1], y0: y[0], y1: y[1] });
    }
    let larger = sides[0].max(sides[1]);
    let supported = (contacts as f64 / options.least_contacts.max(1) as f64).sqrt().ceil().max(1.0) as usize;
    let along = options.base_segments.min(supported);
    let axis = |k: usize| {
        let segments = (along as f64 * sides[k] / larger).round().max(1.0) as usize;
        let [lo, hi] = domain[k].map(|t| (t - frame.origin[k]) / frame.scale);
        let name = if k == 0 { "x" } else { "y" };
        Knots::uniform(options.degree, segments, lo, hi).map_err(|source| HierarchyError::Knots { axis: name, source })
    };
    Mesh::new([axis(0)?, axis(1)?])
}

/// The answer from the last fit.
fn answered(mut refinement: MeshRefinement, system: System, frame: Frame) -> AdaptiveFit {
    let inverse = refinement
        .options
        .uncertainty
        .then(|| timed(&mut refinement.work.inverse, || SelectedInverse::of(&system.factor)))
        .flatten();
    // of the last residuals, once for all that is told of the fit
    let sums = refinement.options.uncertainty.then(|| last_sums(&refinement, &system));
    let traces = sums.as_ref().zip(inverse.as_ref()).map(|(sums, inverse)| traces(&refinement, &system, sums, inverse));
    let [heights, slopes] = refinement.components(traces.unwrap_or_default());
    let declared = match refinement.options.noise {
        RowVariances::Known { slopes, .. } => Some(slopes),
        RowVariances::Estimated => None,
    };
    let oriented = refinement.contacts.oriented();
    let outliers = refinement.shares.iter().flatten().enumerate().filter(|(_, share)| **share == 0.0);
    let mut outliers: Vec<usize> = outliers.map(|(r, _)| refinement.contacts.number(r)).collect();
    outliers.sort_unstable();
    let left_out = outliers.len();
    let certified = sums.map(|sums| backward_error(&refinement, &system, &sums));
    let plane_p = traces.and_then(|[z, s]| plane_probability(&refinement, z + s));
    AdaptiveFit {
        inverse,
        variance: refinement.variance,
        slope_sd: oriented.then(|| declared.unwrap_or_else(|| slopes.sd_of_one_at_least())),
        report: AdaptiveReport {
            rounds: refinement.rounds,
            outliers,
            lambdas: refinement.lambdas,
            freedom: traces.map(|[z, s]| z + s),
            counted: refinement.contacts.len() - left_out,
            plane_p,
            rms: (heights.squares / heights.rows.max(1.0)).sqrt() * frame.scale,
            backward_error: certified,
            condition: system.factor.condition(),
            factor_entries: system.factor.factor_entries(),
            work: refinement.work,
        },
        factor: system.factor,
        field: refinement.field,
        frame,
    }
}

/// Sums of the contacts by cell about the surface that was found.
fn last_sums(refinement: &MeshRefinement, system: &System) -> CellSums {
    let degree = system.space.mesh().levels().degree();
    let mut sums = CellSums::empty(system.space.leaves().len(), degree, refinement.contacts);
    sums.add(refinement.contacts, &refinement.field, &refinement.residuals, refinement.shares.as_deref());
    sums
}

/// Degrees of freedom that the surface takes of the heights and of the slopes: `tr (A + lambda P)^-1 A_k`.
fn traces(refinement: &MeshRefinement, system: &System, sums: &CellSums, inverse: &SelectedInverse) -> [f64; 2] {
    let weights = refinement.weights;
    let trace = |weights: BlockWeights| {
        let (values, _) = system.pattern.assemble(&system.space, sums, weights);
        inverse.trace_with(system.pattern.starts(), system.pattern.rows(), &values)
    };
    let heights = trace(BlockWeights { slopes: 0.0, ..weights });
    let slopes = if refinement.contacts.oriented() { trace(BlockWeights { heights: 0.0, ..weights }) } else { 0.0 };
    [heights, slopes]
}
