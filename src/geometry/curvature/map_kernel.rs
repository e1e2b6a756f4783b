//! The kernel's twin of S and R against the shape operator of this room.

use palpate_numeric::simd::shape_maps_twin;

use super::Derivatives;

/// Spheres, cylinders at any angle, saddles, planes and anything, on slopes up to 30.
fn samples() -> [Vec<f64>; 5] {
    let mut state = 9_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / 2.0_f64.powi(52) - 1.0
    };
    let mut out: [Vec<f64>; 5] = Default::default();
    for k in 0..20_011 {
        let steep = if k % 7 == 0 { 30.0 } else { 1.0 };
        let (p, q) = (next() * steep, next() * steep);
        let (s, c) = (next() * 3.0).sin_cos();
        let (e, f, g) = match k % 4 {
            0 => (next(), next(), next()),
            1 => (s * s, s * c, c * c),
            2 => (-(1.0 + p * p), -p * q, -(1.0 + q * q)), // a sphere's: both curvatures equal
            _ => (c, s, -c),
        };
        let scale = 10.0_f64.powi(k % 9 - 4);
        let flat = if k % 997 == 0 { 0.0 } else { scale };
        for (column, value) in out.iter_mut().zip([p, q, e * flat, f * flat, g * flat]) {
            column.push(value);
        }
    }
    out
}

#[test]
fn twin_is_the_shape_operator_of_the_curvature_room() {
    let d = samples();
    let n = d[0].len();
    let (mut s, mut r) = (vec![0.0; n], vec![0.0; n]);
    shape_maps_twin(d.each_ref().map(|v| &v[..]), &mut s, &mut r);
    for i in 0..n {
        let k = Derivatives::of_height(d[0][i], d[1][i], d[2][i], d[3][i], d[4][i]).principal().unwrap();
        assert!((r[i] - k.curvedness()).abs() <= 1e-13 * r[i], "R at {i}");
        match k.shape_index() {
            None => assert!(s[i].is_nan()),
            Some(expected) => assert!((s[i] - expected).abs() < 1e-12, "S at {i}: {} {expected}", s[i]),
        }
    }
}
