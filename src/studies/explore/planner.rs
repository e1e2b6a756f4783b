//! Which candidates to touch next: those that let u(S) and u(R) of a fit fall most.
//!
//! ```text
//! criterion   u(S)^2 / unit_S^2 + u(R)^2 / unit_R^2          unit: u of the fit itself, or the goals
//! greedy      take the candidate of the largest fall, update the covariance by its three rows, choose again
//! ```
//!
//! A fall is at most `|A P g|^2`, because M is at least the unit matrix. That bound takes six products of two rows; only the
//! candidates whose bound beats the best fall so far need M, some 300 multiplications for degree 2. No refit is made. The
//! choice is that of refitting with each candidate in turn, a noise-free contact on the fitted surface being added
//! (`tests/library/explore.rs`).
//! D-optimal exchange: V. V. Fedorov, *Theory of Optimal Experiments*, 1972; here it is the two uncertainties that are
//! lowered and not the determinant.

use palpate_fitting::fit::{Fit, NoiseSource};
use palpate_geometry::contact::Frame;
use palpate_geometry::shape::{GridGradients, mean_gradients};
use palpate_geometry::surface::HeightField;

use super::ExploreError;
use super::covariance::Covariance;
use super::rows::{CandidateRows, Sensor};

/// What the next touches are to lower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Criterion {
    /// The uncertainties of S and R.
    Shape,
    /// The variance of the height where it is largest.
    Height,
}

/// A fit prepared for choosing next touches again and again; after the first call with so many candidates none allocates.
///
/// ```
/// # use palpate_studies::facade as palpate;
/// use palpate::explore::TouchPlanner;
/// use palpate::fit::{NormalSigma, Objective};
/// use palpate::{Contacts, FitOptions, fit_contacts};
///
/// // a ridge of radius 10, touched at nine places
/// let (x, y): (Vec<f64>, Vec<f64>) = (0..9).map(|r| (4.0 * f64::from(r % 3 - 1), 4.0 * f64::from(r / 3 - 1))).unzip();
/// let up: Vec<f64> = x.iter().map(|x| (100.0 - x * x).sqrt()).collect();
/// let z = up.iter().map(|up| up - 10.0).collect();
/// let contacts = Contacts::from_positions(x.clone(), y, z).with_normals(x, vec![0.0; 9], up);
/// let noise = Objective::Normals(NormalSigma::Known { z: 0.02, normal_deg: 1.0 });
/// let fit = fit_contacts(&contacts, &FitOptions::default().with_objective(noise))?;
///
/// let mut planner = TouchPlanner::new(&fit)?;
/// let candidates = [[0.0, 0.0], [4.0, 4.0], [1.0, 0.0]];
/// // one more height in the middle tells more of how far the ridge rises than the others
/// assert_eq!(planner.next_touches(&candidates, 1)?, [0]);
/// let [u_s, u_r] = planner.expected_u();
/// assert!(u_s < fit.shape().shape_index.u.unwrap() && u_r < fit.shape().curvedness.u.unwrap());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct TouchPlanner {
    surface: HeightField,
    frame: Frame,
    sensor: Sensor,
    fitted: Covariance,
    now: Covariance,
    rows: CandidateRows,
    taken: Vec<bool>,
    chosen: Vec<usize>,
    /// Upper bounds of the scores.
    bounds: Vec<f64>,
    /// 1/unit^2 of S and of R.
    units: [f64; 2],
}

impl TouchPlanner {
    /// Prepares the fit: its covariance and the gradients of its mean S and R.
    ///
    /// # Errors
    /// [`ExploreError::Weights`], [`ExploreError::NoNoise`], [`ExploreError::Unsupported`], [`ExploreError::Turned`].
    pub fn new(fit: &Fit) -> Result<TouchPlanner, ExploreError> {
        let solution = fit.solution();
        let free = solution.unsupported.len() + usize::from(solution.pinned.is_some());
        if free > 0 {
            return Err(ExploreError::Unsupported { coefficients: free });
        }
        if !fit.frame().keeps_axes() {
            return Err(ExploreError::Turned);
        }
        let sensor = sensor(fit)?;
        let unknowns = fit.equations().unknowns();
        let mut matrix = vec![0.0; unknowns * unknowns];
        solution.factor.write_inverse(&mut matrix);
        let maps = &fit.bare_shape().maps;
        let of_points = GridGradients::new(fit.surface(), &maps.rows);
        let of_means = mean_gradients(fit.surface(), maps, &of_points);
        let knots = fit.surface().knots();
        let fitted = Covariance::new(knots, matrix, [&of_means.shape_index, &of_means.curvedness]);
        let units = [0, 1].map(|q| inverse(fitted.followed[q].square));
        Ok(TouchPlanner {
            surface: fit.surface().clone(),
            frame: *fit.frame(),
            sensor,
            now: fitted.clone(),
            fitted,
            rows: CandidateRows::default(),
            taken: Vec::new(),
            chosen: Vec::new(),
            bounds: Vec::new(),
            units,
        })
    }

    /// The same with the falls of u(S) and u(R) counted in these units, such as the goals; R in 1/length of the input.
    pub fn with_units(mut self, of_shape_index: f64, of_curvedness: f64) -> TouchPlanner {
        let of_curvedness = of_curvedness * self.frame.scale;
        self.units = [inverse(of_shape_index * of_shape_index), inverse(of_curvedness * of_curvedness)];
        self
    }

    /// The `n` candidates (x, y in input units) to touch next, the best first, by their numbers; each at most once.
    ///
    /// # Errors
    /// [`ExploreError::NoCandidate`], [`ExploreError::NotFinite`].
    pub fn next_touches(&mut self, candidates: &[[f64; 2]], n: usize) -> Result<&[usize], ExploreError> {
        self.choose(candidates, n, Criterion::Shape)
    }

    /// Standard uncertainties of S and R that are expected once the touches chosen last are made; R in 1/length of the input.
    pub fn expected_u(&self) -> [f64; 2] {
        let [s, r] = [0, 1].map(|q| self.now.followed[q].square.max(0.0).sqrt());
        [s, r / self.frame.scale]
    }

    /// The same of the fit itself.
    pub(super) fn u(&self) -> [f64; 2] {
        let [s, r] = [0, 1].map(|q| self.fitted.followed[q].square.max(0.0).sqrt());
        [s, r / self.frame.scale]
    }

    pub(super) fn choose(
        &mut self,
        candidates: &[[f64; 2]],
        n: usize,
        criterion: Criterion,
    ) -> Result<&[usize], ExploreError> {
        self.start(candidates)?;
        self.chosen.clear();
        for _ in 0..n.min(candidates.len()) {
            let Some(best) = self.best(criterion) else { break };
            self.now.take(&self.rows, best);
            self.taken[best] = true;
            self.chosen.push(best);
        }
        Ok(&self.chosen)
    }

    /// Groups of candidates (the lines of fingers): the one whose touches, all made, lower the criterion most.
    pub(super) fn best_group(
        &mut self,
        candidates: &[[f64; 2]],
        groups: &[Vec<usize>],
        criterion: Criterion,
    ) -> Result<Option<usize>, ExploreError> {
        self.start(candidates)?;
        let mut best: Option<(usize, f64)> = None;
        for (number, group) in groups.iter().enumerate().filter(|(_, group)| !group.is_empty()) {
            self.now.copy_from(&self.fitted);
            let mut fall = 0.0;
            for &k in group {
                fall += self.score(criterion, k);
                self.now.take(&self.rows, k);
            }
            // longer lines lower more: what counts is the fall for each touch
            let fall = fall / group.len() as f64;
            if best.is_none_or(|(_, most)| fall > most) {
                best = Some((number, fall));
            }
        }
        Ok(best.map(|(number, _)| number))
    }

    fn start(&mut self, candidates: &[[f64; 2]]) -> Result<(), ExploreError> {
        if candidates.is_empty() {
            return Err(ExploreError::NoCandidate { why: "the list of candidates is empty".into() });
        }
        if let Some(index) = candidates.iter().position(|c| !c.iter().all(|v| v.is_finite())) {
            let [x, y] = candidates[index];
            return Err(ExploreError::NotFinite { index, x, y });
        }
        let Frame { origin, scale, .. } = self.frame;
        let places = candidates.iter().map(|c| [(c[0] - origin[0]) / scale, (c[1] - origin[1]) / scale]);
        self.rows.fill(&self.surface, self.sensor, places);
        self.now.copy_from(&self.fitted);
        self.taken.clear();
        self.taken.resize(candidates.len(), false);
        Ok(())
    }

    /// The candidate of the largest score, the first of equals.
    fn best(&mut self, criterion: Criterion) -> Option<usize> {
        let mut bounds = std::mem::take(&mut self.bounds);
        bounds.clear();
        bounds.extend(
            (0..self.rows.len()).map(|k| if self.taken[k] { f64::NEG_INFINITY } else { self.bound(criterion, k) }),
        );
        // the candidate of the largest bound is nearly the best, and leaves few others to be asked
        let first =
            (0..bounds.len()).filter(|&k| !self.taken[k]).reduce(|a, b| if bounds[b] > bounds[a] { b } else { a });
        let mut best = first.map(|k| (k, self.score(criterion, k)));
        for k in (0..bounds.len()).filter(|&k| !self.taken[k]) {
            if best.is_some_and(|(_, most)| bounds[k] < most) {
                continue;
            }
            let score = self.score(criterion, k);
            if best.is_none_or(|(at, most)| score > most || (score == most && k < at)) {
                best = Some((k, score));
            }
        }
        self.bounds = bounds;
        best.map(|(k, _)| k)
    }

    /// At least the score of a candidate, also after rounding.
    #[inline]
    fn bound(&self, criterion: Criterion, k: usize) -> f64 {
        /// Far above what rounding moves sums of some dozen products by, relative to their size.
        const ROUNDING: f64 = 1.0 + 1e-9;
        match criterion {
            Criterion::Shape => {
                let [s, r] = self.now.falls_at_most(&self.rows, k);
                ROUNDING * (s * self.units[0] + r * self.units[1])
            }
            Criterion::Height => f64::INFINITY,
        }
    }

    #[inline]
    fn score(&self, criterion: Criterion, k: usize) -> f64 {
        match criterion {
            Criterion::Shape => {
                let [s, r] = self.now.falls(&self.rows, k);
                s * self.units[0] + r * self.units[1]
            }
            Criterion::Height => self.now.height_variance(&self.rows, k),
        }
    }
}

/// What a touch measures, as the fit's own noise sds say.
fn sensor(fit: &Fit) -> Result<Sensor, ExploreError> {
    let noise = fit.noise();
    if let NoiseSource::Weights(_) = noise.source {
        return Err(ExploreError::Weights);
    }
    let over = |sd: Option<f64>, unit: f64| match sd {
        None => Ok(0.0),
        Some(sd) if sd > 0.0 && sd.is_finite() => Ok(unit / sd),
        Some(_) => Err(ExploreError::NoNoise),
    };
    Ok(Sensor {
        height: over(noise.sigma_z, fit.frame().scale)?,
        normal: over(noise.sigma_normal_deg.map(f64::to_radians), 1.0)?,
        slope: over(noise.sigma_slope, 1.0)?,
    })
}

/// 1/v, and 0 where there is nothing to lower.
pub(super) fn inverse(v: f64) -> f64 {
    if v > 0.0 && v.is_finite() { 1.0 / v } else { 0.0 }
}
