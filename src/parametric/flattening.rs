//! Parameters of scattered contacts: landmark Isomap whose edges are arcs, chords corrected by the turn of the normals.
//!
//! ```text
//! graph     every node with the nearest one in each of eight sectors of its tangent plane (Yao graph)
//! d(a, b)   shortest path along it, edges |P - P'| (t/2)/sin(t/2)
//! B = -1/2 J D^2 J = V diag(l) V'    landmarks at sqrt(l_1) V_1, sqrt(l_2) V_2; the others by Gower's formula
//! ```
//!
//! J. B. Tenenbaum, V. de Silva, J. C. Langford, *Science* 290 (2000) 2319; landmarks as V. de Silva and J. B. Tenenbaum,
//! Stanford 2004; A. C. Yao, *SIAM J. Comput.* 11 (1982) 721. The plane is then turned so that its box is smallest.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use faer::{Mat, Side};

use super::fingers::Flat;
use super::touches::Touches;
use super::vector::{Vector, arc, cross, dot, minus, norm, unit};

/// Nodes at most; more contacts than that share nodes, since the graph looks at every pair.
const MAX_NODES: usize = 1500;
/// Landmarks at most: the eigenproblem is of this size.
const MAX_LANDMARKS: usize = 100;
const SECTORS: usize = 8;
/// An edge between normals that turn by more than this joins two sides of a thing, not two places of one.
const MOST_TURN_COSINE: f64 = -0.2;
/// Second principal spread of the flat picture over the first, below which the contacts lie on one curve.
const CURVE: f64 = 1e-3;

struct Node {
    point: Vector,
    normal: Vector,
    members: Vec<usize>,
}

/// Flattens contacts that nobody labelled.
///
/// # Errors
/// In words, why they are no single sheet.
pub fn flatten_scattered(touches: &Touches) -> Result<Flat, &'static str> {
    let nodes = nodes(touches);
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
    turn_to_box(&mut flat);
    let mut places = vec![[0.0; 2]; touches.len()];
    let mut side = [0usize; 2];
    for (k, node) in nodes.iter().enumerate() {
        let Some(gradient) = gradient(k, &nodes, &edges, &flat) else {
            return Err("all contacts lie on one curve");
        };
        side[usize::from(dot(cross(gradient[0], gradient[1]), node.normal) < 0.0)] += 1;
        for &r in &node.members {
            let off = minus(touches.points[r], node.point);
            places[r] = [0, 1].map(|a| flat[k][a] + dot(gradient[a], off));
        }
    }
    if 10 * side[0].min(side[1]) > nodes.len() {
        return Err("normals change sides from contact to contact, or the contacts fold over");
    }
    if side[1] > side[0] {
        places.iter_mut().for_each(|p| p[0] = -p[0]);
    }
    Ok(Flat { places, period: [None; 2], triangles: Vec::new(), method: "landmark Isomap with arcs by the normals" })
}

/// Contacts, or their means over cubes as small as keep the nodes few.
fn nodes(touches: &Touches) -> Vec<Node> {
    let (lo, hi) = touches.points.iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(lo, hi), p| {
        ([0, 1, 2].map(|k| lo[k].min(p[k])), [0, 1, 2].map(|k| hi[k].max(p[k])))
    });
    let size = norm(minus(hi, lo));
    let mut side = 1e-9 * size;
    loop {
        let cube = |p: &Vector| [0, 1, 2].map(|k| ((p[k] - lo[k]) / side.max(f64::MIN_POSITIVE)).floor() as i64);
        let mut bins: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
        touches.points.iter().enumerate().for_each(|(r, p)| bins.entry(cube(p)).or_default().push(r));
        if bins.len() <= MAX_NODES || side > size {
            let mut nodes: Vec<Node> = bins.into_values().map(|members| node(touches, members)).collect();
            // cubes depend on the axes, so their order must not be what the landmarks begin with
            nodes.sort_by_key(|n| n.members[0]);
            return nodes;
        }
        side = if side < 1e-3 * size { 1e-3 * size } else { 1.5 * side };
    }
}

fn node(touches: &Touches, members: Vec<usize>) -> Node {
    let count = members.len() as f64;
    let sum = |all: &[Vector]| members.iter().fold([0.0; 3], |m, r| [0, 1, 2].map(|k| m[k] + all[*r][k] / count));
    Node { point: sum(&touches.points), normal: unit(sum(&touches.normals)), members }
}

type Edges = Vec<Vec<(usize, f64)>>;

/// A length counts as shorter from this share on: of equal ones the first contact's, whatever rounding says.
const SHORTER: f64 = 1.0 - 1e-9;
/// The first sector begins this share of one before the nearest neighbour: no regular pattern has neighbours on a border.
const BEFORE: f64 = 0.37;

/// Tangents at node `a`, the first towards its nearest neighbour, so that sectors turn with the contacts.
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

fn graph(nodes: &[Node]) -> Edges {
    let mut edges: Edges = vec![Vec::new(); nodes.len()];
    for (a, node) in nodes.iter().enumerate() {
        let Some([e1, e2]) = towards_nearest(a, nodes) else { continue };
        let mut nearest = [(f64::INFINITY, usize::MAX); SECTORS];
        for (b, other) in nodes.iter().enumerate() {
            let d = minus(other.point, node.point);
            let length = dot(d, d);
            if a == b || dot(node.normal, other.normal) < MOST_TURN_COSINE {
                continue;
            }
            let turn = dot(d, e2).atan2(dot(d, e1)) / std::f64::consts::TAU + BEFORE / SECTORS as f64;
            let sector = ((turn.rem_euclid(1.0) * SECTORS as f64) as usize).min(SECTORS - 1);
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
    // lengths are not negative, so their bits are ordered as they are
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

/// Classical scaling of the landmarks, every node placed by its distances to them; `None` when one dimension is enough.
fn scaled(landmarks: &[usize], distances: &[Vec<f64>]) -> Option<Vec<[f64; 2]>> {
    let count = landmarks.len();
    let square = |a: usize, node: usize| distances[a][node] * distances[a][node];
    let means: Vec<f64> =
        (0..count).map(|a| (0..count).map(|b| square(a, landmarks[b])).sum::<f64>() / count as f64).collect();
    let mean = means.iter().sum::<f64>() / count as f64;
    let centred = Mat::from_fn(count, count, |a, b| {
        -0.5 * (0.5 * (square(a, landmarks[b]) + square(b, landmarks[a])) - means[a] - means[b] + mean)
    });
    let eigen = centred.self_adjoint_eigen(Side::Lower).ok()?;
    let values: Vec<f64> = eigen.S().column_vector().iter().copied().collect();
    let (first, second) = (values[count - 1], values[count - 2]);
    if !(first > 0.0 && second > CURVE * CURVE * first) {
        return None;
    }
    let place = |node: usize| {
        [(count - 1, first), (count - 2, second)].map(|(k, value)| {
            let sum: f64 = (0..count).map(|a| eigen.U()[(a, k)] * (means[a] - square(a, node))).sum();
            0.5 * sum / value.sqrt()
        })
    };
    Some((0..distances[0].len()).map(place).collect())
}

/// Turns the picture so that its bounding box is smallest, the longer side along v, mirrored to a fixed handedness.
fn turn_to_box(flat: &mut [[f64; 2]]) {
    let hull = hull(flat);
    let mut best: Option<(f64, [f64; 2])> = None;
    for k in 0..hull.len() {
        let (a, b) = (flat[hull[k]], flat[hull[(k + 1) % hull.len()]]);
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        if length == 0.0 {
            continue;
        }
        let along = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
        let [width, height] = extent(flat, along);
        let area = width * height;
        let direction = if width >= height { along } else { [-along[1], along[0]] };
        // a millionth: of equal boxes the first along the hull
        if best.is_none_or(|(least, _)| area < least * (1.0 - 1e-6)) {
            best = Some((area, direction));
        }
    }
    if let Some((_, d)) = best {
        flat.iter_mut().for_each(|p| *p = [p[0] * -d[1] + p[1] * d[0], p[0] * d[0] + p[1] * d[1]]);
    }
}

fn extent(flat: &[[f64; 2]], d: [f64; 2]) -> [f64; 2] {
    let range = |f: &dyn Fn(&[f64; 2]) -> f64| {
        let (lo, hi) = flat.iter().map(f).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        hi - lo
    };
    [range(&|p| p[0] * d[0] + p[1] * d[1]), range(&|p| p[1] * d[0] - p[0] * d[1])]
}

/// Convex hull, anticlockwise, by Andrew's chain.
pub fn hull(points: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| points[*a][0].total_cmp(&points[*b][0]).then(points[*a][1].total_cmp(&points[*b][1])));
    let mut chain: Vec<usize> = Vec::new();
    for pass in 0..2 {
        let floor = chain.len() + usize::from(pass == 0);
        for &k in &order {
            while chain.len() > floor && turn(points, chain[chain.len() - 2], chain[chain.len() - 1], k) <= 0.0 {
                chain.pop();
            }
            chain.push(k);
        }
        chain.pop();
        order.reverse();
    }
    chain
}

/// Twice the area of a triangle, positive when anticlockwise.
fn turn(p: &[[f64; 2]], a: usize, b: usize, c: usize) -> f64 {
    (p[b][0] - p[a][0]) * (p[c][1] - p[a][1]) - (p[b][1] - p[a][1]) * (p[c][0] - p[a][0])
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
