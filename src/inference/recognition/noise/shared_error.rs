//! Errors that all normals share: a number times a known vector, taken out of the rows.
//!
//! ```text
//! e = v a,   a ~ N(0, sd^2)       Sigma_n <- Sigma_n + sd^2 v v'
//! W'W <- W'W - c c'/k             log det <- log det + log(sd^2 k)           W, v~: rows and v whitened by Sigma_n
//! c = W' v~,   k = 1/sd^2 + v~'v~,   mean of a = c . coefficients / k
//! ```
//!
//! Of several each is taken out of the rows and of those that come after it.

use faer::Mat;

use crate::dense;
use palpate_numeric::linalg;

/// One error that all normals share.
#[derive(Clone, Debug)]
pub(super) struct SharedError {
    /// v along both tangents of every cell.
    pub(super) along: [Vec<f64>; 2],
    /// Prior standard deviation of its size.
    pub(super) sd: f64,
}

/// c and k of the rows that an error was taken out of.
#[derive(Clone, Debug)]
pub(super) struct ToldOfShared {
    c: Vec<f64>,
    k: f64,
}

impl ToldOfShared {
    /// Mean of its size where the columns have these coefficients.
    pub(super) fn mean(&self, coefficients: &[f64]) -> f64 {
        self.c.iter().zip(coefficients).map(|(c, x)| c * x).sum::<f64>() / self.k
    }
}

/// A whitened error beside the rows: it is taken out of both halves, and out of other errors.
struct WhitenedError {
    along: [Vec<f64>; 2],
    /// v~'v~
    square: f64,
    variance: f64,
    /// Share of rows along v that is left out, so that of their square `1/(1 + sd^2 v~'v~)` stays.
    share: f64,
}

impl WhitenedError {
    fn new(along: [Vec<f64>; 2], sd: f64, variance: f64) -> WhitenedError {
        let square = along.iter().map(|v| linalg::dot(v, v)).sum::<f64>() / variance;
        let share = 1.0 - (1.0 + sd * sd * square).sqrt().recip();
        WhitenedError { along, square, variance, share }
    }

    /// Leaves its share out of a column of both halves; gives back `v~'` times it.
    fn taken_out_of(&self, mut column: [&mut [f64]; 2]) -> f64 {
        let c = column.iter().zip(&self.along).map(|(half, v)| linalg::dot(half, v)).sum::<f64>() / self.variance;
        let by = if self.square > 0.0 { self.share * c / self.square } else { 0.0 };
        for (half, v) in column.iter_mut().zip(&self.along) {
            half.iter_mut().zip(v).for_each(|(row, v)| *row -= by * v);
        }
        c
    }
}

/// Takes errors out of both halves of the whitened rows of the normals, whose errors have this factor and variance; gives back the sum of
/// `log(sd^2 k)` and what the rows say of each. Taken out of the Gram matrix, they would leave nothing but rounding of contacts without
/// noise.
pub(super) fn take_out(
    errors: Vec<SharedError>,
    halves: &mut [Mat<f64>; 2],
    lower: &Mat<f64>,
    variance: f64,
) -> (f64, Vec<ToldOfShared>) {
    let (mut log_det, mut told) = (0.0, Vec::new());
    let mut errors = errors;
    errors.iter_mut().flat_map(|error| &mut error.along).for_each(|v| dense::forward_in_columns(lower, v));
    for number in 0..errors.len() {
        let (first, later) = errors.split_at_mut(number + 1);
        let sd = first[number].sd;
        let error = WhitenedError::new(first[number].along.clone(), sd, variance);
        for SharedError { along: [one, two], .. } in later {
            error.taken_out_of([one, two]);
        }
        let [one, two] = halves;
        let columns = 0..one.ncols();
        let c = columns.map(|j| error.taken_out_of([one.col_as_slice_mut(j), two.col_as_slice_mut(j)])).collect();
        let k = sd.powi(-2) + error.square;
        log_det += (sd * sd * k).ln();
        told.push(ToldOfShared { c, k });
    }
    (log_det, told)
}
