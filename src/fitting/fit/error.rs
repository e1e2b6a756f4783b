//! Why contacts give no fit. Every variant says what would be right.

use palpate_geometry::contact::{ContactError, counted};
use palpate_numeric::bspline::SplineError;
use palpate_numeric::solve::SolveError;

/// A fit that cannot be had from this input with these options.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// The data themselves are faulty.
    #[error(transparent)]
    Contacts(#[from] ContactError),
    /// Degree, segments or knots are out of range.
    #[error("{axis}: {source}")]
    Knots {
        /// `x` or `y`.
        axis: &'static str,
        /// What is wrong.
        source: SplineError,
    },
    /// An option is out of range.
    #[error("{option} is {value}: {expected}")]
    Option {
        /// Its name.
        option: &'static str,
        /// What was given.
        value: String,
        /// What would be right.
        expected: &'static str,
    },
    /// A text is no value of an option.
    #[error("{expected}")]
    Word {
        /// What would be right.
        expected: String,
    },
    /// Fewer equations than unknowns.
    #[error(
        "{} from {}, too few for {unknowns} unknowns: add contacts or normals, or lower degree or segments",
        counted(*equations, "equation"),
        counted(*contacts, "contact")
    )]
    TooFew {
        /// Contacts (pixels) with data.
        contacts: usize,
        /// Equations they give.
        equations: usize,
        /// Unknowns n m.
        unknowns: usize,
    },
    /// All contacts lie on one line, or at one point, so they span no patch.
    #[error(
        "all {contacts} contacts lie on one line in x, y, and nothing is known beside it: a surface needs contacts beside the line"
    )]
    Collinear {
        /// Number of contacts.
        contacts: usize,
    },
    /// The domain has no area.
    #[error("the domain [{}, {}] x [{}, {}] has no area: every end must be finite and the upper above the lower", domain[0], domain[1], domain[2], domain[3])]
    Domain {
        /// x0, x1, y0, y1.
        domain: [f64; 4],
    },
    /// A contact lies outside a given domain.
    #[error("contact {index} at ({x}, {y}) lies outside the given domain [{}, {}] x [{}, {}]", domain[0], domain[1], domain[2], domain[3])]
    Outside {
        /// Contact, counted from 0.
        index: usize,
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
        /// x0, x1, y0, y1.
        domain: [f64; 4],
    },
    /// A normal that a height field cannot have.
    #[error(
        "the normal of contact {index} has nz = {nz}: a height field over x, y needs nz > 0 (nz = 0 only in normal rows, the option sigma); try frame = auto"
    )]
    NormalDown {
        /// Contact, counted from 0.
        index: usize,
        /// Its unit normal's z component in the patch frame.
        nz: f64,
    },
    /// A normal too flat for a slope row.
    #[error(
        "the normal of contact {index} has nz = {nz}, so its slope is not finite: use normal rows (sigma = auto, or known standard deviations)"
    )]
    Steep {
        /// Contact, counted from 0.
        index: usize,
        /// Its unit normal's z component.
        nz: f64,
    },
    /// Every normal points down, into the body.
    #[error(
        "all {contacts} normals point down (nz < 0), as if into the body: give flip_normals if they point inward, or frame = auto if the surface really faces down"
    )]
    Inward {
        /// Number of contacts.
        contacts: usize,
    },
    /// The objective needs what the data do not have.
    #[error("{objective} needs {needed}, which the input does not have")]
    Objective {
        /// What was asked for.
        objective: &'static str,
        /// What it needs.
        needed: &'static str,
    },
    /// The method does not apply to these data.
    #[error("method {method} {why}")]
    Method {
        /// Name of the method.
        method: &'static str,
        /// Why not.
        why: &'static str,
    },
    /// No height rows and no slopes: nothing holds the surface.
    #[error("the certificate's rank failed: every weight is zero, nothing is left to fit")]
    NoWeight,
    /// The factorisation failed and the options allow no other method.
    #[error("{source}; method = auto may answer with a reduced rank")]
    Solve {
        /// What failed.
        source: SolveError,
    },
    /// The data determine too little of the surface even for a reduced answer.
    #[error(
        "the certificate's rank failed: {rank} of {unknowns} unknowns are determined and the rest do not lie in gaps; lower degree or segments, or use smooth = auto"
    )]
    Rank {
        /// Numerical rank.
        rank: usize,
        /// Unknowns.
        unknowns: usize,
    },
    /// Least roughness does not determine the coefficients without data.
    #[error(
        "least roughness does not determine the {coefficients} coefficients without enough data ({source}): lower the segments or raise the degree"
    )]
    Gap {
        /// How many coefficients.
        coefficients: usize,
        /// Why the roughness has no factor.
        source: SolveError,
    },
    /// The options ask for a parametric surface where a height field is fitted.
    #[error("a height field has no {option}: leave it out, or fit a parametric surface (surface = parametric)")]
    HeightField {
        /// What was asked for: the surface kind, or a closed direction.
        option: &'static str,
    },
    /// The iteration for normal rows (Gauss-Newton) did not settle.
    #[error(
        "normal rows did not settle in {steps} steps: the last one moved a coefficient by {moved:e} of the largest"
    )]
    NotSettled {
        /// Steps taken.
        steps: usize,
        /// Last relative move.
        moved: f64,
    },
    /// The steps that all loops of a fit share were taken, and the surface still moved.
    #[error(
        "the surface had not settled when all {steps} steps of a fit were taken: check that heights, places and normals are in one unit, give sigma or weights as numbers, or lower degree or segments"
    )]
    StepsSpent {
        /// The steps allowed.
        steps: usize,
    },
    /// The contacts do not lie on one sheet.
    #[error("no parametric surface comes of {}: {why}", counted(*contacts, "contact"))]
    Sheet {
        /// Number of contacts.
        contacts: usize,
        /// What they are instead.
        why: &'static str,
    },
    /// A closed direction needs fingers or stations that come back to where they began.
    #[error("a closed direction needs fingers and stations that go round: {why}")]
    Closed {
        /// What is missing.
        why: &'static str,
    },
    /// The surface bends more between neighbouring contacts than their normals differ: it oscillates between them.
    #[error(
        "the surface bends {bending:.1} times as much as neighbouring contacts felt, {most} at most is believed: take fewer segments, a lower degree or a larger smooth"
    )]
    Runaway {
        /// Largest curvature over what was felt there.
        bending: f64,
        /// What is believed.
        most: f64,
    },
    /// Some normals point to the back of the fitted surface.
    #[error("{against} of {contacts} normals are against the surface that the contacts make: check their side")]
    Against {
        /// Contacts whose normal is on the other side.
        against: usize,
        /// Number of contacts.
        contacts: usize,
    },
    /// A parametric surface that has no tangent plane somewhere.
    #[error("the contacts make no parametric surface to start from: it has no tangent plane somewhere")]
    Degenerate,
    /// The result is not a finite surface.
    #[error(transparent)]
    Surface(#[from] SplineError),
}

impl FitError {
    /// Options that the message proposes, each with the proposed value: `option = value` stands in the message, or the
    /// option alone where the value is empty. A program with option names of its own can put those in their place.
    pub fn remedies(&self) -> &'static [(&'static str, &'static str)] {
        match self {
            FitError::NormalDown { .. } => &[("frame", "auto")],
            FitError::Steep { .. } => &[("sigma", "auto")],
            FitError::Inward { .. } => &[("flip_normals", ""), ("frame", "auto")],
            FitError::Solve { .. } => &[("method", "auto")],
            FitError::Rank { .. } => &[("smooth", "auto")],
            FitError::Runaway { .. } => &[("smooth", "")],
            FitError::HeightField { .. } => &[("surface", "parametric")],
            _ => &[],
        }
    }
}
