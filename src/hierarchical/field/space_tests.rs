//! Partition of unity, independence, polynomials and the number of functions a cell meets, on random hierarchies.

use std::sync::Arc;

use super::HierarchicalField;
use crate::mesh::{CellId, Mesh};
use crate::space::{ActiveFunction, HierarchicalSpace, LocalFunction};
use palpate_numeric::bspline::Knots;
use palpate_numeric::draws::Lcg;

/// A base grid of random degrees, segments and knots, with random cells refined up to level 4.
fn random_mesh(draw: &mut Lcg) -> Mesh {
    let mut below = |n: usize| (draw.uniform() * n as f64) as usize;
    let mut axis = || {
        let (degree, segments) = (2 + below(4), 1 + below(5));
        if below(2) == 0 {
            return Knots::uniform(degree, segments, -1.0, 1.5).unwrap();
        }
        let mut knots = vec![-1.0; degree + 1];
        for k in 1..segments {
            let at = -1.0 + 2.5 * (k as f64 + 0.3 * (below(100) as f64 / 100.0 - 0.5)) / segments as f64;
            // now and then a double knot
            (0..1 + below(8) / 7).for_each(|_| knots.push(at));
        }
        knots.extend(vec![1.5; degree + 1]);
        Knots::new(degree, knots).unwrap()
    };
    let mut mesh = Mesh::new([axis(), axis()]).unwrap();
    let base = mesh.tree().base();
    for _ in 0..1 + below(6) {
        let level = below(4);
        let place = base.map(|n| below(n << level) as u32);
        mesh.refine(CellId { level: level as u8, place }).unwrap();
    }
    mesh
}

/// A polynomial of the degrees of the space and its first and second derivatives in x.
fn polynomial(degree: [usize; 2], c: &[f64], [x, y]: [f64; 2]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for a in 0..=degree[0] {
        for b in 0..=degree[1] {
            let k = a as f64;
            let term = c[a * (degree[1] + 1) + b] * y.powi(b as i32);
            sums[0] += term * x.powi(a as i32);
            sums[1] += if a > 0 { term * k * x.powi(a as i32 - 1) } else { 0.0 };
            sums[2] += if a > 1 { term * k * (k - 1.0) * x.powi(a as i32 - 2) } else { 0.0 };
        }
    }
    sums
}

/// Coefficients of a polynomial: those of its level's tensor spline, which truncation preserves. They are its polar form at the knots
/// of the function.
fn coefficients_of(space: &HierarchicalSpace, degree: [usize; 2], c: &[f64]) -> Vec<f64> {
    let elementary = |knots: &Knots, k: usize| -> Vec<f64> {
        // polar form of x^a at t_1 .. t_p: the a-th elementary symmetric sum over its number of terms
        let p = knots.degree();
        let mut sums = vec![0.0; p + 1];
        sums[0] = 1.0;
        for (n, t) in knots.as_slice()[k + 1..=k + p].iter().enumerate() {
            (0..=n).rev().for_each(|a| sums[a + 1] += t * sums[a]);
        }
        let mut terms = 1.0;
        for (a, sum) in sums.iter_mut().enumerate() {
            *sum /= terms;
            terms *= (p - a) as f64 / (a + 1) as f64;
        }
        sums
    };
    let of = |function: &ActiveFunction| -> f64 {
        let axes = space.mesh().levels().at(function.level.into());
        let [x, y] = [0, 1].map(|axis| elementary(axes[axis].knots(), function.place[axis] as usize));
        let row = |a: usize| y.iter().enumerate().map(|(b, e)| c[a * (degree[1] + 1) + b] * e).sum::<f64>();
        x.iter().enumerate().map(|(a, e)| e * row(a)).sum()
    };
    space.functions().iter().map(of).collect()
}

/// What is checked of one hierarchy: unity, polynomials and the bound of functions on a cell.
fn check(mesh: Mesh, draw: &mut Lcg) {
    let degree = mesh.levels().degree();
    let space = Arc::new(HierarchicalSpace::new(mesh));
    let most = 2 * space.local_count();
    let mut on_cell = Vec::new();
    for leaf in 0..space.leaves().len() {
        space.functions_on(leaf, &mut on_cell);
        assert!(on_cell.len() <= most, "{} functions on a cell, at most {most}", on_cell.len());
        for function in space.local_functions(leaf) {
            if let LocalFunction::Truncated(shares) = function {
                assert!(shares.iter().all(|(_, share)| (0.0..=1.0 + 1e-12).contains(share)));
            }
        }
    }
    let c: Vec<f64> = (0..space.local_count()).map(|_| 2.0 * draw.uniform() - 1.0).collect();
    let field = HierarchicalField::new(space.clone(), coefficients_of(&space, degree, &c)).unwrap();
    let unity = HierarchicalField::new(space.clone(), vec![1.0; space.unknowns()]).unwrap();
    for _ in 0..40 {
        let at = [0, 1].map(|_| -1.0 + 2.5 * draw.uniform());
        let (point, one) = (field.at(at[0], at[1]), unity.at(at[0], at[1]));
        let exact = polynomial(degree, &c, at);
        let found = [point.z, point.zx, point.zxx];
        let size = [100.0, 1e4, 1e6];
        for k in 0..3 {
            assert!((found[k] - exact[k]).abs() < 1e-13 * size[k], "derivative {k}: {} {}", found[k], exact[k]);
        }
        assert!((one.z - 1.0).abs() < 1e-14 && one.zx.abs() < 1e-11 && one.zyy.abs() < 1e-8);
    }
}

#[test]
fn a_thousand_random_hierarchies_hold_polynomials_and_sum_to_one() {
    let mut draw = Lcg::new(1);
    for _ in 0..1000 {
        let mesh = random_mesh(&mut draw);
        check(mesh, &mut draw);
    }
}

/// The rank of the basis, seen at (p + 1)(q + 1) places in every cell, which no function that vanishes there can pass.
#[test]
fn the_functions_are_independent() {
    let mut draw = Lcg::new(2);
    for _ in 0..60 {
        let mesh = random_mesh(&mut draw);
        let space = Arc::new(HierarchicalSpace::new(mesh));
        if space.unknowns() > 200 {
            continue;
        }
        let degree = space.mesh().levels().degree();
        let places: Vec<[f64; 2]> = space
            .leaves()
            .iter()
            .flat_map(|cell| {
                let [centre, half] = space.mesh().centre_and_half(*cell);
                let at = move |axis: usize, k: usize| {
                    centre[axis] + half[axis] * (2.0 * (k as f64 + 0.5) / (degree[axis] + 1) as f64 - 1.0)
                };
                (0..=degree[0]).flat_map(move |a| (0..=degree[1]).map(move |b| [at(0, a), at(1, b)]))
            })
            .collect();
        let columns: Vec<Vec<f64>> = (0..space.unknowns())
            .map(|k| {
                let mut unit = vec![0.0; space.unknowns()];
                unit[k] = 1.0;
                let field = HierarchicalField::new(space.clone(), unit).unwrap();
                let values: Vec<f64> = places.iter().map(|at| field.at(at[0], at[1]).z).collect();
                assert!(values.iter().all(|v| *v > -1e-13), "a function below zero");
                let norm = values.iter().map(|v| v * v).sum::<f64>().sqrt();
                values.into_iter().map(|v| v / norm).collect()
            })
            .collect();
        assert!(smallest_remainder(columns) > 1e-4);
    }
}

/// The smallest length that Gram and Schmidt leave of a column of length 1.
fn smallest_remainder(mut columns: Vec<Vec<f64>>) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let mut smallest = f64::INFINITY;
    for k in 0..columns.len() {
        let (done, rest) = columns.split_at_mut(k);
        let column = &mut rest[0];
        for before in done.iter() {
            let share = dot(before, column);
            column.iter_mut().zip(before).for_each(|(c, b)| *c -= share * b);
        }
        let length = dot(column, column).sqrt();
        column.iter_mut().for_each(|c| *c /= length);
        smallest = smallest.min(length);
    }
    smallest
}
