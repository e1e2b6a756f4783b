//! Surfaces in space: the properties that the bench `parametric` prints figures of.

use palpate::Contacts;
use palpate::Orientation;
use palpate::fit::{FitError, FitOptions, NormalSigma, Objective, Smooth, SurfaceKind, fit_contacts};
use palpate::parametric::{FittedSurface, ParametricFit};
use palpate::scene::{Effect, Surface, Sweep, World};
use palpate_fitting::parametric::choose_surface;
use palpate_world::scene::linspace;

mod shapes;

fn world(surface: Surface) -> World {
    World::new(surface, Sweep::new(vec![-4.0, 0.0, 4.0], linspace(-4.0, 4.0, 9)))
}

fn sphere(radius: f64) -> Surface {
    Surface::sphere(radius)
}

fn options(degree: usize) -> FitOptions {
    FitOptions::default()
        .with_surface(SurfaceKind::Parametric)
        .with_degree(degree)
        .with_objective(Objective::Normals(NormalSigma::Known { z: 0.02, normal_deg: 0.03_f64.to_degrees() }))
        .with_smooth(Smooth::Lambda(30.0))
}

/// Mean S and mean R over the contacts' feet.
fn at_contacts(fit: &ParametricFit) -> [f64; 2] {
    let surface = fit.input_surface().unwrap();
    let feet = fit.feet();
    let shapes = feet.iter().map(|p| surface.at(p[0], p[1]).principal().unwrap());
    let sum = shapes.fold([0.0; 2], |m, p| [m[0] + p.shape_index().unwrap(), m[1] + p.curvedness()]);
    sum.map(|v| v / feet.len() as f64)
}

#[test]
fn the_ball_that_the_paper_could_not_feel() {
    let contacts = world(sphere(5.7)).compile().unwrap().noise_free();
    for degree in [3, 4] {
        let fit = ParametricFit::new(&contacts, &options(degree)).unwrap();
        let [s, r] = at_contacts(&fit);
        assert!(s >= 0.98 && (r * 5.7 - 1.0).abs() < 0.02, "degree {degree}: S {s}, R r {}", r * 5.7);
        assert!(fit.certificate().settled && fit.certificate().fold_free);
    }
}

#[test]
fn cylinders_are_ridges_at_every_angle() {
    for radius in [5.7, 10.0] {
        for angle in [0.0, 20.0, 45.0, 70.0, 90.0] {
            let bar = Surface::cylinder(radius).turned(angle);
            let fit = ParametricFit::new(&world(bar).compile().unwrap().noise_free(), &options(3)).unwrap();
            let [s, r] = at_contacts(&fit);
            assert!((s - 0.5).abs() < 0.01, "r {radius} at {angle}: S {s}");
            assert!((r * radius - 0.5_f64.sqrt()).abs() < 0.02, "r {radius} at {angle}: R r {}", r * radius);
        }
    }
}

#[test]
fn noise_neither_folds_nor_runs_away() {
    let noisy = world(sphere(5.7))
        .with(Effect::position_noise([0.02; 3]))
        .with(Effect::normal_noise(0.03_f64.to_degrees()))
        .compile()
        .unwrap();
    let mut mean = 0.0;
    for replicate in 0..20 {
        let fit = ParametricFit::new(&noisy.simulate(7, replicate).0, &options(3)).unwrap();
        let [s, r] = at_contacts(&fit);
        mean += s / 20.0;
        assert!((r * 5.7 - 1.0).abs() < 0.2, "replicate {replicate}: R r {}", r * 5.7);
        assert!(fit.certificate().fold_free, "replicate {replicate}: {:?}", fit.certificate());
    }
    assert!(mean >= 0.95, "mean S {mean}");
}

#[test]
fn a_surface_that_bends_more_than_its_contacts_felt_is_refused() {
    let noisy = world(sphere(5.7))
        .with(Effect::position_noise([0.02; 3]))
        .with(Effect::normal_noise(0.03_f64.to_degrees()))
        .compile()
        .unwrap();
    let sigma = |share: f64| NormalSigma::Known { z: 0.02 * share, normal_deg: (0.03_f64 * share).to_degrees() };
    // no fairness, and noise taken for shape
    let mut refused = 0;
    for (replicate, segments) in [(0, 2), (1, 3), (2, 3), (0, 4)] {
        let (contacts, _) = noisy.simulate(1997, replicate);
        let thin = options(3)
            .with_segments(segments, segments)
            .with_smooth(Smooth::Lambda(0.0))
            .with_objective(Objective::Normals(sigma(0.1)));
        match ParametricFit::new(&contacts, &thin) {
            Ok(fit) => {
                let r = at_contacts(&fit)[1] * 5.7;
                assert!(fit.certificate().bending <= 2.5 && r < 1.5, "{segments} segments: R r {r}");
            }
            Err(FitError::Runaway { bending, most }) => {
                assert!(bending > most);
                refused += 1;
            }
            Err(other) => panic!("{other}"),
        }
    }
    assert!(refused >= 3, "only {refused} ran away, so little was tested");
    // the same contacts with the fairness that they call for
    let fair = options(3).with_segments(3, 3).with_smooth(Smooth::Auto);
    let fit = ParametricFit::new(&noisy.simulate(1997, 1).0, &fair).unwrap();
    let [s, r] = at_contacts(&fit);
    assert!(s > 0.9 && (r * 5.7 - 1.0).abs() < 0.1, "S {s}, R r {}", r * 5.7);
    assert!(fit.certificate().bending < 2.0, "{:?}", fit.certificate());
}

#[test]
fn noisy_normals_do_not_call_for_a_surface_in_space() {
    let scene = palpate_app::io::scene_file::builtin("poor-normals").unwrap();
    let (contacts, _) = scene.world.compile().unwrap().simulate(scene.seed, 0);
    let (kind, reason) = choose_surface(&contacts, &scene.fit.clone().with_surface(SurfaceKind::Auto));
    assert_eq!(kind, SurfaceKind::Height, "{reason}");
    assert!(reason.contains("noise"), "{reason}");
    // the same pipe without its noise turns too far for a height field of degree 2
    let bare = World { effects: Vec::new(), ..scene.world };
    let (kind, reason) =
        choose_surface(&bare.compile().unwrap().noise_free(), &scene.fit.with_surface(SurfaceKind::Auto));
    assert_eq!(kind, SurfaceKind::Parametric, "{reason}");
}

#[test]
fn scenes_that_go_round_close_without_a_seam() {
    for (name, s_true, closed) in [("around-cylinder", Some(0.5), vec![1]), ("around-torus", None, vec![0, 1])] {
        let scene = palpate_app::io::scene_file::builtin(name).unwrap();
        let (contacts, truth) = scene.world.compile().unwrap().simulate(scene.seed, 0);
        let fit = ParametricFit::new(&contacts, &scene.fit).unwrap();
        assert!(fit.certificate().fold_free && fit.certificate().settled, "{name}: {:?}", fit.certificate());
        let maps = &fit.shape().maps;
        let (mut worst, mut count) = ([0.0_f64; 2], 0);
        for (at, _) in maps.supported.indexed_iter().filter(|(_, s)| **s) {
            let local =
                truth.near(maps.points[at], maps.normals[at]).expect("every point of the map lies near the body");
            worst[0] += (maps.shape_index[at] - local.shape_index().unwrap()).powi(2);
            worst[1] += (maps.curvedness[at] / local.curvedness() - 1.0).powi(2);
            count += 1;
        }
        let rms = worst.map(|w| (w / f64::from(count)).sqrt());
        assert!(rms[0] < 0.1 && rms[1] < 0.1, "{name}: rms of S {}, of R {}", rms[0], rms[1]);
        if let Some(s) = s_true {
            assert!((fit.shape().shape_index.mean.unwrap() - s).abs() < 0.03);
        }
        let surface = fit.surface();
        for k in closed {
            let [lo, hi] = surface.knots()[k].domain();
            let middle = surface.knots()[1 - k].domain().iter().sum::<f64>() / 2.0;
            let at = |t: f64| if k == 0 { surface.at(t, middle) } else { surface.at(middle, t) };
            let [a, b] = [lo, hi - 1e-12].map(|t| at(t).principal().unwrap());
            assert!((a.shape_index().unwrap() - b.shape_index().unwrap()).abs() < 1e-8, "{name}");
            assert!((a.curvedness() / b.curvedness() - 1.0).abs() < 1e-8, "{name}");
        }
    }
}

#[test]
fn no_direction_of_space_is_special() {
    let noisy = world(sphere(6.0)).with(Effect::position_noise([0.02; 3])).compile().unwrap();
    let (lanes, _) = noisy.simulate(3, 0);
    let mut scattered = lanes.clone();
    (scattered.finger, scattered.station) = (None, None);
    for contacts in [lanes, scattered] {
        let shape = |contacts: &Contacts| {
            let fit = ParametricFit::new(contacts, &options(3)).unwrap();
            [fit.shape().shape_index.mean.unwrap(), fit.shape().curvedness.mean.unwrap()]
        };
        let first = shape(&contacts);
        for k in 0..5 {
            let t = f64::from(k);
            let turned = shapes::turned(&contacts, [(t + 0.3).sin(), (2.0 * t).cos(), 0.4], 0.5 + 1.1 * t);
            let found = shape(&turned);
            assert!((0..2).all(|i| (found[i] - first[i]).abs() < 1e-9), "{found:?} is not {first:?}");
        }
    }
}

#[test]
fn what_goes_round_has_no_seam() {
    let round = |contacts: &Contacts, closed: [bool; 2], segments: usize| {
        let options = options(3).with_closed(closed).with_segments(segments, segments);
        ParametricFit::new(contacts, &options).unwrap()
    };
    let bar = round(&shapes::ring_of_bar(5.0, 4, 12), [false, true], 1);
    assert!((bar.shape().shape_index.mean.unwrap() - 0.5).abs() < 0.01);
    assert!((bar.shape().radius.unwrap() - 5.0).abs() < 0.05);
    let ring = round(&shapes::torus(8.0, 3.0, 10, 10), [true, true], 6);
    for fit in [&bar, &ring] {
        let surface = fit.surface();
        let [lo, hi] = surface.knots()[1].domain();
        for u in [0.1, 0.5] {
            let [a, b] = [lo, hi - 1e-12].map(|v| surface.at(u, v).principal().unwrap());
            assert!((a.shape_index().unwrap() - b.shape_index().unwrap()).abs() < 1e-8);
            assert!((a.curvedness() / b.curvedness() - 1.0).abs() < 1e-8);
        }
        assert_eq!(fit.shape().support, 1.0);
    }
}

#[test]
fn half_balls_are_felt_to_the_rim_with_and_without_lanes() {
    for contacts in [shapes::half_ball(5.0, 5, 9), shapes::scattered_half_ball(5.0, 60)] {
        let fit = ParametricFit::new(&contacts, &options(3).with_segments(2, 2)).unwrap();
        let [s, r] = at_contacts(&fit);
        assert!(s > 0.95 && (5.0 * r - 1.0).abs() < 0.05, "S {s}, R r {}", 5.0 * r);
        assert!(fit_contacts(&contacts, &FitOptions::default()).is_err() || s > 0.95);
    }
}

#[test]
fn bad_input_is_refused_or_certified() {
    let contacts = world(sphere(10.0)).compile().unwrap().noise_free();
    // every other lane turned over
    let mut sides = contacts.clone();
    if let Orientation::Normals { nx, ny, nz } = &mut sides.orientation {
        for r in 0..9 {
            (nx[r], ny[r], nz[r]) = (-nx[r], -ny[r], -nz[r]);
        }
    }
    assert!(matches!(ParametricFit::new(&sides, &options(3)), Err(FitError::Sheet { .. })));
    // one finger
    let one = World::new(sphere(10.0), Sweep::new(vec![0.0], linspace(-4.0, 4.0, 20))).compile().unwrap().noise_free();
    let mut unlabelled = one.clone();
    (unlabelled.finger, unlabelled.station) = (None, None);
    for line in [one, unlabelled] {
        let found = ParametricFit::new(&line, &options(3));
        assert!(matches!(found, Err(FitError::Sheet { .. })), "{found:?}");
    }
    // stations of the middle lane counted backwards: its chords cross the others'
    let mut crossed = contacts.clone();
    if let Some(stations) = &mut crossed.station {
        (9..18).for_each(|r| stations[r] = 8 - stations[r]);
    }
    match ParametricFit::new(&crossed, &options(3)) {
        Err(FitError::Sheet { .. }) => {}
        Ok(fit) => {
            // flattened without its labels, and the certificate says that they are not those of lanes
            let certificate = fit.certificate();
            assert!(certificate.parametrisation.starts_with("landmark Isomap"), "{certificate:?}");
            assert!(certificate.fingers_monotone == Some(false) && !certificate.fold_free, "{certificate:?}");
            assert!((at_contacts(&fit)[1] * 10.0 - 1.0).abs() < 0.2);
        }
        Err(other) => panic!("{other}"),
    }
    let bare = Contacts { orientation: Orientation::None, ..contacts };
    assert!(matches!(ParametricFit::new(&bare, &options(3)), Err(FitError::Objective { .. })));
}

#[test]
fn auto_stands_up_only_where_it_must() {
    let auto = FitOptions::default().with_surface(SurfaceKind::Auto);
    let flat = world(sphere(20.0)).compile().unwrap().noise_free();
    assert!(matches!(FittedSurface::of(&flat, &auto).unwrap().0, FittedSurface::Height(_)));
    let steep = world(sphere(5.7)).compile().unwrap().noise_free();
    let (found, reason) = FittedSurface::of(&steep, &auto).unwrap();
    let FittedSurface::Parametric(fit) = found else { panic!("{reason}") };
    assert!(reason.contains("from the mean") && reason.contains("degree raised"), "{reason}");
    assert!(fit.shape().shape_index.mean.unwrap() > 0.95);
}
