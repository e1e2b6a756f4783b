//! What the unknowns of a primitive leave open of numbers that follow from it.
//!
//! ```text
//! u^2 = g' V g        g: derivatives by the unknowns, as central differences over a tenth of each unknown's own u
//! ```

use crate::primitives::placed::{MOST_UNKNOWNS, Primitive};
use palpate_numeric::linalg::small::Square;

/// Share of an unknown's own uncertainty over which differences are taken.
const STEP_IN_U: f64 = 0.1;

/// Standard uncertainties of some numbers of a primitive whose unknowns have this covariance.
pub(super) fn standard_uncertainties<const M: usize>(
    primitive: &Primitive,
    covariance: &Square<MOST_UNKNOWNS>,
    of: impl Fn(&Primitive) -> [f64; M],
) -> [f64; M] {
    let free = primitive.kind.free();
    let mut gradients = [[0.0; MOST_UNKNOWNS]; M];
    for &k in free {
        let step = STEP_IN_U * covariance[k][k].max(0.0).sqrt().max(f64::MIN_POSITIVE);
        let at = |sign: f64| {
            let mut moved = [0.0; MOST_UNKNOWNS];
            moved[k] = sign * step;
            of(&primitive.moved(&moved))
        };
        let (plus, minus) = (at(1.0), at(-1.0));
        (0..M).for_each(|n| gradients[n][k] = (plus[n] - minus[n]) / (2.0 * step));
    }
    gradients.map(|g| {
        let square = free.iter().flat_map(|&i| free.iter().map(move |&j| g[i] * covariance[i][j] * g[j])).sum::<f64>();
        square.max(0.0).sqrt()
    })
}
