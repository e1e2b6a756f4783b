//! Scattered contacts, one entry per contact in every column (structure of arrays).

use super::ContactError;
use palpate_numeric::vector::unit_rescaled;

/// How the surface lies at each contact: its normals or its slopes, if they are known.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Orientation {
    /// Positions only.
    #[default]
    None,
    /// Outward normals of any length but zero, towards the free side.
    Normals {
        /// x component.
        nx: Vec<f64>,
        /// y component.
        ny: Vec<f64>,
        /// z component.
        nz: Vec<f64>,
    },
    /// Slopes `zx = dz/dx`, `zy = dz/dy`.
    Slopes {
        /// dz/dx.
        zx: Vec<f64>,
        /// dz/dy.
        zy: Vec<f64>,
    },
}

/// Per-contact weights that multiply the weights of their blocks (residuals, not squares). `None` is all ones.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactWeights {
    /// Of the height rows. All zero: slopes only.
    pub z: Option<Vec<f64>>,
    /// Of the x-slope rows (with normals: of the normal's rows, where `x` and `y` must be equal or one absent).
    pub x: Option<Vec<f64>>,
    /// Of the y-slope rows.
    pub y: Option<Vec<f64>>,
}

/// Contacts at any places: `g` entries in every column, lengths in one unit of the user's choice.
///
/// ```
/// # use palpate_geometry::facade as palpate;
/// use palpate::Contacts;
///
/// let points = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.9], [0.0, 1.0, 0.9]];
/// let normals = [[0.0, 0.0, 1.0], [0.2, 0.0, 1.0], [0.0, 0.2, 1.0]];
/// let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
/// assert_eq!((contacts.len(), contacts.z[1]), (3, 0.9));
/// contacts.check()?;
/// # Ok::<(), palpate::ContactError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Contacts {
    /// Positions, input units.
    pub x: Vec<f64>,
    /// Positions, input units.
    pub y: Vec<f64>,
    /// Heights, input units (ignored where the weight of the height row is zero).
    pub z: Vec<f64>,
    /// Normals, slopes, or neither.
    pub orientation: Orientation,
    /// Which finger made the contact.
    pub finger: Option<Vec<u32>>,
    /// Station of the sweep that it was made at.
    pub station: Option<Vec<u32>>,
    /// Per-contact weights.
    pub weights: ContactWeights,
}

impl Contacts {
    /// Contacts with positions only; add normals or slopes with [`Contacts::with_normals`], [`Contacts::with_slopes`].
    pub fn from_positions(x: Vec<f64>, y: Vec<f64>, z: Vec<f64>) -> Contacts {
        Contacts { x, y, z, ..Contacts::default() }
    }

    /// Contacts with positions only, from points (x, y, z).
    pub fn from_points(points: &[[f64; 3]]) -> Contacts {
        let [x, y, z] = columns(points);
        Contacts::from_positions(x, y, z)
    }

    /// The same contacts with outward normals, one vector (nx, ny, nz) of any length but zero for each contact.
    pub fn with_normal_vectors(self, normals: &[[f64; 3]]) -> Contacts {
        let [nx, ny, nz] = columns(normals);
        self.with_normals(nx, ny, nz)
    }

    /// The same contacts with outward normals (any length but zero).
    pub fn with_normals(mut self, nx: Vec<f64>, ny: Vec<f64>, nz: Vec<f64>) -> Contacts {
        self.orientation = Orientation::Normals { nx, ny, nz };
        self
    }

    /// The same contacts with slopes dz/dx, dz/dy.
    pub fn with_slopes(mut self, zx: Vec<f64>, zy: Vec<f64>) -> Contacts {
        self.orientation = Orientation::Slopes { zx, zy };
        self
    }

    /// Number of contacts g.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are no contacts at all.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Checks lengths, finiteness, normals and weights. Every fit calls it first.
    ///
    /// # Errors
    /// The first fault found, column by column.
    pub fn check(&self) -> Result<(), ContactError> {
        if self.x.is_empty() {
            return Err(ContactError::Empty);
        }
        let mut columns: Vec<(&'static str, &[f64])> = vec![("x", &self.x), ("y", &self.y), ("z", &self.z)];
        match &self.orientation {
            Orientation::None => {}
            Orientation::Normals { nx, ny, nz } => columns.extend([("nx", &nx[..]), ("ny", ny), ("nz", nz)]),
            Orientation::Slopes { zx, zy } => columns.extend([("zx", &zx[..]), ("zy", zy)]),
        }
        for (column, values) in columns {
            self.check_length(column, values.len())?;
            if let Some(index) = values.iter().position(|v| !v.is_finite()) {
                return Err(ContactError::NotFinite { column, index, value: values[index] });
            }
        }
        self.check_normals()?;
        self.check_labels_and_weights()
    }

    fn check_length(&self, column: &'static str, found: usize) -> Result<(), ContactError> {
        let expected = self.x.len();
        if found == expected { Ok(()) } else { Err(ContactError::Length { column, found, expected }) }
    }

    fn check_normals(&self) -> Result<(), ContactError> {
        if let Orientation::Normals { nx, ny, nz } = &self.orientation {
            for index in 0..nx.len() {
                if nx[index] == 0.0 && ny[index] == 0.0 && nz[index] == 0.0 {
                    return Err(ContactError::ZeroNormal { index });
                }
            }
        }
        Ok(())
    }

    fn check_labels_and_weights(&self) -> Result<(), ContactError> {
        for (column, labels) in [("finger", &self.finger), ("station", &self.station)] {
            if let Some(labels) = labels {
                self.check_length(column, labels.len())?;
            }
        }
        for (column, weights) in [("wz", &self.weights.z), ("wx", &self.weights.x), ("wy", &self.weights.y)] {
            if let Some(weights) = weights {
                self.check_length(column, weights.len())?;
                if let Some(index) = weights.iter().position(|w| !w.is_finite() || *w < 0.0) {
                    return Err(ContactError::Weight { column, index, value: weights[index] });
                }
            }
        }
        Ok(())
    }

    /// Unit normal of contact `r`, from its normal or its slopes; `None` for positions only.
    pub fn unit_normal(&self, r: usize) -> Option<[f64; 3]> {
        match &self.orientation {
            Orientation::None => None,
            Orientation::Normals { nx, ny, nz } => Some(unit_rescaled([nx[r], ny[r], nz[r]])),
            Orientation::Slopes { zx, zy } => Some(unit_rescaled([-zx[r], -zy[r], 1.0])),
        }
    }

    /// The same contacts in another order: the k-th is number `order[k]` here.
    ///
    /// # Panics
    /// When there is no contact of such a number.
    pub fn in_order(&self, order: &[u32]) -> Contacts {
        fn taken<T: Copy>(column: &[T], order: &[u32]) -> Vec<T> {
            order.iter().map(|&number| column[number as usize]).collect()
        }
        let optional = |column: &Option<Vec<f64>>| column.as_ref().map(|column| taken(column, order));
        let labels = |column: &Option<Vec<u32>>| column.as_ref().map(|column| taken(column, order));
        let orientation = match &self.orientation {
            Orientation::None => Orientation::None,
            Orientation::Normals { nx, ny, nz } => {
                Orientation::Normals { nx: taken(nx, order), ny: taken(ny, order), nz: taken(nz, order) }
            }
            Orientation::Slopes { zx, zy } => Orientation::Slopes { zx: taken(zx, order), zy: taken(zy, order) },
        };
        let ContactWeights { z, x, y } = &self.weights;
        Contacts {
            x: taken(&self.x, order),
            y: taken(&self.y, order),
            z: taken(&self.z, order),
            orientation,
            finger: labels(&self.finger),
            station: labels(&self.station),
            weights: ContactWeights { z: optional(z), x: optional(x), y: optional(y) },
        }
    }

    /// The same contacts with every normal reversed; slopes and positions stay.
    pub fn with_flipped_normals(mut self) -> Contacts {
        if let Orientation::Normals { nx, ny, nz } = &mut self.orientation {
            for column in [nx, ny, nz] {
                column.iter_mut().for_each(|v| *v = -*v);
            }
        }
        self
    }
}

/// Columns of an array of vectors.
fn columns(vectors: &[[f64; 3]]) -> [Vec<f64>; 3] {
    [0, 1, 2].map(|k| vectors.iter().map(|v| v[k]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_become_columns_and_ragged_normals_are_named() {
        let contacts = Contacts::from_points(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        assert_eq!(contacts, Contacts::from_positions(vec![1.0, 4.0], vec![2.0, 5.0], vec![3.0, 6.0]));
        let ragged = contacts.with_normal_vectors(&[[0.0, 0.0, 1.0]]).check();
        assert_eq!(ragged, Err(ContactError::Length { column: "nx", found: 1, expected: 2 }));
    }

    #[test]
    fn another_order_takes_every_column_along() {
        let contacts = Contacts::from_positions(vec![0.9, 0.1, 0.8], vec![0.5; 3], vec![1.0, 2.0, 3.0])
            .with_slopes(vec![7.0; 3], vec![8.0, 9.0, 10.0]);
        let weights = ContactWeights { z: Some(vec![1.0, 0.0, 2.0]), ..ContactWeights::default() };
        let sorted = Contacts { station: Some(vec![4, 5, 6]), weights, ..contacts }.in_order(&[1, 0, 2]);
        assert_eq!((sorted.x, sorted.y, sorted.z), (vec![0.1, 0.9, 0.8], vec![0.5; 3], vec![2.0, 1.0, 3.0]));
        assert_eq!((sorted.station, sorted.finger), (Some(vec![5, 4, 6]), None));
        assert_eq!(sorted.weights, ContactWeights { z: Some(vec![0.0, 1.0, 2.0]), ..ContactWeights::default() });
        assert_eq!(sorted.orientation, Orientation::Slopes { zx: vec![7.0; 3], zy: vec![9.0, 8.0, 10.0] });
    }
}
