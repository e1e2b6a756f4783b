//! Contacts in the order of the cells, so that those of any cell of any level stand one behind the other.
//!
//! ```text
//! code = base cell * 4^20 + interleaved digits of the halvings in x and y (the order of G. M. Morton)
//! ```
//!
//! Sorted once, they are never moved again however the cells are split. Work is done about the middle of the contacts and in units of
//! half their larger side, so that coordinates of 1e7 cost no digits.

use std::ops::Range;

use super::column_kind::{ColumnKind, columns_of};
use crate::error::HierarchyError;
use crate::mesh::{CellId, MAX_LEVEL, Mesh};
use palpate_geometry::contact::{Contacts, Frame, Orientation};
use palpate_numeric::threads;

/// Contacts in patch coordinates, cell by cell.
#[derive(Clone, Debug)]
pub struct SortedContacts {
    contacts: Contacts,
    codes: Vec<u64>,
    /// Number of each in the order in which they came.
    numbers: Vec<u32>,
}

/// Contacts whose codes one thread makes at a time.
const PIECE: usize = 1 << 14;

fn parts(what: String) -> HierarchyError {
    HierarchyError::Parts { what }
}

/// Digits of x and y in turn.
fn interleaved([x, y]: [u32; 2]) -> u64 {
    let spread = |k: u32| {
        let mut wide = u64::from(k);
        for (shift, mask) in [
            (16, 0x0000_FFFF_0000_FFFF),
            (8, 0x00FF_00FF_00FF_00FF),
            (4, 0x0F0F_0F0F_0F0F_0F0F),
            (2, 0x3333_3333_3333_3333),
            (1, 0x5555_5555_5555_5555),
        ] {
            wide = (wide | wide << shift) & mask;
        }
        wide
    };
    spread(x) << 1 | spread(y)
}

fn code(mesh: &Mesh, root: [usize; 2], digits: [u32; 2]) -> u64 {
    let number = (root[0] * mesh.tree().base()[1] + root[1]) as u64;
    number << (2 * MAX_LEVEL) | interleaved(digits)
}

/// The frame in which fits work: the input's axes about the middle of `domain`, in units of half its larger side; heights from the
/// middle of theirs.
pub fn patch_frame(domain: [[f64; 2]; 2], heights: [f64; 2]) -> Frame {
    let middle = |[lo, hi]: [f64; 2]| lo + 0.5 * (hi - lo);
    let scale = domain.iter().map(|[lo, hi]| 0.5 * (hi - lo)).fold(0.0, f64::max);
    Frame { origin: [middle(domain[0]), middle(domain[1]), middle(heights)], scale, ..Frame::IDENTITY }
}

impl SortedContacts {
    /// Checks the contacts, brings them into the patch's frame and sorts them by the cells of a mesh in that frame.
    ///
    /// # Errors
    /// Faulty contacts ([`Contacts::check`]), and contacts outside the mesh's domain by more than rounding.
    ///
    /// # Panics
    /// Not for contacts that `check` accepts.
    pub fn new(contacts: &Contacts, frame: &Frame, mesh: &Mesh) -> Result<SortedContacts, HierarchyError> {
        contacts.check()?;
        let place = |r: usize| {
            let [x, y, _] = frame.to_patch([contacts.x[r], contacts.y[r], contacts.z[r]]);
            [x, y]
        };
        let domain = mesh.levels().at(0).map(|level| level.knots().domain());
        let outside = |r: &usize| {
            let at = place(*r);
            // the ends of the domain are rounded in the frame
            (0..2).any(|k| {
                let [lo, hi] = domain[k];
                let slack = 1e-9 * (hi - lo);
                at[k] < lo - slack || at[k] > hi + slack
            })
        };
        if let Some(index) = (0..contacts.len()).find(outside) {
            return Err(HierarchyError::Outside { index, x: contacts.x[index], y: contacts.y[index] });
        }
        let (codes, numbers) = sorted_codes(contacts.len(), mesh, place);
        let mut contacts = contacts.in_order(&numbers);
        for r in 0..contacts.len() {
            let at = frame.to_patch([contacts.x[r], contacts.y[r], contacts.z[r]]);
            [contacts.x[r], contacts.y[r], contacts.z[r]] = at;
        }
        Ok(SortedContacts { contacts, codes, numbers })
    }

    /// Some of all contacts that came from this number on, in an order that others of them can be put into.
    ///
    /// # Errors
    /// Numbers beyond 2^32.
    pub(crate) fn numbered_from(mut self, first: usize) -> Result<SortedContacts, HierarchyError> {
        let last = first + self.len();
        let first = u32::try_from(last).map_err(|_| parts(format!("{last} contacts: at most {}", u32::MAX)))?
            - self.numbers.len() as u32;
        self.numbers.iter_mut().for_each(|number| *number += first);
        Ok(self)
    }

    /// A run of them.
    pub(crate) fn slice(&self, range: Range<usize>) -> SortedContacts {
        let order: Vec<u32> = range.clone().map(|r| r as u32).collect();
        SortedContacts {
            contacts: self.contacts.in_order(&order),
            codes: self.codes[range.clone()].to_vec(),
            numbers: self.numbers[range].to_vec(),
        }
    }

    /// All of these, sorted.
    ///
    /// # Errors
    /// When some come with columns that others lack.
    pub(crate) fn merged(runs: &[SortedContacts]) -> Result<SortedContacts, HierarchyError> {
        let Some(first) = runs.first() else { return Err(parts("no contacts".into())) };
        let kind = ColumnKind::of(&first.contacts);
        if runs.iter().any(|run| ColumnKind::of(&run.contacts) != kind) {
            return Err(parts("some come with columns that others lack".into()));
        }
        let joined = |k: usize| runs.iter().flat_map(|run| columns_of(&run.contacts)[k].iter().copied()).collect();
        let contacts = kind.contacts((0..kind.count()).map(joined).collect());
        let codes: Vec<u64> = runs.iter().flat_map(|run| run.codes.iter().copied()).collect();
        let numbers: Vec<u32> = runs.iter().flat_map(|run| run.numbers.iter().copied()).collect();
        if codes.iter().zip(&numbers).is_sorted() {
            return Ok(SortedContacts { contacts, codes, numbers });
        }
        let mut order: Vec<u32> = (0..codes.len() as u32).collect();
        order.sort_unstable_by_key(|r| (codes[*r as usize], numbers[*r as usize]));
        Ok(SortedContacts {
            contacts: contacts.in_order(&order),
            codes: order.iter().map(|r| codes[*r as usize]).collect(),
            numbers: order.iter().map(|r| numbers[*r as usize]).collect(),
        })
    }

    /// From columns that were taken apart.
    ///
    /// # Errors
    /// Columns of different lengths, and codes in no order.
    pub(crate) fn of_columns(
        kind: ColumnKind,
        columns: Vec<Vec<f64>>,
        codes: Vec<u64>,
        numbers: Vec<u32>,
    ) -> Result<SortedContacts, HierarchyError> {
        let count = codes.len();
        let whole = columns.len() == kind.count() && columns.iter().all(|column| column.len() == count);
        if !whole || numbers.len() != count || !codes.is_sorted() {
            return Err(parts("columns that do not belong together".into()));
        }
        Ok(SortedContacts { contacts: kind.contacts(columns), codes, numbers })
    }

    /// Where each stands in the order of the cells, and the number that it had when it came.
    pub(crate) fn codes_and_numbers(&self) -> (&[u64], &[u32]) {
        (&self.codes, &self.numbers)
    }

    /// Those of a run of base cells.
    pub(crate) fn of_roots(&self, roots: Range<usize>) -> Range<usize> {
        let at = |root: usize| self.codes.partition_point(|code| *code < (root as u64) << (2 * MAX_LEVEL));
        at(roots.start)..at(roots.end)
    }

    /// The contacts, sorted.
    pub fn contacts(&self) -> &Contacts {
        &self.contacts
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.codes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.codes.is_empty()
    }

    /// The number that the r-th had when it came.
    pub fn number(&self, r: usize) -> usize {
        self.numbers[r] as usize
    }

    /// Whether slopes or normals come with the contacts.
    pub fn oriented(&self) -> bool {
        self.contacts.orientation != Orientation::None
    }

    /// Puts other heights, and other slopes where there are some, in the place of those that are there; all in the order in which the
    /// contacts came, heights in the patch's units.
    pub(crate) fn measure_again(&mut self, height: impl Fn(usize) -> f64, slopes: Option<[&[f64]; 2]>) {
        for (r, number) in self.numbers.iter().enumerate() {
            self.contacts.z[r] = height(*number as usize);
        }
        if let (Orientation::Slopes { zx, zy }, Some([along_x, along_y])) = (&mut self.contacts.orientation, slopes) {
            for (r, number) in self.numbers.iter().enumerate() {
                (zx[r], zy[r]) = (along_x[*number as usize], along_y[*number as usize]);
            }
        }
    }

    /// The contacts of a cell.
    pub fn of_cell(&self, mesh: &Mesh, cell: CellId) -> Range<usize> {
        let [from, to] = codes_of_cell(mesh, cell);
        self.codes.partition_point(|c| *c < from)..self.codes.partition_point(|c| *c < to)
    }
}

/// Codes of the places in a cell: from the first to before the second.
pub(crate) fn codes_of_cell(mesh: &Mesh, cell: CellId) -> [u64; 2] {
    let root = cell.ancestor(0).place.map(|k| k as usize);
    let shift = MAX_LEVEL - usize::from(cell.level);
    let digits = cell.place.map(|k| (k << shift) & ((1 << MAX_LEVEL) - 1));
    let from = code(mesh, root, digits);
    [from, from + (1u64 << (2 * shift))]
}

/// Codes in ascending order and the numbers of their contacts; contacts of one code keep their order.
fn sorted_codes(count: usize, mesh: &Mesh, place: impl Fn(usize) -> [f64; 2] + Sync) -> (Vec<u64>, Vec<u32>) {
    let all: Vec<u64> = threads::map(count, PIECE, |r| {
        let (root, digits) = mesh.digits(place(r));
        code(mesh, root, digits)
    });
    let roots: usize = mesh.tree().base().iter().product();
    let root_of = |code: u64| (code >> (2 * MAX_LEVEL)) as usize;
    let mut starts = vec![0usize; roots + 1];
    all.iter().for_each(|code| starts[root_of(*code) + 1] += 1);
    (0..roots).for_each(|root| starts[root + 1] += starts[root]);
    let mut next = starts.clone();
    let mut pairs = vec![(0u64, 0u32); count];
    for (r, code) in all.into_iter().enumerate() {
        let at = &mut next[root_of(code)];
        pairs[*at] = (code, r as u32);
        *at += 1;
    }
    let mut buckets = Vec::with_capacity(roots);
    let mut rest = &mut pairs[..];
    for root in 0..roots {
        let (bucket, after) = rest.split_at_mut(starts[root + 1] - starts[root]);
        buckets.push(bucket);
        rest = after;
    }
    threads::each(&mut buckets, |_, bucket| bucket.sort_unstable());
    pairs.into_iter().unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::bspline::Knots;
    use palpate_numeric::draws::Lcg;

    #[test]
    fn the_contacts_of_a_cell_lie_in_it() {
        let mut draw = Lcg::new(3);
        let [x, y, z] = [0, 1, 2].map(|_| (0..3000).map(|_| 5e6 + 40.0 * draw.uniform()).collect::<Vec<f64>>());
        let contacts = Contacts::from_positions(x, y, z);
        let frame = patch_frame([[5e6, 5e6 + 40.0]; 2], [5e6, 5e6 + 40.0]);
        let mut mesh = Mesh::new([5, 3].map(|n| Knots::uniform(3, n, -1.0, 1.0).unwrap())).unwrap();
        (0..4).for_each(|level| mesh.refine(CellId { level, place: [2 << level, 1 << level] }).unwrap());
        let sorted = SortedContacts::new(&contacts, &frame, &mesh).unwrap();
        let mut next = 0;
        for leaf in mesh.tree().leaves() {
            let range = sorted.of_cell(&mesh, mesh.tree().cell(leaf));
            assert_eq!(range.start, next);
            next = range.end;
            for r in range {
                assert_eq!(mesh.locate([sorted.contacts().x[r], sorted.contacts().y[r]]), leaf);
                assert!((contacts.x[sorted.number(r)] - 5e6 - 20.0 - 20.0 * sorted.contacts().x[r]).abs() < 1e-8);
            }
        }
        assert_eq!(next, 3000);
        let far = Contacts::from_positions(vec![5e6 + 41.0], vec![5e6], vec![0.0]);
        assert!(matches!(SortedContacts::new(&far, &frame, &mesh), Err(HierarchyError::Outside { index: 0, .. })));
    }
}
