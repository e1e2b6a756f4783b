//! The measured numbers in the patch frame, site by site, whichever kind of data they came as.
//!
//! ```text
//! contacts  (x, y, z), n = (nx, ny, nz) or (zx, zy)       grid  z - origin over scale, zx, zy
//! ```

use ndarray::Array2;

use palpate_geometry::contact::{Contacts, Grid, Orientation};
use palpate_numeric::linalg::{RowWeights, SiteWeights, Targets};

/// Contacts or a grid in patch coordinates.
#[derive(Clone, Debug)]
pub enum Data {
    /// Scattered contacts, moved into the patch.
    Scattered {
        /// The contacts.
        contacts: Contacts,
        /// The number each has in the user's order, where they were sorted by knot cells.
        numbers: Option<Vec<u32>>,
    },
    /// A grid in input units, with the patch's height origin and length.
    Gridded {
        /// The grid.
        grid: Grid,
        /// Height origin.
        origin: f64,
        /// Length.
        scale: f64,
    },
}

/// The measured numbers of one site; weight zero means missing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Datum {
    /// Height in the patch.
    pub z: f64,
    /// Weight of the height row.
    pub z_weight: f64,
    /// Unit normal.
    pub normal: [f64; 3],
    /// Weight of the normal.
    pub normal_weight: f64,
}

/// The measured numbers, made site by site where they are asked for.
pub(crate) struct Readings<'a> {
    data: &'a Data,
    row_weights: RowWeights,
    targets: Targets,
}

impl Readings<'_> {
    /// Those of one site.
    #[inline]
    pub(crate) fn at(&self, r: usize) -> Datum {
        let ((z, z_weight), m) = (self.height(r), self.row_weights.at(r));
        let (normal, normal_weight) = self.data.normal_and_weight(r, &m, &self.targets[r]);
        Datum { z, z_weight, normal, normal_weight }
    }

    /// Height in the patch and the weight of its row.
    #[inline]
    pub(crate) fn height(&self, r: usize) -> (f64, f64) {
        let weight = self.row_weights.at(r).z;
        (if weight == 0.0 { 0.0 } else { self.targets[r][0] / weight }, weight)
    }

    /// Slopes in x and y of a site whose slope rows count.
    #[inline]
    pub(crate) fn slopes(&self, r: usize) -> Option<[f64; 2]> {
        let m = self.row_weights.at(r);
        (m.a.min(m.d) != 0.0).then(|| [self.targets[r][1] / m.a, self.targets[r][2] / m.d])
    }
}

/// Heights and unit normals with their row weights; weight zero means missing.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// Heights in the patch.
    pub z: Vec<f64>,
    /// Weights of the height rows.
    pub z_weight: Vec<f64>,
    /// Unit normals.
    pub normals: Vec<[f64; 3]>,
    /// Weights of the normals.
    pub normal_weight: Vec<f64>,
}

impl Data {
    /// Whether there are slopes or normals.
    pub(crate) fn has_orientation(&self) -> bool {
        match self {
            Data::Scattered { contacts, .. } => contacts.orientation != Orientation::None,
            Data::Gridded { grid, .. } => grid.zx.is_some(),
        }
    }

    /// Whether there are normals, not only slopes.
    pub(crate) fn has_normals(&self) -> bool {
        matches!(self, Data::Scattered { contacts: Contacts { orientation: Orientation::Normals { .. }, .. }, .. })
    }

    /// Heights and unit normals for normal rows.
    pub(crate) fn measured(&self) -> Measured {
        let readings = self.readings();
        let count = readings.targets.len();
        let room = || Vec::with_capacity(count);
        let mut measured =
            Measured { z: room(), z_weight: room(), normals: Vec::with_capacity(count), normal_weight: room() };
        for r in 0..count {
            let Datum { z, z_weight, normal, normal_weight } = readings.at(r);
            measured.z.push(z);
            measured.z_weight.push(z_weight);
            measured.normals.push(normal);
            measured.normal_weight.push(normal_weight);
        }
        measured
    }

    /// Heights and unit normals, site by site.
    pub(crate) fn readings(&self) -> Readings<'_> {
        let (row_weights, targets) = self.slope_rows([1.0, 1.0, 1.0]);
        Readings { data: self, row_weights, targets }
    }

    fn normal_and_weight(&self, r: usize, m: &SiteWeights, target: &[f64; 3]) -> ([f64; 3], f64) {
        let weight = m.a.min(m.d);
        if weight == 0.0 {
            return ([0.0, 0.0, 1.0], 0.0);
        }
        let normal = match self {
            Data::Scattered { contacts, .. } => contacts.unit_normal(r),
            Data::Gridded { .. } => {
                let (p, q) = (target[1] / m.a, target[2] / m.d);
                let w = p.hypot(q).hypot(1.0);
                Some([-p / w, -q / w, 1.0 / w])
            }
        };
        normal.map_or(([0.0, 0.0, 1.0], 0.0), |n| (n, weight))
    }

    /// The same data with every site's height rows weighted by `z[r]` and its slope rows by `slope[r]` on top.
    pub(crate) fn reweighted(&self, z: &[f64], slope: &[f64]) -> Data {
        let mut data = self.clone();
        let times = |old: &Option<Vec<f64>>, new: &[f64]| -> Option<Vec<f64>> {
            Some(new.iter().enumerate().map(|(r, w)| w * old.as_ref().map_or(1.0, |o| o[r])).collect())
        };
        match &mut data {
            Data::Scattered { contacts, .. } => {
                let old = contacts.weights.clone();
                contacts.weights.z = times(&old.z, z);
                contacts.weights.x = times(&old.x, slope);
                contacts.weights.y = times(&old.y, slope);
            }
            Data::Gridded { grid, .. } => {
                let columns = grid.y.len();
                let map = |old: &Option<Array2<f64>>, new: &[f64]| {
                    Some(Array2::from_shape_fn((grid.x.len(), columns), |(i, j)| {
                        new[i * columns + j] * old.as_ref().map_or(1.0, |o| o[[i, j]])
                    }))
                };
                let (wz, wx, wy) = (map(&grid.wz, z), map(&grid.wx, slope), map(&grid.wy, slope));
                (grid.wz, grid.wx, grid.wy) = (wz, wx, wy);
            }
        }
        data
    }

    /// Root of the sum of squares of the heights whose weight is not zero, in patch units.
    pub(crate) fn size_of_heights(&self) -> f64 {
        let sum: f64 = match self {
            Data::Scattered { contacts, .. } => match &contacts.weights.z {
                None => contacts.z.iter().map(|z| z * z).sum(),
                Some(weights) => contacts.z.iter().zip(weights).filter(|(_, w)| **w != 0.0).map(|(z, _)| z * z).sum(),
            },
            Data::Gridded { .. } => {
                let readings = self.readings();
                let heights = (0..readings.targets.len()).map(|r| readings.height(r));
                heights.filter(|(_, w)| *w != 0.0).map(|(z, _)| z * z).sum()
            }
        };
        sum.sqrt()
    }
}
