//! Parameters of scattered contacts: landmark Isomap whose edges are arcs: chords corrected by the angle
//! between the normals.
//!
//! ```text
//! graph     every node with the nearest one in each of eight sectors of its tangent plane (Yao graph)
//! d(a, b)   shortest path along it, edges |P - P'| (t/2)/sin(t/2), t the angle between the normals
//! B = -1/2 J D^2 J = V diag(l) V'    landmarks at sqrt(l_1) V_1, sqrt(l_2) V_2; the others by Gower's formula
//! ```
//!
//! J. B. Tenenbaum, V. de Silva, J. C. Langford, *Science* 290 (2000) 2319; landmarks as V. de Silva and J. B. Tenenbaum,
//! Stanford 2004; A. C. Yao, *SIAM J. Comput.* 11 (1982) 721. The plane is then rotated so that its bounding box is smallest.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use faer::Mat;

use palpate_geometry::convex_hull::convex_hull;
use palpate_numeric::linalg::{Eigen, eigen};

use super::flattening::Flattening;
use super::patch_contacts::PatchContacts;
use super::vector::{Vector, arc, cross, dot, minus, norm, unit};

/// Most nodes. More contacts than that share nodes, since building the graph visits every pair.
const MAX_NODES: usize = 1500;
/// Most landmarks, which is the order of the eigenproblem.
const MAX_LANDMARKS: usize = 100;
/// Sectors of the Yao graph.
const SECTORS: usize = 8;
/// Least cosine between the normals of neighbours: below it an edge would join two opposite sides of a body.
const LEAST_COSINE: f64 = -0.2;
/// Ratio of the second to the first principal spread of the flat picture, below which the contacts lie on one curve.
const CURVE: f64 = 1e-3;

struct Node {
    point: Vector,
    normal: Vector,
    members: Vec<usize>,
}

/// Flattens contacts without finger and station labels.
///
/// # Errors
/// The reason why they are not a single sheet, in words.
pub(super) fn flatten_scattered(contacts: &PatchContacts) -> Result<Flattening, &'static str> {
    let nodes = nodes(contacts);
    if nodes.len() < 4 {
        return Err("fewer than four contacts at different places");
    }
    let edges = graph(&nodes);
    let landmarks = landmarks(&nodes);
    let distances: Vec<Vec<f64>> = landmarks.iter().map(|l| shortest(&edges, *l)).collect();
    if distances[0].iter().any(|d| d.is_infinite()) {
        return Err(
            "the contacts fall into parts whose normals do not meet: more than one sheet, or normals that change sides",
        );
    }
    let mut flat = scaled(&landmarks, &distances).ok_or("all contacts lie on one curve")?;
    rotate_to_box(&mut flat);
    let mut places = vec![[0.0; 2]; contacts.len()];
    let mut side = [0usize; 2];
    for (k, node) in nodes.iter().enumerate() {
        let Some(gradient) = gradient(k, &nodes, &edges, &flat) else {
            return Err("all contacts lie on one curve");
        };
        side[usize::from(dot(cross(gradient[0], gradient[1]), node.normal) < 0.0)] += 1;
        for &r in &node.members {
            let off = minus(contacts.points[r], node.point);
            places[r] = [0, 1].map(|a| flat[k][a] + dot(gradient[a], off));
        }
    }
    if 10 * side[0].min(side[1]) > nodes.len() {
        return Err("normals change sides from contact to contact, or the contacts fold over");
    }
    if side[1] > side[0] {
        places.iter_mut().for_each(|p| p[0] = -p[0]);
    }
    Ok(Flattening {
        places,
        period: [None; 2],
        triangles: Vec::new(),
        method: "landmark Isomap with arcs by the normals",
    })
}

/// The contacts, or their means over cubes, which are as small as [`MAX_NODES`] permits.
fn nodes(contacts: &PatchContacts) -> Vec<Node> {
    let (lo, hi) = contacts.points.iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(lo, hi), p| {
        ([0, 1, 2].map(|k| lo[k].min(p[k])), [0, 1, 2].map(|k| hi[k].max(p[k])))
    });
    let size = norm(minus(hi, lo));
    let mut side = 1e-9 * size;
    loop {
        let cube = |p: &Vector| [0, 1, 2].map(|k| ((p[k] - lo[k]) / side.max(f64::MIN_POSITIVE)).floor() as i64);
        let mut bins: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
        contacts.points.iter().enumerate().for_each(|(r, p)| bins.entry(cube(p)).or_default().push(r));
        if bins.len() <= MAX_NODES || side > size {
            let mut nodes: Vec<Node> = bins.into_values().map(|members| node(contacts, members)).collect();
            // the order of the cubes depends on the axes, the first landmark must not
            nodes.sort_by_key(|n| n.members[0]);
            return nodes;
        }
        side = if side < 1e-3 * size { 1e-3 * size } else { 1.5 * side };
    }
}

fn node(contacts: &PatchContacts, members: Vec<usize>) -> Node {
    let count = members.len() as f64;
    let sum = |all: &[Vector]| members.iter().fold([0.0; 3], |m, r| [0, 1, 2].map(|k| m[k] + all[*r][k] / count));
    Node { point: sum(&contacts.points), normal: unit(sum(&contacts.normals)), members }
}

type Edges = Vec<Vec<(usize, f64)>>;

/// A length counts as shorter only below this share of the other, so that among equal lengths the first contact wins
/// whatever their rounding.
const SHORTER: f64 = 1.0 - 1e-9;
/// The first sector begins this share of a sector before the nearest neighbour, so that the neighbours of regular
/// patterns do not lie on a border between sectors.
const BEFORE: f64 = 0.37;

/// Tangents at node `a`, the first towards its nearest neighbour, so that the sectors rotate with the contacts.
fn towards_nearest(a: usize, nodes: &[Node]) -> Option<[Vector; 2]> {
    let node = &nodes[a];
    let mut nearest = (f64::INFINITY, [0.0; 3]);
    for (b, other) in nodes.iter().enumerate() {
        let d = minus(other.point, node.point);
        let flat = [0, 1, 2].map(|k| d[k] - dot(d, node.normal) * node.normal[k]);
        let length = dot(d, d);
        if a != b && length < SHORTER * nearest.0 && dot(flat, flat) > 1e-6 * length {
            nearest = (length, flat);
        }
    }
    nearest.0.is_finite().then(|| {
        let e1 = unit(nearest.1);
        [e1, cross(node.normal, e1)]
    })
}

/// The Yao graph: every node with the nearest one in each sector.
fn graph(nodes: &[Node]) -> Edges {
    let mut edges: Edges = vec![Vec::new(); nodes.len()];
    for (a, node) in nodes.iter().enumerate() {
        let Some([e1, e2]) = towards_nearest(a, nodes) else { continue };
        let mut nearest = [(f64::INFINITY, usize::MAX); SECTORS];
        for (b, other) in nodes.iter().enumerate() {
            let d = minus(other.point, node.point);
            let length = dot(d, d);
            if a == b || dot(node.normal, other.normal) < LEAST_COSINE {
                continue;
            }
            let angle = dot(d, e2).atan2(dot(d, e1)) / std::f64::consts::TAU + BEFORE / SECTORS as f64;
            let sector = ((angle.rem_euclid(1.0) * SECTORS as f64) as usize).min(SECTORS - 1);
            if length < SHORTER * nearest[sector].0 {
                nearest[sector] = (length, b);
            }
        }
        for (_, b) in nearest.into_iter().filter(|n| n.1 != usize::MAX) {
            let length = arc(node.point, nodes[b].point, node.normal, nodes[b].normal);
            edges[a].push((b, length));
            edges[b].push((a, length));
        }
    }
    edges
}

/// Farthest point sampling from the first node.
fn landmarks(nodes: &[Node]) -> Vec<usize> {
    let mut chosen = vec![0];
    let mut nearest: Vec<f64> = nodes.iter().map(|n| norm(minus(n.point, nodes[0].point))).collect();
    while chosen.len() < MAX_LANDMARKS.min(nodes.len()) {
        let mut far = 0;
        for k in 1..nearest.len() {
            far = if SHORTER * nearest[k] > nearest[far] { k } else { far };
        }
        chosen.push(far);
        for (d, n) in nearest.iter_mut().zip(nodes) {
            *d = d.min(norm(minus(n.point, nodes[far].point)));
        }
    }
    chosen
}

/// Dijkstra's distances from one node.
fn shortest(edges: &Edges, from: usize) -> Vec<f64> {
    let mut distance = vec![f64::INFINITY; edges.len()];
    distance[from] = 0.0;
    // the bit patterns of non-negative numbers are ordered like the numbers
    let mut queue = BinaryHeap::from([(Reverse(0.0_f64.to_bits()), from)]);
    while let Some((Reverse(bits), a)) = queue.pop() {
        if f64::from_bits(bits) > distance[a] {
            continue;
        }
        for &(b, length) in &edges[a] {
            let through = distance[a] + length;
            if through < distance[b] {
                distance[b] = through;
                queue.push((Reverse(through.to_bits()), b));
            }
        }
    }
    distance
}

/// Places every node by classical scaling of the landmarks and its distances to them; `None` when the nodes lie on one
/// curve.
fn scaled(landmarks: &[usize], distances: &[Vec<f64>]) -> Option<Vec<[f64; 2]>> {
    let count = landmarks.len();
    let square = |a: usize, node: usize| distances[a][node] * distances[a][node];
    let means: Vec<f64> =
        (0..count).map(|a| (0..count).map(|b| square(a, landmarks[b])).sum::<f64>() / count as f64).collect();
    let mean = means.iter().sum::<f64>() / count as f64;
    let centred = Mat::from_fn(count, count, |a, b| {
        -0.5 * (0.5 * (square(a, landmarks[b]) + square(b, landmarks[a])) - means[a] - means[b] + mean)
    });
    let Eigen { values, vectors } = eigen(centred.as_ref())?;
    let (first, second) = (values[count - 1], values[count - 2]);
    if !(first > 0.0 && second > CURVE * CURVE * first) {
        return None;
    }
    let place = |node: usize| {
        [(count - 1, first), (count - 2, second)].map(|(k, value)| {
            let sum: f64 = (0..count).map(|a| vectors[(a, k)] * (means[a] - square(a, node))).sum();
            0.5 * sum / value.sqrt()
        })
    };
    Some((0..distances[0].len()).map(place).collect())
}

/// Rotates the picture so that its bounding box is smallest, with the longer side along v.
fn rotate_to_box(flat: &mut [[f64; 2]]) {
    let hull = convex_hull(flat);
    let mut best: Option<(f64, [f64; 2])> = None;
    for k in 0..hull.len() {
        let (a, b) = (hull[k], hull[(k + 1) % hull.len()]);
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        if length == 0.0 {
            continue;
        }
        let along = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
        let [width, height] = extent(flat, along);
        let area = width * height;
        let direction = if width >= height { along } else { [-along[1], along[0]] };
        // among boxes equal to a millionth the first along the hull wins
        if best.is_none_or(|(least, _)| area < least * (1.0 - 1e-6)) {
            best = Some((area, direction));
        }
    }
    if let Some((_, d)) = best {
        flat.iter_mut().for_each(|p| *p = [p[0] * -d[1] + p[1] * d[0], p[0] * d[0] + p[1] * d[1]]);
    }
}

/// Extents along the direction `d` and across it.
fn extent(flat: &[[f64; 2]], d: [f64; 2]) -> [f64; 2] {
    let range = |f: &dyn Fn(&[f64; 2]) -> f64| {
        let (lo, hi) = flat.iter().map(f).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        hi - lo
    };
    [range(&|p| p[0] * d[0] + p[1] * d[1]), range(&|p| p[1] * d[0] - p[0] * d[1])]
}

/// Gradients of u and v in space at node k, from its neighbours: least squares in the tangent plane.
fn gradient(k: usize, nodes: &[Node], edges: &Edges, flat: &[[f64; 2]]) -> Option<[Vector; 2]> {
    let node = &nodes[k];
    let axis = if node.normal[2].abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
    let e1 = unit(cross(node.normal, axis));
    let e2 = cross(node.normal, e1);
    let (mut xx, mut xy, mut yy, mut right) = (0.0, 0.0, 0.0, [[0.0; 2]; 2]);
    for &(b, length) in &edges[k] {
        let d = minus(nodes[b].point, node.point);
        let (x, y) = (dot(d, e1) / length, dot(d, e2) / length);
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        for (a, line) in right.iter_mut().enumerate() {
            let rise = (flat[b][a] - flat[k][a]) / length;
            *line = [line[0] + x * rise, line[1] + y * rise];
        }
    }
    let det = xx * yy - xy * xy;
    if det.is_nan() || det <= 1e-9 * (xx + yy) * (xx + yy) {
        return None;
    }
    Some(right.map(|[x, y]| {
        let (a, b) = ((yy * x - xy * y) / det, (xx * y - xy * x) / det);
        [0, 1, 2].map(|d| a * e1[d] + b * e2[d])
    }))
}
