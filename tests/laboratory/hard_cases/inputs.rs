//! What the cases are made of: sites, and analytic surfaces in IEEE `+ - * / sqrt`.
//!
//! The order of every operation matters: `tests/golden/inputs.py` repeats it and must get the same bits.

use palpate_fitting::fit::{FitOptions, NormalSigma, Objective, SlopeWeights};
use palpate_geometry::contact::Contacts;
pub(super) use palpate_numeric::bspline::linspace;
pub(super) use palpate_numeric::draws::Lcg;

/// The 8 x 8 patch of the paper.
pub(super) const FULL: [f64; 4] = [-4.0, 4.0, -4.0, 4.0];

/// Finger-major: all stations of the first finger, then of the next.
pub(super) fn sites(fingers: &[f64], stations: &[f64]) -> Vec<[f64; 2]> {
    fingers.iter().flat_map(|&f| stations.iter().map(move |&s| [f, s])).collect()
}

/// This many fingers at equal distances over -4..4, and nine stations along each.
pub(super) fn sweep(fingers: usize) -> Vec<[f64; 2]> {
    sites(&linspace(-4.0, 4.0, fingers), &linspace(-4.0, 4.0, 9))
}

/// Height and slopes `[z, zx, zy]` of a sphere with its apex at the origin.
pub(super) fn sphere(radius: f64) -> impl Fn(f64, f64) -> [f64; 3] {
    move |x, y| {
        let d2 = x * x + y * y;
        let root = (radius * radius - d2).sqrt();
        [-d2 / (radius + root), -x / root, -y / root]
    }
}

/// The same of a cylinder whose generators run along (1, 1).
pub(super) fn cylinder45(radius: f64) -> impl Fn(f64, f64) -> [f64; 3] {
    move |x, y| {
        let d = x - y;
        let d2 = d * d / 2.0;
        let root = (radius * radius - d2).sqrt();
        [-d2 / (radius + root), -d / (2.0 * root), d / (2.0 * root)]
    }
}

/// `z = -(x^2 + y^2) / 16`: exact in doubles at integer sites.
pub(super) fn paraboloid(x: f64, y: f64) -> [f64; 3] {
    [-(x * x + y * y) / 16.0, -x / 8.0, -y / 8.0]
}

/// Heights alone.
pub(super) fn with_heights(sites: &[[f64; 2]], mut surface: impl FnMut(f64, f64) -> [f64; 3]) -> Contacts {
    let z = sites.iter().map(|s| surface(s[0], s[1])[0]).collect();
    Contacts::from_positions(column(sites, 0), column(sites, 1), z)
}

/// Heights and slopes.
pub(super) fn with_slopes(sites: &[[f64; 2]], mut surface: impl FnMut(f64, f64) -> [f64; 3]) -> Contacts {
    let touches: Vec<[f64; 3]> = sites.iter().map(|s| surface(s[0], s[1])).collect();
    let of = |k: usize| touches.iter().map(|t| t[k]).collect::<Vec<f64>>();
    Contacts::from_positions(column(sites, 0), column(sites, 1), of(0)).with_slopes(of(1), of(2))
}

/// Heights and normals `(-zx, -zy, 1)`, not of length one.
pub(super) fn with_normals(sites: &[[f64; 2]], mut surface: impl FnMut(f64, f64) -> [f64; 3]) -> Contacts {
    let touches: Vec<[f64; 3]> = sites.iter().map(|s| surface(s[0], s[1])).collect();
    let of = |k: usize| touches.iter().map(|t| t[k]).collect::<Vec<f64>>();
    let down = |k: usize| touches.iter().map(|t| -t[k]).collect::<Vec<f64>>();
    let up = vec![1.0; sites.len()];
    Contacts::from_positions(column(sites, 0), column(sites, 1), of(0)).with_normals(down(1), down(2), up)
}

fn column(sites: &[[f64; 2]], k: usize) -> Vec<f64> {
    sites.iter().map(|s| s[k]).collect()
}

/// One segment over the 8 x 8 patch.
pub(super) fn options(degree: usize, objective: Objective) -> FitOptions {
    FitOptions { degree: [degree, degree], domain: Some(FULL), objective, ..FitOptions::default() }
}

/// Weights as they are.
pub(super) fn explicit(wz: f64, wx: f64, wy: f64) -> Objective {
    Objective::Slopes(SlopeWeights::Explicit([wz, wx, wy]))
}

/// Unit weights on raw heights and slopes.
pub(super) fn equal() -> Objective {
    explicit(1.0, 1.0, 1.0)
}

/// The tangent preset.
pub(super) fn tangent() -> Objective {
    Objective::Slopes(SlopeWeights::Tangent)
}

/// Normal rows with known standard deviations.
pub(super) fn normal_rows(z: f64, normal_deg: f64) -> Objective {
    Objective::Normals(NormalSigma::Known { z, normal_deg })
}
