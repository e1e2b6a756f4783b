//! Contacts, one after another.

use palpate_geometry::contact::{Contacts, Orientation};

use crate::border::{PalpateStatus, Refused, faulty, guarded, hand_over, named, named_mut, take_back};

/// Contacts: places, each with or without the outward normal there.
#[derive(Debug, Default)]
pub struct PalpateContacts {
    pub(crate) points: Vec<[f64; 3]>,
    /// Zero where it is not known.
    normals: Vec<[f64; 3]>,
}

impl PalpateContacts {
    fn add(&mut self, point: [f64; 3], normal: [f64; 3]) -> Result<(), Refused> {
        let numbers = ["x", "y", "z", "nx", "ny", "nz"].into_iter().zip(point.into_iter().chain(normal));
        if let Some((name, value)) = numbers.into_iter().find(|(_, value)| !value.is_finite()) {
            return Err(faulty(format!("{name} of contact {} is {value}, not a finite number", self.points.len())));
        }
        self.points.push(point);
        self.normals.push(normal);
        Ok(())
    }

    /// For a recognition, which leaves out normals that are not known.
    pub(crate) fn all(&self) -> Contacts {
        let contacts = Contacts::from_points(&self.points);
        let any = self.normals.iter().any(|normal| *normal != [0.0; 3]);
        if any { contacts.with_normal_vectors(&self.normals) } else { contacts }
    }

    /// For a named fit, which takes normals of all contacts or of none.
    pub(crate) fn whole(&self) -> Contacts {
        let contacts = self.all();
        let known = self.normals.iter().all(|normal| *normal != [0.0; 3]);
        if known { contacts } else { Contacts { orientation: Orientation::None, ..contacts } }
    }
}

/// New contacts, of which there are none yet. Free them by `palpate_contacts_free`.
///
/// # Safety
/// `contacts` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_contacts_new(contacts: *mut *mut PalpateContacts) -> PalpateStatus {
    // SAFETY: as this function asks of its caller
    guarded(|| unsafe { hand_over(PalpateContacts::default(), contacts) })
}

/// Frees contacts; null is nothing.
///
/// # Safety
/// `contacts` is null or a handle that was not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_contacts_free(contacts: *mut PalpateContacts) {
    // SAFETY: as this function asks of its caller
    unsafe { take_back(contacts) }
}

/// Adds a place.
///
/// # Safety
/// `contacts` is null or a living handle that no other thread uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_contacts_add(contacts: *mut PalpateContacts, x: f64, y: f64, z: f64) -> PalpateStatus {
    // SAFETY: as this function asks of its caller
    guarded(|| unsafe { named_mut(contacts, "contacts") }?.add([x, y, z], [0.0; 3]))
}

/// Adds a place with the outward normal there, of any length but zero.
///
/// # Safety
/// `contacts` is null or a living handle that no other thread uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_contacts_add_with_normal(
    contacts: *mut PalpateContacts,
    x: f64,
    y: f64,
    z: f64,
    nx: f64,
    ny: f64,
    nz: f64,
) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let contacts = unsafe { named_mut(contacts, "contacts") }?;
        if [nx, ny, nz] == [0.0; 3] {
            return Err(faulty(format!("the normal of contact {} is zero", contacts.points.len())));
        }
        contacts.add([x, y, z], [nx, ny, nz])
    })
}

/// Forgets all contacts; their memory is kept for others.
///
/// # Safety
/// `contacts` is null or a living handle that no other thread uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_contacts_clear(contacts: *mut PalpateContacts) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let contacts = unsafe { named_mut(contacts, "contacts") }?;
        contacts.points.clear();
        contacts.normals.clear();
        Ok(())
    })
}

/// Number of contacts; 0 of null.
///
/// # Safety
/// `contacts` is null or a living handle that no other thread changes meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_contacts_count(contacts: *const PalpateContacts) -> usize {
    // SAFETY: as this function asks of its caller
    unsafe { named(contacts, "contacts") }.map_or(0, |contacts| contacts.points.len())
}
