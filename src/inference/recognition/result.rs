//! What a recognition gives back: the class with its probability, S and R with intervals, the map, and what was set
//! aside.

use std::sync::Arc;

use statrs::function::erf;

use palpate_geometry::contact::Frame;
use palpate_geometry::curvature::ShapeClass;

use super::contacts::NormalsUse;
use super::hypothesis::Hypothesis;
use super::region::{PosteriorDraws, PredictiveDraw, RecognisedSurface};
use super::remark::Remark;

/// A quantity averaged over the patch, with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// Mean over the supported points of the map.
    pub mean: f64,
    /// Standard deviation over the patch: variation, not uncertainty.
    pub sd: f64,
    /// Standard uncertainty from independent noise, were the reported hypothesis certain.
    pub u_noise: f64,
    /// What correlated errors and doubt about the hypothesis add.
    pub u_model: f64,
    /// Standard uncertainty in all, `u^2 = u_noise^2 + u_model^2`.
    pub u: f64,
    /// Both ends of the interval of level `level`.
    pub interval: [f64; 2],
    /// Level of the interval.
    pub level: f64,
    /// Degrees of freedom of the residuals under the reported hypothesis.
    pub dof: f64,
}

impl Estimate {
    /// Moves mean and interval by this much within these limits.
    pub(super) fn moved(&mut self, by: f64, [least, most]: [f64; 2]) {
        let there = |value: f64| (value + by).clamp(least, most);
        (self.mean, self.interval) = (there(self.mean), self.interval.map(there));
    }

    /// The same in units so many times as long, of a quantity that is one over a length.
    pub(super) fn over(self, scale: f64) -> Estimate {
        Estimate {
            mean: self.mean / scale,
            sd: self.sd / scale,
            u_noise: self.u_noise / scale,
            u_model: self.u_model / scale,
            u: self.u / scale,
            interval: self.interval.map(|v| v / scale),
            ..self
        }
    }

    /// Adds an independent standard uncertainty of so large a share of the mean, of a quantity that is never negative.
    pub(super) fn doubted(&mut self, share: f64) {
        self.blurred(share * self.mean, [0.0, f64::INFINITY]);
    }

    /// Adds an independent standard uncertainty, of a quantity within these bounds.
    pub(super) fn blurred(&mut self, own: f64, [least, most]: [f64; 2]) {
        let reach = std::f64::consts::SQRT_2 * erf::erf_inv(self.level) * own;
        let [lo, hi] = self.interval.map(|end| (end - self.mean).hypot(reach));
        self.interval = [(self.mean - lo).max(least), (self.mean + hi).min(most)];
        (self.u, self.u_model) = (self.u.hypot(own), self.u_model.hypot(own));
    }
}

/// What the residuals tell of the sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NoiseFound {
    /// Sd of independent errors of a single contact's position across the surface, input units.
    pub sd_z: f64,
    /// Sd of the errors that neighbouring contacts share, input units.
    pub sd_correlated: f64,
    /// Distance over which those errors fade by a factor e, input units; `None` without such errors.
    pub correlation_length: Option<f64>,
    /// Sd of a normal's two tangential components, degrees; `None` where normals are not used.
    pub sd_normal_deg: Option<f64>,
}

impl NoiseFound {
    /// Sd of a single contact across the surface, of independent and shared errors together: `sqrt(sd_z^2 + sd_correlated^2)`.
    pub fn sd_of_contact(&self) -> f64 {
        self.sd_z.hypot(self.sd_correlated)
    }
}

/// One hypothesis that was tried.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tried {
    /// Which one.
    pub hypothesis: Hypothesis,
    /// Its posterior probability.
    pub weight: f64,
    /// Larger curvature of its fit, 1/length of the input.
    pub k1: f64,
    /// Smaller curvature of its fit.
    pub k2: f64,
    /// Root mean square distance of the averaged contacts, input units.
    pub rms: f64,
}

/// Whether the residuals still hold a pattern.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Misfit {
    /// Correlation of residuals at neighbouring places, -1 to 1.
    pub neighbour_correlation: f64,
    /// Probability of such a correlation, or a larger one, among independent residuals.
    pub p: f64,
    /// Root mean square misfit in percent of the relief.
    pub percent_of_relief: f64,
    /// One sentence.
    pub words: String,
}

/// One point of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MapPoint {
    /// Point of the recognised surface, input coordinates.
    pub position: [f64; 3],
    /// Unit normal on the free side, input axes.
    pub normal: [f64; 3],
    /// Shape index; `None` on a plane.
    pub shape_index: Option<f64>,
    /// Curvedness, 1/length of the input.
    pub curvedness: f64,
    /// Larger curvature.
    pub k1: f64,
    /// Smaller curvature.
    pub k2: f64,
    /// Whether contacts support the surface here.
    pub supported: bool,
    /// Standard uncertainty of the shape index.
    pub u_shape_index: f64,
    /// Standard uncertainty of the curvedness.
    pub u_curvedness: f64,
    /// Standard uncertainties of the larger and the smaller curvature.
    pub u_curvatures: [f64; 2],
    /// Standard uncertainty of the position along the normal.
    pub u_position: f64,
    /// Root mean square angle of the normal, radians.
    pub u_normal: f64,
}

/// The answer of [`Recognition::of`].
#[derive(Clone, Debug)]
pub struct Recognition {
    /// The hypothesis of largest weight.
    pub hypothesis: Hypothesis,
    /// Class of the mean shape index, or plane.
    pub class: ShapeClass,
    /// Probability of every class, likeliest first, those of probability zero left out.
    pub class_probability: Vec<(ShapeClass, f64)>,
    /// Shape index; `None` on a plane.
    pub shape_index: Option<Estimate>,
    /// Curvedness, 1/length of the input.
    pub curvedness: Estimate,
    /// Mean larger curvature.
    pub k1: f64,
    /// Mean smaller curvature.
    pub k2: f64,
    /// Radius of cap, cup, ridge and rut.
    pub radius: Option<f64>,
    /// Radii of the two curvatures of dome and trough, the smaller radius first.
    pub radii: Option<[f64; 2]>,
    /// Interval of `radius`, at the level of the estimates.
    pub radius_interval: Option<[f64; 2]>,
    /// Unit direction of `k1` in the middle of the patch, input axes; `None` for plane and sphere.
    pub direction: Option<[f64; 3]>,
    /// Of a cylinder, cone or torus the unit direction that it is turned about, of an ellipsoid that of its longest half axis. Of a patch that is
    /// none of these the direction in its middle along a ridge or rut, or the longer way of a dome or trough; `None` for the other classes.
    pub axis: Option<[f64; 3]>,
    /// Within how many degrees of `axis` the true one lies, at the level of the estimates.
    pub axis_within_deg: Option<f64>,
    /// Posterior probability of the plane.
    pub plane_probability: f64,
    /// Frame of the patch: its third axis points to the free side.
    pub frame: Frame,
    /// Points of the map that contacts support, and all of them.
    pub support: (usize, usize),
    /// The map, row after row: an even grid from edge to edge of the box of the contacts' x and y, y running fastest; where
    /// the patch stands steep over them, a grid of its chart. Means are over its supported points.
    pub map: Vec<MapPoint>,
    /// Points of the map in the two directions.
    pub grid: [usize; 2],
    /// The box of the input's x and y over which the map is even; `None` where it is even over the chart.
    pub(crate) over: Option<[[f64; 2]; 2]>,
    /// The recognised surface, for sampling it elsewhere.
    pub surface: RecognisedSurface,
    /// Points and unit normals that the means are taken over, input coordinates.
    pub averaged: Vec<([f64; 3], [f64; 3])>,
    /// Contacts too far off the surface to belong to it, which were left out.
    pub outliers: usize,
    /// Missing pixels of a grid.
    pub missing: usize,
    /// Normals of length zero, which were left out.
    pub normals_of_length_zero: usize,
    /// Normals more than 60 degrees off the surface's, which were left out.
    pub normals_against: usize,
    /// Normals that were reversed to agree with their neighbours.
    pub normals_flipped: usize,
    /// What the normals were used for.
    pub normals: NormalsUse,
    /// What the residuals tell of the sensor.
    pub noise: NoiseFound,
    /// All hypotheses with their weights, likeliest first.
    pub tried: Vec<Tried>,
    /// Whether the residuals still hold a pattern: correlation of neighbours, its probability among independent ones, percent of the relief,
    /// one sentence of `words`.
    pub misfit: Misfit,
    /// Number of independent contacts that would tell the mean height as well as these do.
    pub effective_contacts: f64,
    /// Number of contacts that were used.
    pub contacts: usize,
    /// What a user should know; printed, whole sentences.
    pub notes: Vec<Remark>,
    /// Whether something tells which side is free: normals, a viewpoint or a direction. Where nothing does, S and its
    /// interval are given by their size, `class` is the convex one of the two, every class has the probability of its mirror image, and maps
    /// show the side of +z, or of a body the outside.
    pub side_known: bool,
    /// Drawn surfaces with what touches would measure on them; empty where none was asked for.
    pub predictive: Vec<PredictiveDraw>,
    /// Drawn surfaces of all kinds, for touches that come later.
    pub(crate) draws: Arc<PosteriorDraws>,
}

impl Recognition {
    /// Ranges of the chart that the contacts cover: u and v, arc lengths in units of `frame.scale` input units.
    pub fn chart(&self) -> [[f64; 2]; 2] {
        [self.surface.u, self.surface.v]
    }

    /// Point and unit normal of the recognised surface at chart coordinates, in the input's coordinates.
    pub fn at(&self, u: f64, v: f64) -> ([f64; 3], [f64; 3]) {
        self.surface.at(u, v)
    }

    /// Principal curvatures k1 >= k2 at chart coordinates, 1/length of the input; `None` where the chart folds.
    pub fn curvatures_at(&self, u: f64, v: f64) -> Option<[f64; 2]> {
        self.surface.curvatures_at(u, v)
    }

    /// Whether contacts surround the surface at chart coordinates.
    pub fn supported_at(&self, u: f64, v: f64) -> bool {
        self.surface.supported_at(u, v)
    }

    /// Chart coordinates of the surface's point nearest to a place in the input's coordinates.
    pub fn chart_of(&self, place: [f64; 3]) -> [f64; 2] {
        self.surface.chart_of(place)
    }

    /// Signed distance of a place from the surface, positive on the free side. Input units.
    pub fn distance(&self, place: [f64; 3]) -> f64 {
        self.surface.distance(place)
    }
}

impl Recognition {
    /// Where a place of the input lies within the map, 0 to 1 in both directions.
    pub fn share_of_map(&self, place: [f64; 3]) -> [f64; 2] {
        let (at, edges) = match self.over {
            Some(over) => ([place[0], place[1]], over),
            None => (self.surface.chart_of(place), [self.surface.u, self.surface.v]),
        };
        [0, 1].map(|k| {
            let [lo, hi] = edges[k];
            if hi > lo { (at[k] - lo) / (hi - lo) } else { 0.5 }
        })
    }
}
