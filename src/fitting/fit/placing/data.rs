//! From contacts or a grid to data in the patch and their sites under its knots, and what of them a fit must refuse.
//!
//! ```text
//! (x, y) = (X - origin)/scale       slope rows need nz > 0 and |n_xy / nz| < 1e8, normal rows nz >= 0
//! ```

use crate::fit::FitError;
use crate::fit::placing::Patch;
use crate::fit::placing::sites::DataSites;
use crate::observation::{CellNumbers, Data, GridSites, ScatteredSites};
use palpate_geometry::contact::{ContactWeights, Contacts, Grid, Orientation};

fn points(contacts: &Contacts) -> Vec<[f64; 2]> {
    contacts.x.iter().zip(&contacts.y).map(|(x, y)| [*x, *y]).collect()
}

impl Data {
    /// Contacts in patch coordinates. Many contacts are sorted by knot cells once, because the cells are visited many times
    /// and reading contacts in the user's order would jump through memory at every visit.
    pub(crate) fn scattered(contacts: Contacts, patch: &Patch) -> Data {
        if !ScatteredSites::worth_packing(contacts.len(), &patch.knots) {
            return Data::Scattered { contacts, numbers: None };
        }
        let CellNumbers { order, .. } = CellNumbers::of(&patch.knots, &points(&contacts));
        Data::Scattered { contacts: contacts.in_order(&order), numbers: Some(order) }
    }

    /// Where the data lie under the patch's knots.
    pub(crate) fn sites(&self, patch: &Patch) -> DataSites {
        match self {
            Data::Scattered { contacts, .. } => {
                DataSites::Scattered(ScatteredSites::new(patch.knots.clone(), points(contacts)))
            }
            Data::Gridded { grid, .. } => {
                let [ox, oy, _] = patch.frame.origin;
                let local =
                    |axis: &[f64], o: f64| -> Vec<f64> { axis.iter().map(|v| (v - o) / patch.frame.scale).collect() };
                DataSites::Gridded(GridSites::new(patch.knots.clone(), &local(&grid.x, ox), &local(&grid.y, oy)))
            }
        }
    }

    /// The sites whose heights count as contacts in patch coordinates, `most` of them or a few more, spread evenly; `None`
    /// without heights.
    pub(crate) fn contacts_in_patch(&self, patch: &Patch, most: usize) -> Option<Contacts> {
        let found = match self {
            Data::Scattered { contacts, .. } => {
                let counts = |r: &u32| contacts.weights.z.as_ref().is_none_or(|w| w[*r as usize] != 0.0);
                let order: Vec<u32> = (0..contacts.len() as u32).filter(counts).collect();
                let order: Vec<u32> = order.iter().copied().step_by(order.len().div_ceil(most).max(1)).collect();
                Contacts { weights: ContactWeights::default(), ..contacts.in_order(&order) }
            }
            Data::Gridded { grid, origin, scale } => {
                pixels(grid, [patch.frame.origin[0], patch.frame.origin[1], *origin], *scale, most)
            }
        };
        (!found.is_empty()).then_some(found)
    }

    /// Every normal must have a slope: nz > 0, and finite after division.
    ///
    /// # Errors
    /// [`FitError::NormalDown`], [`FitError::Steep`].
    pub(crate) fn check_slopes(&self) -> Result<(), FitError> {
        self.check_each_normal(|[nx, ny, nz]| {
            // beyond 1e8 the square of one slope is larger than all other rows' squares times 1e16, and their digits are lost
            nz >= 0.0 && [nx / nz, ny / nz].iter().all(|s| s.is_finite() && s.abs() < 1e8)
        })
    }

    /// Every normal must belong to a height field's free side: nz >= 0.
    ///
    /// # Errors
    /// [`FitError::NormalDown`].
    pub(crate) fn check_normals(&self) -> Result<(), FitError> {
        self.check_each_normal(|[_, _, nz]| nz >= 0.0)
    }

    /// The user's first normal that is not sound, as an error.
    fn check_each_normal(&self, is_sound: impl Fn([f64; 3]) -> bool) -> Result<(), FitError> {
        let Data::Scattered { contacts, numbers } = self else { return Ok(()) };
        let Orientation::Normals { nx, ny, nz } = &contacts.orientation else { return Ok(()) };
        let number = |r: usize| numbers.as_ref().map_or(r, |numbers| numbers[r] as usize);
        let unsound = (0..nz.len()).filter(|&r| !is_sound([nx[r], ny[r], nz[r]]));
        let Some(first) = unsound.min_by_key(|&r| number(r)) else { return Ok(()) };
        let (index, nz) = (number(first), nz[first]);
        Err(if nz < 0.0 { FitError::NormalDown { index, nz } } else { FitError::Steep { index, nz } })
    }

    /// Largest magnitude of a height in input units: the rounding of the data as given is proportional to it.
    pub(crate) fn largest_height(&self, patch: &Patch) -> f64 {
        let largest =
            |v: &mut dyn Iterator<Item = f64>| v.filter(|z| z.is_finite()).fold(0.0_f64, |m, z| m.max(z.abs()));
        match self {
            Data::Scattered { contacts, .. } => {
                let origin = if patch.frame.keeps_axes() { patch.frame.origin[2] } else { 0.0 };
                largest(&mut contacts.z.iter().map(|z| origin + z * patch.frame.scale))
            }
            Data::Gridded { grid, .. } => largest(&mut grid.z.iter().copied()),
        }
    }
}

/// Pixels of a lattice of a grid as contacts about `origin` in units of `scale`; slopes are kept where all are known.
fn pixels(grid: &Grid, origin: [f64; 3], scale: f64, most: usize) -> Contacts {
    let side = ((grid.z.len() as f64 / most as f64).sqrt().ceil() as usize).max(1);
    let chosen = grid.z.indexed_iter().filter(|((i, j), z)| {
        let weight = grid.wz.as_ref().map_or(1.0, |w| w[[*i, *j]]);
        i % side == 0 && j % side == 0 && !z.is_nan() && weight != 0.0
    });
    let places: Vec<[usize; 2]> = chosen.map(|((i, j), _)| [i, j]).collect();
    let column = |value: &dyn Fn(usize, usize) -> f64| places.iter().map(|&[i, j]| value(i, j)).collect::<Vec<f64>>();
    let local = |v: f64, k: usize| (v - origin[k]) / scale;
    let contacts = Contacts::from_positions(
        column(&|i, _| local(grid.x[i], 0)),
        column(&|_, j| local(grid.y[j], 1)),
        column(&|i, j| local(grid.z[[i, j]], 2)),
    );
    match (&grid.zx, &grid.zy) {
        (Some(zx), Some(zy)) if places.iter().all(|at| zx[*at].is_finite() && zy[*at].is_finite()) => {
            contacts.with_slopes(column(&|i, j| zx[[i, j]]), column(&|i, j| zy[[i, j]]))
        }
        _ => contacts,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{FitOptions, Method, NormalSigma, Objective, fit_contacts};

    /// Many contacts are reordered inside the fit; errors still name the user's own numbers.
    #[test]
    fn the_first_unsound_normal_keeps_its_number() {
        let count = 20_007;
        let at = |r: usize, step: f64| (r as f64 * step).fract();
        let (x, y): (Vec<f64>, Vec<f64>) = (0..count).map(|r| (at(r, 0.754_877_666), at(r, 0.569_840_291))).unzip();
        let z: Vec<f64> = x.iter().zip(&y).map(|(x, y)| x * y).collect();
        let mut nz = vec![1.0; count];
        (nz[999], nz[17_000]) = (-0.5, -0.25);
        let down = Contacts::from_positions(x, y, z).with_normals(vec![0.1; count], vec![0.0; count], nz);
        let options = FitOptions { segments: [8, 8], ..FitOptions::default() };
        let found = fit_contacts(&down, &options);
        assert!(matches!(found, Err(FitError::NormalDown { index: 999, .. })), "{found:?}");
    }

    /// The answer is the same for contacts in reverse order, and by QR of the rows.
    #[test]
    fn the_order_of_many_contacts_does_not_matter() {
        let count = 600;
        let at = |r: usize, step: f64| (r as f64 * step).fract();
        let (x, y): (Vec<f64>, Vec<f64>) = (0..count).map(|r| (at(r, 0.754_877_666), at(r, 0.569_840_291))).unzip();
        let z: Vec<f64> = x.iter().zip(&y).map(|(x, y)| (3.0 * x).sin() * y).collect();
        let (nx, ny) = (x.iter().map(|x| -0.3 * x).collect(), y.iter().map(|y| 0.2 * y).collect());
        let contacts = Contacts::from_positions(x, y, z).with_normals(nx, ny, vec![1.0; count]);
        let backwards: Vec<u32> = (0..count as u32).rev().collect();
        let objective = Objective::Normals(NormalSigma::Known { z: 0.01, normal_deg: 2.0 });
        let fit = |contacts: &Contacts, method: Method| {
            let options = FitOptions { degree: [3, 2], segments: [4, 4], objective, method, ..FitOptions::default() };
            let fit = fit_contacts(contacts, &options).unwrap();
            assert!(fit.equations().packed().is_some());
            fit.solution().coefficients.clone()
        };
        let expected = fit(&contacts, Method::Auto);
        let size = expected.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        for other in [fit(&contacts.in_order(&backwards), Method::Auto), fit(&contacts, Method::Qr)] {
            let gap = expected.iter().zip(&other).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(gap <= 1e-13 * size, "{gap:e} of {size:e}");
        }
    }
}
