//! Heights (and slopes) on the product of two axes: `z[i, j] = z(x_i, y_j)`, never flattened.

use ndarray::Array2;

use super::ContactError;

/// A height map with optional slopes and weight maps. NaN in `z`, `zx` or `zy` means that this entry is missing.
#[derive(Clone, Debug, PartialEq)]
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

    /// Number of pixels, missing ones included.
    pub fn len(&self) -> usize {
        self.x.len() * self.y.len()
    }

    /// No pixels at all.
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
