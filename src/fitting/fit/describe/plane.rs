//! Rows of the best plane `h + gx x + gy y` under the weights of a fit, and what it leaves of them.
//!
//! ```text
//! E_3 = [ wz  wz x  wz y ;  0  a  b ;  0  0  d ]      few sites: QR with pivots
//! many: (D E_3'E_3 D) c = D E_3'b about the weighted centre, refined from the rows      three columns, nothing held
//! ```

use crate::fit::linear::equations::Equations;
use crate::fit::noise::fingers::Fingers;
use crate::fit::placing::sites::DataSites;
use palpate_numeric::linalg::{Sites, dot};
use palpate_numeric::solve::PivotedQr;

/// Unit roundoff 2^-53.
const UNIT: f64 = 0.5 * f64::EPSILON;
/// From this many sites on the rows are not written out, because their QR takes longer than the fit, and three dense
/// columns of a million contacts take 72 MB.
const MANY: usize = 500;
/// Squared pivots of the equilibrated 3 x 3 matrix below this leave too few digits for refinement; then the rows are written
/// out after all.
const POOR: f64 = 1e-8;

/// After a refinement step of this share the next would be below the last bit.
const GAINED: f64 = 1e-9;

/// What the best plane leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneFit {
    /// Sum of squares of the weighted residual rows.
    pub squares: f64,
    /// Whether every residual is within the rounding of its own terms and of the heights as given. Such data are a plane,
    /// although an F ratio of two roundings may be large.
    pub is_rounding: bool,
    /// Height and tilts; of many sites about their centre.
    coefficients: [f64; 3],
}

/// Sums over rows `(target, terms, height of the data)`.
#[derive(Debug)]
struct Tally {
    squares: f64,
    is_rounding: bool,
}

impl Tally {
    fn add(&mut self, target: f64, terms: [f64; 3], height: f64) {
        let residual = target - terms.iter().sum::<f64>();
        let size = target.abs() + terms.iter().map(|t| t.abs()).sum::<f64>();
        self.squares += residual * residual;
        self.is_rounding &= residual.abs() <= 8.0 * UNIT * (size + height);
    }

    fn done(self, coefficients: [f64; 3]) -> PlaneFit {
        PlaneFit { squares: self.squares, is_rounding: self.is_rounding, coefficients }
    }
}

/// The least squares plane under the fit's weights; with normal rows these are the weights linearised about the fitted
/// surface. `largest` is the largest magnitude of a height in patch units.
pub(super) fn plane_rows(equations: &Equations, largest: f64) -> Option<PlaneFit> {
    if equations.sites.len() >= MANY
        && let Some(plane) = of_many(equations, largest)
    {
        return Some(plane);
    }
    of_few(equations, largest)
}

/// What the best plane leaves when the squares of height and of slope rows get factors of their own.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlaneBlocks {
    squares: [f64; 2],
    right: [[f64; 3]; 2],
    gram: [[[f64; 3]; 3]; 2],
}

impl PlaneBlocks {
    /// About the fitted plane, so that the sums of squares do not cancel; `shared` are fingers whose touches share errors,
    /// and the correlations of neighbouring heights and slopes.
    pub(super) fn new(equations: &Equations, plane: &PlaneFit, shared: Option<(&Fingers, [f64; 2])>) -> PlaneBlocks {
        let mut places = Rows::new(equations);
        if equations.sites.len() >= MANY {
            places.centre();
        }
        let mut rows: [Vec<[f64; 4]>; 3] = Default::default();
        let mut at = 0;
        places.each(|_, row, target| {
            let residual = target - (0..3).map(|k| row[k] * plane.coefficients[k]).sum::<f64>();
            rows[at % 3].push([row[0], row[1], row[2], residual]);
            at += 1;
        });
        let mut blocks = PlaneBlocks::default();
        for (k, rows) in rows.iter_mut().enumerate() {
            let b = usize::from(k > 0);
            if let Some((fingers, correlations)) = shared
                && correlations[b] > 0.0
            {
                fingers.whiten(correlations[b], rows);
            }
            for row in rows {
                let residual = row[3];
                blocks.squares[b] += residual * residual;
                (0..3).for_each(|i| blocks.right[b][i] += row[i] * residual);
                (0..3).for_each(|i| (0..3).for_each(|j| blocks.gram[b][i][j] += row[i] * row[j]));
            }
        }
        blocks
    }

    /// Sum of squares under these factors; `None` where the plane is not determined.
    pub(super) fn left(&self, factors: [f64; 2]) -> Option<f64> {
        let both = |of: &dyn Fn(usize) -> f64| factors[0] * of(0) + factors[1] * of(1);
        let gram = [0, 1, 2].map(|i| [0, 1, 2].map(|j| both(&|b| self.gram[b][i][j])));
        let right = [0, 1, 2].map(|i| both(&|b| self.right[b][i]));
        let c = equilibrated_cholesky(gram)?(right);
        Some(both(&|b| self.squares[b]) - (0..3).map(|k| c[k] * right[k]).sum::<f64>())
    }
}

/// The columns are written from the sites' places, so that the slope rows of the constant are exactly zero: a column of
/// rounding errors would be fitted like any other.
fn of_few(equations: &Equations, largest: f64) -> Option<PlaneFit> {
    let rows = Rows::new(equations);
    let count = 3 * equations.sites.len();
    let mut values = vec![0.0; 3 * count];
    let mut rhs = Vec::with_capacity(count);
    rows.each(|_, row, target| {
        (0..3).for_each(|k| values[k * count + rhs.len()] = row[k]);
        rhs.push(target);
    });
    let c = PivotedQr::of_dense(count, 3, &values, &rhs).ok()?.coefficients();
    Some(rows.tally([c[0], c[1], c[2]], largest))
}

/// The three rows of every site, about the origin or the centre: `[[wz, wz u, wz v], [0, a, b], [0, 0, d]]`.
struct Rows<'a> {
    equations: &'a Equations,
    places: Vec<[f64; 2]>,
}

impl Rows<'_> {
    fn new(equations: &Equations) -> Rows<'_> {
        if let DataSites::Scattered(scattered) = &equations.sites
            && scattered.len() >= MANY
        {
            return Rows { equations, places: scattered.points().to_vec() };
        }
        let knots = equations.sites.knots();
        let (gx, gy) = (knots[0].greville(), knots[1].greville());
        let mut places = vec![[0.0; 2]; equations.sites.len()];
        equations.sites.visit(|site| {
            places[site.index] = [dot(&gx[site.first[0]..], site.x), dot(&gy[site.first[1]..], site.y)];
        });
        Rows { equations, places }
    }

    /// About the weighted centre of the heights.
    fn centre(&mut self) {
        let square = |r: usize| self.equations.row_weights.at(r).z.powi(2);
        let (mut total, mut sum) = (0.0, [0.0; 2]);
        for (r, place) in self.places.iter().enumerate() {
            total += square(r);
            (0..2).for_each(|k| sum[k] += square(r) * place[k]);
        }
        if total > 0.0 && total.is_finite() {
            let middle = sum.map(|s| s / total);
            self.places.iter_mut().for_each(|p| (0..2).for_each(|k| p[k] -= middle[k]));
        }
    }

    fn at(&self, r: usize) -> [[f64; 3]; 3] {
        let (m, [u, v]) = (self.equations.row_weights.at(r), self.places[r]);
        [[m.z, m.z * u, m.z * v], [0.0, m.a, m.b], [0.0, 0.0, m.d]]
    }

    fn tally(&self, c: [f64; 3], largest: f64) -> PlaneFit {
        let mut tally = Tally { squares: 0.0, is_rounding: true };
        self.each(|r, row, target| {
            // only the height row has a first entry
            let height = if row[0] == 0.0 { 0.0 } else { self.equations.row_weights.at(r).z * largest };
            tally.add(target, [0, 1, 2].map(|k| c[k] * row[k]), height);
        });
        tally.done(c)
    }

    fn each(&self, mut f: impl FnMut(usize, &[f64; 3], f64)) {
        for r in 0..self.places.len() {
            for (row, target) in self.at(r).iter().zip(self.equations.targets[r]) {
                f(r, row, target);
            }
        }
    }
}

fn of_many(equations: &Equations, largest: f64) -> Option<PlaneFit> {
    let mut rows = Rows::new(equations);
    rows.centre();
    let (mut gram, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    rows.each(|_, row, target| {
        (0..3).for_each(|i| (0..=i).for_each(|j| gram[i][j] += row[i] * row[j]));
        (0..3).for_each(|k| right[k] += row[k] * target);
    });
    let solve = equilibrated_cholesky(gram)?;
    let size = |v: [f64; 3]| v.into_iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let mut c = solve(right);
    // a second step only where the first has not gained all digits
    for _ in 0..2 {
        let mut right = [0.0; 3];
        rows.each(|_, row, target| {
            let residual = target - (0..3).map(|k| row[k] * c[k]).sum::<f64>();
            (0..3).for_each(|k| right[k] += row[k] * residual);
        });
        let step = solve(right);
        (0..3).for_each(|k| c[k] += step[k]);
        if size(step) <= GAINED * size(c) {
            break;
        }
    }
    Some(rows.tally(c, largest))
}

/// `v -> (E_3'E_3)^-1 v`; an empty column's unknown stays zero. `None` where a pivot is poor.
pub(super) fn equilibrated_cholesky(gram: [[f64; 3]; 3]) -> Option<impl Fn([f64; 3]) -> [f64; 3]> {
    let scale = [0, 1, 2].map(|k: usize| if gram[k][k] > 0.0 { 1.0 / gram[k][k].sqrt() } else { 0.0 });
    let mut l = [[0.0_f64; 3]; 3];
    for i in 0..3 {
        for j in 0..=i {
            let a = if i == j && scale[i] == 0.0 { 1.0 } else { gram[i][j] * scale[i] * scale[j] };
            let rest = a - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            if i == j && (rest.is_nan() || rest < POOR) {
                return None;
            }
            l[i][j] = if i == j { rest.sqrt() } else { rest / l[j][j] };
        }
    }
    Some(move |v: [f64; 3]| {
        let mut x = [0, 1, 2].map(|k| v[k] * scale[k]);
        for i in 0..3 {
            x[i] = (x[i] - (0..i).map(|k| l[i][k] * x[k]).sum::<f64>()) / l[i][i];
        }
        for i in (0..3).rev() {
            x[i] = (x[i] - (i + 1..3).map(|k| l[k][i] * x[k]).sum::<f64>()) / l[i][i];
        }
        [0, 1, 2].map(|k| x[k] * scale[k])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observation::ScatteredSites;
    use palpate_numeric::bspline::Knots;
    use palpate_numeric::linalg::{RowWeights, SiteWeights};

    fn equations(row_weights: impl Fn(usize) -> SiteWeights, data: impl Fn([f64; 2]) -> [f64; 3]) -> Equations {
        let knots = [Knots::uniform(3, 4, -1.0, 1.0).unwrap(), Knots::uniform(2, 3, -0.5, 1.5).unwrap()];
        let points: Vec<[f64; 2]> = (0..900)
            .map(|r| [(r as f64 * 0.754_877_666).fract() * 2.0 - 1.0, (r as f64 * 0.569_840_291).fract() * 2.0 - 0.5])
            .collect();
        let site_weights: Vec<SiteWeights> = (0..points.len()).map(row_weights).collect();
        let targets = points
            .iter()
            .zip(&site_weights)
            .map(|(p, m)| {
                let [z, zx, zy] = data(*p);
                [m.z * z, m.a * zx + m.b * zy, m.d * zy]
            })
            .collect();
        let sites = DataSites::Scattered(ScatteredSites::new(knots, points));
        Equations::new(sites, RowWeights::PerSite(site_weights), targets, None)
    }

    #[test]
    fn the_short_way_and_the_dense_one_agree() {
        let bent = |[x, y]: [f64; 2]| [3.0 + 2.0 * x - y + 0.1 * x * x, 2.0 + 0.2 * x, -1.0];
        let flat = |[x, y]: [f64; 2]| [3.0 + 2.0 * x - y, 2.0, -1.0];
        let varied = |r: usize| {
            let w = 1.0 + 0.5 * (r as f64).sin();
            SiteWeights { z: w, a: 0.5 * w, b: 0.2 * (r as f64).cos(), d: 2.0 - w }
        };
        for blocks in [[1.0, 1.0], [1e6, 1.0], [1.0, 1e6], [0.0, 1.0], [1.0, 0.0]] {
            let row_weights = |r: usize| {
                let m = varied(r);
                SiteWeights { z: m.z * blocks[0], a: m.a * blocks[1], b: m.b * blocks[1], d: m.d * blocks[1] }
            };
            let curved = equations(row_weights, bent);
            let (few, many) = (of_few(&curved, 6.0).unwrap(), of_many(&curved, 6.0).unwrap());
            assert!((many.squares / few.squares - 1.0).abs() < 1e-9, "{blocks:?}: {many:?} {few:?}");
            assert!(!few.is_rounding && !many.is_rounding);
            // 2700 rows cost the QR a few digits more than the refined short way
            let plane = of_many(&equations(row_weights, flat), 6.0).unwrap();
            assert!(plane.is_rounding, "{blocks:?}: {plane:?}");
        }
    }
}
