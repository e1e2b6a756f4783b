//! Which B-splines of which level take part, and what every other B-spline on a cell is made of.
//!
//! ```text
//! active at level l        supp N^l_ij in Omega^l, not in Omega^(l+1)
//! on a cell of level l     S = sum_ij d_ij N^l_ij,   d_ij = c_ij           where supp N^l_ij lies in Omega^l
//!                                                   d_ij = sum_km a_ik a_jm d^(l-1)_km      elsewhere
//! ```
//!
//! The second line is the truncation: a coarse function keeps only those of its finer parts that are not in the basis themselves
//! (C. Giannelli, B. Juettler, H. Speleers, *Comput. Aided Geom. Design* 29 (2012) 485). So the functions sum to one, are positive and
//! independent, and a coefficient means the same as in the tensor spline of its level.

use std::collections::BTreeMap;

use crate::mesh::{CellId, Mesh};

/// One B-spline of the basis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ActiveFunction {
    /// Its level.
    pub level: u8,
    /// Its number in x and in y among the functions of the level.
    pub place: [u32; 2],
}

/// A B-spline's coefficient as a sum over those of the basis, `(function, share)` in ascending order.
pub(super) type Shares = Vec<(u32, f64)>;

/// All functions that do not vanish on the unsplit cells of one level.
#[derive(Debug, Default)]
pub(super) struct LevelFunctions {
    /// Places in ascending order.
    places: Vec<[u32; 2]>,
    /// Number in the basis, or `NOT_ACTIVE`.
    pub numbers: Vec<u32>,
}

pub(super) const NOT_ACTIVE: u32 = u32::MAX;

impl LevelFunctions {
    /// Functions on these cells of one level.
    pub(super) fn on_cells(mesh: &Mesh, level: usize, cells: &[CellId]) -> LevelFunctions {
        let axes = mesh.levels().at(level);
        let degree = mesh.levels().degree();
        let mut places = Vec::new();
        for cell in cells {
            let first = [0, 1].map(|axis| axes[axis].knots().first_basis(cell.place[axis] as usize));
            for a in 0..=degree[0] {
                places.extend((0..=degree[1]).map(|b| [(first[0] + a) as u32, (first[1] + b) as u32]));
            }
            // cells come in no order of their places, and neighbours share nearly all functions
            if places.len() > 1 << 20 {
                places.sort_unstable();
                places.dedup();
            }
        }
        places.sort_unstable();
        places.dedup();
        let numbers = vec![NOT_ACTIVE; places.len()];
        LevelFunctions { places, numbers }
    }

    pub(super) fn places(&self) -> &[[u32; 2]] {
        &self.places
    }

    /// Position of a function in the list.
    pub(super) fn position(&self, place: [u32; 2]) -> Option<usize> {
        self.places.binary_search(&place).ok()
    }
}

/// Whether a function's support lies in the union of all cells of its level that exist.
pub(super) fn lies_inside(mesh: &Mesh, level: usize, place: [u32; 2]) -> bool {
    if level == 0 {
        return true;
    }
    let axes = mesh.levels().at(level);
    let [x, y] = [0, 1].map(|axis| axes[axis].reach(place[axis] as usize));
    // children exist together, so one parent answers for four cells
    (x[0] / 2..=x[1] / 2).all(|i| {
        (y[0] / 2..=y[1] / 2).all(|j| {
            let parent = CellId { level: level as u8 - 1, place: [i, j] };
            mesh.tree().find(parent).is_some_and(|number| mesh.tree().is_split(number))
        })
    })
}

/// The shares of functions that are not in the basis, level by level, each computed once.
pub(super) struct Truncation<'a> {
    pub mesh: &'a Mesh,
    pub levels: &'a [LevelFunctions],
    pub known: BTreeMap<ActiveFunction, Shares>,
}

impl Truncation<'_> {
    /// What a function's coefficient is made of.
    pub(super) fn shares(&mut self, function: ActiveFunction) -> Shares {
        if let Some(shares) = self.known.get(&function) {
            return shares.clone();
        }
        let level = usize::from(function.level);
        let shares = if lies_inside(self.mesh, level, function.place) {
            let functions = &self.levels[level];
            let number = functions.position(function.place).map_or(NOT_ACTIVE, |at| functions.numbers[at]);
            // a function of finer cells only is no part of the surface, and nothing depends on its coefficient
            if number == NOT_ACTIVE { Vec::new() } else { vec![(number, 1.0)] }
        } else {
            self.inserted(level, function.place)
        };
        self.known.insert(function, shares.clone());
        shares
    }

    fn inserted(&mut self, level: usize, place: [u32; 2]) -> Shares {
        let [x, y] = [0, 1].map(|axis| self.mesh.levels().insertion_row(axis, level - 1, place[axis] as usize));
        let mut sum: BTreeMap<u32, f64> = BTreeMap::new();
        for (a, share_x) in x.shares.iter().enumerate().filter(|(_, share)| **share != 0.0) {
            for (b, share_y) in y.shares.iter().enumerate().filter(|(_, share)| **share != 0.0) {
                let place = [(x.first + a) as u32, (y.first + b) as u32];
                let coarse = ActiveFunction { level: level as u8 - 1, place };
                for (number, share) in self.shares(coarse) {
                    *sum.entry(number).or_insert(0.0) += share_x * share_y * share;
                }
            }
        }
        sum.into_iter().collect()
    }
}
