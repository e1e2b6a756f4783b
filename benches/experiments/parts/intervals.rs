//! How often the intervals of sizes and directions hold the truth: whole bodies and halves, with errors that are each contact's own and with
//! errors that neighbours share.
//!
//! ```text
//! p <- p + (s g + e(p)) n,   e(p) = s_e sqrt(2 / 40) sum_k cos(w_k . p + phi_k)      w ~ N(0, 1/l^2): neighbours within l err alike
//! n <- turned as the surface displaced by e has it, and by an error of its own
//! half: 180 degrees about the axis; cap: a ball within 35 to 70 degrees of its pole
//! ```
//!
//! A size is inside where |error| <= 1.96 u, an axis where its angle to the truth is within sqrt(5.99) u.

use palpate::Contacts;
use palpate::parts::{PartKind, Parts, PartsOptions};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::{Vector, along, axes_along, cross, dot, norm, unit};

use super::bodies::Random;

/// Waves of an error that neighbours share.
const WAVES: u64 = 40;

/// The kinds, each once whole and once in part.
const KINDS: [PartKind; 4] = [PartKind::Sphere, PartKind::Cylinder, PartKind::Cone, PartKind::Torus];

/// A primitive about the z axis, its contacts, and what is true of it.
pub(crate) struct Touched {
    pub(crate) points: Vec<Vector>,
    pub(crate) normals: Vec<Vector>,
    pub(crate) spacing: f64,
    pub(crate) sizes: [Option<f64>; 3],
}

/// A primitive of the kind, about as large as 1.
fn touched(kind: PartKind, in_part: bool, r: &mut impl FnMut(f64, f64) -> f64) -> Touched {
    let count = r(400_f64.ln(), 6000_f64.ln()).exp() as usize;
    let turn = if in_part { 180.0 } else { 360.0_f64 }.to_radians();
    let (length, angle, tube) = (r(1.0, 4.0), r(10.0, 35.0_f64).to_radians(), r(0.2, 0.6));
    let pole = if in_part { r(35.0, 70.0_f64).to_radians() } else { std::f64::consts::PI };
    let place = |u: f64, v: f64| -> (Vector, Vector) {
        let (sin, cos) = (turn * u).sin_cos();
        match kind {
            PartKind::Sphere => {
                let (s, c) = (std::f64::consts::TAU * u).sin_cos();
                let z = 1.0 - v * (1.0 - pole.cos());
                let rho = (1.0 - z * z).max(0.0).sqrt();
                ([rho * c, rho * s, z], [rho * c, rho * s, z])
            }
            PartKind::Cylinder => ([cos, sin, length * (v - 0.5)], [cos, sin, 0.0]),
            PartKind::Cone => {
                let h = 2.0 * (v - 0.5);
                let rho = 1.2 + h * angle.tan();
                ([rho * cos, rho * sin, h], [angle.cos() * cos, angle.cos() * sin, -angle.sin()])
            }
            _ => {
                let (s, c) = (std::f64::consts::TAU * v).sin_cos();
                ([(1.0 + tube * c) * cos, (1.0 + tube * c) * sin, tube * s], [c * cos, c * sin, s])
            }
        }
    };
    let spread = |k: usize| [0.754_877_666, 0.569_840_290_998].map(|step: f64| (0.5 + step * (k + 1) as f64).fract());
    let (points, normals) = (0..count).map(|k| place(spread(k)[0], spread(k)[1])).unzip();
    let area = match kind {
        PartKind::Sphere => std::f64::consts::TAU * (1.0 - pole.cos()),
        PartKind::Cylinder => turn * length,
        PartKind::Cone => turn * 1.2 * 2.0 / angle.cos(),
        _ => turn * std::f64::consts::TAU * tube,
    };
    let radius = matches!(kind, PartKind::Sphere | PartKind::Cylinder | PartKind::Torus).then_some(1.0);
    let minor = (kind == PartKind::Torus).then_some(tube);
    let sizes = [radius, minor, (kind == PartKind::Cone).then_some(angle.to_degrees())];
    Touched { points, normals, spacing: (area / count as f64).sqrt(), sizes }
}

/// The contacts with errors, and the axis.
pub(crate) fn with_errors(
    body: &Touched,
    shared: bool,
    measured: bool,
    seed: u64,
    r: &mut impl FnMut(f64, f64) -> f64,
) -> (Contacts, Vector) {
    let draws = EffectDraws::new(seed, "intervals");
    let own = r(0.05, 0.3) * body.spacing;
    let size = if shared { own * r(0.5, 1.5) } else { 0.0 };
    let length = body.spacing * r(1.5, 4.0);
    let turned = r(1.0, 4.0_f64).to_radians();
    let waves: Vec<[f64; 4]> = (0..WAVES)
        .map(|k| {
            let mut g = [0.0; 3];
            draws.gaussians(1 << 40, 3 * k, 3, &mut g);
            [g[0] / length, g[1] / length, g[2] / length, std::f64::consts::TAU * r(0.0, 1.0)]
        })
        .collect();
    let scale = size * (2.0 / WAVES as f64).sqrt();
    let error =
        |p: Vector| waves.iter().map(|w| scale * (w[0] * p[0] + w[1] * p[1] + w[2] * p[2] + w[3]).cos()).sum::<f64>();
    let pose = axes_along(unit([r(-1.0, 1.0), r(-1.0, 1.0), r(0.2, 1.0)]));
    let posed = |p: Vector| [0, 1, 2].map(|k| p[0] * pose[0][k] + p[1] * pose[1][k] + p[2] * pose[2][k]);
    let (mut points, mut normals) = (Vec::new(), Vec::new());
    for (k, (p, n)) in body.points.iter().zip(&body.normals).enumerate() {
        let mut g = [0.0; 3];
        draws.gaussians(k as u64, 0, 3, &mut g);
        points.push(posed(along(*p, own * g[0] + error(*p), *n)));
        let [u, v, _] = axes_along(*n);
        let step = 0.01 * body.spacing;
        let slope = |d: Vector| (error(along(*p, step, d)) - error(along(*p, -step, d))) / (2.0 * step);
        let tilted = along(along(*n, turned * g[1] - slope(u), u), turned * g[2] - slope(v), v);
        normals.push(posed(unit(tilted)));
    }
    let contacts = Contacts::from_points(&points);
    (if measured { contacts.with_normal_vectors(&normals) } else { contacts }, pose[2])
}

/// Errors over u of what is known of one row of the table.
#[derive(Default)]
struct Row {
    asked: usize,
    other: usize,
    sizes: [Vec<f64>; 4],
}

/// The table of so many bodies of each kind.
pub(crate) fn print(bodies: u64, first: u64) {
    println!(
        "{bodies} bodies a row from seed {first}; inside, %, of those named rightly, with the root mean square of error / u"
    );
    println!(
        "{:<10} {:<6} {:<7} {:>6} {:>14} {:>14} {:>14} {:>14}",
        "kind", "body", "errors", "named", "radius", "minor radius", "half angle", "axis"
    );
    for kind in KINDS {
        for (in_part, shared) in [(false, false), (false, true), (true, false), (true, true)] {
            let mut row = Row::default();
            (first..first + bodies).for_each(|seed| ask(kind, in_part, shared, seed, &mut row));
            let cells: String =
                (0..4).map(|k| cell(&row.sizes[k], if k == 3 { 5.99_f64.sqrt() } else { 1.96 })).collect();
            let words = [if in_part { "part" } else { "whole" }, if shared { "shared" } else { "own" }];
            println!("{:<10} {:<6} {:<7} {:>6}{cells}", kind.name(), words[0], words[1], row.asked - row.other);
        }
    }
}

/// Share of these errors over u that are at most so large, and their root mean square.
pub(crate) fn cell(z: &[f64], most: f64) -> String {
    if z.is_empty() {
        return format!(" {:>14}", "");
    }
    let count = z.len() as f64;
    let inside = z.iter().filter(|z| z.abs() <= most).count() as f64;
    let rms = (z.iter().map(|z| z * z).sum::<f64>() / count).sqrt();
    format!(" {:>14}", format!("{:.1} ({rms:.2})", 100.0 * inside / count))
}

fn ask(kind: PartKind, in_part: bool, shared: bool, seed: u64, row: &mut Row) {
    let mut random = Random(seed.wrapping_mul(101).wrapping_add(kind.name().len() as u64));
    let mut r = |lo: f64, hi: f64| random.between(lo, hi);
    let body = touched(kind, in_part, &mut r);
    let (contacts, truth) = with_errors(&body, shared, seed.is_multiple_of(2), seed, &mut r);
    row.asked += 1;
    let Ok(found) = Parts::of(&contacts, &PartsOptions::default()) else { return row.other += 1 };
    let [part] = &found.parts[..] else { return row.other += 1 };
    if part.kind != kind {
        return row.other += 1;
    }
    let (g, u) = (&part.geometry, &part.u);
    let found = [(g.radius, u.radius), (g.minor_radius, u.minor_radius), (g.half_angle_deg, u.half_angle_deg)];
    for (k, (value, u)) in found.into_iter().enumerate() {
        if let (Some(value), Some(u), Some(truth)) = (value, u, body.sizes[k]) {
            row.sizes[k].push((value - truth) / u);
        }
    }
    if let (Some(axis), Some(u)) = (g.axis, u.axis_deg) {
        row.sizes[3].push(norm(cross(axis, truth)).atan2(dot(axis, truth).abs()).to_degrees() / u);
    }
}
