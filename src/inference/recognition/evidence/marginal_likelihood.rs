//! How probable every hypothesis is: its marginal likelihood under every covariance, in closed form.
//!
//! ```text
//! whitened y, J, Z;  Z with prior identity is eliminated:  G = I + Z'Z,  H = J'J - J'Z G^-1 Z'J,  x = -H^-1 (J'y - J'Z G^-1 Z'y)
//! log ev = -(log det Sigma + log det G + RSS + log det(H/2 pi) + f log s^2 + S/s^2)/2 + log prior(node) + log prior(shape)
//! s^2 = RSS/(n - p); where that is below S/f, (RSS + S)/(n - p + f)      S, f: scatter of contacts within cells (`scatter_within.rs`)
//! p(R) = (2/pi)/(1 + R^2)    sphere p(R)/2    cylinder p(R)/(2 sqrt2 pi |k|)    general p(R)/(2 pi^2 R max(|k1 - k2|, its sd))
//! ```
//!
//! S and direction are uniform a priori and R half-Cauchy in units of the patch's size, so that no class is favoured.
//! R. E. Kass, A. E. Raftery, *Bayes factors*, J. Amer. Statist. Assoc. 90 (1995) 773; restricted likelihood: H. D.
//! Patterson, R. Thompson, *Biometrika* 58 (1971) 545.

use std::f64::consts::{FRAC_2_PI, LN_2, PI, SQRT_2};

use faer::Mat;

use crate::bodies::Tuning;
use crate::dense;
use crate::recognition::contacts::{CellNormals, Cells};
use crate::recognition::discrepancy::{Body, Displacement};
use crate::recognition::equations::{Columns, Grams, Reduced, column_of, first_of_displacement, reduced};
use crate::recognition::kinds::{Kind, Model};
use crate::recognition::noise::{Kernel, Limit};

use super::linearised::{Linearised, NormalsTold};
use super::node::{Departure, Node, POWERS};
use super::search_context::SearchContext;
use super::whitened::Whitened;

/// With fewer degrees of freedom than this the positions alone do not determine their noise, and normals are used with
/// them.
const FREEDOM_OF_NOISE: usize = 3;

/// Which splines are tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Look {
    /// Splines alone: whether there is a displacement.
    First,
    /// Splines beside a natural departure.
    Second,
}

/// Everything that the evidence is computed from.
pub(crate) struct Evidence<'a> {
    pub(crate) cells: &'a Cells,
    pub(crate) models: &'a [Model],
    pub(crate) displacement: Option<&'a Displacement>,
    pub(crate) kernels: Vec<Kernel>,
    /// Gram matrix of the whitened position rows under every kernel that was tried.
    pub(super) grams: Vec<Option<Mat<f64>>>,
    /// Gram matrix of the whitened normal rows.
    pub(crate) normals: Option<&'a Mat<f64>>,
    /// Variance of the errors of an average cell's normal.
    normal_variance: Option<f64>,
    limit: Limit,
    pub(super) tuning: &'a Tuning,
    pub(super) look: Look,
    /// Whether departures stand over a plane.
    pub(super) over_plane: bool,
}

impl<'a> Evidence<'a> {
    /// Largest log evidence of the kinds without a departure, where neighbours share no errors and the normals err as is told, with
    /// what those errors add.
    pub(super) fn of_plain_kinds(at: SearchContext, linearised: &Linearised, told: &NormalsTold) -> Option<f64> {
        let mut made = Evidence::unasked(at, linearised, Look::First);
        made.normals = told.gram.as_ref();
        made.normal_variance = told.noise.map(|noise| noise.variance);
        let white = Whitened::new(&linearised.rows.of_models(), &at.factors.positions, 0, first_of_displacement())?;
        let nodes = made.models.iter().filter_map(|model| made.node(model, &white, Departure::None));
        let highest = nodes.map(|node| node.log_evidence).max_by(f64::total_cmp)?;
        Some(highest + told.noise.map_or(0.0, |noise| noise.log_share))
    }

    /// Before any kernel is tried.
    pub(super) fn unasked(at: SearchContext<'a>, linearised: &'a Linearised, look: Look) -> Evidence<'a> {
        let SearchContext { cells, limit, tuning, .. } = at;
        let kernels = Kernel::all();
        let grams = kernels.iter().map(|_| None).collect();
        let Linearised { models, displacement, normals, .. } = linearised;
        let over_plane = linearised.over_plane.is_some();
        let (displacement, normals) = (displacement.as_ref(), normals.as_ref());
        let normal_variance = linearised.normal_noise.map(|noise| noise.variance);
        Evidence {
            cells,
            models,
            displacement,
            kernels,
            grams,
            normals,
            normal_variance,
            limit,
            tuning,
            look,
            over_plane,
        }
    }

    /// One hypothesis; `None` where the contacts cannot tell it, or errors would be larger than the limit allows.
    pub(super) fn node(&self, model: &Model, white: &Whitened, departure: Departure) -> Option<Node> {
        let (kind, kernel) = (model.kind(), self.kernels[white.kernel]);
        let (n, p) = (self.cells.points.len(), kind.unknowns());
        if self.normals.is_none() && n < p + FREEDOM_OF_NOISE {
            return None;
        }
        let variance = self.variance(kind, white, departure)?.max(1e-18).max(self.cells.floors.of_positions());
        let tau = (variance * kernel.ratio).sqrt();
        let size = self.limit.log_prior(tau)?;
        let system = self.system(kind, white, variance, departure)?;
        let log_det_h = dense::log_det(&system.lower) - p as f64 * (2.0 * PI).ln();
        let within = self.cells.within;
        let of_means = white.log_det + n as f64 * variance.ln() + system.log_det + system.rss + log_det_h;
        let likelihood = -0.5 * (of_means + within.deviance(variance));
        let log_evidence = likelihood
            + kernel.log_prior
            + size
            + self.share(kind, departure)
            + shape_prior(model, &system.x, &system.lower);
        log_evidence.is_finite().then_some(Node {
            kind,
            kernel: white.kernel,
            ratio: kernel.ratio,
            length: kernel.length,
            departure,
            variance,
            log_evidence,
            x: system.x,
            precision: system.lower,
            dof: (self.rows_of_noise() + within.freedom_beside(variance) - p as f64).max(1.0),
        })
    }

    /// Rows that tell how large errors are. The errors of few positions are told by normals only through what sensors are like.
    fn rows_of_noise(&self) -> f64 {
        let n = self.cells.points.len();
        let known = self.cells.normals.as_ref().filter(|_| self.normals.is_some()).map_or(0, CellNormals::known);
        let of_normals = 2.0 * known as f64;
        let is_few = n < self.tuning.few_positions;
        n as f64 + if is_few { self.tuning.normals_of_few * of_normals } else { of_normals }
    }

    /// Log of a node's share of the prior of its hypothesis. Torus, paraboloid, natural departures and other displacements
    /// have a quarter each of general's prior; of the last, rough splines and smooth departures have half each. The quadric and the torus
    /// have an eighth beside them.
    fn share(&self, kind: Kind, departure: Departure) -> f64 {
        let displaced = if self.displacement.is_some() { LN_2 } else { 0.0 };
        match (kind, departure) {
            (Kind::General, Departure::Rough(_) | Departure::Both(_)) => {
                -displaced - 2.0 * LN_2 - (POWERS.count() as f64).ln()
            }
            (Kind::General, Departure::Smooth { .. }) => {
                let processes =
                    self.displacement.map_or(1, |d| d.smooth.iter().filter(|(_, count)| *count > 0).count());
                -displaced - 2.0 * LN_2 - ((POWERS.count() * processes) as f64).ln()
            }
            (Kind::General, Departure::Body(Body::Quadric)) => -displaced - 2.0 * LN_2,
            (Kind::General, Departure::Body(_)) => -displaced - 3.0 * LN_2,
            (Kind::General | Kind::Paraboloid, _) => -displaced - LN_2,
            _ => 0.0,
        }
    }

    /// Variance of an average cell's independent error, restricted maximum likelihood. A natural departure has its size whatever the
    /// noise is, so its size in units of the noise needs the noise: once where a spline takes up most, else twice.
    fn variance(&self, kind: Kind, white: &Whitened, departure: Departure) -> Option<f64> {
        let (n, p) = (self.cells.points.len(), kind.unknowns());
        if n < p + FREEDOM_OF_NOISE {
            return self.joint_variance(kind, white);
        }
        let rss = |departure: Departure, natural: f64| {
            let columns = self.columns(kind, departure, [departure.of_spline().sqrt(), natural]);
            Some(white.alone(columns, 1.0)?.rss)
        };
        // a ring of contacts does not determine a surface without its normals
        let Some(plain) = rss(Departure::None, 0.0) else { return self.joint_variance(kind, white) };
        let plain = plain.max(1e-30);
        let pooled = |rss: f64| self.cells.within.variance_beside(rss, (n - p) as f64);
        let of =
            |departure: Departure, natural: f64| Some(pooled(rss(departure, natural)?.max(1e-12 * plain)).max(1e-18));
        match departure {
            Departure::None => Some(pooled(plain)),
            Departure::Rough(_) | Departure::Smooth { .. } => of(departure, 0.0),
            Departure::Both(g) => of(departure, of(Departure::Rough(g), 0.0)?.sqrt().recip()),
            Departure::Natural | Departure::Body(_) => {
                let first = of(departure, pooled(plain).max(1e-18).sqrt().recip())?;
                of(departure, first.sqrt().recip())
            }
        }
    }

    /// The same variance where the positions are too few to determine it alone: the fixed point of
    /// `s^2 = (RSS(x) + f (b s_n)^2)/(n - tr H^-1 Jz'Jz/s^2 + f)` with x from positions and normals together, b of
    /// [`Tuning::place_over_normal`], and f degrees of freedom, [`Tuning::supposed_freedom`], for what sensors are like: four contacts
    /// always lie on a sphere, and would have no errors at all.
    fn joint_variance(&self, kind: Kind, white: &Whitened) -> Option<f64> {
        let (y, p, gram) = (column_of(kind), kind.unknowns(), &white.gram);
        let Tuning { supposed_freedom: freedom, place_over_normal: of_normal, .. } = *self.tuning;
        let supposed = freedom * of_normal * of_normal * self.normal_variance?;
        let mut variance = 1e-4;
        for _ in 0..30 {
            let system = self.system(kind, white, variance, Departure::None)?;
            let x = &system.x;
            let full = |i: usize| if i == 0 { 1.0 } else { x[i - 1] };
            let mut rss = 0.0;
            for i in 0..=p {
                (0..=p).for_each(|j| rss += full(i) * full(j) * gram[(y + i, y + j)]);
            }
            let mut along = Mat::from_fn(p, p, |i, j| gram[(y + 1 + i, y + 1 + j)] / variance);
            dense::whiten(&system.lower, along.as_mut());
            let mut across = along.transpose().to_owned();
            dense::whiten(&system.lower, across.as_mut());
            let taken: f64 = (0..p).map(|i| across[(i, i)]).sum();
            let next = (rss.max(1e-30) + supposed) / (self.cells.points.len() as f64 - taken + freedom);
            if (next - variance).abs() < 1e-6 * variance {
                break;
            }
            variance = next;
        }
        Some(variance)
    }

    /// The normal equations of positions and normals together, with the displacement eliminated.
    fn system(&self, kind: Kind, white: &Whitened, variance: f64, departure: Departure) -> Option<Reduced> {
        let columns = self.columns(kind, departure, [(departure.of_spline() * variance).sqrt(), 1.0]);
        match self.normals {
            Some(_) => reduced(columns, Grams { positions: &white.gram, variance, normals: self.normals }),
            None => white.alone(columns, variance),
        }
    }

    /// The equations of a model, with the displacement where there is one; factors of the spline's and of the natural columns.
    pub(crate) fn columns(&self, kind: Kind, departure: Departure, factors: [f64; 2]) -> Columns {
        let mut fixed = None;
        let (start, count, rough) = match (departure, self.displacement) {
            (Departure::None, _) | (_, None) => (0, 0, 0),
            (Departure::Body(body), Some(d)) => {
                let (first, columns) = d.bodies[body.number()];
                fixed = Some(first_of_displacement() + first);
                (first + 1, columns - 1, 0)
            }
            (Departure::Natural, Some(d)) => (d.rough, d.natural, 0),
            (Departure::Rough(_), Some(d)) => (0, d.rough, d.rough),
            (Departure::Both(_), Some(d)) => (0, d.rough + d.natural, d.rough),
            (Departure::Smooth { process, .. }, Some(d)) => {
                (d.smooth[process].0, d.smooth[process].1, d.smooth[process].1)
            }
        };
        let z = (first_of_displacement() + start, count);
        Columns { y: column_of(kind), fixed, unknowns: kind.unknowns(), z, rough, factors }
    }
}

/// Both curvatures of a model moved by x, the larger first.
pub(crate) fn curvatures(model: &Model, x: &[f64]) -> [f64; 2] {
    let theta = model.theta();
    let (a, c, b) = match model.kind() {
        Kind::Plane => return [0.0; 2],
        Kind::Sphere => return [theta[3] + x[3]; 2],
        Kind::Cylinder => (theta[3] + x[3], 0.0, 0.0),
        Kind::General => (theta[3] + x[3], theta[4] + x[4], x[5]),
        Kind::Paraboloid => (theta[3] + x[3], theta[4] + x[4], theta[5] + x[5]),
    };
    let (mean, half) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
    [mean + half, mean - half]
}

/// Log density of the shape's parameters in the evidence's coordinates.
fn shape_prior(model: &Model, x: &[f64], lower: &Mat<f64>) -> f64 {
    let [k1, k2] = curvatures(model, x);
    let r = (0.5 * (k1 * k1 + k2 * k2)).sqrt().max(1e-6);
    let density = FRAC_2_PI / (1.0 + r * r);
    match model.kind() {
        Kind::Plane => 0.0,
        Kind::Sphere => (0.5 * density).ln(),
        Kind::Cylinder => (0.5 * density / (SQRT_2 * PI)).ln() - (k1 - k2).abs().max(1e-6).ln(),
        Kind::General | Kind::Paraboloid => {
            // sd of k1 - k2 = |(A - C, 2 B)|
            let mut sd = 0.0;
            for direction in [[0.0, 0.0, 0.0, 1.0, -1.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 2.0]] {
                let mut along = direction;
                dense::forward(lower, &mut along);
                sd += along.iter().map(|v| v * v).sum::<f64>();
            }
            (density / (2.0 * PI * PI * r)).ln() - (k1 - k2).max(sd.sqrt()).ln()
        }
    }
}
