//! Adaptive fits of surfaces with known truth.

use super::*;
use palpate_numeric::draws::Lcg;

/// Scattered contacts of a surface over [-1, 1]^2 with noise.
fn touched(count: usize, noise: f64, seed: u64, truth: impl Fn(f64, f64) -> f64) -> Contacts {
    let mut draw = Lcg::new(seed);
    let (mut x, mut y, mut z) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..count {
        let [u, v] = [0, 1].map(|_| 2.0 * draw.uniform() - 1.0);
        x.push(u);
        y.push(v);
        z.push(truth(u, v) + noise * draw.normal());
    }
    Contacts::from_positions(x, y, z)
}

fn smooth(x: f64, y: f64) -> f64 {
    0.3 * (1.5 * x).sin() * (1.2 * y + 0.3).cos()
}

fn bump([x, y]: [f64; 2], [u, v]: [f64; 2], height: f64, radius: f64) -> f64 {
    height * (-((x - u).powi(2) + (y - v).powi(2)) / (radius * radius)).exp()
}

#[test]
fn noise_alone_splits_nothing() {
    for seed in 0..10 {
        let fit = fit_adaptive(&touched(20_000, 0.01, seed, smooth), &AdaptiveOptions::default()).unwrap();
        assert_eq!(fit.report().rounds.len(), 1, "{:?}", fit.report().rounds);
        assert!((fit.height_noise() / 0.01 - 1.0).abs() < 0.02);
    }
}

#[test]
fn a_small_feature_is_followed_and_the_rest_left_alone() {
    let truth = |x: f64, y: f64| smooth(x, y) + bump([x, y], [0.31, -0.44], 0.05, 0.03);
    let fit = fit_adaptive(&touched(200_000, 0.002, 3, truth), &AdaptiveOptions::default()).unwrap();
    println!("{:?} noise {} lambdas {:?}", fit.report().rounds, fit.height_noise(), fit.report().lambdas);
    assert!((fit.height_noise() / 0.002 - 1.0).abs() < 0.02);
    assert!((fit.at(0.31, -0.44).z - truth(0.31, -0.44)).abs() < 0.003);
    assert!(fit.unknowns_below(600));
}

impl AdaptiveFit {
    fn unknowns_below(&self, most: usize) -> bool {
        self.field.coefficients().len() < most
    }
}
