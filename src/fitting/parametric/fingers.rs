//! Parameters from fingers and stations: arc length along the fingers' paths (v) and across them (u).
//!
//! ```text
//! v(f, s) = v(f, s - 1) + |P - P'| (t/2)/sin(t/2),  t the angle between both normals
//! u(f, s) alike across the fingers
//! ```
//!
//! Lengths are measured from the middle station and the middle finger, where the paths are aligned; in a closed direction
//! every ring is stretched to the mean period. Repeated contacts share a node, and so do neighbouring stations where there
//! are too many of them: the noise of their positions would add up to length.

use std::collections::BTreeMap;

use super::flattening::Flattening;
use super::patch_contacts::PatchContacts;
use super::vector::{Vector, arc, cross, dot, minus, norm, unit};

/// Most nodes in a direction: between more of them the noise of the positions would add up to length.
const MAX_NODES: usize = 24;

struct Node {
    point: Vector,
    normal: Vector,
    members: Vec<usize>,
}

type Net = Vec<Vec<Option<Node>>>;

/// Flattens contacts with finger and station labels.
///
/// # Errors
/// The reason why the labels do not make one sheet, in words; the caller may flatten without them.
pub(super) fn flatten_by_fingers(contacts: &PatchContacts, closed: [bool; 2]) -> Result<Flattening, &'static str> {
    let labels = contacts.labels.as_ref().ok_or("the contacts have no finger and station")?;
    let net = nodes(contacts, labels);
    let (fingers, stations) = (net.len(), net[0].len());
    let filled = net.iter().flatten().flatten().count();
    if fingers < 2 || stations < 2 || 2 * filled < fingers * stations {
        return Err("fingers and stations do not make a net of lanes");
    }
    let at = |f: usize, s: usize| net[f][s].as_ref();
    let (v, period_v) = lengths(&at, fingers, stations, closed[1]).ok_or("lanes share no station")?;
    let (u, period_u) = lengths(&|s, f| at(f, s), stations, fingers, closed[0]).ok_or("stations share no lane")?;
    let mut places = vec![[0.0; 2]; contacts.len()];
    for f in 0..fingers {
        for s in 0..stations {
            let Some(node) = at(f, s) else { continue };
            let (Some(u), Some(v)) = (u[s][f], v[f][s]) else { return Err("a contact hangs on no lane") };
            let directions = [direction(&|k| at(k, s), f, fingers), direction(&|k| at(f, k), s, stations)];
            for &r in &node.members {
                let off = minus(contacts.points[r], node.point);
                places[r] = [u + dot(off, directions[0]), v + dot(off, directions[1])];
            }
        }
    }
    let side = side(&net, closed)?;
    if side < 0.0 {
        places.iter_mut().for_each(|p| p[0] = period_u.unwrap_or(0.0) - p[0]);
    }
    Ok(Flattening {
        places,
        period: [period_u, period_v],
        triangles: triangles(&net, closed),
        method: "arc lengths of lanes",
    })
}

/// The net of nodes, fingers x stations.
fn nodes(contacts: &PatchContacts, labels: &[[u32; 2]]) -> Net {
    let bins = [0, 1].map(|k| {
        let mut names: Vec<u32> = labels.iter().map(|l| l[k]).collect();
        names.sort_unstable();
        names.dedup();
        let count = names.len().min(MAX_NODES);
        let bin: BTreeMap<u32, usize> = names.iter().enumerate().map(|(i, n)| (*n, i * count / names.len())).collect();
        (bin, count)
    });
    let mut net: Net = (0..bins[0].1).map(|_| (0..bins[1].1).map(|_| None).collect()).collect();
    for (r, label) in labels.iter().enumerate() {
        let node = net[bins[0].0[&label[0]]][bins[1].0[&label[1]]].get_or_insert(Node {
            point: [0.0; 3],
            normal: [0.0; 3],
            members: Vec::new(),
        });
        node.members.push(r);
        (0..3).for_each(|k| node.point[k] += contacts.points[r][k]);
        (0..3).for_each(|k| node.normal[k] += contacts.normals[r][k]);
    }
    for node in net.iter_mut().flatten().flatten() {
        let count = node.members.len() as f64;
        node.point = node.point.map(|p| p / count);
        node.normal = unit(node.normal);
    }
    net
}

type Lengths = Vec<Vec<Option<f64>>>;

/// Arc length of every node along its line of nodes, with the lines aligned, and the mean period of closed lines.
fn lengths<'a>(
    at: &dyn Fn(usize, usize) -> Option<&'a Node>,
    lines: usize,
    count: usize,
    closed: bool,
) -> Option<(Lengths, Option<f64>)> {
    let mut all: Lengths = vec![vec![None; count]; lines];
    let mut periods = Vec::new();
    for (line, out) in all.iter_mut().enumerate() {
        let (mut sum, mut last, mut first) = (0.0, None::<&Node>, None);
        for k in 0..count {
            let Some(node) = at(line, k) else { continue };
            if let Some(last) = last {
                sum += arc(last.point, node.point, last.normal, node.normal);
            }
            out[k] = Some(sum);
            last = Some(node);
            first = first.or(Some(node));
        }
        let (Some(first), Some(last)) = (first, last) else { continue };
        periods.push((line, sum + arc(last.point, first.point, last.normal, first.normal)));
    }
    let mean = periods.iter().map(|p| p.1).sum::<f64>() / periods.len().max(1) as f64;
    if closed {
        for (line, period) in &periods {
            all[*line].iter_mut().flatten().for_each(|v| *v *= mean / period);
        }
    }
    align(&mut all, if closed { 0 } else { count / 2 })?;
    Some((all, closed.then_some(mean)))
}

/// Shifts every line so that node `anchor` has length 0. A line without that node is shifted so that it agrees in the
/// mean with one that has it.
fn align(all: &mut Lengths, anchor: usize) -> Option<()> {
    let reference = (0..all.len()).min_by_key(|line| {
        let missing = all[*line][anchor].is_none();
        (missing, line.abs_diff(all.len() / 2))
    })?;
    let shift = |line: &mut Vec<Option<f64>>, by: f64| line.iter_mut().flatten().for_each(|v| *v -= by);
    if let Some(zero) = all[reference][anchor] {
        shift(&mut all[reference], zero);
    }
    let guide = all[reference].clone();
    for (_, line) in all.iter_mut().enumerate().filter(|(k, _)| *k != reference) {
        if let Some(zero) = line[anchor] {
            shift(line, zero);
            continue;
        }
        let differences: Vec<f64> = line.iter().zip(&guide).filter_map(|(a, b)| Some((*a)? - (*b)?)).collect();
        if differences.is_empty() && line.iter().any(Option::is_some) {
            return None;
        }
        let mean = differences.iter().sum::<f64>() / differences.len().max(1) as f64;
        shift(line, mean);
    }
    Some(())
}

/// Unit direction of a line at node k, from its neighbours.
fn direction<'a>(at: &dyn Fn(usize) -> Option<&'a Node>, k: usize, count: usize) -> Vector {
    let before = (0..k).rev().find_map(at).or(at(k));
    let after = (k + 1..count).find_map(at).or(at(k));
    match (before, after) {
        (Some(before), Some(after)) => unit(minus(after.point, before.point)),
        _ => [0.0; 3],
    }
}

/// Quadrilaterals of the net: `(f, s)` with the next finger and the next station; closed directions wrap.
fn corners(net: &Net, closed: [bool; 2]) -> Vec<[(usize, usize); 4]> {
    let (fingers, stations) = (net.len(), net[0].len());
    let mut all = Vec::new();
    for f in 0..fingers - usize::from(!closed[0]) {
        for s in 0..stations - usize::from(!closed[1]) {
            let (g, t) = ((f + 1) % fingers, (s + 1) % stations);
            all.push([(f, s), (g, s), (f, t), (g, t)]);
        }
    }
    all
}

/// +1 where fingers x stations (a vector product) points to the side of the normals, -1 where it points to the other.
fn side(net: &Net, closed: [bool; 2]) -> Result<f64, &'static str> {
    let (mut with, mut against) = (0usize, 0usize);
    for [a, b, c, d] in corners(net, closed) {
        let corner = |at: (usize, usize)| net[at.0][at.1].as_ref();
        let (Some(a), Some(b), Some(c), Some(d)) = (corner(a), corner(b), corner(c), corner(d)) else { continue };
        let area = cross(minus(d.point, a.point), minus(c.point, b.point));
        for normal in [a, b, c, d].map(|node| node.normal) {
            let sine = dot(area, normal) / norm(area).max(f64::MIN_POSITIVE);
            with += usize::from(sine > 0.2);
            against += usize::from(sine < -0.2);
        }
    }
    match (with, against) {
        (0, 0) => Err("all contacts lie on one curve, or no four of them make a cell"),
        (_, 0) => Ok(1.0),
        (0, _) => Ok(-1.0),
        _ => Err("lanes fold or cross, or normals change sides"),
    }
}

/// Two triangles of contacts for every quadrilateral.
fn triangles(net: &Net, closed: [bool; 2]) -> Vec<[usize; 3]> {
    let mut all = Vec::new();
    for corner in corners(net, closed) {
        let ends = corner.map(|(f, s)| net[f][s].as_ref().map(|node| node.members[0]));
        if let [Some(a), Some(b), Some(c), Some(d)] = ends {
            all.extend([[a, b, d], [a, d, c]]);
        }
    }
    all
}
