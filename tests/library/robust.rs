//! Slips must not move the answer, and the data choose how smooth is smooth enough.

use palpate::Contacts;
use palpate::fit::{FitOptions, Method, NormalSigma, Note, Objective, Robust, SlopeWeights, Smooth, fit_contacts};

use crate::draws::Draws;

/// The inside of a pipe of radius 94 along x, 60 x 60 wide, heights to 0.5, normals to 5 degrees, `share` of gross slips.
fn pipe(share: f64) -> Contacts {
    let mut dice = Draws::new(1997);
    let mut columns: [Vec<f64>; 6] = Default::default();
    for _ in 0..800 {
        let (x, y) = (60.0 * dice.uniform() - 30.0, 60.0 * dice.uniform() - 30.0);
        let root = (94.0_f64 * 94.0 - y * y).sqrt();
        let mut point = [x, y, y * y / (94.0 + root) + 0.5 * dice.normal(), 0.0, -y / 94.0, root / 94.0];
        for k in 3..6 {
            point[k] += 0.08 * dice.normal();
        }
        if dice.uniform() < share {
            point[2] += 40.0 + 20.0 * dice.uniform();
            point[3] = 1.0;
        }
        columns.iter_mut().zip(point).for_each(|(c, v)| c.push(v));
    }
    let [x, y, z, nx, ny, nz] = columns;
    Contacts::from_positions(x, y, z).with_normals(nx, ny, nz)
}

#[test]
fn a_pipe_with_five_per_cent_slips_keeps_its_radius() {
    let objective = Objective::Normals(NormalSigma::Known { z: 0.5, normal_deg: 5.0 });
    let radius = |share: f64, robust: Robust| {
        let options = FitOptions::default().with_objective(objective).with_robust(robust).with_inset(0.2);
        fit_contacts(&pipe(share), &options).unwrap().shape().radius
    };
    let clean = radius(0.0, Robust::None).unwrap();
    assert!((clean - 94.0).abs() < 3.0, "{clean}");
    for robust in [Robust::Huber, Robust::Tukey] {
        let found = radius(0.05, robust).unwrap();
        assert!((found - 94.0).abs() < 4.0, "{robust:?}: {found}");
    }
    let plain = radius(0.05, Robust::None);
    assert!(plain.is_none_or(|r| (r - 94.0).abs() > 4.0), "least squares alone should be off: {plain:?}");
}

/// Noise below the step of the written numbers leaves most heights of a plane alike: their median residual is nothing, and R was known
/// without any doubt.
#[test]
fn numbers_that_are_mostly_alike_do_not_say_that_there_is_no_noise() {
    let mut dice = Draws::new(7);
    let mut columns: [Vec<f64>; 3] = Default::default();
    for k in 0..200 {
        let place = [f64::from(k % 20), f64::from(k / 20), (0.6 * dice.normal()).round() / 1e3];
        columns.iter_mut().zip(place).for_each(|(c, v)| c.push(v));
    }
    let [x, y, z] = columns;
    let contacts = Contacts::from_positions(x, y, z);
    let u = |robust: Robust| {
        let fit = fit_contacts(&contacts, &FitOptions::default().with_robust(robust)).unwrap();
        fit.shape().curvedness.u.unwrap()
    };
    for robust in [Robust::Huber, Robust::Tukey] {
        let ratio = u(robust) / u(Robust::None);
        assert!((0.2..2.0).contains(&ratio), "{robust:?}: {ratio} of the u of least squares");
    }
}

#[test]
fn slips_are_counted() {
    let options =
        FitOptions::default().with_objective(Objective::Slopes(SlopeWeights::Equal)).with_robust(Robust::Tukey);
    let fit = fit_contacts(&pipe(0.05), &options).unwrap();
    let counted = fit.notes().iter().find_map(|n| match n {
        Note::Outliers { sites, .. } => Some(*sites),
        _ => None,
    });
    // 41 of the 800 draws slipped; a few good contacts far out lose half their weight too
    assert!(counted.is_some_and(|n| (30..=160).contains(&n)), "{counted:?}");
}

#[test]
fn smoothing_by_the_data_is_nearer_the_truth_than_none() {
    let mut dice = Draws::new(7);
    let truth = |x: f64, y: f64| (3.0 * x).sin() * (2.0 * y).cos();
    let (mut x, mut y, mut z) = (vec![], vec![], vec![]);
    for _ in 0..500 {
        let (u, v) = (2.0 * dice.uniform() - 1.0, 2.0 * dice.uniform() - 1.0);
        x.push(u);
        y.push(v);
        z.push(truth(u, v) + 0.1 * dice.normal());
    }
    let contacts = Contacts::from_positions(x, y, z);
    let error = |smooth: Smooth| {
        let options =
            FitOptions::default().with_degree(3).with_segments(12, 12).with_smooth(smooth).with_method(Method::Auto);
        let fit = fit_contacts(&contacts, &options).unwrap();
        let surface = fit.input_surface().unwrap();
        let mut sum = 0.0;
        for i in 0..20 {
            for j in 0..20 {
                let (u, v) = (-0.9 + 0.09 * i as f64, -0.9 + 0.09 * j as f64);
                sum += (surface.at(u, v).z - truth(u, v)).powi(2);
            }
        }
        (sum / 400.0).sqrt()
    };
    let (rough, chosen, flat) = (error(Smooth::None), error(Smooth::Auto), error(Smooth::Lambda(1e6)));
    assert!(chosen < 0.5 * rough && chosen < 0.5 * flat, "none {rough}, chosen {chosen}, flat {flat}");
}
