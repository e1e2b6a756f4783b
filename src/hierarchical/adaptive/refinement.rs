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

use super::contact_passes::ContactPasses;
use super::local_scale::ShareRule;
use super::marginal_likelihood::{LevelStep, StepEquations};
use super::options::{AdaptiveOptions, OutlierRule, RowVariances};
use super::split_test::{SplitLimits, cells_to_split, stands_out};
use super::system::{FitWork, System, timed};
use crate::equations::BlockWeights;
use crate::error::HierarchyError;
use crate::field::HierarchicalField;
use crate::mesh::{CellId, Mesh};
use crate::space::HierarchicalSpace;
use palpate_numeric::statistics::VarianceComponent;

/// Likelihoods asked for when nothing is known of lambda, and when that of the round before is.
const FIRST_SEARCH: usize = 14;
const LATER_SEARCH: usize = 4;

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
pub(super) struct MeshRefinement<'a> {
    pub options: &'a AdaptiveOptions,
    pub passes: &'a mut dyn ContactPasses,
    pub field: HierarchicalField,
    pub weights: BlockWeights,
    /// Weights of the roughness over the cells of every level; none before the first fit.
    pub lambdas: Vec<f64>,
    /// Variance of a row of weight 1, and what was declared of it.
    pub variance: f64,
    declared: Option<f64>,
    /// Cells that were split because they held more than noise.
    suspected: BTreeSet<CellId>,
    /// Whether what was followed has been halved once more.
    halved: bool,
    pub rounds: Vec<RefinementRound>,
    pub work: FitWork,
}

impl<'a> MeshRefinement<'a> {
    /// The surface z = 0 over the base grid.
    pub(super) fn begin(
        options: &'a AdaptiveOptions,
        passes: &'a mut dyn ContactPasses,
        mesh: Mesh,
        weights: BlockWeights,
        declared: Option<f64>,
    ) -> Result<MeshRefinement<'a>, HierarchyError> {
        let space = Arc::new(HierarchicalSpace::new(mesh));
        let flat = vec![0.0; space.unknowns()];
        let field = HierarchicalField::new(space, flat)?;
        passes.about(&field)?;
        Ok(MeshRefinement {
            options,
            passes,
            field,
            weights,
            lambdas: Vec::new(),
            variance: 0.0,
            declared,
            suspected: BTreeSet::new(),
            halved: false,
            rounds: Vec::new(),
            work: FitWork::default(),
        })
    }

    /// Fits and splits until no cell holds more than noise, then without outliers. The factor is left as that of the last fit.
    pub(super) fn run(&mut self) -> Result<System, HierarchyError> {
        let most = self.options.deepest_level + self.options.rounds.late_rounds;
        loop {
            let mut system = self.system()?;
            if self.rounds.is_empty() {
                self.first_fits(&mut system)?
            } else {
                self.step(&mut system, 1)?
            }
            let split = self.find_cells()?;
            let (cells, unknowns) = (system.space.leaves().len(), system.space.unknowns());
            self.rounds.push(RefinementRound { cells, unknowns, split: split.len() });
            if split.is_empty() && self.wants_halving() {
                self.halved = true;
                let more = self.followed_leaves(&system.space);
                self.clip()?;
                self.split(&system.space, &more)?;
                continue;
            }
            if split.is_empty() || unknowns > self.options.most_unknowns || self.rounds.len() > most {
                self.finish(&mut system)?;
                return Ok(system);
            }
            self.clip()?;
            self.split(&system.space, &split)?;
        }
    }

    fn wants_halving(&self) -> bool {
        self.options.last_halving && !self.halved && !self.suspected.is_empty()
    }

    /// Leaves whose parents held more than noise.
    fn followed_leaves(&self, space: &HierarchicalSpace) -> Vec<usize> {
        let followed = |cell: &CellId| {
            let parent = cell.level.checked_sub(1).map(|level| cell.ancestor(level));
            usize::from(cell.level) < self.options.deepest_level && parent.is_some_and(|p| self.suspected.contains(&p))
        };
        let leaves = space.leaves().iter().enumerate();
        leaves.filter(|(_, cell)| followed(cell)).map(|(leaf, _)| leaf).collect()
    }

    /// Nothing is known of lambda, of the shares or of the slopes that normals are linear about: each fit makes the next one better.
    fn first_fits(&mut self, system: &mut System) -> Result<(), HierarchyError> {
        self.step(system, FIRST_SEARCH)?;
        for _ in 0..self.options.rounds.most_first_fits {
            let before = self.variance;
            self.clip()?;
            self.step(system, LATER_SEARCH)?;
            if (self.variance / before - 1.0).abs() < self.options.rounds.settled_variance {
                break;
            }
        }
        Ok(())
    }

    fn system(&mut self) -> Result<System, HierarchyError> {
        let AdaptiveOptions { roughness, most_factor_entries, .. } = *self.options;
        System::plan(self.field.space().clone(), roughness, most_factor_entries, &mut self.work)
    }

    /// One step from the surface at hand; `search` likelihoods are asked for lambda, none: it stays.
    pub(super) fn step(&mut self, system: &mut System, search: usize) -> Result<(), HierarchyError> {
        let known = self.begin_levels(system.roughness.len());
        let sums = timed(&mut self.work.passes, || self.passes.sums(&self.field))?;
        let [squares, rows, slope_squares, slope_rows] = sums.totals();
        if known {
            self.weigh([squares, rows, slope_squares, slope_rows]);
        }
        let MeshRefinement { passes, field, weights, work, .. } = self;
        let (matrix, load) = timed(&mut work.assembly, || system.pattern.assemble(&system.space, &sums, *weights));
        let smooth = self.options.roughness.null_dimension() as f64;
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
        // without a determinant no likelihood is known: the lambdas of levels move by traces alone
        let likelihoods = if system.factor.whole().is_some() { search } else { 0 };
        let step = timed(&mut work.factorisation, || equations.solve(&mut system.factor, known, likelihoods))?;
        work.factorisations += step.factorisations;
        let moved = field.coefficients().iter().zip(&step.delta).map(|(c, d)| c + d).collect();
        *field = HierarchicalField::new(system.space.clone(), moved)?;
        timed(&mut work.passes, || passes.about(field))?;
        self.variance = step.variance;
        self.lambdas.iter_mut().for_each(|lambda| *lambda *= step.factor_of_lambda);
        if search > 0 && (self.lambdas.len() > 1 || system.factor.whole().is_none()) {
            self.move_levels(system, &matrix, smooth);
        }
        Ok(())
    }

    /// The lambdas of levels, from the surface and the factor at hand.
    fn move_levels(&mut self, system: &System, matrix: &[f64], smooth: f64) {
        let MeshRefinement { field, lambdas, variance, work, options, .. } = self;
        let step = LevelStep { lambdas, coefficients: field.coefficients(), matrix, variance: *variance, smooth };
        let moved = timed(&mut work.inverse, || step.next(system, &options.levels));
        self.lambdas = moved;
    }

    /// A lambda for every level; whether there were some before. A finer level begins where surfaces of the size of its cells are as
    /// likely as those of the level before.
    fn begin_levels(&mut self, levels: usize) -> bool {
        let known = !self.lambdas.is_empty();
        while self.lambdas.len() < levels {
            let by = self.options.levels.finer_roughness;
            self.lambdas.push(self.lambdas.last().map_or(1.0, |last| last * by));
        }
        known
    }

    /// The two kinds of rows by their variances, from their squares and counts about the surface at hand.
    fn weigh(&mut self, totals: [f64; 4]) {
        if !self.passes.columns().layout.oriented || self.options.noise != RowVariances::Estimated {
            return;
        }
        let [heights, slopes] = components(totals, [0.0; 2]).map(|component| component.sd(1.0).unwrap_or(0.0));
        if heights > 0.0 && slopes > 0.0 {
            // beyond rounding of either kind the ratio means nothing
            self.weights = BlockWeights { heights: 1.0, slopes: (heights / slopes).powi(2).clamp(1e-16, 1e16) };
        }
    }

    /// How contacts count while cells are split.
    fn clip(&mut self) -> Result<(), HierarchyError> {
        self.share_by(match self.options.outliers {
            OutlierRule::Keep => ShareRule::All,
            OutlierRule::Reject { clip, .. } => ShareRule::Clip(clip),
        })
    }

    fn share_by(&mut self, rule: ShareRule) -> Result<(), HierarchyError> {
        let MeshRefinement { options, passes, field, work, .. } = self;
        let varies = options.noise_varies && options.noise == RowVariances::Estimated;
        timed(&mut work.passes, || passes.weigh(field, rule, varies))
    }

    /// The last fits: without the contacts that lie too far off, until these and the lambdas are the same twice.
    fn finish(&mut self, system: &mut System) -> Result<(), HierarchyError> {
        for k in 0..self.options.rounds.most_last_fits {
            let (before, without) = (self.lambdas.clone(), self.passes.left_out(&self.field)?);
            self.reject()?;
            let same = self.passes.left_out(&self.field)? == without;
            self.step(system, if k == 0 { LATER_SEARCH } else { 1 })?;
            let moved = self.lambdas.iter().zip(&before).map(|(a, b)| (a / b).ln().abs()).fold(0.0, f64::max);
            if same && moved < self.options.rounds.settled_lambda {
                break;
            }
        }
        if !self.halved {
            let by = self.options.levels.undersmoothing;
            self.lambdas.iter_mut().skip(1).for_each(|lambda| *lambda *= by);
        }
        self.step(system, 0)?;
        // rows of normals are linear about the surface before the step, and that one was of other lambdas
        if self.passes.columns().normals { self.step(system, 0) } else { Ok(()) }
    }

    /// Contacts that lie too far off count for nothing.
    fn reject(&mut self) -> Result<(), HierarchyError> {
        self.share_by(match self.options.outliers {
            OutlierRule::Keep => ShareRule::All,
            OutlierRule::Reject { reject, .. } => ShareRule::Reject(reject),
        })
    }

    /// Numbers of the leaves that hold more than noise.
    fn find_cells(&mut self) -> Result<Vec<usize>, HierarchyError> {
        let MeshRefinement { options, passes, field, suspected, work, .. } = self;
        let clip = match options.outliers {
            OutlierRule::Keep => f64::MAX,
            OutlierRule::Reject { clip, .. } => clip,
        };
        timed(&mut work.passes, || {
            let (least_contacts, deepest_level) = (options.least_contacts, options.deepest_level);
            let evidence =
                passes.evidence(field, SplitLimits { clip, least_contacts, deepest_level, rule: options.split })?;
            let space = field.space();
            let rates = [options.false_discovery_rate, options.significance_of_children];
            let significances: Vec<f64> = evidence.iter().map(|cell| cell.significance).collect();
            let unshaded = |leaf: usize| stands_out(space, &evidence, leaf, &options.split);
            let split = cells_to_split(space.leaves(), &significances, suspected, rates, unshaded);
            suspected.extend(split.iter().map(|leaf| space.leaves()[*leaf]));
            Ok(split)
        })
    }

    fn split(&mut self, space: &HierarchicalSpace, leaves: &[usize]) -> Result<(), HierarchyError> {
        let MeshRefinement { field, passes, work, .. } = self;
        *field = timed(&mut work.assembly, || {
            let mut mesh = space.mesh().clone();
            leaves.iter().try_for_each(|leaf| mesh.refine(space.leaves()[*leaf]))?;
            field.embedded(Arc::new(HierarchicalSpace::new(mesh)))
        })?;
        timed(&mut work.passes, || passes.about(field))
    }
}

/// Heights and slopes from their squares and counts; `traces` are the degrees of freedom that the surface took of each.
pub(super) fn components([z, rows, s, sites]: [f64; 4], traces: [f64; 2]) -> [VarianceComponent; 2] {
    let of = |squares, rows, trace| VarianceComponent { squares, rows, trace };
    [of(z, rows, traces[0]), of(s, 2.0 * sites, traces[1])]
}
