//! Which hypotheses are asked: every kind and departure under errors that neighbours share more and more, until it has no chance.
//!
//! ```text
//! kernels      rho = 0, then for every length rho = 0.1, 1, ..      a family leaves a chain once it has fallen and is hopeless
//! sizes        g = 10^-2 .. 10^8, from where the kernel before had its best one, up and down until they have fallen and are hopeless
//! hopeless     log evidence of the best - 8
//! ```
//!
//! A family is a kind with a departure, of whatever size. Its best size hardly moves from one kernel to the next.

use faer::Mat;

use crate::recognition::discrepancy::{Body, is_free};
use crate::recognition::equations::{Rows, first_of_displacement};
use crate::recognition::kinds::{Kind, Model};
use crate::recognition::noise::{Factors, Kernel};

use super::linearised::Linearised;
use super::marginal_likelihood::{Evidence, Look};
use super::node::{Departure, Node, POWERS, highest, likeliest};
use super::search_context::SearchContext;
use super::whitened::Whitened;
use palpate_numeric::threads;

/// Log evidence below the best at which stronger correlations, or other sizes, are not tried once it falls: a weight of 3e-4.
const HOPELESS: f64 = 8.0;

/// A kind with a departure, of whatever size.
#[derive(Clone, Copy)]
struct Family<'a> {
    model: &'a Model,
    /// The departure at some size.
    departure: Departure,
}

impl Family<'_> {
    fn is_plain(&self) -> bool {
        self.departure == Departure::None
    }

    /// Whether other families of its group may have all the weight. Simple kinds, rough splines and forms that are free keep a share
    /// of the interval whatever the evidence says of others.
    fn may_be_outdone(&self) -> bool {
        self.departure.process().is_some_and(|process| !is_free(process))
    }
}

/// Where a family stands in its chain of kernels.
#[derive(Clone, Copy)]
struct KernelChain {
    /// Power of ten of its best size under the last kernel.
    power: i32,
    best: f64,
    last: f64,
}

impl KernelChain {
    /// After a kernel; `None` where the family has fallen and is hopeless, or has no size that shared errors of this size allow.
    /// `of_all` is the best of all departures.
    fn after(before: Option<KernelChain>, nodes: &[(i32, Node)], of_all: f64) -> Option<KernelChain> {
        let (power, top) = best_of(nodes)?;
        let is_over = |c: KernelChain| top < c.best.max(of_all) - HOPELESS && top <= c.last;
        if before.is_some_and(is_over) {
            return None;
        }
        Some(KernelChain { power, best: before.map_or(top, |before| before.best.max(top)), last: top })
    }
}

/// The best of nodes with their sizes: its power of ten and its log evidence.
fn best_of(nodes: &[(i32, Node)]) -> Option<(i32, f64)> {
    let each = nodes.iter().map(|(power, node)| (*power, node.log_evidence));
    each.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// What one kernel gives.
struct OfKernel {
    kernel: usize,
    gram: Mat<f64>,
    nodes: Vec<Node>,
    /// Of every family.
    courses: Vec<Option<KernelChain>>,
}

/// A search that has asked the kinds without a departure everywhere, and departures where neighbours share no errors.
pub(crate) struct PartialEvidence<'a> {
    evidence: Evidence<'a>,
    rows: &'a Rows,
    factors: &'a Factors<'a>,
    /// Of the kinds without a departure.
    plain: Vec<Node>,
    displaced: Vec<Family<'a>>,
    white: Option<OfKernel>,
}

impl<'a> PartialEvidence<'a> {
    /// Nodes from which a second look can start, where a displaced surface is far ahead of the kinds without a departure under every
    /// kernel: those kinds and the likeliest of the other families. `None` elsewhere.
    pub(super) fn displaced_at_once(&self) -> Option<Vec<Node>> {
        let white = self.white.as_ref()?;
        let likeliest = likeliest(&white.nodes)?;
        if likeliest.log_evidence < highest(&self.plain) + HOPELESS {
            return None;
        }
        let own = |family: &Family| family.departure.is_like(likeliest.departure);
        let (families, courses): (Vec<Family>, Vec<Option<KernelChain>>) =
            self.displaced.iter().zip(&white.courses).filter(|(family, _)| own(family)).unzip();
        let chains = self.evidence.of_chains(self.rows, self.factors, &families, &courses);
        let found = white.nodes.iter().cloned().chain(chains.into_iter().flat_map(|found| found.nodes));
        Some(self.plain.iter().cloned().chain(found).collect())
    }

    /// The evidence, and all nodes that the data and the limit of shared errors allow. Where departures are outdone without shared errors
    /// and with those that the kinds without one need most, they are asked there alone: errors that neighbours share take up what would
    /// speak for a departure.
    pub(crate) fn finished(self) -> (Evidence<'a>, Vec<Node>) {
        let PartialEvidence { mut evidence, rows, factors, plain: mut nodes, displaced, white } = self;
        let courses = after(white.as_ref(), &displaced);
        let behind = evidence.tuning.outdone;
        let outdone = |found: &OfKernel| {
            let of_plain = nodes.iter().filter(|node| node.kernel == found.kernel);
            highest(&found.nodes) < highest(of_plain) - behind
        };
        let there = |kernel| evidence.of_kernel(rows, factors, kernel, &displaced, &courses);
        // the second kernel is that of the likeliest kind, where it is another
        let second = likeliest(&nodes).map(|node| node.kernel).filter(|kernel| *kernel != 0);
        let alone = white.as_ref().filter(|white| outdone(white)).map(|_| second.and_then(there));
        let rest = match alone {
            Some(there) if there.as_ref().is_none_or(outdone) => there.into_iter().collect(),
            _ => evidence.of_chains(rows, factors, &displaced, &courses),
        };
        evidence.keep(white.into_iter().chain(rest), &mut nodes);
        (evidence, nodes)
    }
}

impl<'a> Evidence<'a> {
    /// Begins with all that these equations and the limit of shared errors allow.
    pub(crate) fn begun(at: SearchContext<'a>, linearised: &'a Linearised, look: Look) -> PartialEvidence<'a> {
        let mut evidence = Evidence::unasked(at, linearised, look);
        let (rows, factors) = (&linearised.rows, &at.factors.positions);
        let (kinds, displaced): (Vec<Family>, Vec<Family>) =
            evidence.families().into_iter().partition(Family::is_plain);
        let plain = evidence.of_all_kernels(&rows.of_models(), factors, &kinds);
        let white = evidence.of_kernel(rows, factors, 0, &displaced, &at_smallest(&displaced));
        PartialEvidence { evidence, rows, factors, plain, displaced, white }
    }

    /// The evidence of the second look under one kernel alone.
    pub(super) fn under(at: SearchContext<'a>, linearised: &'a Linearised, kernel: usize) -> (Evidence<'a>, Vec<Node>) {
        let mut made = Evidence::unasked(at, linearised, Look::Second);
        let (families, factors) = (made.families(), &at.factors.positions);
        let found = made.of_kernel(&linearised.rows, factors, kernel, &families, &at_smallest(&families));
        let mut nodes = Vec::new();
        made.keep(found, &mut nodes);
        (made, nodes)
    }

    /// Log evidence of a node's hypothesis under these equations, with what the errors of the normals add.
    pub(super) fn of_hypothesis(node: &Node, at: SearchContext, linearised: &Linearised) -> Option<f64> {
        let made = Evidence::unasked(at, linearised, Look::Second);
        let white = Whitened::new(&linearised.rows, &at.factors.positions, node.kernel, first_of_displacement())?;
        let model = made.models.iter().find(|model| model.kind() == node.kind)?;
        Some(made.node(model, &white, node.departure)?.log_evidence + linearised.log_share())
    }

    /// Every kind, and the general one with every departure.
    fn families(&self) -> Vec<Family<'a>> {
        let rough = if self.look == Look::First { Departure::Rough(1.0) } else { Departure::Both(1.0) };
        let processes = self.displacement.map_or(&[][..], |d| &d.smooth);
        let seen = (0..processes.len()).filter(|&process| processes[process].1 > 0);
        let smooth = seen.map(|process| Departure::Smooth { variance: 1.0, process });
        // over a plane the general surface is none of two constant curvatures, nor near one
        let natural = (!self.over_plane).then_some(Departure::Natural);
        let near = |body: &Body| self.displacement.is_some_and(|d| d.bodies[body.number()].1 > 0);
        let bodies = Body::ALL.into_iter().filter(near).map(Departure::Body);
        let departures: Vec<Departure> = std::iter::once(rough).chain(smooth).chain(natural).chain(bodies).collect();
        let mut families = Vec::new();
        for model in self.models {
            if model.kind() != Kind::General || !self.over_plane {
                families.push(Family { model, departure: Departure::None });
            }
            if model.kind() == Kind::General && self.displacement.is_some() {
                families.extend(departures.iter().map(|&departure| Family { model, departure }));
            }
        }
        families
    }

    /// Nodes of these families under the first kernel and all others that give them a chance.
    fn of_all_kernels(&mut self, rows: &Rows, factors: &Factors, families: &[Family]) -> Vec<Node> {
        let white = self.of_kernel(rows, factors, 0, families, &at_smallest(families));
        let courses = after(white.as_ref(), families);
        let chains = self.of_chains(rows, factors, families, &courses);
        let mut nodes = Vec::new();
        self.keep(white.into_iter().chain(chains), &mut nodes);
        nodes
    }

    /// All chains of kernels, from where the families stand after the first one.
    fn of_chains(
        &self,
        rows: &Rows,
        factors: &Factors,
        families: &[Family],
        courses: &[Option<KernelChain>],
    ) -> Vec<OfKernel> {
        let of = |chain| self.of_chain(rows, factors, chain, families, courses);
        threads::map(Kernel::CHAINS, 1, of).into_iter().flatten().collect()
    }

    /// Keeps what kernels gave: their nodes, and the Gram matrices that these need.
    fn keep(&mut self, found: impl IntoIterator<Item = OfKernel>, nodes: &mut Vec<Node>) {
        for found in found {
            self.grams[found.kernel] = Some(found.gram);
            nodes.extend(found.nodes);
        }
    }

    /// The kernels of one length, from weakly to strongly shared errors, until no family has a chance.
    fn of_chain(
        &self,
        rows: &Rows,
        factors: &Factors,
        chain: usize,
        families: &[Family],
        start: &[Option<KernelChain>],
    ) -> Vec<OfKernel> {
        let mut courses = start.to_vec();
        let mut out = Vec::new();
        for kernel in Kernel::chain(chain) {
            let Some(found) = self.of_kernel(rows, factors, kernel, families, &courses) else { continue };
            courses = found.courses.clone();
            out.push(found);
            if courses.iter().all(Option::is_none) {
                break;
            }
        }
        out
    }

    /// All families that still have a chance, under one kernel.
    fn of_kernel(
        &self,
        rows: &Rows,
        factors: &Factors,
        kernel: usize,
        families: &[Family],
        courses: &[Option<KernelChain>],
    ) -> Option<OfKernel> {
        let white = Whitened::new(rows, factors, kernel, first_of_displacement())?;
        let of = |(family, course): (&Family, &Option<KernelChain>)| match course {
            Some(course) => self.of_family(family, &white, course.power),
            None => Vec::new(),
        };
        let found: Vec<Vec<(i32, Node)>> = families.iter().zip(courses).map(of).collect();
        let of_all = highest(found.iter().flatten().map(|(_, node)| node).filter(|node| node.is_displaced()));
        let after = |i: usize| {
            let bar = if families[i].may_be_outdone() { of_all } else { f64::NEG_INFINITY };
            KernelChain::after(courses[i], &found[i], bar)
        };
        let courses = (0..families.len()).map(after).collect();
        let nodes = found.into_iter().flatten().map(|(_, node)| node).collect();
        Some(OfKernel { kernel, gram: white.gram, nodes, courses })
    }

    /// The nodes of a family, smaller departures first: sizes up and down from a power of ten, until others have no chance.
    fn of_family(&self, family: &Family, white: &Whitened, start: i32) -> Vec<(i32, Node)> {
        let node = |departure: Departure| self.node(family.model, white, departure);
        if !family.departure.has_size() {
            return node(family.departure).map(|node| (start, node)).into_iter().collect();
        }
        let (first, last) = POWERS.into_inner();
        let mut best = f64::NEG_INFINITY;
        let mut walk = |powers: &mut dyn Iterator<Item = i32>| {
            let (mut before, mut nodes) = (f64::NEG_INFINITY, Vec::new());
            for power in powers {
                let Some(node) = node(family.departure.of_size(10_f64.powi(power))) else { continue };
                let here = node.log_evidence;
                nodes.push((power, node));
                if here < best - HOPELESS && here <= before {
                    break;
                }
                (before, best) = (here, best.max(here));
            }
            nodes
        };
        let above = walk(&mut (start..=last));
        let mut nodes = walk(&mut (first..start).rev());
        nodes.reverse();
        nodes.extend(above);
        nodes
    }
}

/// Where families stand after the first kernel.
fn after(white: Option<&OfKernel>, families: &[Family]) -> Vec<Option<KernelChain>> {
    white.map_or_else(|| at_smallest(families), |white| white.courses.clone())
}

/// Before any kernel: every family from its smallest departures on.
fn at_smallest(families: &[Family]) -> Vec<Option<KernelChain>> {
    let course = KernelChain { power: *POWERS.start(), best: f64::NEG_INFINITY, last: f64::NEG_INFINITY };
    vec![Some(course); families.len()]
}
