//! A camera's intrinsics: focal lengths and centre in pixels, and the length of one unit of stored depth.

/// What turns a pixel and its depth into a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// fx, fy in pixels.
    pub focal: [f64; 2],
    /// cx, cy in pixels; (0, 0) is the middle of the first pixel.
    pub centre: [f64; 2],
    /// Length of one unit of stored depth.
    pub scale: f64,
}

impl Intrinsics {
    /// Of `fx, fy, cx, cy` and perhaps `scale`; `None` where they are no camera's.
    pub fn new(numbers: &[f64]) -> Option<Intrinsics> {
        let (&[fx, fy, cx, cy], scale) = match numbers {
            [four @ .., scale] if numbers.len() == 5 => (<&[f64; 4]>::try_from(four).ok()?, *scale),
            four => (<&[f64; 4]>::try_from(four).ok()?, 1.0),
        };
        let sound = [fx, fy, scale].iter().all(|v| *v > 0.0) && numbers.iter().all(|v| v.is_finite());
        sound.then_some(Intrinsics { focal: [fx, fy], centre: [cx, cy], scale })
    }

    /// Of the matrix `[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]`, or of the four numbers, as arrays in files hold them.
    pub(in crate::io) fn of_array(values: &[f64]) -> Option<Intrinsics> {
        match *values {
            [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0] => Intrinsics::new(&[fx, fy, cx, cy]),
            _ => Intrinsics::new(values),
        }
    }
}

/// `FX,FY,CX,CY` or `FX,FY,CX,CY,SCALE`.
impl std::str::FromStr for Intrinsics {
    type Err = String;

    fn from_str(text: &str) -> Result<Intrinsics, String> {
        let numbers: Option<Vec<f64>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
        numbers.and_then(|n| Intrinsics::new(&n)).ok_or_else(|| {
            "FX,FY,CX,CY[,SCALE] in pixels, such as 615.2,615.4,320.5,240.1,0.001 for depths in millimetres to be taken as metres"
                .into()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_matrices() {
        let camera = Intrinsics { focal: [600.0, 610.0], centre: [320.0, 240.0], scale: 1.0 };
        assert_eq!("600,610, 320,240".parse(), Ok(camera));
        assert_eq!("600,610,320,240,1e-3".parse(), Ok(Intrinsics { scale: 1e-3, ..camera }));
        assert_eq!(Intrinsics::of_array(&[600.0, 0.0, 320.0, 0.0, 610.0, 240.0, 0.0, 0.0, 1.0]), Some(camera));
        for wrong in ["600,610,320", "0,1,2,3", "1,1,nan,1", "1,1,1,1,-1", "a,b,c,d", "1,2,3,4,5,6", ""] {
            assert!(wrong.parse::<Intrinsics>().is_err(), "{wrong}");
        }
    }
}
