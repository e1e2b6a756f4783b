//! What the makers of a body do: axes in one line or side by side, faces square to each other, equal radii. Each is tested on every pair of
//! parts, whether these meet or not.
//!
//! ```text
//! p = holds B / (holds B + 1 - holds)                 B = N(d; 0, s^2) / a(d)
//! d   an angle between directions, a distance between axes or centres, or the difference of two log radii
//! s   its standard uncertainty, of both parts together
//! a   its density where nothing ties the two: directions even over the half sphere, places even over the size of both parts together,
//!     log radii even over a factor of `radii` either way
//! ```
//!
//! B is the ratio of two evidences: a relation is the more probable the closer it holds by an uncertainty that is small. R. Kass and
//! A. Raftery, *J. Am. Stat. Assoc.* 90 (1995) 773.

use std::f64::consts::PI;

use super::result::{Part, Parts};
use crate::primitives::placed::PartKind;
use palpate_numeric::vector::{Vector, along, cross, dot, minus, norm};

/// How two parts of a body may be tied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum RelationKind {
    /// Two axes are one line, or the centre of a ball lies on an axis.
    Coaxial,
    /// Two centres are one point.
    Concentric,
    /// Faces, axes, or a face and an axis, side by side.
    Parallel,
    /// Faces, axes, or a face and an axis, at right angles.
    Perpendicular,
    /// Two radii are one, that of a ring's tube among them.
    EqualRadius,
}

impl RelationKind {
    /// The words used in every output.
    pub fn name(self) -> &'static str {
        match self {
            RelationKind::Coaxial => "coaxial",
            RelationKind::Concentric => "concentric",
            RelationKind::Parallel => "parallel",
            RelationKind::Perpendicular => "perpendicular",
            RelationKind::EqualRadius => "equal radius",
        }
    }
}

/// Two parts and what probably ties them.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Relation {
    /// Their ids, the smaller first.
    pub parts: [usize; 2],
    /// Which tie.
    pub kind: RelationKind,
    /// Probability that it holds.
    pub probability: f64,
    /// By how much it is missed: degrees of parallel and perpendicular; else a length in the contacts' unit.
    pub missed_by: f64,
    /// Standard uncertainty of that.
    pub u: f64,
}

/// What is believed of relations before a body is touched.
#[derive(Clone, Copy, Debug)]
pub struct RelationPrior {
    /// Probability that a relation holds which two kinds allow: a half, for neither.
    pub holds: f64,
    /// Radii that nothing ties differ by a factor of up to this.
    pub radii: f64,
    /// Relations of at least this probability are told.
    pub told: f64,
    /// Directions and places are not known better than by this share of a radian and of the size: rounding.
    pub rounding: f64,
}

impl Default for RelationPrior {
    fn default() -> RelationPrior {
        RelationPrior { holds: 0.5, radii: 10.0, told: 0.5, rounding: 1e-9 }
    }
}

/// What a relation is asked of: the direction and place of one part with their standard uncertainties.
#[derive(Clone, Copy, Debug)]
struct Placed<'a> {
    part: &'a Part,
    /// Axis or normal, and its uncertainty in each direction across, radians.
    direction: Option<(Vector, f64)>,
    /// Uncertainty of the point, in each direction in which it is fixed.
    u_point: f64,
}

/// A tie that two parts may have: by how much it is missed, with what uncertainty, and the log of B.
struct Tested {
    kind: RelationKind,
    missed_by: f64,
    u: f64,
    log_ratio: f64,
}

impl Parts {
    /// The relations of all pairs of primitives that hold with a probability of `prior.told` or more, kind by kind; of two parts that are coaxial, that they are parallel is not said again. The reach of places is the size of the body.
    pub fn relations(&self, prior: &RelationPrior) -> Vec<Relation> {
        let placed: Vec<Placed> = self.parts.iter().filter_map(|part| Placed::of(part, prior)).collect();
        let middle_to = |a: &Placed, b: &Placed| norm(minus(a.part.geometry.point, b.part.geometry.point));
        let mut found = Vec::new();
        for (k, a) in placed.iter().enumerate() {
            for b in &placed[k + 1..] {
                let largest = [a, b].map(|p| p.part.geometry.radius.unwrap_or(0.0));
                let size = middle_to(a, b) + largest[0].max(largest[1]);
                let mut tested: Vec<Tested> = tests(a, b, size.max(self.spacing), prior);
                let is_told = |t: &Tested| probability(t.log_ratio, prior) >= prior.told;
                tested.retain(is_told);
                if tested.iter().any(|t| t.kind == RelationKind::Coaxial) {
                    tested.retain(|t| t.kind != RelationKind::Parallel);
                }
                found.extend(tested.into_iter().map(|t| Relation {
                    parts: [a.part.id, b.part.id],
                    kind: t.kind,
                    probability: probability(t.log_ratio, prior),
                    missed_by: t.missed_by,
                    u: t.u,
                }));
            }
        }
        found.sort_by(|a, b| a.kind.cmp(&b.kind).then(a.parts.cmp(&b.parts)));
        found
    }
}

impl<'a> Placed<'a> {
    /// `None` of a part whose place or uncertainty is not known.
    fn of(part: &'a Part, prior: &RelationPrior) -> Option<Placed<'a>> {
        let u_point = part.u.point?;
        let direction = match part.kind {
            PartKind::Plane | PartKind::Cylinder | PartKind::Cone | PartKind::Torus => {
                let u = part.u.axis_deg?.to_radians().max(prior.rounding);
                Some((part.geometry.axis?, u))
            }
            PartKind::Sphere => None,
            PartKind::Patch | PartKind::Ellipsoid => return None,
        };
        Some(Placed { part, direction, u_point })
    }

    fn is_plane(&self) -> bool {
        self.part.kind == PartKind::Plane
    }

    /// The centre, of kinds that have one.
    fn centre(&self) -> Option<Vector> {
        matches!(self.part.kind, PartKind::Sphere | PartKind::Torus).then_some(self.part.geometry.point)
    }

    /// A direction of a line that is fixed across it.
    fn axis(&self) -> Option<(Vector, f64)> {
        self.direction.filter(|_| !self.is_plane())
    }

    /// Radii of round sections, with their uncertainties: a cone has none, a ring has that of its tube.
    fn section(&self) -> Option<(f64, f64)> {
        let (g, u) = (&self.part.geometry, &self.part.u);
        match self.part.kind {
            PartKind::Sphere | PartKind::Cylinder => g.radius.zip(u.radius),
            PartKind::Torus => g.minor_radius.zip(u.minor_radius),
            _ => None,
        }
    }
}

fn probability(log_ratio: f64, prior: &RelationPrior) -> f64 {
    let log_odds = log_ratio + (prior.holds / (1.0 - prior.holds)).ln();
    1.0 / (1.0 + (-log_odds).exp())
}

/// ln N(d; 0, s^2 I) in so many directions, `square` being |d|^2.
pub(super) fn log_normal(square: f64, s: f64, directions: i32) -> f64 {
    -0.5 * square / (s * s) - f64::from(directions) * (s * (2.0 * PI).sqrt()).ln()
}

fn tests(a: &Placed, b: &Placed, size: f64, prior: &RelationPrior) -> Vec<Tested> {
    let mut found = Vec::new();
    let floor = prior.rounding * size;
    if let (Some(one), Some(two)) = (a.direction, b.direction) {
        found.extend(of_directions(one, two, a.is_plane() != b.is_plane()));
    }
    match (a.axis(), b.axis()) {
        (Some(one), Some(two)) => found.push(of_axes((a, one), (b, two), size, floor)),
        (Some(axis), None) if b.centre().is_some() => found.push(on_axis(b, (a, axis), size, floor)),
        (None, Some(axis)) if a.centre().is_some() => found.push(on_axis(a, (b, axis), size, floor)),
        _ => {}
    }
    if let (Some(one), Some(two)) = (a.centre(), b.centre()) {
        let s = a.u_point.hypot(b.u_point).max(floor);
        let off = norm(minus(one, two));
        let even = -(4.0 / 3.0 * PI * size.powi(3)).ln();
        let log_ratio = log_normal(off * off, s, 3) - even;
        found.push(Tested { kind: RelationKind::Concentric, missed_by: off, u: s, log_ratio });
    }
    if let (Some((r, u_r)), Some((q, u_q))) = (a.section(), b.section()) {
        let s = (u_r / r).hypot(u_q / q).max(prior.rounding);
        let off = (r / q).ln();
        let log_ratio = log_normal(off * off, s, 1) + (2.0 * prior.radii.ln()).ln();
        let (missed_by, u) = ((r - q).abs(), u_r.hypot(u_q));
        found.push(Tested { kind: RelationKind::EqualRadius, missed_by, u, log_ratio });
    }
    found
}

/// Side by side and at right angles. Of a plane and an axis the plane's normal is meant, which turns the words about.
fn of_directions((n, u_n): (Vector, f64), (m, u_m): (Vector, f64), mixed: bool) -> [Tested; 2] {
    let s = u_n.hypot(u_m);
    let angle = norm(cross(n, m)).atan2(dot(n, m).abs());
    let off_square = dot(n, m).abs().asin();
    let along = log_normal(angle * angle, s, 2) + (2.0 * PI).ln();
    // |n . m| of even directions is even between 0 and 1
    let across = log_normal(off_square * off_square, s, 1) + 2.0_f64.ln();
    let [first, second] = if mixed {
        [RelationKind::Perpendicular, RelationKind::Parallel]
    } else {
        [RelationKind::Parallel, RelationKind::Perpendicular]
    };
    [
        Tested { kind: first, missed_by: angle.to_degrees(), u: s.to_degrees(), log_ratio: along },
        Tested { kind: second, missed_by: off_square.to_degrees(), u: s.to_degrees(), log_ratio: across },
    ]
}

/// Whether two axes are one line: side by side, and not apart at the middle between both parts.
fn of_axes(
    (a, (n, u_n)): (&Placed, (Vector, f64)),
    (b, (m, u_m)): (&Placed, (Vector, f64)),
    size: f64,
    floor: f64,
) -> Tested {
    let parallel = of_directions((n, u_n), (m, u_m), false)[0].log_ratio;
    let [p, q] = [a, b].map(|placed| placed.part.geometry.point);
    let half = 0.5 * dot(minus(q, p), n);
    let towards = if dot(n, m) < 0.0 { half } else { -half };
    let apart = minus(along(q, towards, m), along(p, half, n));
    let off = norm(cross(apart, n));
    let s = a.u_point.hypot(b.u_point).hypot(half * u_n).hypot(half * u_m).max(floor);
    let log_ratio = parallel + log_normal(off * off, s, 2) + (PI * size * size).ln();
    Tested { kind: RelationKind::Coaxial, missed_by: off, u: s, log_ratio }
}

/// Whether a centre lies on an axis.
fn on_axis(ball: &Placed, (bar, (n, u_n)): (&Placed, (Vector, f64)), size: f64, floor: f64) -> Tested {
    let apart = minus(ball.part.geometry.point, bar.part.geometry.point);
    let (off, along) = (norm(cross(apart, n)), dot(apart, n));
    let s = ball.u_point.hypot(bar.u_point).hypot(along * u_n).max(floor);
    let log_ratio = log_normal(off * off, s, 2) + (PI * size * size).ln();
    Tested { kind: RelationKind::Coaxial, missed_by: off, u: s, log_ratio }
}

#[cfg(test)]
mod tests {
    use super::super::result::{PartGeometry, PartUncertainty};
    use super::*;
    use palpate_numeric::draws::Lcg;
    use palpate_numeric::vector::unit;

    fn anywhere(generator: &mut Lcg) -> Vector {
        [0, 1, 2].map(|_| generator.normal())
    }

    fn part(id: usize, kind: PartKind, point: Vector, axis: Option<Vector>, radius: Option<f64>) -> Part {
        let u = PartUncertainty {
            point: Some(U_LENGTH),
            axis_deg: axis.map(|_| U_DEG),
            radius: radius.map(|_| U_LENGTH),
            ..PartUncertainty::default()
        };
        Part {
            id,
            kind,
            hollow: false,
            geometry: PartGeometry { point, axis, radius, ..PartGeometry::default() },
            u,
            class: None,
            other_class: None,
            shape_index: None,
            curvedness: 0.0,
            points: 100,
            extent: 1.0,
            misfit: 0.0,
            rejected: None,
            p: None,
            departure: 0.0,
        }
    }

    const U_LENGTH: f64 = 0.01;
    const U_DEG: f64 = 0.2;

    fn body(parts: Vec<Part>) -> Parts {
        Parts {
            parts,
            joints: Vec::new(),
            labels: Vec::new(),
            spacing: 0.1,
            noise: 0.01,
            normal_noise_deg: 1.0,
            tolerance: 0.0,
            notes: Vec::new(),
        }
    }

    /// A measured bar about an axis.
    fn bar(id: usize, point: Vector, axis: Vector, radius: f64, generator: &mut Lcg) -> Part {
        let off = along(point, U_LENGTH, anywhere(generator));
        let turned = unit(along(axis, U_DEG.to_radians(), anywhere(generator)));
        part(id, PartKind::Cylinder, off, Some(turned), Some(radius + U_LENGTH * generator.normal()))
    }

    fn told(parts: &Parts, kind: RelationKind) -> Option<f64> {
        parts.relations(&RelationPrior::default()).iter().find(|r| r.kind == kind).map(|r| r.probability)
    }

    /// Of pairs of which each kind of tie holds in half, those called tied with 95 % or more are, and few that are tied are missed.
    #[test]
    fn what_is_told_is_so() {
        let mut generator = Lcg::new(8);
        let (mut claimed, mut right, mut ties, mut found) = (0, 0, 0, 0);
        for _ in 0..600 {
            let axis = unit(anywhere(&mut generator));
            let (is_coaxial, is_equal) = (generator.uniform() < 0.5, generator.uniform() < 0.5);
            let one = bar(0, [0.0; 3], axis, 1.0, &mut generator);
            let other = if is_coaxial {
                (axis.map(|v| 3.0 * v), axis)
            } else {
                (anywhere(&mut generator), unit(anywhere(&mut generator)))
            };
            let radius = if is_equal { 1.0 } else { (3.0 * (generator.uniform() - 0.5)).exp() };
            let two = bar(1, other.0, other.1, radius, &mut generator);
            let parts = body(vec![one, two]);
            for (kind, holds) in [(RelationKind::Coaxial, is_coaxial), (RelationKind::EqualRadius, is_equal)] {
                let sure = told(&parts, kind).is_some_and(|p| p >= 0.95);
                claimed += usize::from(sure);
                right += usize::from(sure && holds);
                ties += usize::from(holds);
                found += usize::from(sure && holds);
            }
        }
        assert!(20 * right >= 19 * claimed, "{right} of {claimed}");
        assert!(10 * found >= 9 * ties, "{found} of {ties}");
    }

    #[test]
    fn faces_and_axes_have_the_words_that_people_use() {
        let z = [0.0, 0.0, 1.0];
        let plane = |id, axis| part(id, PartKind::Plane, [0.0, 0.0, 2.0], Some(axis), None);
        let pipe = part(2, PartKind::Cylinder, [0.0; 3], Some(z), Some(1.0));
        let lid = body(vec![plane(0, z), plane(1, [0.0, 0.0, -1.0]), pipe.clone()]);
        let words: Vec<(&str, [usize; 2])> =
            lid.relations(&RelationPrior::default()).iter().map(|r| (r.kind.name(), r.parts)).collect();
        assert_eq!(words, [("parallel", [0, 1]), ("perpendicular", [0, 2]), ("perpendicular", [1, 2])]);
        let ball = part(0, PartKind::Sphere, [0.0, 0.0, 4.0], None, Some(1.0));
        let capsule = body(vec![ball.clone(), pipe]);
        assert!(told(&capsule, RelationKind::Coaxial).is_some_and(|p| p > 0.99));
        assert!(told(&capsule, RelationKind::EqualRadius).is_some_and(|p| p > 0.9));
        let shell = body(vec![ball.clone(), Part { id: 1, ..ball }]);
        assert!(told(&shell, RelationKind::Concentric).is_some_and(|p| p > 0.99));
    }
}
