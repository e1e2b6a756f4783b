//! Contacts one at a time: `push` adds three rows to the equations, `shape` returns S and R so far.
//!
//! ```text
//! A += sum_k e_k e_k',   b += sum_k e_k d_k       k = height, x slope, y slope, each row divided by its sd
//! A c = b        S, R = means over the grid        u^2 = g' A^-1 g,  g = d(mean)/dc      (delta method)
//! ```
//!
//! It is meant for a robot that touches a thousand times a second: on patches of one segment nothing is allocated after
//! the plan is made, and every touch costs the same, but for one in a window's length, which forms the sums anew. The rows are slope rows with known noise sds, in the coordinates of
//! the knots.

use super::error::{PlanError, check_noise_sds, check_shape_grid};
use super::touch_memory::{StreamTouch, TouchMemory};
use crate::fit::Statistic;
use palpate_geometry::shape::RepeatedGradients;
use palpate_geometry::surface::CurvatureGrid;
use palpate_numeric::bspline::{Knots, MAX_DEGREE};
use palpate_numeric::linalg::{StencilMatrix, TensorShape};
use palpate_numeric::solve::Cholesky;

const WIDTH: usize = MAX_DEGREE + 1;

/// A fit that grows touch by touch.
///
/// ```
/// # use palpate_fitting::facade as palpate;
/// use palpate::spline::{Knots, linspace};
/// use palpate::plans::TouchStream;
///
/// // a bowl z = (x^2 + y^2)/10: S = -1, R = 1/5 at its bottom
/// let axis = Knots::uniform(2, 1, -1.0, 1.0)?;
/// let points = linspace(-0.1, 0.1, 3);
/// let mut stream = TouchStream::new([axis.clone(), axis], [0.01, 0.03, 0.03], [&points, &points])?;
/// for r in 0..9 {
///     let [x, y] = [f64::from(r / 3) - 1.0, f64::from(r % 3) - 1.0];
///     stream.push([x, y], 0.1 * (x * x + y * y), [0.2 * x, 0.2 * y])?;
/// }
/// let [s, r] = stream.shape()?;
/// assert!(s.mean.is_some_and(|s| s < -0.9) && r.mean.is_some_and(|r| (r - 0.2).abs() < 0.01));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct TouchStream {
    knots: [Knots; 2],
    /// 1/sd of heights, x slopes, y slopes.
    weights: [f64; 3],
    matrix: StencilMatrix,
    right: Vec<f64>,
    factor: Cholesky,
    coefficients: Vec<f64>,
    grid: CurvatureGrid,
    point_gradients: RepeatedGradients,
    /// S and R at the points of the grid.
    maps: [Vec<f64>; 2],
    /// d(mean S)/dc and d(mean R)/dc.
    gradients: [Vec<f64>; 2],
    /// One of the gradients times `A^-1`.
    solved: Vec<f64>,
    contacts: usize,
    memory: TouchMemory,
}

impl TouchStream {
    /// Plans for these knots, the sds `[heights, x slopes, y slopes]` and the axes of the shape grid.
    ///
    /// # Errors
    /// [`PlanError::NoiseSd`] for an sd that is not positive; [`PlanError::EmptyGrid`], [`PlanError::Axis`]; no memory.
    pub fn new(knots: [Knots; 2], sigma: [f64; 3], grid: [&[f64]; 2]) -> Result<TouchStream, PlanError> {
        check_noise_sds(sigma, false)?;
        check_shape_grid(grid)?;
        let shape =
            TensorShape { basis: knots.each_ref().map(Knots::n_basis), degree: knots.each_ref().map(Knots::degree) };
        let factor = Cholesky::plan(shape)?;
        let zeros = vec![0.0; shape.unknowns()];
        // means do not depend on the order of the points
        let [x, y] = grid.map(|axis| {
            let mut axis = axis.to_vec();
            axis.sort_unstable_by(f64::total_cmp);
            axis
        });
        let map = vec![0.0; x.len() * y.len()];
        Ok(TouchStream {
            weights: sigma.map(|sd| 1.0 / sd),
            matrix: StencilMatrix::zeros(shape),
            right: zeros.clone(),
            factor,
            coefficients: zeros.clone(),
            grid: CurvatureGrid::new(&knots, &x, &y),
            point_gradients: RepeatedGradients::new(&knots, &x, &y),
            maps: [map.clone(), map],
            gradients: [zeros.clone(), zeros.clone()],
            solved: zeros,
            contacts: 0,
            memory: TouchMemory::All,
            knots,
        })
    }

    /// The same stream, in which only the last `touches` count. What was pushed before is forgotten.
    ///
    /// # Errors
    /// [`PlanError::Memory`] for no touch, or more than memory holds.
    pub fn with_window(mut self, touches: usize) -> Result<TouchStream, PlanError> {
        self.memory = TouchMemory::window(touches)?;
        self.clear();
        Ok(self)
    }

    /// The same stream, in which a touch counts this share of what it counted before, with every touch that comes after it: its
    /// sds grow with its age. What was pushed before is forgotten.
    ///
    /// # Errors
    /// [`PlanError::Memory`] for a share that is not above 0 or is above 1.
    pub fn with_decay(mut self, share: f64) -> Result<TouchStream, PlanError> {
        self.memory = TouchMemory::decay(share)?;
        self.clear();
        Ok(self)
    }

    /// Forgets all touches; the plan stays.
    pub fn clear(&mut self) {
        self.matrix.clear();
        self.right.fill(0.0);
        self.coefficients.fill(0.0);
        self.memory.clear();
        self.contacts = 0;
    }

    /// Adds one touch: three rows more, over the basis functions alive there. `at` is x and y in the knots' coordinates,
    /// `z` the height there, `slopes` dz/dx and dz/dy.
    ///
    /// # Errors
    /// [`PlanError::NotFinite`] where a number is not finite, [`PlanError::Outside`] where the touch lies outside the
    /// knots' domain; nothing has changed then.
    pub fn push(&mut self, at: [f64; 2], z: f64, slopes: [f64; 2]) -> Result<(), PlanError> {
        self.check(at, z, slopes)?;
        let touch = StreamTouch { at, z, slopes };
        match &mut self.memory {
            TouchMemory::All => self.contacts += 1,
            TouchMemory::Decay(share) => {
                let share = *share;
                self.matrix.values_mut().iter_mut().chain(&mut self.right).for_each(|v| *v *= share);
                self.contacts += 1;
            }
            TouchMemory::Window { ring, next, held } => {
                let oldest = (*held == ring.len()).then(|| ring[*next]);
                ring[*next] = touch;
                *next = (*next + 1) % ring.len();
                *held = (*held + 1).min(ring.len());
                self.contacts = *held;
                if oldest.is_some() && *next == 0 {
                    self.sum_anew();
                    return Ok(());
                }
                if let Some(oldest) = oldest {
                    self.add(&oldest, -1.0);
                }
            }
        }
        self.add(&touch, 1.0);
        Ok(())
    }

    /// The sums over the window, from its touches.
    fn sum_anew(&mut self) {
        self.matrix.clear();
        self.right.fill(0.0);
        // the ring is taken out for as long as the sums are changed
        let memory = std::mem::replace(&mut self.memory, TouchMemory::All);
        if let TouchMemory::Window { ring, held, .. } = &memory {
            ring[..*held].iter().for_each(|touch| self.add(touch, 1.0));
        }
        self.memory = memory;
    }

    /// Adds the rows of a touch so many times; -1 takes it away.
    fn add(&mut self, touch: &StreamTouch, times: f64) {
        let StreamTouch { at: [x, y], z, slopes: [zx, zy] } = *touch;
        let [bx, by] = [(0, x), (1, y)].map(|(axis, at)| {
            let knots = &self.knots[axis];
            let mut rows = [0.0; 2 * WIDTH];
            (knots.derivatives(at, 1, &mut rows[..2 * (knots.degree() + 1)]), rows)
        });
        let TensorShape { basis: [_, m], degree: [p, q] } = self.matrix.shape();
        let [wz, wx, wy] = self.weights;
        // the three rows at basis function (a, b)
        let rows = |a: usize, b: usize| {
            let ((n, dn), (m, dm)) = ((bx.1[a], bx.1[p + 1 + a]), (by.1[b], by.1[q + 1 + b]));
            [wz * n * m, wx * dn * m, wy * n * dm]
        };
        let data = [wz * z, wx * zx, wy * zy];
        for a in 0..=p {
            for b in 0..=q {
                let (row, own) = ((bx.0 + a) * m + by.0 + b, rows(a, b));
                self.right[row] += times * (0..3).map(|k| own[k] * data[k]).sum::<f64>();
                for k in 0..=a {
                    for l in 0..=if k == a { b } else { q } {
                        let other = rows(k, l);
                        let position = self.matrix.position(row, a - k, l + q - b);
                        self.matrix.values_mut()[position] += times * (0..3).map(|e| own[e] * other[e]).sum::<f64>();
                    }
                }
            }
        }
    }

    fn check(&self, [x, y]: [f64; 2], z: f64, [zx, zy]: [f64; 2]) -> Result<(), PlanError> {
        let index = self.contacts;
        for (column, value) in [("x", x), ("y", y), ("z", z), ("zx", zx), ("zy", zy)] {
            if !value.is_finite() {
                return Err(PlanError::NotFinite { column, index, value });
            }
        }
        for (axis, (value, knots)) in ["x", "y"].into_iter().zip([x, y].into_iter().zip(&self.knots)) {
            let [lo, hi] = knots.domain();
            if !(lo..=hi).contains(&value) {
                return Err(PlanError::Outside { axis, index, value, domain: [lo, hi] });
            }
        }
        Ok(())
    }

    /// Touches that count: those so far, or those of the window.
    pub fn contacts(&self) -> usize {
        self.contacts
    }

    /// Fits all touches so far: mean S and mean R (1/length) over the grid with their standard uncertainties, from the sds
    /// that the stream was made with. The mean of S is `None` where S is defined nowhere on the grid.
    ///
    /// # Errors
    /// [`PlanError::Solve`] while touches are too few or leave a basis function without data.
    pub fn shape(&mut self) -> Result<[Statistic; 2], PlanError> {
        self.coefficients.copy_from_slice(&self.right);
        self.factor.factor_and_solve(&self.matrix, &mut self.coefficients)?;
        let (index, curvedness) = self.means();
        let means = [index, Some(curvedness)];
        Ok([0, 1].map(|k| {
            let u = Some(self.uncertainty(k));
            Statistic { mean: means[k], u, u_noise: u, dof: Some(f64::INFINITY), ..Statistic::default() }
        }))
    }

    /// Coefficients of the last [`TouchStream::shape`], n x m, row-major.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Mean S and R over the grid, and their gradients.
    fn means(&mut self) -> (Option<f64>, f64) {
        let [index_map, curvedness_map] = &mut self.maps;
        self.grid.maps(&self.coefficients, index_map, curvedness_map);
        let [of_index, of_curvedness] = &mut self.gradients;
        self.point_gradients.sums(&self.coefficients, index_map, [of_index, of_curvedness]);
        let (mut index, mut defined) = (0.0, 0_usize);
        for here in index_map.iter().filter(|here| !here.is_nan()) {
            index += here;
            defined += 1;
        }
        let points = curvedness_map.len() as f64;
        of_index.iter_mut().for_each(|g| *g /= defined.max(1) as f64);
        of_curvedness.iter_mut().for_each(|g| *g /= points);
        let curved: f64 = curvedness_map.iter().sum();
        ((defined > 0).then(|| index / defined as f64), curved / points)
    }

    /// `sqrt(g' A^-1 g)`.
    fn uncertainty(&mut self, which: usize) -> f64 {
        self.solved.copy_from_slice(&self.gradients[which]);
        self.factor.solve(&mut self.solved);
        let square: f64 = self.solved.iter().zip(&self.gradients[which]).map(|(v, g)| v * g).sum();
        square.max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{FitOptions, Objective, SlopeWeights, fit_contacts};
    use crate::plans::{SlopeColumns, SlopePlan};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::bspline::linspace;

    /// Place, height and slopes of one touch.
    fn touch(r: usize) -> ([f64; 2], f64, [f64; 2]) {
        let (x, y) = ((r as f64 * 0.754_877_666).fract() * 2.0 - 1.0, (r as f64 * 0.569_840_291).fract() * 2.0 - 1.0);
        let off = |k: f64| 0.01 * (r as f64 * k).sin();
        let z = 0.3 * x * x + 0.1 * y * y + 0.05 * x + off(1.3);
        ([x, y], z, [0.6 * x + 0.05 + off(2.1), 0.2 * y + off(3.7)])
    }

    /// Every tenth step against the whole fit with the same rows: coefficients, means, and uncertainties.
    #[test]
    fn every_state_is_the_fit_of_the_touches_so_far() {
        let sigma = [0.02, 0.05, 0.04];
        for (degree, segments) in [(2, 1), (3, 1), (3, 2)] {
            let knots = Knots::uniform(degree, segments, -1.0, 1.0).unwrap();
            // well inside the touches, because a fit takes no point beyond their outline
            let points = linspace(-0.7, 0.7, 8);
            let mut stream = TouchStream::new([knots.clone(), knots.clone()], sigma, [&points, &points]).unwrap();
            assert!(stream.shape().is_err());
            let mut columns: [Vec<f64>; 5] = Default::default();
            for r in 0..120 {
                let (at @ [x, y], z, slopes @ [zx, zy]) = touch(r);
                columns.iter_mut().zip([x, y, z, zx, zy]).for_each(|(c, v)| c.push(v));
                stream.push(at, z, slopes).unwrap();
                if r < 60 || r % 10 != 0 {
                    continue;
                }
                let [s, mean_r] = stream.shape().unwrap();
                let [x, y, z, zx, zy] = &columns;
                let weights = sigma.map(|s| 1.0 / s);
                let mut plan = SlopePlan::new([knots.clone(), knots.clone()], weights).unwrap();
                let c = plan.fit(&SlopeColumns { x, y, z, zx, zy }).unwrap();
                assert!(c.iter().zip(stream.coefficients()).all(|(a, b)| (a - b).abs() < 1e-11), "degree {degree}");
                let contacts =
                    Contacts::from_positions(x.clone(), y.clone(), z.clone()).with_slopes(zx.clone(), zy.clone());
                let fit = fit_contacts(
                    &contacts,
                    &FitOptions {
                        degree: [degree; 2],
                        segments: [segments; 2],
                        domain: Some([-1.0, 1.0, -1.0, 1.0]),
                        objective: Objective::Slopes(SlopeWeights::Explicit(weights)),
                        inset: 0.15,
                        ..FitOptions::default()
                    },
                );
                let shape = fit.unwrap();
                let shape = shape.shape();
                assert_eq!(stream.contacts(), r + 1);
                assert!((s.mean.unwrap() - shape.shape_index.mean.unwrap()).abs() < 1e-9);
                assert!((mean_r.mean.unwrap() - shape.curvedness.mean.unwrap()).abs() < 1e-9);
                // the fit's uncertainty takes the residuals' variances, which are below the declared ones here
                let u = mean_r.u.unwrap();
                assert!(u > 0.0 && u < 20.0 * shape.curvedness.u.unwrap());
            }
        }
    }

    /// A window is a stream of its touches alone, however many went before; and a cleared stream is a new one.
    #[test]
    fn what_is_forgotten_leaves_nothing_behind() {
        let knots = Knots::uniform(3, 1, -1.0, 1.0).unwrap();
        let points = linspace(-0.7, 0.7, 5);
        let plan = || TouchStream::new([knots.clone(), knots.clone()], [0.02, 0.05, 0.04], [&points, &points]).unwrap();
        let mut window = plan().with_window(40).unwrap();
        for r in 0..1000 {
            let (at, z, slopes) = touch(r);
            // a step of the surface that lies far back
            window.push(at, if r < 500 { z + 1e3 } else { z }, slopes).unwrap();
            if r < 700 || r % 97 != 0 {
                continue;
            }
            let mut last = plan();
            (r - 39..=r).for_each(|r| {
                let (at, z, slopes) = touch(r);
                last.push(at, z, slopes).unwrap();
            });
            assert_eq!((window.contacts(), last.contacts()), (40, 40));
            let ([s, curved], [own_s, own_curved]) = (last.shape().unwrap(), window.shape().unwrap());
            assert!((s.mean.unwrap() - own_s.mean.unwrap()).abs() < 1e-9, "{r}");
            assert!((curved.mean.unwrap() - own_curved.mean.unwrap()).abs() < 1e-9, "{r}");
        }
        window.clear();
        assert!(window.shape().is_err() && window.contacts() == 0);
        let mut fresh = plan();
        for r in 0..30 {
            let (at, z, slopes) = touch(r);
            window.push(at, z, slopes).unwrap();
            fresh.push(at, z, slopes).unwrap();
        }
        assert_eq!(window.shape().unwrap(), fresh.shape().unwrap());
    }

    /// A decay weighs a touch as a fit with larger sds would.
    #[test]
    fn a_decaying_touch_counts_as_one_of_larger_sds() {
        let knots = Knots::uniform(2, 1, -1.0, 1.0).unwrap();
        let (points, share) = ([0.0], 0.9_f64);
        let plan = || TouchStream::new([knots.clone(), knots.clone()], [0.02, 0.05, 0.04], [&points, &points]).unwrap();
        let mut decaying = plan().with_decay(share).unwrap();
        let mut weighed = plan();
        for r in 0..25 {
            let (at, z, slopes) = touch(r);
            decaying.push(at, z, slopes).unwrap();
            weighed.add(&StreamTouch { at, z, slopes }, share.powi(24 - r as i32));
        }
        let ([s, curved], [own_s, own_curved]) = (weighed.shape().unwrap(), decaying.shape().unwrap());
        assert!((s.mean.unwrap() - own_s.mean.unwrap()).abs() < 1e-12);
        assert!((curved.u.unwrap() / own_curved.u.unwrap() - 1.0).abs() < 1e-12);
        for wrong in [0.0, -0.5, 1.5, f64::NAN] {
            assert!(matches!(plan().with_decay(wrong), Err(PlanError::Memory { .. })), "{wrong}");
        }
        assert!(plan().with_window(0).is_err() && plan().with_window(usize::MAX).is_err());
    }

    /// The delta method against many streams with other noise: the spread of R is its uncertainty.
    #[test]
    fn uncertainties_are_the_spread_over_repetitions() {
        use palpate_numeric::draws::EffectDraws;
        let knots = Knots::uniform(2, 1, -1.0, 1.0).unwrap();
        let (points, sigma) = (linspace(-0.8, 0.8, 5), [0.01, 0.03, 0.03]);
        let draws = EffectDraws::new(5, "stream");
        let (mut sums, mut claimed) = ([0.0; 4], [0.0; 2]);
        const RUNS: usize = 400;
        for run in 0..RUNS {
            let mut stream = TouchStream::new([knots.clone(), knots.clone()], sigma, [&points, &points]).unwrap();
            for r in 0..40 {
                let mut n = [0.0; 4];
                draws.gaussians(r as u64, run as u64, 4, &mut n);
                let [x, y] = touch(r).0;
                let exact = [0.3 * x * x + 0.1 * y * y, 0.6 * x, 0.2 * y];
                let [z, zx, zy] = [0, 1, 2].map(|k| exact[k] + sigma[k] * n[k]);
                stream.push([x, y], z, [zx, zy]).unwrap();
            }
            let found = stream.shape().unwrap();
            let values = found.map(|found| found.mean.unwrap());
            (0..2).for_each(|k| {
                sums[k] += values[k];
                sums[2 + k] += values[k] * values[k];
            });
            claimed[0] += found[0].u.unwrap() / RUNS as f64;
            claimed[1] += found[1].u.unwrap() / RUNS as f64;
        }
        for k in 0..2 {
            let mean = sums[k] / RUNS as f64;
            let sd = (sums[2 + k] / RUNS as f64 - mean * mean).sqrt();
            // 400 repetitions know their sd to 3.5 %: five sigma
            assert!((sd / claimed[k] - 1.0).abs() < 0.18, "{k}: {sd} against {}", claimed[k]);
        }
    }

    #[test]
    fn a_faulty_touch_is_refused_and_changes_nothing() {
        let knots = Knots::uniform(2, 1, -1.0, 1.0).unwrap();
        let mut stream = TouchStream::new([knots.clone(), knots.clone()], [1.0; 3], [&[0.0], &[0.0]]).unwrap();
        assert!(stream.push([0.0, f64::NAN], 0.0, [0.0; 2]).is_err());
        let far = stream.push([1000.0, 0.0], 0.0, [0.0; 2]);
        assert!(matches!(far, Err(PlanError::Outside { axis: "x", index: 0, .. })));
        assert!(stream.right.iter().chain(stream.matrix.values()).all(|v| *v == 0.0) && stream.contacts == 0);
        assert!(TouchStream::new([knots.clone(), knots.clone()], [0.0; 3], [&[0.0], &[0.0]]).is_err());
        assert!(TouchStream::new([knots.clone(), knots], [1.0; 3], [&[0.0], &[]]).is_err());
    }
}
