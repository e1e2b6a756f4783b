//! Random problems, hard in several ways at once: degrees, segments, crowded or laned sites, noise, weights, offsets.

use palpate::Contacts;
use palpate::fit::{FitOptions, Objective, SlopeWeights};
use palpate::internals::cases::Lcg;
use palpate::internals::linalg::DoubleDouble as Dd;
use palpate::spline::Knots;

use super::oracle::{Problem, Solved};

/// One problem and the answer of the oracle.
pub(crate) struct RandomProblem {
    pub contacts: Contacts,
    pub options: FitOptions,
    pub solved: Solved,
}

/// Draws until the oracle finds full rank.
pub(crate) fn draw(lcg: &mut Lcg) -> RandomProblem {
    loop {
        let (contacts, options, weights) = problem(lcg);
        let [x0, x1, y0, y1] = options.domain.unwrap_or_default();
        let knots = [(x0, x1, 0), (y0, y1, 1)]
            .map(|(lo, hi, k)| Knots::uniform(options.degree[k], options.segments[k], lo, hi).unwrap());
        let grid = [(x0, x1), (y0, y1)].map(|(lo, hi)| exact_linspace(lo, hi, options.grid[0]));
        let [kx, ky] = [0, 1].map(|k| knots[k].as_slice());
        let oracle = Problem { contacts: &contacts, degree: options.degree, knots: [kx, ky], weights };
        if let Some(solved) = oracle.solve([&grid[0], &grid[1]]) {
            return RandomProblem { contacts, options, solved };
        }
    }
}

/// Grid points not rounded to the input's own ulp: far from the origin that would be another place.
fn exact_linspace(low: f64, high: f64, points: usize) -> Vec<Dd> {
    let step = (Dd::new(high) - Dd::new(low)) / Dd::new((points - 1) as f64);
    (0..points).map(|i| Dd::new(low) + Dd::new(i as f64) * step).collect()
}

fn pick<T: Copy>(lcg: &mut Lcg, choices: &[T]) -> T {
    choices[(lcg.uniform() * choices.len() as f64) as usize]
}

fn problem(lcg: &mut Lcg) -> (Contacts, FitOptions, [f64; 3]) {
    let degree = [0, 1].map(|_| pick(lcg, &[1, 2, 2, 3, 3, 4]));
    let segments = [0, 1].map(|_| pick(lcg, &[1, 1, 2, 3]));
    let unknowns: usize = [0, 1].iter().map(|&k| degree[k] + segments[k]).product();
    let with_slopes = lcg.uniform() < 0.7;
    let rows_each = if with_slopes { 3.0 } else { 1.0 };
    let count = ((1.2 + 3.0 * lcg.uniform()) * unknowns as f64 / rows_each) as usize + 3;
    let half = pick(lcg, &[4.0, 4.0, 1.0, 1e-6, 1e6]);
    let offset = half * pick(lcg, &[0.0, 0.0, 1024.0, 1048576.0]);
    let weights = [0, 1, 2].map(|_| pick(lcg, &[1.0, 1.0, 10.0, 0.01, 1e4, 1e-6]));
    let contacts = touches(lcg, count, half, offset, with_slopes);
    let domain = [offset - half, offset + half, offset - half, offset + half];
    let objective = Objective::Slopes(SlopeWeights::Explicit(weights));
    let options = FitOptions::default()
        .with_degrees(degree[0], degree[1])
        .with_segments(segments[0], segments[1])
        .with_domain(domain)
        .with_objective(objective)
        .with_grid(5, 5);
    (contacts, options, weights)
}

/// A random cubic of slopes below about one, with noise.
fn touches(lcg: &mut Lcg, count: usize, half: f64, offset: f64, with_slopes: bool) -> Contacts {
    let site = {
        let crowding = pick(lcg, &[0, 0, 1, 2]);
        let lanes = pick(lcg, &[0.0, 0.0, 4.0]);
        move |lcg: &mut Lcg| {
            let mut u = lcg.uniform();
            (0..crowding).for_each(|_| u *= lcg.uniform());
            2.0 * if lanes > 0.0 { (u * lanes).floor() / (lanes - 1.0) } else { u } - 1.0
        }
    };
    let a: Vec<f64> = (0..9).map(|_| 2.0 * lcg.uniform() - 1.0).collect();
    let noise = pick(lcg, &[0.0, 1e-9, 1e-3, 0.1]);
    let row_weights = lcg.uniform() < 0.25;
    let mut data = Contacts::default();
    let (mut zx, mut zy, mut wz) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..count {
        let (u, v) = (site(lcg), 2.0 * lcg.uniform() - 1.0);
        let height =
            a[0] * u + a[1] * v + a[2] * u * u + a[3] * u * v + a[4] * v * v + a[5] * u * u * u + a[6] * u * v * v;
        let slope_u = a[0] + 2.0 * a[2] * u + a[3] * v + 3.0 * a[5] * u * u + a[6] * v * v;
        let slope_v = a[1] + a[3] * u + 2.0 * a[4] * v + 2.0 * a[6] * u * v;
        data.x.push(offset + half * u);
        data.y.push(offset + half * v);
        data.z.push(half * (height + noise * lcg.normal()));
        zx.push(slope_u + noise * lcg.normal());
        zy.push(slope_v + noise * lcg.normal());
        wz.push(pick(lcg, &[1.0, 1.0, 1e4, 1e-4]));
    }
    data.weights.z = row_weights.then_some(wz);
    if with_slopes { data.with_slopes(zx, zy) } else { data }
}
