//! Known errors in x and y: every contact is moved to where it most likely lies, and rows on which such errors show more
//! weigh less.
//!
//! ```text
//! P = x + d, d ~ N(0, s^2)      measured and true place       r = (z - S, n - n(S_x, S_y)) at x = e - G d,  G = [S_x S_y; J H]
//! d = -(1/s^2 + G'N^-1 G)^-1 G'N^-1 r                         N: variances of heights and of normals or slopes
//! rows at x = P - d, about the same readings carried along:   z - grad S.d,  n - J H d,  slopes - H d
//! variance   N_z + s^2 |grad S|^2 of a height,   N_n + s^2 |J H|^2/2 of a normal per axis (slopes: J = 1)
//! ```
//!
//! Orthogonal distance regression: P. T. Boggs, R. H. Byrd, R. B. Schnabel, *SIAM J. Sci. Stat. Comput.* 8 (1987) 1052.
//! Weights alone, with the contacts left where they are said to lie, would bend the surface too little, because errors in
//! place blur it. Where N is estimated, it is what the residuals leave beyond s (R. C. Paule, J. Mandel, *J. Res. Natl. Bur.
//! Stand.* 87 (1982) 377).

use ndarray::Array2;

use crate::fit::FitError;
use crate::fit::noise::sds::NoiseSource;
use crate::fit::notes::Note;
use crate::fit::objective::budget::Budget;
use crate::fit::objective::fitted::{Fitted, Moved};
use crate::fit::placing::Patch;
use crate::observation::Data;
use palpate_geometry::contact::{Contacts, Orientation};
use palpate_geometry::surface::{HeightField, SurfacePoint};
use palpate_numeric::linalg::SiteWeights;

/// Fits at most; the contacts stand still after 5 to 20.
const MAX_FITS: usize = 60;
/// Moves and weights that change by less than this, in patch units and in shares, change S and R in the sixth digit.
const SETTLED: f64 = 1e-7;
/// Least noise of heights and of normals, as a share of what errors in place add: with none at all a row on level ground
/// would count for everything.
const LEAST_NOISE: f64 = 1e-2;
/// A contact is moved by this many sds at most.
const FARTHEST: f64 = 4.0;

/// What errors in place of one contact come to under a surface.
struct Place {
    /// Most likely place.
    at: [f64; 2],
    /// The surface there.
    surface: SurfacePoint,
    /// Variance that they add to a height, and to a normal or slope per axis, over s^2.
    added: [f64; 2],
}

/// Fits contacts whose places have errors of this sd in x and in y, input units; `fit_at` fits contacts as they lie.
///
/// # Errors
/// Those of `fit_at`, and [`FitError::Objective`] for a grid, whose pixels lie where they are said to lie.
pub(super) fn fit_located(
    patch: &Patch,
    data: &Data,
    sigma_xy: f64,
    budget: &Budget,
    fit_at: impl Fn(&Data) -> Result<Fitted, FitError>,
) -> Result<Fitted, FitError> {
    let Data::Scattered { contacts, numbers } = data else {
        return Err(FitError::Objective { objective: "sigma_xy", needed: "scattered contacts" });
    };
    let scale = patch.frame.scale;
    let sd = sigma_xy / scale;
    let mut fitted = fit_at(data)?;
    let mut places: Vec<[f64; 2]> = contacts.x.iter().zip(&contacts.y).map(|(x, y)| [*x, *y]).collect();
    let mut noise: Option<[f64; 2]> = None;
    let mut factors = vec![[1.0; 2]; contacts.len()];
    for fits in 2..=MAX_FITS {
        let surface = surface_of(patch, &fitted)?;
        let found = noise_of(&fitted, scale);
        let before: Vec<[f64; 2]> = places.iter().map(|[x, y]| added(contacts, &surface.at(*x, *y))).collect();
        let variances = next_noise(noise, found, &before, sd, fitted.noise.source() == NoiseSource::Sigma);
        let moved: Vec<Place> =
            (0..contacts.len()).map(|r| located(contacts, r, &surface, places[r], variances, sd)).collect();
        let next: Vec<[f64; 2]> = moved.iter().map(|place| factors_of(place.added, variances, sd)).collect();
        let change =
            largest_change(&places, moved.iter().map(|p| p.at)).max(largest_change(&factors, next.iter().copied()));
        places = moved.iter().map(|place| place.at).collect();
        (factors, noise) = (next, Some(variances));
        let there = Data::Scattered { contacts: carried(contacts, &moved), numbers: numbers.clone() };
        let [z, slope] = [0, 1].map(|b| factors.iter().map(|f| f[b]).collect::<Vec<f64>>());
        let there = there.reweighted(&z, &slope);
        fitted = fit_at(&there)?;
        if change < SETTLED || fits == MAX_FITS || budget.is_spent() {
            fitted.notes.push(Note::Located { moved: scale * rms_of_moves(contacts, &places), fits });
            let covariances = covariances(contacts, &moved, &fitted, variances, sd);
            fitted.moved = Some(Moved { data: there, covariances });
            break;
        }
    }
    Ok(fitted)
}

fn surface_of(patch: &Patch, fitted: &Fitted) -> Result<HeightField, FitError> {
    let [n, m] = [0, 1].map(|k| patch.knots[k].n_basis());
    let coefficients = Array2::from_shape_fn((n, m), |(i, j)| fitted.solution.coefficients[i * m + j]);
    Ok(HeightField::new(patch.knots.clone(), coefficients)?)
}

fn largest_change(before: &[[f64; 2]], now: impl Iterator<Item = [f64; 2]>) -> f64 {
    let changes = before.iter().zip(now).flat_map(|(a, b)| [(a[0] - b[0]).abs(), (a[1] - b[1]).abs()]);
    changes.fold(0.0_f64, f64::max)
}

/// Variances of heights and of normals or slopes that a fit declares or finds, patch units.
fn noise_of(fitted: &Fitted, scale: f64) -> [f64; 2] {
    let sds = fitted.noise.sds(&fitted.equations, &fitted.solution);
    let slope = sds.sigma_normal_deg.map(f64::to_radians).or(sds.sigma_slope);
    [sds.sigma_z.unwrap_or(0.0) / scale, slope.unwrap_or(0.0)].map(|sd| sd * sd)
}

/// Variances without what errors in place add. A fit under the factors of `now` finds `now` where these are right; where it
/// does not, one step of Newton's method on that condition.
fn next_noise(now: Option<[f64; 2]>, found: [f64; 2], added: &[[f64; 2]], sd: f64, is_known: bool) -> [f64; 2] {
    [0, 1].map(|b| {
        if is_known {
            return found[b];
        }
        let of = |f: &dyn Fn(f64) -> f64| added.iter().map(|a| f(sd * sd * a[b])).sum::<f64>() / added.len() as f64;
        let mean = of(&|k| k);
        let next = match now {
            Some(now) => now[b] + (found[b] / now[b] - 1.0) / of(&|k| 1.0 / (now[b] + k)),
            None => found[b] - mean,
        };
        next.max(LEAST_NOISE * LEAST_NOISE * mean).max(f64::MIN_POSITIVE.sqrt())
    })
}

/// Factors of a contact's rows, `[heights, slopes]`.
fn factors_of(added: [f64; 2], variances: [f64; 2], sd: f64) -> [f64; 2] {
    [0, 1].map(|b| (variances[b] / (variances[b] + sd * sd * added[b])).sqrt())
}

/// `J'J` of the normal by the slopes, and the identity for slopes.
fn metric(contacts: &Contacts, s: &SurfacePoint) -> [f64; 3] {
    if !matches!(contacts.orientation, Orientation::Normals { .. }) {
        return [1.0, 0.0, 1.0];
    }
    let w4 = (1.0 + s.zx * s.zx + s.zy * s.zy).powi(2);
    [(1.0 + s.zy * s.zy) / w4, -s.zx * s.zy / w4, (1.0 + s.zx * s.zx) / w4]
}

/// `H M H` of the Hessian H.
fn bent([a, b, c]: [f64; 3], s: &SurfacePoint) -> [f64; 3] {
    let times = |u: [f64; 2]| [a * u[0] + b * u[1], b * u[0] + c * u[1]];
    let (first, second) = ([s.zxx, s.zxy], [s.zxy, s.zyy]);
    let dot = |u: [f64; 2], v: [f64; 2]| u[0] * v[0] + u[1] * v[1];
    [dot(first, times(first)), dot(first, times(second)), dot(second, times(second))]
}

fn added(contacts: &Contacts, s: &SurfacePoint) -> [f64; 2] {
    let [a, _, c] = bent(metric(contacts, s), s);
    [s.zx * s.zx + s.zy * s.zy, 0.5 * (a + c)]
}

/// Where a contact most likely lies, by one step from `from`.
fn located(
    contacts: &Contacts,
    r: usize,
    surface: &HeightField,
    from: [f64; 2],
    variances: [f64; 2],
    sd: f64,
) -> Place {
    let s = surface.at(from[0], from[1]);
    let back = [contacts.x[r] - from[0], contacts.y[r] - from[1]];
    let weight = |column: &Option<Vec<f64>>| column.as_ref().map_or(1.0, |w| w[r] * w[r]);
    let heights = weight(&contacts.weights.z) / variances[0];
    let slopes = weight(&contacts.weights.x).min(weight(&contacts.weights.y)) / variances[1];
    let gradient = [s.zx, s.zy];
    let residual = contacts.z[r] - s.z - s.zx * back[0] - s.zy * back[1];
    let mut a = [1.0 / (sd * sd), 0.0, 1.0 / (sd * sd)];
    let mut b = [0.0; 2];
    if heights > 0.0 {
        a[0] += heights * s.zx * s.zx;
        a[1] += heights * s.zx * s.zy;
        a[2] += heights * s.zy * s.zy;
        (0..2).for_each(|k| b[k] += heights * gradient[k] * residual);
    }
    if let (Some([p, q]), true) = (misfit_of_slopes(contacts, r, &s), slopes > 0.0) {
        let h = bent(metric(contacts, &s), &s);
        (0..3).for_each(|k| a[k] += slopes * h[k]);
        b[0] += slopes * (s.zxx * p + s.zxy * q - h[0] * back[0] - h[1] * back[1]);
        b[1] += slopes * (s.zxy * p + s.zyy * q - h[1] * back[0] - h[2] * back[1]);
    }
    let d = limited(solved(a, b), FARTHEST * sd);
    let at = [contacts.x[r] - d[0], contacts.y[r] - d[1]];
    let surface = surface.at(at[0], at[1]);
    Place { at, added: added(contacts, &surface), surface }
}

/// `-a^-1 b` for a symmetric matrix by its upper triangle.
fn solved(a: [f64; 3], b: [f64; 2]) -> [f64; 2] {
    let determinant = a[0] * a[2] - a[1] * a[1];
    [-(a[2] * b[0] - a[1] * b[1]) / determinant, -(a[0] * b[1] - a[1] * b[0]) / determinant]
}

/// A move no longer than `most`; none where it is not finite.
fn limited(d: [f64; 2], most: f64) -> [f64; 2] {
    let length = d[0].hypot(d[1]);
    if !length.is_finite() {
        return [0.0; 2];
    }
    if length > most { d.map(|v| v * most / length) } else { d }
}

/// `J'(n - n(S))` of a normal, or the difference of slopes.
fn misfit_of_slopes(contacts: &Contacts, r: usize, s: &SurfacePoint) -> Option<[f64; 2]> {
    match &contacts.orientation {
        Orientation::None => None,
        Orientation::Slopes { zx, zy } => Some([zx[r] - s.zx, zy[r] - s.zy]),
        Orientation::Normals { nx, ny, nz } => {
            let by_slopes = normal_by_slopes(s);
            Some(by_slopes.map(|j| j[0] * nx[r] + j[1] * ny[r] + j[2] * nz[r]))
        }
    }
}

/// Derivatives of the unit normal by S_x and by S_y; J'n(S) = 0.
fn normal_by_slopes(s: &SurfacePoint) -> [[f64; 3]; 2] {
    let (p, q) = (s.zx, s.zy);
    let w3 = (1.0 + p * p + q * q).powf(1.5);
    [[-(1.0 + q * q) / w3, p * q / w3, -p / w3], [p * q / w3, -(1.0 + p * p) / w3, -q / w3]]
}

/// The contacts in their places, their readings carried along.
fn carried(contacts: &Contacts, places: &[Place]) -> Contacts {
    let mut there = contacts.clone();
    for (r, Place { at, surface: s, .. }) in places.iter().enumerate() {
        let d = [contacts.x[r] - at[0], contacts.y[r] - at[1]];
        let turned = [s.zxx * d[0] + s.zxy * d[1], s.zxy * d[0] + s.zyy * d[1]];
        (there.x[r], there.y[r]) = (at[0], at[1]);
        there.z[r] -= s.zx * d[0] + s.zy * d[1];
        match &mut there.orientation {
            Orientation::None => {}
            Orientation::Slopes { zx, zy } => (zx[r], zy[r]) = (zx[r] - turned[0], zy[r] - turned[1]),
            Orientation::Normals { nx, ny, nz } => {
                let [by_x, by_y] = normal_by_slopes(s);
                let n = [0, 1, 2].map(|k| [nx[r], ny[r], nz[r]][k] - by_x[k] * turned[0] - by_y[k] * turned[1]);
                // a normal that lay on its side stays as it is, where it would be turned to face down
                if n[2] >= 0.0 {
                    let length = n[0].hypot(n[1]).hypot(n[2]);
                    (nx[r], ny[r], nz[r]) = (n[0] / length, n[1] / length, n[2] / length);
                }
            }
        }
    }
    there
}

fn covariances(contacts: &Contacts, places: &[Place], fitted: &Fitted, variances: [f64; 2], sd: f64) -> Vec<[f64; 6]> {
    let weights = &fitted.equations.row_weights;
    let of = |(r, place): (usize, &Place)| row_covariance(contacts, &place.surface, &weights.at(r), variances, sd);
    places.iter().enumerate().map(of).collect()
}

/// `T Sigma T'` of a site's rows `T = [z . .; . a b; . . d]` in height and slopes, `Sigma = N + s^2 (grad S, H)(grad S, H)'`.
fn row_covariance(contacts: &Contacts, s: &SurfacePoint, w: &SiteWeights, variances: [f64; 2], sd: f64) -> [f64; 6] {
    let [a, b, c] = metric(contacts, s);
    let (determinant, square) = (a * c - b * b, sd * sd);
    // variances of slopes for a normal's error that is alike in all directions
    let own = [c, -b, a].map(|m| variances[1] * m / determinant);
    let [hpp, hpq, hqq] = bent([1.0, 0.0, 1.0], s);
    let [pp, pq, qq] = [own[0] + square * hpp, own[1] + square * hpq, own[2] + square * hqq];
    let zz = variances[0] + square * (s.zx * s.zx + s.zy * s.zy);
    let zp = square * (s.zx * s.zxx + s.zy * s.zxy);
    let zq = square * (s.zx * s.zxy + s.zy * s.zyy);
    [
        w.z * w.z * zz,
        w.z * (w.a * zp + w.b * zq),
        w.z * w.d * zq,
        w.a * w.a * pp + 2.0 * w.a * w.b * pq + w.b * w.b * qq,
        w.d * (w.a * pq + w.b * qq),
        w.d * w.d * qq,
    ]
}

fn rms_of_moves(contacts: &Contacts, places: &[[f64; 2]]) -> f64 {
    let squares =
        places.iter().enumerate().map(|(r, [x, y])| (contacts.x[r] - x).powi(2) + (contacts.y[r] - y).powi(2));
    (squares.sum::<f64>() / places.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{FitOptions, NormalSigma, Objective, fit_contacts, fit_grid};
    use palpate_geometry::contact::Grid;
    use palpate_numeric::draws::EffectDraws;

    const ERROR: f64 = 0.3;

    /// A saddle z = x y / 10 touched at 12 x 12 places of [-4, 4]^2 that are known to 0.3.
    fn touched(replicate: u64) -> Contacts {
        let mut errors = vec![0.0; 3 * 144];
        let draws = EffectDraws::new(3, "located");
        errors.chunks_mut(36).enumerate().for_each(|(block, part)| draws.gaussians(replicate, block as u64, 36, part));
        let place = |k: usize| 8.0 * k as f64 / 11.0 - 4.0;
        let (x, y): (Vec<f64>, Vec<f64>) = (0..144).map(|r| (place(r / 12), place(r % 12))).unzip();
        let z = (0..144).map(|r| 0.1 * x[r] * y[r] + 0.02 * errors[r]).collect();
        let normals: Vec<[f64; 3]> = (0..144).map(|r| [-0.1 * y[r], -0.1 * x[r], 1.0]).collect();
        let off = |v: &[f64], block: usize| (0..144).map(|r| v[r] + ERROR * errors[block * 144 + r]).collect();
        Contacts::from_positions(off(&x, 1), off(&y, 2), z).with_normal_vectors(&normals)
    }

    #[test]
    fn a_saddle_touched_in_wrong_places_keeps_its_curvature_and_its_interval() {
        let objective = Objective::Normals(NormalSigma::Known { z: 0.02, normal_deg: 2.0 });
        let options = FitOptions::default().with_objective(objective).with_domain([-3.0, 3.0, -3.0, 3.0]);
        let options = FitOptions { outside: crate::fit::OutsideDomain::Extend, ..options };
        let truth = fit_contacts(&exact(), &options).unwrap().shape().curvedness.mean.unwrap();
        let (mut off, mut held) = ([0.0; 2], 0);
        const COUNT: u64 = 40;
        for replicate in 0..COUNT {
            let contacts = touched(replicate);
            for (k, sigma_xy) in [0.0, ERROR].into_iter().enumerate() {
                let fit = fit_contacts(&contacts, &options.clone().with_sigma_xy(sigma_xy)).unwrap();
                let found = &fit.shape().curvedness;
                off[k] += (found.mean.unwrap() / truth - 1.0) / COUNT as f64;
                let interval = found.interval.unwrap();
                held += u64::from(k == 1 && interval.lo <= truth && truth <= interval.hi);
            }
        }
        assert!(off[0] < -0.01 && off[1].abs() < 0.4 * off[0].abs(), "{off:?}");
        assert!(held >= 34, "{held} of {COUNT}");
    }

    fn exact() -> Contacts {
        let place = |k: usize| 8.0 * k as f64 / 11.0 - 4.0;
        let (x, y): (Vec<f64>, Vec<f64>) = (0..144).map(|r| (place(r / 12), place(r % 12))).unzip();
        let normals: Vec<[f64; 3]> = (0..144).map(|r| [-0.1 * y[r], -0.1 * x[r], 1.0]).collect();
        let z = x.iter().zip(&y).map(|(x, y)| 0.1 * x * y).collect();
        Contacts::from_positions(x, y, z).with_normal_vectors(&normals)
    }

    #[test]
    fn a_grid_lies_where_it_lies() {
        let axis: Vec<f64> = (0..6).map(f64::from).collect();
        let grid = Grid::new(axis.clone(), axis, ndarray::Array2::zeros((6, 6)));
        let refused = fit_grid(&grid, &FitOptions::default().with_sigma_xy(0.1));
        assert!(matches!(refused, Err(FitError::Objective { objective: "sigma_xy", .. })), "{refused:?}");
    }
}
