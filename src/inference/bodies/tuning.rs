//! The settings that decide about bodies, all of them, each with its default and where that comes from.

/// What decides how contacts of whole or strongly bent bodies are judged. The defaults serve a user who names nothing.
///
/// ```
/// use palpate_inference::facade::recognition::Tuning;
///
/// // a sensor that never strays
/// let strict = Tuning { false_prior: 1e6, ..Tuning::default() };
/// assert!(strict.false_prior > Tuning::default().false_prior);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Tuning {
    /// Prior odds of plane, sphere, cylinder, cone, torus and ellipsoid. Equal: nothing is known of what is touched.
    pub kinds: [f64; 6],
    /// Lengths of departures from a primitive, in root mean square distances of the contacts from their middle: from half the body
    /// to a tenth of it.
    pub lengths: [f64; 3],
    /// Sizes of departures, in standard deviations of a single contact. Octaves of four: evidence is a smooth function of their logarithm.
    pub departures: [f64; 4],
    /// Prior probability of no departure at all.
    pub exact: f64,
    /// Mean and standard deviation of ln(sd of distances / sd of normals), lengths in the same unit: a sensor whose normals err by 3 degrees
    /// mostly errs by a fiftieth of what it touches, and a factor of five to either side is usual.
    pub log_ratio: [f64; 2],
    /// Change of the mean S, and of the mean R relative to it, from which on a surface that departs is no longer of its kind: half a class, and
    /// a tenth.
    pub other_shape: [f64; 2],
    /// Probability that a departure is an error of the sensor and not shape: even, since contacts of one sensor do not tell.
    pub departure_is_error: f64,
    /// The prior of the share of false contacts is Beta(1, this): one in twenty is expected.
    pub false_prior: f64,
    /// Largest share of false contacts: beyond it the others are the body.
    pub false_most: f64,
    /// Distances over which false contacts are spread, in the same unit as lengths: about the size of the whole.
    pub reach: f64,
    /// Slope of a departure, its root mean square over its length, beyond which a primitive is no answer: where the surface leans 7 degrees
    /// away it also bends otherwise.
    pub largest_slope: f64,
    /// Scatter of single contacts, in the same unit as lengths, beyond which a primitive is no answer.
    pub largest_scatter: f64,
    /// Share of all contacts that each of two things has at least, counting with the second what both leave out: one face of a cube has
    /// a sixth.
    pub other_things: f64,
    /// Angle from the mean normal, degrees, beyond which contacts are judged as a body and not as a patch.
    pub patch_reach_deg: f64,
    /// Kurtosis of the distances from a surface below which two sheets are looked for: gaussian 3, even 1.8, two values 1.
    pub two_peaks: f64,
    /// Sets of a few contacts that are tried as starts of every kind: of sets of eight with a third of all contacts false 4 % are clean.
    pub starts: usize,
    /// Contacts from which evidence is computed at most.
    pub most_contacts: usize,
    /// Places that carry a departure at most.
    pub most_features: usize,
    /// Surfaces that are drawn from the posterior.
    pub draws: usize,
}

impl Default for Tuning {
    fn default() -> Tuning {
        Tuning {
            kinds: [1.0; 6],
            lengths: [0.2, 0.45, 1.0],
            departures: [0.5, 2.0, 8.0, 32.0],
            exact: 0.5,
            log_ratio: [-1.0, 1.6],
            other_shape: [0.06, 0.1],
            departure_is_error: 0.5,
            false_prior: 20.0,
            false_most: 0.5,
            reach: 2.0,
            largest_slope: 0.12,
            largest_scatter: 0.2,
            other_things: 0.15,
            patch_reach_deg: 60.0,
            two_peaks: 1.8,
            starts: 120,
            most_contacts: 6000,
            most_features: 48,
            draws: 400,
        }
    }
}
