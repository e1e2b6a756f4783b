//! The settings that decide how a cloud is cut, each with its default and where that comes from.

use crate::bodies::Tuning;

/// What decides how contacts are cut into parts. The defaults serve a user who names nothing.
///
/// ```
/// use palpate_inference::facade::parts::{PartsOptions, PartsTuning};
///
/// // a cloud of very many small faces
/// let fine = PartsOptions { tuning: PartsTuning { decided_on: 50_000, ..PartsTuning::default() }, ..PartsOptions::default() };
/// assert!(fine.tuning.decided_on > PartsTuning::default().decided_on);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct PartsTuning {
    /// Contacts on which parts are decided at most. Of larger clouds so many, spread over their surface, are cut into parts, and all
    /// contacts are then given to these: how many parts there are, more contacts hardly tell.
    pub decided_on: usize,
    /// Nearest contacts of a place where no part begins at which none is tried, either. With all 20 neighbours a face few contacts wide is
    /// never tried at its middle.
    pub barren: usize,
    /// Share of what a contact costs in its part, below which a region that grows takes it. With twice of it, what lies off an edge grows
    /// over faces that are known, again and again, which takes three times as long; with half of it smooth surfaces fall into more pieces.
    pub steals: f64,
    /// Cosine from which on two normals may be of one smooth face: 45 degrees.
    pub parallel: f64,
    /// Length of the mean normal of the 20 neighbours of a contact, below which they may reach all round a bar, ring or pin that is few
    /// contacts thick: half a ball has a half.
    pub round: f64,
    /// How often parts are looked for again among the contacts that none explains.
    pub again: usize,
    /// Departures in shares of the cloud's size that are let pass, one after another, where contacts depart from their parts side by side:
    /// what was made and handled departs by a hundredth, or by three.
    pub departs: [f64; 2],
    /// Share of the scatter that neighbourhoods show, below which parts are fitted again by what contacts scatter about them.
    pub finer: f64,
    /// Most that a contact costs because its part scatters more than others, over what it costs in no part.
    pub most_price: f64,
    /// Share of a part's contacts that its kind is told by, those nearest to it. A twentieth of a scan may be off its edges, which is thrice
    /// as much of a small face.
    pub own: f64,
    /// Scatter over that of all contacts, beyond which these are no sheet, and no primitive's own. Contacts between two faces at a right
    /// angle scatter by 0.28 spacings; beside noise of a tenth of a spacing and as much let pass, that is twice what is let pass.
    pub loose: f64,
    /// Share of the linked neighbours that are of the same part, from which on contacts are a surface: those of a surface two contacts wide
    /// have a half. What lies between a body and its background is thinner, and its neighbours are of the body.
    pub coherent: f64,
    /// Contacts in parts, as a share, that leave no doubt of these: a twentieth may be off every edge, and half as many are beside joints.
    pub held: f64,
    /// Scatter in spacings below which neighbours show of what kind a surface is.
    pub close: f64,
    /// Scatter of a neighbourhood beside a contact's own, below which its plane takes the place of the contact's own. Two neighbourhoods of
    /// one smooth face differ less: of 13 contacts with the same noise, one in a thousand.
    pub flatter: f64,
    /// Standard deviations by which a contact may be off the plane that it takes.
    pub near_plane: f64,
    /// Scatter of a neighbourhood across its plane over that along it, up to which the plane tells a normal to some five degrees.
    pub flat_places: f64,
    /// Median angle from the planes through neighbours, degrees and over that between normals next to each other, from which on the normals
    /// of a file contradict its places. Planes bend towards edges, and differ from normals by a few degrees there.
    pub contradicts: [f64; 2],
    /// Share of a part's normals that point to its other side, from which on it is not known which is free.
    pub side_doubted: f64,
    /// Contacts of a part that are asked for errors that they share with others, and others of which it is asked: as many as most parts have,
    /// since of few among many none is a neighbour.
    pub shared_asked: [usize; 2],
    /// Ranges of shared errors that are tried, in spacings.
    pub shared_ranges: [f64; 8],
    /// Standard deviations of chance that products of neighbours' residuals must exceed to be shared errors.
    pub shared_clear: f64,
    /// Scatter of measured normals about the surface through 20 neighbours over that through 8, from which on neighbours share errors. Where
    /// errors are independent it is 1.0 to 1.1, and up to 1.3 where contacts are few; of five scans by depth cameras it is 1.39 to 1.58.
    /// Such a cloud is cut by the noise of wide neighbourhoods, and regions grow over each other freely: its waves are no parts.
    pub shared_turns: f64,
    /// Share of a scatter below which another is clearly less.
    pub sharper: f64,
    /// Share of the contacts that one primitive must hold to stand for a cloud.
    pub nearly_all: f64,
    /// Scatter about that primitive, in spacings, up to which it may stand for a cloud without normals that was cut into several parts.
    /// Contacts within a spacing of it resolve no second face; scanned stems, bars and balls scatter by up to 0.7, drawn bodies of several
    /// faces that lie as near have an edge.
    pub one_spacings: f64,
    /// Power with which the number of contacts grows around each of them, from which on they fill a volume. In boxes and balls it is 2.4 and more, for places near the rim have half as many neighbours; on surfaces 2, and up to 2.2 where
    /// noise is a tenth of their size.
    pub volume: f64,
    /// Contacts from which on that is asked.
    pub volume_from: usize,
    /// Neighbours of a contact from which on their growth in number is asked, and one of how many contacts up to which it is: a neighbourhood
    /// of an eighth is half as wide as the whole.
    pub volume_neighbours: [usize; 2],
    /// Most of what tells of shared errors that the unknowns of a fit may take: a range of which they take more could be shape as well.
    pub shared_taken: f64,
    /// Scatter about one primitive over that about two, or about a richer one, beyond which it is not asked whether shared errors make the
    /// difference: a surface that departs by more is another one, whatever it departs by.
    pub merged_scatter: f64,
    /// Ranges of the errors that are then asked for, in distances between cells of contacts.
    pub merged_ranges: [f64; 4],
    /// Variances of these errors over that of a cell's own mean.
    pub merged_shares: [f64; 5],
    /// Neighbours that the surface about a point of `PointShapes` is fitted to, the fewest first: these leave a few degrees of freedom to
    /// heights alone.
    pub jet_sizes: [usize; 4],
    /// Misfit of the next larger neighbourhoods over that of these, beyond which they reach too far.
    pub jet_misfit: f64,
    /// Points whose neighbourhoods are asked for that: noise and bend are then known to some 3 %, which moves no answer by a tenth of its u.
    pub jet_asked: usize,
    /// Distance from a point up to which its surface tells S and R of others, over that of its farthest neighbour. A surface is known nearly
    /// as well there as in its middle. With a half, errors of S grow by up to a tenth, and a tenth of the time is saved.
    pub jet_serves: f64,
    /// Variance that orders which the surface lacks add there, over that of noise: a tenth of it lengthens u by a twentieth.
    pub jet_serves_misfit: f64,
    /// Weight of a point from which on it is wholly on the side of the body that its neighbour's surface is of, which may then serve it: within
    /// a quarter of the radius its distance takes less than a hundredth of it, and a normal that begins to turn away takes the rest.
    pub jet_serves_weight: f64,
    /// Components of a point's own bend against which those of the whole cloud count: they differ from place to place.
    pub jet_belief: f64,
    /// Share of the cloud's size (rms distance from its middle) that a departure must exceed to be a part. Scanners' errors that many
    /// neighbours share are as large; with a third of it, a pipe seen by a depth camera falls into a dozen parts.
    pub unseen: f64,
    /// The same in spacings: contacts do not resolve less.
    pub unresolved: f64,
    /// Departures of normals that go with it, in degrees.
    pub unseen_deg: f64,
    /// The same for normals that were estimated from positions: next to an edge they lie between those of both faces.
    pub blurred_deg: f64,
    /// Cosine between the normals of two contacts near each other below which they are on no one sheet.
    pub faces_away: f64,
    /// Cosine between the normals of two neighbours below which they are on two walls, back to back: within 45 degrees of it. Normals of planes
    /// through neighbours tell no more.
    pub back_to_back: f64,
    /// Share of places that are thought to lie within one part, where it is asked what a primitive leaves over in wide neighbourhoods.
    pub wide_within: f64,
    /// What a pair of neighbours costs that are of different parts, or of different classes where no primitive explains them. A contact with all
    /// 8 neighbours on the other side changes sides unless it costs 6 more there, which noise does once in thirty.
    pub agree: f64,
    /// How often unknowns that mean nothing may seem to, where independent residuals are few.
    pub by_chance: f64,
    /// Independent contacts that a region of no kind has at least: as many as the parabola through neighbours has unknowns.
    pub independent_of_region: f64,
    /// Root mean square departure, in units of the cloud's size, from which on a primitive of the whole cloud is none.
    pub whole_departs: f64,
    /// Scatter about such a primitive over what neighbourhoods show, beyond which it is none of the contacts' own.
    pub whole_loose: f64,
    /// Probability of a lack of fit below which the data reject a primitive, or that half of the cloud's primitives are true. One true primitive
    /// in a hundred is then rejected by chance.
    pub rejected: f64,
    /// Standard uncertainties within which a difference may be chance, an interval of 95 %. Half angles that are so near to zero are those of
    /// cylinders, and curvatures those of planes. Where S or R of a rich field differs by more, one true primitive in twenty is doubted, and
    /// its u is then two to three times that of the field.
    pub clear_u: f64,
    /// Length of the mean normal of a region below which it bends too far for one height field.
    pub field_one_sided: f64,
    /// Fewest pairs of contacts that make a joint: a corner where parts meet in one point has fewer.
    pub joint_pairs: usize,
    /// Turn of the normals below which they are one smooth surface to a reader, in degrees: boundaries are known to half a spacing, which on a
    /// body 12 spacings wide turns a normal by as much.
    pub joint_smooth_deg: f64,
    /// Distances between the two contacts of a pair within which its parts meet: an edge of 30 degrees lies so far from their middle.
    pub joint_reach: f64,
    /// Weight of the step from part to part beside their normals, where sides of parts are to agree. With 2 their mirror image in the plane
    /// halfway along it is taken, which tells nothing where one contact lies at the edge and the other in its face; with twice as much an edge
    /// of any angle tells.
    pub step_weight: f64,
    /// Probability of a primitive's class over that of the likeliest one from which on few touches do not contradict it. Touches that leave open
    /// whether a ridge is a dome give both some half.
    pub few_open: f64,
    /// Share of R by which two fits of few exact contacts may differ: intervals of no width hold no other fit.
    pub few_same: f64,
    /// Length of the mean normal of few contacts beyond which they lie on one side of their part: half a ball has 0.5.
    pub few_one_side: f64,
    /// Cost at which a contact is none of a primitive's: three squares of gaussians exceed it once in a thousand.
    pub cost_of_none: f64,
    /// Share of the neighbourhoods that is thought to lie away from every edge, and the same quantile of a gaussian: both change together. A
    /// quarter of them may then be wrong, and the noise is still that of the smooth ones; with the median, two edges in a small cloud would
    /// raise it.
    pub smooth: [f64; 2],
    /// The settings by which parts that recognition judges are judged: whole clouds, few touches, free regions. By default they are its own,
    /// so that contacts are judged alike whether they are asked for one surface or for parts.
    pub recognition: Tuning,
}

impl Default for PartsTuning {
    fn default() -> PartsTuning {
        PartsTuning {
            decided_on: 12_000,
            barren: 4,
            steals: 1.0,
            parallel: 0.7,
            round: 0.5,
            again: 3,
            departs: [0.01, 0.03],
            finer: 0.8,
            most_price: 0.5,
            own: 0.85,
            loose: 1.5,
            coherent: 0.4,
            held: 0.92,
            close: 0.5,
            flatter: 0.5,
            near_plane: 2.0,
            flat_places: 0.1,
            contradicts: [10.0, 3.0],
            side_doubted: 0.2,
            shared_asked: [300, 6000],
            shared_ranges: [1.0, 1.6, 2.5, 4.0, 6.4, 10.0, 16.0, 25.0],
            shared_clear: 3.0,
            shared_turns: 1.35,
            sharper: 0.5,
            nearly_all: 0.97,
            one_spacings: 1.0,
            volume: 2.35,
            volume_from: 150,
            volume_neighbours: [4, 8],
            shared_taken: 0.75,
            merged_scatter: 3.0,
            merged_ranges: [1.0, 2.0, 4.0, 8.0],
            merged_shares: [0.25, 1.0, 4.0, 16.0, 64.0],
            jet_sizes: [24, 48, 96, 192],
            jet_misfit: 1.1,
            jet_asked: 1024,
            jet_serves: 0.25,
            jet_serves_misfit: 0.1,
            jet_serves_weight: 0.9,
            jet_belief: 10.0,
            unseen: 0.003,
            unresolved: 0.1,
            unseen_deg: 1.0,
            blurred_deg: 15.0,
            faces_away: 0.2,
            back_to_back: -0.7,
            wide_within: 0.3,
            agree: 0.7,
            by_chance: 0.01,
            independent_of_region: 6.0,
            whole_departs: 0.02,
            whole_loose: 3.0,
            rejected: 0.01,
            clear_u: 1.96,
            field_one_sided: 0.6,
            joint_pairs: 6,
            joint_smooth_deg: 5.0,
            joint_reach: 2.0,
            step_weight: 4.0,
            few_open: 0.5,
            few_same: 1e-3,
            few_one_side: 0.5,
            cost_of_none: 16.0,
            smooth: [0.3, -0.5244],
            recognition: Tuning::default(),
        }
    }
}
