//! Two routes to the same number must agree: Cholesky, QR, fast diagonalisation and conjugate gradients, scattered and
//! gridded data, and the dense oracle of the written equation through `nalgebra`.

use ndarray::Array2;
use palpate::fit::{FitOptions, Method, Objective, SlopeWeights, Smooth, fit_contacts, fit_grid};
use palpate::{Contacts, Fit, Grid};
use palpate_fitting::fit::Equations;
use palpate_fitting::observation::to_csr;
use palpate_numeric::linalg::Sites;

fn height(x: f64, y: f64) -> [f64; 3] {
    [
        0.3 * (6.0 * x).sin() * (5.0 * y).cos() + 0.1 * x * y,
        1.8 * (6.0 * x).cos() * (5.0 * y).cos() + 0.1 * y,
        -1.5 * (6.0 * x).sin() * (5.0 * y).sin() + 0.1 * x,
    ]
}

/// Ripples in the data that no spline follows stand for noise.
fn ripple(i: usize, j: usize) -> f64 {
    1e-3 * ((i * 37 + j * 91) as f64).sin()
}

fn grid(slopes: bool) -> Grid {
    let x: Vec<f64> = (0..60).map(|i| (i as f64 + 0.5) / 60.0).collect();
    let y: Vec<f64> = (0..45).map(|j| 0.75 * (j as f64 + 0.5) / 45.0).collect();
    let map = |k: usize| Array2::from_shape_fn((60, 45), |(i, j)| height(x[i], y[j])[k] + ripple(i + 7 * k, j));
    let mut grid = Grid::new(x.clone(), y.clone(), map(0));
    if slopes {
        (grid.zx, grid.zy) = (Some(map(1)), Some(map(2)));
    }
    grid
}

fn flattened(grid: &Grid) -> Contacts {
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for a in &grid.x {
        for b in &grid.y {
            x.push(*a);
            y.push(*b);
        }
    }
    let column = |a: &Array2<f64>| a.iter().copied().collect::<Vec<_>>();
    let contacts = Contacts::from_positions(x, y, column(&grid.z));
    match (&grid.zx, &grid.zy) {
        (Some(zx), Some(zy)) => contacts.with_slopes(column(zx), column(zy)),
        _ => contacts,
    }
}

fn options(method: Method) -> FitOptions {
    FitOptions::default()
        .with_degrees(3, 2)
        .with_segments(9, 12)
        .with_objective(Objective::Slopes(SlopeWeights::Explicit([1.0, 0.2, 0.3])))
        .with_method(method)
}

fn gap(a: &Fit, b: &Fit) -> f64 {
    let (a, b) = (&a.solution().coefficients, &b.solution().coefficients);
    let largest = a.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    a.iter().zip(b).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs())) / largest
}

#[test]
fn every_method_gives_the_same_coefficients_on_a_complete_grid() {
    let grid = grid(true);
    let reference = fit_grid(&grid, &options(Method::Qr)).unwrap();
    for method in [Method::Auto, Method::Cholesky, Method::Kronecker, Method::Pcg] {
        let fit = fit_grid(&grid, &options(method)).unwrap();
        assert!(gap(&reference, &fit) < 1e-12, "{method:?}: {:e}", gap(&reference, &fit));
        assert!(fit.certificate().backward_error < 1e-13, "{method:?}");
    }
}

#[test]
fn a_grid_and_the_same_points_scattered_agree() {
    for slopes in [false, true] {
        let grid = grid(slopes);
        let a = fit_grid(&grid, &options(Method::Auto)).unwrap();
        let b = fit_contacts(&flattened(&grid), &options(Method::Auto)).unwrap();
        assert!(gap(&a, &b) < 1e-12, "slopes {slopes}: {:e}", gap(&a, &b));
    }
}

#[test]
fn missing_pixels_by_cells_and_by_conjugate_gradients_agree() {
    let mut grid = grid(true);
    for (i, j) in [(3, 3), (30, 20), (31, 20), (59, 44)] {
        grid.z[[i, j]] = f64::NAN;
    }
    let a = fit_grid(&grid, &options(Method::Cholesky)).unwrap();
    let b = fit_grid(&grid, &options(Method::Pcg)).unwrap();
    assert!(gap(&a, &b) < 1e-12, "{:e}", gap(&a, &b));
    let refused = fit_grid(&grid, &options(Method::Kronecker)).unwrap_err();
    assert!(refused.to_string().contains("complete grids"), "{refused}");
}

/// The written objective, dense: normal equations of the rows that `to_csr` writes out, by nalgebra's SVD.
fn oracle(equations: &Equations) -> Vec<f64> {
    let csr = to_csr(&equations.sites, &equations.row_weights);
    let dense = nalgebra_sparse::convert::serial::convert_csr_dense(&csr);
    let rhs = nalgebra_sparse::na::DVector::from_iterator(
        3 * equations.sites.len(),
        equations.targets.iter().flatten().copied(),
    );
    dense.svd(true, true).solve(&rhs, 1e-13).unwrap().iter().copied().collect()
}

#[test]
fn structured_and_dense_routes_agree_on_scattered_contacts() {
    let contacts = {
        let (mut x, mut y, mut z, mut zx, mut zy) = (vec![], vec![], vec![], vec![], vec![]);
        for k in 0..300 {
            let (u, v) = ((k as f64 * 0.754_877_666).fract(), (k as f64 * 0.569_840_291).fract());
            let [h, p, q] = height(u, v);
            x.push(u);
            y.push(v);
            z.push(h + ripple(k, 1));
            zx.push(p);
            zy.push(q);
        }
        Contacts::from_positions(x, y, z).with_slopes(zx, zy)
    };
    for method in [Method::Cholesky, Method::Qr] {
        let fit = fit_contacts(&contacts, &options(method).with_segments(3, 2)).unwrap();
        let expected = oracle(fit.equations());
        let largest = expected.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (a, b) in fit.solution().coefficients.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-12 * largest, "{method:?}");
        }
    }
}

#[test]
fn a_large_roughness_leaves_the_best_plane() {
    let smooth = options(Method::Auto).with_smooth(Smooth::Lambda(1e9));
    let fit = fit_grid(&grid(true), &smooth).unwrap();
    let bend = fit.surface().at(0.1, 0.1);
    assert!(bend.zxx.abs() < 1e-5 && bend.zxy.abs() < 1e-5 && bend.zyy.abs() < 1e-5);
    let matrix_free = fit_grid(&grid(true), &options(Method::Pcg).with_smooth(Smooth::Lambda(1e-3))).unwrap();
    let factored = fit_grid(&grid(true), &options(Method::Cholesky).with_smooth(Smooth::Lambda(1e-3))).unwrap();
    assert!(gap(&factored, &matrix_free) < 1e-11, "{:e}", gap(&factored, &matrix_free));
    assert_eq!(fit.equations().sites.len(), 60 * 45);
}

/// The penalty's rows count in the residual: an answer that solves its equations to rounding is told so.
#[test]
fn a_smoothed_answer_has_a_backward_error_of_rounding() {
    for method in [Method::Cholesky, Method::Qr] {
        let smooth = options(method).with_smooth(Smooth::Lambda(1e-3));
        let fit = fit_contacts(&flattened(&grid(true)), &smooth).unwrap();
        let error = fit.certificate().backward_error;
        assert!(error < 1e-13, "{method:?}: {error:e}");
    }
}
