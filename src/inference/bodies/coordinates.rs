//! What a departure is a function of, and how its derivatives there are those at a place.
//!
//! ```text
//! section     q = (rho, h) of the foot: what is the same all round a base's axis, and small
//! turned      q = (rho, h): distance from the base's axis and height along it;  k(q, c) + k(q, (-rho_c, h_c)), smooth on the axis
//!             hess f = f_rr r r' + f_rh (r a' + a r') + f_hh a a' + f_r / rho (1 - r r' - a a')      r: away from the axis a
//! extruded    q = (x, y): the two coordinates across the base's axis
//! ```

use crate::primitives::placed::Primitive;
use palpate_numeric::vector::{Vector, along, dot};

/// Distance from the axis of a turned body within which curvature round it is that along it.
const NEAR_AXIS: f64 = 1e-6;

/// In which way a free surface is the same in many places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Symmetry {
    None,
    /// All round an axis.
    Turned,
    /// All along a line.
    Extruded,
}

/// What a departure is a function of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DepartureOver {
    /// The foot of a place on the base.
    Feet,
    /// The foot's distance from the base's axis and its height along it: the base's section is another one.
    Section,
    /// The place itself.
    Space,
    /// Distance from the base's axis and height along it: a body of revolution.
    Turned,
    /// The two coordinates across the base's axis: a body drawn along it.
    Extruded,
}

impl DepartureOver {
    /// What that of a free surface may be a function of.
    pub(super) const FORMS: [DepartureOver; 3] = [DepartureOver::Space, DepartureOver::Turned, DepartureOver::Extruded];

    /// Which of `tau omega size omega3` move the base where it is only what a departure is counted from: those that no departure takes up.
    pub(super) fn moving(self) -> &'static [usize] {
        match self {
            DepartureOver::Feet | DepartureOver::Section | DepartureOver::Space => &[],
            DepartureOver::Turned => &[0, 1, 3, 4],
            DepartureOver::Extruded => &[3, 4],
        }
    }

    /// Whether it is small beside the body, so that the base's feet are those of the surface.
    pub(super) fn is_small(self) -> bool {
        matches!(self, DepartureOver::Feet | DepartureOver::Section)
    }

    pub(super) fn symmetry(self) -> Symmetry {
        match self {
            DepartureOver::Feet | DepartureOver::Section | DepartureOver::Space => Symmetry::None,
            DepartureOver::Turned => Symmetry::Turned,
            DepartureOver::Extruded => Symmetry::Extruded,
        }
    }

    /// What the departure is a function of, at a place whose foot is given.
    pub(super) fn coordinates(self, base: &Primitive, place: Vector, foot: Vector) -> Vector {
        let section = |[x, y, z]: Vector| [x.hypot(y), z, 0.0];
        match self {
            DepartureOver::Feet => foot,
            DepartureOver::Section => section(base.own(foot)),
            DepartureOver::Space => place,
            DepartureOver::Turned => section(base.own(place)),
            DepartureOver::Extruded => {
                let [x, y, _] = base.own(place);
                [x, y, 0.0]
            }
        }
    }

    /// How they change along a direction.
    pub(super) fn along(self, base: &Primitive, place: Vector, direction: Vector) -> Vector {
        let own = || base.axes.map(|axis| dot(axis, direction));
        match self {
            DepartureOver::Feet | DepartureOver::Space => direction,
            DepartureOver::Section | DepartureOver::Turned => {
                let ([cos, sin], [x, y, z]) = (outwards(base.own(place)), own());
                [cos * x + sin * y, z, 0.0]
            }
            DepartureOver::Extruded => {
                let [x, y, _] = own();
                [x, y, 0.0]
            }
        }
    }
}

/// The direction away from the third axis, in the first two; any of them on it.
fn outwards([x, y, _]: Vector) -> [f64; 2] {
    let rho = x.hypot(y);
    if rho > 0.0 { [x / rho, y / rho] } else { [1.0, 0.0] }
}

impl DepartureOver {
    /// Places at which a carrier stands: of a turned body its mirror image too, which makes the departure smooth on the axis.
    pub(super) fn images(self, c: Vector) -> impl Iterator<Item = Vector> {
        let mirrored = (self == DepartureOver::Turned).then_some([-c[0], c[1], c[2]]);
        std::iter::once(c).chain(mirrored)
    }
}

/// A departure at one place.
pub(super) struct DepartureJet {
    pub(super) value: f64,
    pub(super) gradient: Vector,
    pub(super) hessian: [Vector; 3],
}

impl DepartureJet {
    /// A function of (rho, h) as one of a place about the third axis.
    pub(super) fn turned(self, own: Vector) -> DepartureJet {
        let [cos, sin] = outwards(own);
        let (rho, [by_rho, by_height, _]) = (own[0].hypot(own[1]), self.gradient);
        let [[twice, mixed, _], [_, upward, _], _] = self.hessian;
        // on the axis itself it bends alike in all directions
        let around = if rho > NEAR_AXIS { by_rho / rho } else { twice };
        let level = (twice - around) * cos * sin;
        let hessian = [
            [twice * cos * cos + around * sin * sin, level, mixed * cos],
            [level, twice * sin * sin + around * cos * cos, mixed * sin],
            [mixed * cos, mixed * sin, upward],
        ];
        DepartureJet { gradient: [by_rho * cos, by_rho * sin, by_height], hessian, ..self }
    }

    /// A function of (x, y) as one of a place: it is the same all along the third axis.
    pub(super) fn extruded(self) -> DepartureJet {
        let [[xx, xy, _], [yx, yy, _], _] = self.hessian;
        DepartureJet { hessian: [[xx, xy, 0.0], [yx, yy, 0.0], [0.0; 3]], ..self }
    }

    /// From a base's axes to those of the cloud.
    pub(super) fn out_of(self, base: &Primitive) -> DepartureJet {
        let rows = self.hessian.map(|row| base.out(row));
        let column = |i: usize| base.out([rows[0][i], rows[1][i], rows[2][i]]);
        DepartureJet { gradient: base.out(self.gradient), hessian: [column(0), column(1), column(2)], ..self }
    }

    /// The same as a function of the foot alone, which moves along a surface of this normal n and Hessian of distances: places beside each other
    /// have feet that fall behind the tangent.
    ///
    /// ```text
    /// grad f - n n' grad f        P hess f P - (n' grad f) hess d,   P = 1 - n n'
    /// ```
    pub(super) fn of_foot(self, normal: Vector, bends: [Vector; 3]) -> DepartureJet {
        let level = |v: Vector| along(v, -dot(v, normal), normal);
        let rows = self.hessian.map(level);
        let columns = [0, 1, 2].map(|j| level([rows[0][j], rows[1][j], rows[2][j]]));
        let away = dot(self.gradient, normal);
        let hessian = [0, 1, 2].map(|i| [0, 1, 2].map(|j| columns[j][i] - away * bends[i][j]));
        DepartureJet { gradient: level(self.gradient), hessian, ..self }
    }
}
