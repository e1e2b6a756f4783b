//! The rows of contacts about one primitive, and their Gram matrices for a departure of some length.
//!
//! ```text
//! distance of contact i   d_i + J_i x - phi(q_i)' w                        J: by the primitive's free unknowns
//! its normal, along t     t . (g_i - n_i) + (t . G_i) x - phi_t(q_i)' w    t: two directions across the normal, phi_t: slope along t
//! columns                 w, x, residual
//! ```

use std::sync::Arc;

use faer::{Mat, MatMut};

use super::departure::{DepartureOver, DepartureProcess};
use super::mode::aligned;
use super::sample::BodySample;
use crate::dense;
use crate::primitives::descent::rows;
use crate::primitives::placed::Primitive;
use palpate_numeric::vector::{Vector, along, axes_along, dot};

/// Rows by the primitive's unknowns and the residual.
pub(super) struct BaseRows {
    over: DepartureOver,
    /// What the departure is a function of, at every contact.
    places: Vec<Vector>,
    /// Contacts with a normal, with two directions across it.
    across: Vec<(usize, [Vector; 2])>,
    distances: Mat<f64>,
    tangential: Mat<f64>,
}

/// Gram matrices over columns `w, x, residual`.
pub(super) struct RowGrams {
    /// Of distances and of normals.
    pub(super) of: [Mat<f64>; 2],
    /// Number of the columns w.
    pub(super) places: usize,
    /// What the columns w are those of.
    pub(super) process: Option<Arc<DepartureProcess>>,
}

impl BaseRows {
    /// Of the contacts that belong to a primitive.
    pub(super) fn new(primitive: &Primitive, members: &[usize], sample: &BodySample, over: DepartureOver) -> BaseRows {
        let free = primitive.kind.free();
        let width = free.len() + 1;
        let normals = members.iter().filter(|i| sample.normal(**i).is_some()).count();
        let mut found = BaseRows {
            over,
            places: Vec::with_capacity(members.len()),
            across: Vec::with_capacity(normals),
            distances: Mat::zeros(members.len(), width),
            tangential: Mat::zeros(2 * normals, width),
        };
        for (r, &i) in members.iter().enumerate() {
            let place = sample.points[i];
            let (d, normal) = primitive.nearest(place);
            let given = sample.normal(i).map(|n| aligned(n, normal));
            let all = rows(primitive, place, given.unwrap_or([0.0; 3]));
            found.places.push(match over {
                DepartureOver::Feet => along(place, -d, normal),
                DepartureOver::Space => place,
            });
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
            found.across.push((r, [first, second]));
        }
        found
    }

    /// Without a departure.
    pub(super) fn grams(&self) -> RowGrams {
        let of = [&self.distances, &self.tangential].map(|rows| dense::gram(rows.as_ref()));
        RowGrams { of, places: 0, process: None }
    }

    /// With one of a length, carried by so many places at most; `None` where its places do not carry it.
    pub(super) fn grams_with(&self, length: f64, most: usize) -> Option<RowGrams> {
        let process = DepartureProcess::new(&self.places, self.over, length, most)?;
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
        let carried = |rows: MatMut<'_, f64>| process.whiten(rows.subcols_mut(0, places));
        carried(distances.as_mut());
        carried(tangential.as_mut());
        let of = [distances, tangential].map(|rows| dense::gram(rows.as_ref()));
        Some(RowGrams { of, places, process: Some(Arc::new(process)) })
    }
}

/// The rows with so many empty columns before them.
fn beside(rows: &Mat<f64>, places: usize) -> Mat<f64> {
    let mut wide = Mat::zeros(rows.nrows(), places + rows.ncols());
    wide.as_mut().subcols_mut(places, rows.ncols()).copy_from(rows);
    wide
}
