//! Which columns contacts have, and the columns one after another: what is written, read and put together.
//!
//! ```text
//! x y z   [zx zy | nx ny nz]   [wz] [wx] [wy]
//! ```

use palpate_geometry::contact::{ContactWeights, Contacts, Orientation};

/// Which columns there are besides x, y and z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ColumnKind {
    /// Columns of the orientation: 0, 2 of slopes, 3 of normals.
    oriented: u8,
    /// Weights of heights, and of slopes in x and in y.
    weights: [bool; 3],
}

impl ColumnKind {
    pub(crate) fn of(contacts: &Contacts) -> ColumnKind {
        let oriented = match contacts.orientation {
            Orientation::None => 0,
            Orientation::Slopes { .. } => 2,
            Orientation::Normals { .. } => 3,
        };
        let ContactWeights { z, x, y } = &contacts.weights;
        ColumnKind { oriented, weights: [z, x, y].map(Option::is_some) }
    }

    /// Columns with x, y and z.
    pub(crate) fn count(self) -> usize {
        3 + usize::from(self.oriented) + self.weights.iter().filter(|there| **there).count()
    }

    /// As one number.
    pub(crate) fn to_word(self) -> u64 {
        self.weights.iter().rev().fold(0, |sum, there| 2 * sum + u64::from(*there)) << 2 | u64::from(self.oriented)
    }

    /// `None` of a number that is none.
    pub(crate) fn of_word(word: u64) -> Option<ColumnKind> {
        let oriented = (word & 3) as u8;
        (word < 32 && oriented != 1).then(|| ColumnKind { oriented, weights: [4, 8, 16].map(|bit| word & bit != 0) })
    }

    /// Contacts of these columns, as many as [`ColumnKind::count`] says; others stay empty.
    pub(crate) fn contacts(self, columns: Vec<Vec<f64>>) -> Contacts {
        let mut columns = columns.into_iter();
        let mut next = || columns.next().unwrap_or_default();
        let made = Contacts::from_positions(next(), next(), next());
        let orientation = match self.oriented {
            0 => Orientation::None,
            2 => Orientation::Slopes { zx: next(), zy: next() },
            _ => Orientation::Normals { nx: next(), ny: next(), nz: next() },
        };
        let [z, x, y] = self.weights.map(|there| there.then(&mut next));
        Contacts { orientation, weights: ContactWeights { z, x, y }, ..made }
    }
}

/// All columns in their order.
pub(crate) fn columns_of(contacts: &Contacts) -> Vec<&[f64]> {
    let mut columns: Vec<&[f64]> = vec![&contacts.x, &contacts.y, &contacts.z];
    match &contacts.orientation {
        Orientation::None => {}
        Orientation::Slopes { zx, zy } => columns.extend([&zx[..], zy]),
        Orientation::Normals { nx, ny, nz } => columns.extend([&nx[..], ny, nz]),
    }
    let ContactWeights { z, x, y } = &contacts.weights;
    columns.extend([z, x, y].into_iter().filter_map(Option::as_deref));
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_put_together_as_they_were() {
        let three = || Contacts::from_positions(vec![1.0], vec![2.0], vec![3.0]);
        let mut weighed = three().with_normal_vectors(&[[0.0, 0.6, 0.8]]);
        weighed.weights.z = Some(vec![0.5]);
        weighed.weights.y = Some(vec![0.25]);
        for contacts in [three(), three().with_slopes(vec![0.1], vec![0.2]), weighed] {
            let kind = ColumnKind::of(&contacts);
            assert_eq!(ColumnKind::of_word(kind.to_word()), Some(kind));
            let columns: Vec<Vec<f64>> = columns_of(&contacts).iter().map(|column| column.to_vec()).collect();
            assert_eq!(columns.len(), kind.count());
            assert_eq!(kind.contacts(columns), contacts);
        }
        assert!([1, 5, 32, u64::MAX].into_iter().all(|word| ColumnKind::of_word(word).is_none()));
    }
}
