//! What decides which cells are split, how strongly each level is smoothed, and when rounds end: the numbers behind an adaptive fit.
//!
//! Each says where it comes from. A user who knows more of a surface than its contacts say may change some; the defaults are those that the
//! figures of `benches/runs/hierarchical.md` were made with.

use crate::error::HierarchyError;

/// How residuals of a cell are tested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitRule {
    /// Boxes along a side of the finest grid within a cell, a power of two. Default 32: smaller things than a 32nd of a cell are found when
    /// what is around them has been split.
    pub most_boxes: usize,
    /// Contacts for each box of a grid, on average. Default 5: with fewer one box says little, and Fisher's law wants gaussian noise.
    pub contacts_of_box: usize,
    /// Cells that the swings of a surface about a feature reach. Default 3: a cubic spline's fall to a hundredth within three cells.
    pub reach_of_swings: u32,
    /// Share of the strongest neighbour's excess below which a cell waits. Default 0.1: the first swing of a cubic spline has a tenth of the
    /// feature's squares. 0: no cell waits, which splits what the next round would find to be smooth.
    pub shade: f64,
}

/// How lambda goes from level to level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelRule {
    /// Vectors of random signs behind the traces of a level (M. Hutchinson, *Commun. Stat. Simul.* 19 (1990) 433). Default 8: of a level with r
    /// functions lambda is off by the share `1/sqrt(4 r)`.
    pub probes: usize,
    /// A level's lambda over that of the level before, before anything is known. Default 1/16: features of half the size are as high.
    pub finer_roughness: f64,
    /// The last fit takes the lambdas of split cells times this. Default 0.3: the likelihood balances bias against variance over all cells of a
    /// level, and intervals want the peaks' bias below their noise (P. Hall, *Ann. Stat.* 20 (1992) 675). It costs 5 % of the uncertainty there.
    pub undersmoothing: f64,
    /// A level's lambda moves at most by this factor in a step. Default 100: far from the answer the steps are too long.
    pub longest_step: f64,
    /// Of a level's functions the roughness decides at least this share by itself. Default 0.01: below, the traces are noise.
    pub least_left: f64,
    /// The largest lambda over the one at which roughness and contacts weigh alike. Default 1e6: the surface has no roughness at all there.
    pub stiffest: f64,
}

/// When fits are repeated, and when they are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundRule {
    /// Rounds beyond the deepest level. Default 6: neighbours of a feature follow it late.
    pub late_rounds: usize,
    /// First fits after the very first, which outliers may have drawn far off. Default 8: each halves what is left.
    pub most_first_fits: usize,
    /// Change of the variance that ends the first fits. Default 0.02, a tenth of what outliers of 5 % move it by.
    pub settled_variance: f64,
    /// Last fits. Default 5: rejections settle in two or three, the lambdas of levels in about as many.
    pub most_last_fits: usize,
    /// Change of a lambda's logarithm that moves nothing beyond the noise. Default 0.2.
    pub settled_lambda: f64,
}

/// Where an adaptive surface is taken in the place of a smooth one without being asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetailRule {
    /// Fewer contacts show no features beside a surface. Default 2,000: a base grid of 64 cells with 32 contacts each.
    pub fewest_contacts: usize,
    /// Share of the patch that small cells cover at most. Default a half: errors that are alike among neighbours are everywhere, features are not.
    pub most_covered: f64,
    /// Least cosine between the surface's normal in the middle and z. Default 0.7: a height field over x and y that leans by 45 degrees at most.
    pub level: f64,
}

impl Default for SplitRule {
    fn default() -> SplitRule {
        SplitRule { most_boxes: 32, contacts_of_box: 5, reach_of_swings: 3, shade: 0.1 }
    }
}

impl Default for LevelRule {
    fn default() -> LevelRule {
        LevelRule {
            probes: 8,
            finer_roughness: 1.0 / 16.0,
            undersmoothing: 0.3,
            longest_step: 100.0,
            least_left: 0.01,
            stiffest: 1e6,
        }
    }
}

impl Default for RoundRule {
    fn default() -> RoundRule {
        RoundRule { late_rounds: 6, most_first_fits: 8, settled_variance: 0.02, most_last_fits: 5, settled_lambda: 0.2 }
    }
}

impl Default for DetailRule {
    fn default() -> DetailRule {
        DetailRule { fewest_contacts: 2_000, most_covered: 0.5, level: 0.7 }
    }
}

fn wrong(option: &'static str, value: impl ToString, expected: &'static str) -> Result<(), HierarchyError> {
    Err(HierarchyError::Option { option, value: value.to_string(), expected })
}

impl SplitRule {
    pub(super) fn check(&self) -> Result<(), HierarchyError> {
        if !self.most_boxes.is_power_of_two() || !(2..=256).contains(&self.most_boxes) {
            return wrong("most_boxes", self.most_boxes, "a power of two from 2 to 256");
        }
        if self.contacts_of_box == 0 {
            return wrong("contacts_of_box", 0, "at least 1");
        }
        if self.reach_of_swings > 16 {
            return wrong("reach_of_swings", self.reach_of_swings, "at most 16");
        }
        if !(0.0..=1.0).contains(&self.shade) {
            return wrong("shade", self.shade, "0 to 1");
        }
        Ok(())
    }
}

impl LevelRule {
    pub(super) fn check(&self) -> Result<(), HierarchyError> {
        if !(1..=1000).contains(&self.probes) {
            return wrong("probes", self.probes, "1 to 1000");
        }
        let positive = [
            ("finer_roughness", self.finer_roughness),
            ("undersmoothing", self.undersmoothing),
            ("stiffest", self.stiffest),
        ];
        if let Some((name, value)) = positive.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
            return wrong(name, value, "a positive number");
        }
        if !(self.longest_step > 1.0 && self.longest_step.is_finite()) {
            return wrong("longest_step", self.longest_step, "more than 1");
        }
        if !(self.least_left > 0.0 && self.least_left < 1.0) {
            return wrong("least_left", self.least_left, "between 0 and 1");
        }
        Ok(())
    }
}

impl RoundRule {
    pub(super) fn check(&self) -> Result<(), HierarchyError> {
        if self.most_last_fits == 0 {
            return wrong("most_last_fits", 0, "at least 1");
        }
        let changes = [("settled_variance", self.settled_variance), ("settled_lambda", self.settled_lambda)];
        match changes.into_iter().find(|(_, value)| value.is_nan() || *value < 0.0) {
            Some((name, value)) => wrong(name, value, "0 or more"),
            None => Ok(()),
        }
    }
}
