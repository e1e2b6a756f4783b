//! Heights (and slopes) on the product of two axes: `z[i, j] = z(x_i, y_j)`, never flattened.

use ndarray::{Array2, ArrayView2};

use super::ContactError;

/// A height map with optional slopes and weight maps. NaN in `z`, `zx` or `zy` means that this entry is missing.
///
/// ```
/// # use palpate_geometry::facade as palpate;
/// use ndarray::Array2;
/// use palpate::Grid;
///
/// let (x, y) = ([0.0, 1.0, 2.0], [0.0, 0.5]);
/// // single-precision heights, indexed [x, y]
/// let z = Array2::from_shape_fn((3, 2), |(i, j)| (i + j) as f32);
/// let grid = Grid::from_view(&x, &y, z.view());
/// assert_eq!((grid.len(), grid.z[[2, 1]]), (6, 3.0));
/// grid.check()?;
/// # Ok::<(), palpate::ContactError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(into = "saved::SavedGrid", try_from = "saved::SavedGrid"))]
pub struct Grid {
    /// Increasing axis, n entries, input units.
    pub x: Vec<f64>,
    /// Increasing axis, m entries, input units.
    pub y: Vec<f64>,
    /// Heights, n x m.
    pub z: Array2<f64>,
    /// dz/dx, n x m.
    pub zx: Option<Array2<f64>>,
    /// dz/dy, n x m.
    pub zy: Option<Array2<f64>>,
    /// Weight maps: of heights, x slopes, y slopes; they multiply the weights of their blocks.
    pub wz: Option<Array2<f64>>,
    /// Weights of the x-slope rows.
    pub wx: Option<Array2<f64>>,
    /// Weights of the y-slope rows.
    pub wy: Option<Array2<f64>>,
}

impl Grid {
    /// A grid of heights alone.
    pub fn new(x: Vec<f64>, y: Vec<f64>, z: Array2<f64>) -> Grid {
        Grid { x, y, z, zx: None, zy: None, wz: None, wx: None, wy: None }
    }

    /// A grid of heights alone, copied from a view of `f32` or `f64` in any memory order, indexed [x, y].
    pub fn from_view<T: Into<f64> + Copy>(x: &[f64], y: &[f64], z: ArrayView2<'_, T>) -> Grid {
        Grid::new(x.to_vec(), y.to_vec(), z.mapv(Into::into))
    }

    /// The same grid with slopes dz/dx and dz/dy, copied from views.
    pub fn with_slope_views<T: Into<f64> + Copy>(self, zx: ArrayView2<'_, T>, zy: ArrayView2<'_, T>) -> Grid {
        Grid { zx: Some(zx.mapv(Into::into)), zy: Some(zy.mapv(Into::into)), ..self }
    }

    /// Number of pixels, missing ones included.
    pub fn len(&self) -> usize {
        self.x.len() * self.y.len()
    }

    /// Whether there are no pixels at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Checks axes, shapes, infinities and weights.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), ContactError> {
        if self.is_empty() {
            return Err(ContactError::Empty);
        }
        check_axis("x", &self.x)?;
        check_axis("y", &self.y)?;
        let named = [
            ("z", Some(&self.z)),
            ("zx", self.zx.as_ref()),
            ("zy", self.zy.as_ref()),
            ("wz", self.wz.as_ref()),
            ("wx", self.wx.as_ref()),
            ("wy", self.wy.as_ref()),
        ];
        for (array, values) in named {
            if let Some(values) = values {
                self.check_array(array, values)?;
            }
        }
        match (&self.zx, &self.zy) {
            (Some(_), None) => Err(ContactError::HalfSlopes { present: "zx", missing: "zy" }),
            (None, Some(_)) => Err(ContactError::HalfSlopes { present: "zy", missing: "zx" }),
            _ => Ok(()),
        }
    }

    fn check_array(&self, array: &'static str, values: &Array2<f64>) -> Result<(), ContactError> {
        let expected = [self.x.len(), self.y.len()];
        let found = [values.nrows(), values.ncols()];
        if found != expected {
            return Err(ContactError::Shape { array, found, expected });
        }
        let is_weight = array.starts_with('w');
        for (index, &value) in values.iter().enumerate() {
            if is_weight && (!value.is_finite() || value < 0.0) {
                return Err(ContactError::Weight { column: array, index, value });
            }
            if value.is_infinite() {
                return Err(ContactError::NotFinite { column: array, index, value });
            }
        }
        Ok(())
    }
}

fn check_axis(axis: &'static str, values: &[f64]) -> Result<(), ContactError> {
    for (index, &value) in values.iter().enumerate() {
        if !value.is_finite() {
            return Err(ContactError::NotFinite { column: axis, index, value });
        }
        if index > 0 && value <= values[index - 1] {
            return Err(ContactError::AxisOrder { axis, index, before: values[index - 1], after: value });
        }
    }
    Ok(())
}

/// The serialised form: arrays as nested rows, a missing entry as none.
#[cfg(feature = "serde")]
mod saved {
    use ndarray::Array2;

    use super::{ContactError, Grid};

    type Rows = Vec<Vec<Option<f64>>>;

    #[derive(serde::Serialize, serde::Deserialize)]
    pub(super) struct SavedGrid {
        x: Vec<f64>,
        y: Vec<f64>,
        z: Rows,
        zx: Option<Rows>,
        zy: Option<Rows>,
        wz: Option<Rows>,
        wx: Option<Rows>,
        wy: Option<Rows>,
    }

    fn rows(array: &Array2<f64>) -> Rows {
        array.rows().into_iter().map(|row| row.iter().map(|v| (!v.is_nan()).then_some(*v)).collect()).collect()
    }

    fn array(name: &'static str, rows: Rows, expected: [usize; 2]) -> Result<Array2<f64>, ContactError> {
        let columns = rows.iter().map(Vec::len).find(|m| *m != expected[1]).unwrap_or(expected[1]);
        let found = [rows.len(), columns];
        let flat = rows.into_iter().flatten().map(|v| v.unwrap_or(f64::NAN)).collect();
        (Array2::from_shape_vec((found[0], found[1]), flat).ok().filter(|_| found == expected))
            .ok_or(ContactError::Shape { array: name, found, expected })
    }

    impl From<Grid> for SavedGrid {
        fn from(grid: Grid) -> SavedGrid {
            let optional = |array: Option<Array2<f64>>| array.as_ref().map(rows);
            let Grid { x, y, z, zx, zy, wz, wx, wy } = grid;
            SavedGrid {
                x,
                y,
                z: rows(&z),
                zx: optional(zx),
                zy: optional(zy),
                wz: optional(wz),
                wx: optional(wx),
                wy: optional(wy),
            }
        }
    }

    impl TryFrom<SavedGrid> for Grid {
        type Error = ContactError;

        fn try_from(saved: SavedGrid) -> Result<Grid, ContactError> {
            let expected = [saved.x.len(), saved.y.len()];
            let optional = |name, rows: Option<Rows>| rows.map(|rows| array(name, rows, expected)).transpose();
            let grid = Grid {
                z: array("z", saved.z, expected)?,
                zx: optional("zx", saved.zx)?,
                zy: optional("zy", saved.zy)?,
                wz: optional("wz", saved.wz)?,
                wx: optional("wx", saved.wx)?,
                wy: optional("wy", saved.wy)?,
                x: saved.x,
                y: saved.y,
            };
            grid.check()?;
            Ok(grid)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_of_either_type_and_order_make_the_same_grid() {
        let (x, y) = ([0.0, 1.0, 2.0], [0.0, 0.5]);
        let z = Array2::from_shape_fn((3, 2), |(i, j)| (2 * i + j) as f64);
        let grid = Grid::from_view(&x, &y, z.view()).with_slope_views(z.view(), z.view());
        assert_eq!(grid.check(), Ok(()));
        let by_columns = z.t().as_standard_layout().to_owned();
        let single = z.mapv(|v| v as f32);
        assert_eq!(Grid::from_view(&x, &y, by_columns.t()), Grid::new(x.to_vec(), y.to_vec(), z.clone()));
        assert_eq!(Grid::from_view(&x, &y, single.view()).z, z);
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serialised_grids_come_back_and_faulty_ones_do_not() {
        let mut z = Array2::from_shape_fn((3, 2), |(i, j)| (2 * i + j) as f64);
        z[[1, 1]] = f64::NAN;
        let grid = Grid::from_view(&[0.0, 1.0, 2.0], &[0.0, 0.5], z.view());
        let text = serde_json::to_string(&grid).unwrap();
        let back: Grid = serde_json::from_str(&text).unwrap();
        assert!(back.z[[1, 1]].is_nan() && back.z[[2, 1]] == 5.0 && back.x == grid.x);
        let unordered = text.replace("[0.0,1.0,2.0]", "[0.0,1.0,1.0]");
        assert!(serde_json::from_str::<Grid>(&unordered).unwrap_err().to_string().contains("does not increase"));
        let ragged = text.replace("[4.0,5.0]", "[4.0]");
        assert!(serde_json::from_str::<Grid>(&ragged).unwrap_err().to_string().contains("but the axes"));
    }
}
