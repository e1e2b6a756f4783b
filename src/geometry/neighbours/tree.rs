//! Nearest neighbours by a k-d tree: points halved by the median of their widest direction until few are left.
//!
//! ```text
//! build O(n log n)       one query O(log n) on average: a half is skipped when it lies beyond the k-th neighbour
//! distance of a half     sum over the axes of the squared gaps that were crossed on the way to it
//! ```
//!
//! A cut knows where either half ends: between the two lies a gap, which is wide where contacts lie along a few lines. A query in the
//! gap's end begins in its own half, and crosses the gap at its full width.
//!
//! J. L. Bentley, *Commun. ACM* 18 (1975) 509; S. Arya, D. M. Mount, *Proc. Data Compression Conf.* (1993) 381. Equal distances are
//! ordered by the point's number, so answers do not depend on how the tree happens to be cut.

use std::borrow::Cow;

use palpate_numeric::vector::{Vector, dot, minus};

/// Points in a leaf: below this a scan is faster than another cut.
const LEAF: usize = 12;

/// A tree over points that it borrows, or owns once it is to outlive them.
#[derive(Clone, Debug)]
pub struct Neighbours<'a> {
    points: Cow<'a, [Vector]>,
    /// The points with their numbers, halves next to each other: those of a leaf are read at once.
    leaves: Vec<(Vector, u32)>,
    /// In the order in which the halves are visited.
    cuts: Vec<Halving>,
}

/// Where a set of points is halved: the lower half ends at the first place along the axis, the upper one begins at the second. Where
/// both are one, points that tie are halved by the next axis, in which the upper half begins there.
#[derive(Clone, Copy, Debug, Default)]
struct Halving {
    axis: u8,
    gap: [f64; 2],
    tied: f64,
}

/// The axis by which points are ordered that tie in this one.
fn next(axis: usize) -> usize {
    (axis + 1) % 3
}

/// A neighbour: squared distance and number.
type Near = (f64, u32);

/// Up to so many neighbours are kept in order while they are found; of more, moving the rest at every find costs more than
/// picking the nearest from a buffer now and then.
const FEW_NEIGHBOURS: usize = 32;

/// The nearest points that were met.
struct Found {
    k: usize,
    /// The nearest `k` in order where they are few, else these and what came since they were picked.
    near: Vec<Near>,
    /// Length at which the nearest are picked again.
    full: usize,
    /// The farthest of `k` neighbours, where so many are known.
    bound: Option<Near>,
    /// Leaves that were looked into.
    #[cfg(test)]
    leaves: usize,
}

impl Found {
    fn new(k: usize) -> Found {
        let room = if k <= FEW_NEIGHBOURS { k + 1 } else { k + k / 2 };
        Found {
            k,
            near: Vec::with_capacity(room),
            full: k,
            bound: None,
            #[cfg(test)]
            leaves: 0,
        }
    }

    fn keep(&mut self, new: Near) {
        if self.bound.is_some_and(|bound| new >= bound) {
            return;
        }
        if self.k > FEW_NEIGHBOURS {
            self.near.push(new);
            if self.near.len() >= self.full {
                self.pick();
            }
            return;
        }
        let at = self.near.partition_point(|old| *old < new);
        self.near.insert(at, new);
        self.near.truncate(self.k);
        self.bound = if self.near.len() == self.k { self.near.last().copied() } else { None };
    }

    /// Leaves the nearest `k` in the buffer.
    fn pick(&mut self) {
        let (_, farthest, _) = self.near.select_nth_unstable_by(self.k - 1, in_order);
        self.bound = Some(*farthest);
        self.near.truncate(self.k);
        self.full = self.k + self.k / 2;
    }

    fn unordered(mut self) -> Vec<Near> {
        if self.near.len() > self.k {
            self.pick();
        }
        self.near
    }

    fn sorted(self) -> Vec<Near> {
        let is_in_order = self.k <= FEW_NEIGHBOURS;
        let mut near = self.unordered();
        if !is_in_order {
            near.sort_unstable_by(in_order);
        }
        near
    }
}

fn in_order(a: &Near, b: &Near) -> std::cmp::Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
}

impl<'a> Neighbours<'a> {
    pub fn new(points: &'a [Vector]) -> Neighbours<'a> {
        let mut items: Vec<(Vector, u32)> = points.iter().copied().zip(0..).collect();
        let depth_of = |mut count: usize| {
            let mut depth = 0;
            while count > LEAF {
                count = count.div_ceil(2);
                depth += 1;
            }
            depth
        };
        let mut cuts = vec![Halving::default(); (1 << depth_of(points.len())) - 1];
        cut(&mut items, 0, &mut cuts);
        Neighbours { points: Cow::Borrowed(points), leaves: items, cuts }
    }

    /// The same tree with points of its own.
    pub fn into_owned(self) -> Neighbours<'static> {
        Neighbours { points: Cow::Owned(self.points.into_owned()), leaves: self.leaves, cuts: self.cuts }
    }

    /// Numbers of the `k` points nearest to `place`, nearest first; a point of the tree finds itself.
    pub fn nearest(&self, place: Vector, k: usize) -> Vec<Near> {
        self.found(place, k).sorted()
    }

    /// The same in no order, which saves sorting many: where the tree is the same, so is this.
    pub fn nearest_unordered(&self, place: Vector, k: usize) -> Vec<Near> {
        self.found(place, k).unordered()
    }

    fn found(&self, place: Vector, k: usize) -> Found {
        let mut found = Found::new(k);
        if k > 0 {
            self.visit(place, (0, 0, self.leaves.len()), [0.0; 3], &mut found);
        }
        found
    }

    /// Points with their numbers, leaf by leaf.
    pub(super) fn leaves(&self) -> Vec<&[(Vector, u32)]> {
        let mut found = Vec::with_capacity(self.cuts.len() + 1);
        let mut nodes = vec![(0, 0, self.leaves.len())];
        while let Some((node, lo, hi)) = nodes.pop() {
            if node >= self.cuts.len() {
                found.push(&self.leaves[lo..hi]);
                continue;
            }
            let [lower, upper] = halves(node, lo, hi);
            nodes.extend([upper, lower]);
        }
        found
    }

    /// All points up to so far from a place, in no order.
    pub(super) fn within(&self, place: Vector, distance: f64) -> Vec<(Vector, u32)> {
        let most = distance * distance;
        let mut found = Vec::new();
        let mut nodes = vec![((0, 0, self.leaves.len()), [0.0; 3])];
        while let Some(((node, lo, hi), away)) = nodes.pop() {
            if node >= self.cuts.len() {
                let near = |(point, _): &&(Vector, u32)| {
                    let offset = minus(*point, place);
                    dot(offset, offset) <= most
                };
                found.extend(self.leaves[lo..hi].iter().filter(near));
                continue;
            }
            let Halving { axis, gap, .. } = self.cuts[node];
            let axis = usize::from(axis);
            let beyond = [(place[axis] - gap[0]).max(0.0), (gap[1] - place[axis]).max(0.0)];
            for (half, beyond) in halves(node, lo, hi).into_iter().zip(beyond) {
                let mut across = away;
                across[axis] = beyond.max(away[axis]);
                if dot(across, across) <= most {
                    nodes.push((half, across));
                }
            }
        }
        found
    }

    /// A point by its number.
    pub fn point(&self, number: u32) -> Vector {
        self.points[number as usize]
    }

    /// Distance from point `number` to the nearest other point, and that point.
    pub fn nearest_other(&self, number: usize) -> Option<(f64, usize)> {
        let found = self.nearest(self.points[number], 2);
        found.iter().find(|(_, other)| *other as usize != number).map(|(d, other)| (d.sqrt(), *other as usize))
    }

    /// The points of a node, whose cell is `away` from the place along each axis.
    fn visit(&self, place: Vector, (node, lo, hi): (usize, usize, usize), away: Vector, found: &mut Found) {
        if node >= self.cuts.len() {
            #[cfg(test)]
            (found.leaves += 1);
            for (point, number) in &self.leaves[lo..hi] {
                let offset = minus(*point, place);
                found.keep((dot(offset, offset), *number));
            }
            return;
        }
        let Halving { axis, gap, tied } = self.cuts[node];
        let axis = usize::from(axis);
        let halves = halves(node, lo, hi);
        let beyond = [place[axis] - gap[0], place[axis] - gap[1]];
        let side = beyond[0] + beyond[1];
        let own = usize::from(side > 0.0 || side == 0.0 && place[next(axis)] >= tied);
        self.visit(place, halves[own], away, found);
        let mut across = away;
        // within the gap the far half is as far as its own end
        across[axis] = beyond[1 - own];
        // of the same rounding as a point's own distance, so that no point is skipped that is as near as the bound
        if found.bound.is_none_or(|bound| dot(across, across) <= bound.0) {
            self.visit(place, halves[1 - own], across, found);
        }
    }
}

/// The two nodes below a node, with the points of each.
fn halves(node: usize, lo: usize, hi: usize) -> [(usize, usize, usize); 2] {
    let middle = lo + (hi - lo).div_ceil(2);
    [(2 * node + 1, lo, middle), (2 * node + 2, middle, hi)]
}

/// Points move with their numbers, so that no level jumps through memory.
fn cut(items: &mut [(Vector, u32)], node: usize, cuts: &mut [Halving]) {
    if node >= cuts.len() {
        return;
    }
    let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for (p, _) in items.iter() {
        (0..3).for_each(|i| (lo[i], hi[i]) = (lo[i].min(p[i]), hi[i].max(p[i])));
    }
    let width = minus(hi, lo);
    let axis = if width[0] >= width[1] && width[0] >= width[2] { 0 } else { 1 + usize::from(width[2] > width[1]) };
    let middle = items.len().div_ceil(2);
    if middle >= items.len() {
        return;
    }
    items.select_nth_unstable_by(middle, |a, b| {
        let along = |axis: usize| a.0[axis].total_cmp(&b.0[axis]);
        along(axis).then_with(|| along(next(axis))).then(a.1.cmp(&b.1))
    });
    let (left, right) = items.split_at_mut(middle);
    let end = left.iter().map(|(p, _)| p[axis]).fold(f64::NEG_INFINITY, f64::max);
    cuts[node] = Halving { axis: axis as u8, gap: [end, right[0].0[axis]], tied: right[0].0[next(axis)] };
    cut(left, 2 * node + 1, cuts);
    cut(right, 2 * node + 2, cuts);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_finds_what_a_scan_finds() {
        for count in [1, 2, 13, 100, 997] {
            let points: Vec<Vector> = (0..count)
                .map(|i| [(i as f64 * 0.37).sin(), (i as f64 * 1.71).cos(), ((i % 7) as f64 * 0.1)])
                .collect();
            let tree = Neighbours::new(&points);
            for place in points.iter().step_by(11).chain([&[2.0, 0.0, -1.0]]) {
                let mut all: Vec<Near> = (0..count as u32)
                    .map(|i| (dot(minus(points[i as usize], *place), minus(points[i as usize], *place)), i))
                    .collect();
                all.sort_by(|a, b| a.partial_cmp(b).unwrap());
                for k in [1, 9, FEW_NEIGHBOURS, FEW_NEIGHBOURS + 1, 60, 300] {
                    assert_eq!(tree.nearest(*place, k), all[..k.min(count)]);
                }
            }
        }
    }

    /// Leaves that the queries of all points look into, on average.
    fn leaves(points: &[Vector]) -> f64 {
        let tree = Neighbours::new(points);
        let of = |place: &Vector| {
            let mut found = Found::new(21);
            tree.visit(*place, (0, 0, points.len()), [0.0; 3], &mut found);
            found.leaves
        };
        points.iter().map(of).sum::<usize>() as f64 / points.len() as f64
    }

    /// Fingers that touch densely along a few lines, lines that cross, lines beside a patch, a grid whose columns tie with its cuts,
    /// and points that are all one but for a line: no query passes through the points of another line.
    #[test]
    fn a_query_stays_among_its_neighbours_however_the_points_lie() {
        const MANY: usize = 20_000;
        let share = |i: usize| i as f64 / MANY as f64;
        let on_lines = |lines: usize| -> Vec<Vector> {
            (0..MANY).map(|i| [(i % lines) as f64, share(i - i % lines), 0.0]).collect()
        };
        let scattered = |i: usize| [(i as f64 * 0.754_877).fract(), (i as f64 * 0.569_840).fract(), 0.0];
        let shapes: [(&str, Vec<Vector>); 8] = [
            ("one line", on_lines(1)),
            ("two lines", on_lines(2)),
            ("three lines", on_lines(3)),
            ("seven lines", on_lines(7)),
            (
                "a cross",
                (0..MANY).map(|i| if i % 2 == 0 { [share(i), 0.5, 0.0] } else { [0.5, share(i), 0.0] }).collect(),
            ),
            (
                "a patch and a line",
                (0..MANY).map(|i| if i % 2 == 0 { scattered(i) } else { [3.0, share(i), 1.0] }).collect(),
            ),
            ("a grid", (0..MANY).map(|i| [(i % 141) as f64, (i / 141) as f64, 0.0]).collect()),
            ("scattered", (0..MANY).map(scattered).collect()),
        ];
        for (name, points) in &shapes {
            let average = leaves(points);
            assert!(average < 20.0, "{name}: {average} of {} leaves", MANY / LEAF);
        }
    }
}
