//! Random problems, hard in several ways at once.
//!
//! ```text
//! degrees 1 to 9, segments, sizes, offsets, sides     x     crowded, laned, clustered sites, holes     x     weights to 1e+-12
//! heights, slopes, rows that are missing, roughness, normals, slips under a robust loss, noise to be found
//! ```

use palpate::Contacts;
use palpate::fit::{FitOptions, NormalSigma, Objective, Robust, SlopeWeights, Smooth};
use palpate_laboratory::hard_cases::Lcg;

use super::touches::{Feels, Place, pick, sites, touches};

/// What is minimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    /// Heights alone.
    Heights,
    /// Heights and slopes.
    Slopes,
    /// Heights and slopes, some of whose rows weigh nothing.
    Mixed,
    /// With a roughness penalty, given or found.
    Smooth,
    /// Normal rows of known or found noise.
    Normals,
    /// Slips under Huber's or Tukey's loss.
    Robust,
    /// Slope rows whose weights are found with the fit.
    Estimated,
}

impl Family {
    /// All of them, in the order of the table.
    pub(crate) const ALL: [Family; 7] = [
        Family::Heights,
        Family::Slopes,
        Family::Mixed,
        Family::Smooth,
        Family::Normals,
        Family::Robust,
        Family::Estimated,
    ];

    /// Its word.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Family::Heights => "heights",
            Family::Slopes => "slopes",
            Family::Mixed => "mixed rows",
            Family::Smooth => "smoothing",
            Family::Normals => "normal rows",
            Family::Robust => "robust",
            Family::Estimated => "weights found",
        }
    }
}

/// One problem.
#[derive(Clone)]
pub(crate) struct RandomProblem {
    pub family: Family,
    pub contacts: Contacts,
    pub options: FitOptions,
    /// Explicit weights, or those that stand for weights to be found.
    pub weights: [f64; 3],
}

/// The problem of this seed and number; problems without full rank are drawn again, under the next `attempt`.
pub(crate) fn draw(seed: u64, number: u64, attempt: u64) -> RandomProblem {
    draw_with(seed, number, attempt, 0)
}

/// The same with at least so many contacts.
pub(crate) fn draw_with(seed: u64, number: u64, attempt: u64, least: usize) -> RandomProblem {
    let lcg = &mut Lcg::new(mixed(mixed(mixed(seed) ^ number) ^ attempt));
    let family = pick(lcg, &FAMILIES);
    let [degree, segments] = orders(lcg, family);
    let unknowns: usize = [0, 1].iter().map(|&k| degree[k] + segments[k]).product();
    let feels = feels(lcg, family);
    let rows_each = if feels == Feels::Heights { 1.0 } else { 3.0 };
    let count = ((1.1 + 3.0 * lcg.uniform()) * unknowns as f64 / rows_each) as usize + 3;
    let count = count.max(least);
    let place = Place::draw(lcg);
    let noise = match family {
        Family::Normals | Family::Robust | Family::Estimated => pick(lcg, &[1e-4, 1e-3, 1e-2, 0.1]),
        _ => pick(lcg, &[0.0, 1e-9, 1e-3, 0.1]),
    };
    let slips = if family == Family::Robust { 0.1 } else { 0.0 };
    let sites = sites(lcg, count);
    let mut contacts = touches(lcg, &sites, &place, feels, [noise, slips]);
    weigh_rows(lcg, family, &mut contacts);
    let weights = [0, 1, 2].map(|_| pick(lcg, &[1.0, 1.0, 1.0, 10.0, 0.01, 1e4, 1e-6, 1e12, 1e-12]));
    let options = FitOptions::default()
        .with_degrees(degree[0], degree[1])
        .with_segments(segments[0], segments[1])
        .with_domain(place.domain())
        .with_grid(5, 5);
    let options = with_family(lcg, family, options, weights, noise * place.unit());
    RandomProblem { family, contacts, options, weights }
}

/// How often each family comes.
const FAMILIES: [Family; 16] = [
    Family::Heights,
    Family::Heights,
    Family::Heights,
    Family::Slopes,
    Family::Slopes,
    Family::Slopes,
    Family::Slopes,
    Family::Slopes,
    Family::Mixed,
    Family::Mixed,
    Family::Smooth,
    Family::Smooth,
    Family::Normals,
    Family::Normals,
    Family::Robust,
    Family::Estimated,
];

/// Sebastiano Vigna's SplitMix64: neighbouring numbers give unrelated states.
fn mixed(value: u64) -> u64 {
    let a = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let b = (a ^ (a >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let c = (b ^ (b >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    c ^ (c >> 31)
}

/// Degrees and segments. Most problems are small, because a QR in 32 digits of 100 unknowns takes as long as 500 of 10.
fn orders(lcg: &mut Lcg, family: Family) -> [[usize; 2]; 2] {
    let most = match family {
        Family::Heights | Family::Slopes | Family::Mixed => pick(lcg, &[16, 16, 16, 16, 25, 25, 25, 36, 49, 100]),
        Family::Smooth | Family::Normals => pick(lcg, &[16, 16, 25]),
        Family::Robust | Family::Estimated => 16,
    };
    loop {
        let degree = [0, 1].map(|_| pick(lcg, &[1, 2, 2, 3, 3, 4, 5, 6, 7, 8, 9]));
        let segments = [0, 1].map(|_| pick(lcg, &[1, 1, 1, 2, 3, 4]));
        if (degree[0] + segments[0]) * (degree[1] + segments[1]) <= most {
            return [degree, segments];
        }
    }
}

fn feels(lcg: &mut Lcg, family: Family) -> Feels {
    match family {
        Family::Heights => Feels::Heights,
        Family::Slopes | Family::Mixed | Family::Estimated => Feels::Slopes,
        Family::Normals => Feels::Normals,
        Family::Smooth | Family::Robust => pick(lcg, &[Feels::Heights, Feels::Slopes]),
    }
}

/// Weights of single contacts: some of four or twelve decades, in mixed rows some of zero.
fn weigh_rows(lcg: &mut Lcg, family: Family, contacts: &mut Contacts) {
    let (spread, count) = (pick(lcg, &[0.0, 0.0, 0.0, 4.0, 12.0]), contacts.len());
    let mut column = |missing: f64| -> Vec<f64> {
        let mut weight = || match pick(lcg, &[0, 0, 1, -1]) {
            _ if lcg.uniform() < missing => 0.0,
            sign => 10_f64.powf(spread * f64::from(sign)),
        };
        (0..count).map(|_| weight()).collect()
    };
    match family {
        Family::Mixed => {
            (contacts.weights.z, contacts.weights.x) = (Some(column(0.3)), Some(column(0.3)));
            contacts.weights.y = Some(column(0.3));
        }
        Family::Heights | Family::Slopes | Family::Smooth if spread > 0.0 => contacts.weights.z = Some(column(0.0)),
        _ => {}
    }
}

fn with_family(lcg: &mut Lcg, family: Family, options: FitOptions, weights: [f64; 3], sd: f64) -> FitOptions {
    let explicit = Objective::Slopes(SlopeWeights::Explicit(weights));
    match family {
        Family::Heights | Family::Slopes | Family::Mixed => options.with_objective(explicit),
        Family::Smooth => {
            let lambda = pick(lcg, &[1e-12, 1e-6, 1e-3, 1.0, 1e3]);
            let smooth = if lcg.uniform() < 0.2 { Smooth::Auto } else { Smooth::Lambda(lambda) };
            options.with_objective(explicit).with_smooth(smooth)
        }
        Family::Normals => {
            let normal_deg = pick(lcg, &[0.01, 1.0, 5.0, 15.0]);
            let known = NormalSigma::Known { z: sd, normal_deg };
            let sigma = if lcg.uniform() < 0.25 { NormalSigma::Auto } else { known };
            options.with_objective(Objective::Normals(sigma))
        }
        Family::Robust => {
            let loss = pick(lcg, &[Robust::Huber, Robust::Tukey]);
            let objective = if lcg.uniform() < 0.5 { explicit } else { Objective::Slopes(SlopeWeights::Tangent) };
            options.with_objective(objective).with_robust(loss)
        }
        Family::Estimated => options.with_objective(Objective::Slopes(SlopeWeights::Auto)),
    }
}
