//! How contacts scatter within their cells: what the mean of a cell no longer tells of their independent errors.
//!
//! ```text
//! d = a0 + a1 u + a2 v [+ a3 u^2 + a4 u v + a5 v^2] + e       u, v of a contact in its cell, along the two tangents; d its distance
//! S_3, S_6                                                    sums of squares that planes and quadrics leave in all cells
//! told    S_3 / f_3 < `Tuning::bent_cells` S_6 / f_6          cells bend by less than contacts scatter; f: degrees of freedom
//! s^2 >= S/f                                                  S = S_6 over the mean number of contacts in a cell
//! ```
//!
//! Where a cell bends by more, terms of third degree, which stay, would pass for scatter. An error that neighbours share changes little
//! within a cell, so that the scatter is that of independent errors, and no shape or shared error may take its place. The mean of a cell
//! errs by no less than its contacts tell, and by more where no surface that is tried follows it: a thousand contacts a cell know
//! it better than any spline.

use crate::bodies::Tuning;
use palpate_numeric::vector::{Vector, dot, minus, norm};

use super::height_polynomial::left_by_polynomial;

/// Terms of a plane and of a quadric.
const TERMS: [usize; 2] = [3, 6];

/// Contacts of a cell from which on a quadric leaves some scatter.
const FEWEST_IN_CELL: usize = 9;

/// What quadrics leave of contacts within their cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ScatterWithin {
    /// Sum of squares over the mean number of contacts in a cell: its expectation is `freedom` times the variance of an average cell.
    pub(crate) square: f64,
    /// Degrees of freedom; 0 where nothing is told.
    pub(crate) freedom: f64,
}

impl ScatterWithin {
    /// Variance of an average cell that makes a sum of squares with these degrees of freedom likeliest, beside the scatter where that says
    /// more.
    pub(crate) fn variance_beside(&self, square: f64, freedom: f64) -> f64 {
        let own = square / freedom;
        if self.exceeds(own) { (square + self.square) / (freedom + self.freedom) } else { own }
    }

    /// Twice the negative log likelihood of the scatter under a variance of an average cell.
    pub(crate) fn deviance(&self, variance: f64) -> f64 {
        if self.freedom == 0.0 {
            return 0.0;
        }
        let variance = if self.exceeds(variance) { variance } else { self.square / self.freedom };
        self.freedom * variance.ln() + self.square / variance
    }

    /// Degrees of freedom that the scatter adds to this variance.
    pub(crate) fn freedom_beside(&self, variance: f64) -> f64 {
        if self.exceeds(variance) { self.freedom } else { 0.0 }
    }

    /// Whether contacts scatter by more than this variance of an average cell.
    fn exceeds(&self, variance: f64) -> bool {
        self.square > variance * self.freedom
    }

    /// Of contacts with these feet at these distances from a surface near them, in cells with these `middles` and tangents of it there.
    pub(crate) fn of(
        cell_of: &[usize],
        [feet, middles]: [&[Vector]; 2],
        tangents: &[Vec<Vector>; 2],
        distances: &[f64],
        tuning: &Tuning,
    ) -> ScatterWithin {
        let per_cell = cell_of.len() as f64 / middles.len() as f64;
        if per_cell > tuning.crowded_cells {
            return ScatterWithin::default();
        }
        let mut members = vec![Vec::new(); middles.len()];
        cell_of.iter().enumerate().for_each(|(contact, cell)| members[*cell].push(contact));
        let (mut squares, mut freedom) = ([0.0; 2], [0.0; 2]);
        for (cell, members) in members.iter().enumerate().filter(|(_, members)| members.len() >= FEWEST_IN_CELL) {
            let from = |i: &usize| minus(feet[*i], middles[cell]);
            let size = members.iter().map(|i| norm(from(i))).fold(0.0, f64::max);
            let place = |i: &usize| {
                let along = |side: usize| dot(from(i), tangents[side][cell]) / size;
                [along(0), along(1), distances[*i]]
            };
            let places: Vec<Vector> = members.iter().map(place).collect();
            let left = TERMS.map(|terms| square_left(&places, terms));
            if let [Some(plane), Some(quadric)] = left {
                for (k, square) in [plane, quadric].into_iter().enumerate() {
                    squares[k] += square;
                    freedom[k] += (members.len() - TERMS[k]) as f64;
                }
            }
        }
        let [of_planes, of_quadrics] = [0, 1].map(|k| squares[k] / freedom[k]);
        if freedom[1] < tuning.scatter_freedom || of_planes >= tuning.bent_cells * of_quadrics {
            return ScatterWithin::default();
        }
        ScatterWithin { square: squares[1] / per_cell, freedom: freedom[1] }
    }
}

/// Sum of squares that a polynomial of so many terms leaves; `None` where the places do not tell it.
fn square_left(places: &[Vector], terms: usize) -> Option<f64> {
    let square: f64 = left_by_polynomial(places, terms, 1)?.iter().map(|left| left * left).sum();
    square.is_finite().then_some(square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::draws::Lcg;

    const COUNT: usize = 4000;
    const SIDE: usize = 14;

    /// Of contacts over a square of side 2 about z = 0, this high and with this noise, in 14 x 14 cells.
    fn within(noise: f64, height: impl Fn(f64, f64) -> f64) -> ScatterWithin {
        let mut generator = Lcg::new(5);
        let mut place = || {
            let [x, y] = [0, 1].map(|_| 2.0 * generator.uniform() - 1.0);
            [x, y, height(x, y) + noise * generator.normal()]
        };
        let points: Vec<Vector> = (0..COUNT).map(|_| place()).collect();
        let feet: Vec<Vector> = points.iter().map(|[x, y, _]| [*x, *y, 0.0]).collect();
        let distances: Vec<f64> = points.iter().map(|p| p[2]).collect();
        let number = |v: f64| (0.5 * (v + 1.0) * SIDE as f64) as usize;
        let cell_of: Vec<usize> = feet.iter().map(|[x, y, _]| number(*x) * SIDE + number(*y)).collect();
        let middle = |k: usize| (2 * k + 1) as f64 / SIDE as f64 - 1.0;
        let middles: Vec<Vector> = (0..SIDE * SIDE).map(|k| [middle(k / SIDE), middle(k % SIDE), 0.0]).collect();
        let tangents = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|t| vec![t; SIDE * SIDE]);
        ScatterWithin::of(&cell_of, [&feet, &middles], &tangents, &distances, &Tuning::default())
    }

    #[test]
    fn waves_that_are_longer_than_cells_are_no_scatter() {
        let found = within(0.01, |x, y| 0.1 * (4.0 * x).sin() + 0.05 * y * y);
        assert!(found.freedom > 2000.0);
        let sd = (found.square / found.freedom * COUNT as f64 / (SIDE * SIDE) as f64).sqrt();
        assert!((sd / 0.01 - 1.0).abs() < 0.05, "{sd}");
    }

    #[test]
    fn means_err_by_no_less_than_contacts_tell_and_may_err_by_more() {
        let found = within(0.01, |x, _| 0.05 * x * x);
        let told = found.square / found.freedom;
        assert!((found.variance_beside(100.0 * 0.1 * told, 100.0) / told - 1.0).abs() < 0.1);
        assert_eq!(found.variance_beside(64.0 * 9.0 * told, 64.0), 9.0 * told);
        assert!(found.deviance(0.1 * told) > found.deviance(told) + 100.0);
        assert_eq!(found.deviance(9.0 * told), found.deviance(told));
        assert_eq!([0.1, 9.0].map(|times| found.freedom_beside(times * told)), [found.freedom, 0.0]);
        assert_eq!(ScatterWithin::default().deviance(told), 0.0);
    }

    #[test]
    fn cells_that_bend_more_than_contacts_scatter_tell_nothing() {
        assert_eq!(within(1e-5, |x, y| 0.1 * (9.0 * x).sin() * (9.0 * y).cos()), ScatterWithin::default());
    }
}
