//! Data on a grid, the product of two axes: the factors `N (n_x x n)` and `M (n_y x m)` are stored separately, as bands.

use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg::{GridAxis, Site, Sites, TensorShape};

/// Basis values along one axis: row r has its p + 1 values at `first[r]`.
#[derive(Clone, Debug)]
pub struct AxisRows {
    /// Knots of this axis.
    pub knots: Knots,
    /// First basis function that is not zero at each axis point.
    pub first: Vec<usize>,
    /// p + 1 values per axis point.
    pub values: Vec<f64>,
    /// p + 1 slopes per axis point.
    pub slopes: Vec<f64>,
    /// Runs of axis points that share a segment.
    runs: Vec<std::ops::Range<usize>>,
}

impl AxisRows {
    fn new(knots: Knots, axis: &[f64]) -> AxisRows {
        let width = knots.degree() + 1;
        let mut rows = AxisRows { knots, first: Vec::new(), values: Vec::new(), slopes: Vec::new(), runs: Vec::new() };
        let mut buffer = vec![0.0; 2 * width];
        for &at in axis {
            rows.first.push(rows.knots.derivatives(at, 1, &mut buffer));
            rows.values.extend_from_slice(&buffer[..width]);
            rows.slopes.extend_from_slice(&buffer[width..]);
        }
        let mut start = 0;
        for run in rows.first.chunk_by(|a, b| a == b) {
            rows.runs.push(start..start + run.len());
            start += run.len();
        }
        rows
    }

    /// Lower bands of `sum_r w_r B_r B_r'` with B the values (`derivative = 0`) or the slopes (1).
    pub fn gram(&self, derivative: usize, weights: Option<&[f64]>) -> Vec<Vec<f64>> {
        let width = self.knots.degree() + 1;
        let table = if derivative == 0 { &self.values } else { &self.slopes };
        let mut bands = vec![vec![0.0; width]; self.knots.n_basis()];
        for (r, row) in table.chunks_exact(width).enumerate() {
            let weight = weights.map_or(1.0, |w| w[r]);
            for a in 0..width {
                for b in 0..=a {
                    bands[self.first[r] + a][a - b] += weight * row[a] * row[b];
                }
            }
        }
        bands
    }
}

/// Sites of a grid.
#[derive(Clone, Debug)]
pub struct GridSites {
    axes: [AxisRows; 2],
}

impl GridSites {
    /// Forms the basis rows along both axes, which are increasing and in the coordinates of the knots.
    pub fn new(knots: [Knots; 2], x: &[f64], y: &[f64]) -> GridSites {
        let [kx, ky] = knots;
        GridSites { axes: [AxisRows::new(kx, x), AxisRows::new(ky, y)] }
    }

    /// Basis rows along x and y.
    pub fn axes(&self) -> &[AxisRows; 2] {
        &self.axes
    }
}

impl Sites for GridSites {
    fn shape(&self) -> TensorShape {
        let [x, y] = &self.axes;
        TensorShape { basis: [x.knots.n_basis(), y.knots.n_basis()], degree: [x.knots.degree(), y.knots.degree()] }
    }

    fn len(&self) -> usize {
        self.axes[0].first.len() * self.axes[1].first.len()
    }

    fn grid_axes(&self) -> Option<[GridAxis<'_>; 2]> {
        Some(self.axes.each_ref().map(|axis| GridAxis {
            first: &axis.first,
            values: &axis.values,
            slopes: &axis.slopes,
            runs: &axis.runs,
            width: axis.knots.degree() + 1,
        }))
    }

    fn visit(&self, mut f: impl FnMut(&Site)) {
        let [ax, ay] = &self.axes;
        let width = self.shape().degree.map(|d| d + 1);
        let columns = ay.first.len();
        for x_run in &ax.runs {
            for y_run in &ay.runs {
                for i in x_run.clone() {
                    let x = i * width[0]..(i + 1) * width[0];
                    for j in y_run.clone() {
                        let y = j * width[1]..(j + 1) * width[1];
                        f(&Site {
                            index: i * columns + j,
                            first: [ax.first[i], ay.first[j]],
                            x: &ax.values[x.clone()],
                            dx: &ax.slopes[x.clone()],
                            y: &ay.values[y.clone()],
                            dy: &ay.slopes[y],
                        });
                    }
                }
            }
        }
    }
}
