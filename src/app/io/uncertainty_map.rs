//! What a saved surface carries of its uncertainty: standard uncertainties at a few points of the domain.
//!
//! ```text
//! at = (u_0 .. u_a, v_0 .. v_b)      position, normal_deg, S, R indexed [i][j]      between them: linear in u and v
//! ```
//!
//! The covariance of the coefficients would tell more and is far larger: for 4,489 coefficients it is 160 MB against 8 kB.
//! What is asked of a surface at a point (does it agree with another one here?) these four maps answer.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Points each way, ends included. Uncertainty changes slowly, except within the last cells, where it rises to the edge.
pub(crate) const UNCERTAINTY_POINTS: usize = 9;

/// Most points each way that are read.
const MOST_POINTS: usize = 4096;

/// Standard uncertainties over a grid of the domain; `null` where there is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UncertaintyMap {
    /// Places in x and y, or in u and v.
    pub(crate) at: [Vec<f64>; 2],
    /// Of the position along the surface's normal, input units.
    pub(crate) position: Vec<Vec<Option<f64>>>,
    /// Of the normal: root mean square angle, degrees.
    pub(crate) normal_deg: Vec<Vec<Option<f64>>>,
    /// Of the shape index.
    #[serde(rename = "S")]
    pub(crate) shape_index: Vec<Vec<Option<f64>>>,
    /// Of the curvedness.
    #[serde(rename = "R")]
    pub(crate) curvedness: Vec<Vec<Option<f64>>>,
    /// Of the larger curvature; no rows in files of earlier versions.
    #[serde(default)]
    pub(crate) k1: Vec<Vec<Option<f64>>>,
    /// Of the smaller curvature.
    #[serde(default)]
    pub(crate) k2: Vec<Vec<Option<f64>>>,
}

/// Standard uncertainties at one point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PointUncertainty {
    pub(crate) position: Option<f64>,
    pub(crate) normal_deg: Option<f64>,
    pub(crate) shape_index: Option<f64>,
    pub(crate) curvedness: Option<f64>,
    pub(crate) k1: Option<f64>,
    pub(crate) k2: Option<f64>,
}

impl PointUncertainty {
    /// The same to as many digits as an uncertainty is known to.
    pub(crate) fn rounded(self) -> PointUncertainty {
        let PointUncertainty { position, normal_deg, shape_index, curvedness, k1, k2 } = self;
        PointUncertainty {
            position: position.and_then(rounded),
            normal_deg: normal_deg.and_then(rounded),
            shape_index: shape_index.and_then(rounded),
            curvedness: curvedness.and_then(rounded),
            k1: k1.and_then(rounded),
            k2: k2.and_then(rounded),
        }
    }
}

/// Four significant digits: an uncertainty is not known any better.
fn rounded(value: f64) -> Option<f64> {
    format!("{value:.3e}").parse::<f64>().ok().filter(|v| v.is_finite())
}

impl UncertaintyMap {
    /// From the values at every point, the second direction running fastest.
    pub(crate) fn of(at: [Vec<f64>; 2], values: &[PointUncertainty]) -> UncertaintyMap {
        let columns = at[1].len().max(1);
        let map = |pick: fn(&PointUncertainty) -> Option<f64>| -> Vec<Vec<Option<f64>>> {
            values.chunks(columns).map(|row| row.iter().map(|u| pick(u).and_then(rounded)).collect()).collect()
        };
        UncertaintyMap {
            position: map(|u| u.position),
            normal_deg: map(|u| u.normal_deg),
            shape_index: map(|u| u.shape_index),
            curvedness: map(|u| u.curvedness),
            k1: map(|u| u.k1),
            k2: map(|u| u.k2),
            at,
        }
    }

    /// Whether the maps fit their places.
    ///
    /// # Errors
    /// What is wrong.
    pub(crate) fn check(&self) -> Result<(), String> {
        for (name, axis) in ["first", "second"].into_iter().zip(&self.at) {
            let ascends = axis.is_sorted_by(|a, b| a < b);
            if !(2..=MOST_POINTS).contains(&axis.len()) || !ascends || axis.iter().any(|t| !t.is_finite()) {
                return Err(format!("uncertainty.at: the {name} list must be two or more ascending numbers"));
            }
        }
        let [n, m] = [self.at[0].len(), self.at[1].len()];
        let maps = [
            ("position", &self.position),
            ("normal_deg", &self.normal_deg),
            ("S", &self.shape_index),
            ("R", &self.curvedness),
        ];
        let later = [("k1", &self.k1), ("k2", &self.k2)].into_iter().filter(|(_, map)| !map.is_empty());
        for (name, map) in maps.into_iter().chain(later) {
            if map.len() != n || map.iter().any(|row| row.len() != m) {
                return Err(format!("uncertainty.{name} has not the {n} x {m} entries of uncertainty.at"));
            }
            if map.iter().flatten().flatten().any(|u| !u.is_finite() || *u < 0.0) {
                return Err(format!("uncertainty.{name} has a number below zero or not finite"));
            }
        }
        Ok(())
    }

    /// At a place of the domain; beyond the outermost points what stands there.
    pub(crate) fn at(&self, place: [f64; 2]) -> PointUncertainty {
        let cells = [cell(&self.at[0], place[0]), cell(&self.at[1], place[1])];
        let value = |map: &[Vec<Option<f64>>]| -> Option<f64> {
            let [(i, s), (j, t)] = cells;
            let at = |i: usize, j: usize| map.get(i)?.get(j).copied()?;
            // an end is itself, whatever its neighbour lacks
            let between = |a: Option<f64>, b: Option<f64>, w: f64| match w {
                0.0 => a,
                1.0 => b,
                w => Some((1.0 - w) * a? + w * b?),
            };
            between(between(at(i, j), at(i, j + 1), t), between(at(i + 1, j), at(i + 1, j + 1), t), s)
        };
        PointUncertainty {
            position: value(&self.position),
            normal_deg: value(&self.normal_deg),
            shape_index: value(&self.shape_index),
            curvedness: value(&self.curvedness),
            k1: value(&self.k1),
            k2: value(&self.k2),
        }
    }
}

/// The interval of an ascending list that holds `t`, and how far along `t` lies in it, 0 to 1.
fn cell(axis: &[f64], t: f64) -> (usize, f64) {
    let last = axis.len().saturating_sub(2);
    let k = axis.partition_point(|a| *a <= t).saturating_sub(1).min(last);
    let [lo, hi] = [axis[k], axis[(k + 1).min(axis.len() - 1)]];
    let share = if hi > lo { ((t - lo) / (hi - lo)).clamp(0.0, 1.0) } else { 0.0 };
    (k, if share.is_nan() { 0.0 } else { share })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_between_and_constant_beyond() {
        let at = [vec![0.0, 1.0, 3.0], vec![-1.0, 1.0]];
        let values: Vec<PointUncertainty> = (0..6)
            .map(|k| PointUncertainty {
                position: Some(f64::from(k)),
                shape_index: (k < 4).then_some(0.5),
                ..Default::default()
            })
            .collect();
        let map = UncertaintyMap::of(at, &values);
        map.check().unwrap();
        assert_eq!(map.at([0.5, 0.0]).position, Some(1.5));
        assert_eq!(map.at([9.0, 9.0]).position, Some(5.0));
        assert_eq!((map.at([1.0, 0.0]).shape_index, map.at([2.0, 0.0]).shape_index), (Some(0.5), None));
        assert_eq!(map.at([0.0, 0.0]).curvedness, None);
        let text = serde_json::to_string(&map).unwrap();
        assert_eq!(serde_json::from_str::<UncertaintyMap>(&text).unwrap(), map);
    }
}
