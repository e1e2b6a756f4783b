//! The recognised surface as a tensor-product spline, so that it can be saved, evaluated and drawn like any other.
//!
//! ```text
//! height field   z = S(x, y)      least squares on samples of the surface and of its normals, even over x and y, where contacts
//!                                support it and one sample farther
//! parametric     (x, y, z)(u, v)  least squares on samples of every coordinate; u and v are arc lengths, input units
//! ```
//!
//! A height field keeps the input's own axes and is taken where the surface stands nowhere steep over them. Segments
//! are doubled until the spline misses the recognised surface by far less than the contacts do.

use ndarray::Array2;

use crate::recognition::Recognition;
use palpate_fitting::fit::{
    Fit, FitError, FitOptions, FrameChoice, Objective, OutsideDomain, SlopeWeights, Smooth, fit_contacts, fit_grid,
};
use palpate_geometry::contact::{Contacts, Grid};
use palpate_geometry::shape::UvSupport;
use palpate_geometry::surface::{HeightField, Parametric};
use palpate_numeric::bspline::linspace;
use palpate_numeric::vector::{Vector, minus, norm};

/// Samples each way: a few for every unknown of the finest spline below.
const SAMPLES: usize = 33;

/// Degree of the spline: its curvatures are smooth.
const DEGREE: usize = 4;

/// Numbers of segments that are tried, the coarsest first.
const SEGMENTS: [usize; 4] = [2, 4, 8, 16];

/// The spline may miss the recognised surface by this share of the contacts' misfit.
const OF_MISFIT: f64 = 1e-3;

/// The same as a share of the patch's size, for contacts without noise.
const OF_SIZE: f64 = 1e-7;

/// Cells each way of the supported region as triangles.
const CELLS: usize = 16;

/// A recognised surface as a spline, in the input's coordinates.
#[derive(Clone, Debug)]
pub enum RecognisedSpline {
    /// Heights over the input's x and y, with the fit to the samples that made them.
    Height {
        /// The spline.
        surface: HeightField,
        /// The fit to the samples.
        fit: Box<Fit>,
    },
    /// A map into space over arc lengths u and v.
    Parametric {
        /// The spline.
        surface: Parametric,
        /// The part of (u, v) that contacts surround.
        support: UvSupport,
    },
}

/// Points and normals of the surface at an even lattice of its chart.
struct Samples {
    u: Vec<f64>,
    v: Vec<f64>,
    points: Vec<Vector>,
    normals: Vec<Vector>,
    supported: Vec<bool>,
}

impl Recognition {
    /// The recognised surface as a spline: a height field over the input's axes, or else a map into space.
    ///
    /// # Errors
    /// When the surface's coordinates leave no distinct knots.
    pub fn spline(&self) -> Result<RecognisedSpline, FitError> {
        let samples = match self.over {
            Some(over) => Samples::over(self, over),
            None => Samples::of(self),
        };
        let rms = self.tried.iter().find(|t| t.hypothesis == self.hypothesis).map_or(0.0, |t| t.rms);
        let size = norm(minus(samples.points[0], samples.points[samples.points.len() - 1]));
        let enough = (OF_MISFIT * rms).max(OF_SIZE * size);
        match self.over {
            Some(over) => samples.height_field(over, enough),
            None => samples.parametric(self, enough),
        }
    }
}

impl Samples {
    fn of(found: &Recognition) -> Samples {
        let surface = &found.surface;
        let [u, v] = [surface.u, surface.v].map(|[lo, hi]| linspace(lo, hi, SAMPLES));
        let places: Vec<(f64, f64)> = u.iter().flat_map(|a| v.iter().map(|b| (*a, *b))).collect();
        let (points, normals) = places.iter().map(|(a, b)| surface.at(*a, *b)).unzip();
        let mut supported: Vec<bool> = places.iter().map(|(a, b)| surface.supported_at(*a, *b)).collect();
        if supported.iter().filter(|s| **s).count() < SAMPLES {
            supported.fill(true);
        }
        Samples { u, v, points, normals, supported }
    }

    /// Samples at an even lattice of the input's x and y: outside of the spline's domain its last cells would bend to them.
    fn over(found: &Recognition, over: [[f64; 2]; 2]) -> Samples {
        let [u, v] = over.map(|[lo, hi]| linspace(lo, hi, SAMPLES));
        let mut samples = Samples { u, v, points: Vec::new(), normals: Vec::new(), supported: Vec::new() };
        let mut reached = Vec::new();
        for (point, normal, holds) in found.surface.over(over, [SAMPLES; 2]) {
            samples.points.push(point.unwrap_or([0.0; 3]));
            samples.normals.push(normal);
            samples.supported.push(holds);
            reached.push(point.is_some());
        }
        if samples.supported.contains(&true) {
            let grown = samples.grown();
            samples.supported = grown.iter().zip(&reached).map(|(grown, reached)| *grown && *reached).collect();
        } else {
            samples.supported = reached;
        }
        samples
    }

    /// Supported samples and those beside them, so that a cell at the outline is held on all sides.
    fn grown(&self) -> Vec<bool> {
        let near = |k: usize| k.saturating_sub(1)..(k + 2).min(SAMPLES);
        let held = |i: usize, j: usize| self.supported[i * SAMPLES + j];
        let one = |k: usize| near(k / SAMPLES).any(|i| near(k % SAMPLES).any(|j| held(i, j)));
        (0..self.supported.len()).map(one).collect()
    }

    fn used(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.points.len()).filter(|&i| self.supported[i])
    }

    fn height_field(&self, over: [[f64; 2]; 2], enough: f64) -> Result<RecognisedSpline, FitError> {
        let points: Vec<Vector> = self.used().map(|i| self.points[i]).collect();
        let normals: Vec<Vector> = self.used().map(|i| self.normals[i]).collect();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let mut options = FitOptions {
            degree: [DEGREE; 2],
            frame: Some(FrameChoice::Keep),
            domain: Some([over[0][0], over[0][1], over[1][0], over[1][1]]),
            outside: OutsideDomain::Extend,
            objective: Objective::Slopes(SlopeWeights::Equal),
            // where no sample is
            smooth: Smooth::faint([DEGREE; 2]),
            ..FitOptions::default()
        };
        let mut best: Option<(f64, Fit)> = None;
        // contacts that surround a narrow strip leave few samples: no more segments than these determine
        for segments in SEGMENTS.into_iter().filter(|n| (n + DEGREE).pow(2) <= 3 * points.len()) {
            options.segments = [segments; 2];
            let fit = fit_contacts(&contacts, &options)?;
            let missed = fit.rms().z.unwrap_or(f64::INFINITY);
            if best.as_ref().is_none_or(|(least, _)| missed < *least) {
                best = Some((missed, fit));
            }
            if missed <= enough {
                break;
            }
        }
        let (_, fit) = best.ok_or(FitError::Rank { rank: 0, unknowns: 0 })?;
        let fit = Box::new(fit);
        Ok(RecognisedSpline::Height { surface: fit.input_surface()?, fit })
    }

    fn parametric(&self, found: &Recognition, enough: f64) -> Result<RecognisedSpline, FitError> {
        let scale = found.surface.frame.scale;
        let [u, v] = [&self.u, &self.v].map(|axis| axis.iter().map(|t| t * scale).collect::<Vec<f64>>());
        let mut best = None;
        for segments in SEGMENTS {
            let options = FitOptions { degree: [DEGREE; 2], segments: [segments; 2], ..FitOptions::default() };
            let coordinate = |k: usize| {
                let z = Array2::from_shape_fn((SAMPLES, SAMPLES), |(i, j)| self.points[i * SAMPLES + j][k]);
                fit_grid(&Grid::new(u.clone(), v.clone(), z), &options)
            };
            let fits = [coordinate(0)?, coordinate(1)?, coordinate(2)?];
            let done = fits.iter().all(|fit| fit.rms().z.is_some_and(|z| z <= enough));
            best = Some(fits);
            if done {
                break;
            }
        }
        let fits = best.ok_or(FitError::Rank { rank: 0, unknowns: 0 })?;
        let [x, y, z] = [fits[0].input_surface()?, fits[1].input_surface()?, fits[2].input_surface()?];
        let at = |at: (usize, usize)| [x.coefficients()[at], y.coefficients()[at], z.coefficients()[at]];
        let coefficients = Array2::from_shape_fn(x.coefficients().dim(), at);
        let surface = Parametric::new(x.knots().clone(), coefficients)?;
        Ok(RecognisedSpline::Parametric { surface, support: support(found, scale) })
    }
}

/// Cells of the chart with all four corners supported, as triangles.
fn support(found: &Recognition, scale: f64) -> UvSupport {
    let surface = &found.surface;
    let [u, v] = [surface.u, surface.v].map(|[lo, hi]| linspace(lo, hi, CELLS + 1));
    let held = Array2::from_shape_fn((CELLS + 1, CELLS + 1), |(i, j)| surface.supported_at(u[i], v[j]));
    let at = |i: usize, j: usize| [scale * u[i], scale * v[j]];
    let whole = vec![[at(0, 0), at(CELLS, 0), at(CELLS, CELLS)], [at(0, 0), at(CELLS, CELLS), at(0, CELLS)]];
    if held.iter().all(|h| *h) {
        return UvSupport::new(whole, [None; 2]);
    }
    let mut triangles = Vec::new();
    for i in 0..CELLS {
        for j in 0..CELLS {
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            if corners.iter().all(|at| held[*at]) {
                let [a, b, c, d] = corners.map(|(i, j)| at(i, j));
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    if triangles.is_empty() {
        triangles = whole;
    }
    UvSupport::new(triangles, [None; 2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::RecognitionOptions;
    use palpate_geometry::curvature::{Derivatives, curvatures};
    use palpate_numeric::vector::dot;

    /// Contacts with normals on a cylinder of radius 5 along y, up to `reach` radians to both sides.
    fn cylinder(reach: f64) -> Contacts {
        let places = (0..180).map(|i| {
            let (a, y) = (reach * ((i % 20) as f64 / 9.5 - 1.0), (i / 20) as f64);
            ([5.0 * a.sin(), y, 5.0 * a.cos()], [a.sin(), 0.0, a.cos()])
        });
        let (points, normals): (Vec<Vector>, Vec<Vector>) = places.unzip();
        Contacts::from_points(&points).with_normal_vectors(&normals)
    }

    /// A bump that is not round, seen over the inner part of a box, with corners that no contact is near: the spline bends as the surface does.
    #[test]
    fn a_height_field_over_a_part_of_the_contacts_bends_as_the_surface() {
        let bump = |[x, y]: [f64; 2]| [x, y, 1.5 * (-(x * x + 0.5 * y * y) / 18.0).exp()];
        let disc = |p: &[f64; 2]| p[0].hypot(p[1]) < 6.5;
        let places = (0..1225).map(|k| [(k % 35) as f64 * 0.35 - 5.95, (k / 35) as f64 * 0.35 - 5.95]).filter(disc);
        let points: Vec<Vector> = places.map(bump).collect();
        for inset in [0.0, 0.1, 0.25] {
            let options = RecognitionOptions { inset, grid: [9, 9], ..RecognitionOptions::default() };
            let found = Recognition::of(&Contacts::from_points(&points), &options).unwrap();
            let RecognisedSpline::Height { surface, .. } = found.spline().unwrap() else { panic!("no height field") };
            for here in found.map.iter().filter(|here| here.supported) {
                let [x, y, z] = here.position;
                let of_spline = surface.at(x, y);
                let derivatives =
                    Derivatives::of_height(of_spline.zx, of_spline.zy, of_spline.zxx, of_spline.zxy, of_spline.zyy);
                let [k1, k2] = curvatures(&derivatives).unwrap();
                assert!((of_spline.z - z).abs() < 1e-3, "{inset}: {here:?} {of_spline:?}");
                assert!((k1 - here.k1).abs().max((k2 - here.k2).abs()) < 0.01, "{inset}: {here:?} {k1} {k2}");
            }
        }
    }

    /// Corners of the box that no contact is near: the spline goes on there as it bends, and does not bend to the outermost samples.
    #[test]
    fn a_height_field_beside_empty_corners_is_the_surface() {
        let noise = |k: usize| 0.01 * (2.3 * k as f64).sin();
        let turned = |(a, y): (f64, f64)| {
            let [along, across] = [y, 25.0 * a.sin()].map(|v| v / 2.0_f64.sqrt());
            [along - across, along + across, 25.0 * a.cos()]
        };
        let places = (0..200).map(|k| (1.2 * (0.618 * k as f64).fract() - 0.6, 40.0 * (0.755 * k as f64).fract()));
        let points: Vec<Vector> = places.enumerate().map(|(k, at)| turned(at).map(|v| v + noise(k))).collect();
        let found = Recognition::of(&Contacts::from_points(&points), &RecognitionOptions::default()).unwrap();
        let RecognisedSpline::Height { surface, fit } = found.spline().unwrap() else { panic!("no height field") };
        assert!(!fit.without_data().is_empty(), "all corners have samples");
        let off = found.map.iter().filter(|here| here.supported).map(|here| {
            let [x, y, z] = here.position;
            (surface.at(x, y).z - z).abs()
        });
        let most = off.fold(0.0, f64::max);
        assert!(most < 0.1 * found.noise.sd_z, "{most} beside {}", found.noise.sd_z);
    }

    /// Places where a bar leans by more than 40 degrees were not found from above, and its spline ended before them.
    #[test]
    fn a_height_field_reaches_the_steep_sides_of_a_bar() {
        let found = Recognition::of(&cylinder(1.0), &RecognitionOptions::default()).unwrap();
        let RecognisedSpline::Height { surface, .. } = found.spline().unwrap() else { panic!("no height field") };
        for x in [-4.1, -3.6, 0.0, 3.2, 4.1_f64] {
            let (here, height) = (surface.at(x, 4.0), (25.0 - x * x).sqrt());
            let derivatives = Derivatives::of_height(here.zx, here.zy, here.zxx, here.zxy, here.zyy);
            let [_, k2] = curvatures(&derivatives).unwrap();
            assert!((here.z - height).abs() < 1e-3 && (k2 + 0.2).abs() < 0.01, "{x}: {here:?}");
        }
        let reached =
            found.map.iter().filter(|here| here.supported).fold(0.0_f64, |most, here| most.max(here.position[0]));
        assert!(reached > 3.9, "{reached}");
    }

    #[test]
    fn a_level_patch_becomes_a_height_field_and_half_a_pipe_a_map() {
        let found = Recognition::of(&cylinder(0.8), &RecognitionOptions::default()).unwrap();
        let RecognisedSpline::Height { surface, .. } = found.spline().unwrap() else { panic!("no height field") };
        let here = surface.at(2.0, 4.0);
        assert!((here.z - 21.0_f64.sqrt()).abs() < 1e-4);
        let found = Recognition::of(&cylinder(1.5), &RecognitionOptions::default()).unwrap();
        let RecognisedSpline::Parametric { surface, support } = found.spline().unwrap() else { panic!("no map") };
        let [u, v] = [0, 1].map(|k| surface.knots()[k].domain()).map(|[lo, hi]| 0.3 * lo + 0.7 * hi);
        assert!(support.holds(u, v));
        let here = surface.at(u, v);
        let [x, _, z] = here.point;
        assert!((x.hypot(z) - 5.0).abs() < 1e-3);
        let p = here.principal().unwrap();
        assert!(dot(p.normal, [x, 0.0, z]) > 0.0 && (p.k2 + 0.2).abs() < 1e-3, "{p:?}");
    }
}
