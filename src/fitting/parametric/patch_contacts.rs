//! The contacts in patch coordinates: points, unit normals, weights. One length scales space and both parameters.

use super::vector::Vector;
use crate::fit::FitError;
use palpate_geometry::contact::{Contacts, Orientation, Rounding};

/// The data of every contact.
#[derive(Clone, Debug)]
pub(super) struct PatchContacts {
    /// Points.
    pub points: Vec<Vector>,
    /// Unit normals towards the free side.
    pub normals: Vec<Vector>,
    /// Weights of the positions, which multiply residuals.
    pub position_weight: Vec<f64>,
    /// Weights of the normals.
    pub normal_weight: Vec<f64>,
    /// Finger and station of every contact, where both are known.
    pub labels: Option<Vec<[u32; 2]>>,
    /// Standard deviations by which positions and normals were rounded where they were written.
    pub rounding: [f64; 2],
}

impl PatchContacts {
    /// In input units.
    ///
    /// # Errors
    /// Faulty columns; contacts without normals, which leave a parametric surface undetermined.
    pub(super) fn new(contacts: &Contacts) -> Result<PatchContacts, FitError> {
        contacts.check()?;
        if contacts.orientation == Orientation::None {
            return Err(FitError::Objective { objective: "a parametric surface", needed: "normals or slopes" });
        }
        let count = contacts.len();
        let weight = |column: &Option<Vec<f64>>, r: usize| column.as_ref().map_or(1.0, |w| w[r]);
        let written = Rounding::of_contacts(contacts);
        let labels = contacts.finger.as_ref().zip(contacts.station.as_ref());
        Ok(PatchContacts {
            points: (0..count).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]).collect(),
            normals: (0..count).filter_map(|r| contacts.unit_normal(r)).collect(),
            position_weight: (0..count).map(|r| weight(&contacts.weights.z, r)).collect(),
            normal_weight: (0..count)
                .map(|r| weight(&contacts.weights.x, r).min(weight(&contacts.weights.y, r)))
                .collect(),
            labels: labels.map(|(f, s)| f.iter().zip(s).map(|(f, s)| [*f, *s]).collect()),
            rounding: [written.position.into_iter().fold(0.0, f64::max), written.normal],
        })
    }

    /// The contacts with these numbers.
    pub(super) fn chosen(&self, numbers: &[usize]) -> PatchContacts {
        let vectors = |of: &[Vector]| numbers.iter().map(|&r| of[r]).collect();
        let weights = |of: &[f64]| numbers.iter().map(|&r| of[r]).collect();
        PatchContacts {
            points: vectors(&self.points),
            normals: vectors(&self.normals),
            position_weight: weights(&self.position_weight),
            normal_weight: weights(&self.normal_weight),
            labels: self.labels.as_ref().map(|labels| numbers.iter().map(|&r| labels[r]).collect()),
            rounding: self.rounding,
        }
    }

    /// Number of contacts.
    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    /// Number of scalar rows: one for each position and two for each normal whose weight is not zero.
    pub(super) fn equations(&self) -> usize {
        let count = |weights: &[f64]| weights.iter().filter(|w| **w > 0.0).count();
        count(&self.position_weight) + 2 * count(&self.normal_weight)
    }

    /// Moves the points to patch coordinates: `(P - origin) / scale`.
    pub(super) fn place(&mut self, origin: Vector, scale: f64) {
        for p in &mut self.points {
            (0..3).for_each(|k| p[k] = (p[k] - origin[k]) / scale);
        }
        self.rounding[0] /= scale;
    }

    /// Mean point.
    pub(super) fn centre(&self) -> Vector {
        let n = self.len() as f64;
        self.points.iter().fold([0.0; 3], |m, p| [0, 1, 2].map(|k| m[k] + p[k] / n))
    }
}
