//! Knots of every level: each level halves all segments of the one before.
//!
//! ```text
//! V^0 in V^1 in V^2 in ...     N^l_k = sum_j a_jk N^(l+1)_j,   a_jk = N^l_k's polar form at t^(l+1)_(j+1), .., t^(l+1)_(j+p)
//! ```
//!
//! The row `a_j.` is what the recursion of the basis gives when every step takes its own knot for x (E. Cohen, T. Lyche,
//! R. Riesenfeld, *Comp. Graph. Image Proc.* 14 (1980) 87).

use crate::error::HierarchyError;
use palpate_numeric::bspline::{Knots, MAX_DEGREE, SplineError};

const AXES: [&str; 2] = ["x", "y"];
/// Second derivatives want degree 2.
const LEAST_DEGREE: usize = 2;
/// Beyond degree 5 the powers that the equations are summed in lose digits.
const MOST_DEGREE: usize = 5;
/// Segments of a base grid in one direction: places at the deepest level stay below 2^30.
const MOST_SEGMENTS: usize = 1 << 10;

/// Knots of one direction at one level, with the segments that every function reaches.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelKnots {
    knots: Knots,
    /// First and last segment of every function's support.
    reach: Vec<[u32; 2]>,
}

impl LevelKnots {
    fn new(knots: Knots) -> LevelKnots {
        let mut reach = vec![[u32::MAX, 0]; knots.n_basis()];
        for segment in 0..knots.n_segments() {
            let first = knots.first_basis(segment);
            for [from, to] in &mut reach[first..=first + knots.degree()] {
                *from = (*from).min(segment as u32);
                *to = segment as u32;
            }
        }
        LevelKnots { knots, reach }
    }

    /// The knots.
    pub fn knots(&self) -> &Knots {
        &self.knots
    }

    /// First and last segment that a function does not vanish on.
    pub fn reach(&self, function: usize) -> [u32; 2] {
        self.reach[function]
    }

    /// First and last segment that the functions on a segment reach.
    pub fn extension(&self, segment: u32) -> [u32; 2] {
        let first = self.knots.first_basis(segment as usize);
        [self.reach[first][0], self.reach[first + self.knots.degree()][1]]
    }
}

/// One row of knot insertion: the coarse functions that fine function j is a part of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InsertionRow {
    /// First coarse function.
    pub first: usize,
    /// Shares of it and of the p that follow.
    pub shares: [f64; MAX_DEGREE + 1],
}

/// Knots of all levels that exist, in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct KnotLevels {
    axes: [Vec<LevelKnots>; 2],
    uniform: [bool; 2],
}

impl KnotLevels {
    /// The base knots alone. Interior knots may be repeated; repeated knots stay as they are in all levels.
    ///
    /// # Errors
    /// Degrees outside 2 to 5, closed knots, more than 1,024 segments in a direction.
    pub fn new(base: [Knots; 2]) -> Result<KnotLevels, HierarchyError> {
        for (knots, axis) in base.iter().zip(AXES) {
            let degree = knots.degree();
            if !(LEAST_DEGREE..=MOST_DEGREE).contains(&degree) {
                return Err(HierarchyError::Degree { axis, degree, least: LEAST_DEGREE, most: MOST_DEGREE });
            }
            if knots.is_closed() {
                return Err(HierarchyError::Closed { axis });
            }
            if knots.n_segments() > MOST_SEGMENTS {
                let source = SplineError::Segments { segments: knots.n_segments(), max: MOST_SEGMENTS };
                return Err(HierarchyError::Knots { axis, source });
            }
        }
        let uniform = base.each_ref().map(|knots| {
            let [lo, hi] = knots.domain();
            Knots::uniform(knots.degree(), knots.n_segments(), lo, hi).is_ok_and(|made| made == *knots)
        });
        Ok(KnotLevels { axes: base.map(|knots| vec![LevelKnots::new(knots)]), uniform })
    }

    /// Degrees in x and y.
    pub fn degree(&self) -> [usize; 2] {
        self.axes.each_ref().map(|levels| levels[0].knots.degree())
    }

    /// KnotLevels that exist.
    pub fn count(&self) -> usize {
        self.axes[0].len()
    }

    /// Knots of a level in both directions.
    pub fn at(&self, level: usize) -> [&LevelKnots; 2] {
        self.axes.each_ref().map(|levels| &levels[level])
    }

    /// Makes all levels up to this one.
    ///
    /// # Errors
    /// A segment too short to be halved.
    pub(super) fn deepen(&mut self, level: usize) -> Result<(), HierarchyError> {
        for (axis, levels) in self.axes.iter_mut().enumerate() {
            while levels.len() <= level {
                let last = &levels[levels.len() - 1].knots;
                let next = halved(last, self.uniform[axis])
                    .map_err(|source| HierarchyError::Knots { axis: AXES[axis], source })?;
                levels.push(LevelKnots::new(next));
            }
        }
        Ok(())
    }

    /// The row of function `fine` of level `level + 1` over the functions of `level`, along one axis.
    pub fn insertion_row(&self, axis: usize, level: usize, fine: usize) -> InsertionRow {
        let [coarse, fine_knots] = [level, level + 1].map(|l| &self.axes[axis][l].knots);
        let p = coarse.degree();
        // the segment in which the function begins holds all coarse functions that it is a part of
        let segment = (self.axes[axis][level + 1].reach[fine][0] / 2) as usize;
        blossom_row(coarse, segment, &fine_knots.as_slice()[fine + 1..=fine + p])
    }
}

/// Shares of the functions on a segment in the blossom of a spline's polynomial there at p arguments: the coefficient that the spline has
/// for a function whose inner knots these are.
pub(crate) fn blossom_row(knots: &Knots, segment: usize, arguments: &[f64]) -> InsertionRow {
    let (p, first) = (knots.degree(), knots.first_basis(segment));
    let window = &knots.as_slice()[first + 1..=first + 2 * p];
    let mut shares = [0.0; MAX_DEGREE + 1];
    shares[0] = 1.0;
    for (j, x) in (1..=p).zip(arguments) {
        let mut saved = 0.0;
        for r in 0..j {
            let (right, left) = (window[p + r], window[p + r - j]);
            let share = shares[r] / (right - left);
            shares[r] = saved + (right - x) * share;
            saved = (x - left) * share;
        }
        shares[j] = saved;
    }
    InsertionRow { first, shares }
}

/// All segments halved; repeated knots keep their number.
fn halved(knots: &Knots, uniform: bool) -> Result<Knots, SplineError> {
    let [lo, hi] = knots.domain();
    if uniform {
        return Knots::uniform(knots.degree(), 2 * knots.n_segments(), lo, hi);
    }
    let mut all = knots.as_slice().to_vec();
    all.extend((0..knots.n_segments()).map(|s| {
        let [a, b] = knots.segment(s);
        a + 0.5 * (b - a)
    }));
    all.sort_by(f64::total_cmp);
    Knots::new(knots.degree(), all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inserted_knots_leave_the_spline_as_it_was() {
        let odd = Knots::new(3, vec![0.0, 0.0, 0.0, 0.0, 0.3, 0.5, 0.5, 2.0, 2.0, 2.0, 2.0]).unwrap();
        for base in [Knots::uniform(2, 1, 0.0, 1.0).unwrap(), Knots::uniform(5, 7, -1.0, 2.0).unwrap(), odd] {
            let mut levels = KnotLevels::new([base.clone(), base]).unwrap();
            levels.deepen(2).unwrap();
            for level in 0..2 {
                let [coarse, fine] = [level, level + 1].map(|l| levels.at(l)[0].knots().clone());
                let c: Vec<f64> = (0..coarse.n_basis()).map(|k| (1.7 * k as f64).sin()).collect();
                let d: Vec<f64> = (0..fine.n_basis())
                    .map(|j| {
                        let row = levels.insertion_row(0, level, j);
                        (0..=coarse.degree()).map(|a| row.shares[a] * c[row.first + a]).sum()
                    })
                    .collect();
                let at = |knots: &Knots, c: &[f64], x: f64| -> f64 {
                    let row = knots.basis(x);
                    row.derivative(0).iter().enumerate().map(|(a, n)| n * c[row.first + a]).sum()
                };
                let [lo, hi] = coarse.domain();
                for k in 0..=40 {
                    let x = lo + (hi - lo) * f64::from(k) / 40.0;
                    assert!((at(&coarse, &c, x) - at(&fine, &d, x)).abs() < 1e-14, "level {level} x {x}");
                }
            }
        }
    }

    #[test]
    fn bad_bases_are_refused_by_name() {
        let of = |degree| Knots::uniform(degree, 3, 0.0, 1.0).unwrap();
        assert!(matches!(KnotLevels::new([of(1), of(2)]), Err(HierarchyError::Degree { axis: "x", degree: 1, .. })));
        assert!(matches!(KnotLevels::new([of(2), of(6)]), Err(HierarchyError::Degree { axis: "y", degree: 6, .. })));
        let closed = Knots::closed(3, 5, 0.0, 1.0).unwrap();
        assert!(matches!(KnotLevels::new([closed, of(3)]), Err(HierarchyError::Closed { axis: "x" })));
    }
}
