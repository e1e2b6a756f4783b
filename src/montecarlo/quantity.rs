//! What is asked of every replicate beside the grid means of S and of R.

use std::fmt;
use std::str::FromStr;

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
    /// At one point, input coordinates.
    At(PointQuantity, [f64; 2]),
}

/// A quantity at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum PointQuantity {
    /// Shape index.
    ShapeIndex,
    /// Curvedness.
    Curvedness,
    /// Larger principal curvature.
    K1,
    /// Smaller principal curvature.
    K2,
}

impl PointQuantity {
    fn name(self) -> &'static str {
        match self {
            PointQuantity::ShapeIndex => "S",
            PointQuantity::Curvedness => "R",
            PointQuantity::K1 => "k1",
            PointQuantity::K2 => "k2",
        }
    }
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
            Quantity::At(what, [x, y]) => write!(f, "{}@{x},{y}", what.name()),
        }
    }
}

impl FromStr for Quantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Quantity, String> {
        const EXPECTED: &str = "k1, k2, radius, direction_deg, or S, R, k1, k2 at a point as in S@0,1.5";
        if let Some((what, place)) = text.split_once('@') {
            let what = match what {
                "S" => PointQuantity::ShapeIndex,
                "R" => PointQuantity::Curvedness,
                "k1" => PointQuantity::K1,
                "k2" => PointQuantity::K2,
                _ => return Err(format!("{text}: {EXPECTED}")),
            };
            let numbers: Result<Vec<f64>, _> = place.split(',').map(|n| n.trim().parse::<f64>()).collect();
            return match numbers.as_deref() {
                Ok(&[x, y]) if x.is_finite() && y.is_finite() => Ok(Quantity::At(what, [x, y])),
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
