//! The three rows that a touch at (x, y) would add to a fit, over the coefficients that are not zero there.
//!
//! ```text
//! height            w_z  N o M
//! normal (x, y)     w_n  U [N' o M; N o M']        U'U = J'J at the fitted slopes: as in the fit's own normal rows
//! slopes            w_s  [N' o M; N o M']
//! ```
//!
//! All rows are divided by their noise sd, so that each adds its square to the information. Patch coordinates.

use palpate_fitting::observation::linearise_normals;
use palpate_geometry::surface::HeightField;
use palpate_numeric::bspline::{Knots, MAX_DEGREE};

const WIDTH: usize = MAX_DEGREE + 1;

/// What a touch measures, each as one over its sd in the patch frame; 0: not measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sensor {
    /// Of a height.
    pub height: f64,
    /// Of a normal per tangent axis, 1/radian.
    pub normal: f64,
    /// Of a slope.
    pub slope: f64,
}

/// Rows of all candidates, one after the other: `3 x local` numbers each, and the knot cell that each lies in.
#[derive(Clone, Debug, Default)]
pub(super) struct CandidateRows {
    rows: Vec<f64>,
    cells: Vec<u32>,
    local: usize,
    /// Where the basis along x was evaluated last, and its values and derivatives: candidates often share their x.
    last: Option<(f64, usize, [f64; 2 * WIDTH])>,
}

impl CandidateRows {
    /// Writes the rows of the candidates at `places`, patch coordinates; memory is used again.
    pub(super) fn fill(&mut self, surface: &HeightField, sensor: Sensor, places: impl Iterator<Item = [f64; 2]>) {
        let knots = surface.knots();
        self.local = (knots[0].degree() + 1) * (knots[1].degree() + 1);
        self.rows.clear();
        self.cells.clear();
        // the knots may be others than those of the last call
        self.last = None;
        for place in places {
            self.add(surface, knots, sensor, place);
        }
    }

    fn add(&mut self, surface: &HeightField, knots: &[Knots; 2], sensor: Sensor, [x, y]: [f64; 2]) {
        let [p, q] = [knots[0].degree(), knots[1].degree()];
        let (segment_x, along) = match self.last {
            Some((at, segment, along)) if at == x => (segment, along),
            _ => {
                let (segment, mut along) = (knots[0].segment_of(x), [0.0; 2 * WIDTH]);
                knots[0].derivatives_on(segment, x, 1, &mut along[..2 * (p + 1)]);
                self.last = Some((x, segment, along));
                (segment, along)
            }
        };
        let segments = [segment_x, knots[1].segment_of(y)];
        let mut across = [0.0; 2 * WIDTH];
        knots[1].derivatives_on(segments[1], y, 1, &mut across[..2 * (q + 1)]);
        let first = [knots[0].first_basis(segments[0]), knots[1].first_basis(segments[1])];
        let start = self.rows.len();
        self.rows.resize(start + 3 * self.local, 0.0);
        let (height, slopes) = self.rows[start..].split_at_mut(self.local);
        let (along_x, along_y) = slopes.split_at_mut(self.local);
        let [mut zx, mut zy] = [0.0; 2];
        for a in 0..=p {
            for b in 0..=q {
                let at = a * (q + 1) + b;
                let c = surface.coefficients()[[first[0] + a, first[1] + b]];
                height[at] = along[a] * across[b];
                along_x[at] = along[p + 1 + a] * across[b];
                along_y[at] = along[a] * across[q + 1 + b];
                zx += c * along_x[at];
                zy += c * along_y[at];
            }
        }
        weigh(sensor, [zx, zy], height, along_x, along_y);
        self.cells.push((segments[0] * knots[1].n_segments() + segments[1]) as u32);
    }

    /// Number of candidates.
    pub(super) fn len(&self) -> usize {
        self.cells.len()
    }

    /// Numbers in one row.
    pub(super) fn local(&self) -> usize {
        self.local
    }

    /// The three rows of candidate `k`.
    pub(super) fn of(&self, k: usize) -> &[f64] {
        &self.rows[3 * self.local * k..3 * self.local * (k + 1)]
    }

    /// The knot cell of candidate `k`.
    pub(super) fn cell(&self, k: usize) -> usize {
        self.cells[k] as usize
    }
}

/// Divides the rows by their sds, those of a normal through the triangle U at the fitted slopes.
fn weigh(sensor: Sensor, [zx, zy]: [f64; 2], height: &mut [f64], along_x: &mut [f64], along_y: &mut [f64]) {
    let (a, b, d) = if sensor.normal > 0.0 {
        // the target does not enter, so any normal will do
        let (u, _) = linearise_normals([0.0, 0.0, 1.0], zx, zy);
        (sensor.normal * u.a, sensor.normal * u.b, sensor.normal * u.d)
    } else {
        (sensor.slope, 0.0, sensor.slope)
    };
    for ((height, along_x), along_y) in height.iter_mut().zip(along_x).zip(along_y) {
        *height *= sensor.height;
        *along_x = a * *along_x + b * *along_y;
        *along_y *= d;
    }
}
