//! A surface as a page shows it: a mesh with the shape at its corners, the control net, the contacts and what they miss by.
//!
//! ```text
//! mesh       n x m points Q with normals, S, R, u(S), u(R), support        numbered i m + j, as the maps are
//! contacts   P, residual, foot on the surface                              at most MOST_CONTACTS of them
//! ```

use crate::io::Input;
use palpate_geometry::contact::Contacts;

/// A place or a direction in the input's coordinates.
pub(crate) type Vector = [f64; 3];

/// Contacts that are drawn. One buffer of so many points is turned in every frame by any processor of today, and makes a
/// page of some 6 MB; of more, every so many-th is taken, and the page says so.
pub(super) const MOST_CONTACTS: usize = 300_000;

/// What is drawn of a surface.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceView {
    /// Names of the two directions of the maps: x, y of a height field, u, v of a surface in space.
    pub axes: [&'static str; 2],
    /// Coordinates of the maps' points along both directions.
    pub places: [Vec<f64>; 2],
    /// Corners of the mesh.
    pub points: Vec<Vector>,
    /// Unit normals to the free side; NaN where undefined.
    pub normals: Vec<Vector>,
    /// Shape index; NaN where undefined or without support.
    pub shape_index: Vec<f64>,
    /// Curvedness; NaN where undefined or without support.
    pub curvedness: Vec<f64>,
    /// Standard uncertainties of S and of R at the corners, where they are known.
    pub uncertainty: Option<[Vec<f64>; 2]>,
    /// What the uncertainties count, or why there are none.
    pub uncertainty_words: &'static str,
    /// Directions that close on themselves.
    pub closed: [bool; 2],
    /// Control points along both directions.
    pub net: ([usize; 2], Vec<Vector>),
    /// The contacts, where the page is about a fit of some.
    pub contacts: Option<ContactsView>,
    /// Upper end of the scale of R where the patch is flat: S is undefined then, and what is left of R is rounding or noise.
    pub flat: Option<f64>,
}

impl SurfaceView {
    /// Shows a patch that was found to be flat as one: without S, and R on a scale up to its upper bound.
    pub(super) fn flattened(mut self, most: f64) -> SurfaceView {
        /// R of rounding: the patch rises by a millionth of its size at most.
        const ROUNDING: f64 = 1e-6;
        self.shape_index.fill(f64::NAN);
        if let Some([s, _]) = &mut self.uncertainty {
            s.fill(f64::NAN);
        }
        let largest = self.curvedness.iter().copied().filter(|r| r.is_finite()).fold(most, f64::max);
        let span = |places: &Vec<f64>| places.first().zip(places.last()).map_or(0.0, |(lo, hi)| hi - lo);
        let size = self.places.iter().map(span).fold(0.0, f64::max);
        self.flat = Some(if size > 0.0 { largest.max(ROUNDING / size) } else { largest.max(f64::MIN_POSITIVE) });
        self
    }
}

/// Contacts and their residuals.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactsView {
    /// Contacts there are; fewer may be held here.
    pub all: usize,
    /// Where they are.
    pub points: Vec<Vector>,
    /// Where they are on the maps.
    pub places: Vec<[f64; 2]>,
    /// Unit normals, where they were measured.
    pub normals: Option<Vec<Vector>>,
    /// Signed distances from the surface, positive on the free side.
    pub residuals: Vec<f64>,
    /// The surface's points that they are measured from.
    pub feet: Vec<Vector>,
    /// Contacts that were set aside as not belonging to the surface.
    pub left_out: Vec<bool>,
    /// Along what residuals are measured.
    pub measured: &'static str,
}

/// Where a contact stands relative to the surface.
pub(super) struct Standing {
    /// On the maps.
    pub place: [f64; 2],
    /// The surface's point.
    pub foot: Vector,
    /// Signed distance.
    pub residual: f64,
    /// It was set aside.
    pub left_out: bool,
}

impl ContactsView {
    /// Contacts of an input, at most [`MOST_CONTACTS`], each with its number; `standing` says where it stands.
    pub(super) fn new(
        input: &Input,
        measured: &'static str,
        standing: impl Fn(usize, Vector) -> Standing,
    ) -> ContactsView {
        let (all, taken) = taken(input);
        let mut view = ContactsView { all, measured, ..ContactsView::default() };
        let mut normals = Vec::new();
        for (number, point, normal) in taken {
            let here = standing(number, point);
            view.points.push(point);
            view.places.push(here.place);
            view.residuals.push(here.residual);
            view.feet.push(here.foot);
            view.left_out.push(here.left_out);
            normals.extend(normal);
        }
        view.normals = Some(normals).filter(|normals| !normals.is_empty() && normals.len() == view.points.len());
        view
    }

    /// Residuals of the contacts that belong to the surface.
    pub(super) fn belonging(&self) -> impl Iterator<Item = f64> + '_ {
        let both = self.residuals.iter().zip(&self.left_out);
        both.filter(|(residual, out)| !**out && residual.is_finite()).map(|(residual, _)| *residual)
    }
}

/// Number, place and unit normal of a contact.
type Touched = (usize, Vector, Option<Vector>);

/// How many contacts there are, and evenly chosen ones.
fn taken(input: &Input) -> (usize, Vec<Touched>) {
    match input {
        Input::Contacts(contacts) => {
            let all = contacts.len();
            (all, every(all).map(|r| (r, [contacts.x[r], contacts.y[r], contacts.z[r]], normal(contacts, r))).collect())
        }
        Input::Grid(grid) => {
            let pixels = grid.z.indexed_iter().filter(|(_, z)| z.is_finite()).map(|((i, j), z)| (i, j, *z));
            let pixels: Vec<(usize, usize, f64)> = pixels.collect();
            let touched = every(pixels.len()).map(|r| {
                let (i, j, z) = pixels[r];
                (r, [grid.x[i], grid.y[j], z], None)
            });
            (pixels.len(), touched.collect())
        }
    }
}

/// Unit normal of a contact, where it has one.
fn normal(contacts: &Contacts, r: usize) -> Option<Vector> {
    contacts.unit_normal(r).filter(|normal| normal.iter().all(|v| v.is_finite()))
}

/// Numbers up to `all`, evenly thinned where there are too many.
fn every(all: usize) -> impl Iterator<Item = usize> {
    let taken = all.min(MOST_CONTACTS);
    (0..taken).map(move |k| (k as u128 * all as u128 / taken as u128) as usize)
}

/// Values of a coarse grid, one row after another, between its points: `at` runs from 0 to 1 in both directions.
pub(super) fn between(values: &[f64], [n, m]: [usize; 2], at: [f64; 2]) -> f64 {
    let cell = |t: f64, count: usize| {
        let place = t.clamp(0.0, 1.0) * (count.max(1) - 1) as f64;
        let below = (place.floor() as usize).min(count.saturating_sub(2));
        (below, place - below as f64)
    };
    let ((i, s), (j, t)) = (cell(at[0], n), cell(at[1], m));
    let value =
        |i: usize, j: usize| values.get(i.min(n.max(1) - 1) * m + j.min(m.max(1) - 1)).copied().unwrap_or(f64::NAN);
    let along = |i: usize| (1.0 - t) * value(i, j) + if t > 0.0 { t * value(i, j + 1) } else { 0.0 };
    (1.0 - s) * along(i) + if s > 0.0 { s * along(i + 1) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_between_is_interpolated() {
        let values = [0.0, 1.0, 2.0, 10.0, 11.0, 12.0];
        for (at, expected) in [([0.0, 0.0], 0.0), ([1.0, 1.0], 12.0), ([0.5, 0.25], 5.5), ([0.25, 1.0], 4.5)] {
            assert!((between(&values, [2, 3], at) - expected).abs() < 1e-12, "{at:?}");
        }
        assert!(between(&[], [0, 0], [0.5, 0.5]).is_nan());
    }

    #[test]
    fn too_many_contacts_are_thinned_evenly() {
        let chosen: Vec<usize> = every(3 * MOST_CONTACTS).collect();
        assert_eq!((chosen.len(), chosen[1], *chosen.last().unwrap()), (MOST_CONTACTS, 3, 3 * MOST_CONTACTS - 3));
        assert_eq!((every(0).count(), every(7).last()), (0, Some(6)));
    }
}
