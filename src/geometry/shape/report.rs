//! What is said of the shape of a surface, whichever kind of surface it is and however it was found.
//!
//! ```text
//! sd    spread over the grid points, variation over the patch        u    standard uncertainty of the mean
//! ```

use super::{Interval, Spread};
use crate::curvature::ShapeClass;
use palpate_numeric::vector::Vector;

/// Mean over the patch with spread (variation over the patch) and uncertainty (of the mean, from noise).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistic {
    /// Mean over supported points.
    pub mean: Option<f64>,
    /// Sample sd over them.
    pub sd: Option<f64>,
    /// Standard uncertainty of the mean in all, `u^2 = u_noise^2 + u_model^2`.
    pub u: Option<f64>,
    /// Interval for the mean at the options' confidence level.
    pub interval: Option<Interval>,
    /// The part of `u` that comes from noise.
    pub u_noise: Option<f64>,
    /// The part of `u` that comes from doubt about the kind of surface; `None` where no other kind was asked.
    pub u_model: Option<f64>,
    /// Degrees of freedom of `u_noise`, infinite where the noise was declared.
    pub dof: Option<f64>,
    /// Factor by which `u` reaches the farther end of the interval.
    pub coverage_factor: Option<f64>,
}

/// The shape of a surface in input units, with the maps `M` that its means are taken over. What a kind of surface does not tell is
/// `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeReport<M> {
    /// Maps over the shape grid: places, k1, k2, S, R.
    pub maps: M,
    /// Shape index S; all `None` for a plane.
    pub shape_index: Statistic,
    /// Curvedness R, 1/length.
    pub curvedness: Statistic,
    /// Class of the mean S, or plane.
    pub class: ShapeClass,
    /// The class from the other side, where nothing tells which side is free: S and its interval are then given by their size.
    pub other_class: Option<ShapeClass>,
    /// Probability of each class; empty for a plane.
    pub class_probability: Vec<(ShapeClass, f64)>,
    /// Radius of the cap, cup, ridge or rut.
    pub radius: Option<f64>,
    /// Interval of `radius`, at the level of R's.
    pub radius_interval: Option<[f64; 2]>,
    /// Radii of the two curvatures of dome and trough, the smaller radius first.
    pub radii: Option<[f64; 2]>,
    /// Larger principal curvature over the patch.
    pub k1: Spread,
    /// Smaller principal curvature over the patch.
    pub k2: Spread,
    /// Of a height field: direction of k1 at the patch centre projected to the input's x, y, degrees in [0, 180).
    pub direction_deg: Option<f64>,
    /// Of a height field the same of the axis: the direction along a ridge or rut, or the longer way of a dome or trough;
    /// `None` for the other classes.
    pub axis_deg: Option<f64>,
    /// Of a surface in space: unit direction of k1 at the supported grid point nearest the middle of (u, v).
    pub direction: Option<Vector>,
    /// Of a surface in space: unit direction there of the axis.
    pub axis: Option<Vector>,
    /// Within how many degrees of the axis the true one lies, at the level of R's interval.
    pub axis_within_deg: Option<f64>,
    /// Centre of a ball, or the point of a pipe's or bar's axis next to the middle of the patch.
    pub centre: Option<Vector>,
    /// Points used / grid points.
    pub support: f64,
    /// p-value of the best plane against the fit.
    pub plane_p: Option<f64>,
}

impl<M> ShapeReport<M> {
    /// A plane of which no more is known than these maps.
    pub fn of_maps(maps: M) -> ShapeReport<M> {
        ShapeReport {
            maps,
            shape_index: Statistic::default(),
            curvedness: Statistic::default(),
            class: ShapeClass::Plane,
            other_class: None,
            class_probability: Vec::new(),
            radius: None,
            radius_interval: None,
            radii: None,
            k1: Spread::default(),
            k2: Spread::default(),
            direction_deg: None,
            axis_deg: None,
            direction: None,
            axis: None,
            axis_within_deg: None,
            centre: None,
            support: 0.0,
            plane_p: None,
        }
    }
}

/// Every class in the order of S, and the plane, with its probability.
pub fn every_class(found: &[(ShapeClass, f64)]) -> Vec<(ShapeClass, f64)> {
    let of = |class| found.iter().find(|(c, _)| *c == class).map_or(0.0, |(_, p)| *p);
    ShapeClass::CURVED.into_iter().chain([ShapeClass::Plane]).map(|class| (class, of(class))).collect()
}
