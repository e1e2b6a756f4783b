//! Which effect is to blame: shares of the variance of S and of R, by common random numbers.
//!
//! ```text
//! A: replicates b        B: the same effects' draws of replicates b + 2^41        C_e: A with B's draws of effect e alone
//! first-order share   corr(B, C_e): what e alone brings          total share   (mean (A - C_e)^2 / 2)/V: with all its company
//! share               (first-order + total)/2: its own part, and half of what it brings together with one other effect
//! ```
//!
//! First-order shares leave out what effects bring only together, total shares count it for each of them: neither adds up. The
//! mean of both is Shapley's share wherever effects meet in pairs (A. B. Owen, *SIAM/ASA J. Uncertainty Quantification* 2
//! (2014) 245), and these shares sum to one; a sum whose interval misses one tells of three effects that act together.
//!
//! Estimators of A. Janon et al. (*ESAIM: P&S* 18 (2014) 342) and M. Jansen (*Comp. Phys. Comm.* 117 (1999) 35). Intervals by
//! a jackknife over 32 groups of replicates, cut to [0, 1]; a share whose estimate falls below 0 by chance is given as 0. An
//! effect that is off, or has nothing random, has the share 0 exactly. The same scene and seed give the same bits.

use super::engine::Engine;
use super::linear_law::LinearLaw;
use super::noise_free_draws::AtRest;
use palpate_geometry::shape::Interval;
use palpate_numeric::draws::EffectDraws;
use palpate_world::scene::Simulator;

/// Where B's draws lie: beyond all replicates that a study may have.
const BEYOND: u64 = 1 << 41;
/// Groups of the jackknife.
const GROUPS: usize = 32;
/// Student's t for 31 degrees of freedom, 95 %.
const T: f64 = 2.039_5;

/// A share with its interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// The share, 0 to 1; `None` where nothing varies or all is undefined.
    pub share: Option<f64>,
    /// 95 % interval, cut to [0, 1].
    pub interval: Option<Interval>,
}

/// One effect's part in the variance of S and of R.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EffectShare {
    /// Its name.
    pub name: String,
    /// Shares of S and R: the mean of the first-order and the total share, which sums to one where effects meet in pairs.
    pub share: [Share; 2],
    /// First-order shares of S and R.
    pub first: [Share; 2],
    /// Total shares of S and R.
    pub total: [Share; 2],
    /// Sd of S and R with this effect alone, the others at rest.
    pub alone: [Option<f64>; 2],
    /// Shares by the linear law.
    pub linear: [Option<f64>; 2],
}

/// Shares of all effects.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attribution {
    /// Replicates of A; of B and every C_e as many.
    pub replicates: usize,
    /// One entry an effect that is compiled in.
    pub effects: Vec<EffectShare>,
    /// Sums of the shares of S and R, with intervals; 1 where no three effects act together.
    pub sum: [Share; 2],
}

/// Replicates that the shares take at least: those of A, of B, and of two designs for each random stage.
pub(super) fn least_replicates(simulator: &Simulator) -> usize {
    let random = simulator.stages().iter().filter(|stage| stage.draws_per_contact() > 0).count();
    (2 + 2 * random) * GROUPS
}

/// Replicates of each design where all designs together may take so many.
pub(super) fn affordable(simulator: &Simulator, replicates: u64) -> usize {
    usize::try_from(replicates).unwrap_or(usize::MAX) / least_replicates(simulator) * GROUPS
}

/// Shares of every stage, from `count` replicates a design.
pub fn attribute(engine: &Engine, seed: u64, count: usize, linear: &LinearLaw) -> Attribution {
    let count = count.next_multiple_of(GROUPS);
    let simulator = engine.simulator();
    let a = engine.values_from(&|stage| simulator.draws(stage, seed), 0, count).columns;
    let b = engine.values_from(&|stage| simulator.draws(stage, seed).later(BEYOND), 0, count).columns;
    let rest = AtRest::shared(simulator);
    let mut effects = Vec::new();
    let mut groups_of_sum = [vec![0.0; GROUPS + 1], vec![0.0; GROUPS + 1]];
    let all: f64 = 0.0;
    let linear_sum = linear.by_stage.iter().fold([all; 2], |sum, (_, v)| [sum[0] + v[0], sum[1] + v[1]]);
    for (number, stage) in simulator.stages().iter().enumerate() {
        let mut own = EffectShare { name: stage.name().into(), ..EffectShare::default() };
        if stage.draws_per_contact() == 0 {
            let zero = Share { share: Some(0.0), interval: Some(Interval { lo: 0.0, hi: 0.0 }) };
            (own.share, own.first, own.total) = ([zero; 2], [zero; 2], [zero; 2]);
            (own.alone, own.linear) = ([Some(0.0); 2], [Some(0.0); 2]);
            effects.push(own);
            continue;
        }
        let draws = |k: usize| {
            let draws = simulator.draws(k, seed);
            if k == number { draws.later(BEYOND) } else { draws }
        };
        let c = engine.values_from(&draws, 0, count).columns;
        let only = |k: usize| {
            if k == number { simulator.draws(k, seed) } else { EffectDraws::from_source(rest[k].clone()) }
        };
        let alone = engine.values_from(&only, 0, count).columns;
        for q in 0..2 {
            let first = jackknife(|keep| correlation(&b[q], &c[q], keep));
            let total = jackknife(|keep| correlation(&a[q], &c[q], keep).map(|r| 1.0 - r));
            let both: Vec<f64> = first.iter().zip(&total).map(|(first, total)| 0.5 * (first + total)).collect();
            groups_of_sum[q].iter_mut().zip(&both).for_each(|(sum, share)| *sum += share);
            own.share[q] = share(&both);
            own.first[q] = share(&first);
            own.total[q] = share(&total);
            own.alone[q] = sd(&alone[q]);
            let variance = linear.by_stage.iter().find(|(name, _)| *name == stage.name()).map(|(_, v)| v[q]);
            own.linear[q] = variance.filter(|_| linear_sum[q] > 0.0).map(|v| v / linear_sum[q]);
        }
        effects.push(own);
    }
    let random = simulator.stages().iter().any(|stage| stage.draws_per_contact() > 0);
    let sum = groups_of_sum.map(|groups| if random { share_up_to(&groups, f64::INFINITY) } else { Share::default() });
    Attribution { replicates: count, effects, sum }
}

/// The estimate from all replicates, and from all but each group.
fn jackknife(estimate: impl Fn(&dyn Fn(usize) -> bool) -> Option<f64>) -> Vec<f64> {
    let mut values = vec![estimate(&|_| true).unwrap_or(f64::NAN)];
    values.extend((0..GROUPS).map(|group| estimate(&|b| b % GROUPS != group).unwrap_or(f64::NAN)));
    values
}

fn share(values: &[f64]) -> Share {
    share_up_to(values, 1.0)
}

fn share_up_to(values: &[f64], most: f64) -> Share {
    let whole = values[0];
    if values.iter().any(|v| v.is_nan()) {
        return Share::default();
    }
    let n = GROUPS as f64;
    let mean = values[1..].iter().sum::<f64>() / n;
    let variance = (n - 1.0) / n * values[1..].iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
    let half = T * variance.sqrt();
    let cut = |v: f64| v.clamp(0.0, most);
    Share { share: Some(cut(whole)), interval: Some(Interval { lo: cut(whole - half), hi: cut(whole + half) }) }
}

/// `(mean xy - m^2)/(mean (x^2 + y^2)/2 - m^2)`, m the mean of both: Janon's estimator. `None` where nothing varies.
fn correlation(x: &[f64], y: &[f64], keep: &dyn Fn(usize) -> bool) -> Option<f64> {
    let kept = || {
        let both = x.iter().zip(y).enumerate();
        both.filter(|(b, (x, y))| keep(*b) && x.is_finite() && y.is_finite()).map(|(_, (x, y))| (*x, *y))
    };
    let n = kept().count() as f64;
    if n < 2.0 {
        return None;
    }
    let m = kept().map(|(x, y)| 0.5 * (x + y)).sum::<f64>() / n;
    let (mut product, mut square) = (0.0, 0.0);
    for (x, y) in kept() {
        product += (x - m) * (y - m);
        square += 0.5 * ((x - m) * (x - m) + (y - m) * (y - m));
    }
    (square > 0.0).then(|| product / square)
}

fn sd(values: &[f64]) -> Option<f64> {
    let kept = || values.iter().copied().filter(|v| v.is_finite());
    let n = kept().count() as f64;
    if n < 2.0 {
        return None;
    }
    let mean = kept().sum::<f64>() / n;
    Some((kept().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0)).sqrt())
}
