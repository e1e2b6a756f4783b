//! What the cases are made of: sites, analytic surfaces in IEEE `+ - * / sqrt`, and a documented generator.
//!
//! ```text
//! state <- state * 6364136223846793005 + 1442695040888963407  (mod 2^64),   uniform = (state >> 11) / 2^53
//! ```
//!
//! The order of every operation matters: `tests/golden/inputs.py` repeats it and must get the same bits.

pub(super) use crate::bspline::linspace;
use crate::contact::Contacts;
use crate::fit::{FitOptions, NormalSigma, Objective, SlopeWeights};

/// The 8 x 8 patch of the paper.
pub(super) const FULL: [f64; 4] = [-4.0, 4.0, -4.0, 4.0];

/// Knuth's linear congruential generator: enough to scatter test sites, and the same in every language.
#[derive(Clone, Debug)]
pub struct Lcg {
    state: u64,
}

impl Lcg {
    /// Starts with `seed` as the state.
    pub fn new(seed: u64) -> Lcg {
        Lcg { state: seed }
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.state >> 11) as f64 / 9007199254740992.0
    }

    /// Sum of twelve uniforms less six: mean 0, variance 1.
    pub fn normal(&mut self) -> f64 {
        let mut total = 0.0;
        for _ in 0..12 {
            total += self.uniform();
        }
        total - 6.0
    }
}

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
