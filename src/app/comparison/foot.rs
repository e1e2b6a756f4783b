//! Where a line meets a surface: Newton's method from the nearest of a lattice of points.
//!
//! ```text
//! Q(u, v) = P + t n        [Q_u  Q_v  -n] (du, dv, dt) = P + t n - Q
//! ```

use palpate_numeric::bspline::linspace;
use palpate_numeric::vector::{Vector, along, cross, dot, minus, norm};

use super::side::Side;
use palpate_geometry::surface::Jet;

/// Points of the lattice each way.
const LATTICE: usize = 33;

/// Steps after which a line that has not met the surface is given up.
const STEPS: usize = 30;

/// A place may lie outside of the chart by this share of its side, so that rounding at the rim does not decide.
const RIM: f64 = 1e-9;

/// A meeting point is found when it is off by less than this share of the surface's size.
const MET: f64 = 1e-12;

/// A surface with its lattice.
pub(super) struct Feet<'a> {
    side: &'a Side<'a>,
    lattice: Vec<([f64; 2], Vector)>,
    size: f64,
}

impl<'a> Feet<'a> {
    pub(super) fn new(side: &'a Side<'a>) -> Feet<'a> {
        let [u, v] = side.domain().map(|[lo, hi]| linspace(lo, hi, LATTICE));
        let places = u.iter().flat_map(|u| v.iter().map(move |v| [*u, *v]));
        let lattice = places.map(|place| (place, side.jet(place).point)).collect();
        let [lo, hi] = side.bounds();
        Feet { side, lattice, size: norm(minus(hi, lo)) }
    }

    /// The place of the chart at which the line through `point` along `normal` meets the surface near `point`.
    pub(super) fn along(&self, point: Vector, normal: Vector) -> Option<[f64; 2]> {
        let distance = |q: &Vector| {
            let offset = minus(*q, point);
            dot(offset, offset)
        };
        let (mut place, _) = *self.lattice.iter().min_by(|a, b| distance(&a.1).total_cmp(&distance(&b.1)))?;
        let mut t = 0.0;
        for _ in 0..STEPS {
            let Jet { point: q, derivatives: d } = self.side.jet(place);
            let miss = minus(along(point, t, normal), q);
            if norm(miss) <= MET * self.size {
                return self.inside(place);
            }
            let back = normal.map(|v| -v);
            let volume = dot(d.u, cross(d.v, back));
            let step = [dot(miss, cross(d.v, back)), dot(d.u, cross(miss, back)), dot(d.u, cross(d.v, miss))]
                .map(|v| v / volume);
            if step.iter().any(|v| !v.is_finite()) {
                return None;
            }
            (place, t) = ([place[0] + step[0], place[1] + step[1]], t + step[2]);
            place = self.held(place);
        }
        None
    }

    /// A step that leaves the chart far behind is cut: end polynomials grow fast.
    fn held(&self, place: [f64; 2]) -> [f64; 2] {
        let (domain, closed) = (self.side.domain(), self.side.closed());
        [0, 1].map(|k| {
            let [lo, hi] = domain[k];
            let slack = 0.25 * (hi - lo);
            if closed[k] { place[k] } else { place[k].clamp(lo - slack, hi + slack) }
        })
    }

    fn inside(&self, place: [f64; 2]) -> Option<[f64; 2]> {
        let (domain, closed) = (self.side.domain(), self.side.closed());
        let within = |k: usize| {
            let [lo, hi] = domain[k];
            let rim = RIM * (hi - lo);
            closed[k] || (lo - rim..=hi + rim).contains(&place[k])
        };
        (within(0) && within(1)).then_some(place)
    }
}
