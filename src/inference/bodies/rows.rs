//! The rows of contacts about one primitive, and their Gram matrices for a departure of some length.
//!
//! ```text
//! distance of contact i   d_i + J_i x - phi(q_i)' w                        J: by the primitive's free unknowns
//! its normal, along t     t . (g_i - n_i) + (t . G_i) x - phi_t(q_i)' w    t: two directions across the normal, phi_t: slope along t
//! columns                 w, x, residual
//! ```

use std::sync::Arc;

use faer::{Mat, MatMut};

use super::coordinates::DepartureOver;
use super::departure::DepartureProcess;
use super::departure_kernel::DepartureKernel;
use super::departure_reading::DepartureReading;
use super::kernel_layer::spread;
use super::mode::aligned;
use super::sample::BodySample;
use crate::dense;
use crate::primitives::normal_equations::rows;
use crate::primitives::placed::Primitive;
use palpate_numeric::vector::{Vector, along, axes_along, dot};

/// Rows by the primitive's unknowns and the residual.
pub(super) struct BaseRows {
    pub(super) over: DepartureOver,
    /// What the departure is a function of, at every contact.
    pub(super) places: Vec<Vector>,
    /// Contacts with a normal, with two directions across it in what the departure is a function of.
    pub(super) across: Vec<(usize, [Vector; 2])>,
    pub(super) distances: Mat<f64>,
    pub(super) tangential: Mat<f64>,
    /// Given normals that point to the side of the base's normals, and those that point to the other.
    pub(super) sides: [usize; 2],
    /// Rows of steepness, and the directions in which it is asked; none where a departure is small.
    pub(super) steepness: Mat<f64>,
    pub(super) upward: Vec<Vector>,
}

/// Gram matrices over columns `w, x, residual`.
pub(super) struct RowGrams {
    /// Of distances and of normals.
    pub(super) of: [Mat<f64>; 2],
    /// Of steepness, where it is asked.
    pub(super) steepness: Option<Mat<f64>>,
    /// Number of the columns w.
    pub(super) places: usize,
    /// What the departure is.
    pub(super) reading: DepartureReading,
    /// What the columns w are those of.
    pub(super) process: Option<Arc<DepartureProcess>>,
}

impl BaseRows {
    /// Of the contacts that belong to a primitive, for departures that are small.
    pub(super) fn new(primitive: &Primitive, over: DepartureOver, members: &[usize], sample: &BodySample) -> BaseRows {
        let free = primitive.kind.free();
        let width = free.len() + 1;
        let mut found = BaseRows::empty(over, free.len(), members, sample);
        for (r, &i) in members.iter().enumerate() {
            let place = sample.points[i];
            let (d, normal) = primitive.nearest(place);
            let given = sample.normal(i).map(|n| aligned(n, normal));
            found.count_side(sample.normal(i), normal);
            let all = rows(primitive, place, given.unwrap_or([0.0; 3]));
            let foot = along(place, -d, normal);
            found.places.push(over.coordinates(primitive, place, foot));
            free.iter().enumerate().for_each(|(c, &a)| found.distances[(r, c)] = all[0].1[a]);
            found.distances[(r, width - 1)] = d;
            if given.is_none() {
                continue;
            }
            // the rows of a normal are in the primitive's own axes
            let [first, second, _] = axes_along(normal);
            for (k, tangent) in [first, second].into_iter().enumerate() {
                let own = primitive.axes.map(|axis| dot(axis, tangent));
                let project = |of: &dyn Fn(usize) -> f64| (0..3).map(|k| own[k] * of(k)).sum::<f64>();
                let next = 2 * found.across.len() + k;
                for (c, &a) in free.iter().enumerate() {
                    found.tangential[(next, c)] = project(&|k| all[1 + k].1[a]);
                }
                found.tangential[(next, width - 1)] = project(&|k| all[1 + k].0);
            }
            found.across.push((r, [first, second].map(|tangent| over.along(primitive, foot, tangent))));
        }
        found
    }

    /// So many rows as there are distances and normals, by so many unknowns and the residual.
    pub(super) fn empty(over: DepartureOver, unknowns: usize, members: &[usize], sample: &BodySample) -> BaseRows {
        let normals = members.iter().filter(|i| sample.normal(**i).is_some()).count();
        BaseRows {
            over,
            places: Vec::with_capacity(members.len()),
            across: Vec::with_capacity(normals),
            distances: Mat::zeros(members.len(), unknowns + 1),
            tangential: Mat::zeros(2 * normals, unknowns + 1),
            sides: [0; 2],
            steepness: Mat::zeros(if over.is_small() { 0 } else { members.len() }, unknowns + 1),
            upward: Vec::new(),
        }
    }

    pub(super) fn count_side(&mut self, given: Option<Vector>, of_base: Vector) {
        if let Some(given) = given {
            self.sides[usize::from(dot(given, of_base) < 0.0)] += 1;
        }
    }

    /// Without a departure.
    pub(super) fn grams(&self) -> RowGrams {
        let of = [&self.distances, &self.tangential].map(|rows| dense::gram(rows.as_ref()));
        RowGrams { of, steepness: None, places: 0, reading: DepartureReading::Untold, process: None }
    }

    /// Where a departure may be carried: at the contacts, and on both sides of those whose normals tell slopes, if it is as large as the
    /// body. So many slopes are followed by so many more places.
    fn carriers(&self, aside: f64) -> Vec<Vector> {
        let sides = |(r, tangents): &(usize, [Vector; 2])| {
            let place = self.places[*r];
            tangents.map(|t| [along(place, aside, t), along(place, -aside, t)]).into_iter().flatten()
        };
        let told = self.across.iter().filter(|_| !self.over.is_small());
        self.places.iter().copied().chain(told.flat_map(sides)).collect()
    }

    /// With one of a length, carried by so many places at most, and with a broad one where it is as large as the body; `None` where its
    /// places do not carry it.
    pub(super) fn grams_with(
        &self,
        of: DepartureKernel,
        broad: Option<DepartureKernel>,
        most: usize,
    ) -> Option<RowGrams> {
        // of a place with one number of its own it is not told whether that is noise
        let numbers = self.distances.nrows() + self.tangential.nrows();
        if !self.over.is_small() && 2 * spread(&self.places, of.length, most).len() > numbers {
            return None;
        }
        let carriers = self.carriers(of.apart * of.length);
        let process = DepartureProcess::new(&carriers, self.over, of, most)?;
        let process = match broad {
            Some(broad) => process.beside_broad(&carriers, broad, most)?,
            None => process,
        };
        let places = process.len();
        let mut distances = beside(&self.distances, places);
        let mut tangential = beside(&self.tangential, places);
        for (r, place) in self.places.iter().enumerate() {
            process.values(*place).enumerate().for_each(|(c, v)| distances[(r, c)] = -v);
        }
        for (number, (r, tangents)) in self.across.iter().enumerate() {
            for (c, [a, b]) in process.slopes(self.places[*r], *tangents).enumerate() {
                (tangential[(2 * number, c)], tangential[(2 * number + 1, c)]) = (-a, -b);
            }
        }
        let mut steepness = beside(&self.steepness, places);
        for (r, upward) in self.upward.iter().enumerate() {
            for (c, [a, _]) in process.slopes(self.places[r], [*upward, *upward]).enumerate() {
                steepness[(r, c)] = -a;
            }
        }
        let carried = |rows: MatMut<'_, f64>| process.whiten(rows.subcols_mut(0, places));
        carried(distances.as_mut());
        carried(tangential.as_mut());
        carried(steepness.as_mut());
        let of = [distances, tangential].map(|rows| dense::gram(rows.as_ref()));
        let steepness = (!self.upward.is_empty()).then(|| dense::gram(steepness.as_ref()));
        let reading = match self.over {
            DepartureOver::Feet if self.across.is_empty() => DepartureReading::Untold,
            DepartureOver::Feet => DepartureReading::Followed,
            _ => DepartureReading::Shape,
        };
        Some(RowGrams { of, steepness, places, reading, process: Some(Arc::new(process)) })
    }
}

/// The rows with so many empty columns before them.
fn beside(rows: &Mat<f64>, places: usize) -> Mat<f64> {
    let mut wide = Mat::zeros(rows.nrows(), places + rows.ncols());
    wide.as_mut().subcols_mut(places, rows.ncols()).copy_from(rows);
    wide
}

impl RowGrams {
    /// Whether the departure is one of the section alone.
    pub(super) fn is_of_section(&self) -> bool {
        self.process.as_ref().is_some_and(|process| process.over == DepartureOver::Section)
    }

    /// Length of the departure.
    pub(super) fn length(&self) -> Option<f64> {
        self.process.as_ref().map(|process| process.kernel().length)
    }

    /// The same where normals do not follow the departure: they are those of the base alone, whose Gram matrices are given.
    pub(super) fn unfollowed(&self, base: &RowGrams) -> RowGrams {
        let [distances, normals] = &self.of;
        let mut alone = Mat::zeros(normals.nrows(), normals.ncols());
        let own = base.of[1].ncols();
        alone.as_mut().submatrix_mut(self.places, self.places, own, own).copy_from(&base.of[1]);
        RowGrams {
            of: [distances.clone(), alone],
            steepness: None,
            places: self.places,
            reading: DepartureReading::SensorError,
            process: self.process.clone(),
        }
    }

    /// Sum over the contacts of the squared departure, less what a move of the primitive takes up of it: the two trade where the departure is
    /// long, and only their sum is told.
    ///
    /// ```text
    /// |d|^2 - b' (J'J)^-1 b,   d = K w,  b = J'd      K, J: rows of distances by the departure's places and by the primitive's moves
    /// ```
    pub(super) fn departure_square(&self, solution: &[f64]) -> Option<f64> {
        let (places, weights) = (self.places, &solution[..self.places]);
        let product = |i: usize| self.of[0].col_as_slice(i).iter().zip(weights).map(|(g, w)| g * w).sum::<f64>();
        let square = weights.iter().enumerate().map(|(i, w)| w * product(i)).sum::<f64>();
        let moves: Vec<usize> = (places..solution.len()).collect();
        if moves.is_empty() {
            return Some(square);
        }
        let largest = moves.iter().map(|&i| self.of[0][(i, i)]).fold(0.0, f64::max);
        let of_moves = |i: usize, j: usize| {
            // what no distance tells stays where it is
            let held = if i == j { 1e-12 * largest + f64::MIN_POSITIVE } else { 0.0 };
            self.of[0][(moves[i], moves[j])] + held
        };
        let lower = dense::cholesky(&Mat::from_fn(moves.len(), moves.len(), of_moves))?;
        let mut taken: Vec<f64> = moves.iter().map(|&i| product(i)).collect();
        dense::forward_in_columns(&lower, &mut taken);
        Some((square - taken.iter().map(|t| t * t).sum::<f64>()).max(0.0))
    }
}
