//! Damped Gauss-Newton steps for nonlinear least squares, over any residual model.
//!
//! ```text
//! minimise F(x) = sum over blocks of w r(x)^2        A = sum w r' r'^T,  g = sum w r' r
//! (A + mu D) step = -g        accepted where F falls: mu lower;  refused: mu times 10
//! ```
//!
//! K. Levenberg, *Q. Appl. Math.* 2 (1944) 164; D. W. Marquardt, *J. SIAM* 11 (1963) 431; J. J. More, *The Levenberg-Marquardt
//! algorithm*, 1978. The model sums its residual blocks into whatever matrix it has, dense or banded, scales it by its own D and
//! says which points it cannot stand on; the loop here owns damping, acceptance and the end.

/// What is minimised.
pub trait ResidualModel {
    /// Where the descent stands, with what the model wants to remember of it.
    type Point;
    /// A move away from a point.
    type Step;
    /// Why damped equations have no solution.
    type Error;

    /// Sums the normal equations at a point over all residual blocks, and returns F there.
    fn linearise(&mut self, at: &Self::Point) -> f64;

    /// The step under a damping.
    ///
    /// # Errors
    /// The damped matrix has no factor.
    fn solve(&mut self, damping: f64) -> Result<Self::Step, Self::Error>;

    /// The point after a step and F there; `None` where the model does not hold there.
    fn moved(&mut self, from: &Self::Point, step: &Self::Step) -> Option<(Self::Point, f64)>;

    /// A longer step that is tried first: where successive steps form a series, its sum. It leaves the damping as it is.
    fn extrapolated(&mut self, _step: &Self::Step, _damping: f64) -> Option<Self::Step> {
        None
    }

    /// Is told a step that was taken, or that one was refused.
    fn decided(&mut self, _taken: Option<TakenStep<'_, Self::Step>>) {}

    /// Whether to look no further after a refused step to a value of `after`: there is nothing lower but by rounding.
    fn gives_up(&self, _step: &Self::Step, _before: f64, _after: Option<f64>) -> bool {
        false
    }

    /// Whether a step that was taken from `before` to `after` ends the descent.
    fn is_settled(&mut self, step: &Self::Step, before: f64, after: f64) -> bool;
}

/// A step that was taken.
#[derive(Clone, Copy, Debug)]
pub struct TakenStep<'a, S> {
    pub step: &'a S,
    /// Whether it was the extrapolated one.
    pub is_extrapolated: bool,
}

/// Damping, acceptance and budget of a descent.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// First damping, and that after a search that found nothing.
    pub first: f64,
    /// Largest damping that is tried.
    pub most: f64,
    /// The damping after a step that was taken. A function, because `mu 0.1` and `mu / 10` differ in their last bit.
    pub fall: fn(f64) -> f64,
    /// Share of F by which a step may raise it and is taken all the same; 0 where only a fall counts.
    pub rounding: f64,
    /// Most steps that are taken.
    pub steps: usize,
    /// Most steps that are tried.
    pub trials: usize,
}

/// Factor of the damping after a refused step.
const RISE: f64 = 10.0;

/// How a descent ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DescentEnd {
    /// Steps taken.
    pub steps: usize,
    /// Whether the last step was small enough, or none goes down any more.
    pub is_settled: bool,
}

/// Takes steps from `point` until the model has settled, none goes down, or the budget is spent; `damping` is carried on.
///
/// # Errors
/// The equations have no solution under the largest damping. The point is the last one that was reached.
pub fn descend<M: ResidualModel>(
    model: &mut M,
    point: &mut M::Point,
    damping: &mut f64,
    settings: &Settings,
) -> Result<DescentEnd, M::Error> {
    let mut trials = settings.trials;
    let mut found = DescentEnd { steps: 0, is_settled: false };
    while found.steps < settings.steps && !found.is_settled {
        let before = model.linearise(point);
        match lower(model, point, before, damping, settings, &mut trials)? {
            Some((step, after)) => {
                found.steps += 1;
                found.is_settled = model.is_settled(&step, before, after);
            }
            None => found.is_settled = true,
        }
    }
    Ok(found)
}

/// Raises the damping until a step goes down and takes it; `None` where none does.
fn lower<M: ResidualModel>(
    model: &mut M,
    point: &mut M::Point,
    before: f64,
    damping: &mut f64,
    settings: &Settings,
    trials: &mut usize,
) -> Result<Option<(M::Step, f64)>, M::Error> {
    let goes_down =
        |after: f64| after < before || (settings.rounding > 0.0 && after <= before * (1.0 + settings.rounding));
    let mut unsolved = None;
    if !before.is_finite() {
        return Ok(None);
    }
    while *damping <= settings.most && *trials > 0 {
        *trials -= 1;
        let step = match model.solve(*damping) {
            Ok(step) => step,
            Err(error) => {
                unsolved = Some(error);
                *damping *= RISE;
                continue;
            }
        };
        unsolved = None;
        if let Some(longer) = model.extrapolated(&step, *damping)
            && let Some((next, after)) = model.moved(point, &longer).filter(|(_, after)| goes_down(*after))
        {
            *point = next;
            model.decided(Some(TakenStep { step: &longer, is_extrapolated: true }));
            return Ok(Some((longer, after)));
        }
        let trial = model.moved(point, &step);
        let after = trial.as_ref().map(|(_, after)| *after);
        if let Some((next, after)) = trial.filter(|(_, after)| goes_down(*after)) {
            *point = next;
            *damping = (settings.fall)(*damping);
            model.decided(Some(TakenStep { step: &step, is_extrapolated: false }));
            return Ok(Some((step, after)));
        }
        model.decided(None);
        if model.gives_up(&step, before, after) {
            return Ok(None);
        }
        *damping *= RISE;
    }
    *damping = settings.first;
    unsolved.map_or(Ok(None), Err)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(1 - x)^2 + 100 (y - x^2)^2`; H. H. Rosenbrock, *Comput. J.* 3 (1960) 175.
    #[derive(Default)]
    struct Valley {
        matrix: [[f64; 2]; 2],
        gradient: [f64; 2],
        refused: usize,
    }

    fn residuals([x, y]: [f64; 2]) -> [f64; 2] {
        [1.0 - x, 10.0 * (y - x * x)]
    }

    impl ResidualModel for Valley {
        type Point = [f64; 2];
        type Step = [f64; 2];
        type Error = ();

        fn linearise(&mut self, at: &[f64; 2]) -> f64 {
            let (r, rows) = (residuals(*at), [[-1.0, 0.0], [-20.0 * at[0], 10.0]]);
            let sum = |of: &dyn Fn(usize) -> f64| of(0) + of(1);
            self.matrix = [0, 1].map(|i| [0, 1].map(|j| sum(&|k| rows[k][i] * rows[k][j])));
            self.gradient = [0, 1].map(|i| sum(&|k| rows[k][i] * r[k]));
            r[0] * r[0] + r[1] * r[1]
        }

        fn solve(&mut self, damping: f64) -> Result<[f64; 2], ()> {
            let [[a, b], [c, d]] = self.matrix;
            let (a, d) = (a * (1.0 + damping), d * (1.0 + damping));
            let [g, h] = self.gradient;
            let det = a * d - b * c;
            if det > 0.0 { Ok([(b * h - d * g) / det, (c * g - a * h) / det]) } else { Err(()) }
        }

        fn moved(&mut self, from: &[f64; 2], step: &[f64; 2]) -> Option<([f64; 2], f64)> {
            let next = [from[0] + step[0], from[1] + step[1]];
            let [p, q] = residuals(next);
            Some((next, p * p + q * q))
        }

        fn decided(&mut self, taken: Option<TakenStep<'_, [f64; 2]>>) {
            self.refused += usize::from(taken.is_none());
        }

        fn is_settled(&mut self, _: &[f64; 2], before: f64, after: f64) -> bool {
            after <= 1e-24 || after > before * (1.0 - 1e-12)
        }
    }

    const SETTINGS: Settings =
        Settings { first: 1e-3, most: 1e9, fall: |mu| 0.1 * mu, rounding: 0.0, steps: 100, trials: usize::MAX };

    #[test]
    fn a_bent_valley_is_followed_to_its_end() {
        let (mut model, mut point, mut damping) = (Valley::default(), [-1.2, 1.0], SETTINGS.first);
        let found = descend(&mut model, &mut point, &mut damping, &SETTINGS).unwrap();
        assert!(found.is_settled && found.steps < 40 && model.refused > 0, "{found:?} {}", model.refused);
        assert!((point[0] - 1.0).abs() < 1e-10 && (point[1] - 1.0).abs() < 1e-10, "{point:?}");
    }

    #[test]
    fn budgets_end_a_descent_and_a_matrix_without_factor_is_an_error() {
        let (mut point, mut damping) = ([-1.2, 1.0], 1e-3);
        let few = Settings { steps: 2, ..SETTINGS };
        let found = descend(&mut Valley::default(), &mut point, &mut damping, &few).unwrap();
        assert_eq!(found, DescentEnd { steps: 2, is_settled: false });
        let tried = Settings { trials: 1, ..SETTINGS };
        assert!(descend(&mut Valley::default(), &mut point, &mut damping, &tried).unwrap().steps <= 1);
        let not_finite = descend(&mut Valley::default(), &mut [f64::NAN; 2], &mut damping, &SETTINGS);
        assert_eq!(not_finite, Ok(DescentEnd { steps: 0, is_settled: true }));
        let mut negative = 1e9;
        assert_eq!(lower(&mut Valley::default(), &mut point, 1.0, &mut negative, &SETTINGS, &mut 5), Err(()));
        assert_eq!(negative, SETTINGS.first);
    }
}
