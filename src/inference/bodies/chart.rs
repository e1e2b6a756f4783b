//! A primitive as a map Q(u, v) over the part that was touched, in the input's coordinates.
//!
//! ```text
//! plane      u, v along two axes of it                   cylinder, cone   u = r angle, v along a generator
//! sphere     u = r longitude, v = r latitude             torus            u = R angle of the ring, v = r angle of the tube
//! ```
//!
//! Angles are counted from the middle of what was touched, so that the seam lies in the widest gap; a gap narrower than a sixth of
//! the way round is none. `Q_u x Q_v` points to the free side.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::primitives::placed::{PartKind, Primitive};
use palpate_geometry::contact::Frame;
use palpate_geometry::curvature::{curvedness, shape_index};
use palpate_geometry::neighbours::{Neighbours, mean_of};
use palpate_numeric::statistics::{Rank, quantile};
use palpate_numeric::vector::{Vector, along, axes_along, cross, dot, minus, norm, unit_or_zero};

use super::posterior::DrawnBase;
use super::tuning::Tuning;

/// Contacts by which a place is surrounded.
const BESIDE: usize = 8;

/// Latitudes beyond which meridians are too near to each other for a chart.
const POLAR: f64 = 1.48;

/// Newton steps to the surface over a place of x and y; a place beyond the edge has none, and is left after so many.
const STEPS_UPWARD: usize = 30;

/// Share of the contacts' size within which such a place counts as reached.
const REACHED: f64 = 1e-9;

/// Least nz of a surface that is touched from above: steeper than 87 degrees it is met anywhere.
const UPRIGHT: f64 = 0.05;

/// A body over a rectangle of its chart.
#[derive(Clone, Debug)]
pub(crate) struct BodyChart {
    /// Units of the contacts' size about their middle, with the input's axes.
    pub(crate) frame: Frame,
    primitive: Primitive,
    /// Angle of a torus's tube from which v is counted: the middle of what was touched.
    tube_from: f64,
    /// The likeliest surface: the primitive, with its departure where that is shape.
    surface: DrawnBase,
    /// Draws of the posterior, for the uncertainty point by point.
    pub(crate) draws: Arc<Vec<DrawnBase>>,
    contacts: Arc<Neighbours<'static>>,
    reach: f64,
    surrounded: f64,
    pub(crate) u: [f64; 2],
    pub(crate) v: [f64; 2],
}

impl BodyChart {
    /// Of contacts that belong to the body, in its units.
    pub(crate) fn new(
        frame: Frame,
        likeliest: DrawnBase,
        contacts: &[Vector],
        draws: Vec<DrawnBase>,
        tuning: &Tuning,
    ) -> BodyChart {
        let primitive = with_seam(likeliest.primitive, contacts);
        let foot = |p: &Vector| {
            let (d, normal) = primitive.nearest(*p);
            along(*p, -d, normal)
        };
        // of departures as large as the body the base's feet tell no distance between contacts
        let is_level_set = likeliest.is_level_set();
        let feet: Vec<Vector> = contacts.iter().map(|p| if is_level_set { *p } else { foot(p) }).collect();
        let tree = Neighbours::new(&feet).into_owned();
        let beside: Vec<f64> = (0..feet.len()).filter_map(|i| tree.nearest_other(i)).map(|(d, _)| d).collect();
        let reach = tuning.supported[usize::from(is_level_set)]
            * quantile(beside, 0.9, Rank::NearestStep).unwrap_or(f64::INFINITY);
        let mut chart = BodyChart {
            frame,
            primitive,
            tube_from: middle(&tube_angles(&primitive, contacts)),
            surface: likeliest,
            draws: Arc::new(draws),
            contacts: Arc::new(tree),
            reach,
            surrounded: tuning.surrounded,
            u: [0.0; 2],
            v: [0.0; 2],
        };
        [chart.u, chart.v] = chart.ranges(&feet, tuning.no_gap_deg.to_radians());
        chart
    }

    fn ranges(&self, feet: &[Vector], no_gap: f64) -> [[f64; 2]; 2] {
        let places: Vec<[f64; 2]> = feet.iter().map(|q| self.own_chart(*q)).collect();
        let lengths = self.lengths();
        let range = |k: usize| {
            let values = places.iter().map(|place| place[k]);
            let [lo, hi] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)]);
            let round = self.is_round(k).then(|| PI * lengths[k]);
            match round {
                Some(half) if 2.0 * half - (hi - lo) < no_gap * lengths[k] => [-half, half],
                _ if hi > lo => [lo, hi],
                // all contacts on one line of the chart
                _ => [lo - 0.5 * lengths[k].min(1.0), hi + 0.5 * lengths[k].min(1.0)],
            }
        };
        [range(0), range(1)]
    }

    /// Lengths of one radian in the two directions.
    fn lengths(&self) -> [f64; 2] {
        let [one, two, three] = self.primitive.sizes;
        match self.primitive.kind {
            PartKind::Plane | PartKind::Patch => [1.0, 1.0],
            PartKind::Sphere => [one, one],
            PartKind::Cylinder | PartKind::Cone => [one.abs(), 1.0],
            PartKind::Torus => [one, two],
            PartKind::Ellipsoid => [(one * two * three).cbrt(); 2],
        }
    }

    /// Whether the chart comes back to itself that way.
    fn is_round(&self, k: usize) -> bool {
        match self.primitive.kind {
            PartKind::Plane | PartKind::Patch => false,
            PartKind::Sphere | PartKind::Cylinder | PartKind::Cone | PartKind::Ellipsoid => k == 0,
            PartKind::Torus => true,
        }
    }

    /// Chart coordinates of a place, in the sample's units; `u` is turned so that the normal points to the free side.
    fn own_chart(&self, p: Vector) -> [f64; 2] {
        let q = self.primitive.own(p);
        let [lu, lv] = self.lengths();
        let rho = q[0].hypot(q[1]);
        let angle = q[1].atan2(q[0]);
        let [u, v] = match self.primitive.kind {
            PartKind::Plane | PartKind::Patch => [q[0], q[1]],
            PartKind::Sphere => [lu * angle, lv * q[2].atan2(rho).clamp(-POLAR, POLAR)],
            PartKind::Cylinder => [lu * angle, q[2]],
            PartKind::Cone => {
                let (sin, cos) = self.primitive.sizes[1].sin_cos();
                [lu * angle, (rho - self.primitive.sizes[0]) * sin + q[2] * cos]
            }
            PartKind::Torus => {
                let from = q[2].atan2(rho - self.primitive.sizes[0]) - self.tube_from;
                [lu * angle, lv * (from - 2.0 * PI * (from / (2.0 * PI)).round())]
            }
            PartKind::Ellipsoid => {
                let (d, normal) = self.primitive.distance(q);
                let x = [0, 1, 2].map(|k| (q[k] - d * normal[k]) / self.primitive.sizes[k]);
                [lu * x[1].atan2(x[0]), lv * x[2].atan2(x[0].hypot(x[1])).clamp(-POLAR, POLAR)]
            }
        };
        [self.primitive.side * u, v]
    }

    /// Place in the sample's units.
    fn place(&self, [u, v]: [f64; 2]) -> Vector {
        let u = self.primitive.side * u;
        let [lu, lv] = self.lengths();
        let [one, two, three] = self.primitive.sizes;
        let round = |rho: f64, angle: f64, h: f64| [rho * angle.cos(), rho * angle.sin(), h];
        let own = match self.primitive.kind {
            PartKind::Plane | PartKind::Patch => [u, v, 0.0],
            PartKind::Sphere => {
                let (sin, cos) = (v / lv).sin_cos();
                round(one * cos, u / lu, one * sin)
            }
            PartKind::Cylinder => round(one, u / lu, v),
            PartKind::Cone => {
                let (sin, cos) = two.sin_cos();
                round(one + v * sin, u / lu, v * cos)
            }
            PartKind::Torus => {
                let (sin, cos) = (v / lv + self.tube_from).sin_cos();
                round(one + two * cos, u / lu, two * sin)
            }
            PartKind::Ellipsoid => {
                let ((sin, cos), angle) = ((v / lv).sin_cos(), u / lu);
                [one * cos * angle.cos(), two * cos * angle.sin(), three * sin]
            }
        };
        along(self.primitive.origin, 1.0, self.primitive.out(own))
    }

    pub(crate) fn at(&self, u: f64, v: f64) -> (Vector, Vector) {
        let (place, normal) = self.surface.over(self.place([u, v]));
        (self.frame.to_input(place), self.frame.rotate_back(normal))
    }

    pub(crate) fn curvatures_at(&self, u: f64, v: f64) -> Option<[f64; 2]> {
        let both = self.surface.curvatures(self.place([u, v])).map(|k| k / self.frame.scale);
        both.iter().all(|k| k.is_finite()).then_some(both)
    }

    pub(crate) fn supported_at(&self, u: f64, v: f64) -> bool {
        let place = self.place([u, v]);
        let is_near = |place: Vector, reach: f64| {
            self.contacts.nearest(place, 1).first().is_some_and(|(square, _)| *square <= reach * reach)
        };
        if !self.surface.is_level_set() {
            return is_near(place, self.reach);
        }
        let (place, normal) = self.surface.over(place);
        is_near(place, self.reach) && self.is_surrounded(place) && self.faces_as_beside(place, normal)
    }

    /// Whether the surface faces there as it does at the contact next to it: steps to the surface may end where F is 0 for no contact.
    fn faces_as_beside(&self, place: Vector, normal: Vector) -> bool {
        let nearest = self.contacts.nearest(place, 1);
        let agrees = |contact: Vector| dot(self.surface.over(contact).1, normal) > 0.0;
        nearest.first().is_some_and(|(_, i)| agrees(self.contacts.point(*i)))
    }

    /// Whether contacts lie on all sides: beyond the last of them, and on the rim itself, a free surface may bend in any way.
    ///
    /// ```text
    /// |mean of (c - p)| <= most sqrt(mean |c - p|^2)       c: the eight contacts next to p
    /// ratio    1 / sqrt 8 = 0.35 among random contacts, (4 / 3 pi) / (1 / sqrt 2) = 0.6 on a straight rim
    /// ```
    fn is_surrounded(&self, place: Vector) -> bool {
        let beside = self.contacts.nearest(place, BESIDE);
        let offsets: Vec<Vector> = beside.iter().map(|(_, i)| minus(self.contacts.point(*i), place)).collect();
        let square = offsets.iter().map(|o| dot(*o, *o)).sum::<f64>() / offsets.len().max(1) as f64;
        norm(mean_of(&offsets)) <= self.surrounded * square.sqrt()
    }

    pub(crate) fn chart_of(&self, place: Vector) -> [f64; 2] {
        self.own_chart(self.frame.to_patch(place))
    }

    pub(crate) fn distance(&self, place: Vector) -> f64 {
        self.frame.scale * self.surface.distance(self.frame.to_patch(place))
    }

    /// Standard uncertainties of height and of the normal's direction (radians) at a place of the input, and of S, R, k1 and k2 there.
    pub(crate) fn sds_at(&self, place: Vector) -> [f64; 6] {
        self.sds_of(&self.readings_at(place))
    }

    /// Height, turn of the normal (radians), S, R, k1 and k2 of every draw at a place of the input, in the sample's units.
    pub(crate) fn readings_at(&self, place: Vector) -> Vec<[f64; 6]> {
        let local = self.frame.to_patch(place);
        let (d, normal) = self.primitive.nearest(local);
        // where departures are as large as the body its foot lies elsewhere
        let foot = if self.surface.is_level_set() { local } else { along(local, -d, normal) };
        let normal = if self.surface.is_level_set() { self.surface.over(local).1 } else { normal };
        let of = |drawn: &DrawnBase| {
            let reading = drawn.reading(foot);
            let [k1, k2] = reading.curvatures;
            let s = shape_index(k1 + k2, (k1 - k2).abs()).unwrap_or(0.0);
            [reading.distance, norm(minus(reading.normal, normal)), s, curvedness(k1, k2), k1, k2]
        };
        self.draws.iter().map(of).collect()
    }

    /// Numbers of at most so many of the draws, evenly.
    pub(crate) fn some_draws(&self, most: usize) -> Vec<usize> {
        (0..self.draws.len()).step_by(self.draws.len().div_ceil(most).max(1)).collect()
    }

    /// Signed distance of a place of the input from these draws, and their unit normals at its feet, in the input's units and axes.
    pub(crate) fn drawn_at(&self, place: Vector, draws: &[usize]) -> Vec<(f64, Vector)> {
        let local = self.frame.to_patch(place);
        let of = |&d: &usize| {
            let there = self.draws[d].reading(local);
            (self.frame.scale * there.distance, self.frame.rotate_back(there.normal))
        };
        draws.iter().map(of).collect()
    }

    /// What a touch at a place of the input would measure on these of the draws: the height of the surface over the likeliest one,
    /// input units, and two slopes against it.
    pub(crate) fn measured_at(&self, place: Vector, draws: &[usize]) -> Vec<[f64; 3]> {
        let local = self.frame.to_patch(place);
        let (foot, normal) = self.surface.over(local);
        let [first, second, _] = axes_along(normal);
        let of = |&d: &usize| {
            let there = self.draws[d].reading(foot);
            [-self.frame.scale * there.distance, dot(there.normal, first), dot(there.normal, second)]
        };
        draws.iter().map(of).collect()
    }

    /// The point of the surface over a place of the input's x and y that is next to a height; `None` where the surface stands
    /// upright, or is not there.
    pub(crate) fn point_over(&self, [x, y]: [f64; 2], height: f64) -> Option<Vector> {
        let mut point = [x, y, height];
        for _ in 0..STEPS_UPWARD {
            let reading = self.surface.reading(self.frame.to_patch(point));
            let upward = self.frame.rotate_back(reading.normal)[2];
            let step = self.frame.scale * reading.distance / upward;
            if !(step.is_finite() && upward.abs() > UPRIGHT) {
                return None;
            }
            point[2] -= step;
            if step.abs() <= REACHED * self.frame.scale {
                return Some(point);
            }
        }
        None
    }

    /// Standard uncertainties of such readings, in the input's units.
    pub(crate) fn sds_of(&self, readings: &[[f64; 6]]) -> [f64; 6] {
        let (mut sums, mut squares) = ([0.0; 6], [0.0; 6]);
        for (drawn, reading) in self.draws.iter().zip(readings) {
            for (k, value) in reading.iter().enumerate() {
                sums[k] += drawn.share * value;
                squares[k] += drawn.share * value * value;
            }
        }
        // the mean normal is the likeliest: its scatter is about zero
        sums[1] = 0.0;
        let sd = |k: usize| (squares[k] - sums[k] * sums[k]).max(0.0).sqrt();
        let scale = self.frame.scale;
        [sd(0) * scale, sd(1) / 2.0_f64.sqrt(), sd(2), sd(3) / scale, sd(4) / scale, sd(5) / scale]
    }
}

/// The same in axes whose seam lies in the widest gap between contacts.
fn with_seam(mut primitive: Primitive, contacts: &[Vector]) -> Primitive {
    if primitive.kind == PartKind::Sphere {
        primitive.axes = axes_along(pole(&primitive, contacts));
    }
    // the axes of an ellipsoid are its own
    if !matches!(primitive.kind, PartKind::Plane | PartKind::Ellipsoid) {
        let (axes, (sin, cos)) = (primitive.axes, middle(&angles(&primitive, contacts)).sin_cos());
        let first = along(axes[0].map(|e| e * cos), sin, axes[1]);
        primitive.axes = [first, cross(axes[2], first), axes[2]];
    }
    primitive
}

/// The poles of a ball's chart lie where it was touched least: across the contacts' mean direction, and of all ways across it where they
/// reach least.
fn pole(ball: &Primitive, contacts: &[Vector]) -> Vector {
    let directions: Vec<Vector> = contacts.iter().map(|p| unit_or_zero(minus(*p, ball.origin))).collect();
    let mean = directions.iter().fold([0.0; 3], |sum, d| along(sum, 1.0 / contacts.len() as f64, *d));
    let spread_along = |axis: Vector| directions.iter().map(|d| dot(*d, axis).powi(2)).sum::<f64>();
    let middle = if norm(mean) > 0.2 { unit_or_zero(mean) } else { [0.0, 0.0, 1.0] };
    let [e1, e2, _] = axes_along(middle);
    let ways = (0..36).map(|k| f64::from(k) * PI / 36.0).map(|a| along(e1.map(|e| e * a.cos()), a.sin(), e2));
    let found = ways.min_by(|a, b| spread_along(*a).total_cmp(&spread_along(*b)));
    if norm(mean) > 0.2 { found.unwrap_or(e1) } else { middle }
}

/// Angles of the contacts round the axis.
fn angles(primitive: &Primitive, contacts: &[Vector]) -> Vec<f64> {
    contacts.iter().map(|p| primitive.own(*p)).map(|q| q[1].atan2(q[0])).collect()
}

/// Angles round the tube of a torus; none of another kind.
fn tube_angles(primitive: &Primitive, contacts: &[Vector]) -> Vec<f64> {
    let own = contacts.iter().filter(|_| primitive.kind == PartKind::Torus).map(|p| primitive.own(*p));
    own.map(|q| q[2].atan2(q[0].hypot(q[1]) - primitive.sizes[0])).collect()
}

/// The angle opposite to the middle of the widest gap.
fn middle(angles: &[f64]) -> f64 {
    let mut ordered = angles.to_vec();
    ordered.sort_by(f64::total_cmp);
    let count = ordered.len();
    let gap = |k: usize| {
        if k + 1 < count { ordered[k + 1] - ordered[k] } else { ordered[0] + 2.0 * PI - ordered[count - 1] }
    };
    let widest = (0..count).max_by(|a, b| gap(*a).total_cmp(&gap(*b)));
    widest.map_or(0.0, |k| ordered[k] + 0.5 * gap(k) - PI)
}
