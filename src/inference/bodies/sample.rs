//! Contacts about their own middle in units of one length.
//!
//! ```text
//! p = (P - mean P) / s,   s^2 = mean |P - mean P|^2
//! ```

use palpate_geometry::contact::{Frame, Rounding};
use palpate_numeric::statistics::evenly_among;
use palpate_numeric::vector::{Vector, dot, minus};

/// Contacts in units of their own size.
#[derive(Clone, Debug)]
pub(crate) struct BodySample {
    /// The input's axes about the contacts' middle.
    pub(crate) frame: Frame,
    pub(crate) points: Vec<Vector>,
    /// Unit normals, zero where unknown; empty where there are none.
    pub(crate) normals: Vec<Vector>,
    /// Sds that numbers with a step leave, of a place and of a normal: no scale is found below them.
    pub(crate) floor: [f64; 2],
    /// The same of every coordinate, and how many share one rounding.
    pub(super) rounding: Rounding,
}

/// Scales below this share of the contacts' size are those of rounding.
const ROUNDING: f64 = 1e-12;

impl BodySample {
    /// `None` where the contacts have no extent. `rounding` is in the input's unit.
    pub(crate) fn new(points: &[Vector], normals: &[Vector], rounding: Rounding) -> Option<BodySample> {
        let count = points.len() as f64;
        let first = *points.first()?;
        let sum = points.iter().fold([0.0; 3], |sum, p| [0, 1, 2].map(|k| sum[k] + (p[k] - first[k])));
        let origin = [0, 1, 2].map(|k| first[k] + sum[k] / count);
        let square: f64 = points.iter().map(|p| minus(*p, origin)).map(|d| dot(d, d)).sum();
        let scale = (square / count).sqrt();
        if !(scale > 0.0 && scale.is_finite()) {
            return None;
        }
        let frame = Frame { origin, scale, ..Frame::IDENTITY };
        let points: Vec<Vector> = points.iter().map(|p| minus(*p, origin).map(|v| v / scale)).collect();
        let far = origin.iter().fold(0.0_f64, |far, v| far.max(v.abs())) / scale;
        let rounding = rounding.per(scale);
        // the coordinate along a bar may be as coarse as it likes
        let [place, normal] = rounding.among(&points, normals).largest();
        let floor = [place.max(ROUNDING * (1.0 + far)), normal.max(ROUNDING)];
        Some(BodySample { frame, points, normals: normals.to_vec(), floor, rounding })
    }

    /// Sd of a place that counts for as many contacts as there are: those that are rounded alike err alike.
    pub(super) fn shared_floor(&self, members: &[usize]) -> f64 {
        let some = self.only(members);
        self.rounding.among(&some.points, &some.normals).variances()[0].sqrt()
    }

    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// The normal of a contact, where it is known.
    pub(crate) fn normal(&self, i: usize) -> Option<Vector> {
        self.normals.get(i).copied().filter(|n| *n != [0.0; 3])
    }

    pub(crate) fn known_normals(&self) -> usize {
        (0..self.len()).filter(|i| self.normal(*i).is_some()).count()
    }

    /// Some of the contacts.
    pub(crate) fn only(&self, members: &[usize]) -> BodySample {
        let of = |values: &[Vector]| members.iter().filter_map(|&i| values.get(i).copied()).collect();
        BodySample { points: of(&self.points), normals: of(&self.normals), ..self.clone() }
    }

    /// At most so many contacts, evenly among all.
    pub(crate) fn at_most(&self, most: usize) -> BodySample {
        self.only(&evenly_among(self.len(), most).collect::<Vec<usize>>())
    }
}
