//! Bodies whose form is known but for a few numbers: quadrics and rings, as departures from the surface of two constant curvatures that
//! touches them.
//!
//! ```text
//! axes of the surface at its chart's origin: x, y along k1 and k2, w along the normal
//! quadric          w = (k1 x^2 + k2 y^2)/2 + w (p0 x + p1 y) + p2 w^2/2                          ellipsoids, hyperboloids, cones, paraboloids
//! ring along x     a circle of curvature k1 in the plane of x and w, turned about an axis in it    its parallels through the origin have
//!                  the normal curvature k2 and the geodesic curvature p0
//! ring along y     the same with x and y, k1 and k2 exchanged
//! f(u, v; p)       displacement along the surface's normal at which the body lies                  c(p) its spline coefficients
//! c(p) = c(q) + sum_i (p_i - q_i) dc/dp_i (q)                                                       p_i ~ N(0, (s_i R)^2)
//! ```
//!
//! Two constant curvatures are those of a ring at its equator. A ring that is touched elsewhere, and every quadric but the round ones,
//! departs from them, by forms that three numbers or one say, where a natural departure has nine. Where the contacts follow such a body, its
//! evidence is ahead and its interval as narrow as that of whoever knows the body; where they do not, it has no weight. General quadric:
//! nine numbers, six of which place and bend the surface that it departs from. G. Lukacs, R. Martin, D. Marshall, ECCV 1998, 671.

use faer::Mat;

use crate::dense;
use crate::recognition::kinds::ConstantCurvature;
use palpate_geometry::primitives::over_circle;
use palpate_numeric::bspline::Knots;
use palpate_numeric::vector::Vector;

use super::smooth::splines_through;

/// Numbers that say how a body departs; those that a body does not have are zero.
pub(crate) type Form = [f64; 3];

/// Forms of all bodies, in the order of [`Body::ALL`].
pub(crate) type Forms = [Form; Body::ALL.len()];

/// Which body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Body {
    Quadric,
    /// A ring whose generating circle runs along the first direction of the chart.
    TorusAlongU,
    /// A ring whose generating circle runs along the second.
    TorusAlongV,
}

/// Standard deviations of the numbers in units of R, which is what they have on bodies that are about as long as wide: an ellipsoid's
/// third is (a/c)^2 times its curvature at the end of the axis c.
const SPREAD: Form = [1.0, 1.0, 2.0];

/// Step of central differences, in units of the patch: their error is its square.
const STEP_OF_DIFFERENCES: f64 = 1e-4;

/// Steps until a place on the body is found, and how near it then is.
const STEPS: usize = 20;
const NEAR: f64 = 1e-11;

/// Largest displacement relative to the chart's box: a body farther away is none of the surface's neighbours.
const FARTHEST: f64 = 0.5;

/// Steps of Gauss and Newton to the nearest form, the change in units of R at which it is found, and a small weight of staying.
const ROUNDS: usize = 6;
const FOUND: f64 = 1e-3;
const UNTOLD: f64 = 1e-9;

impl Body {
    pub(crate) const ALL: [Body; 3] = [Body::Quadric, Body::TorusAlongU, Body::TorusAlongV];

    /// Number of the body in [`Body::ALL`].
    pub(crate) fn number(self) -> usize {
        self as usize
    }

    /// How many numbers say its form.
    pub(crate) fn numbers(self) -> usize {
        if self == Body::Quadric { 3 } else { 1 }
    }

    /// Zero on the body, and positive on its free side; to first order the distance where the body is level.
    fn side(self, [k1, k2]: [f64; 2], form: Form, [x, y, w]: Vector) -> f64 {
        match self {
            Body::Quadric => {
                w - 0.5 * (k1 * x * x + k2 * y * y) - w * (form[0] * x + form[1] * y) - 0.5 * form[2] * w * w
            }
            Body::TorusAlongU => ring([k1, k2], form[0], [x, y, w]),
            Body::TorusAlongV => ring([k2, k1], form[0], [y, x, w]),
        }
    }

    /// Displacement of the body above the surface at chart coordinates, and its derivatives by the numbers of the form, `-F_p / F_f` for the
    /// side F; `None` where it has none near by.
    fn displacement(
        self,
        surface: &ConstantCurvature,
        form: Form,
        [u, v]: [f64; 2],
        farthest: f64,
    ) -> Option<(f64, Form)> {
        let [_, _, _, k1, k2, _] = surface.theta;
        let at = |form: Form, f: f64| self.side([k1, k2], form, surface.form().point(u, v, f));
        let slope_at = |f: f64| {
            (at(form, f + STEP_OF_DIFFERENCES) - at(form, f - STEP_OF_DIFFERENCES)) / (2.0 * STEP_OF_DIFFERENCES)
        };
        let (mut f, mut step) = (0.0, f64::INFINITY);
        // one slope serves all steps: the side is nearly linear along the normal
        let slope = slope_at(f);
        for _ in 0..STEPS {
            step = at(form, f) / slope;
            f -= step;
            if step.abs() < NEAR {
                break;
            }
        }
        if f.is_nan() || f.abs() > farthest || step.abs() > NEAR {
            return None;
        }
        let slope = slope_at(f);
        let mut by = Form::default();
        for (number, by) in by[..self.numbers()].iter_mut().enumerate() {
            let (mut ahead, mut behind) = (form, form);
            ahead[number] += STEP_OF_DIFFERENCES;
            behind[number] -= STEP_OF_DIFFERENCES;
            *by = -(at(ahead, f) - at(behind, f)) / (2.0 * STEP_OF_DIFFERENCES * slope);
        }
        Some((f, by))
    }
}

/// Signed distance from a circle of curvature `k1` in the plane of x and w, turned about an axis in that plane such that the parallel
/// through the origin has the normal curvature `k2` and the geodesic curvature `geodesic`.
fn ring([k1, k2]: [f64; 2], geodesic: f64, [x, y, w]: Vector) -> f64 {
    let k = geodesic.hypot(k2);
    // towards the axis
    let [along_x, along_w] = if k > 0.0 { [geodesic / k, k2 / k] } else { [0.0, 1.0] };
    let (inwards, beside) = (along_x * x + along_w * w, along_w * x - along_x * w);
    // turned back into the plane, without a division by k
    let (turned, _) = over_circle(k, y, inwards, f64::hypot);
    let (x, w) = (along_x * turned + along_w * beside, along_w * turned - along_x * beside);
    over_circle(k1, x, w, f64::hypot).0
}

/// Standard deviation of one of a body's numbers on such a surface.
pub(crate) fn spread(surface: &ConstantCurvature, number: usize) -> f64 {
    let [_, _, _, k1, k2, _] = surface.theta;
    SPREAD[number] * (0.5 * (k1 * k1 + k2 * k2)).sqrt()
}

/// Farthest displacement that counts.
pub(super) fn farthest(knots: &[Knots; 2]) -> f64 {
    let widths = knots.each_ref().map(Knots::domain).map(|[lo, hi]| hi - lo);
    FARTHEST * widths[0].min(widths[1])
}

/// Spline coefficients of a body's displacements, to first order about a form of it: first where all numbers are zero, then what every number
/// adds, in units of its standard deviation. `None` where the body does not lie near the surface.
pub(super) fn columns(knots: &[Knots; 2], surface: &ConstantCurvature, body: Body, form: Form) -> Option<Mat<f64>> {
    let [us, vs] = knots.each_ref().map(Knots::greville);
    let farthest = farthest(knots);
    let mut values = vec![Mat::<f64>::zeros(us.len(), vs.len()); 1 + body.numbers()];
    for (i, u) in us.iter().enumerate() {
        for (j, v) in vs.iter().enumerate() {
            let (mut f, by) = body.displacement(surface, form, [*u, *v], farthest)?;
            for number in 0..body.numbers() {
                values[1 + number][(i, j)] = spread(surface, number) * by[number];
                f -= form[number] * by[number];
            }
            values[0][(i, j)] = f;
        }
    }
    splines_through(knots, &values)
}

/// The form in which a body is nearest to a displaced surface, but for what the surface's own parameters hold: least squares by steps of
/// Gauss and Newton at some places. `None` where it is not near there.
pub(super) fn nearest_form(
    surface: &ConstantCurvature,
    body: Body,
    start: Form,
    places: &[([f64; 2], f64)],
    farthest: f64,
) -> Option<Form> {
    let count = body.numbers();
    let of_surface = |[u, v]: [f64; 2]| [1.0, u, v, 0.5 * u * u, u * v, 0.5 * v * v];
    let unknowns = count + 6;
    let mut form = start;
    for _ in 0..ROUNDS {
        let mut normal = Mat::<f64>::zeros(unknowns, unknowns);
        let mut right = vec![0.0; unknowns];
        for (place, wanted) in places {
            let (f, by) = body.displacement(surface, form, *place, farthest)?;
            let mut row = by[..count].to_vec();
            row.extend(of_surface(*place));
            let left = wanted - f;
            for i in 0..unknowns {
                right[i] += row[i] * left;
                (0..unknowns).for_each(|j| normal[(i, j)] += row[i] * row[j]);
            }
        }
        // a number that the places do not tell stays where it is
        (0..count).for_each(|i| normal[(i, i)] += UNTOLD / spread(surface, i).powi(2));
        dense::solve(&dense::cholesky(&normal)?, &mut right);
        (0..count).for_each(|number| form[number] += right[number]);
        if right[..count].iter().enumerate().all(|(i, step)| step.abs() < FOUND * spread(surface, i)) {
            break;
        }
    }
    Some(form)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::discrepancy::basis::JetRow;

    fn places() -> impl Iterator<Item = [f64; 2]> {
        (0..30).map(|i| [0.8 * (1.3 * i as f64).sin(), 0.8 * (2.1 * i as f64).cos()])
    }

    #[test]
    fn a_ring_that_is_touched_beside_its_equator_has_its_exact_distance() {
        let (tube, radius, latitude) = (1.5_f64, 4.0_f64, 0.6_f64);
        let (sin, cos) = latitude.sin_cos();
        // of the parallel through the place that is touched, on the outer side: both bend away from the normal
        let parallel = radius + tube * cos;
        let (k1, k2, geodesic) = (-1.0 / tube, -cos / parallel, sin / parallel);
        for [x, y] in places() {
            let w = 0.1 * (3.0 * x).sin() - 0.2;
            // the axis through the origin, z along it
            let across = parallel + w * cos - x * sin;
            let z = tube * sin + w * sin + x * cos;
            let expected = (across.hypot(y) - radius).hypot(z) - tube;
            assert!((ring([k1, k2], geodesic, [x, y, w]) - expected).abs() < 1e-13, "{x} {y}");
            assert!((Body::TorusAlongV.side([k2, k1], [geodesic, 0.0, 0.0], [y, x, w]) - expected).abs() < 1e-13);
        }
    }

    #[test]
    fn without_numbers_rings_are_the_surface_itself_and_a_quadric_with_the_curvature_of_a_ball_is_the_ball() {
        let surface = ConstantCurvature::new([0.1, 0.05, -0.1, 0.5, -0.2, 0.7]);
        for body in [Body::TorusAlongU, Body::TorusAlongV] {
            for place in places().filter(|_| body == Body::TorusAlongU) {
                assert!(body.displacement(&surface, Form::default(), place, 1.0).unwrap().0.abs() < 1e-12);
            }
        }
        let ball = ConstantCurvature::new([0.0, 0.1, 0.0, 0.4, 0.4, 0.0]);
        for place in places() {
            assert!(Body::Quadric.displacement(&ball, [0.0, 0.0, 0.4], place, 1.0).unwrap().0.abs() < 1e-12);
        }
    }

    #[test]
    fn an_ellipsoid_lies_where_its_displacement_says() {
        let [a, b, c] = [3.0_f64, 2.5, 2.0];
        let surface = ConstantCurvature::new([0.0, 0.0, 0.0, -c / (a * a), -c / (b * b), 0.0]);
        for [u, v] in places() {
            let f = Body::Quadric.displacement(&surface, [0.0, 0.0, -1.0 / c], [u, v], 1.0).unwrap().0;
            let [x, y, w] = surface.form().point(u, v, f);
            assert!(((x / a).powi(2) + (y / b).powi(2) + ((w + c) / c).powi(2) - 1.0).abs() < 1e-10);
        }
    }

    #[test]
    fn columns_are_the_body_to_first_order_and_its_form_is_found_again() {
        let surface = ConstantCurvature::new([0.0, 0.0, 0.0, -0.5, -0.2, 0.0]);
        let knots = [(); 2].map(|_| Knots::uniform(4, 5, -1.0, 1.0).unwrap());
        for (body, form) in [(Body::Quadric, [0.1, -0.2, -0.6]), (Body::TorusAlongU, [0.2, 0.0, 0.0])] {
            let columns = columns(&knots, &surface, body, form).unwrap();
            assert_eq!(columns.ncols(), 1 + body.numbers());
            let mut beside = form;
            beside[0] += 0.01;
            for (form, near) in [(form, 1e-5), (beside, 2e-5)] {
                let weight = |j: usize| if j == 0 { 1.0 } else { form[j - 1] / spread(&surface, j - 1) };
                let splines: Vec<f64> = (0..columns.nrows())
                    .map(|i| (0..columns.ncols()).map(|j| weight(j) * columns[(i, j)]).sum())
                    .collect();
                for place in places() {
                    let f = body.displacement(&surface, form, place, 1.0).unwrap().0;
                    let found = JetRow::new(&knots, place).jet(&splines)[0];
                    assert!((found - f).abs() < near, "{body:?} {place:?}: {found} {f}");
                }
            }
            let seen: Vec<([f64; 2], f64)> =
                places().map(|place| (place, body.displacement(&surface, form, place, 1.0).unwrap().0)).collect();
            let found = nearest_form(&surface, body, Form::default(), &seen, 1.0).unwrap();
            (0..3).for_each(|i| assert!((found[i] - form[i]).abs() < 1e-5, "{body:?} {found:?}"));
        }
    }
}
