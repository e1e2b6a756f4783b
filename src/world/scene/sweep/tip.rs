//! First contact of a ball of radius rho whose centre comes down over `c`:
//!
//! ```text
//! maximise  h(P) + sqrt(rho^2 - |P - c|^2)  over |P - c| <= rho;      stationary:  P + rho n_xy(P) = c
//! ```
//!
//! The maximum over the disc is first looked for on a polar lattice, because a ball may rest on two places and bridge the
//! hollow between them. Newton's method then solves the stationary condition to rounding; the condition is linear on
//! spheres, cylinders and planes. A ball that rests on an edge without a normal has no contact here.

use crate::scene::rotation::sin_cos_deg;
use crate::scene::surface::{Surface, SurfacePoint};

/// Lattice of starting points: rings x directions. Bodies with features narrower than rho/8 need more.
const RINGS: usize = 8;
const DIRECTIONS: usize = 16;
/// Largest residual accepted, relative to the lengths in it.
const TOLERANCE: f64 = 1e-12;
/// Newton doubles its digits each step; 60 leaves room for damped ones.
const STEPS: usize = 60;

pub(super) fn rolled(surface: &Surface, aim: [f64; 2], radius: f64) -> Option<SurfacePoint> {
    let start = highest(surface, aim, radius)?;
    let mut touch = surface.at(start[0], start[1])?;
    let mut miss = residual(&touch, aim, radius);
    let scale = radius + aim[0].abs() + aim[1].abs();
    for _ in 0..STEPS {
        let Some(next) = improved(surface, &touch, aim, radius, miss) else { break };
        touch = next;
        miss = residual(&touch, aim, radius);
        if size(miss) == 0.0 {
            break;
        }
    }
    (size(miss) <= TOLERANCE * scale).then_some(touch)
}

/// Point of the lattice whose tip centre is highest: where the ball touches first, roughly.
fn highest(surface: &Surface, aim: [f64; 2], radius: f64) -> Option<[f64; 2]> {
    let mut best: Option<(f64, [f64; 2])> = None;
    let mut consider = |reach: f64, degrees: f64| {
        let (sin, cos) = sin_cos_deg(degrees);
        let at = [aim[0] + reach * cos, aim[1] + reach * sin];
        if let Some(height) = surface.height(at[0], at[1]) {
            let centre = height + ((radius - reach) * (radius + reach)).max(0.0).sqrt();
            if best.is_none_or(|(top, _)| centre > top) {
                best = Some((centre, at));
            }
        }
    };
    consider(0.0, 0.0);
    for ring in 1..=RINGS {
        for direction in 0..DIRECTIONS {
            consider(radius * ring as f64 / RINGS as f64, 360.0 * direction as f64 / DIRECTIONS as f64);
        }
    }
    best.map(|(_, at)| at)
}

/// `P + rho n_xy(P) - c`.
fn residual(touch: &SurfacePoint, aim: [f64; 2], radius: f64) -> [f64; 2] {
    [0, 1].map(|k| (touch.point[k] - aim[k]) + radius * touch.local.normal[k])
}

fn size(miss: [f64; 2]) -> f64 {
    miss[0].hypot(miss[1])
}

/// One damped Newton step that makes the residual smaller; `None` when none does.
fn improved(
    surface: &Surface,
    touch: &SurfacePoint,
    aim: [f64; 2],
    radius: f64,
    miss: [f64; 2],
) -> Option<SurfacePoint> {
    let [column_x, column_y] = [0, 1].map(|axis| change(surface, touch, aim, radius, miss, axis));
    let ([a, c], [b, d]) = (column_x?, column_y?);
    let determinant = a * d - b * c;
    let step = [(d * miss[0] - b * miss[1]) / determinant, (a * miss[1] - c * miss[0]) / determinant];
    let mut fraction = 1.0;
    while fraction > 1e-6 {
        let at = [touch.point[0] - fraction * step[0], touch.point[1] - fraction * step[1]];
        if let Some(next) = surface.at(at[0], at[1])
            && size(residual(&next, aim, radius)) < size(miss)
        {
            return Some(next);
        }
        fraction *= 0.5;
    }
    None
}

/// Derivative of the residual along x or y, by a difference towards whichever side the surface reaches.
fn change(
    surface: &Surface,
    touch: &SurfacePoint,
    aim: [f64; 2],
    radius: f64,
    miss: [f64; 2],
    axis: usize,
) -> Option<[f64; 2]> {
    // cube root of rounding would suit a central difference; Newton needs only a direction
    let step = 1e-7 * (radius + touch.point[0].abs() + touch.point[1].abs());
    [step, -step].into_iter().find_map(|h| {
        let mut at = [touch.point[0], touch.point[1]];
        at[axis] += h;
        let near = surface.at(at[0], at[1])?;
        let moved = residual(&near, aim, radius);
        Some([(moved[0] - miss[0]) / h, (moved[1] - miss[1]) / h])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_a_ball_the_contact_is_where_the_centres_line_passes() {
        let (radius, tip) = (6.0, 1.5);
        let ball = Surface::sphere(radius);
        for aim in [[0.0, 0.0], [4.0, -4.0], [1.0, 5.0], [5.0, 5.0]] {
            let touch = rolled(&ball, aim, tip).unwrap();
            for (found, aim) in touch.point.iter().zip(aim) {
                assert!((found - aim * radius / (radius + tip)).abs() < 1e-14 * radius);
            }
        }
        assert!(rolled(&ball, [5.4, 5.4], tip).is_none());
    }

    #[test]
    fn inside_a_groove_contacts_lie_further_out() {
        let (radius, tip) = (10.0, 2.0);
        let groove = Surface::cylinder(radius).turned(90.0).concave();
        let touch = rolled(&groove, [3.0, 1.0], tip).unwrap();
        assert!((touch.point[0] - 3.0 * radius / (radius - tip)).abs() < 1e-13);
        assert!((touch.point[1] - 1.0).abs() < 1e-14);
    }
}
