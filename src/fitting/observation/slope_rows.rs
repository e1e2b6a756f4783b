//! Slope rows: `wz (z - S)`, `wx (zx - S_x)`, `wy (zy - S_y)` with `(zx, zy) = (-nx/nz, -ny/nz)` (paper Eq. 13, 14).

use ndarray::Array2;

use palpate_geometry::contact::{Contacts, Grid, Orientation};
use palpate_numeric::linalg::{RowWeights, SiteWeights, Targets};

use super::Data;

impl Data {
    /// Slope rows with weights `[wz, wx, wy]` in patch units.
    pub(crate) fn slope_rows(&self, block: [f64; 3]) -> (RowWeights, Targets) {
        match self {
            Data::Scattered { contacts, .. } => slope_rows(contacts, block),
            Data::Gridded { grid, origin, scale } => grid_slope_rows(grid, block, *origin, *scale),
        }
    }
}

/// Weights and targets of scattered contacts that are already in the patch frame; `block` is `[wz, wx, wy]` there.
///
/// Contacts without slopes have height rows only. A normal with nz = 0 has no slope; the caller must refuse it before.
pub(super) fn slope_rows(contacts: &Contacts, block: [f64; 3]) -> (RowWeights, Targets) {
    let weights = &contacts.weights;
    let has_slopes = contacts.orientation != Orientation::None;
    let block = if has_slopes { block } else { [block[0], 0.0, 0.0] };
    let row = |column: &Option<Vec<f64>>, r: usize| column.as_ref().map_or(1.0, |w| w[r]);
    let weights_of = |r: usize| SiteWeights {
        z: block[0] * row(&weights.z, r),
        a: block[1] * row(&weights.x, r),
        b: 0.0,
        d: block[2] * row(&weights.y, r),
    };
    let row_weights = if weights.z.is_none() && weights.x.is_none() && weights.y.is_none() {
        RowWeights::Uniform(weights_of(0))
    } else {
        RowWeights::PerSite((0..contacts.len()).map(weights_of).collect())
    };
    let targets = (0..contacts.len())
        .map(|r| {
            let w = row_weights.at(r);
            let [zx, zy] = match &contacts.orientation {
                Orientation::None => [0.0, 0.0],
                Orientation::Normals { nx, ny, nz } => [-nx[r] / nz[r], -ny[r] / nz[r]],
                Orientation::Slopes { zx, zy } => [zx[r], zy[r]],
            };
            // a number with weight zero is ignored, even if it is not finite
            let weighted = |w: f64, v: f64| if w == 0.0 { 0.0 } else { w * v };
            [weighted(w.z, contacts.z[r]), weighted(w.a, zx), weighted(w.d, zy)]
        })
        .collect();
    (row_weights, targets)
}

/// The same for a grid. `origin` and `scale` bring its heights into the patch frame; NaN gets weight zero.
pub(super) fn grid_slope_rows(grid: &Grid, block: [f64; 3], origin: f64, scale: f64) -> (RowWeights, Targets) {
    if let Some(uniform) = uniform_weights(grid, block) {
        return (RowWeights::Uniform(uniform), uniform_targets(grid, &uniform, origin, scale));
    }
    let at = |array: &Option<Array2<f64>>, i: usize, j: usize, otherwise: f64| {
        array.as_ref().map_or(otherwise, |a| a[[i, j]])
    };
    let mut site_weights = Vec::with_capacity(grid.len());
    let mut targets = Vec::with_capacity(grid.len());
    for i in 0..grid.x.len() {
        for j in 0..grid.y.len() {
            let values =
                [(grid.z[[i, j]] - origin) / scale, at(&grid.zx, i, j, f64::NAN), at(&grid.zy, i, j, f64::NAN)];
            let maps = [at(&grid.wz, i, j, 1.0), at(&grid.wx, i, j, 1.0), at(&grid.wy, i, j, 1.0)];
            let w = [0, 1, 2].map(|k| if values[k].is_nan() { 0.0 } else { block[k] * maps[k] });
            site_weights.push(SiteWeights { z: w[0], a: w[1], b: 0.0, d: w[2] });
            targets.push([0, 1, 2].map(|k| if w[k] == 0.0 { 0.0 } else { w[k] * values[k] }));
        }
    }
    let uniform = site_weights.first().copied().unwrap_or_default();
    let row_weights = if site_weights.iter().all(|w| *w == uniform) {
        RowWeights::Uniform(uniform)
    } else {
        RowWeights::PerSite(site_weights)
    };
    (row_weights, targets)
}

/// The weights of every pixel of a grid without weight maps and without missing numbers.
fn uniform_weights(grid: &Grid, block: [f64; 3]) -> Option<SiteWeights> {
    let is_whole = |array: &Array2<f64>| array.iter().all(|v| !v.is_nan());
    let has_maps = [&grid.wz, &grid.wx, &grid.wy].iter().any(|map| map.is_some());
    let slopes = [&grid.zx, &grid.zy];
    if has_maps || !is_whole(&grid.z) || !slopes.iter().all(|s| s.as_ref().is_none_or(is_whole)) {
        return None;
    }
    let [a, d] = [0, 1].map(|k| if slopes[k].is_some() { block[1 + k] } else { 0.0 });
    Some(SiteWeights { z: block[0], a, b: 0.0, d })
}

fn uniform_targets(grid: &Grid, w: &SiteWeights, origin: f64, scale: f64) -> Targets {
    let height = |z: &f64| if w.z == 0.0 { 0.0 } else { w.z * ((z - origin) / scale) };
    let mut targets: Targets = grid.z.iter().map(|z| [height(z), 0.0, 0.0]).collect();
    for (k, weight, slopes) in [(1, w.a, &grid.zx), (2, w.d, &grid.zy)] {
        if let (Some(slopes), true) = (slopes, weight != 0.0) {
            targets.iter_mut().zip(slopes).for_each(|(target, slope)| target[k] = weight * slope);
        }
    }
    targets
}
