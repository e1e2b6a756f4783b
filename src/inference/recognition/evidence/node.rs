//! One hypothesis under one covariance: a kind of surface, how it departs from that kind, and how probable both are.
//!
//! ```text
//! surface = kind + f        f = 0, natural departure, rough spline, both, smooth departure, or a body's
//! ```

use std::mem::discriminant;

use faer::Mat;

use crate::recognition::Hypothesis;
use crate::recognition::discrepancy::Body;
use crate::recognition::kinds::Kind;

/// Variances of the displacement relative to that of a cell's position, in powers of ten.
pub(super) const POWERS: std::ops::RangeInclusive<i32> = -2..=8;

/// How a surface departs from its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Departure {
    None,
    /// By third and fourth derivatives of natural size.
    Natural,
    /// By a spline, whose variance is so many times that of a position.
    Rough(f64),
    /// By both. A spline that is smoothed by its third derivatives pulls them to zero at the edges of the patch, where nothing lies
    /// beyond; a natural departure beside it keeps them. S of a bump, whose edges bend the other way, was 0.02 too high with 200
    /// contacts and 0.04 with 2,000, and is 0.003 and 0.002 too high (`benches/runs/coverage.md`).
    Both(f64),
    /// By a smooth departure.
    Smooth {
        /// Its variance over that of a position.
        variance: f64,
        /// Number of its process: form and length.
        process: usize,
    },
    /// As a body does whose form is known but for a few numbers.
    Body(Body),
}

impl Departure {
    /// Variance of the rough spline or the smooth departure over that of a position; 0 without one.
    pub(super) fn of_spline(self) -> f64 {
        match self {
            Departure::Rough(g) | Departure::Both(g) => g,
            Departure::Smooth { variance, .. } => variance,
            Departure::None | Departure::Natural | Departure::Body(_) => 0.0,
        }
    }

    /// Whether it comes in sizes that are tried.
    pub(super) fn has_size(self) -> bool {
        matches!(self, Departure::Rough(_) | Departure::Both(_) | Departure::Smooth { .. })
    }

    /// The same departure with this variance over that of a position; one without a size as it is.
    pub(super) fn of_size(self, variance: f64) -> Departure {
        match self {
            Departure::Rough(_) => Departure::Rough(variance),
            Departure::Both(_) => Departure::Both(variance),
            Departure::Smooth { process, .. } => Departure::Smooth { variance, process },
            Departure::None | Departure::Natural | Departure::Body(_) => self,
        }
    }

    /// Whether it is a smooth departure.
    pub(crate) fn is_smooth(self) -> bool {
        matches!(self, Departure::Smooth { .. })
    }

    /// Number of the process of a smooth departure.
    pub(crate) fn process(self) -> Option<usize> {
        if let Departure::Smooth { process, .. } = self { Some(process) } else { None }
    }

    /// The body that it is.
    pub(crate) fn body(self) -> Option<Body> {
        if let Departure::Body(body) = self { Some(body) } else { None }
    }

    /// Whether both have the same prior but for its size.
    pub(crate) fn is_like(self, other: Departure) -> bool {
        discriminant(&self) == discriminant(&other) && self.process() == other.process() && self.body() == other.body()
    }
}

/// One hypothesis under one covariance.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) kind: Kind,
    /// Number of its kernel.
    pub(crate) kernel: usize,
    pub(crate) ratio: f64,
    pub(crate) length: f64,
    pub(crate) departure: Departure,
    /// Variance of an average cell's independent error.
    pub(crate) variance: f64,
    pub(crate) log_evidence: f64,
    /// Step from the fitted model, in the evidence's coordinates.
    pub(crate) x: Vec<f64>,
    /// Lower factor of the precision of x.
    pub(crate) precision: Mat<f64>,
    pub(crate) dof: f64,
}

/// The node of the largest log evidence.
pub(crate) fn likeliest<'n>(nodes: impl IntoIterator<Item = &'n Node>) -> Option<&'n Node> {
    nodes.into_iter().max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))
}

/// Largest log evidence; minus infinity of no nodes.
pub(crate) fn highest<'n>(nodes: impl IntoIterator<Item = &'n Node>) -> f64 {
    likeliest(nodes).map_or(f64::NEG_INFINITY, |node| node.log_evidence)
}

/// Groups of hypotheses: simple, general, displaced by a spline or smoothly, general with a natural departure alone, bodies.
pub(crate) const GROUPS: usize = 5;

impl Node {
    /// Number of the node's group.
    pub(crate) fn group(&self) -> usize {
        match (self.kind, self.departure) {
            (Kind::General, Departure::Natural) => 3,
            (Kind::General, Departure::Body(_)) => 4,
            (Kind::General, Departure::Rough(_) | Departure::Both(_) | Departure::Smooth { .. }) => 2,
            (Kind::General | Kind::Paraboloid, _) => 1,
            _ => 0,
        }
    }

    /// What it is called in the answer.
    pub(crate) fn hypothesis(&self) -> Hypothesis {
        match self.kind {
            Kind::Plane => Hypothesis::Plane,
            Kind::Sphere => Hypothesis::Sphere,
            Kind::Cylinder => Hypothesis::Cylinder,
            Kind::General if self.is_displaced() => match self.departure.body() {
                None => Hypothesis::Displaced,
                Some(Body::Quadric) => Hypothesis::Quadric,
                Some(Body::TorusAlongU | Body::TorusAlongV) => Hypothesis::Torus,
            },
            Kind::General => Hypothesis::General,
            Kind::Paraboloid => Hypothesis::Paraboloid,
        }
    }

    /// Whether the surface departs from its kind at all.
    pub(crate) fn is_displaced(&self) -> bool {
        self.departure != Departure::None
    }

    /// Whether it does so by a natural departure alone.
    pub(crate) fn is_natural(&self) -> bool {
        self.departure == Departure::Natural
    }

    /// Whether it is a body whose form is known but for a few numbers.
    pub(crate) fn is_body(&self) -> bool {
        self.departure.body().is_some()
    }

    /// Standard deviation of the errors that neighbours share.
    pub(crate) fn tau(&self) -> f64 {
        (self.variance * self.ratio).sqrt()
    }
}
