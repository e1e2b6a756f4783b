//! The distance of a family to the true surface as a function of mean S or R, and the least length that it forces.
//!
//! ```text
//! from the nearest member on, S or R is held half an sd farther each time, and the nearest member that has it is sought again
//! between two members the distance is taken as linear: it is convex, so that this is no less than it is
//! ```

use statrs::distribution::{ContinuousCDF, Normal};

use super::descent::{descend, dot, products, solve};
use super::member::Member;
use super::view::{Held, View};

/// (mean S or R, distance) in order.
pub(crate) type Profile = Vec<[f64; 2]>;

/// Distance at which a member is left out of an interval as often as not at all.
const FAR: f64 = 5.0;

/// Members on one side.
const MEMBERS: usize = 20;

/// Intervals of the integral.
const CELLS: usize = 20_000;

/// Standard deviation of mean S or R as a fit of this family knows it; `None` where the family fixes it.
pub(crate) fn sd(view: &View, member: &Member, q: usize) -> Option<f64> {
    let (columns, slopes) = view.derivatives(member, None)?;
    if slopes.iter().all(|s| s[q].abs() < 1e-7) {
        return None;
    }
    let (f, sizes) = products(&columns);
    let g: Vec<f64> = slopes.iter().zip(&sizes).map(|(s, size)| s[q] / size).collect();
    Some(dot(&g, &solve(&f, &g, 1e-10)).sqrt())
}

/// Members to both sides of the nearest.
pub(crate) fn follow(view: &View, nearest: &Member, q: usize) -> Profile {
    let point = |member: &Member| Some([view.shape(member)?[q], view.distance(member)?]);
    let Some(first) = point(nearest) else { return Profile::new() };
    let Some(sd) = sd(view, nearest, q).filter(|sd| sd.is_finite()) else { return Profile::new() };
    let mut profile = vec![first];
    for side in [1.0, -1.0] {
        let mut member = nearest.clone();
        for k in 1..=MEMBERS {
            let held = Held { quantity: q, value: first[0] + side * 0.5 * sd * k as f64, within: 0.02 * sd };
            let Some((next, _)) = descend(view, member, Some(held), 20) else { break };
            let Some(found) = point(&next).filter(|_| view.is_touched(&next)) else { break };
            profile.push(found);
            member = next;
            if found[1] > FAR {
                break;
            }
        }
    }
    profile.sort_by(|a, b| a[0].total_cmp(&b[0]));
    profile
}

fn distance(profile: &Profile, value: f64) -> f64 {
    let between = |pair: &[[f64; 2]]| {
        let [[v, d], [w, e]] = [pair[0], pair[1]];
        (v <= value && value <= w && w > v).then(|| d + (e - d) * (value - v) / (w - v))
    };
    profile.windows(2).filter_map(between).fold(f64::INFINITY, f64::min)
}

/// Least length by several families.
pub(crate) fn length(profiles: &[&Profile]) -> f64 {
    let normal = Normal::new(0.0, 1.0).expect("a normal law");
    let one_sided = normal.inverse_cdf(0.95);
    let low = profiles.iter().filter_map(|p| p.first()).map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let high = profiles.iter().filter_map(|p| p.last()).map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
    if high <= low {
        return 0.0;
    }
    let cell = (high - low) / CELLS as f64;
    let left_out = |k: usize| {
        let value = low + (k as f64 + 0.5) * cell;
        let nearest = profiles.iter().map(|p| distance(p, value)).fold(f64::INFINITY, f64::min);
        normal.cdf(one_sided - nearest)
    };
    cell * (0..CELLS).map(left_out).sum::<f64>()
}
