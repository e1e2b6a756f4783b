//! What effects do to each other: nothing; and what holds for each of them beside its law.
use palpate::scene::{Effect, Simulator, Surface, Sweep, World};
use palpate::{Contacts, Orientation};
use palpate_world::scene::{ContactBatch, linspace};

use crate::scene_effects::{LAWS, assert_close, minus};

/// How much too large the tips of [`one_of_each`] are believed to be.
const TIP_RADIUS_ERROR: f64 = 0.05;

/// One of each, of ordinary strength.
fn one_of_each() -> Vec<Effect> {
    vec![
        Effect::tip_radius_error(TIP_RADIUS_ERROR),
        Effect::indentation(50.0, 0.5, 0.2),
        Effect::friction(0.2, 0.02),
        Effect::force_noise(0.02).with_force_bias([0.01, 0.0, -0.01]).with_force_drift(0.005).with_force_steps(0.01),
        Effect::position_noise([0.02, 0.03, 0.04]),
        Effect::normal_noise(2.0),
        Effect::slope_gain(0.3),
        Effect::encoder(0.01, 0.02),
        Effect::misalignment([1.0, -2.0, 0.5], [0.1, 0.0, -0.1]),
        Effect::latency(0.05, 0.02),
        Effect::finger_noise([0.01; 3], 1.0, 3.0),
        Effect::slip(0.2, 0.5),
        Effect::dropout(0.2),
        Effect::row_noise(0.02, 0.05),
    ]
}

fn patch(effects: Vec<Effect>) -> World {
    let cylinder = Surface::cylinder(6.6).turned(90.0);
    let sweep = Sweep::new(vec![-4.0, 0.0, 4.0], linspace(-4.0, 4.0, 6)).with_tip_radius(0.5).with_repeats(2);
    World { effects, ..World::new(cylinder, sweep) }
}

#[test]
fn every_effect_has_a_law_test_and_an_explain_line_in_the_physical_order() {
    assert_eq!(LAWS, Effect::ORDER);
    let names: Vec<&str> = one_of_each().iter().map(Effect::name).collect();
    assert_eq!(names, Effect::ORDER);
    // whatever the order they are given in
    let mut reversed = one_of_each();
    reversed.reverse();
    let simulator = patch(reversed).compile().unwrap();
    assert_eq!(simulator.stage_names(), Effect::ORDER);
    let text = palpate_world::scene::explain::table(&simulator, &[]);
    for line in simulator.explain() {
        assert!(!line.changes.is_empty());
        assert!(text.lines().any(|row| row.starts_with(line.name)), "no line on {} in\n{text}", line.name);
    }
    let backwards = simulator.simulate(3, 4);
    assert_eq!(patch(one_of_each()).compile().unwrap().simulate(3, 4), backwards);
}

#[test]
fn adding_an_effect_leaves_every_other_effects_draws_alone() {
    const LANES: usize = 4;
    let clean = |simulator: &Simulator| {
        let mut block = ContactBatch::default();
        simulator.simulate_batch(9, 5, LANES, &mut block);
        block
    };
    let untouched = clean(&patch(Vec::new()).compile().unwrap());
    let alone: Vec<ContactBatch> = one_of_each()
        .into_iter()
        .map(|effect| {
            let mut block = untouched.clone();
            patch(vec![effect]).compile().unwrap().run_stage(0, 9, &mut block);
            block
        })
        .collect();
    let effects = one_of_each();
    let mut pairs = 0;
    for (i, one) in effects.iter().enumerate() {
        for (j, other) in effects.iter().enumerate().filter(|(j, _)| *j != i) {
            let simulator = patch(vec![one.clone(), other.clone()]).compile().unwrap();
            let stage = simulator.stage_names().iter().position(|name| *name == one.name()).unwrap();
            let mut block = untouched.clone();
            simulator.run_stage(stage, 9, &mut block);
            assert_eq!(block.normals, alone[i].normals, "normals of {} beside {}", one.name(), other.name());
            assert_eq!(block.lost, alone[i].lost, "losses of {} beside {}", one.name(), other.name());
            if other.name() == "tip_radius_error" {
                // the same draws, swung with the radius that the robot now believes in
                for entry in 0..block.points.len() {
                    let tilt = minus(block.normals[entry], untouched.normals[entry]);
                    let swings = matches!(one.name(), "friction" | "force_noise" | "encoder");
                    let more = if swings { TIP_RADIUS_ERROR } else { 0.0 };
                    let expected = minus(alone[i].points[entry], tilt.map(|d| more * d));
                    assert_close(one.name(), block.points[entry], expected, 1e-13);
                }
            } else {
                assert_eq!(block.points, alone[i].points, "points of {} beside {}", one.name(), other.name());
            }
            pairs += 1;
            assert!(j < effects.len());
        }
    }
    assert_eq!(pairs, 14 * 13);
}

fn nearly_nothing(strength: f64) -> Vec<Effect> {
    let s = strength;
    vec![
        Effect::tip_radius_error(s),
        // Hertz's depth grows with F^(2/3): a depth of s, not a force of s
        Effect::indentation(1.0, s * s.sqrt(), 0.0),
        Effect::friction(s, s),
        Effect::force_noise(s).with_force_bias([s; 3]).with_force_drift(s).with_force_steps(s),
        Effect::position_noise([s; 3]),
        Effect::normal_noise(s),
        Effect::slope_gain(s),
        Effect::encoder(s, s),
        Effect::misalignment([s; 3], [s; 3]),
        Effect::latency(s, s),
        Effect::finger_noise([s; 3], s, 1.0),
        Effect::slip(0.5, s),
        Effect::dropout(s),
        Effect::row_noise(s, s),
    ]
}

#[test]
fn zero_is_absence_and_almost_zero_is_almost_absence() {
    let clean = patch(Vec::new()).compile().unwrap().simulate(1, 1).0;
    for effect in nearly_nothing(0.0) {
        let simulator = patch(vec![effect.clone()]).compile().unwrap();
        assert!(simulator.stage_names().is_empty(), "{} of strength zero is compiled in", effect.name());
    }
    for effect in nearly_nothing(1e-12) {
        let simulator = patch(vec![effect.clone()]).compile().unwrap();
        assert_eq!(simulator.stage_names(), [effect.name()]);
        let moved = largest_difference(&simulator.simulate(1, 1).0, &clean);
        assert!(moved <= 1e-10, "{} of strength 1e-12 moves by {moved:e}", effect.name());
    }
}

fn largest_difference(a: &Contacts, b: &Contacts) -> f64 {
    let (Orientation::Normals { nx, ny, nz }, Orientation::Normals { nx: mx, ny: my, nz: mz }) =
        (&a.orientation, &b.orientation)
    else {
        panic!("contacts without normals")
    };
    assert_eq!(a.len(), b.len());
    [(&a.x, &b.x), (&a.y, &b.y), (&a.z, &b.z), (nx, mx), (ny, my), (nz, mz)]
        .into_iter()
        .flat_map(|(one, other)| one.iter().zip(other).map(|(p, q)| (p - q).abs()))
        .fold(0.0, f64::max)
}

#[test]
fn one_replicate_is_the_same_as_its_lane_in_any_block() {
    let simulator = patch(one_of_each()).compile().unwrap();
    let mut block = ContactBatch::default();
    simulator.simulate_batch(11, 100, 37, &mut block);
    for lane in [0, 1, 17, 36] {
        assert_eq!(simulator.contacts_of(&block, lane), simulator.simulate(11, 100 + lane as u64));
    }
}

#[test]
fn effects_that_keep_the_sites_say_so_and_do() {
    for effect in one_of_each().into_iter().chain([
        Effect::position_noise([0.0, 0.0, 0.1]),
        Effect::finger_noise([0.0, 0.0, 0.1], 3.0, 2.0),
        Effect::misalignment([0.0; 3], [0.0, 0.0, 0.2]),
    ]) {
        for tip_radius in [0.0, 0.5] {
            let mut world = patch(vec![effect.clone()]);
            world.sweeps[0].tip_radius = tip_radius;
            let Ok(simulator) = world.compile() else { continue };
            let clean = simulator.noise_free();
            let (contacts, _) = simulator.simulate(1, 1);
            let kept = contacts.x == clean.x && contacts.y == clean.y;
            // a noisy quantised force may round to nothing and lose its contact, though it rarely does
            let may_lose = effect.name() == "force_noise";
            assert!(simulator.keeps_sites() == kept || may_lose && kept, "{} with tip {tip_radius}", effect.name());
        }
    }
}
