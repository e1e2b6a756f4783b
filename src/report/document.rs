//! `palpate.fit/1`: the keys of the JSON that others rely on. Lengths are in input units, angles in degrees; what is
//! undefined is `null`. New keys may be added beside these; none is taken away without a new version.

use std::fmt;

use serde::de::{Deserializer, MapAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};

use crate::io::{SavedFrame, SavedSurface};

/// One fit, described.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FitDocument {
    /// `palpate.fit/1`.
    pub schema: String,
    /// Number of contacts, or of pixels that hold a measurement.
    pub contacts: usize,
    /// The patch frame.
    pub frame: SavedFrame,
    /// How the surface was found.
    pub fit: FitPart,
    /// What the patch looks like.
    pub shape: ShapePart,
    /// What is true, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<TruthPart>,
    /// The surface itself.
    pub surface: SavedSurface,
    /// Where the time went.
    pub seconds: Seconds,
}

/// How the surface was found, with the certificate of the numbers.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FitPart {
    /// Degrees in x and y.
    pub degree: [usize; 2],
    /// Segments in x and y.
    pub segments: [usize; 2],
    /// Weights of the slope rows as applied: z, zx, zy; `null` for normal rows.
    pub weights: Option<[f64; 3]>,
    /// Which kind of surface it is and why, where that was a question.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen: Option<ChosenPart>,
    /// Certificate of a parametric surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parametric: Option<ParametricPart>,
    /// Standard deviations of the noise, declared or estimated.
    pub sigma: Option<SigmaPart>,
    /// Method that gave the answer.
    pub method: String,
    /// Why this method.
    pub reason: String,
    /// Scalar rows.
    pub equations: usize,
    /// Coefficients.
    pub unknowns: usize,
    /// Numerical rank of the equations.
    pub rank: usize,
    /// 1-norm condition estimate of the column-equilibrated weighted rows.
    pub condition: Option<f64>,
    /// Oettli-Prager backward error of the augmented system.
    pub backward_error: Option<f64>,
    /// Decimal digits that the answer has at least; `null` for a parametric surface, which guarantees none.
    #[serde(default)]
    pub promise: Option<PromisePart>,
    /// Refinement steps from the rows.
    #[serde(default)]
    pub refinements: usize,
    /// Roughness weight lambda; 0 without.
    pub smooth: f64,
    /// Root mean squares of the residuals.
    pub rms: RmsPart,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// Decimal digits that agree for certain with the exact solution of the written problem.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct PromisePart {
    /// Of the coefficients, relative to the largest.
    pub coefficients: f64,
    /// Of S at the worst supported point, absolute.
    #[serde(rename = "S")]
    pub shape_index: f64,
    /// Of R at the worst supported point, relative.
    #[serde(rename = "R")]
    pub curvedness: f64,
}

/// Kind of surface.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ChosenPart {
    /// `height` or `parametric`.
    pub surface: String,
    /// Why.
    pub reason: String,
}

/// Certificate of a parametric surface.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ParametricPart {
    /// How the contacts were flattened.
    pub parametrisation: String,
    /// Steps of the descent with corrected parameters.
    pub iterations: usize,
    /// The descent ended at a minimum.
    pub settled: bool,
    /// Steps refused because they would have folded the map.
    pub folds_refused: usize,
    /// Smallest Jacobian where contacts reach, over the mean one.
    pub smallest_jacobian: f64,
    /// The surface folds back on itself nowhere.
    pub fold_free: bool,
    /// Contacts stand in the order of their stations; `null` without stations.
    #[serde(rename = "lanes_monotone")]
    pub fingers_monotone: Option<bool>,
    /// Contacts whose normal is against the surface.
    pub against: usize,
    /// Largest curvature of the surface, divided by the largest that the normals of neighbouring contacts show there.
    pub bending: f64,
    /// How often the fairness was raised tenfold because that ratio was above 2.5.
    pub fairness_raised: usize,
    /// Directions that close.
    pub closed: [bool; 2],
}

/// Standard deviations of the noise.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct SigmaPart {
    /// Of z, input units.
    pub z: Option<f64>,
    /// Of the normal per tangent axis, degrees (normal rows).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal_deg: Option<f64>,
    /// Of the slopes (slope rows).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slope: Option<f64>,
}

/// Root mean square residuals, unweighted.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct RmsPart {
    /// Heights, input units.
    pub z: Option<f64>,
    /// Slopes in x.
    pub zx: Option<f64>,
    /// Slopes in y.
    pub zy: Option<f64>,
    /// Angle between the normals and the surface's, degrees (parametric surfaces, whose `z` is the distance to them).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal_deg: Option<f64>,
}

/// Shape over the grid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ShapePart {
    /// Points in x and y.
    pub grid: [usize; 2],
    /// Shape index.
    #[serde(rename = "S")]
    pub shape_index: MeasurePart,
    /// Curvedness, 1/length.
    #[serde(rename = "R")]
    pub curvedness: MeasurePart,
    /// Radius of spheres and cylinders.
    pub radius: Option<f64>,
    /// One of the nine classes, or plane.
    pub class: Option<String>,
    /// Probability of each class.
    pub class_probability: Option<Shares>,
    /// Larger principal curvature.
    pub k1: SpreadPart,
    /// Smaller principal curvature.
    pub k2: SpreadPart,
    /// Direction of k1 at the centre, from +x towards +y, in [0, 180).
    pub direction_deg: Option<f64>,
    /// Unit direction of k1 in space at the centre (parametric surfaces).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Points used / grid points.
    pub support: f64,
    /// p-value of the best plane against the fit.
    pub plane_p: Option<f64>,
}

/// Mean and spread over the patch, and the uncertainty of the mean.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct MeasurePart {
    /// Mean over the patch.
    pub mean: Option<f64>,
    /// Sample sd over the patch: variation, not uncertainty.
    pub sd: Option<f64>,
    /// Standard uncertainty of the mean.
    pub u: Option<f64>,
    /// Interval of the mean at the fit's level.
    pub interval: Option<[f64; 2]>,
}

/// Mean and spread over the patch.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct SpreadPart {
    /// Mean over the patch.
    pub mean: Option<f64>,
    /// Sample sd over the patch.
    pub sd: Option<f64>,
}

/// Named shares in their own order.
#[derive(Clone, Debug)]
pub(crate) struct Shares(pub Vec<(String, f64)>);

impl Serialize for Shares {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, share) in &self.0 {
            map.serialize_entry(name, share)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Shares {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Shares, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Shares;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("an object of shares")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Shares, A::Error> {
                let mut shares = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    shares.push(entry);
                }
                Ok(Shares(shares))
            }
        }
        deserializer.deserialize_map(InOrder)
    }
}

/// The truth over the same points.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct TruthPart {
    /// Mean true shape index.
    #[serde(rename = "S")]
    pub shape_index: Option<f64>,
    /// Mean true curvedness.
    #[serde(rename = "R")]
    pub curvedness: Option<f64>,
    /// Pointwise rms error of S.
    #[serde(rename = "error_S")]
    pub error_shape_index: Option<f64>,
    /// Pointwise rms error of R.
    #[serde(rename = "error_R")]
    pub error_curvedness: Option<f64>,
}

/// Wall-clock seconds.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Seconds {
    /// Reading, or simulating, the contacts.
    pub read: f64,
    /// Fitting.
    pub fit: f64,
    /// S, R and their uncertainty.
    pub shape: f64,
    /// Everything up to here.
    pub total: f64,
}
