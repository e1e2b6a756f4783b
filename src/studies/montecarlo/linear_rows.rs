//! Replicates whose sites stand still: one factor, then data -> coefficients -> S, R, eight or more replicates at once.
//!
//! ```text
//! c = c0 + H (t - t0)        H = A^-1 E'W    (unknowns x 3 contacts),   t the weighted targets of a replicate
//! slope rows   t = (wz z, wx zx, wy zy)                       linear as they are
//! normal rows  t = (wz z, w U(p, q) + w U'^-1 J'n)            linearised at the nominal surface's slopes p, q
//! ```
//!
//! Where row noise is all there is, its draws go straight from the generator's lanes to the coefficients, as in
//! [`super::FixedSites`]: the two routes agree to rounding.

use super::problem::{Problem, Rows};
use palpate_fitting::fit::FitError;
use palpate_fitting::observation::linearise_normals;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::linalg::{SiteWeights, Sites};
use palpate_numeric::simd::{CHACHA_BLOCKS, CHACHA_WORDS, Isa, REPLICATES, add_draws, chacha8, gaussian_triples};
use palpate_world::scene::ContactBatch;

/// H with what it is applied to.
#[derive(Clone, Debug)]
pub(super) struct LinearRows {
    nominal: Vec<f64>,
    /// `response[contact][unknown]`, three targets a contact.
    response: Vec<Vec<[f64; 3]>>,
    /// `H diag(weight sigma)` of row noise, where that is the only effect.
    of_draws: Option<Vec<Vec<[f64; 3]>>>,
    targets: Vec<[f64; 3]>,
    places: Vec<Place>,
}

/// What makes targets from the data of one contact.
#[derive(Clone, Copy, Debug)]
struct Place {
    weights: SiteWeights,
    slopes: [f64; 2],
}

impl LinearRows {
    /// One factor of the nominal problem; `row_noise` are the sds of z and of the slopes where that is the only effect.
    pub(super) fn new(problem: &Problem, row_noise: Option<[f64; 2]>) -> Result<LinearRows, FitError> {
        let (sites, row_weights, factor, nominal) = problem.factored()?;
        let columns = sites.shape().basis[1];
        let unknowns = nominal.len();
        let mut response = vec![Vec::new(); sites.len()];
        sites.visit(|site| {
            let m = row_weights.at(site.index);
            let mut own = vec![[0.0; 3]; unknowns];
            for k in 0..3 {
                let mut row = vec![0.0; unknowns];
                for a in 0..site.x.len() {
                    for b in 0..site.y.len() {
                        let (value, along, across) =
                            (site.x[a] * site.y[b], site.dx[a] * site.y[b], site.x[a] * site.dy[b]);
                        row[(site.first[0] + a) * columns + site.first[1] + b] =
                            [m.z * value, m.a * along + m.b * across, m.d * across][k];
                    }
                }
                factor.solve(&mut row);
                own.iter_mut().zip(row).for_each(|(p, v)| p[k] = v);
            }
            response[site.index] = own;
        });
        let of_draws = row_noise.map(|[z, slope]| {
            let scaled = |(r, own): (usize, &Vec<[f64; 3]>)| {
                let m = row_weights.at(r);
                let by = [m.z * z / problem.scale(), m.a * slope, m.d * slope];
                own.iter().map(|p| [p[0] * by[0], p[1] * by[1], p[2] * by[2]]).collect()
            };
            response.iter().enumerate().map(scaled).collect()
        });
        let places = (0..sites.len()).map(|r| Place { weights: row_weights.at(r), slopes: problem.slopes_at(r) });
        let mut made = LinearRows { nominal, response, of_draws, targets: Vec::new(), places: places.collect() };
        made.targets = (0..sites.len()).map(|r| made.target(problem, r, problem.point(r), problem.normal(r))).collect();
        Ok(made)
    }

    /// Coefficients without noise.
    pub(super) fn nominal(&self) -> &[f64] {
        &self.nominal
    }

    #[inline]
    fn target(&self, problem: &Problem, r: usize, point: [f64; 3], normal: [f64; 3]) -> [f64; 3] {
        let Place { weights: m, slopes: [p, q] } = self.places[r];
        let z = m.z * problem.local_height(point[2]);
        match problem.rows() {
            Rows::Slopes(_) => [z, -m.a * normal[0] / normal[2], -m.d * normal[1] / normal[2]],
            Rows::Normals { weight, .. } => {
                let (_, [first, second]) = linearise_normals(normal, p, q);
                [z, weight * first, weight * second]
            }
        }
    }

    /// Coefficients of the replicates of a simulated block of [`REPLICATES`] lanes.
    pub(super) fn coefficients(&self, isa: Isa, problem: &Problem, batch: &ContactBatch, c: &mut [[f64; REPLICATES]]) {
        for (lanes, value) in c.iter_mut().zip(&self.nominal) {
            *lanes = [*value; REPLICATES];
        }
        let mut off = [[0.0; REPLICATES]; 3];
        for (r, (weights, nominal)) in self.response.iter().zip(&self.targets).enumerate() {
            let entries = r * REPLICATES..(r + 1) * REPLICATES;
            let data = batch.points[entries.clone()].iter().zip(&batch.normals[entries]);
            for (lane, (point, normal)) in data.enumerate() {
                let target = self.target(problem, r, *point, *normal);
                (0..3).for_each(|k| off[k][lane] = target[k] - nominal[k]);
            }
            add_draws(isa, weights, &off, c);
        }
    }

    /// What a standard normal draw does to each coefficient, `[contact][unknown]`, where row noise is the only effect.
    pub(super) fn of_draws(&self) -> Option<&Vec<Vec<[f64; 3]>>> {
        self.of_draws.as_ref()
    }

    /// Whether draws go to coefficients without contacts in between.
    pub(super) fn is_direct(&self) -> bool {
        self.of_draws.is_some()
    }

    /// The same for replicates `first ..` of row noise, `first` even; lanes come in the order of [`direct_lane`].
    pub(super) fn direct(&self, isa: Isa, draws: &EffectDraws, first: u64, c: &mut [[f64; REPLICATES]]) {
        let Some(response) = &self.of_draws else { return };
        for (lanes, value) in c.iter_mut().zip(&self.nominal) {
            *lanes = [*value; REPLICATES];
        }
        let key = draws.key();
        let mut words = [[0_u64; CHACHA_BLOCKS]; CHACHA_WORDS];
        let mut drawn = [[0.0; REPLICATES]; 3];
        for (contact, weights) in response.iter().enumerate() {
            chacha8(isa, &key, contact as u64, first / 2, &mut words);
            gaussian_triples(isa, &words, &mut drawn);
            add_draws(isa, weights, &drawn, c);
        }
    }
}

/// The lane in which the `k`-th replicate of a direct block stands: a block of the generator feeds two replicates.
pub(super) fn direct_lane(k: usize) -> usize {
    k % 2 * CHACHA_BLOCKS + k / 2
}
