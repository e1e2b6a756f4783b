//! Whether the patch is a plane: by a test against noise, or to rounding.
//!
//! ```text
//! rejected        the best plane's rise in the sum of squares, by chi-square with declared sds, else by F
//! flat            mean R * side < 100 u condition max |z - plane| / side + 4 u max |z| / side
//! ```

use crate::fit::Robust;
use crate::fit::describe::plane::{PlaneBlocks, PlaneFit, plane_rows};
use crate::fit::describe::robust_plane::score_probability;
use crate::fit::linear::equations::Equations;
use crate::fit::noise::sds::{MEDIAN_EFFICIENCY, NoiseSource};
use crate::fit::noise::variance_ratio_posterior::Way;
use crate::fit::solved::Solved;
use palpate_geometry::shape::{best_plane, chi_square_upper_tail, f_upper_tail};
use palpate_numeric::linalg::{RowWeights, SiteWeights, Sites, apply_rows};

/// Unit roundoff 2^-53.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// A p-value under preset weights that no other weights bring near a decision; such a test is not repeated over the noise
/// sds.
const DECIDED: f64 = 1e-40;

/// A p-value under a robust loss below which the plane is not asked itself.
const CERTAIN: f64 = 1e-9;

/// p-value of the best plane against the fit; `None` where the fit has no more freedom than a plane, or no noise estimate.
pub(super) fn plane_probability(solved: &Solved) -> Option<f64> {
    let fitted = &solved.fitted;
    let equations = &fitted.equations;
    let freedom = fitted.solution.rank as f64 - 3.0;
    let rest = equations.count() as f64 - fitted.solution.rank as f64;
    if freedom <= 0.0 || (fitted.noise.source() != NoiseSource::Sigma && rest <= 0.0) {
        return None;
    }
    let of_fit: f64 = equations.residual_squares(&fitted.solution.coefficients).iter().sum();
    let largest = solved.data.largest_height(&solved.patch) / solved.patch.frame.scale;
    let plane = plane_rows(equations, largest)?;
    if plane.is_rounding {
        return Some(1.0);
    }
    let rise = (plane.squares - of_fit).max(0.0);
    Some(match fitted.noise.source() {
        NoiseSource::Sigma => under_known_noise(solved, &plane, rise, freedom),
        NoiseSource::Weights(_) | NoiseSource::Estimated => {
            let efficiency = fitted.noise.efficiency();
            let robust = if solved.options.robust == Robust::None { 1.0 } else { MEDIAN_EFFICIENCY };
            let p = f_upper_tail((rise / freedom) / (of_fit / rest) * efficiency, freedom, rest * robust);
            if p < DECIDED && fitted.noise.is_preset() {
                p
            } else {
                let p = over_levels(solved, &plane, freedom, efficiency, robust).unwrap_or(p);
                // what contradicts a plane for certain needs no second opinion, which a surface of mostly flat ground misleads
                if p < CERTAIN {
                    p
                } else {
                    score_probability(solved, || places(equations)).map_or(p, |score| score.max(p))
                }
            }
        }
    })
}

/// By chi-square, also over what the touches of a finger may share.
fn under_known_noise(solved: &Solved, plane: &PlaneFit, rise: f64, freedom: f64) -> f64 {
    let apart = chi_square_upper_tail(rise, freedom);
    let Some(levels) = solved.levels() else { return apart };
    let of_shared = levels.mean(|way| match way.shared {
        Some(_) => Some(chi_square_upper_tail(rise_of(&solved.fitted.equations, plane, way)?, freedom)),
        None => Some(0.0),
    });
    of_shared.map_or(apart, |of_shared| (1.0 - levels.probability_shared()) * apart + of_shared)
}

/// The same p-value over all ratios of the noise sds that few contacts leave open, and over what the touches of a finger may
/// share. Weights are no statement about noise, so the test does not rest on them.
fn over_levels(solved: &Solved, plane: &PlaneFit, freedom: f64, efficiency: f64, robust: f64) -> Option<f64> {
    let levels = solved.levels()?;
    let mut last: Option<([f64; 2], PlaneBlocks)> = None;
    levels.mean(|way| {
        let correlations = way.shared.map_or([0.0; 2], |(_, correlations)| correlations);
        let blocks = match last.filter(|(of, _)| *of == correlations) {
            Some((_, blocks)) => blocks,
            None => PlaneBlocks::new(&solved.fitted.equations, plane, way.shared),
        };
        last = Some((correlations, blocks));
        let rise = (blocks.left(way.factors)? - way.rss).max(0.0);
        let ratio = (rise / freedom) / (way.rss / levels.freedom) * efficiency;
        Some(f_upper_tail(ratio, freedom, levels.freedom * robust))
    })
}

/// By how much the best plane's sum of squares is above that of the fit.
fn rise_of(equations: &Equations, plane: &PlaneFit, way: &Way) -> Option<f64> {
    let left = PlaneBlocks::new(equations, plane, way.shared).left(way.factors)?;
    Some((left - way.rss).max(0.0))
}

/// Whether a surface of this mean R (input units) is flat to rounding.
pub(super) fn is_flat(solved: &Solved, mean_curvedness: f64) -> bool {
    let (side, scale) = (solved.patch.side, solved.patch.frame.scale);
    let largest = solved.data.largest_height(&solved.patch);
    let rounding =
        |deviation: f64| 100.0 * UNIT * solved.condition() * deviation * scale / side + 4.0 * UNIT * largest / side;
    // no residual of the least squares plane is larger than the norm of all heights, which is cheaper
    if mean_curvedness * side >= rounding(solved.data.size_of_heights()) {
        return false;
    }
    let measured = solved.data.measured();
    let places = places(&solved.fitted.equations);
    let heights = places.iter().enumerate().filter(|(r, _)| measured.z_weight[*r] != 0.0);
    let (_, deviation) = best_plane(heights.map(|(r, p)| [p[0], p[1], measured.z[r]]));
    mean_curvedness * side < rounding(deviation)
}

/// x and y of every site, as splines whose coefficients are the Greville points.
fn places(equations: &Equations) -> Vec<[f64; 2]> {
    let sites = &equations.sites;
    let one = RowWeights::Uniform(SiteWeights { z: 1.0, ..SiteWeights::default() });
    let mut places = vec![[0.0; 2]; sites.len()];
    let knots = sites.knots();
    let (gx, gy) = (knots[0].greville(), knots[1].greville());
    for axis in 0..2 {
        let coordinate = |x: &f64, y: &f64| if axis == 0 { *x } else { *y };
        let coefficients: Vec<f64> = gx.iter().flat_map(|x| gy.iter().map(move |y| coordinate(x, y))).collect();
        let mut rows = Vec::new();
        apply_rows(sites, &one, &coefficients, &mut rows);
        rows.iter().enumerate().for_each(|(r, row)| places[r][axis] = row[0]);
    }
    places
}
