//! What a recognition answers on simulated patches.

use palpate_geometry::contact::{Contacts, Grid, Orientation};
use palpate_geometry::curvature::ShapeClass;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::{Vector, cross, dot, unit};

use super::discrepancy::Forms;
use super::equations::Moved;
use super::evidence::{Evidence, FactorPair, Linearised, Look, SearchContext};
use super::kinds::ConstantCurvature;
use super::noise::Limit;
use super::start::{Patch, relief};
use super::*;

/// Uniform and gaussian numbers of one seed.
struct Numbers(EffectDraws);

impl Numbers {
    fn new(seed: u64) -> Numbers {
        Numbers(EffectDraws::new(seed, "recognition tests"))
    }

    fn uniforms(&self, contact: usize) -> [f64; 2] {
        let mut out = [0.0; 2];
        self.0.uniforms(contact as u64, 0, 2, &mut out);
        out.map(|v| 2.0 * v - 1.0)
    }

    fn gaussian(&self, contact: usize) -> f64 {
        let mut out = [0.0];
        self.0.gaussians(contact as u64, 9, 1, &mut out);
        out[0]
    }
}

/// Contacts at random places of a square of half width 4, height noise `sd`.
fn patch(height: impl Fn(f64, f64) -> f64, count: usize, sd: f64, seed: u64) -> Vec<Vector> {
    let numbers = Numbers::new(seed);
    (0..count)
        .map(|i| {
            let [x, y] = numbers.uniforms(i).map(|v| 4.0 * v);
            [x, y, height(x, y) + sd * numbers.gaussian(i)]
        })
        .collect()
}

fn sphere(x: f64, y: f64) -> f64 {
    (100.0 - x * x - y * y).sqrt() - 10.0
}

fn cylinder(x: f64, y: f64) -> f64 {
    let across = 0.8 * x - 0.6 * y;
    (100.0 - across * across).sqrt() - 10.0
}

fn recognised(points: &[Vector]) -> Recognition {
    Recognition::of(&Contacts::from_points(points), &RecognitionOptions::default()).unwrap()
}

/// Whether contacts show a plane is forecast as often as it comes true: the doubt that an interval keeps is none of the class.
#[test]
fn a_plane_is_as_sure_as_it_is_right() {
    let found: Vec<Recognition> = (0..20).map(|seed| recognised(&patch(|x, _| 0.1 * x, 36, 0.02, seed))).collect();
    let given = |r: &Recognition| r.class_probability.iter().find(|c| c.0 == ShapeClass::Plane).map_or(0.0, |c| c.1);
    let right = found.iter().filter(|r| r.class == ShapeClass::Plane).count() as f64 / 20.0;
    let forecast = found.iter().map(given).sum::<f64>() / 20.0;
    assert!(right > 0.9 && (forecast - right).abs() < 0.1, "{forecast} {right}");
    let whole = |r: &Recognition| (r.class_probability.iter().map(|c| c.1).sum::<f64>() - 1.0).abs() < 1e-12;
    assert!(found.iter().all(whole));
}

#[test]
fn sphere_cylinder_saddle_and_plane_are_named_right() {
    let found = recognised(&patch(sphere, 60, 0.02, 1));
    assert_eq!((found.class, found.hypothesis), (ShapeClass::Cap, Hypothesis::Sphere));
    // places alone do not tell a cap from a cup
    let [(cap, p), (cup, q)] = found.class_probability[..2] else { panic!("{:?}", found.class_probability) };
    assert_eq!((cap, cup, found.side_known), (ShapeClass::Cap, ShapeClass::Cup, false));
    assert!((found.radius.unwrap() - 10.0).abs() < 0.4 && p + q > 0.9 && p == q);
    let found = recognised(&patch(cylinder, 60, 0.02, 2));
    assert_eq!((found.class, found.hypothesis), (ShapeClass::Ridge, Hypothesis::Cylinder));
    assert!((found.radius.unwrap() - 10.0).abs() < 0.5);
    // the larger curvature of a ridge is zero, along its axis
    assert!(dot(found.direction.unwrap(), [0.6, 0.8, 0.0]).abs() > 0.99);
    let found = recognised(&patch(|x, y| (x * x - y * y) / 20.0, 60, 0.02, 3));
    assert_eq!(found.class, ShapeClass::Saddle);
    let interval = found.shape_index.unwrap().interval;
    assert!(interval[0] < 0.02 && interval[1] > -0.02);
    let found = recognised(&patch(|x, y| 0.2 * x - 0.1 * y, 60, 0.02, 4));
    assert_eq!((found.class, found.shape_index.is_none(), found.radius), (ShapeClass::Plane, true, None));
    assert!(found.plane_probability > 0.5);
}

#[test]
fn turning_scaling_and_shuffling_change_nothing_but_coordinates() {
    let points = patch(|x, y| 0.05 * x * x - 0.02 * y * y + 0.01 * x * y, 60, 0.01, 5);
    let normals: Vec<Vector> =
        points.iter().map(|[x, y, _]| unit([-0.1 * x - 0.01 * y, 0.04 * y - 0.01 * x, 1.0])).collect();
    let of = |points: &[Vector], normals: &[Vector]| {
        let contacts = Contacts::from_points(points).with_normal_vectors(normals);
        Recognition::of(&contacts, &RecognitionOptions::default()).unwrap()
    };
    let first = of(&points, &normals);
    let (s, r) = (first.shape_index.unwrap().mean, first.curvedness.mean);
    let e1 = unit([1.0, 2.0, -0.5]);
    let e2 = unit(cross([0.3, 0.1, 1.0], e1));
    let e3 = cross(e1, e2);
    let turn = |v: &Vector| [dot(*v, e1), dot(*v, e2), dot(*v, e3)];
    let moved: Vec<Vector> = points.iter().map(|p| turn(p).map(|v| 1000.0 * v + 5e4)).collect();
    let turned = of(&moved, &normals.iter().map(turn).collect::<Vec<_>>());
    eprintln!(
        "{s} {} {r} {} u {} notes {:?} {:?} {:?} {:?}",
        turned.shape_index.unwrap().mean,
        turned.curvedness.mean * 1000.0,
        first.curvedness.u,
        first.notes,
        turned.notes,
        first.hypothesis,
        turned.hypothesis
    );
    assert!(
        (turned.shape_index.unwrap().mean - s).abs() < 1e-3 && (turned.curvedness.mean * 1000.0 / r - 1.0).abs() < 1e-3
    );
    let back = |v: &Vec<Vector>| v.iter().rev().copied().collect::<Vec<Vector>>();
    let shuffled = of(&back(&points), &back(&normals));
    assert_eq!((shuffled.shape_index, shuffled.curvedness), (first.shape_index, first.curvedness));
}

#[test]
fn shared_errors_widen_the_interval_and_count_as_few_contacts() {
    let numbers = Numbers::new(6);
    let rough = |sd: f64| -> Vec<Vector> {
        // errors that are constant over tiles of width 1 are shared by neighbours
        let shared = |x: f64, y: f64| sd * numbers.gaussian(1000 + ((x + 5.0) as usize) * 10 + (y + 5.0) as usize);
        patch(sphere, 150, 0.01, 7).iter().map(|&[x, y, z]| [x, y, z + shared(x, y)]).collect()
    };
    let (white, shared) = (recognised(&rough(0.0)), recognised(&rough(0.05)));
    assert!(shared.curvedness.u > 2.0 * white.curvedness.u);
    assert!(white.effective_contacts > 100.0 && shared.effective_contacts < 0.7 * white.effective_contacts);
    assert!(shared.noise.sd_correlated > 0.01);
}

#[test]
fn outliers_and_faulty_normals_are_set_aside_and_counted() {
    let mut points = patch(sphere, 80, 0.01, 8);
    let mut normals: Vec<Vector> = points.iter().map(|[x, y, z]| unit([*x, *y, z + 10.0])).collect();
    points[5][2] += 3.0;
    points[17][2] -= 2.0;
    normals[30] = [0.0; 3];
    normals[31] = normals[31].map(|v| -v);
    let found =
        Recognition::of(&Contacts::from_points(&points).with_normal_vectors(&normals), &RecognitionOptions::default())
            .unwrap();
    assert_eq!((found.outliers, found.normals_of_length_zero, found.normals_flipped), (2, 1, 1));
    assert_eq!((found.class, found.normals), (ShapeClass::Cap, NormalsUse::Believed));
    assert!((found.radius.unwrap() - 10.0).abs() < 0.3);
}

#[test]
fn half_a_ball_and_half_a_cylinder_come_within_three_percent() {
    let numbers = Numbers::new(9);
    let ball: Vec<Vector> = (0..150)
        .map(|i| {
            let [a, z] = numbers.uniforms(i);
            let (z, across) = (z.abs(), (1.0 - z * z).sqrt());
            let angle = a * std::f64::consts::PI;
            [across * angle.cos(), across * angle.sin(), z].map(|v| v * (3.0 + 0.005 * numbers.gaussian(i)))
        })
        .collect();
    let found = recognised(&ball);
    assert_eq!(found.class, ShapeClass::Cap);
    assert!((found.radius.unwrap() / 3.0 - 1.0).abs() < 0.03);
    let can: Vec<Vector> = (0..150)
        .map(|i| {
            let [a, y] = numbers.uniforms(i);
            let (angle, r) = (a * std::f64::consts::FRAC_PI_2, 3.0 + 0.005 * numbers.gaussian(i));
            [r * angle.sin(), 4.0 * y, r * angle.cos()]
        })
        .collect();
    let found = recognised(&can);
    assert_eq!(found.class, ShapeClass::Ridge);
    assert!((found.radius.unwrap() / 3.0 - 1.0).abs() < 0.03);
}

#[test]
fn the_map_lies_on_the_surface_and_the_grid_way_agrees() {
    let axis: Vec<f64> = (0..12).map(|i| i as f64 * 0.6 - 3.3).collect();
    let mut z = ndarray::Array2::from_shape_fn((12, 12), |(i, j)| sphere(axis[i], axis[j]));
    z[[3, 4]] = f64::NAN;
    let found = Recognition::of_grid(&Grid::new(axis.clone(), axis, z), &RecognitionOptions::default()).unwrap();
    assert_eq!((found.class, found.missing, found.contacts), (ShapeClass::Cap, 1, 143));
    assert_eq!((found.map.len(), found.support.1), (64, 64));
    for point in found.map.iter().filter(|p| p.supported) {
        let [x, y, z] = point.position;
        assert!((z - sphere(x, y)).abs() < 1e-6 && dot(point.normal, unit([x, y, z + 10.0])) > 1.0 - 1e-9);
    }
}

/// Means over cells of two sheets that mirror each other lie on a plane.
#[test]
fn a_body_that_mirrors_itself_is_no_plane() {
    let height = |x: f64, y: f64| 0.4 + 0.15 * (4.0 * x).sin() * (3.0 * y).cos();
    let side: Vec<Vector> = (0..1500)
        .map(|i| [1.9, 1.3].map(|share| 2.0 * (f64::from(i) * 0.618 * share).fract() - 1.0))
        .map(|[x, y]| [x, 1.4 * y, height(x, y)])
        .collect();
    let both: Vec<Vector> = side.iter().flat_map(|&[x, y, z]| [[x, y, z], [x, y, -z]]).collect();
    let found = Recognition::of(&Contacts::from_points(&both), &RecognitionOptions::default());
    assert!(!found.is_ok_and(|found| found.hypothesis == Hypothesis::Plane));
}

#[test]
fn what_is_no_patch_is_refused_with_a_reason() {
    let refused = |points: &[Vector]| {
        Recognition::of(&Contacts::from_points(points), &RecognitionOptions::default()).unwrap_err()
    };
    let few = refused(&patch(sphere, 4, 0.0, 1));
    assert_eq!(few, RecognitionError::TooFew { found: 4, needed: 9, kind: "without" });
    let line: Vec<Vector> = (0..20).map(|i| [i as f64, 2.0 * i as f64, 1.0]).collect();
    assert!(matches!(refused(&line), RecognitionError::Collinear { .. }));
    let waves = patch(|x, _| (2.0 * x).sin(), 400, 0.01, 2);
    // or the pieces of which they are made
    let unlike = refused(&waves);
    assert!(
        matches!(unlike, RecognitionError::NotOneSheet { .. } | RecognitionError::SeveralThings { .. }),
        "{unlike}"
    );
    let ball: Vec<Vector> = (0..200)
        .map(|i| {
            unit([
                Numbers::new(3).gaussian(3 * i),
                Numbers::new(3).gaussian(3 * i + 1),
                Numbers::new(3).gaussian(3 * i + 2),
            ])
        })
        .collect();
    let closed =
        Recognition::of(&Contacts::from_points(&ball).with_normal_vectors(&ball), &RecognitionOptions::default());
    // a whole ball is recognised; what goes round and is no body is refused
    let closed = closed.unwrap();
    assert_eq!((closed.class, closed.side_known), (ShapeClass::Cap, true));
    assert!((closed.radius.unwrap() - 1.0).abs() < 1e-6);
    let knobbly: Vec<Vector> =
        ball.iter().map(|p| p.map(|v| v * (1.0 + 0.4 * (9.0 * p[0]).sin() * (8.0 * p[1]).cos()))).collect();
    assert!(matches!(refused(&knobbly), RecognitionError::AllAround { .. }));
    let nan = Contacts { orientation: Orientation::None, ..Contacts::from_points(&[[f64::NAN, 0.0, 0.0]; 12]) };
    assert!(matches!(Recognition::of(&nan, &RecognitionOptions::default()), Err(RecognitionError::Contact(_))));
}

#[test]
fn few_touches_with_normals_are_enough_for_a_class() {
    for count in [4, 5, 6, 9] {
        let points: Vec<Vector> = (0..count)
            .map(|i| {
                let angle = i as f64 * 2.4;
                let reach = 3.0 * ((i + 1) as f64 / count as f64).sqrt();
                let (x, y) = (reach * angle.cos(), reach * angle.sin());
                [x, y, sphere(x, y)]
            })
            .collect();
        let normals: Vec<Vector> = points.iter().map(|[x, y, z]| unit([*x, *y, z + 10.0])).collect();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let found = Recognition::of(&contacts, &RecognitionOptions::default()).unwrap();
        assert_eq!(found.class, ShapeClass::Cap, "{count} touches");
    }
}

/// A surface that is moved until its chart's pole lies among the contacts carries no displacement: the first look stands.
#[test]
fn a_moved_surface_without_a_chart_leaves_the_first_look() {
    let (points, normals) = bump(true, 1);
    let options = RecognitionOptions::default();
    let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
    let patch = Patch::new(&Observations::from_contacts(&contacts, &options).unwrap(), &options).unwrap();
    let cells = patch.cells(&options.tuning);
    let distances = noise::distances_between(&cells);
    let factors = FactorPair::new(&cells, &distances);
    let tuning = &options.tuning;
    let plain = Linearised::new(&cells, &patch.points, patch.fitted(&cells, tuning), &factors, tuning);
    let moved = |k: f64| {
        let base = ConstantCurvature::new([0.0, 0.0, 0.0, k, k, 0.0]);
        let moved = Moved {
            base: Model::Constant(Kind::General, base),
            slopes: None,
            spent: 0.0,
            kernel: 0,
            forms: Forms::default(),
        };
        plain.about(&moved, &cells, &patch.points, &factors).is_some()
    };
    assert!(moved(-0.1) && !moved(-1.5));
}

/// Measured normals are believed on a body that bends, too; those of planes through neighbours are not.
#[test]
fn normals_that_follow_from_the_positions_are_told_from_measured_ones() {
    for seed in 0..10 {
        let (points, normals) = bump(true, seed);
        let contacts = Contacts::from_points(&points);
        let used = |contacts: &Contacts| Recognition::of(contacts, &RecognitionOptions::default()).unwrap().normals;
        assert_eq!(used(&contacts.clone().with_normal_vectors(&normals)), NormalsUse::Believed, "{seed}");
        let estimated = contacts.with_estimated_normals(None).unwrap();
        assert_eq!(used(&estimated), NormalsUse::DerivedFromPositions, "{seed}");
    }
}

/// Between contacts that lie far apart the shape itself bends, which turns both normals alike: half of such bodies lost their normals.
#[test]
fn measured_normals_of_few_contacts_on_a_strong_wave_are_believed() {
    for seed in 0..6 {
        let numbers = Numbers::new(2000 + seed);
        let points = patch(|x, _| 0.4 * (1.2 * x).cos(), 260, 0.002, seed);
        let normal = |(i, [x, ..]): (usize, &Vector)| {
            let [dx, dy] = [0, 1].map(|side| 0.005 * numbers.gaussian(2 * i + side));
            unit([0.48 * (1.2 * x).sin() + dx, dy, 1.0])
        };
        let normals: Vec<Vector> = points.iter().enumerate().map(normal).collect();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let found = Recognition::of(&contacts, &RecognitionOptions::default()).unwrap();
        assert_eq!(found.normals, NormalsUse::Believed, "{seed}");
    }
}

/// A low bump, touched at 400 places with its normals, or with those of a ball of about its size.
fn bump(of_bump: bool, seed: u64) -> (Vec<Vector>, Vec<Vector>) {
    let height = |x: f64, y: f64| 2.5 * (-(x * x + y * y) / 50.0).exp();
    let numbers = Numbers::new(1000 + seed);
    let points = patch(height, 400, 0.02, seed);
    let normals: Vec<Vector> = points
        .iter()
        .enumerate()
        .map(|(i, [x, y, _])| {
            let bend = if of_bump { height(*x, *y) / 25.0 } else { 1.0 / 13.0 };
            let [dx, dy] = [0, 1].map(|side| 0.03 * numbers.gaussian(2 * i + side));
            unit([bend * x + dx, bend * y + dy, 1.0])
        })
        .collect();
    (points, normals)
}

/// A sensor that errs in its positions does not tilt normals that were measured on their own. Each of these normals is too noisy to
/// tell; all together they do.
#[test]
fn normals_together_tell_shape_from_an_error_of_the_sensor() {
    let displaced = |of_bump: bool| {
        let recognised = |seed: u64| {
            let (points, normals) = bump(of_bump, seed);
            let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
            Recognition::of(&contacts, &RecognitionOptions::default()).unwrap()
        };
        // a low bump may pass for an ellipsoid, which is shape, too
        let is_shape = |found: &Recognition| matches!(found.hypothesis, Hypothesis::Displaced | Hypothesis::Quadric);
        (0..10).filter(|seed| is_shape(&recognised(*seed))).count()
    };
    let (of_bump, of_ball) = (displaced(true), displaced(false));
    assert!(of_bump >= 9 && of_ball <= 1, "{of_bump} of 10 and {of_ball} of 10");
}

/// A saddle with a third-degree term departs from two constant curvatures as surfaces do, a saddle with waves as sensors do. What
/// may be either is said; some of these saddles tell by themselves that neighbours share no errors.
#[test]
fn natural_departures_are_shape_and_waves_are_an_error() {
    let saddle = |x: f64, y: f64| (x * x - 0.6 * y * y) / 20.0;
    let as_shape = |found: &Recognition| found.notes.iter().any(|note| matches!(note, Remark::DepartureAsShape { .. }));
    let (mut shape, mut either, mut error) = (0, 0, 0);
    for seed in 0..10 {
        let found = recognised(&patch(|x, y| saddle(x, y) + 0.0015 * x.powi(3), 400, 0.02, seed));
        shape += usize::from(found.hypothesis == Hypothesis::Displaced);
        either += usize::from(as_shape(&found));
        let found = recognised(&patch(|x, y| saddle(x, y) + 0.04 * (1.6 * x).sin() * (1.6 * y).cos(), 400, 0.01, seed));
        error += usize::from(found.hypothesis == Hypothesis::Paraboloid && !as_shape(&found));
    }
    assert!(shape >= 9 && either >= 5 && error >= 9, "{shape}, {either} and {error} of 10");
}

/// A bump is smooth in all its derivatives, and a rounded crease bends abruptly: the evidence tells which spline is the likelier.
#[test]
fn smooth_surfaces_are_told_from_creased_ones() {
    let lead = |height: &dyn Fn(f64, f64) -> f64, seed: u64| {
        let options = RecognitionOptions::default();
        let contacts = Contacts::from_points(&patch(height, 200, 0.01, seed));
        let patch = Patch::new(&Observations::from_contacts(&contacts, &options).unwrap(), &options).unwrap();
        let tuning = &options.tuning;
        let cells = patch.cells(tuning);
        let models = patch.fitted(&cells, tuning);
        let distances = noise::distances_between(&cells);
        let limit = Limit::new(&patch.nearest(), &patch.distances, relief(&cells, &models, tuning), tuning);
        let factors = FactorPair::new(&cells, &distances);
        let plain = Linearised::new(&cells, &patch.points, models, &factors, tuning);
        let at = SearchContext { cells: &cells, contacts: &patch.points, factors: &factors, limit, tuning };
        let (_, nodes) = Evidence::begun(at, &plain, Look::First).finished();
        let best = |smooth: bool| {
            let own = nodes.iter().filter(|n| n.group() == 2 && n.departure.is_smooth() == smooth);
            own.map(|n| n.log_evidence).fold(f64::NEG_INFINITY, f64::max)
        };
        best(true) - best(false)
    };
    for seed in 0..4 {
        let bump = lead(&|x, y| 2.0 * (-(x * x + y * y) / 32.0).exp(), seed);
        // a straight crease would be a profile, which is smooth along itself
        let crease = lead(&|x, y| -0.4 * ((x - 0.1 * y * y).powi(2) + 0.1).sqrt(), seed);
        assert!(bump > 3.0 && crease < -3.0, "{seed}: {bump} and {crease}");
    }
}

/// A sheet in waves is neither a bar nor whatever follows the contacts: S is a half to either side everywhere.
#[test]
fn waves_are_drawn_along_a_line() {
    let found = recognised(&patch(|x, y| (1.2 * (0.8 * x - 0.6 * y)).sin(), 120, 0.01, 12));
    assert_eq!(found.hypothesis, Hypothesis::Extrusion);
    assert!(dot(found.axis.unwrap(), [0.6, 0.8, 0.0]).abs() > 0.999, "{:?}", found.axis);
    let supported: Vec<f64> = found.map.iter().filter(|p| p.supported).filter_map(|p| p.shape_index).collect();
    assert!(supported.len() > 20 && supported.iter().all(|s| (s.abs() - 0.5).abs() < 1e-6), "{supported:?}");
}

/// Whether the radius of a whole bar along z lies in its interval, touched at so many even places round it in twelve rows.
fn holds_rounded_bar(radius: f64, places: u32, decimals: i32) -> bool {
    let unit = 10.0_f64.powi(decimals);
    let rounded = |v: f64| (v * unit).round() / unit;
    let contact = |k: u32| {
        let (s, c) = (std::f64::consts::TAU * f64::from(k % places) / f64::from(places)).sin_cos();
        let place = [radius * c, radius * s, radius * (0.1 + 0.2 * f64::from(k / places))];
        (place.map(rounded), [c, s, 0.0].map(rounded))
    };
    let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..12 * places).map(contact).unzip();
    let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
    let found = Recognition::of(&contacts, &RecognitionOptions::default()).unwrap();
    assert_eq!((found.hypothesis, found.class), (Hypothesis::Cylinder, ShapeClass::Ridge));
    let [lo, hi] = found.radius_interval.unwrap();
    assert!(hi - lo < 2.0 / unit, "{radius} {places} {decimals}: {lo} to {hi}");
    lo < radius && radius < hi
}

/// The twelve rows of every place round a bar hold the same roundings, and so does its mirror image.
#[test]
fn rounded_rows_round_a_body_leave_its_radius_open() {
    let cases = [6.0, 12.5, 20.0].into_iter().flat_map(|r| [13, 16, 20].map(|n| (r, n)));
    let held = cases.flat_map(|(r, n)| [1, 2, 3].map(|d| holds_rounded_bar(r, n, d))).filter(|held| *held).count();
    assert!(held >= 25, "{held} of 27");
}
