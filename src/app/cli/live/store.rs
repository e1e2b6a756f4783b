//! The touches that count: all of them, or the last so many.
//!
//! ```text
//! touches    1 2 3 4 5 6 7 8          memory: at most twice the window, whatever has gone through
//! window 3             6 7 8
//! ```

use palpate_geometry::contact::{ContactWeights, Contacts, Orientation};

/// Touches in the order in which they came.
#[derive(Debug, Default)]
pub(super) struct TouchStore {
    contacts: Contacts,
    window: Option<usize>,
    /// Touches that ever came.
    touches: u64,
}

impl TouchStore {
    /// An empty one that keeps the last `window` touches, or all.
    pub(super) fn new(window: Option<usize>) -> TouchStore {
        TouchStore { window, ..TouchStore::default() }
    }

    /// What an earlier run had kept, of so many touches.
    pub(super) fn with(mut self, contacts: Contacts, touches: u64) -> TouchStore {
        (self.contacts, self.touches) = (contacts, touches);
        self.forget(1);
        self
    }

    /// Touches that ever came.
    pub(super) fn touches(&self) -> u64 {
        self.touches
    }

    /// Touches that count.
    pub(super) fn len(&self) -> usize {
        self.contacts.len().min(self.window.unwrap_or(usize::MAX))
    }

    /// The touches that count.
    pub(super) fn contacts(&self) -> Contacts {
        let all = self.contacts.len();
        if all == self.len() {
            return self.contacts.clone();
        }
        let last: Vec<u32> = (all - self.len()..all).filter_map(|k| u32::try_from(k).ok()).collect();
        self.contacts.in_order(&last)
    }

    /// One touch more.
    pub(super) fn push(&mut self, touch: &Contacts) {
        append(&mut self.contacts, touch);
        self.touches += 1;
        self.forget(2);
    }

    /// Gives up what lies before the window, once there is so many times the window.
    fn forget(&mut self, times: usize) {
        let Some(window) = self.window else { return };
        if self.contacts.len() >= times.max(1) * window && self.contacts.len() > window {
            self.contacts = self.contacts();
        }
    }
}

/// Adds contacts behind others. What some of them lack is filled in: an unknown normal is zero, a weight is 1.
fn append(all: &mut Contacts, more: &Contacts) {
    let (before, added) = (all.len(), more.len());
    all.x.extend(&more.x);
    all.y.extend(&more.y);
    all.z.extend(&more.z);
    let old = std::mem::take(&mut all.orientation);
    all.orientation = match (old, &more.orientation) {
        (Orientation::None, Orientation::None) => Orientation::None,
        (Orientation::None, Orientation::Slopes { zx, zy }) if before == 0 => {
            Orientation::Slopes { zx: zx.clone(), zy: zy.clone() }
        }
        (Orientation::Slopes { zx: mut x, zy: mut y }, Orientation::Slopes { zx, zy }) => {
            x.extend(zx);
            y.extend(zy);
            Orientation::Slopes { zx: x, zy: y }
        }
        (old, new) => {
            let [mut nx, mut ny, mut nz] = normals(old, before);
            let [x, y, z] = normals(new.clone(), added);
            nx.extend(x);
            ny.extend(y);
            nz.extend(z);
            Orientation::Normals { nx, ny, nz }
        }
    };
    labels(&mut all.finger, &more.finger, before, added);
    labels(&mut all.station, &more.station, before, added);
    let ContactWeights { z, x, y } = &mut all.weights;
    for (old, new) in [(z, &more.weights.z), (x, &more.weights.x), (y, &more.weights.y)] {
        filled(old, new, [before, added], 1.0);
    }
}

/// Slopes as normals, and zeros where nothing is known.
fn normals(orientation: Orientation, contacts: usize) -> [Vec<f64>; 3] {
    match orientation {
        Orientation::Normals { nx, ny, nz } => [nx, ny, nz],
        Orientation::Slopes { zx, zy } => {
            let minus = |slopes: Vec<f64>| slopes.iter().map(|slope| -slope).collect::<Vec<f64>>();
            [minus(zx), minus(zy), vec![1.0; contacts]]
        }
        Orientation::None => [0, 1, 2].map(|_| vec![0.0; contacts]),
    }
}

/// A touch whose finger or station is not known belongs to none of the others: then none is told apart.
fn labels(old: &mut Option<Vec<u32>>, new: &Option<Vec<u32>>, before: usize, added: usize) {
    match (old.as_mut(), new) {
        (Some(old), Some(new)) => old.extend(new),
        (None, Some(new)) if before == 0 => *old = Some(new.clone()),
        _ if added == 0 => {}
        _ => *old = None,
    }
}

fn filled(old: &mut Option<Vec<f64>>, new: &Option<Vec<f64>>, [before, added]: [usize; 2], with: f64) {
    if old.is_none() && new.is_none() {
        return;
    }
    let all = old.get_or_insert_with(|| vec![with; before]);
    match new {
        Some(new) => all.extend(new),
        None => all.extend(vec![with; added]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touch(k: usize) -> Contacts {
        Contacts::from_points(&[[k as f64, 0.0, 0.0]])
    }

    #[test]
    fn the_window_keeps_the_last_and_its_memory_stays() {
        let mut store = TouchStore::new(Some(5));
        let mut most = 0;
        for k in 0..1000 {
            store.push(&touch(k));
            most = most.max(store.contacts.x.len());
            let last: Vec<f64> = ((k + 1).saturating_sub(5)..=k).map(|k| k as f64).collect();
            assert_eq!(store.contacts().x, last);
        }
        assert_eq!((store.touches(), store.len()), (1000, 5));
        assert!(most <= 10, "{most}");
    }

    #[test]
    fn touches_with_and_without_normals_stand_side_by_side() {
        let mut store = TouchStore::new(None);
        store.push(&touch(1));
        store.push(&touch(2).with_normal_vectors(&[[0.0, 0.6, 0.8]]));
        store.push(&touch(3).with_slopes(vec![0.5], vec![0.25]));
        let Orientation::Normals { nx, ny, nz } = store.contacts().orientation else { panic!("normals") };
        assert_eq!((nx, ny, nz), (vec![0.0, 0.0, -0.5], vec![0.0, 0.6, -0.25], vec![0.0, 0.8, 1.0]));
        let mut slopes = TouchStore::new(None);
        slopes.push(&touch(1).with_slopes(vec![0.5], vec![0.25]));
        slopes.push(&touch(2).with_slopes(vec![0.1], vec![0.2]));
        assert_eq!(slopes.contacts().orientation, Orientation::Slopes { zx: vec![0.5, 0.1], zy: vec![0.25, 0.2] });
    }
}
