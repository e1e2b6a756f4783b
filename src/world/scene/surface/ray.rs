//! Where a line from above first meets a surface that has no closed form for it: scan, then bisect.
//!
//! `F(t)` is positive above the surface. The scan has [`STEPS`] steps over the range that can hold the surface; a
//! fold thinner than one step can be missed. Bisection then runs to the last bit of t. Only tilted torus, superquadric,
//! Gaussian bump, sinusoid, monkey saddle and imported surfaces come here; upright ones have closed forms.

/// Steps of the scan. 1/512 of the range is thinner than any wave that contacts at a few stations could show.
const STEPS: usize = 512;

/// The greatest t in `[low, high]` where `value` falls through zero coming from above.
pub(super) fn first_below(low: f64, high: f64, value: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let step = (high - low) / STEPS as f64;
    let mut above = None;
    for i in (0..=STEPS).rev() {
        let t = low + step * i as f64;
        match (value(t), above) {
            (Some(f), Some(top)) if f <= 0.0 => return Some(bisect(t, top, &value)),
            (Some(f), _) => above = (f > 0.0).then_some(t),
            (None, _) => above = None,
        }
    }
    None
}

fn bisect(mut below: f64, mut above: f64, value: &impl Fn(f64) -> Option<f64>) -> f64 {
    loop {
        let middle = below + 0.5 * (above - below);
        if middle <= below || middle >= above {
            return below;
        }
        match value(middle) {
            Some(f) if f > 0.0 => above = middle,
            _ => below = middle,
        }
    }
}

/// Parameters where the line `o + t d` enters and leaves a ball; `None` when it misses.
pub(super) fn through_ball(o: [f64; 3], d: [f64; 3], centre: [f64; 3], radius: f64) -> Option<(f64, f64)> {
    let w = [o[0] - centre[0], o[1] - centre[1], o[2] - centre[2]];
    let b = w[0] * d[0] + w[1] * d[1] + w[2] * d[2];
    let c = w[0] * w[0] + w[1] * w[1] + w[2] * w[2] - radius * radius;
    let under = b * b - c;
    (under >= 0.0).then(|| (-b - under.sqrt(), -b + under.sqrt()))
}

/// Parameters where the line is between two heights; `None` when it runs horizontally or downwards.
pub(super) fn through_slab(o: [f64; 3], d: [f64; 3], low: f64, high: f64) -> Option<(f64, f64)> {
    (d[2] > 0.0).then(|| ((low - o[2]) / d[2], (high - o[2]) / d[2]))
}

/// A little more than the range, so that both its ends lie off the surface.
pub(super) fn widened((low, high): (f64, f64)) -> (f64, f64) {
    let margin = 1e-3 * (high - low);
    (low - margin, high + margin)
}

/// A range that holds an unbounded height field about the patch: four times the patch's distance from the origin.
pub(super) fn about_the_patch(o: [f64; 3], d: [f64; 3], length: f64) -> Option<(f64, f64)> {
    let half = 4.0 * (o[0].hypot(o[1]).hypot(o[2]) + length);
    through_slab(o, d, -half, half)
}
