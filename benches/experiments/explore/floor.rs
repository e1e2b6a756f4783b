//! Contacts until S and R are right for an oracle that knows the object's family and the noise: what any planning could save.
//!
//! ```text
//! p = sizes of the body, rotations, offset         three rows a touch: position across the surface, normal along two tangents
//! F = sum of rows' rows over the touches           error of S = (dS/dp) F^+ sum rows' e,  e standard normal       R alike
//! lattice   the candidate farthest from all touches
//! planned   the candidate that lowers Var S/0.01^2 + Var R/(0.02 R)^2 most, one after the other
//! ```
//!
//! The oracle is a maximum likelihood fit to first order. Its plan is made at the true surface, which no strategy knows: a strategy that
//! reached it would have to know the family, and the sizes, before it touches.

use palpate::scene::Surface;
use palpate_numeric::draws::EffectDraws;
use palpate_world::scene::linspace;
use rayon::prelude::*;

use crate::contacts::{BUDGET, Protocol, RIGHT, tell, tell_settled};
use crate::objects::{Drawn, HALF, NOISE};

/// Steps of the differences: sizes and offsets in units of the patch, rotations in degrees.
const STEP_OF_DIFFERENCES: f64 = 1e-5;

/// Places each way at which explorations touch, and over which S and R are averaged.
const PLACES: usize = 21;
const AVERAGED: usize = 8;

/// Information, relative to that of all candidates, below which a direction is not known: a ball has no direction.
const UNKNOWN: f64 = 1e-10;

/// Rows of one touch.
const ROWS: usize = 3;

type Row = Vec<f64>;

/// What every candidate would tell.
struct Oracle {
    places: Vec<[f64; 2]>,
    rows: Vec<[Row; ROWS]>,
    /// Derivatives of S and of R in units of the goal.
    slopes: [Row; 2],
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Means of S and R over the patch.
fn means(surface: &Surface) -> Option<[f64; 2]> {
    let axis = linspace(-HALF, HALF, AVERAGED);
    let (mut sums, mut defined) = ([0.0; 2], 0.0);
    for (x, y) in axis.iter().flat_map(|x| axis.iter().map(move |y| (*x, *y))) {
        let local = surface.at(x, y)?.local;
        sums[1] += local.curvedness() / (AVERAGED * AVERAGED) as f64;
        if let Some(s) = local.shape_index() {
            sums[0] += s;
            defined += 1.0;
        }
    }
    Some([sums[0] / f64::max(defined, 1.0), sums[1]])
}

/// Two unit vectors along a surface.
fn tangents(n: [f64; 3]) -> [[f64; 3]; 2] {
    let length = n[0].hypot(n[2]);
    let a = [n[2] / length, 0.0, -n[0] / length];
    [a, [n[1] * a[2] - n[2] * a[1], n[2] * a[0] - n[0] * a[2], n[0] * a[1] - n[1] * a[0]]]
}

/// The surface with one of its numbers moved.
fn moved(drawn: &Drawn, number: usize, by: f64) -> Surface {
    let mut drawn = drawn.clone();
    let sizes = drawn.sizes.len();
    match drawn.sizes.get_mut(number) {
        Some(size) => *size += by,
        None => drawn.pose[number - sizes] += by,
    }
    drawn.surface()
}

impl Oracle {
    fn new(drawn: &Drawn) -> Oracle {
        let count = drawn.sizes.len() + drawn.pose.len();
        let surface = drawn.surface();
        let pairs: Vec<[Surface; 2]> =
            (0..count).map(|k| [moved(drawn, k, STEP_OF_DIFFERENCES), moved(drawn, k, -STEP_OF_DIFFERENCES)]).collect();
        let axis = linspace(-HALF, HALF, PLACES);
        let (mut places, mut rows) = (Vec::new(), Vec::new());
        for (x, y) in axis.iter().flat_map(|x| axis.iter().map(move |y| (*x, *y))) {
            if let Some(found) = touch(&surface, &pairs, x, y) {
                places.push([x, y]);
                rows.push(found);
            }
        }
        let r = means(&surface).map_or(f64::NAN, |[_, r]| r);
        let slope = |[ahead, behind]: &[Surface; 2]| {
            let (ahead, behind) = (means(ahead)?, means(behind)?);
            Some([0, 1].map(|q| (ahead[q] - behind[q]) / (2.0 * STEP_OF_DIFFERENCES)))
        };
        let slopes: Vec<[f64; 2]> = pairs.iter().map(|pair| slope(pair).unwrap_or([f64::NAN; 2])).collect();
        let mut oracle = Oracle { places, rows, slopes: [0, 1].map(|q| slopes.iter().map(|s| s[q]).collect()) };
        oracle.scale([RIGHT[0], RIGHT[1] * r]);
        oracle
    }

    /// Numbers in units in which all candidates tell equally much of each, S and R in units of the goal.
    fn scale(&mut self, goal: [f64; 2]) {
        let told = |k: usize| self.rows.iter().flatten().map(|row| row[k] * row[k]).sum::<f64>();
        let units: Vec<f64> = (0..self.slopes[0].len()).map(|k| (told(k) / self.rows.len() as f64).sqrt()).collect();
        // where a motion leaves the body as it is, differences are rounding and stay small
        let least = 1e-6 * units.iter().copied().fold(1e-100, f64::max);
        for (k, unit) in units.into_iter().map(|unit| unit.max(least)).enumerate() {
            self.rows.iter_mut().flatten().for_each(|row| row[k] /= unit);
            // a family that fixes S leaves the rounding of differences
            for (slopes, goal) in self.slopes.iter_mut().zip(goal) {
                slopes[k] = if slopes[k].abs() < 1e-7 { 0.0 } else { slopes[k] / (unit * goal) };
            }
        }
    }

    /// The inverse of the information of some touches.
    fn inverse(&self, touched: &[usize]) -> Vec<Row> {
        let count = self.slopes[0].len();
        let mut information = vec![vec![0.0; count]; count];
        for row in touched.iter().flat_map(|&k| &self.rows[k]) {
            for i in 0..count {
                (0..count).for_each(|j| information[i][j] += row[i] * row[j]);
            }
        }
        (0..count).for_each(|i| information[i][i] += UNKNOWN * self.rows.len() as f64);
        inverted(information)
    }

    /// The candidate farthest from all touches.
    fn farthest(&self, touched: &[usize]) -> Option<usize> {
        let apart =
            |a: usize, b: usize| (self.places[a][0] - self.places[b][0]).hypot(self.places[a][1] - self.places[b][1]);
        let nearest = |k: usize| touched.iter().map(|&t| apart(k, t)).fold(f64::INFINITY, f64::min);
        first_largest((0..self.places.len()).map(|k| (k, nearest(k))).filter(|(_, apart)| *apart > 1e-6))
    }

    /// The candidate that lets the variances of S and R fall most.
    fn planned(&self, touched: &[usize]) -> Option<usize> {
        let inverse = self.inverse(touched);
        let carried = self.slopes.each_ref().map(|g| times(&inverse, g));
        let left = (0..self.places.len()).filter(|k| !touched.contains(k));
        first_largest(left.map(|k| (k, self.fall(k, &inverse, &carried))))
    }

    fn fall(&self, k: usize, inverse: &[Row], carried: &[Row; 2]) -> f64 {
        let rows = &self.rows[k];
        let through = rows.each_ref().map(|row| times(inverse, row));
        let spread =
            (0..ROWS).map(|i| (0..ROWS).map(|j| dot(&rows[i], &through[j]) + f64::from(u8::from(i == j))).collect());
        let spread = inverted(spread.collect());
        let falls = carried.iter().map(|carried| {
            let y: Row = rows.iter().map(|row| dot(row, carried)).collect();
            dot(&y, &times(&spread, &y))
        });
        falls.sum()
    }

    /// Whether both errors are within the goal.
    fn is_right(&self, touched: &[usize], noise: &[[f64; ROWS]]) -> bool {
        let inverse = self.inverse(touched);
        let mut told = vec![0.0; inverse.len()];
        for (k, noise) in touched.iter().zip(noise) {
            for (row, e) in self.rows[*k].iter().zip(noise) {
                told.iter_mut().zip(row).for_each(|(sum, v)| *sum += e * v);
            }
        }
        let off = times(&inverse, &told);
        self.slopes.iter().all(|g| dot(g, &off).abs() <= 1.0)
    }
}

/// Rows of a touch: derivatives of what it feels, in standard deviations.
fn touch(surface: &Surface, pairs: &[[Surface; 2]], x: f64, y: f64) -> Option<[Row; ROWS]> {
    let normal = surface.at(x, y)?.local.normal;
    let along = tangents(normal);
    let mut rows = [Row::new(), Row::new(), Row::new()];
    for [ahead, behind] in pairs {
        let (ahead, behind) = (ahead.at(x, y)?, behind.at(x, y)?);
        rows[0].push(normal[2] * (ahead.point[2] - behind.point[2]) / (2.0 * STEP_OF_DIFFERENCES * NOISE[0]));
        let turn = [0, 1, 2]
            .map(|d| (ahead.local.normal[d] - behind.local.normal[d]) / (2.0 * STEP_OF_DIFFERENCES * NOISE[1]));
        rows[1].push(dot(&along[0], &turn));
        rows[2].push(dot(&along[1], &turn));
    }
    Some(rows)
}

fn times(matrix: &[Row], v: &[f64]) -> Row {
    matrix.iter().map(|row| dot(row, v)).collect()
}

/// The inverse of a symmetric positive matrix, by Gauss and Jordan.
fn inverted(mut a: Vec<Row>) -> Vec<Row> {
    let count = a.len();
    for k in 0..count {
        let pivot = a[k][k];
        a[k][k] = 1.0;
        a[k].iter_mut().for_each(|v| *v /= pivot);
        let row = a[k].clone();
        for (_, other) in a.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let part = other[k];
            other[k] = 0.0;
            other.iter_mut().zip(&row).for_each(|(v, r)| *v -= part * r);
        }
    }
    a
}

fn first_largest(scored: impl Iterator<Item = (usize, f64)>) -> Option<usize> {
    scored.reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(k, _)| k)
}

/// Contacts until the oracle is right; the whole budget's contacts are chosen once for all noise seeds.
fn until(oracle: &Oracle, seed: u64, noises: u64, protocol: Protocol, planned: bool) -> Vec<(u64, usize)> {
    let axis = linspace(-HALF, HALF, protocol.first);
    let at = |x: f64, y: f64| oracle.places.iter().position(|p| (p[0] - x).hypot(p[1] - y) < 1e-6);
    let mut touched: Vec<usize> = axis.iter().flat_map(|x| axis.iter().filter_map(|y| at(*x, *y))).collect();
    let mut looks = vec![touched.len()];
    while looks.last().is_some_and(|last| last + protocol.round <= BUDGET) {
        for _ in 0..protocol.round {
            touched.extend(if planned { oracle.planned(&touched) } else { oracle.farthest(&touched) });
        }
        looks.push(touched.len());
    }
    let one = |noise: u64| {
        let draws = EffectDraws::new(noise, "floor");
        let noise: Vec<[f64; ROWS]> = (0..touched.len() as u64)
            .map(|contact| {
                let mut three = [0.0; ROWS];
                draws.gaussians(contact, seed, ROWS, &mut three);
                three
            })
            .collect();
        let right: Vec<bool> = looks.iter().map(|&n| oracle.is_right(&touched[..n], &noise[..n])).collect();
        let first = right.windows(2).position(|pair| pair[0] && pair[1]);
        (seed, first.map_or(usize::MAX, |k| looks[k]))
    };
    (1..=noises).map(one).collect()
}

pub(crate) fn print(first: u64, objects: u64, noises: u64, protocol: Protocol) {
    println!(
        "\n{objects} objects from seed {first}, {noises} noise seeds each; first sweep {0} x {0}, {1} touches a round; an oracle that knows the family and the noise",
        protocol.first, protocol.round
    );
    println!("{:<22} {:>7} {:>8} {:>10}   medians by kind", "touches", "median", "90 %", "never, %");
    let seeds: Vec<u64> = (first..first + objects).collect();
    let oracles: Vec<(u64, Oracle)> = seeds.par_iter().map(|&seed| (seed, Oracle::new(&Drawn::new(seed)))).collect();
    let all: Vec<(String, Vec<(u64, usize)>)> = [("oracle, lattice", false), ("oracle, planned", true)]
        .map(|(name, planned)| {
            let runs =
                oracles.par_iter().flat_map_iter(|(seed, oracle)| until(oracle, *seed, noises, protocol, planned));
            (name.to_string(), runs.collect())
        })
        .into();
    all.iter().for_each(|(name, found)| tell(name, found));
    tell_settled(&all);
}
