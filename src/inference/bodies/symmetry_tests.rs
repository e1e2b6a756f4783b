//! Bodies that were turned or drawn, against what they are.

use super::chart::BodyChart;
use super::coordinates::{DepartureOver, Symmetry};
use super::departure_kernel::DepartureKernel;
use super::evidence::LinearisedBase;
use super::free_surface::free_surface;
use super::inference::{Verdict, infer};
use super::mode::{FalseContacts, Mode};
use super::posterior::{DrawnBase, draws, spread};
use super::sample::BodySample;
use super::search::ModeSearch;
use super::tests::gaussian;
use super::tuning::Tuning;
use crate::primitives::placed::{PartKind, Primitive};
use palpate_geometry::contact::Rounding;
use palpate_numeric::draws::Lcg;
use palpate_numeric::vector::{Vector, along, axes_along, cross, dot, norm, unit};

/// Axes that are none of the coordinates'.
fn tilted() -> [Vector; 3] {
    axes_along(unit([0.3, -0.5, 0.8]))
}

fn placed([x, y, z]: Vector) -> Vector {
    let [a, b, c] = tilted();
    along(along(along([5.0, -2.0, 1.0], x, a), y, b), z, c)
}

/// Radius of a vase at a height, with its first two derivatives.
fn vase(h: f64) -> [f64; 3] {
    let (sin, cos) = (1.3 * h).sin_cos();
    [2.0 + 0.6 * sin, 0.78 * cos, -1.014 * sin]
}

fn touched_vase(count: usize, generator: &mut Lcg) -> BodySample {
    let one = |_| {
        let (sin, cos) = (std::f64::consts::TAU * generator.uniform()).sin_cos();
        let h = 5.0 * generator.uniform() - 2.5;
        let rho = vase(h)[0] + 0.005 * gaussian(generator);
        placed([rho * cos, rho * sin, h])
    };
    BodySample::new(&(0..count).map(one).collect::<Vec<Vector>>(), &[], Rounding::NONE).unwrap()
}

/// A cloud that fills a ball or a box and lies on no surface.
fn filling(count: usize, is_box: bool, generator: &mut Lcg) -> BodySample {
    let one = |_| {
        let draw = |generator: &mut Lcg| if is_box { 2.0 * generator.uniform() - 1.0 } else { gaussian(generator) };
        [draw(generator), draw(generator), draw(generator)]
    };
    BodySample::new(&(0..count).map(one).collect::<Vec<Vector>>(), &[], Rounding::NONE).unwrap()
}

/// An ellipse of half axes 2 and 1.2 drawn along a line, with normals.
fn touched_tube(count: usize, generator: &mut Lcg) -> BodySample {
    let [a, b, _] = tilted();
    let one = |_| {
        let (sin, cos) = (std::f64::consts::TAU * generator.uniform()).sin_cos();
        let h = 4.0 * generator.uniform() - 2.0;
        let normal = unit(along(a.map(|v| v * cos / 2.0), sin / 1.2, b));
        let place = placed([2.0 * cos, 1.2 * sin, h]);
        let off = [0, 1, 2].map(|_| 0.02 * gaussian(generator));
        (along(place, 0.004 * gaussian(generator), normal), unit(along(normal, 1.0, off)))
    };
    let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..count).map(one).unzip();
    BodySample::new(&points, &normals, Rounding::NONE).unwrap()
}

#[test]
fn a_vase_is_turned_about_its_axis_and_bends_as_it_does() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(81);
    let sample = touched_vase(150, &mut generator);
    let Verdict::Free { found: posterior, .. } = infer(&sample, &tuning) else { panic!("no free surface") };
    assert_eq!(posterior.symmetry(), Symmetry::Turned);
    let likeliest = posterior.likeliest(posterior.kind()).unwrap();
    assert!(norm(cross(likeliest.axes[2], tilted()[2])) < 0.01, "{:?}", likeliest.axes);
    let drawn = draws(&posterior, &tuning, 3);
    let scale = sample.frame.scale;
    for (k, h) in [-1.5, -0.7, 0.0, 0.8, 1.6].into_iter().enumerate() {
        let [rho, slope, bend] = vase(h);
        let steep = slope.hypot(1.0);
        let truth = [-1.0 / (rho * steep), bend / steep.powi(3)];
        let place = sample.frame.to_patch(placed([rho * (k as f64).cos(), rho * (k as f64).sin(), h]));
        let mean = |i: usize| drawn.iter().map(|d| d.curvatures(place)[i]).sum::<f64>() / drawn.len() as f64 / scale;
        let found = [mean(0), mean(1)];
        let (most, least) = (truth[0].max(truth[1]), truth[0].min(truth[1]));
        assert!((found[0] - most).abs() < 0.05 && (found[1] - least).abs() < 0.05, "{h}: {found:?} {truth:?}");
    }
}

/// Curvatures round and along vases of 60 contacts lie in their 95 % intervals nearly as often as these say.
#[test]
fn intervals_of_curvature_hold_along_a_vase() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(85);
    let (mut held, mut all) = (0, 0);
    for seed in 0..6 {
        let sample = touched_vase(60, &mut generator);
        let Verdict::Free { found: posterior, .. } = infer(&sample, &tuning) else { panic!("{seed}: no free surface") };
        let drawn = draws(&posterior, &tuning, seed);
        for (k, h) in [-1.9, -1.3, -0.6, 0.0, 0.7, 1.4, 2.0].into_iter().enumerate() {
            let [rho, slope, bend] = vase(h);
            let steep = slope.hypot(1.0);
            let (round, lengthwise) = (-1.0 / (rho * steep), bend / steep.powi(3));
            let place = sample.frame.to_patch(placed([rho * (k as f64).cos(), rho * (k as f64).sin(), h]));
            let bent: Vec<[f64; 2]> = drawn.iter().map(|d| d.curvatures(place)).collect();
            for (i, truth) in [round.max(lengthwise), round.min(lengthwise)].into_iter().enumerate() {
                let values: Vec<(f64, f64)> =
                    bent.iter().zip(&drawn).map(|(c, d)| (c[i] / sample.frame.scale, d.share)).collect();
                let [lo, hi] = spread(&values, 0.95).unwrap().interval;
                held += usize::from((lo..=hi).contains(&truth));
                all += 1;
            }
        }
    }
    assert!(held * 100 >= 85 * all, "{held} of {all}");
}

#[test]
fn a_tube_of_any_section_does_not_bend_along_itself() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(82);
    let sample = touched_tube(120, &mut generator);
    let Verdict::Free { found: posterior, .. } = infer(&sample, &tuning) else { panic!("no free surface") };
    assert_eq!(posterior.symmetry(), Symmetry::Extruded);
    let scale = sample.frame.scale;
    for drawn in draws(&posterior, &tuning, 4).iter().step_by(40) {
        let turn = drawn.share * 400.0;
        let place = sample.frame.to_patch(placed([2.0 * turn.cos(), 1.2 * turn.sin(), 0.5]));
        let [k1, k2] = drawn.curvatures(place).map(|k| k / scale);
        let speed = (4.0 * turn.sin().powi(2) + 1.44 * turn.cos().powi(2)).sqrt();
        assert!(k1.abs() < 1e-9, "{k1}");
        assert!((k2 + 2.4 / speed.powi(3)).abs() < 0.1, "{k2}");
    }
}

/// Gradient and Hessian of surfaces that depart in every way against differences.
#[test]
fn derivatives_of_a_level_set_are_those_of_its_values() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(83);
    let sample = touched_tube(60, &mut generator);
    let origin = sample.frame.to_patch(placed([0.0; 3]));
    let base = |kind, sizes| Primitive { kind, origin, axes: tilted(), sizes, side: 1.0 };
    let of = |over, base: Primitive| {
        let (weights, sd) = (vec![1.0; sample.len()], [0.01, 0.02]);
        let mode = Mode { primitive: base, weights, sd, likelihood: 0.0, strays: FalseContacts::None };
        let surface = DrawnBase::of_primitive(base);
        let linearised = LinearisedBase::of_level_set(
            &surface,
            over,
            &mode,
            &sample,
            &[DepartureKernel::gaussian(0.4, 0.2)],
            &tuning,
        );
        let nodes = linearised.departed_nodes_near(0, &[8.0], &tuning);
        DrawnBase::likeliest(nodes[0].likeliest(&base), &nodes[0])
    };
    let surfaces = [
        of(DepartureOver::Space, base(PartKind::Sphere, [0.9, 0.0, 0.0])),
        of(DepartureOver::Turned, base(PartKind::Cylinder, [0.7, 0.0, 0.0])),
        of(DepartureOver::Turned, base(PartKind::Ellipsoid, [0.8, 0.8, 1.1])),
        of(DepartureOver::Extruded, base(PartKind::Cylinder, [0.7, 0.0, 0.0])),
    ];
    let step = 1e-5;
    for (number, surface) in surfaces.iter().enumerate() {
        for place in sample.points.iter().step_by(7) {
            let jet = surface.jet(*place);
            for k in 0..3 {
                let aside = |by: f64| surface.jet([0, 1, 2].map(|i| place[i] + if i == k { by } else { 0.0 }));
                let (more, less) = (aside(step), aside(-step));
                let slope = (more.value - less.value) / (2.0 * step);
                assert!((slope - jet.gradient[k]).abs() < 1e-6 * (1.0 + slope.abs()), "{number} {k}: {slope}");
                for i in 0..3 {
                    let bend = (more.gradient[i] - less.gradient[i]) / (2.0 * step);
                    assert!((bend - jet.hessian[i][k]).abs() < 1e-5 * (1.0 + bend.abs()), "{number} {k}: {bend}");
                }
            }
        }
    }
}

/// A ring of an elliptical tube: about the round one its section departs all round alike, and it bends as that of the ellipse does.
#[test]
fn a_ring_whose_section_departs_bends_as_that_section_does() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(85);
    let [across, upwards] = [0.4, 0.44];
    let at = |turn: f64, tube: f64| {
        let rho = 1.0 + across * tube.cos();
        placed([rho * turn.cos(), rho * turn.sin(), upwards * tube.sin()])
    };
    let touched = |_| {
        let [turn, tube] = [0, 1].map(|_| std::f64::consts::TAU * generator.uniform());
        at(turn, tube)
    };
    let contacts: Vec<Vector> = (0..300).map(touched).collect();
    let sample = BodySample::new(&contacts, &[], Rounding::NONE).unwrap();
    let scale = sample.frame.scale;
    let origin = sample.frame.to_patch(placed([0.0; 3]));
    let sizes = [1.0 / scale, 0.42 / scale, 0.0];
    let ring = Primitive { kind: PartKind::Torus, origin, axes: tilted(), sizes, side: 1.0 };
    let (weights, sd) = (vec![1.0; sample.len()], [0.01, 0.02]);
    let mode = Mode { primitive: ring, weights, sd, likelihood: 0.0, strays: FalseContacts::None };
    let linearised = LinearisedBase::new(&mode, &sample, &tuning).departing(&tuning);
    let nodes = linearised.nodes(0, &tuning);
    let best = nodes.iter().max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence)).unwrap();
    assert!(best.is_of_section(), "{:?} {:?}", best.departure, best.reading);
    let surface = DrawnBase::likeliest(best.likeliest(&ring), best);
    for tube in [0.4_f64, 1.3, 2.2, 3.4, 5.1] {
        let (sin, cos) = tube.sin_cos();
        let speed = (across * sin).hypot(upwards * cos);
        let along = -across * upwards / speed.powi(3);
        let round = -upwards * cos / speed / (1.0 + across * cos);
        let [k1, k2] = surface.curvatures(sample.frame.to_patch(at(0.7, tube))).map(|k| k / scale);
        assert!((k1 - along.max(round)).abs() < 0.05 * along.abs(), "{tube}: {k1} for {}", along.max(round));
        assert!((k2 - along.min(round)).abs() < 0.05 * along.abs(), "{tube}: {k2} for {}", along.min(round));
    }
}

/// The inner side of a ring, where angles of the tube pass half a turn: its map lies where contacts do, and nowhere else.
#[test]
fn a_map_of_the_inside_of_a_ring_lies_where_it_was_touched() {
    let mut generator = Lcg::new(84);
    let torus = Primitive {
        kind: PartKind::Torus,
        origin: [0.0; 3],
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        sizes: [1.0, 0.4, 0.0],
        side: 1.0,
    };
    let one = |_| {
        let (turn, tube) = (1.2 * generator.uniform(), std::f64::consts::PI + 1.4 * (generator.uniform() - 0.5));
        let rho = 1.0 + 0.4 * tube.cos();
        [rho * turn.cos(), rho * turn.sin(), 0.4 * tube.sin()]
    };
    let contacts: Vec<Vector> = (0..200).map(one).collect();
    let tuning = Tuning::default();
    let likeliest = DrawnBase::of_primitive(torus);
    let frame = palpate_geometry::contact::Frame::IDENTITY;
    let chart = BodyChart::new(frame, likeliest, &contacts, Vec::new(), &tuning);
    let [lo, hi] = chart.v;
    assert!(hi - lo < 0.4 * 1.5, "{lo} {hi}");
    for k in 0..=10 {
        let v = lo + (hi - lo) * f64::from(k) / 10.0;
        let (place, _) = chart.at(0.5 * (chart.u[0] + chart.u[1]), v);
        assert!(place[0].hypot(place[1]) < 1.0, "{place:?}");
        let [u, again] = chart.chart_of(place);
        assert!((again - v).abs() < 1e-9 && chart.supported_at(u, again), "{v} {again}");
    }
    // half a tube farther no contact is near
    assert!(!chart.supported_at(0.0, hi + 0.5));
}

/// A body with a neck, closed at both ends: half axis, radius of each of two rods with round ends.
const RODS: [([f64; 2], f64); 2] = [([-1.4, 0.6], 1.4), ([0.6, 3.0], 0.6)];

/// Distance from the outside of a rod along the third axis, and the direction away from it.
fn beside_rod(p: Vector, ([lo, hi], radius): ([f64; 2], f64)) -> (f64, Vector) {
    let from = [p[0], p[1], p[2] - p[2].clamp(lo, hi)];
    (norm(from) - radius, unit(from))
}

/// Steps to the surface from the base of its map may end inside the body, where F is 0 for no contact: no such place is said to be known.
#[test]
fn a_map_of_a_bottle_faces_outwards() {
    for seed in [89, 97] {
        let (known, inwards) = places_of_a_bottle(seed);
        assert!(known > 150 && inwards == 0, "{seed}: {inwards} of {known}");
    }
}

/// Places of the map that are said to be known, and those of them that face inwards.
fn places_of_a_bottle(seed: u64) -> (usize, usize) {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(seed);
    let (mut points, mut normals) = (Vec::new(), Vec::new());
    while points.len() < 150 {
        let ends = RODS[usize::from(generator.uniform() < 0.3)];
        let ([lo, hi], radius) = ends;
        let normal = unit([0, 1, 2].map(|_| gaussian(&mut generator)));
        let h = lo + (hi - lo) * generator.uniform();
        let middle = if normal[2].abs() < 0.6 {
            h
        } else if normal[2] > 0.0 {
            hi
        } else {
            lo
        };
        let rim = along([0.0, 0.0, middle], radius + 0.005 * gaussian(&mut generator), normal);
        let side = unit([normal[0], normal[1], 0.0]);
        let (place, normal) =
            if normal[2].abs() < 0.6 { (along([0.0, 0.0, h], radius, side), side) } else { (rim, normal) };
        if RODS.iter().all(|rod| beside_rod(place, *rod).0 > -0.05) {
            points.push(placed(place));
            let off = [0, 1, 2].map(|_| 0.03 * gaussian(&mut generator));
            normals.push(unit(
                tilted().iter().zip(along(normal, 1.0, off)).fold([0.0; 3], |n, (axis, by)| along(n, by, *axis)),
            ));
        }
    }
    let sample = BodySample::new(&points, &normals, Rounding::NONE).unwrap();
    let posterior = free_surface(&sample, &ModeSearch::new(&tuning)).unwrap();
    let kind = posterior.kind();
    let surface = DrawnBase::likeliest(posterior.likeliest(kind).unwrap(), posterior.best_of(kind).unwrap());
    let members: Vec<Vector> = posterior.members_of(kind).iter().map(|i| sample.points[*i]).collect();
    let chart = BodyChart::new(sample.frame, surface, &members, Vec::new(), &tuning);
    let (mut known, mut inwards) = (0, 0);
    for cell in 0..24 * 24 {
        let [u, v] =
            [(chart.u, cell % 24), (chart.v, cell / 24)].map(|([lo, hi], k)| lo + (hi - lo) * f64::from(k) / 23.0);
        if chart.supported_at(u, v) {
            let (place, normal) = chart.at(u, v);
            let from = [0, 1, 2].map(|k| place[k] - placed([0.0; 3])[k]);
            let own = tilted().map(|axis| dot(axis, from));
            let nearest = RODS.map(|rod| beside_rod(own, rod)).into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            let outwards = tilted().iter().zip(nearest.1).map(|(axis, by)| by * dot(*axis, normal)).sum::<f64>();
            known += 1;
            inwards += usize::from(outwards < 0.0);
        }
    }
    (known, inwards)
}

#[test]
fn a_cloud_that_fills_a_volume_is_no_surface() {
    let tuning = Tuning::default();
    for seed in 1..=12 {
        let mut generator = Lcg::new(300 + seed);
        let sample = filling(200, seed % 2 == 0, &mut generator);
        assert!(free_surface(&sample, &ModeSearch::new(&tuning)).is_none(), "{seed}");
    }
}
