//! Log evidence of several things that one sensor touches: each is where it likes, and contacts scatter alike about all of them.
//!
//! ```text
//! ln p = N_n/2 ln v - nu/2 ln(pi sum_k RSS_k) + ln Gamma(nu/2) - sum_k ln|A_k| / 2 + sum_k ln p(theta_k) + ln p(division) + ln p(sides)
//! ```
//!
//! `evidence` has it of one thing. A face of few contacts tells no scatter of its own, and all faces together do.

use std::f64::consts::PI;

use statrs::function::gamma::ln_gamma;

use super::evidence::{LinearisedBase, likeliest_ratio};
use super::sides::log_sides;
use super::tuning::Tuning;
use crate::dense;

/// Log evidence of things without departures, each among the contacts that those before it leave out.
pub(super) fn of_one_sensor(things: &[LinearisedBase], tuning: &Tuning) -> Option<f64> {
    let sides: Vec<[usize; 2]> = things.iter().map(|thing| thing.sides).collect();
    let apart: f64 = sides.iter().map(|own| log_sides(&[*own], tuning)).sum();
    let constant = things.iter().map(|thing| thing.constant + tuning.exact.ln()).sum::<f64>();
    let has_normals = things.iter().any(|thing| thing.rows[1] > 0.0);
    let (best, of_v) = if has_normals {
        let value = |log_v: f64| at_ratio(things, log_v.exp()).unwrap_or(f64::NEG_INFINITY);
        likeliest_ratio(scales(things), value, tuning)
    } else {
        (0.0, 0.0)
    };
    Some(at_ratio(things, best.exp())? + of_v + constant - apart + log_sides(&sides, tuning))
}

fn at_ratio(things: &[LinearisedBase], v: f64) -> Option<f64> {
    let (mut sum, mut log_det) = (0.0, 0.0);
    for thing in things {
        let own = thing.factored(&thing.plain, None, v)?;
        sum += own.sum;
        log_det += dense::log_det(&own.lower);
    }
    let freedom: f64 = things.iter().map(LinearisedBase::freedom).sum();
    let normals: f64 = things.iter().map(|thing| thing.rows[1]).sum();
    Some(0.5 * normals * v.ln() - 0.5 * freedom * (PI * sum).ln() + ln_gamma(0.5 * freedom) - 0.5 * log_det)
}

/// Root mean square scales of all things, by their contacts.
fn scales(things: &[LinearisedBase]) -> [f64; 2] {
    let count: f64 = things.iter().map(|thing| thing.rows[0]).sum();
    [0, 1].map(|k| (things.iter().map(|thing| thing.rows[0] * thing.sd[k].powi(2)).sum::<f64>() / count).sqrt())
}
