//! Departures over a plane, where a body bends as much as it does over the patch because of them: a bump, a wave.
//!
//! ```text
//! curved base    Q = torus + f along its normals           plane    z = h + (A u^2 + C v^2)/2 + B u v + f(u, v)
//! L = |n - grad f| of either, n its normal                 the same surface: N . n = 1/L
//! log evidence over the plane + sum log(Lp/Lc) (1 + 2 where a normal is known)    beside    that over the curved base
//! ```
//!
//! A smooth process over a curved surface is another prior than one over a plane. The profile `cos x` is smooth in x, and its departure
//! from a circle, as a function of the arc, is not as smooth: smoothed like a process it bends too little at the patch's edges, by 2 %
//! about a line and by 34 % about a circle of radius 10 (`benches/experiments/edge_bias.py`). Bodies that are round as a whole are
//! simpler over the curved base. The evidence tells which, and is compared for the same measured points: a distance along the normal of
//! the plane is L times one along the surface's own normal, and rows of normals are L times as long.

use crate::bodies::Tuning;
use crate::recognition::contacts::is_known;
use crate::recognition::discrepancy::{ChartPoint, Forms, State};
use crate::recognition::equations::Moved;
use crate::recognition::kinds::{Kind, Model};
use palpate_numeric::vector::{Vector, dot};

use super::linearised::Linearised;
use super::marginal_likelihood::Evidence;
use super::node::{Node, highest, likeliest};
use super::relinearise::under_likeliest;

/// A surface that was found, seen from a plane.
pub(super) struct OverPlane {
    pub(super) moved: Moved,
    /// What the longer rows over the plane add to its log evidence.
    pub(super) longer: f64,
}

/// The plane under the likeliest surface; `None` where that does not depart much, or is too steep for a plane.
pub(super) fn over_plane(made: &Linearised, evidence: &Evidence, nodes: &[Node], tuning: &Tuning) -> Option<OverPlane> {
    let likeliest = likeliest(nodes)?;
    let departs = |n: &Node| n.is_displaced() && !n.is_natural() && !n.is_body();
    let others = highest(nodes.iter().filter(|n| !departs(n)));
    if made.over_plane.is_some() || !departs(likeliest) || likeliest.log_evidence < others + tuning.plane_ahead {
        return None;
    }
    let (general, plane) = (of_kind(evidence, Kind::General)?, of_kind(evidence, Kind::Plane)?);
    let [h, a, b, ..] = plane.theta();
    let base = Model::new(Kind::General, [h, a, b, 0.0, 0.0, general.theta()[5]]);
    let found = normals_of(evidence, likeliest, general)?;
    let cells = evidence.cells;
    let (mut longer, mut slopes) = (0.0, [Vec::new(), Vec::new()]);
    for (i, (normal, of_curved)) in found.iter().enumerate() {
        let of_plane = base.distance_and_normal(cells.points[i]).1;
        let [over_plane, over_curved] = [of_plane, *of_curved].map(|n| dot(*normal, n));
        if over_plane.min(over_curved) < tuning.plane_steepest {
            return None;
        }
        let known = cells.normals.as_ref().is_some_and(|normals| is_known(normals.variance[i]));
        longer += (over_curved / over_plane).ln() * if known { 3.0 } else { 1.0 };
        for (slopes, tangents) in slopes.iter_mut().zip(&cells.tangents) {
            slopes.push(dot(of_plane, tangents[i]) - dot(*normal, tangents[i]) / over_plane);
        }
    }
    let slopes = cells.normals.is_some().then_some(slopes);
    let spent = under_likeliest(evidence, &made.rows, nodes)?.spent;
    Some(OverPlane { moved: Moved { base, slopes, spent, kernel: likeliest.kernel, forms: Forms::default() }, longer })
}

fn of_kind<'a>(evidence: &Evidence<'a>, kind: Kind) -> Option<&'a Model> {
    evidence.models.iter().find(|m| m.kind() == kind)
}

/// Normals of a node's likeliest surface, and of the surface that it stands on, at the cells.
fn normals_of(evidence: &Evidence, node: &Node, base: &Model) -> Option<Vec<(Vector, Vector)>> {
    let Model::Constant(_, curved) = base else { return None };
    let displacement = evidence.displacement?;
    let (mean, _) = evidence.joint_posterior(node)?;
    let (x, z) = mean.split_at(node.kind.unknowns());
    let state = State::new(base, x, Some(displacement.coefficients(&evidence.weights_of(node, z))));
    let at = |p: &Vector| {
        let chart = curved.chart(*p);
        let point =
            ChartPoint { chart, place: curved.point(chart[0], chart[1], 0.0), row: Some(displacement.at(chart)) };
        (state.place_and_normal(&point).1, curved.distance_and_normal(*p).1)
    };
    Some(evidence.cells.points.iter().map(at).collect())
}
