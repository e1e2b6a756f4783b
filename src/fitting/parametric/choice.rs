//! The choice between a height field and a parametric surface, from how much the measured normals vary.
//!
//! ```text
//! parametric, if   more than one smoothed normal in twenty is over 20 degrees + 1.5 sd of their noise from the mean one
//!            or    some smoothed normal is over 56 degrees (slope 1.5) + 1.5 sd of their noise from z
//! ```
//!
//! On the paper's patches a height field of degree 2 is off in R by 3 % where normals are 12 degrees from the mean one and by
//! 12 % where they are 24, a parametric surface by 0.1 % (`cargo bench --bench parametric -- auto`). One normal in twenty
//! is needed, so that a single poor one decides nothing. The noise raises the limits because a parametric surface, being of
//! degree 3, has less bias but more noise: with normals wrong by 14 degrees a pipe whose normals are 26 degrees from the
//! mean one is better fitted by a height field.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use super::vector::{Vector, dot, minus, unit};
use crate::fit::{FitOptions, SurfaceKind};
use palpate_geometry::contact::{Contacts, Orientation};
use palpate_numeric::statistics::{Rank, quantile};

/// Largest angle of a smoothed normal from z, degrees, for which a height field is taken.
const STEEP_DEG: f64 = 56.0;
/// Largest angle from the mean normal, degrees, for which a height field is taken.
const SPREAD_DEG: f64 = 20.0;
/// Share of the normals that may be farther from the mean one.
const BEYOND: f64 = 0.05;
/// Sds of the noise that are added to the limits: half of one is left in the smoothed normals, and one is what the third
/// degree costs.
const NOISE: f64 = 1.5;
/// Contacts that one normal is smoothed over, a sweep of three fingers: fewer leave more noise, more smooth the shape away.
const NEAREST: usize = 27;
/// Columns of the local fit: 1 and three offsets.
const COLUMNS: usize = 4;
/// Fewer contacts than this are not smoothed.
const FEWEST_CONTACTS: usize = 2 * COLUMNS;
/// Most contacts that are used; every pair of such a contact and a smoothed normal takes 10 ns.
const POOL: usize = 2000;
/// Most normals that are smoothed.
const SITES: usize = 200;

/// `Height` or `Parametric` for these contacts, and the reason in words.
pub fn choose_surface(contacts: &Contacts, options: &FitOptions) -> (SurfaceKind, String) {
    match options.surface {
        SurfaceKind::Auto => by_normals(contacts, options),
        kind => (kind, "asked for".into()),
    }
}

fn by_normals(contacts: &Contacts, options: &FitOptions) -> (SurfaceKind, String) {
    if options.closed != [false; 2] {
        return (SurfaceKind::Parametric, "a direction closes".into());
    }
    if contacts.orientation == Orientation::None || contacts.is_empty() {
        return (SurfaceKind::Height, "without normals there is nothing to hold a surface in space".into());
    }
    let Some(Smoothed { normals, noise }) = smoothed(contacts) else {
        return (SurfaceKind::Height, "the contacts have no single side".into());
    };
    let mean = unit(normals.iter().fold([0.0; 3], |m, n| [0, 1, 2].map(|k| m[k] + n[k])));
    let angles: Vec<f64> = normals.iter().map(|n| dot(*n, mean).clamp(-1.0, 1.0).acos().to_degrees()).collect();
    let spread = quantile(angles, 1.0 - BEYOND, Rank::FloorOfSteps).unwrap_or(0.0);
    let steepest = normals.iter().map(|n| n[0].hypot(n[1]).atan2(n[2]).to_degrees()).fold(0.0, f64::max);
    let of = format!("smoothed normals (noise {noise:.1} degrees)");
    if spread > SPREAD_DEG + NOISE * noise {
        return (SurfaceKind::Parametric, format!("{of} turn by {spread:.0} degrees from the mean one"));
    }
    if steepest > STEEP_DEG + NOISE * noise {
        return (SurfaceKind::Parametric, format!("{of} are up to {steepest:.0} degrees from z"));
    }
    let limit = SPREAD_DEG + NOISE * noise;
    (SurfaceKind::Height, format!("{of} turn by {spread:.0} degrees from the mean one, not above {limit:.0}"))
}

/// Smoothed normals, and the sd of the noise of the measured ones per tangent axis, degrees.
struct Smoothed {
    normals: Vec<Vector>,
    noise: f64,
}

/// Fits `n ~ a + B (P - P_0)` over the nearest contacts of up to [`SITES`] of them, which is exact on planes, balls and
/// bars. `None` where there are no normals.
fn smoothed(contacts: &Contacts) -> Option<Smoothed> {
    let stride = contacts.len().div_ceil(POOL).max(1);
    let pool: Vec<(Vector, Vector)> = (0..contacts.len())
        .step_by(stride)
        .filter_map(|r| Some(([contacts.x[r], contacts.y[r], contacts.z[r]], contacts.unit_normal(r)?)))
        .collect();
    if pool.len() < FEWEST_CONTACTS {
        let normals: Vec<Vector> = pool.iter().map(|p| p.1).collect();
        return (!normals.is_empty()).then_some(Smoothed { normals, noise: 0.0 });
    }
    let (mut normals, mut squares, mut free) = (Vec::new(), 0.0, 0.0);
    for site in pool.iter().step_by(pool.len().div_ceil(SITES)) {
        let mut near: Vec<(f64, &(Vector, Vector))> = pool
            .iter()
            .map(|other| {
                let d = minus(other.0, site.0);
                (dot(d, d), other)
            })
            .collect();
        let count = NEAREST.min(near.len());
        near.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0));
        near.truncate(count);
        let plane = local_plane(site.0, &near);
        normals.push(unit(plane(site.0)));
        squares += near.iter().map(|(_, (p, n))| squared(minus(*n, unit(plane(*p))))).sum::<f64>();
        free += 2.0 * (count - COLUMNS) as f64;
    }
    Some(Smoothed { normals, noise: (squares / free).sqrt().to_degrees() })
}

fn squared(v: Vector) -> f64 {
    dot(v, v)
}

/// Least squares of the normals by 1 and the offsets from `from`.
fn local_plane(from: Vector, near: &[(f64, &(Vector, Vector))]) -> impl Fn(Vector) -> Vector + use<> {
    let reach = near.iter().map(|n| n.0).fold(0.0, f64::max).sqrt().max(f64::MIN_POSITIVE);
    let columns = move |p: Vector| {
        let d = minus(p, from);
        [1.0, d[0] / reach, d[1] / reach, d[2] / reach]
    };
    let rows: Vec<[f64; COLUMNS]> = near.iter().map(|(_, (p, _))| columns(*p)).collect();
    let sum = |f: &dyn Fn(usize) -> f64| (0..rows.len()).map(f).sum::<f64>();
    // contacts in a plane do not determine the third slope: a millionth of the trace keeps it at zero
    let small = |i: usize, j: usize| if i == j { 1e-6 * rows.len() as f64 } else { 0.0 };
    let normal = Mat::from_fn(COLUMNS, COLUMNS, |i, j| sum(&|r| rows[r][i] * rows[r][j]) + small(i, j));
    let right = Mat::from_fn(COLUMNS, 3, |i, d| sum(&|r| rows[r][i] * near[r].1.1[d]));
    // a factor fails only where numbers overflow; NaN normals then lead to a height field, whose checks name the fault
    let solved: [Vector; COLUMNS] = normal.llt(Side::Lower).map_or([[f64::NAN; 3]; COLUMNS], |factor| {
        let solved = factor.solve(&right);
        std::array::from_fn(|k| [0, 1, 2].map(|d| solved[(k, d)]))
    });
    move |p| {
        let row = columns(p);
        [0, 1, 2].map(|d| (0..COLUMNS).map(|k| row[k] * solved[k][d]).sum())
    }
}
