//! What contacts scatter by about their parts.
//!
//! ```text
//! sd = 1.48 median |d|, of all contacts and of those of each part         price = 2 ln(sd / sd of all) + 4 ln(the same of normals)
//! ```

use std::f64::consts::SQRT_2;

use super::local::Noise;
use crate::bodies::Tuning;
use palpate_numeric::statistics::mad;

/// Whether contacts next to each other lie off a surface together: what they are off by differs less between neighbours than it scatters.
pub(super) fn lie_off_together(
    off: impl Iterator<Item = f64>,
    between: impl Iterator<Item = f64>,
    tuning: &Tuning,
) -> bool {
    mad(between) / SQRT_2 < tuning.sharper * mad(off)
}

/// What the contacts of a partition scatter by.
pub(super) struct PartsScatter {
    /// About all parts together.
    pub(super) common: Noise,
    /// About each part, at least the common one: a part that is not fitted to its last digit yet, or departs, keeps its contacts. Empty: the
    /// common one.
    pub(super) own: Vec<Noise>,
    /// What places are off by along the surface, where that turns their normals.
    pub(super) along: f64,
    /// Most that a contact costs because its part scatters more than others.
    pub(super) most_price: f64,
}

impl PartsScatter {
    pub(super) fn common(common: Noise, along: f64) -> PartsScatter {
        PartsScatter { common, own: Vec::new(), along, most_price: 0.0 }
    }

    /// The same where normals tell nothing.
    pub(super) fn of_distances(self) -> PartsScatter {
        let blind = |noise: Noise| Noise { normal: f64::INFINITY, ..noise };
        PartsScatter { common: blind(self.common), own: self.own.into_iter().map(blind).collect(), ..self }
    }

    pub(super) fn of(&self, part: usize) -> &Noise {
        self.own.get(part).unwrap_or(&self.common)
    }

    /// What a contact costs in any part that scatters more than the others, beside its squares: the normalisation of gaussians.
    pub(super) fn price(&self, part: usize) -> f64 {
        let own = self.of(part);
        let of_normals = if own.normal.is_finite() { (own.normal / self.common.normal).ln() } else { 0.0 };
        (2.0 * (own.distance / self.common.distance).ln() + 4.0 * of_normals).min(self.most_price)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_that_scatters_more_costs_more_and_never_more_than_no_part() {
        let common = Noise { distance: 0.01, normal: 0.05 };
        let wider = |by: f64| Noise { distance: by * common.distance, normal: by * common.normal };
        let own = vec![common, wider(1.5), wider(1e3)];
        let scatter = PartsScatter { common, own, along: 0.0, most_price: 8.0 };
        assert_eq!(scatter.price(0), 0.0);
        assert!((scatter.price(1) - 6.0 * 1.5_f64.ln()).abs() < 1e-12);
        assert_eq!(scatter.price(2), 8.0);
        // without normals they cost nothing
        assert!((scatter.of_distances().price(1) - 2.0 * 1.5_f64.ln()).abs() < 1e-12);
    }
}
