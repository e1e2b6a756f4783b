//! The kernel of gradients against the formulas of this room, point by point.

use ndarray::Array2;
use palpate_numeric::bspline::Knots;
use palpate_numeric::simd::{
    CellPoints, CurveLanes, Isa, ORDERS, POINTS, PointShapes, ROUNDING, cell_curves, shape_gradients,
};

use super::{by_coefficients, shape_gradient};
use crate::surface::HeightField;

/// The largest difference and the largest number that were compared.
#[derive(Default)]
struct Largest {
    difference: f64,
    size: f64,
}

impl Largest {
    fn compare(&mut self, value: f64, expected: f64) {
        let gap = (value - expected).abs();
        // written such that NaN counts as the largest difference
        self.difference = if gap <= self.difference { self.difference } else { gap };
        self.size = self.size.max(expected.abs());
    }

    /// Holds the largest difference below `most` units in the last place of the largest number.
    fn hold(&self, isa: Isa, most: f64) {
        let found = self.difference / (self.size * f64::EPSILON);
        assert!(found < most, "{}: {found} ulp", isa.name());
    }
}

/// Points of one cell of a wavy surface with slopes up to `steep`, every one against the shape room's formulas.
fn compare(isa: Isa, degree: [usize; 2], steep: f64) {
    let knots = [Knots::uniform(degree[0], 1, 0.0, 1.0).unwrap(), Knots::uniform(degree[1], 1, -1.0, 1.0).unwrap()];
    let size = degree.map(|d| d + 1);
    let c = Array2::from_shape_fn(size, |(i, j)| steep * (i as f64 * 1.7 + j as f64 * 0.9).sin());
    let surface = HeightField::new(knots.clone(), c.clone()).unwrap();
    let bx = knots[0].basis(0.37);
    let rows: Vec<_> = (0..POINTS).map(|k| knots[1].basis(k as f64 / 4.0 - 0.9)).collect();
    let y = [0, 1, 2].map(|k| (0..size[1]).map(|b| std::array::from_fn(|l| rows[l].derivative(k)[b])).collect());
    let y: [Vec<[f64; POINTS]>; 3] = y;
    let x = [0, 1, 2].map(|k| bx.derivative(k));
    let y = y.each_ref().map(|y| &y[..]);
    let runs: Vec<usize> = (0..size[0]).map(|a| a * size[1]).collect();
    let mut curves = vec![CurveLanes::default(); size[0]];
    cell_curves(isa, c.as_slice().unwrap(), &runs, y, &mut curves);
    let points = CellPoints { x, y, curves: &curves };
    let [mut of_s, mut of_r] = [vec![[0.0; POINTS]; size[0] * size[1]], vec![[0.0; POINTS]; size[0] * size[1]]];
    let mut made = PointShapes::default();
    shape_gradients(isa, &points, [&mut of_s, &mut of_r], &mut made);
    let entries = [of_s, of_r];
    let (mut gradients, mut terms) = (Largest::default(), Largest::default());
    for (l, by) in rows.iter().enumerate() {
        let expected = shape_gradient(&surface.with_rows(&bx, by));
        for (k, by_point) in [&expected.shape_index, &expected.curvedness].into_iter().enumerate() {
            by_coefficients(by_point, &bx, by, |a, b, value| {
                gradients.compare(entries[k][a * size[1] + b][l], value);
            });
        }
        let bend = 0.5 * (expected.sum.abs() + expected.difference);
        gradients.compare(made.bend[l], bend);
        gradients.compare(made.difference[l], expected.difference);
        gradients.compare(made.sizes[1][l], 0.5 * expected.sum.hypot(expected.difference));
        let of_derivative = ORDERS.map(|(i, j)| {
            let term = |a: usize, b: usize| (c[[a, b]] * bx.derivative(i)[a] * by.derivative(j)[b]).abs();
            (0..size[0] * size[1]).map(|u| term(u / size[1], u % size[1])).sum::<f64>()
        });
        for (k, (g, size)) in
            [(&expected.shape_index, 1.0), (&expected.curvedness, made.sizes[1][l])].iter().enumerate()
        {
            let sum: f64 = (0..5).map(|k| g[k].abs() * of_derivative[k]).sum();
            terms.compare(made.roundings[k][l], ROUNDING * (sum + size));
        }
        let [x, y, xx, xy, yy] = of_derivative;
        terms.compare(made.opening[l], ROUNDING * (2.0 * (xx + 2.0 * xy + yy) + 4.0 * bend * (x + y)));
    }
    gradients.hold(isa, 32.0);
    terms.hold(isa, 8.0);
}

#[test]
fn every_isa_agrees_with_the_shape_room() {
    for isa in Isa::available() {
        for degree in [[2, 2], [3, 3], [2, 4]] {
            [0.1, 1.0, 20.0].into_iter().for_each(|steep| compare(isa, degree, steep));
        }
    }
}
