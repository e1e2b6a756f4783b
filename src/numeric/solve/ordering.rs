//! Nested dissection of the n x m array of coefficients: halve the longer side by a separator p (or q) lines wide.
//!
//! A. George, *Nested dissection of a regular finite element mesh*, SIAM J. Numer. Anal. 10 (1973).

use crate::linalg::TensorShape;

/// Boxes with up to this many unknowns are not divided further: a supernode of that size costs less than its separators.
const LEAF: usize = 96;

/// Elimination order: entry k is the unknown eliminated k-th.
pub(super) fn nested_dissection(shape: TensorShape) -> Vec<usize> {
    let mut order = Vec::with_capacity(shape.unknowns());
    dissect(&shape, [0, shape.basis[0]], [0, shape.basis[1]], &mut order);
    order
}

fn dissect(shape: &TensorShape, x: [usize; 2], y: [usize; 2], order: &mut Vec<usize>) {
    let (wide, high) = (x[1] - x[0], y[1] - y[0]);
    let [p, q] = shape.degree;
    // the cheaper separator: p columns of `high`, or q rows of `wide`
    let cut_x = p * high <= q * wide;
    let (length, separator) = if cut_x { (wide, p) } else { (high, q) };
    if wide * high <= LEAF || length < 3 * separator {
        let m = shape.basis[1];
        order.extend((x[0]..x[1]).flat_map(|i| (y[0]..y[1]).map(move |j| i * m + j)));
        return;
    }
    let before = (length - separator) / 2;
    let part = |range: [usize; 2]| {
        let (a, b) = (range[0] + before, range[0] + before + separator);
        [[range[0], a], [b, range[1]], [a, b]]
    };
    for piece in part(if cut_x { x } else { y }) {
        let is_separator = piece[1] - piece[0] == separator && piece[0] == (if cut_x { x } else { y })[0] + before;
        let (px, py) = if cut_x { (piece, y) } else { (x, piece) };
        if is_separator {
            let m = shape.basis[1];
            order.extend((px[0]..px[1]).flat_map(|i| (py[0]..py[1]).map(move |j| i * m + j)));
        } else {
            dissect(shape, px, py, order);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unknown_appears_once() {
        for basis in [[3, 3], [67, 67], [5, 90], [131, 20]] {
            let shape = TensorShape { basis, degree: [3, 2] };
            let mut order = nested_dissection(shape);
            order.sort_unstable();
            assert_eq!(order, (0..shape.unknowns()).collect::<Vec<_>>());
        }
    }
}
