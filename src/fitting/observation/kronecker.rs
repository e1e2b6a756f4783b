//! The normal matrix of a complete grid with one weight per block, from Grams of its two Kronecker factors:
//!
//! ```text
//! A = wz^2 (N'N) (x) (M'M) + wx^2 (D'D) (x) (M'M) + wy^2 (N'N) (x) (F'F),   D, F the slopes of N, M
//! ```

use super::GridSites;
use palpate_numeric::linalg::{Sites, StencilMatrix};

/// Block weights `[wz, wx, wy]` (multiplying residuals) that hold at every pixel.
pub(super) type SeparableWeights = [f64; 3];

/// `E'E` without visiting a pixel: work grows with the axes, not with their product.
pub fn kronecker_normal_matrix(sites: &GridSites, weights: SeparableWeights) -> StencilMatrix {
    let [x, y] = sites.axes();
    let [gram_x, gram_dx] = [x.gram(0, None), x.gram(1, None)];
    let [gram_y, gram_dy] = [y.gram(0, None), y.gram(1, None)];
    let [z, zx, zy] = weights.map(|w| w * w);
    let mut matrix = StencilMatrix::zeros(sites.shape());
    for (weight, gx, gy) in [(z, &gram_x, &gram_y), (zx, &gram_dx, &gram_y), (zy, &gram_x, &gram_dy)] {
        if weight != 0.0 {
            matrix.add_kronecker(weight, gx, gy);
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::bspline::{Knots, linspace};
    use palpate_numeric::linalg::{RowWeights, SiteWeights, assemble};

    #[test]
    fn grams_and_pixels_give_the_same_matrix() {
        let knots = [Knots::uniform(3, 4, 0.0, 1.0).unwrap(), Knots::uniform(2, 3, -1.0, 1.0).unwrap()];
        let sites = GridSites::new(knots, &linspace(0.0, 1.0, 21), &linspace(-1.0, 1.0, 13));
        let weights = [1.5, 0.5, 2.0];
        let fast = kronecker_normal_matrix(&sites, weights);
        let mut slow = StencilMatrix::zeros(sites.shape());
        let row_weights = SiteWeights { z: weights[0], a: weights[1], b: 0.0, d: weights[2] };
        assemble(&sites, &RowWeights::Uniform(row_weights), &mut slow);
        let largest = slow.values().iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (a, b) in fast.values().iter().zip(slow.values()) {
            assert!((a - b).abs() < 1e-13 * largest);
        }
    }
}
