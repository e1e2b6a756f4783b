//! Replicates of a small fit whose sites are the same in all of them: one factor serves every replicate.
//!
//! ```text
//! c = c0 + P n       P = A^-1 E'W diag(sigma)   (unknowns x 3 g),   n standard normals, three per contact
//! S_b = mean_g S(c_b),  R_b = mean_g R(c_b)
//! ```
//!
//! Only heights and slopes are noisy here; effects that move a site, drop a contact or rotate a normal need the whole
//! fit. The draws of replicate b are those of the effect [`ROW_NOISE`] at (seed, contact, b) in every block.

use palpate_fitting::plans::{PlanError, SlopeColumns, SlopePlan, check_noise_sds, check_shape_grid};
use palpate_geometry::surface::pieces_of;
use palpate_numeric::bspline::Knots;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::simd::{
    CHACHA_BLOCKS, CHACHA_WORDS, GridTables, Isa, REPLICATES, add_draws, chacha8, gaussian_triples, mean_shapes,
};

/// Name of the effect that the draws belong to.
pub const ROW_NOISE: &str = "row_noise";

/// Everything that all replicates share: the sites, the factor and the shape grid.
///
/// ```
/// # use palpate_studies::facade as palpate;
/// use palpate::spline::Knots;
/// use palpate::montecarlo::FixedSites;
/// use palpate::plans::SlopeColumns;
///
/// // z = x^2/2 at nine sites; how do mean S and mean R vary with noise of sd 0.01 and 0.02?
/// let axis = Knots::uniform(2, 1, -1.0, 1.0)?;
/// let x: Vec<f64> = (0..9).map(|r| (r / 3) as f64 - 1.0).collect();
/// let y: Vec<f64> = (0..9).map(|r| (r % 3) as f64 - 1.0).collect();
/// let z: Vec<f64> = x.iter().map(|x| 0.5 * x * x).collect();
/// let contacts = SlopeColumns { x: &x, y: &y, z: &z, zx: &x, zy: &[0.0; 9] };
/// let points = [-0.5, -0.2, 0.2, 0.5];
/// let knots = [axis.clone(), axis];
/// let sites = FixedSites::new(&knots, &contacts, [1.0; 3], [0.01, 0.02, 0.02], [&points, &points])?;
/// let (mut s, mut r) = ([0.0; 100], [0.0; 100]);
/// sites.replicates(2026, 0, &mut s, &mut r);
/// assert!(s.iter().all(|s| (s + 0.5).abs() < 0.2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FixedSites {
    degree: [usize; 2],
    /// Coefficients of the noise-free data.
    nominal: Vec<f64>,
    /// `noise[contact][unknown]`: P, three numbers a contact.
    noise: Vec<Vec<[f64; 3]>>,
    grid: GridTables,
}

impl FixedSites {
    /// Prepares the sites `contacts` with noise-free data, the block weights `[wz, wx, wy]`, the noise sds
    /// `[heights, x slopes, y slopes]` and the points of the shape grid.
    ///
    /// # Errors
    /// As [`SlopePlan::fit`]; [`PlanError::Degree`] for degrees other than 2 x 2 and 3 x 3; [`PlanError::NoiseSd`] for an
    /// sd that is negative or not finite; [`PlanError::EmptyGrid`], [`PlanError::Axis`].
    pub fn new(
        knots: &[Knots; 2],
        contacts: &SlopeColumns<'_>,
        weights: [f64; 3],
        sigma: [f64; 3],
        grid: [&[f64]; 2],
    ) -> Result<FixedSites, PlanError> {
        let degree = [knots[0].degree(), knots[1].degree()];
        if degree[0] != degree[1] || degree[0] < 2 {
            return Err(PlanError::Degree { degree, allowed: "replicates are made for degrees 2 x 2 and 3 x 3" });
        }
        check_noise_sds(sigma, true)?;
        check_shape_grid(grid)?;
        let mut plan = SlopePlan::new(knots.clone(), weights)?;
        let nominal = plan.fit(contacts)?.to_vec();
        let columns = knots[1].n_basis();
        let noise = (0..contacts.x.len())
            .map(|r| {
                let (bx, by) = (knots[0].basis(contacts.x[r]), knots[1].basis(contacts.y[r]));
                let mut response = vec![[0.0; 3]; nominal.len()];
                for (k, [dx, dy]) in [[0, 0], [1, 0], [0, 1]].into_iter().enumerate() {
                    let mut row = vec![0.0; nominal.len()];
                    for (a, n) in bx.derivative(dx).iter().enumerate() {
                        for (b, m) in by.derivative(dy).iter().enumerate() {
                            let unknown = (bx.first + a) * columns + by.first + b;
                            row[unknown] = weights[k] * weights[k] * sigma[k] * n * m;
                        }
                    }
                    plan.factor().solve(&mut row);
                    response.iter_mut().zip(row).for_each(|(p, v)| p[k] = v);
                }
                response
            })
            .collect();
        Ok(FixedSites { degree, nominal, noise, grid: tables(knots, grid) })
    }

    /// Mean S and mean R over the grid of the replicates `first ..`, as many as both arrays have room for.
    ///
    /// The threads of the current pool share the blocks of [`REPLICATES`] replicates; a replicate's numbers depend on the seed
    /// and its own number alone. S is NaN where a replicate is flat at every point.
    pub fn replicates(&self, seed: u64, first: u64, shape_index: &mut [f64], curvedness: &mut [f64]) {
        let key = EffectDraws::new(seed, ROW_NOISE).key();
        let count = shape_index.len().min(curvedness.len());
        self.range(&key, first, &mut shape_index[..count], &mut curvedness[..count]);
    }

    fn range(&self, key: &[u32; 8], first: u64, s: &mut [f64], r: &mut [f64]) {
        // 64 blocks are about a millisecond of work
        const TASK: usize = 64 * REPLICATES;
        if first % 2 == 1 && !s.is_empty() {
            // an odd replicate is the second half of a ChaCha block, so both are made and the even one is dropped
            let (mut pair_s, mut pair_r) = ([0.0; 2], [0.0; 2]);
            self.range(key, first - 1, &mut pair_s, &mut pair_r);
            (s[0], r[0]) = (pair_s[1], pair_r[1]);
            self.range(key, first + 1, &mut s[1..], &mut r[1..]);
            return;
        }
        if s.len() > TASK {
            let half = (s.len() / 2).next_multiple_of(REPLICATES);
            let (s_a, s_b) = s.split_at_mut(half);
            let (r_a, r_b) = r.split_at_mut(half);
            palpate_numeric::threads::join(
                || self.range(key, first, s_a, r_a),
                || self.range(key, first + half as u64, s_b, r_b),
            );
            return;
        }
        let mut coefficients = vec![[0.0; REPLICATES]; self.nominal.len()];
        for (k, (s, r)) in s.chunks_mut(REPLICATES).zip(r.chunks_mut(REPLICATES)).enumerate() {
            self.block(key, first + (k * REPLICATES) as u64, &mut coefficients, s, r);
        }
    }

    /// One block of replicates, the first of them even. Lane `16 p + l` is replicate `first + 2 l + p`, since a ChaCha
    /// block feeds two replicates.
    fn block(&self, key: &[u32; 8], first: u64, c: &mut [[f64; REPLICATES]], s: &mut [f64], r: &mut [f64]) {
        let isa = Isa::active();
        for (lanes, value) in c.iter_mut().zip(&self.nominal) {
            *lanes = [*value; REPLICATES];
        }
        let mut words = [[0_u64; CHACHA_BLOCKS]; CHACHA_WORDS];
        let mut drawn = [[0.0; REPLICATES]; 3];
        for (contact, weights) in self.noise.iter().enumerate() {
            chacha8(isa, key, contact as u64, first / 2, &mut words);
            gaussian_triples(isa, &words, &mut drawn);
            add_draws(isa, weights, &drawn, c);
        }
        let (mut means, mut curved) = ([0.0; REPLICATES], [0.0; REPLICATES]);
        mean_shapes(isa, self.degree, &self.grid, c, &mut means, &mut curved);
        for (k, (s, r)) in s.iter_mut().zip(r.iter_mut()).enumerate() {
            let lane = k % 2 * CHACHA_BLOCKS + k / 2;
            (*s, *r) = (means[lane], curved[lane]);
        }
    }
}

pub(super) fn tables(knots: &[Knots; 2], points: [&[f64]; 2]) -> GridTables {
    let mut made = GridTables { first_x: Vec::new(), x: Default::default(), y: pieces_of(&knots[1], points[1]) };
    for &value in points[0] {
        let row = knots[0].basis(value);
        made.first_x.push(row.first);
        for (d, values) in made.x.iter_mut().enumerate() {
            values.extend_from_slice(row.derivative(d));
        }
    }
    made
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;
    use palpate_geometry::surface::HeightField;
    use palpate_numeric::bspline::linspace;

    type Columns = [Vec<f64>; 5];

    fn cylinder() -> Columns {
        let mut out: Columns = Default::default();
        for r in 0..36 {
            let (x, y) = ((r / 12) as f64 * 4.0 - 4.0, (r % 12) as f64 * 0.7 - 3.9);
            let u = 0.5 * x - 0.866 * y;
            let depth = (43.56 - u * u).sqrt();
            for (column, v) in out.iter_mut().zip([x, y, depth - 6.6, -0.5 * u / depth, 0.866 * u / depth]) {
                column.push(v);
            }
        }
        out
    }

    fn columns(c: &Columns) -> SlopeColumns<'_> {
        SlopeColumns { x: &c[0], y: &c[1], z: &c[2], zx: &c[3], zy: &c[4] }
    }

    /// Every replicate against the plain route: draws by address, data, fit, shape at every point.
    #[test]
    fn a_replicate_is_the_fit_of_its_own_data() {
        let knots = [Knots::uniform(2, 1, -4.5, 4.5).unwrap(), Knots::uniform(2, 1, -4.5, 4.5).unwrap()];
        let (data, points) = (cylinder(), linspace(-3.5, 3.5, 8));
        let (weights, sigma) = ([1.0, 2.0, 2.0], [0.02, 0.05, 0.05]);
        let sites = FixedSites::new(&knots, &columns(&data), weights, sigma, [&points, &points]).unwrap();
        let (mut s, mut r) = (vec![0.0; 50], vec![0.0; 50]);
        sites.replicates(7, 100, &mut s, &mut r);
        let mut plan = SlopePlan::new(knots.clone(), weights).unwrap();
        let draws = EffectDraws::new(7, ROW_NOISE);
        for k in 0..50 {
            let mut noisy = data.clone();
            for contact in 0..36 {
                let mut n = [0.0; 3];
                draws.gaussians(contact as u64, 100 + k as u64, 3, &mut n);
                for c in 0..3 {
                    noisy[2 + c][contact] += sigma[c] * n[c];
                }
            }
            let c = plan.fit(&columns(&noisy)).unwrap().to_vec();
            let surface = HeightField::new(knots.clone(), Array2::from_shape_vec((3, 3), c).unwrap()).unwrap();
            let (mut mean_s, mut mean_r) = (0.0, 0.0);
            for x in &points {
                for y in &points {
                    let shape = surface.at(*x, *y).derivatives().principal().unwrap();
                    mean_s += shape.shape_index().unwrap() / 64.0;
                    mean_r += shape.curvedness() / 64.0;
                }
            }
            assert!((s[k] - mean_s).abs() < 1e-12 && (r[k] - mean_r).abs() < 1e-13, "replicate {k}");
        }
    }

    #[test]
    fn any_split_and_any_number_of_threads_give_the_same_bits() {
        let knots = [Knots::uniform(2, 1, -4.5, 4.5).unwrap(), Knots::uniform(2, 1, -4.5, 4.5).unwrap()];
        let (data, points) = (cylinder(), linspace(-3.5, 3.5, 4));
        let sites = FixedSites::new(&knots, &columns(&data), [1.0; 3], [0.02; 3], [&points, &points]).unwrap();
        let run = |threads: usize, first: u64, count: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (mut s, mut r) = (vec![0.0; count], vec![0.0; count]);
            pool.install(|| sites.replicates(1, first, &mut s, &mut r));
            (s, r)
        };
        let whole = run(1, 0, 5000);
        assert_eq!(run(2, 0, 5000), whole);
        for (first, count) in [(64, 32), (4999, 1), (33, 70), (1001, 31)] {
            let part = run(1, first as u64, count);
            assert_eq!(part.0, whole.0[first..first + count]);
            assert_eq!(part.1, whole.1[first..first + count]);
        }
    }

    #[test]
    fn faulty_noise_and_contacts_are_named() {
        let axis = || Knots::uniform(2, 1, -4.5, 4.5).unwrap();
        let (data, points) = (cylinder(), linspace(-3.5, 3.5, 4));
        let make = |data: &Columns, sigma: [f64; 3], points: &[f64]| {
            FixedSites::new(&[axis(), axis()], &columns(data), [1.0; 3], sigma, [points, points]).map(|_| ())
        };
        for sd in [-1.0, f64::NAN, f64::INFINITY] {
            let found = make(&data, [0.02, sd, 0.02], &points);
            assert!(matches!(found, Err(PlanError::NoiseSd { block: "x slopes", .. })), "{found:?}");
        }
        assert!(matches!(make(&data, [0.02; 3], &[]), Err(PlanError::EmptyGrid { axis: "x" })));
        let mut bad = data.clone();
        bad[2][3] = f64::NAN;
        assert!(matches!(make(&bad, [0.02; 3], &points), Err(PlanError::NotFinite { column: "z", index: 3, .. })));
        assert_eq!(make(&data, [0.0; 3], &points), Ok(()));
    }
}
