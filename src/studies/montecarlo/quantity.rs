//! What is asked of every replicate beside the grid means of S and of R.

use std::fmt;
use std::str::FromStr;

use palpate_geometry::curvature::Principal;

/// A quantity of one fit. S and R stand first in every study; these may be asked for besides.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Quantity {
    /// Grid mean of the shape index.
    ShapeIndex,
    /// Grid mean of the curvedness, 1/length.
    Curvedness,
    /// Grid mean of the larger principal curvature.
    K1,
    /// Grid mean of the smaller principal curvature.
    K2,
    /// Radius of a cap, cup, ridge or rut; undefined for other classes.
    Radius,
    /// Direction of k1 at the patch's centre, degrees, within 90 of the noise-free one.
    Direction,
    /// Shape index over one place (x, y), input coordinates.
    ShapeIndexAt([f64; 2]),
    /// Curvedness over one place.
    CurvednessAt([f64; 2]),
    /// Larger principal curvature over one place.
    K1At([f64; 2]),
    /// Smaller principal curvature over one place.
    K2At([f64; 2]),
}
impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Quantity::ShapeIndex => f.write_str("S"),
            Quantity::Curvedness => f.write_str("R"),
            Quantity::K1 => f.write_str("k1"),
            Quantity::K2 => f.write_str("k2"),
            Quantity::Radius => f.write_str("radius"),
            Quantity::Direction => f.write_str("direction_deg"),
            Quantity::ShapeIndexAt([x, y]) => write!(f, "S@{x},{y}"),
            Quantity::CurvednessAt([x, y]) => write!(f, "R@{x},{y}"),
            Quantity::K1At([x, y]) => write!(f, "k1@{x},{y}"),
            Quantity::K2At([x, y]) => write!(f, "k2@{x},{y}"),
        }
    }
}

impl FromStr for Quantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Quantity, String> {
        const EXPECTED: &str = "k1, k2, radius, direction_deg, or S, R, k1, k2 at a point as in S@0,1.5";
        if let Some((what, place)) = text.split_once('@') {
            let of: fn([f64; 2]) -> Quantity = match what {
                "S" => Quantity::ShapeIndexAt,
                "R" => Quantity::CurvednessAt,
                "k1" => Quantity::K1At,
                "k2" => Quantity::K2At,
                _ => return Err(format!("{text}: {EXPECTED}")),
            };
            let numbers: Result<Vec<f64>, _> = place.split(',').map(|n| n.trim().parse::<f64>()).collect();
            return match numbers.as_deref() {
                Ok(&[x, y]) if x.is_finite() && y.is_finite() => Ok(of([x, y])),
                _ => Err(format!("{text}: {EXPECTED}")),
            };
        }
        match text {
            "S" => Ok(Quantity::ShapeIndex),
            "R" => Ok(Quantity::Curvedness),
            "k1" => Ok(Quantity::K1),
            "k2" => Ok(Quantity::K2),
            "radius" => Ok(Quantity::Radius),
            "direction" | "direction_deg" => Ok(Quantity::Direction),
            _ => Err(format!("{text}: {EXPECTED}")),
        }
    }
}

impl Quantity {
    /// The value at one point of a surface whose lengths are in units of `scale` input units; NaN of a quantity that belongs
    /// to the patch.
    pub(super) fn at_point(&self, p: &Principal, scale: f64) -> f64 {
        match self {
            Quantity::ShapeIndexAt(_) => p.shape_index().unwrap_or(f64::NAN),
            Quantity::CurvednessAt(_) => p.curvedness() / scale,
            Quantity::K1At(_) => p.k1 / scale,
            Quantity::K2At(_) => p.k2 / scale,
            Quantity::ShapeIndex
            | Quantity::Curvedness
            | Quantity::K1
            | Quantity::K2
            | Quantity::Radius
            | Quantity::Direction => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back() {
        for text in ["S", "R", "k1", "k2", "radius", "direction_deg", "S@0,1.5", "k2@-1,3"] {
            assert_eq!(text.parse::<Quantity>().unwrap().to_string(), text);
        }
        for wrong in ["", "s", "S@1", "S@1,2,3", "S@a,b", "radius@0,0", "k3"] {
            assert!(wrong.parse::<Quantity>().is_err(), "{wrong}");
        }
    }
}
