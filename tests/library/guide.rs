//! The examples of JCGM 101:2008, clause 9, through the statistics of a study: the intervals that the guide prints.
//!
//! The guide's models are sums and products of drawn quantities, not fits, so what is tested is the tally, the order
//! statistics, the shortest interval and the standard errors; numbers in brackets are the guide's clauses and tables.

use palpate::scene::{EffectDraws, NoiseLaw};
use palpate_studies::montecarlo::{Tally, summarise};

const TRIALS: usize = 1_000_000;

/// `count` columns of standardised draws of a law.
fn columns(name: &str, law: NoiseLaw, count: usize) -> Vec<Vec<f64>> {
    let draws = EffectDraws::new(101, name).with_law(law);
    let column = |k: usize| {
        let mut out = vec![0.0; TRIALS];
        draws.gaussians(k as u64, 0, 1, &mut out);
        out
    };
    (0..count).map(column).collect()
}

fn summary(values: &[f64], level: f64) -> palpate::montecarlo::Summary {
    let mut tally = Tally::new(0.0, None);
    tally.extend(values);
    summarise(&tally, level, &[], None, 0.0, None)
}

fn near(found: f64, printed: f64, within: f64) {
    assert!((found - printed).abs() <= within, "{found}, the guide prints {printed}");
}

/// 9.2: Y = X1 + X2 + X3 + X4.
#[test]
fn additive_model() {
    let sums = |columns: &[Vec<f64>], scale: [f64; 4]| -> Vec<f64> {
        (0..TRIALS).map(|b| columns.iter().zip(scale).map(|(x, s)| s * x[b]).sum()).collect()
    };
    // 9.2.2, Table 2: four normal laws, u = 2.0, [-3.92, 3.92]
    let normal = columns("normal", NoiseLaw::Normal, 4);
    let s = summary(&sums(&normal, [1.0; 4]), 0.95);
    let i = s.symmetric.unwrap().interval;
    near(s.sd.unwrap(), 2.0, 0.005);
    near(i.lo, -3.92, 0.025);
    near(i.hi, 3.92, 0.025);
    // 9.2.3, Table 3: four rectangular laws of sd 1, u = 2.0, [-3.88, 3.88]
    let flat = columns("flat", NoiseLaw::Uniform, 4);
    let s = summary(&sums(&flat, [1.0; 4]), 0.95);
    let i = s.symmetric.unwrap().interval;
    near(s.sd.unwrap(), 2.0, 0.005);
    near(i.lo, -3.88, 0.02);
    near(i.hi, 3.88, 0.02);
    // 9.2.4, Table 4: one of them ten times wider, u = 10.1, [-17.0, 17.0]; the normal approximation says 19.9
    let s = summary(&sums(&flat, [1.0, 1.0, 1.0, 10.0]), 0.95);
    let i = s.symmetric.unwrap().interval;
    near(s.sd.unwrap(), 10.1, 0.06);
    near(i.lo, -17.0, 0.06);
    near(i.hi, 17.0, 0.06);
}

/// 9.3: mass calibration, dm = (mR + dmR)(1 + (a - a0)(1/rhoW - 1/rhoR)) - m0, Table 6, milligrams.
#[test]
fn mass_calibration() {
    let normal = columns("mass", NoiseLaw::Normal, 2);
    let flat = columns("densities", NoiseLaw::Uniform, 3);
    let half = 3.0_f64.sqrt();
    let values: Vec<f64> = (0..TRIALS)
        .map(|b| {
            let (mr, dmr) = (100_000.0 + 0.05 * normal[0][b], 1.234 + 0.02 * normal[1][b]);
            // half widths 0.1, 1000 and 50 kg/m3
            let (a, w, r) =
                (1.2 + 0.1 / half * flat[0][b], 8000.0 + 1000.0 / half * flat[1][b], 8000.0 + 50.0 / half * flat[2][b]);
            (mr + dmr) * (1.0 + (a - 1.2) * (1.0 / w - 1.0 / r)) - 100_000.0
        })
        .collect();
    let s = summary(&values, 0.95);
    // Table 7: 1.234 1, u 0.075 4, shortest [1.083 4, 1.382 5]
    near(s.mean.unwrap(), 1.2341, 0.0003);
    near(s.sd.unwrap(), 0.0754, 0.0002);
    let i = s.shortest.unwrap().interval;
    near(i.lo, 1.0834, 0.004);
    near(i.hi, 1.3825, 0.004);
    near(i.hi - i.lo, 1.3825 - 1.0834, 0.0015);
}

/// 9.5: gauge block, dL = Ls + D + d1 + d2 - Ls (da (theta0 + Delta) + as dtheta) - Lnom as a sum and products of draws,
/// nanometres, Table 11: 838, u 36, shortest 99 % interval [745, 932].
#[test]
fn gauge_block() {
    let t = |name: &str, dof: f64| columns(name, NoiseLaw::StudentT { dof }, 1).remove(0);
    // u of Student's laws scaled by the guide are those of the t law itself: sd = u sqrt(dof/(dof - 2))
    let wide = |dof: f64| (dof / (dof - 2.0)).sqrt();
    let (ls, d, d1, d2) = (t("Ls", 18.0), t("D", 24.0), t("d1", 5.0), t("d2", 8.0));
    let flat = columns("rectangles", NoiseLaw::Uniform, 3);
    let theta = columns("theta", NoiseLaw::Normal, 1).remove(0);
    let half = 3.0_f64.sqrt();
    // Delta: an arc sine law of half width 0.5
    let arc = EffectDraws::new(101, "arc sine");
    let mut phase = vec![0.0; TRIALS];
    arc.uniforms(0, 0, 1, &mut phase);
    // rectangles whose half width is itself uncertain (curvilinear trapezoids, 6.4.3)
    let mut wobble = [vec![0.0; TRIALS], vec![0.0; TRIALS]];
    EffectDraws::new(101, "limits").uniforms(0, 0, 1, &mut wobble[0]);
    EffectDraws::new(101, "limits").uniforms(1, 0, 1, &mut wobble[1]);
    let nominal = 50_000_000.0;
    let values: Vec<f64> = (0..TRIALS)
        .map(|b| {
            let ls = 50_000_623.0 + 25.0 * wide(18.0) * ls[b];
            let d = 215.0 + 6.0 * wide(24.0) * d[b] + 4.0 * wide(5.0) * d1[b] + 7.0 * wide(8.0) * d2[b];
            let alpha = 11.5e-6 + 2e-6 / half * flat[0][b];
            let theta = -0.1 + 0.2 * theta[b] + 0.5 * (std::f64::consts::TAU * phase[b]).sin();
            let limit = |half_width: f64, spread: f64, u: f64| half_width + spread * (2.0 * u - 1.0);
            let d_alpha = limit(1e-6, 0.1e-6, wobble[0][b]) / half * flat[1][b];
            let d_theta = limit(0.05, 0.025, wobble[1][b]) / half * flat[2][b];
            (ls * (1.0 + (alpha - d_alpha) * (theta - d_theta)) + d) / (1.0 + alpha * theta) - nominal
        })
        .collect();
    let s = summary(&values, 0.99);
    near(s.mean.unwrap(), 838.0, 0.6);
    near(s.sd.unwrap(), 36.0, 0.6);
    let i = s.shortest.unwrap().interval;
    near(i.lo, 745.0, 3.5);
    near(i.hi, 932.0, 3.5);
}
