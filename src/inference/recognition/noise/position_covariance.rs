//! How large the errors of the contacts' places are, along the input's z and across it.
//!
//! ```text
//! E (d_i - d_j)^2 / 2 = s_z^2 (n_z^2 + r (1 - n_z^2))        i, j with the nearest feet;  s_xy^2 = r s_z^2
//! P(r | d) ~ p(r) L(d | r)^(1/2)          p(0) = p(1) = p(r < 1) / `Tuning::other_ratio` = r^2 p(r > 1) / `Tuning::other_ratio`
//! ```
//!
//! On level ground errors in x and y do not show, on slopes they do. Where nothing tells them, errors along z alone, as simulations
//! have them, and errors that are alike in all directions, as those of arms and scanners are, are equally likely. Differences
//! between neighbours leave out how the shape departs from the robust surface. Each contact is in two pairs on average, hence the
//! root. On a patch that stands upright the distances are errors across z, and ratios below 1 are not asked for.

use crate::bodies::Tuning;
use crate::recognition::start::Patch;
use palpate_numeric::statistics::mad;

/// Ratios of the variances.
const RATIOS: [f64; 8] = [0.0, 1.0 / 16.0, 0.25, 1.0, 4.0, 16.0, 64.0, 256.0];

/// Variances of one contact's place, in units of the patch's size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaceErrors {
    /// Along the input's z.
    pub(super) along_z: f64,
    /// Along each of the input's x and y.
    pub(crate) across: f64,
    /// Standard deviation of the variance across: how well it is known.
    pub(super) doubt: f64,
    /// Whether those across are known, or the contacts show that they are larger, so that contacts on slopes weigh less.
    pub(super) weigh: bool,
    /// Whether it is the contacts that show it.
    pub(crate) shown: bool,
}

impl PlaceErrors {
    /// Of the contacts of a patch, some of them with the one whose foot is nearest; `declared` is the known sd in x and in y, input units, and 0 where
    /// it is not known.
    pub(crate) fn of(patch: &Patch, nearest: &[[usize; 2]], declared: f64, tuning: &Tuning) -> PlaceErrors {
        let pairs = pairs(patch, nearest, tuning.place_blunder);
        let whole = pairs.iter().map(|(q, _)| q).sum::<f64>() / pairs.len().max(1) as f64;
        if declared > 0.0 {
            let across = (declared / patch.frame.scale).powi(2);
            let slope = pairs.iter().map(|(_, slope)| slope).sum::<f64>() / pairs.len().max(1) as f64;
            let along_z = (whole - across * slope).max(0.0);
            return PlaceErrors { along_z, across, doubt: 0.0, weigh: true, shown: false };
        }
        let scale = mad(patch.distances.iter().copied());
        if pairs.len() < tuning.place_pairs || whole.sqrt() < tuning.single_errors * scale {
            // between none along the surface and as large ones as across it, alike in all directions however the patch lies
            let half = 0.5 * whole;
            return PlaceErrors { along_z: half, across: half, doubt: half, weigh: false, shown: false };
        }
        by_evidence(&pairs, tuning)
    }
}

/// Half the squared differences of distances between contacts with the nearest feet, and `1 - n_z^2` there; without differences beyond
/// this multiple of their scale.
fn pairs(patch: &Patch, nearest: &[[usize; 2]], blunder: f64) -> Vec<(f64, f64)> {
    let found: Vec<(f64, usize)> = nearest.iter().map(|&[i, j]| (patch.distances[i] - patch.distances[j], i)).collect();
    let scale = mad(found.iter().map(|(d, _)| *d));
    let sound = found.into_iter().filter(|(d, _)| d.abs() <= blunder * scale);
    sound.map(|(d, i)| (0.5 * d * d, (1.0 - patch.upright(patch.feet[i]).powi(2)).max(0.0))).collect()
}

/// Means of both variances over the ratios.
fn by_evidence(pairs: &[(f64, f64)], tuning: &Tuning) -> PlaceErrors {
    let n = pairs.len() as f64;
    let of = |ratio: f64| {
        let relative = |slope: f64| 1.0 - slope + ratio * slope;
        let kept = || pairs.iter().map(|(q, slope)| (q, relative(*slope).max(tuning.least_variance)));
        let variance = kept().map(|(q, v)| q / v).sum::<f64>() / n;
        let log = -0.5 * (kept().map(|(_, v)| v.ln()).sum::<f64>() + n * variance.max(1e-30).ln());
        let prior = if ratio == 0.0 || ratio == 1.0 { 1.0 } else { tuning.other_ratio * ratio.max(1.0).powi(-2) };
        (0.5 * log + f64::ln(prior), variance)
    };
    let level = pairs.iter().map(|(_, slope)| 1.0 - slope).sum::<f64>() / n;
    let asked = |ratio: f64| ratio >= 1.0 || level >= tuning.stands_upright;
    let found = RATIOS.map(|ratio| if asked(ratio) { of(ratio) } else { (f64::NEG_INFINITY, 0.0) });
    let largest = found.iter().map(|(log, _)| *log).fold(f64::NEG_INFINITY, f64::max);
    let weights = found.map(|(log, _)| (log - largest).exp());
    let sum: f64 = weights.iter().sum();
    let mean = |of: &dyn Fn(usize) -> f64| (0..RATIOS.len()).map(|k| weights[k] * of(k)).sum::<f64>() / sum;
    let across = mean(&|k| RATIOS[k] * found[k].1);
    let shown = mean(&|k| f64::from(u8::from(RATIOS[k] > 1.0))) > tuning.certain;
    PlaceErrors {
        along_z: mean(&|k| found[k].1),
        across,
        doubt: mean(&|k| (RATIOS[k] * found[k].1 - across).powi(2)).sqrt(),
        weigh: shown,
        shown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Differences with the variances of a law, on slopes from level to 30 degrees.
    #[test]
    fn the_ratio_is_found_on_slopes_and_taken_for_one_on_level_ground() {
        let pairs = |along_z: f64, across: f64, steep: f64| -> Vec<(f64, f64)> {
            (0..600)
                .map(|k| {
                    let slope = steep * (k % 60) as f64 / 59.0;
                    // quantiles of a half-normal law in place of draws
                    let e = 2.0_f64.sqrt() * statrs::function::erf::erf_inv((k / 60) as f64 / 10.0 + 0.05);
                    ((along_z * (1.0 - slope) + across * slope) * e * e, slope)
                })
                .collect()
        };
        let told = |pairs: Vec<(f64, f64)>| by_evidence(&pairs, &Tuning::default());
        let found = told(pairs(1.0, 16.0, 0.25));
        assert!(found.weigh && (12.0..20.0).contains(&found.across), "{found:?}");
        let found = told(pairs(1.0, 1.0, 0.25));
        assert!(!found.weigh && (0.5..1.5).contains(&found.across), "{found:?}");
        let found = told(pairs(1.0, 0.0, 0.25));
        assert!(!found.weigh && found.across < 0.5, "{found:?}");
        let found = told(pairs(1.0, 0.0, 0.0));
        assert!(!found.weigh && (0.3..1.0).contains(&found.across) && found.doubt > 0.4, "{found:?}");
    }
}
