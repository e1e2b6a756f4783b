//! Order of accuracy: how fast the errors of a spline fall when its segments are halved.
//!
//! ```text
//! e(h) ~ h^s      heights s = p + 1,  slopes s = p,  curvatures s = p - 1          s = log2 e(2 h)/e(h)
//! e = root mean square over the patch by Gauss quadrature; grids with more than 6 stations a segment, no noise
//! ```
//!
//! Heights of degree 2 are the exception where slope rows take part: they are measured at 2.4, and nearer to 2 the finer the
//! segments. The slopes of the best spline
//! of degree p err by `f^(p+1) h^p B_p(t)/p!`, t the place within a segment and B_p the Bernoulli polynomial. Its integral
//! over a segment is 0, so heights stay right from knot to knot; but its mean over m evenly spaced stations is `B_p/m^p`
//! (1/36 of B_2 for six of them), and a fit that makes the *sum* over stations small tilts every segment by that much. The
//! tilts have one sign and add up along the patch: heights err by `h^p/m^p` beside the `h^(p+1)` of theory. For odd p,
//! `B_p = 0`; for p = 4, `m^p` is too large for it to be seen. With stations and weights of Gauss's quadrature the sum is
//! the integral, and degree 2 has its order 3 back (`stations` of the rows below).

use ndarray::Array2;

use palpate_fitting::fit::{FitOptions, Objective, SlopeWeights, fit_grid};
use palpate_geometry::contact::Grid;
use palpate_geometry::surface::HeightField;
use palpate_numeric::bspline::gauss_legendre;
use palpate_world::scene::surface::{Body, Ellipsoid, GaussianBump};
use palpate_world::scene::{Surface, linspace};

/// Half the side of the patch, in units in which the bodies have sizes of 1 to 3.
const HALF: f64 = 1.0;
/// Segments each way; the orders are those of the last two halvings.
const SEGMENTS: [usize; 3] = [16, 32, 64];
/// Intervals between stations of a segment: with both ends, 7 stations.
const STATIONS: usize = 6;
/// Gauss points of a segment for the errors.
const POINTS: usize = 7;

/// Which rows take part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrderRows {
    /// Heights alone, stations evenly spaced.
    Heights,
    /// Heights and slopes, stations evenly spaced.
    Slopes,
    /// Heights and slopes at the stations and with the weights of Gauss's quadrature.
    Gauss,
}

impl OrderRows {
    /// All of them.
    pub(crate) const ALL: [OrderRows; 3] = [OrderRows::Heights, OrderRows::Slopes, OrderRows::Gauss];

    /// Words.
    pub fn name(self) -> &'static str {
        match self {
            OrderRows::Heights => "heights",
            OrderRows::Slopes => "heights and slopes",
            OrderRows::Gauss => "heights and slopes, Gauss stations",
        }
    }
}

/// Measured orders of one body, degree and kind of rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// `ellipsoid` or `gaussian`.
    pub body: &'static str,
    /// Degree.
    pub degree: usize,
    /// Rows.
    pub rows: OrderRows,
    /// Errors of heights, slopes and curvatures at 16, 32 and 64 segments.
    pub errors: [[f64; 3]; 3],
}

impl Order {
    /// Orders of heights, slopes and curvatures over the last halvings: the mean of two.
    pub fn found(&self) -> [f64; 3] {
        let [coarse, _, fine] = self.errors;
        std::array::from_fn(|q| 0.5 * (coarse[q] / fine[q]).log2())
    }

    /// What theory says.
    pub fn theory(&self) -> [f64; 3] {
        [1.0, 0.0, -1.0].map(|more| self.degree as f64 + more)
    }
}

/// Measures every body, degree 2 to 5, and kind of rows.
pub fn orders() -> Vec<Order> {
    let bodies = [
        Body::Ellipsoid(Ellipsoid { semi_axes: [3.0, 2.5, 2.0] }),
        Body::Gaussian(GaussianBump { height: 0.5, width: 1.2 }),
    ];
    let mut found = Vec::new();
    for body in bodies {
        let surface = Surface::new(body, 20.0);
        for degree in 2..=5 {
            for rows in OrderRows::ALL {
                let errors = SEGMENTS.map(|segments| errors(&surface, degree, segments, rows));
                found.push(Order { body: surface.body.kind(), degree, rows, errors });
            }
        }
    }
    found
}

/// Errors of heights, slopes and curvatures; NaN where there is no fit.
fn errors(surface: &Surface, degree: usize, segments: usize, rows: OrderRows) -> [f64; 3] {
    let Some(grid) = stations(surface, segments, rows) else { return [f64::NAN; 3] };
    let options = FitOptions::default()
        .with_degree(degree)
        .with_segments(segments, segments)
        .with_domain([-HALF, HALF, -HALF, HALF])
        .with_objective(Objective::Slopes(SlopeWeights::Explicit([1.0; 3])));
    let fitted = fit_grid(&grid, &options).and_then(|fit| fit.input_surface());
    fitted.map_or([f64::NAN; 3], |field| quadrature(surface, &field, segments))
}

/// Places and weights of one axis: the weights multiply residuals.
fn axis(segments: usize, rows: OrderRows) -> (Vec<f64>, Vec<f64>) {
    if rows != OrderRows::Gauss {
        let places = linspace(-HALF, HALF, STATIONS * segments + 1);
        let weights = vec![1.0; places.len()];
        return (places, weights);
    }
    let (places, weights) = gauss(segments, STATIONS);
    (places, weights.iter().map(|w| w.sqrt()).collect())
}

/// Gauss points of every segment with their weights.
fn gauss(segments: usize, points: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut nodes, weights) = gauss_legendre(points);
    // the axis of a grid rises; the weights are the same from both ends
    nodes.sort_unstable_by(f64::total_cmp);
    let half = HALF / segments as f64;
    let middles = (0..segments).map(|k| -HALF + (2 * k + 1) as f64 * half);
    let all = middles.flat_map(|middle| nodes.iter().zip(&weights).map(move |(t, w)| (middle + half * t, half * w)));
    all.unzip()
}

fn stations(surface: &Surface, segments: usize, rows: OrderRows) -> Option<Grid> {
    let (places, weights) = axis(segments, rows);
    let size = (places.len(), places.len());
    let [mut z, mut zx, mut zy] = [(); 3].map(|()| Array2::zeros(size));
    for (i, x) in places.iter().enumerate() {
        for (j, y) in places.iter().enumerate() {
            let there = surface.at(*x, *y)?;
            let [nx, ny, nz] = there.local.normal;
            (z[[i, j]], zx[[i, j]], zy[[i, j]]) = (there.point[2], -nx / nz, -ny / nz);
        }
    }
    let mut grid = Grid::new(places.clone(), places, z);
    if rows != OrderRows::Heights {
        (grid.zx, grid.zy) = (Some(zx), Some(zy));
    }
    if rows == OrderRows::Gauss {
        let map = Array2::from_shape_fn(size, |(i, j)| weights[i] * weights[j]);
        (grid.wz, grid.wx, grid.wy) = (Some(map.clone()), Some(map.clone()), Some(map));
    }
    Some(grid)
}

/// Root mean squares over the patch of the errors of heights, slopes and k1.
fn quadrature(surface: &Surface, field: &HeightField, segments: usize) -> [f64; 3] {
    let (places, weights) = gauss(segments, POINTS);
    let mut sums = [0.0; 3];
    for (x, wx) in places.iter().zip(&weights) {
        for (y, wy) in places.iter().zip(&weights) {
            let Some(there) = surface.at(*x, *y) else { return [f64::NAN; 3] };
            let found = field.at(*x, *y);
            let [nx, ny, nz] = there.local.normal;
            let slopes = (found.zx + nx / nz).powi(2) + (found.zy + ny / nz).powi(2);
            let k1 = found.derivatives().principal().map_or(f64::NAN, |principal| principal.k1);
            let errors = [(found.z - there.point[2]).powi(2), slopes, (k1 - there.local.k1).powi(2)];
            (0..3).for_each(|q| sums[q] += wx * wy * errors[q]);
        }
    }
    sums.map(|sum| (sum / (4.0 * HALF * HALF)).sqrt())
}
