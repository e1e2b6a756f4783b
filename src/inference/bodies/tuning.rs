//! The settings that decide about bodies, all of them, each with its default and where that comes from.

use std::f64::consts::{E, PI};

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
    /// Lengths by which the places that carry a departure are apart: nearer ones tell nothing that their neighbour does not.
    pub apart: f64,
    /// Sizes of departures, in standard deviations of a single contact. Octaves of four: evidence is a smooth function of their logarithm.
    pub departures: [f64; 4],
    /// Prior probability of no departure at all.
    pub exact: f64,
    /// Probability that a ring's departure is one of its section, the same all round: even, since necks and rims are turned as often as not.
    pub section: f64,
    /// Mean and standard deviation of ln(sd of distances / sd of normals), lengths in the same unit: a sensor whose normals err by 3 degrees
    /// mostly errs by a fiftieth of what it touches, and a factor of five to either side is usual.
    pub log_ratio: [f64; 2],
    /// Change of the mean S, and of the mean R relative to it, from which on a surface that departs is no longer of its kind: half a class, and
    /// a tenth.
    pub other_shape: [f64; 2],
    /// Root mean square of a departure, in the same unit as lengths, from which on the surface is no longer of its kind either.
    pub other_body: f64,
    /// Probability that a departure is an error of the sensor and not shape, before its size is looked at: even, since contacts of one
    /// sensor do not tell.
    pub departure_is_error: f64,
    /// Probability that normals were measured by themselves, and not computed from the places, whose errors they then follow: a file does
    /// not tell.
    pub own_normals: f64,
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
    /// Contacts from which on a body of no simple kind is a free surface, with and without normals: fewer do not tell those that are left out.
    pub free_from: [usize; 2],
    /// Contacts from which on it takes the place of a patch, which needs fewer to tell how it bends.
    pub free_beside_patch: [usize; 2],
    /// Length of the mean normal below which contacts go all round a body: half a ball has a half.
    pub all_round: f64,
    /// Lengths of a free surface's departure from its base.
    pub free_lengths: [f64; 4],
    /// Lengths by which the places that carry it are apart: on the way to its mode, and then where it bends evenly and where it does not. A
    /// departure is many times the noise, and what is lost of it between the places must be less.
    pub free_apart: [f64; 3],
    /// Sizes of that departure, in standard deviations of a single contact: up to a third of the body for the most exact sensor.
    pub free_sizes: [f64; 6],
    /// By how much the slope of an implicit surface may differ from 1 along its normal, a standard deviation: it is a distance nearby.
    pub free_steepness: f64,
    /// Standard deviation and length of a broad departure besides, as large as the body: what no primitive and no short length follows.
    pub free_broad: [f64; 2],
    /// Two of the lengths by which its forms are rated before any is followed.
    pub free_rated: [f64; 2],
    /// Distance of the nearest contact from focal points of a base, over the root mean square one, below which a turned surface goes through them:
    /// necks as thin as a quarter are rare.
    pub focal: f64,
    /// Forms of every symmetry that are followed to their mode.
    pub free_followed: usize,
    /// Steps to a mode: each squares what is left.
    pub free_rounds: usize,
    /// Contacts from which a free surface is computed at most.
    pub free_contacts: usize,
    /// Places that carry a free surface at most.
    pub free_features: usize,
    /// Root mean square error at contacts left out, over that of the best primitive, up to which a free surface is an answer.
    pub free_predicts: f64,
    /// Surfaces that are drawn to tell what a free surface does not know at contacts left out: of 32 it is known to an eighth.
    pub predicted_draws: usize,
    /// Length of a departure from which on that of a free surface is shape, and no detail or error beside one, and a section may depart: half
    /// the body.
    pub shape_from: f64,
    /// Standard deviations of a contact that a free surface may go to both sides without meeting itself, or it is none.
    pub sheets_apart: f64,
    /// Share of all contacts that each of two things has at least, counting with the second what both leave out, and that is looked for as one
    /// thing of many: one face of a cube has a sixth.
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
    /// Contacts among which modes are searched; the best of every kind is then followed over all.
    pub searched: usize,
    /// Directions of an axis that are tried on a half sphere: of 160 the next is 6 degrees away.
    pub directions: usize,
    /// Starts of a kind that are followed to their mode: the nearest by the distance that a sure share of the contacts has at most, by the
    /// median, and by the mean square.
    pub followed: [usize; 3],
    /// Share of the contacts that surely belong to the surface, or to one of two sheets, though half of all are false.
    pub surely_own: f64,
    /// Contacts from which planes through neighbours tell normals for a start.
    pub neighbourly: usize,
    /// Contacts from which on false ones are told from others: half of them must still outnumber the unknowns.
    pub false_from: usize,
    /// Extent, in the same unit as lengths, by which sizes are judged: beyond a hundred of it a simpler kind is as good.
    pub extent: f64,
    /// Log evidence below the best at which a hypothesis is left out: by its rough value, to which exact departures add less, and by the whole.
    pub hopeless: [f64; 2],
    /// Standard deviations within which a contact belongs to a primitive that was fitted to others of the same cloud.
    pub belongs: f64,
    /// Contacts that each of several things has at least, without and with normals, which are two more rows of a contact each.
    pub thing_contacts: [usize; 2],
    /// Share of the contacts left out that the second thing holds: one more face of a cube has a fifth of them.
    pub second_share: f64,
    /// Things that are told apart at most.
    pub most_things: usize,
    /// Scatter over that of another explanation, below which it is far nearer: about a thing over that about what may be two, since noise is
    /// the same all over, and about a body over that about a patch.
    pub sharper: f64,
    /// Scatter about one or several primitives over that about a free surface, up to which they are as near: of 160 contacts it is known to 6 %.
    pub as_near: f64,
    /// Share of all contacts that three things or more hold where two alone do not explain them better than one.
    pub things_hold: f64,
    /// Share of all contacts that planes, balls, bars and cones hold where a cut into many takes the place of one surface: a scan leaves some
    /// at every edge.
    pub primitives_hold: f64,
    /// First things, the likeliest, of which the second is looked for; beside them one of every simple kind that is far nearer to its own contacts.
    pub firsts: usize,
    /// Log prior odds of one thing against several, which are as probable once they are ahead by it.
    pub clearly: f64,
    /// Spread across a line over that along it, below which contacts are one row: a row lies on many surfaces and is no thing.
    pub row: f64,
    /// Share of contacts or normals set aside from which on a patch is doubted, and of contacts beside another sheet of a free surface from
    /// which on that is none.
    pub doubtful: f64,
    /// Share of the given normals that turn away from a patch's middle by more than a patch may, from which on it is judged as a body.
    pub farther_round: f64,
    /// Share of false contacts, or of normals against a patch, from which on a body is the better answer.
    pub decisive: f64,
    /// Probability that the kind of a body has at least where there are too few contacts for a patch.
    pub sure_of_few: f64,
    /// Contacts from which on two peaks of their distances are looked for.
    pub peaks_from: usize,
    /// Spread across a line over that along it, above which places are no line whatever they err by.
    pub narrow: f64,
    /// Spread across a line, in standard deviations of a contact, that errors may have made.
    pub line_errors: f64,
    /// Places without normals from which on a plane through them is asked whether they are one bent path.
    pub path_from: usize,
    /// Share of normals that must point to one side for it to be the free one.
    pub normals_agree: f64,
    /// Scatter of normals, radians, from which on they tell nothing.
    pub random_normals: f64,
    /// Posterior probability of a departure from which on it is spoken of, and of one thing up to which several are.
    pub certain: f64,
    /// A gap between contacts round a body, degrees, that is no gap of its map.
    pub no_gap_deg: f64,
    /// A place of the map is supported where a contact is so many times as near as contacts are to each other, at the 90th percentile: of a
    /// primitive, and of a free surface, of which no more is known than within the widest gap between random contacts.
    pub supported: [f64; 2],
    /// Distance of the middle of the contacts beside a place of a free surface from it, over their root mean square distance, up to
    /// which they lie on all sides of it.
    pub surrounded: f64,
}

impl Default for Tuning {
    fn default() -> Tuning {
        Tuning {
            kinds: [1.0; 6],
            lengths: [0.2, 0.45, 1.0],
            apart: 0.7,
            departures: [0.5, 2.0, 8.0, 32.0],
            exact: 0.5,
            section: 0.5,
            log_ratio: [-1.0, 1.6],
            other_shape: [0.06, 0.1],
            other_body: 0.05,
            departure_is_error: 0.5,
            own_normals: 0.5,
            false_prior: 20.0,
            false_most: 0.5,
            reach: 2.0,
            largest_slope: 0.12,
            largest_scatter: 0.2,
            free_from: [12, 24],
            free_beside_patch: [12, 40],
            all_round: 0.5,
            free_lengths: [0.15, 0.3, 0.6, 1.2],
            free_apart: [0.4, 0.2, 0.12],
            free_sizes: [8.0, 32.0, 128.0, 512.0, 2048.0, 8192.0],
            free_steepness: 0.1,
            free_broad: [2.0, 2.0],
            free_rated: [0.3, 0.8],
            focal: 0.25,
            free_followed: 2,
            free_rounds: 8,
            free_contacts: 600,
            free_features: 240,
            free_predicts: 0.5,
            predicted_draws: 32,
            shape_from: 0.45,
            sheets_apart: 2.0,
            other_things: 0.15,
            patch_reach_deg: 60.0,
            two_peaks: 1.8,
            starts: 120,
            most_contacts: 6000,
            most_features: 48,
            draws: 400,
            searched: 120,
            directions: 160,
            followed: [2, 2, 2],
            surely_own: 0.3,
            neighbourly: 20,
            false_from: 8,
            extent: 3.0,
            hopeless: [60.0, 40.0],
            belongs: 4.0,
            thing_contacts: [6, 3],
            second_share: 0.15,
            most_things: 16,
            sharper: 0.5,
            as_near: 1.2,
            things_hold: 0.95,
            primitives_hold: 0.8,
            firsts: 4,
            clearly: 10.0,
            row: 0.05,
            doubtful: 0.05,
            farther_round: 0.2,
            decisive: 0.1,
            sure_of_few: 0.8,
            peaks_from: 12,
            narrow: 0.2,
            line_errors: 3.0,
            path_from: 9,
            normals_agree: 0.75,
            random_normals: 0.35,
            certain: 0.95,
            no_gap_deg: 60.0,
            supported: [3.0, 1.5],
            surrounded: 0.5,
        }
    }
}

impl Tuning {
    /// Scatter, in the same unit as lengths, of contacts that are as likely as those that belong to nothing: anywhere within the reach.
    pub(crate) fn scatter_of_none(&self) -> f64 {
        self.reach / (2.0 * PI * E).sqrt()
    }
}
