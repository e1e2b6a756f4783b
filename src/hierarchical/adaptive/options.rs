//! What a user may choose about an adaptive fit; every default says where it comes from.

use super::rules::{LevelRule, RoundRule, SplitRule};
use crate::error::HierarchyError;
use crate::mesh::MAX_LEVEL;
use palpate_fitting::observation::RoughnessOrder;

/// What happens to contacts that lie far off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutlierRule {
    /// All count alike.
    Keep,
    /// While cells are split, residuals beyond `clip` local scales count as if they stood there; the last fits leave out those
    /// beyond `reject`.
    Reject {
        /// Default 3: of gaussian noise 0.3 % are clipped, which costs 0.1 % of the efficiency.
        clip: f64,
        /// Default 4.5: of a million gaussian contacts seven are left out.
        reject: f64,
    },
}

/// How slope or normal rows are weighed against height rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RowVariances {
    /// Both variances are estimated with the fit.
    Estimated,
    /// Standard deviations of heights (input units) and of slopes, or of normals in radians for each tangent axis.
    Known {
        /// Of heights.
        heights: f64,
        /// Of slopes or normals.
        slopes: f64,
    },
}

/// Options of an adaptive fit.
#[derive(Clone, Debug, PartialEq)]
pub struct AdaptiveOptions {
    /// Degree in x and y, 2 to 5. Default 3: curvature is continuous.
    pub degree: usize,
    /// `[[x0, x1], [y0, y1]]`, input units. Default: the contacts' bounding box.
    pub domain: Option<[[f64; 2]; 2]>,
    /// Segments of the base grid along the larger side; the other side gets as many as keep cells square. Default 8: a cell of the
    /// base grid is what a split can undo no more, and 64 cells cost nothing.
    pub base_segments: usize,
    /// Share of the cells split in a round that may be split by chance (Y. Benjamini, Y. Hochberg, *J. R. Stat. Soc. B* 57 (1995) 289).
    /// Default 0.01.
    pub false_discovery_rate: f64,
    /// Significance at which the children of cells that were split by that rule are split. Default 0.05: a child that needs no split
    /// costs one unknown, one that is left though it needs it takes the surface off by several standard uncertainties.
    pub significance_of_children: f64,
    /// Cells with fewer contacts are not split. Default 16: four contacts for the unknown that a child brings.
    pub least_contacts: usize,
    /// Deepest level. Default 12: cells 4,096 times smaller than those of the base grid.
    pub deepest_level: usize,
    /// No cell is split any more beyond so many unknowns. Default 2,000,000: about 10 GB of factor.
    pub most_unknowns: usize,
    /// Numbers in the factor of the equations at most. Where there would be more, conjugate gradients solve them, to the same digits; the
    /// condition is then not told, standard uncertainties at points come by [`AdaptiveOptions::posterior_draws`]. Default 500,000,000: 4 GB.
    pub most_factor_entries: usize,
    /// Random draws of the surface given the contacts that standard uncertainties at points take where conjugate gradients solve; 0: they
    /// are not told. Each draw is one solution. Default 64: what comes from beyond a block is off by 18 %, and it is little of the whole.
    pub posterior_draws: usize,
    /// Which derivatives' squares are the roughness. Default second ones, the thin plate.
    pub roughness: RoughnessOrder,
    /// What happens to outliers.
    pub outliers: OutlierRule,
    /// How the rows are weighed.
    pub noise: RowVariances,
    /// Whether noise that is estimated may differ from place to place: contacts then count by the residuals of the 2,000 nearest in the
    /// order of the cells. Default yes: it costs 1 % of the efficiency where the noise is even, and intervals hold where it is not.
    pub noise_varies: bool,
    /// Whether the cells of what was followed are halved once more when only noise is left: at four times the unknowns there, intervals of R
    /// near features of three to ten standard deviations hold 98 to 99.7 % of the time instead of 93.6 to 93.7 %. Default no.
    pub last_halving: bool,
    /// How residuals of a cell are tested.
    pub split: SplitRule,
    /// How lambda goes from level to level.
    pub levels: LevelRule,
    /// When fits are repeated.
    pub rounds: RoundRule,
    /// Whether the entries of the inverse are computed, which standard uncertainties ask for. Default yes.
    pub uncertainty: bool,
}

impl Default for AdaptiveOptions {
    fn default() -> AdaptiveOptions {
        AdaptiveOptions {
            degree: 3,
            domain: None,
            base_segments: 8,
            false_discovery_rate: 0.01,
            significance_of_children: 0.05,
            least_contacts: 16,
            deepest_level: 12,
            most_unknowns: 2_000_000,
            most_factor_entries: 500_000_000,
            posterior_draws: 64,
            roughness: RoughnessOrder::Second,
            outliers: OutlierRule::Reject { clip: 3.0, reject: 4.5 },
            noise: RowVariances::Estimated,
            noise_varies: true,
            last_halving: false,
            split: SplitRule::default(),
            levels: LevelRule::default(),
            rounds: RoundRule::default(),
            uncertainty: true,
        }
    }
}

impl AdaptiveOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`HierarchyError::Option`] with what would be right.
    pub fn check(&self) -> Result<(), HierarchyError> {
        let wrong = |option, value: String, expected| Err(HierarchyError::Option { option, value, expected });
        if !(2..=5).contains(&self.degree) {
            return wrong("degree", self.degree.to_string(), "2 to 5");
        }
        if !(1..=1024).contains(&self.base_segments) {
            return wrong("base_segments", self.base_segments.to_string(), "1 to 1024");
        }
        let rates = [
            ("false_discovery_rate", self.false_discovery_rate),
            ("significance_of_children", self.significance_of_children),
        ];
        if let Some((name, rate)) = rates.into_iter().find(|(_, rate)| !(*rate > 0.0 && *rate < 1.0)) {
            return wrong(name, rate.to_string(), "between 0 and 1");
        }
        if self.deepest_level > MAX_LEVEL {
            return wrong("deepest_level", self.deepest_level.to_string(), "at most 20");
        }
        if self.roughness == RoughnessOrder::Third && self.degree < 3 {
            return wrong("roughness", "Third".into(), "Second below degree 3, where a spline has no third derivative");
        }
        if let OutlierRule::Reject { clip, reject } = self.outliers
            && !(clip > 0.0 && reject >= clip && reject.is_finite())
        {
            return wrong("outliers", format!("{clip}, {reject}"), "positive scales, rejection not below clipping");
        }
        if let RowVariances::Known { heights, slopes } = self.noise
            && !(heights > 0.0 && slopes > 0.0 && heights.is_finite() && slopes.is_finite())
        {
            return wrong("noise", format!("{heights}, {slopes}"), "positive standard deviations");
        }
        self.split.check()?;
        self.levels.check()?;
        self.rounds.check()?;
        self.check_domain()
    }

    fn check_domain(&self) -> Result<(), HierarchyError> {
        let Some([x, y]) = self.domain else { return Ok(()) };
        let sound = |[lo, hi]: [f64; 2]| lo < hi && (hi - lo).is_finite();
        if sound(x) && sound(y) {
            return Ok(());
        }
        Err(HierarchyError::Flat { x0: x[0], x1: x[1], y0: y[0], y1: y[1] })
    }
}
