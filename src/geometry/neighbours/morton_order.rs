//! Points in an order in which those next to each other mostly are so in space.
//!
//! ```text
//! cell_k = floor(2^20 (p_k - least_k) / width)      width: the largest of the cloud's three
//! key    = the bits of the three numbers in turn    points by key, and within a cell by their coordinates
//! ```
//!
//! What looks at points and their neighbours in this order reads what it has just read, and points that are the same in another order
//! come out in one. G. M. Morton, *A computer oriented geodetic data base*, IBM 1966.

use palpate_numeric::vector::{Vector, minus};

/// Bits of a cell's number along each axis: three of them fill a word.
const BITS: u32 = 20;

/// Numbers of the points along the curve. Points that are one keep their order.
pub fn morton_order(points: &[Vector]) -> Vec<u32> {
    let (mut least, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in points {
        (0..3).for_each(|k| (least[k], most[k]) = (least[k].min(p[k]), most[k].max(p[k])));
    }
    let width = minus(most, least).into_iter().fold(f64::MIN_POSITIVE, f64::max);
    let cells = f64::from(1 << BITS);
    let key = |p: &Vector| {
        let cell = minus(*p, least).map(|off| (off / width * cells).min(cells - 1.0) as u64);
        (0..BITS).fold(0, |key, bit| (0..3).fold(key, |key, k| key | ((cell[k] >> bit) & 1) << (3 * bit + k as u32)))
    };
    let mut order: Vec<(u64, u32)> = points.iter().map(key).zip(0..).collect();
    let by_place = |a: u32, b: u32| {
        let (a, b) = (points[a as usize], points[b as usize]);
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
    };
    order.sort_unstable_by(|a, b| a.0.cmp(&b.0).then_with(|| by_place(a.1, b.1)).then(a.1.cmp(&b.1)));
    order.into_iter().map(|(_, number)| number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every corner of a cube before those of the next, whatever order and unit the points come in.
    #[test]
    fn points_of_a_cell_follow_each_other_in_any_order_and_unit() {
        let points: Vec<Vector> = (0..64).map(|i| [i % 4, i / 4 % 4, i / 16].map(f64::from)).collect();
        let along: Vec<Vector> = morton_order(&points).iter().map(|i| points[*i as usize]).collect();
        for eight in along.chunks(8) {
            let corner = eight[0].map(|v| (v / 2.0).floor());
            assert!(eight.iter().all(|p| p.map(|v| (v / 2.0).floor()) == corner), "{eight:?}");
        }
        let shuffled: Vec<Vector> = (0..64).map(|i| points[(i * 29 + 5) % 64].map(|v| 1e-9 * v - 3.0)).collect();
        let again = morton_order(&shuffled);
        let places: Vec<Vector> = again.iter().map(|i| points[(*i as usize * 29 + 5) % 64]).collect();
        assert_eq!(places, along);
        assert_eq!(morton_order(&[[1.0; 3]; 4]), [0, 1, 2, 3]);
        assert!(morton_order(&[]).is_empty());
    }
}
