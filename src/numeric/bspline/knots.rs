//! Knot vectors of n basis functions, clamped or closed.
//!
//! ```text
//! clamped    t_0 = .. = t_p < .. < t_n = .. = t_n+p
//! closed     uniform from end to end; the last p coefficients repeat the first p, so the spline has no seam
//! ```

use super::SplineError;

/// Largest degree. Beyond 9 the basis itself loses digits and nobody fits surfaces with it.
pub const MAX_DEGREE: usize = 9;

/// Largest number of segments in one direction. 2^20 keeps every product of indices below 2^53, and a number larger than
/// that is a typing error.
const MAX_SEGMENTS: usize = 1 << 20;

/// A knot vector with its degree; clamped unless it is closed.
///
/// In a clamped vector the first and last knot stand degree + 1 times, so that the spline begins and ends at its first
/// and last coefficient. Libraries that take breakpoints and an order (degree + 1) repeat the ends in the same way.
///
/// ```
/// # use palpate_numeric::facade as palpate;
/// use palpate::spline::Knots;
///
/// let knots = Knots::uniform(2, 4, 0.0, 1.0)?; // parabolas, four segments
/// assert_eq!(knots.as_slice(), [0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.0]);
/// assert_eq!((knots.n_basis(), knots.n_segments(), knots.domain()), (6, 4, [0.0, 1.0]));
/// assert_eq!(knots.segment_of(0.5), 2); // a knot belongs to the segment on its right
/// # Ok::<(), palpate::spline::SplineError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Knots {
    degree: usize,
    closed: bool,
    knots: Vec<f64>,
    /// Index in `knots` of the left end of every segment of positive length.
    segment_starts: Vec<usize>,
    /// 1 / segment length when all interior knots are simple and equally spaced.
    inverse_step: Option<f64>,
}

/// `n` points from `lo` to `hi`, both ends included: `lo + i * ((hi - lo) / (n - 1))`, the last one `hi` exactly.
///
/// `n = 1` gives the middle. Uniform knots, shape grids and the hard cases' stations are placed by this expression, which
/// is numpy's. The stations of simulated sweeps have one of their own, `scene::linspace`, which rounds differently.
pub fn linspace(lo: f64, hi: f64, n: usize) -> Vec<f64> {
    if n == 1 {
        return vec![0.5 * (lo + hi)];
    }
    let step = (hi - lo) / (n as f64 - 1.0);
    (0..n).map(|i| if i + 1 == n { hi } else { lo + i as f64 * step }).collect()
}

impl Knots {
    /// Uniform knots: `segments` equal pieces over `[lo, hi]`.
    ///
    /// # Errors
    /// Degree or segment count out of range, or an empty domain.
    pub fn uniform(degree: usize, segments: usize, lo: f64, hi: f64) -> Result<Knots, SplineError> {
        check_degree(degree)?;
        if segments == 0 || segments > MAX_SEGMENTS {
            return Err(SplineError::Segments { segments, max: MAX_SEGMENTS });
        }
        if !(lo.is_finite() && hi.is_finite() && lo < hi && (hi - lo).is_finite()) {
            return Err(SplineError::Domain { lo, hi });
        }
        let mut knots = vec![lo; degree];
        knots.extend(linspace(lo, hi, segments + 1));
        knots.extend(std::iter::repeat_n(hi, degree));
        let mut made = Knots::new(degree, knots)?;
        if made.segment_starts.len() == segments {
            made.inverse_step = Some(segments as f64 / (hi - lo));
        }
        Ok(made)
    }

    /// A given clamped knot vector; interior knots may be repeated up to `degree` times.
    ///
    /// # Errors
    /// Everything that [`SplineError`] names.
    pub fn new(degree: usize, knots: Vec<f64>) -> Result<Knots, SplineError> {
        check_degree(degree)?;
        let needed = 2 * (degree + 1);
        if knots.len() < needed {
            return Err(SplineError::TooFew { found: knots.len(), needed, degree });
        }
        let out_of_order = |i: &usize| !knots[*i].is_finite() || (*i > 0 && knots[*i] < knots[*i - 1]);
        if let Some(index) = (0..knots.len()).find(out_of_order) {
            return Err(SplineError::Order { index, value: knots[index] });
        }
        let (lo, hi) = (knots[0], knots[knots.len() - 1]);
        if lo >= hi || !(hi - lo).is_finite() {
            return Err(SplineError::Domain { lo, hi });
        }
        if knots[degree] != lo || knots[knots.len() - 1 - degree] != hi {
            return Err(SplineError::NotClamped { needed: degree + 1 });
        }
        check_multiplicity(degree, &knots)?;
        let segment_starts = (degree..knots.len() - degree - 1).filter(|&i| knots[i] < knots[i + 1]).collect();
        Ok(Knots { degree, closed: false, knots, segment_starts, inverse_step: None })
    }

    /// Closed uniform knots: period `hi - lo`, knots `lo + (i - p) (hi - lo) / segments`, n = segments + p basis
    /// functions of which the last p repeat the first p ([`Knots::free`] counts the distinct ones).
    ///
    /// # Errors
    /// As [`Knots::uniform`]; also for fewer than degree + 1 segments, with which a basis function would overlap itself.
    pub fn closed(degree: usize, segments: usize, lo: f64, hi: f64) -> Result<Knots, SplineError> {
        let open = Knots::uniform(degree, segments, lo, hi)?;
        if segments <= degree {
            return Err(SplineError::ClosedSegments { segments, needed: degree + 1 });
        }
        let step = (hi - lo) / segments as f64;
        let at = |i: usize| match i.checked_sub(degree) {
            Some(i) if i <= segments => open.knots[degree + i],
            _ => lo + (i as f64 - degree as f64) * step,
        };
        let knots: Vec<f64> = (0..=segments + 2 * degree).map(at).collect();
        let segment_starts = (degree..degree + segments).collect();
        Ok(Knots { degree, closed: true, knots, segment_starts, inverse_step: open.inverse_step })
    }

    /// A closed knot vector that was written out before: it must equal, but for rounding, what [`Knots::closed`] makes.
    ///
    /// # Errors
    /// Everything that [`SplineError`] names.
    pub fn closed_from(degree: usize, knots: &[f64]) -> Result<Knots, SplineError> {
        check_degree(degree)?;
        let needed = 3 * degree + 2;
        if knots.len() < needed {
            return Err(SplineError::TooFew { found: knots.len(), needed, degree });
        }
        let segments = knots.len() - 2 * degree - 1;
        let made = Knots::closed(degree, segments, knots[degree], knots[degree + segments])?;
        let far = 1e-9 * (knots[degree + segments] - knots[degree]);
        let off = |i: &usize| knots[*i].is_nan() || (knots[*i] - made.knots[*i]).abs() > far;
        match (0..knots.len()).find(off) {
            Some(index) => Err(SplineError::NotUniform { index, value: knots[index] }),
            None => Ok(made),
        }
    }

    /// Whether the spline closes on itself.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Number of distinct coefficients: n, or n - p in a closed direction, where the last p repeat the first p.
    pub fn free(&self) -> usize {
        if self.closed { self.n_basis() - self.degree } else { self.n_basis() }
    }

    /// `t` brought into the period of a closed direction; unchanged in an open one.
    pub fn wrapped(&self, t: f64) -> f64 {
        if !self.closed {
            return t;
        }
        let [lo, hi] = self.domain();
        let r = lo + (t - lo).rem_euclid(hi - lo);
        if r < hi { r } else { lo }
    }

    /// The same knots under `t -> (t - origin) / scale`.
    ///
    /// # Errors
    /// When both ends of the domain become equal, or a knot is not finite any more.
    pub fn mapped(&self, origin: f64, scale: f64) -> Result<Knots, SplineError> {
        if self.closed {
            let [lo, hi] = self.domain().map(|t| (t - origin) / scale);
            return Knots::closed(self.degree, self.segment_starts.len(), lo, hi);
        }
        let mut made = Knots::new(self.degree, self.knots.iter().map(|t| (t - origin) / scale).collect())?;
        if made.segment_starts.len() == self.segment_starts.len() {
            made.inverse_step = self.inverse_step.map(|w| w * scale);
        }
        Ok(made)
    }

    /// Degree p.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The whole vector, n + p + 1 entries.
    pub fn as_slice(&self) -> &[f64] {
        &self.knots
    }

    /// Number of basis functions n.
    pub fn n_basis(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Number of segments of positive length.
    pub fn n_segments(&self) -> usize {
        self.segment_starts.len()
    }

    /// Both ends of the domain.
    pub fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.knots.len() - 1 - self.degree]]
    }

    /// Both ends of segment `s`.
    pub fn segment(&self, s: usize) -> [f64; 2] {
        let start = self.segment_starts[s];
        [self.knots[start], self.knots[start + 1]]
    }

    /// The first of the p + 1 basis functions that do not vanish on segment `s`.
    pub fn first_basis(&self, s: usize) -> usize {
        self.segment_starts[s] - self.degree
    }

    /// The segment that holds `x`. A knot belongs to the segment on its right, the upper end of the domain to the last
    /// segment, and points outside the domain to the nearest end segment.
    #[inline]
    pub fn segment_of(&self, x: f64) -> usize {
        let Some(inverse_step) = self.inverse_step else { return self.segment_by_search(x) };
        // `as` saturates, so values outside the domain and NaN get an end segment
        let guess = (((x - self.knots[self.degree]) * inverse_step) as i32).max(0) as usize;
        let guess = guess.min(self.segment_starts.len() - 1);
        if self.knots[self.degree + guess] <= x && x < self.knots[self.degree + guess + 1] {
            return guess;
        }
        self.segment_beside(guess, x)
    }

    /// Corrects a segment number that rounding made too large or too small by one, by comparing with the knots.
    #[cold]
    fn segment_beside(&self, mut s: usize, x: f64) -> usize {
        let last = self.segment_starts.len() - 1;
        while s < last && x >= self.knots[self.degree + s + 1] {
            s += 1;
        }
        while s > 0 && x < self.knots[self.degree + s] {
            s -= 1;
        }
        s
    }

    fn segment_by_search(&self, x: f64) -> usize {
        let upper = self.segment_starts.partition_point(|&start| self.knots[start] <= x);
        upper.saturating_sub(1)
    }

    /// Greville abscissae `(t_i+1 + .. + t_i+p) / p`: where coefficient i acts. The spline with these coefficients is x itself.
    pub fn greville(&self) -> Vec<f64> {
        let p = self.degree;
        (0..self.n_basis()).map(|i| self.knots[i + 1..=i + p].iter().map(|t| t / p as f64).sum()).collect()
    }
}

fn check_degree(degree: usize) -> Result<(), SplineError> {
    if (1..=MAX_DEGREE).contains(&degree) { Ok(()) } else { Err(SplineError::Degree { degree }) }
}

fn check_multiplicity(degree: usize, knots: &[f64]) -> Result<(), SplineError> {
    let (lo, hi) = (knots[0], knots[knots.len() - 1]);
    for run in knots.chunk_by(|a, b| a == b) {
        let max = if run[0] == lo || run[0] == hi { degree + 1 } else { degree };
        if run.len() > max {
            return Err(SplineError::Multiplicity { value: run[0], found: run.len(), max });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_right_continuous_and_closed_at_the_top() {
        for segments in [1, 3, 7, 10, 64] {
            let knots = Knots::uniform(3, segments, 0.1, 0.7).unwrap();
            let general = Knots::new(3, knots.as_slice().to_vec()).unwrap();
            for s in 0..segments {
                let [lo, hi] = knots.segment(s);
                for x in [lo, 0.5 * (lo + hi), hi.next_down()] {
                    assert_eq!((knots.segment_of(x), general.segment_of(x)), (s, s));
                }
            }
            assert_eq!(knots.segment_of(0.7), segments - 1);
            assert_eq!((knots.segment_of(-5.0), general.segment_of(-5.0)), (0, 0));
            assert_eq!((knots.segment_of(5.0), general.segment_of(5.0)), (segments - 1, segments - 1));
        }
    }

    #[test]
    fn closed_splines_have_no_seam() {
        let knots = Knots::closed(3, 5, -1.0, 4.0).unwrap();
        assert_eq!((knots.n_basis(), knots.free(), knots.domain()), (8, 5, [-1.0, 4.0]));
        assert_eq!(Knots::closed_from(3, knots.as_slice()).unwrap(), knots);
        assert!(matches!(Knots::closed(3, 3, 0.0, 1.0), Err(SplineError::ClosedSegments { needed: 4, .. })));
        let c: Vec<f64> = (0..8).map(|i| ((i % 5) as f64).sin()).collect();
        let at = |t: f64, k: usize| -> f64 {
            let row = knots.basis(t);
            row.derivative(k).iter().enumerate().map(|(a, n)| n * c[row.first + a]).sum()
        };
        for k in 0..3 {
            assert!((at(-1.0, k) - at(4.0, k)).abs() < 1e-12, "derivative {k}");
        }
        assert_eq!(knots.wrapped(9.0), -1.0);
        assert_eq!(knots.wrapped(-1.5), 3.5);
    }

    #[test]
    fn bad_vectors_are_refused_by_name() {
        assert_eq!(Knots::uniform(0, 1, 0.0, 1.0), Err(SplineError::Degree { degree: 0 }));
        assert_eq!(Knots::uniform(10, 1, 0.0, 1.0), Err(SplineError::Degree { degree: 10 }));
        assert!(matches!(Knots::uniform(2, 0, 0.0, 1.0), Err(SplineError::Segments { .. })));
        assert!(matches!(Knots::uniform(2, 1, 1.0, 1.0), Err(SplineError::Domain { .. })));
        assert!(matches!(Knots::new(2, vec![0.0; 5]), Err(SplineError::TooFew { .. })));
        assert!(matches!(Knots::new(1, vec![0.0, 0.0, 2.0, 1.0, 3.0, 3.0]), Err(SplineError::Order { index: 3, .. })));
        assert!(matches!(Knots::new(1, vec![0.0, 0.5, 1.0, 1.0]), Err(SplineError::NotClamped { .. })));
        let torn = vec![0.0, 0.0, 1.0, 1.0, 2.0, 2.0];
        assert!(matches!(Knots::new(1, torn), Err(SplineError::Multiplicity { found: 2, .. })));
    }
}
