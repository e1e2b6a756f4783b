//! `palpate.fit/1`: the keys of the JSON that others rely on. Lengths are in input units, angles in degrees; what is
//! undefined is `null`. New keys may be added beside these; none is taken away without a new version.

use std::{fmt, iter};

use schemars::JsonSchema;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use super::truth_part::TruthPart;
use crate::io::{SavedFrame, SavedSurface, UncertaintyMap};
use palpate_geometry::curvature::ShapeClass;

/// One fit, described.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub(crate) struct FitDocument {
    /// `palpate.fit/1`.
    pub(crate) schema: String,
    /// Unit of all lengths, where the user named it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) unit: Option<String>,
    /// Number of contacts, or of pixels that hold a measurement.
    pub(crate) contacts: usize,
    /// The patch frame.
    pub(crate) frame: SavedFrame,
    /// How the surface was found.
    pub(crate) fit: FitPart,
    /// What the patch looks like.
    pub(crate) shape: ShapePart,
    /// What is true, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) truth: Option<TruthPart>,
    /// The surface itself.
    pub(crate) surface: SavedSurface,
    /// Standard uncertainties over the surface; in files that a surface is saved in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) uncertainty: Option<UncertaintyMap>,
    /// Where the time went.
    pub(crate) seconds: Seconds,
}

/// How the surface was found, with the certificate of the numbers.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub(crate) struct FitPart {
    /// Degrees in x and y.
    pub(crate) degree: [usize; 2],
    /// Segments in x and y.
    pub(crate) segments: [usize; 2],
    /// Weights of the slope rows as applied: z, zx, zy; `null` for normal rows.
    pub(crate) weights: Option<[f64; 3]>,
    /// Which kind of surface it is and why, where that was a question.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) chosen: Option<ChosenPart>,
    /// Whether the residuals still hold a pattern, where it was tested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) lack_of_fit: Option<LackOfFitPart>,
    /// Certificate of a parametric surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) parametric: Option<ParametricPart>,
    /// Where the knots of an adaptive surface are, and how they came there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) adaptive: Option<AdaptivePart>,
    /// Standard deviations of the noise, declared or estimated.
    pub(crate) sigma: Option<SigmaPart>,
    /// Method that gave the answer.
    pub(crate) method: String,
    /// Why this method.
    pub(crate) reason: String,
    /// Scalar rows.
    pub(crate) equations: usize,
    /// Coefficients.
    pub(crate) unknowns: usize,
    /// Numerical rank of the equations.
    pub(crate) rank: usize,
    /// 1-norm condition estimate of the column-equilibrated weighted rows.
    pub(crate) condition: Option<f64>,
    /// Oettli-Prager backward error of the augmented system.
    pub(crate) backward_error: Option<f64>,
    /// Decimal digits that the answer has at least; `null` for a parametric surface, which guarantees none.
    #[serde(default)]
    pub(crate) promise: Option<PromisePart>,
    /// Refinement steps from the rows.
    #[serde(default)]
    pub(crate) refinements: usize,
    /// Roughness weight lambda; 0 without.
    pub(crate) smooth: f64,
    /// Root mean squares of the residuals.
    pub(crate) rms: RmsPart,
    /// What the user should know.
    pub(crate) notes: Vec<String>,
    /// Those of `notes` that the first output says in other words, or leaves to `--verbose`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) technical_notes: Vec<String>,
}

/// Decimal digits that agree for certain with the exact solution of the written problem.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct PromisePart {
    /// Of the coefficients, relative to the largest.
    pub(crate) coefficients: f64,
    /// Of S at the worst supported point, absolute.
    #[serde(rename = "S")]
    pub(crate) shape_index: f64,
    /// Of R at the worst supported point, relative.
    #[serde(rename = "R")]
    pub(crate) curvedness: f64,
}

/// What the program chose, and why.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct ChosenPart {
    /// `height` or `parametric`.
    pub(crate) surface: String,
    /// Why, in one sentence.
    #[serde(default)]
    pub(crate) why: String,
    /// The same under the key that it had first.
    pub(crate) reason: String,
    /// Degrees of the surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) degree: Option<[usize; 2]>,
    /// Segments of the surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) segments: Option<[usize; 2]>,
    /// `keep` where the surface stands over the input's x and y, `auto` where its axes come from the data.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) frame: Option<String>,
    /// The simple shape that the contacts show.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) hypothesis: Option<String>,
    /// All that was tried, likeliest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) tried: Vec<TriedPart>,
}

impl ChosenPart {
    /// A kind of surface that was chosen, and why.
    pub(crate) fn new(surface: &str, why: String) -> ChosenPart {
        ChosenPart { surface: surface.into(), reason: why.clone(), why, ..ChosenPart::default() }
    }
}

/// One shape that was tried.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct TriedPart {
    /// Its name.
    pub(crate) name: String,
    /// Its probability among those tried.
    pub(crate) probability: Option<f64>,
    /// Larger curvature of its fit.
    pub k1: Option<f64>,
    /// Smaller curvature of its fit.
    pub k2: Option<f64>,
    /// Root mean square distance of the contacts from it, input units.
    pub(crate) rms: Option<f64>,
}

/// Whether the residuals still hold a pattern.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct LackOfFitPart {
    /// Probability of residuals as alike as these among neighbours, were they independent.
    pub(crate) p: Option<f64>,
    /// Root mean square misfit of the contacts' local means, in percent of the relief.
    pub(crate) percent_of_relief: Option<f64>,
    /// One sentence.
    pub(crate) words: String,
}

/// Certificate of a parametric surface.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub(crate) struct ParametricPart {
    /// How the contacts were flattened.
    pub(crate) parametrisation: String,
    /// Steps of the descent with corrected parameters.
    pub(crate) iterations: usize,
    /// The descent ended at a minimum.
    pub(crate) settled: bool,
    /// Steps refused because they would have folded the map.
    pub(crate) folds_refused: usize,
    /// Smallest Jacobian where contacts reach, over the mean one; `null` where that is 0.
    #[schemars(with = "Option<f64>")]
    pub(crate) smallest_jacobian: f64,
    /// The surface folds back on itself nowhere.
    pub(crate) fold_free: bool,
    /// Contacts stand in the order of their stations; `null` without stations.
    #[serde(rename = "lanes_monotone")]
    pub(crate) fingers_monotone: Option<bool>,
    /// Contacts whose normal is against the surface.
    pub(crate) against: usize,
    /// Largest curvature of the surface, divided by the largest that the normals of neighbouring contacts show there;
    /// `null` where these show none.
    #[schemars(with = "Option<f64>")]
    pub(crate) bending: f64,
    /// How often the fairness was raised tenfold because that ratio was above 2.5.
    pub(crate) fairness_raised: usize,
    /// Directions that close.
    pub(crate) closed: [bool; 2],
}

/// Where the knots of an adaptive surface are, and how they came there.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct AdaptivePart {
    /// Cells of the surface.
    pub(crate) cells: usize,
    /// How often the smallest cell's side is a half of a base cell's.
    pub(crate) halvings: usize,
    /// Rounds of fitting and splitting, the last of which split nothing or was the last allowed.
    pub(crate) rounds: usize,
    /// Contacts that lie off what is around them and were left out.
    pub(crate) left_out: usize,
    /// Degrees of freedom that the surface took of the contacts; `null` with `--bare`.
    pub(crate) freedom: Option<f64>,
    /// Numbers in the factor of the equations.
    pub(crate) factor_entries: usize,
    /// Share by which standard uncertainties at points are off because they come by random draws; `null` where they are exact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) draws_error: Option<f64>,
}

/// Standard deviations of the noise.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct SigmaPart {
    /// Of z, input units.
    pub(crate) z: Option<f64>,
    /// Of the normal per tangent axis, degrees (normal rows).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) normal_deg: Option<f64>,
    /// Of the slopes (slope rows).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) slope: Option<f64>,
    /// Of the errors across the surface that neighbouring contacts share, input units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) shared: Option<f64>,
    /// Distance over which shared errors fade by a factor e, input units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) shared_over: Option<f64>,
}

impl SigmaPart {
    /// What one point is off by in all: its own error and the one it shares with its neighbours, `sqrt(z² + shared²)`.
    pub(crate) fn of_point(&self) -> Option<f64> {
        self.z.map(|own| own.hypot(self.shared.unwrap_or(0.0)))
    }
}

/// Root mean square residuals, unweighted.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct RmsPart {
    /// Heights, input units.
    pub(crate) z: Option<f64>,
    /// Slopes in x.
    pub(crate) zx: Option<f64>,
    /// Slopes in y.
    pub(crate) zy: Option<f64>,
    /// Angle between the normals and the surface's, degrees (parametric surfaces, whose `z` is the distance to them).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) normal_deg: Option<f64>,
}

/// Shape over the grid.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub(crate) struct ShapePart {
    /// Points in x and y.
    pub(crate) grid: [usize; 2],
    /// Shape index.
    #[serde(rename = "S")]
    pub(crate) shape_index: MeasurePart,
    /// Curvedness, 1/length.
    #[serde(rename = "R")]
    pub(crate) curvedness: MeasurePart,
    /// Radius of spheres and cylinders.
    pub(crate) radius: Option<f64>,
    /// Interval of the radius, at the level of R's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) radius_interval: Option<[f64; 2]>,
    /// Both radii of dome and trough, the smaller first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) radii: Option<[f64; 2]>,
    /// One of the nine classes, or plane.
    pub(crate) class: Option<String>,
    /// The class from the other side, where nothing tells which side is free; S is then given by its size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) other_class: Option<String>,
    /// Probability of each class.
    #[schemars(extend("required" = ShapeClass::CURVED.map(ShapeClass::name)))]
    pub(crate) class_probability: Option<Shares>,
    /// Where several classes stand side by side and `class` is null: share of the patch of each that has a tenth of it or more, the
    /// commonest first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) class_by_area: Option<Shares>,
    /// Larger principal curvature.
    pub k1: SpreadPart,
    /// Smaller principal curvature.
    pub k2: SpreadPart,
    /// Direction of k1 at the centre, from +x towards +y, in [0, 180).
    pub(crate) direction_deg: Option<f64>,
    /// Unit direction of k1 in space at the centre (parametric surfaces).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) direction: Option<[f64; 3]>,
    /// Direction along a ridge or rut, or the longer way of a dome or trough, as `direction_deg`; of what is recognised as a ring or a cone
    /// what it is turned about, of an ellipsoid its longest half axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) axis_deg: Option<f64>,
    /// The same in space (parametric surfaces).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) axis: Option<[f64; 3]>,
    /// Within how many degrees of it the true axis lies, at the level of R's interval, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) axis_within_deg: Option<f64>,
    /// Of a recognised ball its centre, of a pipe or bar the point of its axis next to the middle of the patch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) centre: Option<[f64; 3]>,
    /// Points used / grid points.
    pub(crate) support: f64,
    /// p-value of the best plane against the fit.
    pub(crate) plane_p: Option<f64>,
    /// Covariance of the noise in the means of S and of R, 1/length.
    #[serde(rename = "cov_S_R", default, skip_serializing_if = "Option::is_none")]
    pub(crate) covariance: Option<f64>,
    /// How the intervals of a height field of a named model came about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) intervals: Option<IntervalsPart>,
}

/// How intervals came about.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct IntervalsPart {
    /// Law of the noise: `normal` where it was declared, `student_t` where it was estimated.
    pub(crate) law: String,
    /// What they count beside noise: the other kind of surface that they cover, or nothing.
    pub(crate) beside: Option<String>,
    /// Seed of the draws behind that; `null` without draws.
    pub(crate) seed: Option<u64>,
    /// Instruction set of the kernels.
    pub(crate) isa: String,
}

/// Mean and spread over the patch, and the uncertainty of the mean.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct MeasurePart {
    /// Mean over the patch.
    pub(crate) mean: Option<f64>,
    /// Sample sd over the patch: variation, not uncertainty.
    pub(crate) sd: Option<f64>,
    /// Standard uncertainty of the mean.
    pub(crate) u: Option<f64>,
    /// Interval of the mean at the fit's level.
    pub(crate) interval: Option<[f64; 2]>,
    /// The part of `u` that independent noise explains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) u_noise: Option<f64>,
    /// The part of `u` that comes from shared errors and from doubt about the kind of surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) u_model: Option<f64>,
    /// Level of the interval.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) level: Option<f64>,
    /// Factor by which `u` reaches the farther end of the interval.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) coverage_factor: Option<f64>,
    /// Degrees of freedom behind `u`, or behind `u_noise` of a named model; not there where the noise was declared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) dof: Option<f64>,
}

/// Mean and spread over the patch.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct SpreadPart {
    /// Mean over the patch.
    pub(crate) mean: Option<f64>,
    /// Sample sd over the patch.
    pub(crate) sd: Option<f64>,
}

/// Named shares in their own order.
#[derive(Clone, Debug)]
pub(crate) struct Shares(pub Vec<(String, f64)>);

impl Serialize for Shares {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, share)| (name, share)))
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
                iter::from_fn(|| map.next_entry().transpose()).collect::<Result<_, _>>().map(Shares)
            }
        }
        deserializer.deserialize_map(InOrder)
    }
}

/// Wall-clock seconds.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Seconds {
    /// Reading, or simulating, the contacts.
    pub(crate) read: f64,
    /// Fitting.
    pub(crate) fit: f64,
    /// S, R and their uncertainty.
    pub(crate) shape: f64,
    /// Everything up to here.
    pub(crate) total: f64,
}
