//! The settings that decide about bodies, how a patch is begun, how contacts and normals may err, how surfaces that explain a patch share
//! its answer, and when a free height field is one, each with its default and where that comes from.

use std::f64::consts::{E, PI};

/// What decides how contacts of whole or strongly bent bodies are judged, how the contacts of a patch and their errors are read, and how
/// hypotheses about it are weighed. The defaults serve a user who names nothing.
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
    /// Surfaces that are drawn from the posterior, of a body or of all kinds that explain a patch.
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
    /// Probability of a patch's kind from which on primitives in space are not asked beside it: they cost more than the patch itself, and one in
    /// 500 is less than a forecast is told to.
    pub sure_of_patch: f64,
    /// Contacts up to which a bar is asked whether it tapers, however sure a patch is of it: more show what a bar leaves as errors that neighbours
    /// share.
    pub taper_asked: usize,
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
    /// Posterior probability of a departure from which on it is spoken of, of one thing up to which several are, and of errors of places that
    /// are larger across z than along it from which on they count as shown.
    pub certain: f64,
    /// A gap between contacts round a body, degrees, that is no gap of its map.
    pub no_gap_deg: f64,
    /// A place of the map is supported where a contact is so many times as near as contacts are to each other, at the 90th percentile: of a
    /// primitive, and of a free surface, of which no more is known than within the widest gap between random contacts.
    pub supported: [f64; 2],
    /// Distance of the middle of the contacts beside a place of a free surface from it, over their root mean square distance, up to
    /// which they lie on all sides of it.
    pub surrounded: f64,
    /// Root mean squares of a departure over the relief, between which it is read as the sensor's error. Below the first it moves R by no more
    /// than some 5 %, so that nothing is lost by reading it as shape.
    pub sensor_departs: [f64; 2],
    /// Multiple of the scatter of single contacts up to which a sensor may err as a whole.
    pub sensor_over_scatter: f64,
    /// Share of the relief below which such an error must stay.
    pub sensor_of_relief: f64,
    /// A sensor that errs smoothly over the whole patch errs from contact to contact too: neighbours share errors of at least this share of
    /// the smooth one.
    pub shared_of_departure: f64,
    /// Probability of that, below which a departure is shape, whatever its size.
    pub shared_refuted: f64,
    /// Log evidence of everything, and log likelihood of all normals together, by which a surface that departs must be ahead of the others to be
    /// shape whatever its size. Normals of a tactile image are slopes of its own heights, so they follow its errors: 1 for each of 29
    /// normals of a touched ball. Normals with a scatter of 0.5 degrees are ahead by 10 to 31 on tori and bumps, and by 0.2 to 1.5 with 3 degrees.
    /// Of 120 objects that were touched at 441 places each, 91 had S and R right without that, and 101 with it (`benches/runs/explore.md`).
    pub departure_ahead: f64,
    /// Share of natural departures, or of bodies, in the estimate from which on the interval of R holds theirs. Without that the interval of an
    /// ellipsoid misses in 7 to 10 of 100 fits instead of 5 or 6; saddles of 27 contacts have one that is a seventh wider.
    pub heard: f64,
    /// Share of either reading in the interval where the contacts cannot tell shape from a sensor's error.
    pub either_reading: f64,
    /// Share of departures in the interval where they explain the contacts as well as any surface: most bodies are no plane, ball or bar. With
    /// a half, shallow bumps and the crests of long waves, which 40 contacts cannot tell from a ball and a bar, have R inside in a tenth to a
    /// quarter fewer of 100 fits; intervals of bars are 5 to 13 % wider by it.
    pub departed: f64,
    /// Log evidence within which two readings count as equally good.
    pub alike: f64,
    /// Log evidence by which a simple shape may be ahead of natural departures until their share of general's part falls to 1/e.
    pub simpler: f64,
    /// Least share of other displacements and of natural departures, where they are as likely, in what both have. Natural departures of
    /// shallow patches are too small to be seen, so half of the share would be a doubt about nothing.
    pub other_departures: f64,
    /// Share of a free smooth departure that counts with a prior ten times as loose. Its bias is smaller than a rough spline's, and draws
    /// of either half miss the truth on either side: with all or none of it, S of a bump is inside in 5 to 10 of 100 fits fewer. Profiles
    /// have few ways to bend, so that a loose prior costs them little width.
    pub looser: f64,
    /// Least share of torus and of paraboloid within general's part of the interval, when they fit equally well.
    pub reference: f64,
    /// Factor of misfit within which the two references count as equally good.
    pub reference_misfit: f64,
    /// Factor of misfit within which a simple shape cannot be excluded when the misfit is the sensor's.
    pub simple_misfit: f64,
    /// Log evidence that departures cost where nothing shows them: 8 to 11 on balls and bars. What lies farther behind is not unseen, but spoken
    /// against, as departures from a torus are on a paraboloid (14 to 32): with the whole least share there, all of it on one side, the
    /// interval of R ended in their middle.
    pub unseen: f64,
    /// Of intervals: log evidence by which the share of the worse of two readings falls to 1/e, and the least share of general and of displaced
    /// surfaces. With 8 and 0.1 they are up to half as wide again, and hold one of 100 random surfaces more, and of shallow bumps, which pass
    /// for balls, 7 of 100.
    pub doubt_of_interval: [f64; 2],
    /// The same of classes, which end sharply: bumps of 27 contacts, whose S lies beside such an end, have the right class in 63 of 100 fits, and
    /// by this doubt 67 are forecast, by that of intervals 70.
    pub doubt_of_class: [f64; 2],
    /// Log evidence by which the same surface seen in another way, about a plane or a finer displacement, has to be ahead. Within it both explain
    /// the contacts equally well, and most bodies are round: without it bumps of 27 contacts have the right class in 0.59 instead of 0.63 of all
    /// fits. With more, bumps of 36 contacts would stay over the curved surface, too.
    pub look_ahead: f64,
    /// Log evidence by which natural departures and kinds without one have to be behind before a plane is tried: a body that is nearly round
    /// is no bump on a plane.
    pub plane_ahead: f64,
    /// Least cosine between the surface and that plane: on a steeper flank a height over the plane says little.
    pub plane_steepest: f64,
    /// Misfit over relief from which on a simple shape leaves much unsaid, if it has a pattern.
    pub unsaid_of_relief: f64,
    /// The same from which on no surface of the list explains the contacts.
    pub unexplained_of_relief: f64,
    /// Probability of a misfit's pattern by chance below which it is one.
    pub pattern_by_chance: f64,
    /// The same below which it is certain.
    pub pattern_certain: f64,
    /// Misfit over the patch's size, above which a surface that leaves much unsaid is no answer: a sensor's error may be large beside the
    /// relief of a flat patch, but not beside its size.
    pub sensor_of_size: f64,
    /// Misfit over relief, shared over single errors, and correlation of neighbours, from which on a misfit is waves. Depth cameras err by as
    /// much together as alone (0.5 to 1.3 times as much on scans of pipes), and a scan of a golf ball by 57 times as much, but by a seventeenth
    /// of the relief. Waves too short for the cells leave errors that cells do not share, but neighbours do.
    pub waves: [f64; 3],
    /// Scatter of contacts over the patch's size that no sensor of a flat patch errs by.
    pub deep_waves: f64,
    /// Misfit over relief from which on the bend may be that of waves: a patch that bends by more than twice what it scatters has a shape of its
    /// own, whatever lies between its contacts.
    pub bend_of_waves: f64,
    /// Error of a height field at contacts left out, over the relief, below which it is an answer where nothing else is.
    pub field_predicts: f64,
    /// The same over the misfit of a simple shape, below which it takes that one's place.
    pub field_better: f64,
    /// The same over the misfit of a free surface at contacts that this follows: what a surface is off by on the whole need not be a bend.
    pub field_nearer: f64,
    /// Contacts from which on a free surface that follows them is held against a field that follows each of them, and lines are looked for.
    pub field_averaged_from: usize,
    /// Least cosine between a simple shape's normal and the axis along which a field has heights: it does not follow a steeper patch.
    pub field_level: f64,
    /// Spread of the contacts across the patch's own plane over that along its narrower side, beyond which there is no one plane: the corner of a
    /// room has 0.6, the edge of a box 0.7. Such contacts are several faces, though a field may follow them.
    pub field_folded: f64,
    /// Share of the normals on either side of a field from which on contacts go round more than it does, and the cosine that is clearly on a
    /// side: a sensor's stray ones are fewer.
    pub field_back: [f64; 2],
    /// Factor of the least error at contacts left out up to which a coarser field predicts as well, and is taken.
    pub field_as_good: f64,
    /// Factor by which that error must have risen above the least for finer fields to follow noise, so that they are not tried, and share of
    /// the relief below which the least must be: above it nothing has been predicted yet, and finer fields are tried all the same.
    pub field_risen: [f64; 2],
    /// Contacts for every unknown of a field at least: where blocks are left out, where single contacts are, and of a smoothed field, whose cost
    /// tells what contacts do not.
    pub field_per_unknown: [f64; 3],
    /// Difference of heights between contacts over nearly the same place, in units of the relief, above which they lie on several sheets: two
    /// that go round a body differ by as much as the relief, and no field comes nearer to both.
    pub field_sheets: f64,
    /// Pairs of contacts from which on it is asked how errors of places across z compare to those along it. Fewer lie so far apart that the
    /// shape's departure differs between them.
    pub place_pairs: usize,
    /// Prior probability of a ratio of their variances that is neither 0 nor 1, over that of those two.
    pub other_ratio: f64,
    /// Mean square of the normals' z below which a patch stands upright, and ratios below 1 are not asked for.
    pub stands_upright: f64,
    /// Share of the scale of distances from the surface below which differences between neighbours are no errors of single contacts, but how
    /// errors that neighbours share, or a departure, change from one to the next.
    pub single_errors: f64,
    /// Multiple of the scale of differences between neighbours beyond which one is a blunder.
    pub place_blunder: f64,
    /// Log odds against a sensor whose normals are all turned by one angle, or all too steep by one factor: one in twenty.
    pub rare_error: f64,
    /// Cells from which on positions tell a surface by themselves, and such an error is asked for: twice the unknowns of the general surface.
    /// Five touches whose heights hardly bend had a gain that turned a cap into a cup.
    pub rare_error_from: usize,
    /// Prior standard deviation of either angle that all normals may be turned by, at most, in radians: three degrees, as of what is mounted by
    /// eye. Eight are found as well, for contacts tell an angle to a tenth of that. And the same over the scatter of normals: those that err by
    /// 0.4 degrees may be turned by three. A sensor whose normals are exact is not askew: positions would then have to say how the patch lies,
    /// and what a step between the two leaves is more than such normals err by.
    pub tilt: [f64; 2],
    /// Prior standard deviation of the gain, by which all slopes are too steep. Slopes that are wrong by half are within 2.5 of it; for precise
    /// normals its size hardly counts.
    pub gain: f64,
    /// Multiple of that up to which a gain is believed. On a plane whose normals lean by an angle of their own "95 % flatter" would say it.
    pub most_gains: f64,
    /// Share of the relief, and multiple of the differences between nearest contacts, that errors which neighbours share may be as large as.
    pub shared_up_to: [f64; 2],
    /// Multiple of the larger of both beyond which such errors are not considered.
    pub shared_beyond: f64,
    /// Length of the mean normal below which contacts go round more than half a body and are no patch: half a cylinder has 0.64, half a ball 0.5.
    pub round_patch: f64,
    /// Share of outliers above which the contacts of a patch are several things, not one with a few errors.
    pub most_outliers: f64,
    /// Share of the contacts off a surface of constant curvatures that a smooth departure has to explain for them to belong. Where it explains
    /// fewer, something else lies beside the surface, as the shoulders beside a bullet's land, and what a departure takes of that is no shape.
    pub taken_back: f64,
    /// Contacts from which on that is asked: of fewer, a departure of third and fourth degree would follow any.
    pub taken_back_from: usize,
    /// Contacts from which on outliers of a patch are set aside: six parameters leave too few of fewer to tell what single ones scatter by, and a
    /// third of the patches that were touched at 7 to 10 places were refused.
    pub outliers_from: usize,
    /// Median error of the normals, radians, below which they contradict nothing, and the multiple of what another surface leaves of it
    /// above which they contradict the surface that positions found.
    pub normals_lean: [f64; 2],
    /// Factor by which that other surface may lie farther from the positions.
    pub told_as_near: f64,
    /// Error of a position over that of a normal, in radians, that is supposed before either is known: 0.05 mm over a patch of 5 mm, beside 3
    /// degrees.
    pub place_over_normal: f64,
    /// Log evidence by which departures must be behind the kinds without one, to be asked under two covariances alone. Estimates hardly move by
    /// it (`benches/runs/coverage.md`); more would ask all 25 of most balls and bars, for a share that the estimate does not see.
    pub outdone: f64,
    /// Probability of a departure from which on the equations are placed again, about the surface that departs.
    pub second_look: f64,
    /// Share of the changes from which on they are placed once more, where a body is the likeliest surface: it has no prior that would hide what
    /// a step leaves. R of an ellipsoid that is touched precisely, 9 by 6 by 5 under a patch of 8 by 8, is inside in 94 instead of 81 of 100
    /// fits; elsewhere it would cost a fifth more time.
    pub nearer_body: f64,
    /// Log evidence by which a body in the form that is nearest to the likeliest surface may be behind that, to be asked in a nearer form.
    pub hopeless_form: f64,
    /// Contacts below which normals count little for the errors of positions.
    pub few_positions: usize,
    /// Share by which they then count: with all of them, intervals of R hold the truth in 88 to 93 of 100 patches of 4 to 8 contacts.
    pub normals_of_few: f64,
    /// Degrees of freedom that the errors of few positions have from those of the normals.
    pub supposed_freedom: f64,
    /// Length of the mean normal above which it tells the direction that a patch faces.
    pub tells_up: f64,
    /// Spread across over spread along below which the contacts of a patch are on one line: one finger's path, whose sideways errors say
    /// nothing of the bend across it. Three paths a tenth of their length apart have 0.08.
    pub thin_patch: f64,
    /// Contacts beyond which it is asked whether normals were computed from the positions. Fewer are touches, whose normals a sensor gave.
    pub derived_from: usize,
    /// Correlation above which they were: seven scans have 0.34 to 0.86; measured normals have 0.06 and less, with a scatter of 0.07 where 200
    /// contacts are asked. And the share of how planes through neighbours turn that errors of the positions must explain, for that to be told
    /// from the bend of the shape: scans have 0.25 to 1.7, 300 measured normals on bodies whose places err by up to 0.3 % of their size hardly
    /// any. Where places err by 1.5 %, such measured normals have 0.2 to 0.7 as well, and are not told from derived ones by it.
    pub normals_derived: [f64; 2],
    /// Cosine below which a normal contradicts the surface: 60 degrees off.
    pub normal_against: f64,
    /// Contacts in a cell, on the mean, up to which it is asked how they scatter within it: by more of them a mean is known to less than a tenth
    /// of a contact's error, which the splines of a departure do not follow, and a bound that low sends the search to other errors instead. An
    /// image of 640 x 480 with slopes had S off by twice as much with it, one of 160 x 120 by less.
    pub crowded_cells: f64,
    /// Degrees of freedom from which on that scatter is told: to a twentieth.
    pub scatter_freedom: f64,
    /// Ratio of the variances that planes and quadrics leave up to which cells bend by less than contacts scatter.
    pub bent_cells: f64,
    /// Least eigenvalue below which places lie on a conic, whose heights do not tell a bend. Three by three touches have 0.13, a ring that is
    /// wide by a tenth of its radius 2e-3, one whose touches scatter by a hundredth of it 2e-4: what the latter tell of the bend is what they
    /// err by.
    pub on_conic: f64,
    /// Surfaces that are drawn of a body that may explain a patch and whose own interval is asked for.
    pub heard_draws: usize,
    /// Share of a patch's draws that touches are predicted on: 128 of 400. With all of them a look takes three times as long, and u(R) after 60
    /// touches is a tenth smaller on balls and the same on other bodies (`benches/runs/explore.md`).
    pub draws_touched: f64,
    /// Standard uncertainty of S, and of R relative to it, that splines leave of a departure and of a body however precise the contacts are:
    /// five segments hold a bump or a wave over the patch no better. R of 196 touches with hardly any noise (1e-6 of the relief) is 0.0005 too
    /// large, and S of a bump 0.001 too small. Bodies they hold better: S and R of an ellipsoid of half axes 9, 6 and 5 that is touched without
    /// noise over 8 by 8 are off by 6e-5 and 7e-5.
    pub left_by_splines: [f64; 2],
    /// Growth from one distance between neighbours to the next longer one that tells repeats of a site from its neighbours: repeats differ by
    /// noise, sites by the step of the finger. Along a finger and across fingers the steps differ less.
    pub site_from_repeats: f64,
    /// Share of the reach of contacts by which a point of a patch's map may lie outside their outline. Errors move the contacts on the outline
    /// by less than their distance from each other, and the edge of an even grid would otherwise be inside here and outside there.
    pub beyond_outline: f64,
    /// Prior standard deviation of the logarithms of an ellipsoid's half axes about their mean, in two directions across it.
    pub half_axes: f64,
    /// Contacts from which on shape is looked for that is finer than a free surface follows: a correlation of a half is then certain.
    pub finer_from: usize,
    /// Standard deviations of a correlation of chance above which what contacts lie off such a surface is finer shape.
    pub finer_certain: f64,
    /// Part of a minority whose distances tell its scatter: a few of the others lie near it by chance.
    pub minority: f64,
    /// Difference of log evidence below which two modes of a kind are one, that was found from several starts.
    pub same_mode: f64,
    /// Radius, in the same unit as lengths, of a cylinder that is as good as a plane for a free surface to be counted from: with 160 its middle
    /// lies 1/80 of a unit above its rim two units away.
    pub wide_as_plane: f64,
    /// Median cosine between normals and those of the surface below which they contradict it, and above which another order of their columns
    /// agrees: 45 and 15 degrees.
    pub normals_order: [f64; 2],
    /// Least variance, over that of the others, of a cell, and of a pair of neighbours, by what is known of errors in x and y: that may be too
    /// much, and a few contacts on level ground or on walls must not decide alone.
    pub least_variance: f64,
    /// Cosine above which a normal has a slope that tells of the height quadric from which a patch's fits begin.
    pub start_upright: f64,
    /// Least relief of a patch over its size, so that planes have one too.
    pub least_relief: f64,
    /// Prior standard deviation of a surface's departure of third and fourth degree, in natural sizes. With 1, intervals of R miss an ellipsoid
    /// of half axes 16, 12 and 9 in 9 to 20 of 100 fits; with 2 in 5 or 6, and intervals of tori are up to a fifth wider; 4 gains nothing.
    pub natural_departure: f64,
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
            sure_of_patch: 0.998,
            taper_asked: 600,
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
            sensor_departs: [1.0 / 40.0, 1.0 / 8.0],
            sensor_over_scatter: 2.0,
            sensor_of_relief: 0.5,
            shared_of_departure: 0.05,
            shared_refuted: 0.1,
            departure_ahead: 8.0,
            heard: 0.25,
            either_reading: 0.5,
            departed: 0.8,
            alike: 2.0,
            simpler: 4.0,
            other_departures: 0.25,
            looser: 0.5,
            reference: 0.25,
            reference_misfit: 1.5,
            simple_misfit: 2.0,
            unseen: 10.0,
            doubt_of_interval: [4.0, 0.05],
            doubt_of_class: [8.0, 0.1],
            look_ahead: 2.0,
            plane_ahead: 8.0,
            plane_steepest: 0.5,
            unsaid_of_relief: 0.25,
            unexplained_of_relief: 0.5,
            pattern_by_chance: 0.01,
            pattern_certain: 1e-3,
            sensor_of_size: 0.1,
            waves: [2.0, 5.0, 0.3],
            deep_waves: 0.03,
            bend_of_waves: 0.5,
            field_predicts: 0.5,
            field_better: 0.5,
            field_nearer: 0.95,
            field_averaged_from: 400,
            field_level: 0.7,
            field_folded: 0.45,
            field_back: [0.1, 0.1],
            field_as_good: 1.05,
            field_risen: [1.5, 0.5],
            field_per_unknown: [3.0, 1.3, 1.0],
            field_sheets: 0.7,
            place_pairs: 100,
            other_ratio: 1.0 / 8.0,
            stands_upright: 0.5,
            single_errors: 0.5,
            place_blunder: 6.0,
            rare_error: 3.0,
            rare_error_from: 12,
            tilt: [0.05, 8.0],
            gain: 0.2,
            most_gains: 3.0,
            shared_up_to: [0.1, 2.0],
            shared_beyond: 1.5,
            round_patch: 0.3,
            most_outliers: 0.25,
            taken_back: 0.75,
            taken_back_from: 18,
            outliers_from: 12,
            normals_lean: [5e-3, 3.0],
            told_as_near: 2.0,
            place_over_normal: 0.2,
            outdone: 5.0,
            second_look: 0.05,
            nearer_body: 0.1,
            hopeless_form: 16.0,
            few_positions: 12,
            normals_of_few: 0.25,
            supposed_freedom: 1.0,
            tells_up: 0.3,
            thin_patch: 0.03,
            derived_from: 200,
            normals_derived: [0.25, 0.1],
            normal_against: 0.5,
            crowded_cells: 100.0,
            scatter_freedom: 200.0,
            bent_cells: 2.0,
            on_conic: 1e-3,
            heard_draws: 100,
            draws_touched: 0.32,
            left_by_splines: [5e-4, 1e-4],
            site_from_repeats: 5.0,
            beyond_outline: 0.03,
            half_axes: 0.35,
            finer_from: 40,
            finer_certain: 4.0,
            minority: 0.8,
            same_mode: 1e-3,
            wide_as_plane: 160.0,
            normals_order: [0.71, 0.966],
            least_variance: 0.1,
            start_upright: 0.3,
            least_relief: 0.02,
            natural_departure: 2.0,
        }
    }
}

impl Tuning {
    /// Scatter, in the same unit as lengths, of contacts that are as likely as those that belong to nothing: anywhere within the reach.
    pub(crate) fn scatter_of_none(&self) -> f64 {
        self.reach / (2.0 * PI * E).sqrt()
    }
}
