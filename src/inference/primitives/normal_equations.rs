//! Normal equations of a primitive over weighted contacts, the loop in which a cut into parts spends most of its time.
//!
//! ```text
//! A = sum_i w_i a_i a_i'        g = sum_i w_i a_i r_i        sum = sum_i w_i r_i^2        4 rows a_i and residuals r_i a contact
//! by tau    -g                            -s H                                          g = grad d, H its Hessian, s the free side
//! by omega  -(q x g) e_j                  -s H (e_j x q) + e_j x m                      m = n_i in the primitive's axes
//! by sizes  d by_size                     s g by_size
//! ```
//!
//! The form and its unknowns are known where the loop is compiled, so that a row has no more entries than these, and what a primitive has
//! once (a cone's sine) is taken once.

use super::placed::{MOST_UNKNOWNS, PartKind, Primitive, free};
use palpate_geometry::primitives::{
    self as forms, Cone, Cylinder, DistanceJet, Plane, Sphere, Torus, TriaxialEllipsoid,
};
use palpate_numeric::linalg::GramOfRows;
use palpate_numeric::linalg::small::Square;
use palpate_numeric::simd::Isa;
use palpate_numeric::vector::{Vector, dot};

/// A contact with one over the variances of its distance and of its normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WeightedContact {
    pub(crate) point: Vector,
    pub(crate) normal: Option<Vector>,
    pub(crate) weights: [f64; 2],
}

/// Which way a measured normal is taken, beside the one that the primitive has there.
pub(crate) type Facing = fn(Vector, Vector) -> Vector;

/// Normal matrix, gradient and weighted sum of squares, by all unknowns; ones on the diagonal of those that are not free.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NormalEquations {
    pub(crate) matrix: Square<MOST_UNKNOWNS>,
    pub(crate) gradient: [f64; MOST_UNKNOWNS],
    pub(crate) sum: f64,
}

impl NormalEquations {
    /// Of all contacts at a primitive.
    pub(crate) fn new(
        primitive: &Primitive,
        facing: Facing,
        contacts: impl Iterator<Item = WeightedContact>,
    ) -> NormalEquations {
        let [one, two, _] = primitive.sizes;
        match primitive.kind {
            PartKind::Patch => over(&Plane, [], (primitive, facing), contacts),
            PartKind::Plane => over(&Plane, free::PLANE, (primitive, facing), contacts),
            PartKind::Sphere => over(&Sphere { radius: one }, free::SPHERE, (primitive, facing), contacts),
            PartKind::Cylinder => over(&Cylinder { radius: one }, free::CYLINDER, (primitive, facing), contacts),
            PartKind::Cone => over(&Cone { radius: one, half_angle: two }, free::CONE, (primitive, facing), contacts),
            PartKind::Torus => over(&Torus { ring: one, tube: two }, free::TORUS, (primitive, facing), contacts),
            PartKind::Ellipsoid => {
                let form = TriaxialEllipsoid { half_axes: primitive.sizes };
                over(&form, free::ELLIPSOID, (primitive, facing), contacts)
            }
        }
    }
}

/// The same of one form with its unknowns.
#[inline(always)]
fn over<const N: usize>(
    form: &impl forms::Primitive,
    unknowns: [usize; N],
    (primitive, facing): (&Primitive, Facing),
    contacts: impl Iterator<Item = WeightedContact>,
) -> NormalEquations {
    // of a few contacts, which are not worth the wider registers
    let mut gram = GramOfRows::new(Isa::for_work(0), N + 1);
    for WeightedContact { point, normal, weights } in contacts {
        let q = primitive.own(point);
        let jet = form.jet(q);
        let outwards = jet.gradient.map(|g| primitive.side * g);
        let given = normal.map_or(outwards, |n| facing(primitive.axes.map(|axis| dot(axis, n)), outwards));
        let rows = ContactRows { jet: &jet, side: primitive.side, q, given };
        // a loop and not `map`, which is a call for every unknown
        let mut columns = [[0.0; ROWS]; N];
        for k in 0..N {
            columns[k] = rows.column(unknowns[k]);
        }
        let told = if normal.is_some() { ROWS } else { 1 };
        add(&mut gram, rows.residuals(outwards), &columns, weights, told);
    }
    spread(gram, unknowns)
}

/// A residual and its derivatives by all unknowns.
pub(crate) type PrimitiveRow = (f64, [f64; MOST_UNKNOWNS]);

/// The rows of one point: the distance's first, then the normal's three.
pub(crate) fn rows(primitive: &Primitive, p: Vector, n: Vector) -> [PrimitiveRow; ROWS] {
    let q = primitive.own(p);
    let jet = primitive.at(q);
    let given = primitive.axes.map(|axis| dot(axis, n));
    let of = ContactRows { jet: &jet, side: primitive.side, q, given };
    let residuals = of.residuals(jet.gradient.map(|g| primitive.side * g));
    let columns: [Lanes; MOST_UNKNOWNS] = std::array::from_fn(|unknown| of.column(unknown));
    std::array::from_fn(|row| (residuals[row], columns.map(|column| column[row])))
}

/// Rows of a contact: of its distance, and of the three components of its normal.
const ROWS: usize = 4;

/// A number for each of them.
type Lanes = [f64; ROWS];

/// What the rows of a contact are made from, in the primitive's own axes.
struct ContactRows<'a> {
    jet: &'a DistanceJet,
    side: f64,
    q: Vector,
    given: Vector,
}

impl ContactRows<'_> {
    #[inline(always)]
    fn residuals(&self, outwards: Vector) -> Lanes {
        let m = self.given;
        [self.jet.distance, outwards[0] - m[0], outwards[1] - m[1], outwards[2] - m[2]]
    }

    /// Derivatives by one unknown, in the order of [`PartKind::free`].
    #[inline(always)]
    fn column(&self, unknown: usize) -> Lanes {
        match unknown {
            0..=2 => self.by_place(unknown),
            3 | 4 => self.by_turn(unknown - 3),
            8 => self.by_turn(2),
            _ => self.by_size(unknown - 5),
        }
    }

    #[inline(always)]
    fn by_place(&self, k: usize) -> Lanes {
        let (g, h, s) = (self.jet.gradient, &self.jet.hessian, self.side);
        [-g[k], -s * h[0][k], -s * h[1][k], -s * h[2][k]]
    }

    #[inline(always)]
    fn by_turn(&self, axis: usize) -> Lanes {
        let (h, s) = (&self.jet.hessian, self.side);
        let (of_place, of_given) = (turned(axis, self.q), turned(axis, self.given));
        let of_normal = |k: usize| of_given[k] - s * dot(h[k], of_place);
        [-dot(self.jet.gradient, of_place), of_normal(0), of_normal(1), of_normal(2)]
    }

    #[inline(always)]
    fn by_size(&self, k: usize) -> Lanes {
        let (jet, s) = (self.jet, self.side);
        let by = jet.gradient_by_size[k];
        [jet.by_size[k], s * by[0], s * by[1], s * by[2]]
    }
}

/// `e x v` of a coordinate axis e.
#[inline(always)]
fn turned(axis: usize, v: Vector) -> Vector {
    match axis {
        0 => [0.0, -v[2], v[1]],
        1 => [v[2], 0.0, -v[0]],
        _ => [-v[1], v[0], 0.0],
    }
}

/// Adds the first rows of a contact, its distance's and then its normal's, each with its residual behind the unknowns.
#[inline(always)]
fn add<const N: usize>(gram: &mut GramOfRows, residuals: Lanes, columns: &[Lanes; N], weights: [f64; 2], told: usize) {
    let [of_distance, of_normal] = weights.map(f64::sqrt);
    for (r, by) in [of_distance, of_normal, of_normal, of_normal].into_iter().enumerate().take(told) {
        let row = &mut gram.next_row()[..=N];
        for k in 0..N {
            row[k] = by * columns[k][r];
        }
        row[N] = by * residuals[r];
    }
}

/// By all unknowns.
fn spread<const N: usize>(mut gram: GramOfRows, unknowns: [usize; N]) -> NormalEquations {
    gram.finish();
    let (mut matrix, mut gradient) = ([[0.0; MOST_UNKNOWNS]; MOST_UNKNOWNS], [0.0; MOST_UNKNOWNS]);
    (0..MOST_UNKNOWNS).for_each(|k| matrix[k][k] = 1.0);
    for i in 0..N {
        gradient[unknowns[i]] = gram.at(N, i);
        for j in 0..=i {
            matrix[unknowns[i]][unknowns[j]] = gram.at(i, j);
            matrix[unknowns[j]][unknowns[i]] = gram.at(i, j);
        }
    }
    NormalEquations { matrix, gradient, sum: gram.at(N, N) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::vector::{axes_along, unit};

    /// The sums of rows over all unknowns that are free, one after another.
    #[test]
    fn sums_are_those_of_the_rows() {
        let place = |k: u32| [0.371, 0.617, 0.833].map(|step| 6.0 * ((f64::from(k) * step).fract() - 0.5));
        let contact = |k: u32| WeightedContact {
            point: place(k),
            normal: (!k.is_multiple_of(3)).then(|| unit(place(k + 7))),
            weights: [1.0 + f64::from(k % 5), 0.3],
        };
        for kind in PartKind::BODIES {
            let sizes = if kind == PartKind::Cone { [2.0, 0.4, 0.0] } else { [3.0, 1.8, 1.5] };
            let (origin, axes) = ([0.3, -0.2, 0.5], axes_along(unit([1.0, 2.0, -0.5])));
            let primitive = Primitive { kind, origin, axes, sizes, side: -1.0 };
            let found = NormalEquations::new(&primitive, |given, _| given, (0..30).map(contact));
            let (mut matrix, mut gradient, mut sum) =
                ([[0.0; MOST_UNKNOWNS]; MOST_UNKNOWNS], [0.0; MOST_UNKNOWNS], 0.0);
            for WeightedContact { point, normal, weights } in (0..30).map(contact) {
                let all = rows(&primitive, point, normal.unwrap_or_default());
                let told = if normal.is_some() { &all[..] } else { &all[..1] };
                for (number, (residual, row)) in told.iter().enumerate() {
                    let weight = weights[usize::from(number > 0)];
                    sum += weight * residual * residual;
                    for &i in kind.free() {
                        gradient[i] += weight * row[i] * residual;
                        kind.free().iter().for_each(|&j| matrix[i][j] += weight * row[i] * row[j]);
                    }
                }
            }
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * (1.0 + b.abs());
            assert!(near(found.sum, sum), "{kind:?}");
            for i in 0..MOST_UNKNOWNS {
                let is_free = kind.free().contains(&i);
                assert!(near(found.gradient[i], gradient[i]), "{kind:?}, {i}");
                for j in 0..MOST_UNKNOWNS {
                    let expected = if i == j && !is_free { 1.0 } else { matrix[i][j] };
                    assert!(near(found.matrix[i][j], expected), "{kind:?}, {i}, {j}");
                }
            }
        }
    }
}
