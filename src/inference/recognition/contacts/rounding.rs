//! What the rounding of written numbers adds to the errors of contacts, as a floor of every scale and variance.
//!
//! ```text
//! s^2 = q^2/12 along the patch's normal         copies: contacts that share one rounding         floor = s^2 (1 + 3 (copies - 1))
//! ```
//!
//! Contacts that were rounded alike err alike, and no scatter of theirs tells it. The few heights of a bar on an even grid are no sample of
//! roundings: each may be off by half a step, whose square is 3 s^2. Numbers that lie exactly on a plane or on a height quadric were
//! not rounded, however round they are.

use palpate_geometry::contact::{Frame, Rounding};
use palpate_numeric::vector::{Vector, minus, scaled};

use super::height_polynomial::left_by_polynomial;

/// Different heights that a plane, and a quadric, need to leave something of.
const FEWEST_HEIGHTS: [usize; 2] = [4, 7];
/// Floors below this, in units of the patch, are below what the arithmetic holds.
const ARITHMETIC: f64 = 1e-13;
/// Fits one after the other, until numbers that lie on a polynomial leave rounding alone.
const ROUNDS: usize = 3;

/// Floors of the errors, in units of the patch and in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Floors {
    /// Of a contact's distance from the surface.
    pub(crate) position: f64,
    /// Of a normal, for either tangential part.
    pub(crate) normal: f64,
    /// Contacts, and normals, that share one rounding.
    copies: [f64; 2],
    /// Contacts, and normals, of which an error is the mean.
    averaged: [f64; 2],
}

impl Default for Floors {
    fn default() -> Floors {
        Floors { position: 0.0, normal: 0.0, copies: [1.0; 2], averaged: [1.0; 2] }
    }
}

impl Floors {
    /// Of rounded contacts, their normals in this frame; none where the contacts are exact.
    pub(crate) fn new(rounding: &Rounding, points: &[Vector], normals: Option<&[Vector]>, frame: &Frame) -> Floors {
        let up = frame.axes[2];
        let square: f64 = (0..3).map(|k| (up[k] * rounding.position[k]).powi(2)).sum();
        let kept = |floor: f64| if floor > ARITHMETIC { floor } else { 0.0 };
        let (position, normal) = (kept(square.sqrt() / frame.scale), kept(rounding.normal));
        if position == 0.0 && normal == 0.0 {
            return Floors::default();
        }
        let local: Vec<Vector> = points.iter().map(|p| scaled(frame.scale.recip(), minus(*p, frame.origin))).collect();
        let own: Vec<Vector> = points.iter().map(|p| frame.to_patch(*p)).collect();
        if position > 0.0 && [&local, &own].iter().any(|points| is_exact(points, position)) {
            return Floors::default();
        }
        let slopes_are_exact = position == 0.0
            && normals.is_some_and(|normals| {
                (0..2).all(|k| {
                    let of = |(p, n): (&Vector, &Vector)| [p[0], p[1], n[k] / n[2]];
                    let slopes: Vec<Vector> = own.iter().zip(normals).map(of).collect();
                    is_exact(&slopes, normal)
                })
            });
        let normal = if slopes_are_exact { 0.0 } else { normal };
        Floors { position, normal, copies: rounding.copies, ..Floors::default() }
    }

    /// The same for means over so many contacts and normals.
    pub(crate) fn of_means(self, contacts: f64, normals: f64) -> Floors {
        Floors { averaged: [contacts, normals], ..self }
    }

    /// Least variance of an error of place.
    pub(crate) fn of_positions(&self) -> f64 {
        self.position * self.position / self.averaged[0] * Rounding::of_copies(self.copies[0])
    }

    /// Least variance of an error of a normal.
    pub(crate) fn of_normals(&self) -> f64 {
        self.normal * self.normal / self.averaged[1] * Rounding::of_copies(self.copies[1])
    }
}

/// Whether points lie on a plane or on a height quadric to far less than their rounding, and would not without reason.
fn is_exact(points: &[Vector], rounding: f64) -> bool {
    let mut heights: Vec<f64> = points.iter().map(|p| p[2]).collect();
    heights.sort_unstable_by(f64::total_cmp);
    let different = heights.chunk_by(|a, b| b - a < 0.5 * rounding).count();
    let limit = (Rounding::EXACT * rounding).max(ARITHMETIC);
    [(3, FEWEST_HEIGHTS[0]), (6, FEWEST_HEIGHTS[1])].into_iter().any(|(terms, fewest)| {
        // a plane along its own axes has one height
        let has_rest = different >= fewest || (different == 1 && points.len() >= fewest);
        has_rest && left_of(points, terms) < limit
    })
}

/// The largest residual of a polynomial with so many terms; fitted again and again, which takes out what the ridge has left.
fn left_of(points: &[Vector], terms: usize) -> f64 {
    let left = left_by_polynomial(points, terms, ROUNDS);
    left.map_or(f64::INFINITY, |left| left.iter().fold(0.0, |most, d| most.max(d.abs())))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_OF_HEIGHTS: f64 = 1e-3;

    fn lattice(z: impl Fn(f64, f64) -> f64) -> Vec<Vector> {
        let places = (0..49).map(|r| [f64::from(r % 7) / 3.0 - 1.0, f64::from(r / 7) / 3.0 - 1.0]);
        places.map(|[x, y]| [x, y, (z(x, y) / STEP_OF_HEIGHTS).round() * STEP_OF_HEIGHTS]).collect()
    }

    fn floors(points: &[Vector]) -> Floors {
        let sd = STEP_OF_HEIGHTS / 12.0_f64.sqrt();
        Floors::new(&Rounding { position: [sd; 3], normal: 0.0, copies: [7.0, 1.0] }, points, None, &Frame::IDENTITY)
    }

    #[test]
    fn bodies_are_rounded_and_round_quadrics_are_not() {
        assert!(floors(&lattice(|x, _| (9.0 - x * x).sqrt())).position > 2e-4);
        let exact: Vec<Vector> = lattice(|x, y| 0.009 * (9.0 * x * y).round());
        assert_eq!(floors(&exact), Floors::default());
    }

    #[test]
    fn roundings_that_are_shared_count_as_one_each_half_a_step_off() {
        let found = floors(&lattice(|x, _| (9.0 - x * x).sqrt()));
        let times = |floors: Floors| floors.of_positions() / found.position.powi(2);
        assert!((times(found) - 19.0).abs() < 1e-9 && (times(found.of_means(4.0, 1.0)) - 4.75).abs() < 1e-9);
        assert_eq!(Floors::default().of_positions(), 0.0);
    }
}
