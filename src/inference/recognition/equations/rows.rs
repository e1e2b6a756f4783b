//! What was measured as linear equations about the fitted models: residuals y, Jacobians J, displacement columns Z.
//!
//! ```text
//! positions  y = d(theta; C),        J = dd/dtheta,         Z = -basis              n rows
//! normals    y = (n - grad d) . t,   J = its derivative,    Z = slopes along t     2 n rows, t two tangents
//! one matrix [y_1 J_1 | .. | y_5 J_5 | Z] for all models, so that a covariance whitens them together
//! ```

use faer::Mat;

use crate::recognition::contacts::{CellNormals, Cells};
use crate::recognition::discrepancy::{Displacement, Quadratic};
use crate::recognition::kinds::{Kind, Model};
use palpate_numeric::vector::{dot, minus};

/// First of the general surface's curvatures among its unknowns.
pub(super) const CURVATURES: usize = 3;

/// Columns of all models side by side.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    pub(crate) positions: Mat<f64>,
    /// Both tangential parts of the normals, each with a row for every cell.
    pub(crate) normals: Option<[Mat<f64>; 2]>,
    pub(crate) columns: usize,
    /// First column and number of columns of every group of the displacement that stands together in some departure.
    pub(crate) groups: Vec<(usize, usize)>,
}

/// Column of a model's residuals; its Jacobian follows.
pub(crate) fn column_of(kind: Kind) -> usize {
    Kind::ALL.iter().take_while(|k| **k != kind).map(|k| 1 + k.unknowns()).sum()
}

/// First column of the displacement.
pub(crate) fn first_of_displacement() -> usize {
    Kind::ALL.iter().map(|k| 1 + k.unknowns()).sum()
}

impl Rows {
    pub(crate) fn new(cells: &Cells, models: &[Model], displacement: Option<&Displacement>) -> Rows {
        let n = cells.points.len();
        let first = first_of_displacement();
        let columns = first + displacement.map_or(0, Displacement::columns);
        let mut positions = Mat::<f64>::zeros(n, columns);
        let mut normals = cells.normals.as_ref().map(|_| Mat::<f64>::zeros(2 * n, columns));
        for model in models {
            fill(cells, model, column_of(model.kind()), &mut positions, normals.as_mut());
        }
        if let Some(displacement) = displacement {
            let z = &displacement.positions;
            (0..z.ncols()).for_each(|j| (0..n).for_each(|i| positions[(i, first + j)] = z[(i, j)]));
            if let (Some(normals), Some(z)) = (normals.as_mut(), &displacement.normals) {
                (0..z.ncols()).for_each(|j| (0..2 * n).for_each(|i| normals[(i, first + j)] = z[(i, j)]));
            }
        }
        let halves = normals.map(|all| [0, n].map(|start| all.as_ref().subrows(start, n).to_owned()));
        let groups = displacement.map_or_else(Vec::new, Displacement::groups);
        let groups = groups.into_iter().map(|(start, count)| (first + start, count)).collect();
        Rows { positions, normals: halves, columns, groups }
    }

    /// Lets the general surface's curvatures stand for quadratic displacements: over a plane its columns are exact so, however far its
    /// curvatures lie from those of a plane.
    pub(crate) fn bend_by(&mut self, quadratic: &Quadratic) {
        let (n, first) = (self.positions.nrows(), column_of(Kind::General) + 1 + CURVATURES);
        for j in 0..3 {
            (0..n).for_each(|i| self.positions[(i, first + j)] = quadratic.positions[(i, j)]);
            for (half, start) in self.normals.iter_mut().flatten().zip([0, n]) {
                let Some(slopes) = &quadratic.normals else { continue };
                (0..n).for_each(|i| half[(i, first + j)] = slopes[(start + i, j)]);
            }
        }
    }

    /// The models alone, without a displacement.
    pub(crate) fn of_models(&self) -> Rows {
        let columns = first_of_displacement();
        let own = |rows: &Mat<f64>| rows.as_ref().subcols(0, columns).to_owned();
        let normals = self.normals.as_ref().map(|halves| halves.each_ref().map(own));
        Rows { positions: own(&self.positions), normals, columns, groups: Vec::new() }
    }
}

/// Residuals and Jacobian of one model from column `at` on.
fn fill(cells: &Cells, model: &Model, at: usize, positions: &mut Mat<f64>, normals: Option<&mut Mat<f64>>) {
    let (y, yn) = residuals(cells, model);
    write(positions, at, &y);
    let mut normals = normals;
    if let Some(normals) = normals.as_deref_mut() {
        write(normals, at, &yn);
    }
    for (j, (ahead, behind, width)) in model.neighbours().into_iter().enumerate() {
        let ((a, an), (b, bn)) = (residuals(cells, &ahead), residuals(cells, &behind));
        let slope = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) / width).collect::<Vec<f64>>();
        write(positions, at + 1 + j, &slope(&a, &b));
        if let Some(normals) = normals.as_deref_mut() {
            write(normals, at + 1 + j, &slope(&an, &bn));
        }
    }
}

fn write(matrix: &mut Mat<f64>, column: usize, values: &[f64]) {
    values.iter().enumerate().for_each(|(i, v)| matrix[(i, column)] = *v);
}

/// Distances, and tangential differences of the normals where there are any.
fn residuals(cells: &Cells, model: &Model) -> (Vec<f64>, Vec<f64>) {
    let found: Vec<_> = cells.points.iter().map(|p| model.distance_and_normal(*p)).collect();
    let distances = found.iter().map(|(d, _)| *d).collect();
    let Some(CellNormals { measured, .. }) = &cells.normals else { return (distances, Vec::new()) };
    let part = |side: usize| {
        let tangents = &cells.tangents[side];
        let found = &found;
        (0..measured.len()).map(move |i| dot(minus(measured[i], found[i].1), tangents[i]))
    };
    (distances, part(0).chain(part(1)).collect())
}
