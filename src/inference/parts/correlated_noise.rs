//! Errors that neighbours share: what a primitive leaves over in a neighbourhood much wider than that of a point.
//!
//! ```text
//! u(m) = quantile over 120 places of the rms residual of the best primitive through the m nearest contacts        m = 40, ..., n/40
//! ```
//!
//! Independent errors leave the same at every width. A depth camera's errors, and normals computed from positions, leave more
//! the wider one looks. They are let pass while parts are looked for. No wider than a fortieth of the cloud, because wider
//! neighbourhoods reach over edges even in the middle of a box's face.

use super::cloud::{Cloud, NEAREST};
use super::hypothesis::{Walk, best, sampled};
use super::local::{LocalShapes, Noise, ROUNDING};
use super::tuning::PartsTuning;
use crate::primitives::descent::Sample;
use palpate_numeric::statistics::{ENOUGH_FOR_RANKS, Rank, evenly_among, quantile};
use palpate_numeric::vector::{dot, minus};

/// Places that are looked at.
const PLACES: usize = 120;

/// Largest part of the cloud in one neighbourhood.
const WIDEST: usize = 40;

/// Contacts of a neighbourhood that are fitted.
const SAMPLED: usize = 150;

/// The largest noise that is found at any width.
pub(super) fn wide_noise(cloud: &Cloud, shapes: &LocalShapes, noise: &Noise, tuning: &PartsTuning) -> Noise {
    let asked: Vec<u32> = evenly_among(cloud.len(), ENOUGH_FOR_RANKS).map(|i| i as u32).collect();
    let variances = shapes.of(cloud, &asked).into_iter().map(|shape| shape.variance[0]);
    let mut order: Vec<(f64, u32)> = variances.zip(asked).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let places: Vec<usize> = (0..PLACES).map(|k| order[k * order.len() / PLACES].1 as usize).collect();
    let mut widest = *noise;
    let mut walk = Walk::new(cloud.len());
    let mut width = 2 * NEAREST;
    while width <= cloud.len() / WIDEST {
        let mut left: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
        for &place in &places {
            // the other wall of a pipe is no error that neighbours share
            let faces = |i: usize| dot(cloud.normals[place], cloud.normals[i]) > tuning.faces_away;
            let members = walk.reach(cloud, &[place as u32], width, faces);
            let Some([distance, normal]) = residuals(cloud, &members, &widest, tuning) else { continue };
            left[0].push(distance);
            left[1].push(normal);
        }
        let [distance, normal] = left.map(|values| quantile(values, tuning.wide_within, Rank::Floor).unwrap_or(0.0));
        widest = Noise { distance: widest.distance.max(distance), normal: widest.normal.max(normal) };
        width *= 2;
    }
    widest
}

/// Root mean squares, corrected for the unknowns.
fn residuals(cloud: &Cloud, members: &[u32], noise: &Noise, tuning: &PartsTuning) -> Option<[f64; 2]> {
    let (points, normals) = sampled(cloud, members, SAMPLED);
    let sample = Sample { points: &points, normals: &normals, u_distance: noise.distance, u_normal: noise.normal };
    let primitive = best(&sample, &[], tuning)?.primitive;
    let (mut distances, mut angles) = (0.0, 0.0);
    for (p, n) in points.iter().zip(&normals) {
        let (d, normal) = primitive.nearest(*p);
        let off = minus(normal, *n);
        distances += d * d;
        angles += dot(off, off);
    }
    let freedom = points.len() as f64 - primitive.kind.free().len() as f64 / 3.0;
    Some([(distances / freedom).sqrt().max(ROUNDING), (0.5 * angles / freedom).sqrt().max(ROUNDING)])
}
