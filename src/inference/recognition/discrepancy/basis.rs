//! The basis functions of a displacement at a point of the chart.
//!
//! ```text
//! N_i(u) N_j(v)  and their derivatives: jet (f, f_u, f_v, f_uu, f_uv, f_vv)        degree 4: five each way do not vanish
//! u = c u2 - s v2,   v = s u2 + c v2                                              axes rotated by an angle
//! ```

use palpate_geometry::primitives::NormalJet;
use palpate_numeric::bspline::Knots;
use palpate_numeric::simd::ChartBasis;

/// Degree of the splines.
pub(super) const DEGREE: usize = 4;

/// Basis functions each way that do not vanish at a point.
pub(super) const WIDTH: usize = DEGREE + 1;

/// The 25 basis functions at one chart point with their derivatives.
#[derive(Clone, Debug)]
pub(crate) struct JetRow {
    first: [usize; 2],
    values: [[[f64; WIDTH]; 3]; 2],
    across: usize,
}

impl JetRow {
    pub(super) fn new(knots: &[Knots; 2], place: [f64; 2]) -> JetRow {
        let mut made = JetRow { first: [0; 2], values: [[[0.0; WIDTH]; 3]; 2], across: knots[1].n_basis() };
        for side in 0..2 {
            // outside of the box the displacement keeps its value at the edge: nothing supports it there
            let [lo, hi] = ends(&knots[side]);
            let mut flat = [0.0; 3 * WIDTH];
            made.first[side] = knots[side].derivatives(place[side].clamp(lo, hi), 2, &mut flat);
            for k in 0..3 {
                made.values[side][k].copy_from_slice(&flat[k * WIDTH..(k + 1) * WIDTH]);
            }
        }
        made
    }

    /// The same for the kernel that looks at many surfaces at once.
    pub(super) fn basis(&self, chart: [f64; 2]) -> ChartBasis<'_> {
        ChartBasis { chart, first: self.first, across: self.across, values: &self.values }
    }

    /// Number of the coefficient of the a-th and b-th basis function that do not vanish here.
    pub(super) fn coefficient(&self, a: usize, b: usize) -> usize {
        (self.first[0] + a) * self.across + self.first[1] + b
    }

    /// The jet of that basis function alone.
    pub(super) fn jet_of(&self, a: usize, b: usize) -> NormalJet {
        let [us, vs] = &self.values;
        [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)].map(|(u, v)| us[u][a] * vs[v][b])
    }

    /// f, f_u, f_v, f_uu, f_uv, f_vv of the displacement with these coefficients.
    pub(super) fn jet(&self, coefficients: &[f64]) -> NormalJet {
        let mut out = [0.0; 6];
        let [us, vs] = &self.values;
        for a in 0..WIDTH {
            let start = self.coefficient(a, 0);
            let row = &coefficients[start..start + WIDTH];
            let along_v = [0, 1, 2].map(|k| row.iter().zip(&vs[k]).map(|(c, b)| c * b).sum::<f64>());
            out[0] += us[0][a] * along_v[0];
            out[1] += us[1][a] * along_v[0];
            out[2] += us[0][a] * along_v[1];
            out[3] += us[2][a] * along_v[0];
            out[4] += us[1][a] * along_v[1];
            out[5] += us[0][a] * along_v[2];
        }
        out
    }
}

/// A jet in axes rotated by an angle: `u = c u2 - s v2`, `v = s u2 + c v2`.
pub(super) fn turned(jet: &NormalJet, c: f64, s: f64) -> NormalJet {
    let [f, fu, fv, fuu, fuv, fvv] = *jet;
    [
        f,
        c * fu + s * fv,
        c * fv - s * fu,
        c * c * fuu + 2.0 * c * s * fuv + s * s * fvv,
        (c * c - s * s) * fuv + c * s * (fvv - fuu),
        s * s * fuu - 2.0 * c * s * fuv + c * c * fvv,
    ]
}

pub(super) fn ends(knots: &Knots) -> [f64; 2] {
    let t = knots.as_slice();
    [t[0], t[t.len() - 1]]
}
