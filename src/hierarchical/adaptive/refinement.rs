//! Rounds of fitting and splitting until nothing but noise is left.
//!
//! ```text
//! fit -> residuals -> local scales -> which cells hold more than noise? -> split them and what must be split with them -> fit ...
//! ```
//!
//! A round costs two passes over the contacts and a few factorisations. The surface at hand goes over into the finer space as it is, and
//! every fit is a step from it.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::local_scale::{LocalScales, noise_ratios, shares, weigh_by_noise};
use super::marginal_likelihood::{StepEquations, lambdas_of_levels};
use super::options::{AdaptiveOptions, OutlierRule, RowVariances};
use super::split_test::{SplitTest, cells_to_split, stands_out};
use super::system::{FitWork, System, timed};
use crate::equations::{BlockWeights, CellSums, ContactResiduals, SortedContacts};
use crate::error::HierarchyError;
use crate::field::HierarchicalField;
use crate::mesh::{CellId, Mesh};
use crate::space::HierarchicalSpace;
use palpate_geometry::contact::Orientation;
use palpate_numeric::statistics::VarianceComponent;

/// Likelihoods asked for when nothing is known of lambda, and when that of the round before is.
const FIRST_SEARCH: usize = 14;
const LATER_SEARCH: usize = 4;
/// First fits after the very first, which outliers may have drawn far off, and the change of the variance that ends them.
const MOST_FIRST_FITS: usize = 8;
const SETTLED_VARIANCE: f64 = 0.02;
/// Last fits: rejections settle in two or three, the lambdas of levels in about as many.
const MOST_LAST_FITS: usize = 5;
/// The last fit takes the lambdas of split cells times this: the likelihood balances bias against variance over all cells of a level,
/// and intervals want the peaks' bias below their noise (P. Hall, *Ann. Stat.* 20 (1992) 675). It costs 5 % of the uncertainty there.
const UNDERSMOOTHING: f64 = 0.3;
/// Change of a lambda's logarithm that moves nothing beyond the noise.
const SETTLED: f64 = 0.2;
/// A level's lambda over that of the level before, before anything is known: features of half the size are as high.
const FINER_ROUGHNESS: f64 = 1.0 / 16.0;
/// Rounds beyond the deepest level: neighbours of a feature follow it late.
const LATE_ROUNDS: usize = 6;

/// One round, for whoever wants to see how the cells came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RefinementRound {
    /// Unsplit cells of the round.
    pub cells: usize,
    /// Functions.
    pub unknowns: usize,
    /// Cells that hold more than noise.
    pub split: usize,
}

/// A fit under way.
#[derive(Debug)]
pub(super) struct MeshRefinement<'a> {
    pub options: &'a AdaptiveOptions,
    pub contacts: &'a SortedContacts,
    pub field: HierarchicalField,
    pub residuals: ContactResiduals,
    pub shares: Option<Vec<f64>>,
    pub weights: BlockWeights,
    /// Those of the last step.
    pub solved_weights: BlockWeights,
    /// Weights of the roughness over the cells of every level; none before the first fit.
    pub lambdas: Vec<f64>,
    /// Variance of a row of weight 1, and what was declared of it.
    pub variance: f64,
    declared: Option<f64>,
    /// Cells that were split because they held more than noise.
    suspected: BTreeSet<CellId>,
    pub rounds: Vec<RefinementRound>,
    pub work: FitWork,
}

impl<'a> MeshRefinement<'a> {
    /// The surface z = 0 over the base grid.
    pub(super) fn begin(
        options: &'a AdaptiveOptions,
        contacts: &'a SortedContacts,
        mesh: Mesh,
        weights: BlockWeights,
        declared: Option<f64>,
    ) -> Result<MeshRefinement<'a>, HierarchyError> {
        let space = Arc::new(HierarchicalSpace::new(mesh));
        let flat = vec![0.0; space.unknowns()];
        let field = HierarchicalField::new(space, flat)?;
        let residuals = ContactResiduals::of(contacts, &field);
        Ok(MeshRefinement {
            options,
            contacts,
            field,
            residuals,
            shares: None,
            weights,
            solved_weights: weights,
            lambdas: Vec::new(),
            variance: 0.0,
            declared,
            suspected: BTreeSet::new(),
            rounds: Vec::new(),
            work: FitWork::default(),
        })
    }

    /// Fits and splits until no cell holds more than noise, then without outliers. The factor is left as that of the last fit.
    pub(super) fn run(&mut self) -> Result<System, HierarchyError> {
        let most = self.options.deepest_level + LATE_ROUNDS;
        loop {
            let mut system = self.system()?;
            if self.rounds.is_empty() {
                self.first_fits(&mut system)?
            } else {
                self.step(&mut system, 1)?
            }
            let split = self.find_cells();
            let (cells, unknowns) = (system.space.leaves().len(), system.space.unknowns());
            self.rounds.push(RefinementRound { cells, unknowns, split: split.len() });
            if split.is_empty() || unknowns > self.options.most_unknowns || self.rounds.len() > most {
                self.finish(&mut system)?;
                return Ok(system);
            }
            self.shares = self.clipped();
            self.split(&system.space, &split)?;
        }
    }

    /// Nothing is known of lambda, of the shares or of the slopes that normals are linear about: each fit makes the next one better.
    fn first_fits(&mut self, system: &mut System) -> Result<(), HierarchyError> {
        self.step(system, FIRST_SEARCH)?;
        for _ in 0..MOST_FIRST_FITS {
            let before = self.variance;
            self.shares = self.clipped();
            self.step(system, LATER_SEARCH)?;
            if (self.variance / before - 1.0).abs() < SETTLED_VARIANCE {
                break;
            }
        }
        Ok(())
    }

    fn system(&mut self) -> Result<System, HierarchyError> {
        System::plan(self.field.space().clone(), self.options.roughness, &mut self.work)
    }

    /// One step from the surface at hand; `search` likelihoods are asked for lambda, none: it stays.
    pub(super) fn step(&mut self, system: &mut System, search: usize) -> Result<(), HierarchyError> {
        let known = self.begin_levels(system.roughness.len());
        let degree = system.space.mesh().levels().degree();
        let MeshRefinement { contacts, field, residuals, shares, weights, work, .. } = self;
        let sums = timed(&mut work.passes, || {
            let mut sums = CellSums::empty(system.space.leaves().len(), degree, contacts);
            sums.add(contacts, field, residuals, shares.as_deref());
            sums
        });
        let (matrix, load) = timed(&mut work.assembly, || system.pattern.assemble(&system.space, &sums, *weights));
        let smooth = self.options.roughness.null_dimension() as f64;
        let [squares, rows, slope_squares, slope_rows] = sums.totals();
        drop(sums);
        let rough = system.rough(&self.lambdas);
        let equations = StepEquations {
            pattern: &system.pattern,
            matrix: &matrix,
            roughness: &rough,
            load: &load,
            coefficients: field.coefficients(),
            squares: weights.heights * squares + weights.slopes * slope_squares,
            rows: rows + 2.0 * slope_rows,
            declared: self.declared,
            smooth,
        };
        let step = timed(&mut work.factorisation, || equations.solve(&mut system.factor, known, search))?;
        work.factorisations += step.factorisations;
        let moved = field.coefficients().iter().zip(&step.delta).map(|(c, d)| c + d).collect();
        *field = HierarchicalField::new(system.space.clone(), moved)?;
        *residuals = timed(&mut work.passes, || ContactResiduals::of(contacts, field));
        self.variance = step.variance;
        self.solved_weights = self.weights;
        self.lambdas.iter_mut().for_each(|lambda| *lambda *= step.factor_of_lambda);
        if search > 0 && self.lambdas.len() > 1 {
            let (c, lambdas) = (field.coefficients(), &self.lambdas);
            self.lambdas =
                timed(&mut work.inverse, || lambdas_of_levels(system, lambdas, c, &matrix, step.variance, smooth));
        }
        self.weigh([0.0; 2]);
        Ok(())
    }

    /// A lambda for every level; whether there were some before. A finer level begins where surfaces of the size of its cells are as
    /// likely as those of the level before.
    fn begin_levels(&mut self, levels: usize) -> bool {
        let known = !self.lambdas.is_empty();
        while self.lambdas.len() < levels {
            self.lambdas.push(self.lambdas.last().map_or(1.0, |last| last * FINER_ROUGHNESS));
        }
        known
    }

    /// The two kinds of rows by their variances; `traces` are the degrees of freedom that the surface took of each.
    pub(super) fn weigh(&mut self, traces: [f64; 2]) {
        if self.residuals.slopes.is_empty() || self.options.noise != RowVariances::Estimated {
            return;
        }
        let [heights, slopes] = self.components(traces).map(|component| component.sd(1.0).unwrap_or(0.0));
        if heights > 0.0 && slopes > 0.0 {
            // beyond rounding of either kind the ratio means nothing
            self.weights = BlockWeights { heights: 1.0, slopes: (heights / slopes).powi(2).clamp(1e-16, 1e16) };
        }
    }

    /// Squares and rows of heights and of slopes.
    pub(super) fn components(&self, traces: [f64; 2]) -> [VarianceComponent; 2] {
        let weights = self.contacts.contacts().weights.z.as_deref();
        let mut sums = [[0.0; 2]; 2];
        for r in 0..self.contacts.len() {
            let share = self.shares.as_ref().map_or(1.0, |s| s[r]);
            let w = weights.map_or(1.0, |w| w[r]);
            sums[0][0] += share * (w * self.residuals.heights[r]).powi(2);
            sums[0][1] += if w > 0.0 { share } else { 0.0 };
            if let Some([first, second]) = self.residuals.slopes.get(r) {
                sums[1][0] += share * (first * first + second * second);
                sums[1][1] += 2.0 * share;
            }
        }
        [0, 1].map(|k| VarianceComponent { squares: sums[k][0], rows: sums[k][1], trace: traces[k] })
    }

    /// Shares for the fits while cells are split.
    fn clipped(&mut self) -> Option<Vec<f64>> {
        match self.options.outliers {
            OutlierRule::Keep => self.shares_by(|_| 1.0),
            OutlierRule::Reject { clip, .. } => self.shares_by(|t| if t > clip { clip / t } else { 1.0 }),
        }
    }

    fn shares_by(&mut self, rule: impl Fn(f64) -> f64 + Sync) -> Option<Vec<f64>> {
        let MeshRefinement { options, contacts, field, residuals, work, .. } = self;
        let varies = options.noise_varies && options.noise == RowVariances::Estimated;
        if !varies && options.outliers == OutlierRule::Keep {
            return None;
        }
        Some(timed(&mut work.passes, || {
            let scales = LocalScales::of(field.space(), contacts, residuals);
            let mut made = shares(field.space(), contacts, residuals, &scales, rule);
            if varies {
                weigh_by_noise(&mut made, &noise_ratios(contacts, residuals));
            }
            made
        }))
    }

    /// The last fits: without the contacts that lie too far off, until these and the lambdas are the same twice.
    fn finish(&mut self, system: &mut System) -> Result<(), HierarchyError> {
        for k in 0..MOST_LAST_FITS {
            let rejected = self.rejected();
            let without =
                |shares: &Option<Vec<f64>>| -> Vec<bool> { shares.iter().flatten().map(|s| *s == 0.0).collect() };
            let (same, before) = (without(&rejected) == without(&self.shares), self.lambdas.clone());
            self.shares = rejected;
            self.step(system, if k == 0 { LATER_SEARCH } else { 1 })?;
            let moved = self.lambdas.iter().zip(&before).map(|(a, b)| (a / b).ln().abs()).fold(0.0, f64::max);
            if same && moved < SETTLED {
                break;
            }
        }
        self.lambdas.iter_mut().skip(1).for_each(|lambda| *lambda *= UNDERSMOOTHING);
        self.step(system, 0)?;
        // rows of normals are linear about the surface before the step, and that one was of other lambdas
        let normals = matches!(self.contacts.contacts().orientation, Orientation::Normals { .. });
        if normals { self.step(system, 0) } else { Ok(()) }
    }

    /// Shares without the contacts that lie too far off.
    fn rejected(&mut self) -> Option<Vec<f64>> {
        match self.options.outliers {
            OutlierRule::Keep => self.shares_by(|_| 1.0),
            OutlierRule::Reject { reject, .. } => self.shares_by(|t| if t > reject { 0.0 } else { 1.0 }),
        }
    }

    /// Numbers of the leaves that hold more than noise.
    fn find_cells(&mut self) -> Vec<usize> {
        let MeshRefinement { options, contacts, field, residuals, suspected, work, .. } = self;
        let clip = match options.outliers {
            OutlierRule::Keep => f64::MAX,
            OutlierRule::Reject { clip, .. } => clip,
        };
        timed(&mut work.passes, || {
            let scales = LocalScales::of(field.space(), contacts, residuals);
            let (least_contacts, deepest_level) = (options.least_contacts, options.deepest_level);
            let (space, scales) = (field.space(), &scales);
            let test = SplitTest { space, contacts, residuals, scales, clip, least_contacts, deepest_level };
            let rates = [options.false_discovery_rate, options.significance_of_children];
            let evidence = test.evidence();
            let significances: Vec<f64> = evidence.iter().map(|cell| cell.significance).collect();
            let unshaded = |leaf: usize| stands_out(space, &evidence, leaf);
            let split = cells_to_split(space.leaves(), &significances, suspected, rates, unshaded);
            suspected.extend(split.iter().map(|leaf| space.leaves()[*leaf]));
            split
        })
    }

    fn split(&mut self, space: &HierarchicalSpace, leaves: &[usize]) -> Result<(), HierarchyError> {
        let MeshRefinement { field, work, .. } = self;
        // the surface is the same but for rounding, and so are the residuals
        *field = timed(&mut work.assembly, || {
            let mut mesh = space.mesh().clone();
            leaves.iter().try_for_each(|leaf| mesh.refine(space.leaves()[*leaf]))?;
            field.embedded(Arc::new(HierarchicalSpace::new(mesh)))
        })?;
        Ok(())
    }
}
