//! Whether contacts beside one surface are several primitives.
//!
//! ```text
//! s       mad of the distances d_i from the surface          near    mad(d_i - d_j) / sqrt 2, contact j next to i
//! asked   near < s / 2: contacts lie off the surface together, which it does not follow
//! ln p    of one surface   -n ln s - u ln(sqrt(n) / s)       u    unknowns of all primitives together
//!         of primitives    the sum of the same over each, and of what belongs to none, anywhere within the reach
//! told    the primitives are likelier for certain, lie far nearer, and hold nearly all contacts
//! ```
//!
//! The surface is given as many unknowns as the primitives have, since a free form takes what it wants.

use super::cloud::{DIGITS, framed};
use super::ordered_contacts::places;
use super::scatter::lie_off_together;
use super::segmentation::{Segmentation, is_simple};
use super::{Parts, PartsOptions};
use crate::bodies::{Tuning, price_of_unknowns};
use palpate_geometry::contact::Contacts;
use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::draws::evenly;
use palpate_numeric::statistics::mad;
use palpate_numeric::vector::Vector;

/// Contacts, evenly among all, that are cut into parts to see whether it is worth it.
const LOOKED_AT: usize = 2_500;

impl Parts {
    /// The parts of contacts, where these tell them better than one surface from which they lie at `distances`; input units.
    ///
    /// `None` where the surface follows the contacts, and where they cannot be cut.
    pub fn instead_of(distances: &[f64], contacts: &Contacts, options: &PartsOptions) -> Option<Parts> {
        let points: Vec<Vector> = places(contacts);
        let tuning = &options.tuning.recognition;
        let (_, _, size) = framed(&points)?;
        let is_exact = mad(distances.iter().copied()) <= DIGITS * size;
        if distances.len() != points.len() || is_exact || !leaves_a_pattern(distances, &points, tuning) {
            return None;
        }
        let found_of = |members: &[u32]| {
            let off: Vec<f64> = members.iter().map(|i| distances[*i as usize]).collect();
            // what has too few contacts in primitives need not be fitted
            let cut = Segmentation::of(&contacts.in_order(members), options).ok()?;
            let is_worth = cut.held_by_simple_kinds() >= tuning.primitives_hold;
            let found = is_worth.then(|| cut.parts(&options.tuning))?;
            is_likelier(&found, &off, size, tuning).then_some(found)
        };
        // what some of very many contacts do not show, all of them need not be cut for
        let share = LOOKED_AT as f64 / points.len() as f64;
        let members: Vec<u32> = (0..points.len() as u32).collect();
        let some: Vec<u32> = members.iter().copied().filter(|i| evenly(*i as usize) < share).collect();
        let found = found_of(&some)?;
        if some.len() == members.len() { Some(found) } else { found_of(&members) }
    }
}

/// Whether contacts next to each other lie off the surface together.
fn leaves_a_pattern(distances: &[f64], points: &[Vector], tuning: &Tuning) -> bool {
    let tree = Neighbours::new(points);
    let pairs = (0..points.len()).filter_map(|i| Some(distances[i] - distances[tree.nearest_other(i)?.1]));
    lie_off_together(distances.iter().copied(), pairs, tuning)
}

/// One of several groups of contacts that are told by a surface of their own.
struct ContactGroup {
    contacts: f64,
    /// In units of the size of all.
    scatter: f64,
    unknowns: f64,
}

impl ContactGroup {
    fn log_probability(&self) -> f64 {
        -self.contacts * self.scatter.ln() - price_of_unknowns(self.unknowns, self.contacts, self.scatter)
    }
}

fn is_likelier(found: &Parts, distances: &[f64], size: f64, tuning: &Tuning) -> bool {
    let count = distances.len() as f64;
    let scatter = |length: f64| (length / size).max(f64::EPSILON);
    let of_one = scatter(mad(distances.iter().copied()));
    let primitives = found.parts.iter().filter(|part| is_simple(part.kind));
    let of_parts: Vec<ContactGroup> = primitives
        .map(|part| ContactGroup {
            contacts: part.points as f64,
            scatter: scatter(part.misfit),
            unknowns: part.kind.free().len() as f64,
        })
        .collect();
    let held: f64 = of_parts.iter().map(|told| told.contacts).sum();
    let square: f64 = of_parts.iter().map(|told| told.contacts * told.scatter * told.scatter).sum();
    let unknowns = of_parts.iter().map(|told| told.unknowns).sum();
    let is_nearer = (square / held).sqrt() < tuning.sharper * of_one;
    if of_parts.len() < 2 || held < tuning.primitives_hold * count || !is_nearer {
        return false;
    }
    let one = ContactGroup { contacts: count, scatter: of_one, unknowns };
    let none = -(count - held) * tuning.scatter_of_none().ln();
    let several = of_parts.iter().map(ContactGroup::log_probability).sum::<f64>() + none;
    several > one.log_probability() + tuning.clearly
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::placed::PartKind;
    use palpate_numeric::draws::Lcg;
    use palpate_numeric::vector::{norm, unit};

    const COUNT: usize = 1200;

    /// Places on a cube of side 2, and their distances from a ball about it that is as far in as out.
    fn cube() -> (Vec<Vector>, Vec<f64>) {
        let mut generator = Lcg::new(3);
        let places: Vec<Vector> = (0..COUNT)
            .map(|k| {
                let side = if k % 2 == 0 { 1.0 } else { -1.0 };
                let [u, v] = [0, 1].map(|_| 2.0 * generator.uniform() - 1.0);
                let face = [side, u, v];
                [0, 1, 2].map(|axis| face[(axis + k / 2) % 3])
            })
            .collect();
        let distances = places.iter().map(|p| norm(*p) - 1.28).collect();
        (places, distances)
    }

    #[test]
    fn the_faces_of_a_cube_tell_more_than_a_ball_about_it() {
        let (places, distances) = cube();
        let found = Parts::instead_of(&distances, &Contacts::from_points(&places), &PartsOptions::default()).unwrap();
        let planes = found.parts.iter().filter(|part| part.kind == PartKind::Plane).count();
        assert!(planes >= 5 && found.parts.len() == 6, "{planes}");
    }

    #[test]
    fn a_surface_that_follows_the_contacts_stands() {
        let mut generator = Lcg::new(4);
        let noise: Vec<f64> = (0..COUNT).map(|_| 0.02 * (generator.uniform() - 0.5)).collect();
        let places: Vec<Vector> = noise
            .iter()
            .map(|off| unit([0, 1, 2].map(|_| generator.uniform() - 0.5)).map(|v| v * (1.0 + off)))
            .collect();
        assert!(Parts::instead_of(&noise, &Contacts::from_points(&places), &PartsOptions::default()).is_none());
    }
}
