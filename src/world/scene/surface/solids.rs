//! Bodies of several solids, joined and cut: blocks, balls, bars, frustums and rings.
//!
//! ```text
//! solid(p)  = max over its faces of the distance to the face        < 0 inside
//! body(p)   = max(min over solids, - min over cuts)                 a point of a face is seen where body = 0
//! scan      points of every face, spread by the sequence (k g1, k g2) mod 1 over its area, those that are seen
//! ```
//!
//! Unlike other bodies these have no apex at the origin: each solid is centred where its pose puts it, its axis along z.
//! g1, g2 are powers of the plastic number (M. Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018): the
//! points are as even as a lattice without its rows, which no simulation of a scanner should have.

use super::geometry::Geometry;
use super::local::Local;
use super::pose::Pose;
use super::ray::through_ball;
use super::solid::{Face, SolidShape};
use super::{Body, SceneError, Surface, SurfacePoint};
use crate::scene::error::finite;
use palpate_numeric::vector::{Vector, along, dot, minus, norm, scaled};

/// Most points of one scan.
const MOST_POINTS: f64 = 1e7;

/// Inverse powers of the plastic number.
const SPREAD: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// Several solids as one body.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Solids {
    /// At least one of them is no cut.
    pub parts: Vec<Solid>,
}

impl Surface {
    /// Solids that are joined and cut, each where its own pose puts it: what a scanner sees. Range: at least one that is no
    /// cut.
    ///
    /// ```
    /// # use palpate_world::facade as palpate;
    /// use palpate::scene::{Solid, Surface, Sweep, World};
    ///
    /// // a block with a hole through it
    /// let block = Surface::solids(vec![Solid::block([8.0, 8.0, 3.0]), Solid::bar(2.0, 4.0).cut()]);
    /// let (points, truth) = World::new(block, Sweep::scan(0.5, None)).compile()?.simulate(1997, 0);
    /// assert_eq!(points.len(), truth.points.len());
    /// # Ok::<(), palpate::scene::SceneError>(())
    /// ```
    pub fn solids(parts: Vec<Solid>) -> Surface {
        Surface::new(Body::Solids(Solids { parts }), 0.0)
    }
}

/// One solid of a body of several, centred at the origin, its axis along z, until it is posed. Lengths in input units.
///
/// ```
/// # use palpate_world::facade as palpate;
/// use palpate::scene::{Solid, Surface};
///
/// // a capsule, 10 from end to end and lying along x
/// let lying = [0.0, 90.0, 0.0];
/// let ends = [-3.0, 3.0].map(|x| Solid::ball(2.0).moved([x, 0.0, 0.0]));
/// let bar = Solid::bar(2.0, 6.0).posed(lying, [0.0; 3]);
/// let capsule = Surface::solids(ends.into_iter().chain([bar]).collect());
/// assert!(capsule.check().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Solid {
    /// What it is.
    pub shape: SolidShape,
    /// Where it is.
    pub pose: Pose,
    /// Taken away from the others instead of added.
    pub cut: bool,
}

impl Solid {
    /// A box with these sides along x, y, z.
    pub fn block(size: [f64; 3]) -> Solid {
        Solid::of(SolidShape::Block { size })
    }

    /// A ball.
    pub fn ball(radius: f64) -> Solid {
        Solid::of(SolidShape::Ball { radius })
    }

    /// A round bar with flat ends, `length` from end to end.
    pub fn bar(radius: f64, length: f64) -> Solid {
        Solid::of(SolidShape::Bar { radius, length })
    }

    /// A cone whose lower end has `radius` and whose upper end has `top`, which is less, and 0 for a whole cone; `length`
    /// from end to end.
    pub fn frustum(radius: f64, top: f64, length: f64) -> Solid {
        Solid::of(SolidShape::Frustum { radius, top, length })
    }

    /// A ring lying flat: radius `major` of its centre line, `minor` of the tube, which is less.
    pub fn ring(major: f64, minor: f64) -> Solid {
        Solid::of(SolidShape::Ring { major, minor })
    }

    fn of(shape: SolidShape) -> Solid {
        Solid { shape, pose: Pose::new(0.0, [0.0; 3], [0.0; 3]), cut: false }
    }

    /// The same solid rotated by `rotation_deg` about the fixed axes x, y, z in that order, degrees, then moved by `offset`.
    pub fn posed(self, rotation_deg: [f64; 3], offset: [f64; 3]) -> Solid {
        Solid { pose: Pose::new(0.0, rotation_deg, offset), ..self }
    }

    /// The same solid, upright, moved by `offset`.
    pub fn moved(self, offset: [f64; 3]) -> Solid {
        self.posed([0.0; 3], offset)
    }

    /// The same solid, taken away from the others instead of added.
    pub fn cut(self) -> Solid {
        Solid { cut: true, ..self }
    }
}

impl Solid {
    /// Greatest distance to a face, in the solid's coordinates: negative inside. Outside it is never more than the true one.
    fn depth(&self, p: Vector) -> f64 {
        let own = self.pose.to_body(p);
        self.shape.faces().iter().map(|face| face.distance(own)).fold(f64::NEG_INFINITY, f64::max)
    }
}

impl Solids {
    /// Every face: solid, face of the solid.
    fn faces(&self) -> Vec<(&Solid, Face)> {
        self.parts.iter().flat_map(|solid| solid.shape.faces().into_iter().map(move |face| (solid, face))).collect()
    }

    fn depth(&self, p: Vector) -> f64 {
        let least = |cut: bool| {
            let depths = self.parts.iter().filter(|solid| solid.cut == cut).map(|solid| solid.depth(p));
            depths.fold(f64::INFINITY, f64::min)
        };
        least(false).max(-least(true))
    }

    /// A length that is rounding here.
    fn rounding(&self) -> f64 {
        1e-9 * self.reach().1
    }

    /// A ball that holds the body.
    fn reach(&self) -> (Vector, f64) {
        let kept = self.parts.iter().filter(|solid| !solid.cut);
        let centre = |solid: &Solid| solid.pose.to_world([0.0; 3]);
        let first = kept.clone().next().map_or([0.0; 3], centre);
        let radius = kept.map(|solid| norm(minus(centre(solid), first)) + solid.shape.reach()).fold(0.0, f64::max);
        (first, radius)
    }

    /// The number of the face that a point of the body lies on, counted over all solids in their order.
    pub(crate) fn face_at(&self, p: [f64; 3]) -> Option<usize> {
        let whole = |(k, (solid, face)): (usize, (&Solid, Face))| {
            // a point beyond the face's rim lies on the face's continuation, not on the body
            let off = face.distance(solid.pose.to_body(p)).abs().max(solid.depth(p).abs());
            (off, k)
        };
        let nearest = self.faces().into_iter().enumerate().map(whole).min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, k)| k)
    }

    /// The kinds of all faces, in the order in which [`Solids::face_at`] numbers them.
    pub(crate) fn face_kinds(&self) -> Vec<&'static str> {
        self.faces().iter().map(|(_, face)| face.word()).collect()
    }

    fn local_of(solid: &Solid, face: &Face, p: Vector) -> Option<Local> {
        let mut local = face.local(solid.pose.to_body(p))?;
        local.normal = solid.pose.direction_to_world(local.normal);
        if solid.cut {
            local = Local {
                normal: scaled(-1.0, local.normal),
                k1: -local.k2,
                k2: -local.k1,
                difference: local.difference,
            };
        }
        Some(local)
    }

    /// Whether the line from a point of the body to the eye is free.
    fn sees(&self, point: Vector, normal: Vector, eye: Vector) -> bool {
        let towards = minus(eye, point);
        let distance = norm(towards);
        let direction = scaled(1.0 / distance, towards);
        // grazing lines are no lines of sight
        if dot(direction, normal) < 0.1 {
            return false;
        }
        let (_, size) = self.reach();
        let mut t = 1e-3 * size;
        while t < distance.min(4.0 * size) {
            let free = self.depth(along(point, t, direction));
            if free < 1e-6 * size {
                return false;
            }
            t += free.max(1e-3 * size);
        }
        true
    }
}

impl Geometry for Solids {
    fn check(&self) -> Result<(), SceneError> {
        if !self.parts.iter().any(|solid| !solid.cut) {
            let expected = "at least one part that is no cut is needed";
            return Err(SceneError::List { key: "surface.parts".into(), expected });
        }
        self.parts.iter().try_for_each(|solid| {
            solid.shape.check()?;
            solid.pose.to_world([0.0; 3]).iter().try_for_each(|v| finite("surface.parts.offset", *v))
        })
    }

    fn height(&self, x: f64, y: f64) -> Option<f64> {
        self.hit([x, y, 0.0], [0.0, 0.0, 1.0])
    }

    fn local(&self, p: Vector) -> Option<Local> {
        let faces = self.faces();
        let (solid, face) = faces.get(self.face_at(p)?)?;
        Solids::local_of(solid, face, p)
    }

    fn hit(&self, o: Vector, d: Vector) -> Option<f64> {
        let (centre, radius) = self.reach();
        let (low, high) = through_ball(o, d, centre, radius * (1.0 + 1e-9))?;
        let length = norm(d);
        let mut t = high;
        // the distance is a lower bound, so a step of it never passes the surface
        while t > low {
            let free = self.depth(along(o, t, d));
            if free <= self.rounding() {
                return Some(t);
            }
            t -= free.max(self.rounding()) / length;
        }
        None
    }

    fn scan(&self, spacing: f64, eye: Option<Vector>) -> Option<Vec<SurfacePoint>> {
        let rounding = self.rounding();
        let mut found = Vec::new();
        for (number, solid) in self.parts.iter().enumerate() {
            for face in solid.shape.faces() {
                let count = (face.area() / (spacing * spacing)).round().min(MOST_POINTS) as usize;
                for k in 0..count {
                    let place = SPREAD.map(|step| (0.5 + step * (k + 1) as f64).fract());
                    let point = solid.pose.to_world(face.at(place[0], place[1]));
                    let others = |cut: bool| {
                        let all = self.parts.iter().enumerate().filter(|(n, other)| *n != number && other.cut == cut);
                        all.map(|(_, other)| other.depth(point)).fold(f64::INFINITY, f64::min)
                    };
                    let shown = others(true) > rounding
                        && if solid.cut { others(false) < -rounding } else { others(false) > rounding };
                    let Some(local) = Solids::local_of(solid, &face, point).filter(|_| shown) else { continue };
                    if eye.is_none_or(|eye| self.sees(point, local.normal, eye)) {
                        found.push(SurfacePoint { point, local });
                    }
                }
            }
        }
        Some(found)
    }
}
