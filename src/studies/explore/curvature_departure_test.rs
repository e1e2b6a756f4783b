//! Does the surface that was recognised depart from constant curvature in the lowest orders, and what would that do to S and R?
//!
//! ```text
//! residuals        d / s_z,  -(n . e1) / s_n,  -(n . e2) / s_n          e1, e2: tangents along u and v
//! explained by     f / s_z,   f_u / s_n,        f_v / s_n               f = sum c u^i v^j (i + j <= 3) + c (u^2 + v^2)^2
//! F = (explained by the cubic terms and the last, beyond those below, per term) / (left over, per row)
//! change           mean S and R under the second derivatives with those of f, less those without
//! ```
//!
//! A bump is no ball because its curvatures change from place to place: to one side, which the four cubic terms see, or from
//! the middle outwards, which the last one sees. Five terms see what the 25 unknowns of a spline (`richer_spline_test.rs`) spread over
//! all of them. A departure may be certain and yet leave S and R as they are: a paraboloid's patch, tilted, is one.

use palpate_geometry::contact::Contacts;
use palpate_geometry::curvature::{curvedness, shape_index};
use palpate_geometry::shape::f_upper_tail;
use palpate_inference::recognition::Recognition;
use palpate_numeric::solve::PivotedQr;
use palpate_numeric::vector::{Vector, dot, minus, reject, unit};

/// One term of f.
#[derive(Clone, Copy)]
enum Term {
    /// `u^i v^j`.
    Powers([i32; 2]),
    /// `(u^2 + v^2)^2`.
    Outwards,
}

/// The terms that a recognised surface has, then those that it has not.
const KNOWN: usize = 6;
const TERMS: [Term; 11] = [
    Term::Powers([0, 0]),
    Term::Powers([1, 0]),
    Term::Powers([0, 1]),
    Term::Powers([2, 0]),
    Term::Powers([1, 1]),
    Term::Powers([0, 2]),
    Term::Powers([3, 0]),
    Term::Powers([2, 1]),
    Term::Powers([1, 2]),
    Term::Powers([0, 3]),
    Term::Outwards,
];

/// Rows that must be left over: with fewer the test overlooks what it is there for.
const LEFT_OVER: usize = 15;

/// Step over which the surface is differentiated, in units of the patch: errors of 1e-8 in tangents and of 1e-4 in curvatures.
const STEP_OF_DIFFERENCES: f64 = 1e-4;

/// A departure: how sure it is, and what it would do to the answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Departure {
    /// Probability of so large an F, or a larger one, if the recognised surface were all there is.
    pub(super) p: f64,
    /// By how much mean S would change.
    pub(super) shape_index: f64,
    /// By how much mean R would.
    pub(super) curvedness: f64,
}

/// The departure that explains the contacts best; `None` where they are too few to ask.
pub(super) fn departure(contacts: &Contacts, found: &Recognition) -> Option<Departure> {
    let rows = rows(contacts, found)?;
    let [known, all] = [&TERMS[..KNOWN], &TERMS[..]].map(|terms| Explained::by(terms, &rows));
    let (known, all) = (known?, all?);
    let more = all.rank.checked_sub(known.rank).filter(|more| *more > 0)? as f64;
    let left = rows.len().checked_sub(all.rank).filter(|left| *left >= LEFT_OVER)? as f64;
    let ratio = (known.left_over - all.left_over).max(0.0) / more / (all.left_over / left);
    let [shape_index, curvedness] = change(found, &all.coefficients)?;
    Some(Departure { p: f_upper_tail(ratio, more, left), shape_index, curvedness })
}

/// A measured number: what is left of it, where it was measured, and which derivative of f it sees.
struct Row {
    residual: f64,
    chart: [f64; 2],
    sd: f64,
    sees: Sees,
}

#[derive(Clone, Copy)]
enum Sees {
    Height,
    AlongU,
    AlongV,
}

impl Term {
    /// The value and the derivatives along u and v.
    fn first(self, [u, v]: [f64; 2]) -> [f64; 3] {
        match self {
            Term::Powers([i, j]) => [power(u, i) * power(v, j), slope(u, i) * power(v, j), power(u, i) * slope(v, j)],
            Term::Outwards => {
                let square = u * u + v * v;
                [square * square, 4.0 * square * u, 4.0 * square * v]
            }
        }
    }

    /// The derivatives by uu, uv and vv.
    fn second(self, [u, v]: [f64; 2]) -> [f64; 3] {
        let bend = |x: f64, k: i32| if k < 2 { 0.0 } else { f64::from(k * (k - 1)) * power(x, k - 2) };
        match self {
            Term::Powers([i, j]) => [bend(u, i) * power(v, j), slope(u, i) * slope(v, j), power(u, i) * bend(v, j)],
            Term::Outwards => [12.0 * u * u + 4.0 * v * v, 8.0 * u * v, 4.0 * u * u + 12.0 * v * v],
        }
    }
}

fn power(x: f64, k: i32) -> f64 {
    x.powi(k)
}

fn slope(x: f64, k: i32) -> f64 {
    if k == 0 { 0.0 } else { f64::from(k) * power(x, k - 1) }
}

impl Row {
    /// The column of a term in this row.
    fn of(&self, term: Term) -> f64 {
        let [height, along_u, along_v] = term.first(self.chart);
        let seen = match self.sees {
            Sees::Height => height,
            Sees::AlongU => along_u,
            Sees::AlongV => along_v,
        };
        seen / self.sd
    }
}

/// All rows, lengths in units of the patch.
fn rows(contacts: &Contacts, found: &Recognition) -> Option<Vec<Row>> {
    let scale = found.frame.scale;
    let sd_z = found.noise.sd_z / scale;
    let sd_normal = found.noise.sd_normal_deg.map(f64::to_radians);
    let mut rows = Vec::with_capacity(3 * contacts.len());
    for r in 0..contacts.len() {
        let place = [contacts.x[r], contacts.y[r], contacts.z[r]];
        let chart = found.surface.chart_of(place);
        let residual = found.surface.distance(place) / scale / sd_z;
        rows.push(Row { residual, chart, sd: sd_z, sees: Sees::Height });
        let (Some(sd), Some(felt)) = (sd_normal, contacts.unit_normal(r)) else { continue };
        for (tangent, sees) in tangents(found, chart).into_iter().zip([Sees::AlongU, Sees::AlongV]) {
            rows.push(Row { residual: -dot(felt, tangent) / sd, chart, sd, sees });
        }
    }
    rows.iter().all(|row| row.residual.is_finite()).then_some(rows)
}

/// Unit tangents along u and v.
fn tangents(found: &Recognition, [u, v]: [f64; 2]) -> [Vector; 2] {
    let (here, up) = found.surface.at(u, v);
    [[u + STEP_OF_DIFFERENCES, v], [u, v + STEP_OF_DIFFERENCES]]
        .map(|[u, v]| unit(reject(minus(found.surface.at(u, v).0, here), up)))
}

/// By how much mean S and mean R change when the surface is displaced by f along its normal.
fn change(found: &Recognition, coefficients: &[f64]) -> Option<[f64; 2]> {
    let scale = found.frame.scale;
    let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
    for (place, _) in &found.averaged {
        let chart = found.surface.chart_of(*place);
        let bent = second_derivatives(found, chart);
        let mut displaced = bent.map(|b| scale * b);
        for (term, c) in TERMS.iter().zip(coefficients) {
            displaced.iter_mut().zip(term.second(chart)).for_each(|(d, second)| *d += c * second);
        }
        let ((s, r), (moved_s, moved_r)) = (shape_of(bent), shape_of(displaced.map(|d| d / scale)));
        if let (Some(s), Some(moved_s)) = (s, moved_s) {
            (sums[0], counts[0]) = (sums[0] + moved_s - s, counts[0] + 1.0);
        }
        (sums[1], counts[1]) = (sums[1] + moved_r - r, counts[1] + 1.0);
    }
    let mean = [0, 1].map(|k| if counts[k] > 0.0 { sums[k] / counts[k] } else { 0.0 });
    mean.iter().all(|m| m.is_finite()).then_some(mean)
}

/// The surface over its tangent plane, by uu, uv and vv: what the normal turns away, over the arc length. Input units.
fn second_derivatives(found: &Recognition, [u, v]: [f64; 2]) -> [f64; 3] {
    let [e1, e2] = tangents(found, [u, v]);
    let ahead = [found.surface.at(u + STEP_OF_DIFFERENCES, v).1, found.surface.at(u, v + STEP_OF_DIFFERENCES).1];
    let behind = [found.surface.at(u - STEP_OF_DIFFERENCES, v).1, found.surface.at(u, v - STEP_OF_DIFFERENCES).1];
    let [by_u, by_v] = [0, 1].map(|k| minus(behind[k], ahead[k]));
    let bent = [dot(by_u, e1), 0.5 * (dot(by_u, e2) + dot(by_v, e1)), dot(by_v, e2)];
    bent.map(|b| b / (2.0 * STEP_OF_DIFFERENCES * found.frame.scale))
}

/// S and R of the second derivatives by uu, uv and vv.
fn shape_of([uu, uv, vv]: [f64; 3]) -> (Option<f64>, f64) {
    let (sum, difference) = (uu + vv, 2.0 * (0.5 * (uu - vv)).hypot(uv));
    (shape_index(sum, difference), curvedness(0.5 * (sum + difference), 0.5 * (sum - difference)))
}

/// What some terms explain of the residuals, by least squares.
struct Explained {
    coefficients: Vec<f64>,
    /// Terms that the contacts tell apart.
    rank: usize,
    /// Sum of squares that is not explained.
    left_over: f64,
}

impl Explained {
    /// `None` where a number is not finite.
    fn by(terms: &[Term], rows: &[Row]) -> Option<Explained> {
        let columns: Vec<f64> = terms.iter().flat_map(|term| rows.iter().map(|row| row.of(*term))).collect();
        let mut residuals: Vec<f64> = rows.iter().map(|row| row.residual).collect();
        let factor = PivotedQr::of_dense(rows.len(), terms.len(), &columns, &residuals).ok()?;
        let coefficients = factor.coefficients();
        for (column, c) in columns.chunks_exact(rows.len().max(1)).zip(&coefficients) {
            residuals.iter_mut().zip(column).for_each(|(left, value)| *left -= c * value);
        }
        let left_over = residuals.iter().map(|left| left * left).sum();
        Some(Explained { coefficients, rank: factor.rank(), left_over })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_terms_are_those_of_finite_differences() {
        const H: f64 = 1e-4;
        let [u, v] = [0.7, -0.4];
        for term in TERMS {
            let [_, by_u, by_v] = term.first([u, v]);
            let along = |k: usize, du: f64, dv: f64| {
                (term.first([u + du, v + dv])[k] - term.first([u - du, v - dv])[k]) / (2.0 * H)
            };
            let found = [by_u, by_v, term.second([u, v])[0], term.second([u, v])[1], term.second([u, v])[2]];
            let differences =
                [along(0, H, 0.0), along(0, 0.0, H), along(1, H, 0.0), along(1, 0.0, H), along(2, 0.0, H)];
            for (found, difference) in found.iter().zip(differences) {
                assert!((found - difference).abs() < 1e-6, "{found} {difference}");
            }
        }
    }

    #[test]
    fn coefficients_that_made_the_rows_are_found_again() {
        let made: [f64; TERMS.len()] = std::array::from_fn(|k| (k as f64 - 4.0) / 7.0);
        let places = (0..9).map(|k| [f64::from(k % 3) - 0.9, f64::from(k / 3) - 1.2]);
        let mut rows: Vec<Row> = places
            .flat_map(|chart| {
                [Sees::Height, Sees::AlongU, Sees::AlongV].map(|sees| Row { residual: 0.0, chart, sd: 0.3, sees })
            })
            .collect();
        for row in &mut rows {
            row.residual = TERMS.iter().zip(made).map(|(term, c)| c * row.of(*term)).sum();
        }
        let fit = Explained::by(&TERMS, &rows).unwrap();
        let whole: f64 = rows.iter().map(|row| row.residual * row.residual).sum();
        assert!(fit.rank == TERMS.len() && fit.left_over < 1e-20 * whole, "{} {}", fit.rank, fit.left_over);
        assert!(fit.coefficients.iter().zip(made).all(|(a, b)| (a - b).abs() < 1e-9), "{:?}", fit.coefficients);
    }

    /// The sides of a sphere's second derivatives: a cap of radius 2 has S = 1 and R = 1/2.
    #[test]
    fn a_cap_is_a_cap() {
        let (s, r) = shape_of([-0.5, 0.0, -0.5]);
        assert!(s.is_some_and(|s| (s - 1.0).abs() < 1e-15) && (r - 0.5).abs() < 1e-15, "{s:?} {r}");
    }
}
