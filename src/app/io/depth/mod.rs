//! A perspective depth image: how far away along the viewing axis the surface is, at every pixel (u, v).
//!
//! ```text
//! x = (u - cx) d / fx     y = (v - cy) d / fy     z = d = scale * stored        0, NaN or infinite: no measurement
//! ```
//!
//! Coordinates are the camera's: x to the right, y down, z forward, the camera at the origin. Images are indexed [v, u], row
//! by row from the top, as NumPy and PNG have them. R. Hartley and A. Zisserman, *Multiple View Geometry*, 2nd ed., ch. 6.

mod intrinsics;
mod png;

use crate::io::columns::{Column, Columns, Need};
use crate::io::place::{Runs, Unit};
use crate::io::{IoError, ReadOptions, Reading};

pub(crate) use intrinsics::Intrinsics;
pub(super) use png::read_png;

/// Stored depths, row by row from the top.
#[derive(Debug, PartialEq)]
pub(super) struct DepthImage {
    pub(super) width: usize,
    pub(super) stored: Vec<f64>,
}

impl DepthImage {
    /// Of an array [v, u]; `None` where it is not 2-D.
    pub(super) fn of_array(shape: &[usize], fortran_order: bool, values: &[f64]) -> Option<DepthImage> {
        let &[height, width] = shape else { return None };
        let at = |pixel: usize| if fortran_order { (pixel % width) * height + pixel / width } else { pixel };
        Some(DepthImage { width, stored: (0..width * height).map(|pixel| values[at(pixel)]).collect() })
    }
}

/// Contacts of all pixels that hold a measurement.
pub(super) fn read(
    file: &str,
    image: &DepthImage,
    intrinsics: &Intrinsics,
    options: &ReadOptions,
) -> Result<Reading, IoError> {
    let Intrinsics { focal, centre, scale } = *intrinsics;
    let (mut x, mut y, mut z) = (Vec::new(), Vec::new(), Vec::new());
    let mut pixels = Runs::default();
    for (pixel, &stored) in image.stored.iter().enumerate() {
        if !(stored.is_finite() && stored > 0.0) {
            continue;
        }
        let (u, v, d) = ((pixel % image.width) as f64, (pixel / image.width) as f64, scale * stored);
        x.push((u - centre[0]) * d / focal[0]);
        y.push((v - centre[1]) * d / focal[1]);
        z.push(d);
        pixels.push(pixel);
    }
    let missing = image.stored.len() - z.len();
    let mut columns = Columns::named(file, &["x", "y", "z"], Need::Contacts)?;
    for (column, values) in [(Column::X, x), (Column::Y, y), (Column::Z, z)] {
        columns.set(column, values);
    }
    let mut reading = columns.into_reading(file, (pixels, Unit::Pixel), options)?;
    reading.viewpoint = Some([0.0; 3]);
    reading.notes.push("depth image: x to the right, y down, z forward, the camera at the origin".into());
    if missing > 0 {
        reading.notes.push(format!("{missing} pixels without a measurement left out"));
    }
    Ok(reading)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{Input, Place};

    #[test]
    fn pixels_become_places_before_the_camera() {
        let image = DepthImage { width: 3, stored: vec![0.0, 1000.0, f64::NAN, 2000.0, 0.0, 500.0] };
        let intrinsics = Intrinsics { focal: [2.0, 4.0], centre: [1.0, 0.0], scale: 0.001 };
        let reading = read("f", &image, &intrinsics, &ReadOptions::default()).unwrap();
        assert_eq!(reading.viewpoint, Some([0.0; 3]));
        assert_eq!(reading.places.as_ref().unwrap().of(2), Place::Pixel(5));
        let Input::Contacts(c) = reading.input else { panic!("a grid") };
        assert_eq!((c.x, c.y, c.z), (vec![0.0, -1.0, 0.25], vec![0.0, 0.5, 0.125], vec![1.0, 2.0, 0.5]));
    }
}
