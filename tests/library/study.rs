//! Studies through the library: the paths to S and R agree, splits and threads change no bit, stopping and shares hold.

use palpate::fit::{FitOptions, NormalSigma, Objective, SlopeWeights};
use palpate::scene::{Effect, NoiseLaw, Simulator, Surface, Sweep, World};
use palpate_numeric::bspline::linspace;
use palpate_studies::montecarlo::{Engine, Path, Quantity, Stopped, Store, Study, StudyOptions, Tolerance};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn world() -> World {
    let surface = Surface::cylinder(6.6).turned(30.0);
    World::new(surface, Sweep::new(vec![-4.0, 0.0, 4.0], linspace(-4.0, 4.0, 9)))
}

fn slopes(degree: usize, grid: usize) -> FitOptions {
    FitOptions::default()
        .with_degree(degree)
        .with_grid(grid, grid)
        .with_objective(Objective::Slopes(SlopeWeights::Tangent))
}

fn engine(simulator: Simulator, options: &FitOptions, only: Option<Path>) -> Engine {
    Engine::new(simulator, options, &[], only).unwrap()
}

/// Every path that can be had for a scene, against whole fits, replicate by replicate.
#[test]
fn the_paths_agree_where_they_overlap() {
    let still = world().with(Effect::row_noise(0.02, 0.05));
    let mixed = world()
        .with(Effect::position_noise([0.0, 0.0, 0.02]))
        .with(Effect::normal_noise(2.0))
        .with(Effect::finger_noise([0.0, 0.0, 0.01], 1.0, 2.0));
    // sites leave the domain that stands still
    let moving = world().with(Effect::position_noise([0.1; 3])).with(Effect::normal_noise(2.0));
    let losing = world().with(Effect::dropout(0.1)).with(Effect::row_noise(0.02, 0.05));
    for (world, path) in
        [(&still, Path::FixedSites), (&mixed, Path::FixedSites), (&moving, Path::Refit), (&losing, Path::Refit)]
    {
        for degree in [2, 3, 4, 1] {
            let options = slopes(degree, 4);
            let own = engine(world.compile().unwrap(), &options, None);
            assert_eq!(own.path(), path, "{}", own.why());
            let whole = engine(world.compile().unwrap(), &options, Some(Path::Whole));
            let (found, expected) = (own.values(3, 10, 40), whole.values(3, 10, 40));
            assert!(expected.failed.is_empty(), "{:?}", expected.failed);
            for (found, expected) in found.columns.iter().zip(&expected.columns) {
                for (a, b) in found.iter().zip(expected) {
                    assert!((a - b).abs() < 1e-10, "{path} degree {degree}: {a} {b}");
                }
            }
            if path == Path::FixedSites && degree < 4 {
                let refit = engine(world.compile().unwrap(), &options, Some(Path::Refit)).values(3, 10, 40);
                assert!(refit.columns[0].iter().zip(&found.columns[0]).all(|(a, b)| (a - b).abs() < 1e-10));
            }
        }
    }
}

#[test]
fn linearised_normal_rows_are_named_and_close_at_small_noise() {
    let world = world().with(Effect::position_noise([0.0, 0.0, 1e-4])).with(Effect::normal_noise(0.01));
    let objective = Objective::Normals(NormalSigma::Known { z: 1e-4, normal_deg: 0.01 });
    let options = slopes(3, 4).with_objective(objective);
    let own = engine(world.compile().unwrap(), &options, None);
    assert_eq!(own.path(), Path::Linearised);
    assert!(own.why().contains("linearised at the nominal surface"));
    let whole = engine(world.compile().unwrap(), &options, Some(Path::Whole));
    let (found, expected) = (own.values(3, 0, 20).columns, whole.values(3, 0, 20).columns);
    for q in 0..2 {
        let spread = expected[q].iter().map(|v| (v - expected[q][0]).abs()).fold(0.0, f64::max);
        assert!(found[q].iter().zip(&expected[q]).all(|(a, b)| (a - b).abs() < 0.02 * spread), "{q}: {spread}");
    }
}

#[test]
fn any_split_on_any_number_of_threads_gives_the_same_bits() {
    let options = slopes(2, 4);
    for world in [
        world().with(Effect::row_noise(0.02, 0.05)),
        world().with(Effect::position_noise([0.05; 3])).with_law("position_noise", NoiseLaw::StudentT { dof: 4.0 }),
    ] {
        let engine = engine(world.compile().unwrap(), &options, None);
        let whole = engine.values(5, 0, 300).columns;
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        for (first, count) in [(0, 300), (31, 2), (64, 32), (33, 200), (299, 1)] {
            let part = one.install(|| engine.values(5, first as u64, count)).columns;
            for (part, whole) in part.iter().zip(&whole) {
                assert_eq!(part, &whole[first..first + count]);
            }
        }
    }
}

#[test]
fn parts_merge_to_the_bits_of_one_run() {
    for most in [20_000, 1 << 23] {
        let options = StudyOptions { replicates: most, replicates_given: true, ..StudyOptions::default() };
        let simulator = || world().with(Effect::row_noise(0.02, 0.05)).compile().unwrap();
        let study = Study::new(simulator(), &slopes(2, 4), options, 1).unwrap();
        let run = |from, to| study.run(study.start(from), to, &mut |_| true).unwrap().0;
        let whole = run(0, 20_000);
        assert_eq!(matches!(whole.tallies[0].store, Store::Values(_)), most == 20_000);
        let mut parts = run(0, 7);
        for (from, to) in [(7, 4100), (4100, 4101), (4101, 20_000)] {
            parts.merge(&run(from, to)).unwrap();
        }
        assert_eq!(study.result(&parts, 0), study.result(&whole, 0));
    }
}

/// Shares of two effects sum to one, lie between the first-order and the total ones, repeat to the bit, and off means 0.
#[test]
fn shares_add_up_and_repeat() {
    let world = world()
        .with(Effect::friction(0.1, 0.0))
        .with(Effect::position_noise([0.01; 3]))
        .with(Effect::normal_noise(2.0));
    let study = Study::new(world.compile().unwrap(), &slopes(2, 4), StudyOptions::default(), 1).unwrap();
    let state = study.run(study.start(0), 2000, &mut |_| true).unwrap().0;
    let result = study.result(&state, 2000);
    let shares = result.attribution.clone().unwrap();
    assert_eq!(shares.effects.len(), 3);
    assert_eq!(shares.effects[0].first[0].share, Some(0.0));
    for q in 0..2 {
        let sum = shares.sum[q];
        let interval = sum.interval.unwrap();
        assert!(interval.lo <= 1.0 && interval.hi >= 1.0, "{q}: {sum:?}");
        for effect in &shares.effects {
            let (first, total) = (effect.first[q].share.unwrap(), effect.total[q].share.unwrap());
            assert!((0.0..=1.0).contains(&first) && total > first - 0.1, "{effect:?}");
            let share = effect.share[q].share.unwrap();
            assert!(share >= first.min(total) && share <= first.max(total), "{effect:?}");
        }
    }
    assert_eq!(study.result(&state, 2000), result);
}

/// Small noise: the linear law's sds are those of the Monte Carlo, and it is called valid.
#[test]
fn the_linear_law_holds_at_small_noise_and_not_on_a_ball() {
    let small = [Effect::position_noise([1e-4; 3]), Effect::normal_noise(0.02)];
    let on = |surface: Surface| {
        let sweep = Sweep::new(vec![-4.0, 0.0, 4.0], linspace(-4.0, 4.0, 9));
        let mut world = World::new(surface.turned(20.0), sweep);
        world.effects = small.to_vec();
        let options = StudyOptions { replicates: 40_000, ..StudyOptions::default() };
        let study = Study::new(world.compile().unwrap(), &slopes(4, 4), options, 1).unwrap();
        let state = study.run(study.start(0), 40_000, &mut |_| true).unwrap().0;
        study.result(&state, 0)
    };
    let saddle = on(Surface::saddle([12.0, 12.0]));
    for q in 0..2 {
        let ratio = saddle.linear.sd[q].unwrap() / saddle.quantities[q].sd.unwrap();
        assert!((ratio - 1.0).abs() < 0.012, "{q}: {ratio}");
    }
    assert!(saddle.linear.valid(), "{}", saddle.linear.why);
    let ball = on(Surface::sphere(10.0));
    assert!(!ball.linear.valid_parts[0], "{}", ball.linear.why);
    let plane = on(Surface::plane());
    assert!(!plane.linear.valid(), "{}", plane.linear.why);
}

#[test]
fn quantities_on_request_are_those_of_the_fit() {
    let world = world().with(Effect::row_noise(0.002, 0.005));
    let asked: Vec<Quantity> =
        ["k1", "k2", "radius", "direction", "S@1,2", "R@0,0", "k2@-1,3"].iter().map(|q| q.parse().unwrap()).collect();
    let of = |path| Engine::new(world.compile().unwrap(), &slopes(2, 4), &asked, path).unwrap().values(1, 0, 5).columns;
    let (fixed, whole) = (of(None), of(Some(Path::Whole)));
    assert_eq!(fixed.len(), 9);
    for (q, (fixed, whole)) in fixed.iter().zip(&whole).enumerate() {
        for (a, b) in fixed.iter().zip(whole) {
            // directions are axes: 0 and 180 are one
            let gap = if q == 5 { (a - b + 90.0).rem_euclid(180.0) - 90.0 } else { a - b };
            assert!(gap.abs() < 1e-8, "{q}: {a} {b}");
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let study = |options: StudyOptions| {
        let simulator = world().with(Effect::row_noise(0.02, 0.0)).compile().unwrap();
        Study::new(simulator, &slopes(2, 4), options, 1).map(|_| ()).unwrap_err().to_string()
    };
    let none = StudyOptions::default();
    assert!(study(StudyOptions { replicates: 0, ..none.clone() }).contains("replicates is 0"));
    for level in [0.0, 1.0, f64::NAN, -0.5] {
        assert!(study(StudyOptions { level, ..none.clone() }).contains("level is"), "{level}");
    }
    assert!(study(StudyOptions { quantiles: vec![1.5], ..none.clone() }).contains("quantile is 1.5"));
    let moving = world().with(Effect::position_noise([0.1; 3])).compile().unwrap();
    let forced = Engine::new(moving, &slopes(2, 4), &[], Some(Path::FixedSites)).unwrap_err().to_string();
    assert!(forced.contains("position_noise moves sites"), "{forced}");
}

/// A thousand random cuts of one run into parts, each joined to the same bits.
#[test]
fn a_thousand_random_splits_merge_to_the_same_bits() {
    const REPLICATES: u64 = 600;
    let options = StudyOptions { replicates: REPLICATES, replicates_given: true, ..StudyOptions::default() };
    let simulator = world().with(Effect::row_noise(0.02, 0.05)).compile().unwrap();
    let study = Study::new(simulator, &slopes(2, 4), options, 1).unwrap();
    let run = |from, to| study.run(study.start(from), to, &mut |_| true).unwrap().0;
    let whole = run(0, REPLICATES);
    let of = |state: &palpate::montecarlo::StudyState| {
        let tallies = state.tallies.iter();
        let numbers: Vec<_> =
            tallies.map(|t| (t.mean(), t.sd(), t.ranked().symmetric(0.95), t.ranked().shortest(0.95))).collect();
        (numbers, state.classes)
    };
    let expected = of(&whole);
    let mut random = ChaCha8Rng::seed_from_u64(1997);
    for _ in 0..1000 {
        let a = random.random_range(1..REPLICATES - 1);
        let b = random.random_range(a + 1..REPLICATES);
        let mut parts = run(0, a);
        parts.merge(&run(a, b)).unwrap();
        parts.merge(&run(b, REPLICATES)).unwrap();
        assert_eq!(of(&parts), expected, "0:{a}:{b}:{REPLICATES}");
    }
}

/// Stopped after every chunk and gone on with, a study to a tolerance ends with the bits of one that was left alone; its
/// replicates count twice or more by the control, and it agrees with many.
#[test]
fn a_tolerance_with_the_control_goes_on_to_the_same_bits() {
    let make = |options: StudyOptions| {
        let simulator = world().with(Effect::row_noise(0.02, 0.05)).compile().unwrap();
        Study::new(simulator, &slopes(2, 4), options, 5).unwrap()
    };
    let tolerance = Some(Tolerance::Stein(2));
    let study = make(StudyOptions { tolerance, ..StudyOptions::default() });
    let (whole, stopped) = study.run(study.start(0), 1 << 30, &mut |_| true).unwrap();
    assert_eq!(stopped, Stopped::Tolerance);
    let mut cut = study.start(0);
    let mut pauses = 0;
    loop {
        let (next, stopped) = study.run(cut, 1 << 30, &mut |_| false).unwrap();
        cut = next;
        pauses += 1;
        if stopped == Stopped::Tolerance {
            break;
        }
    }
    assert!(pauses > 10, "{pauses} pauses");
    assert_eq!((cut.to, &cut.batches, &cut.control), (whole.to, &whole.batches, &whole.control));
    assert_eq!(cut.tallies, whole.tallies);
    assert_eq!(study.result(&cut, 0), study.result(&whole, 0));
    let plain = make(StudyOptions { replicates: 1 << 20, ..StudyOptions::default() });
    let (many, _) = plain.run(plain.start(0), 1 << 20, &mut |_| true).unwrap();
    let (own, other) = (study.result(&whole, 0), plain.result(&many, 0));
    for (a, b) in own.quantities.iter().zip(&other.quantities) {
        // each replicate counts twice or more
        assert!(a.control.is_some_and(|beta| beta.iter().all(|beta| beta * beta > 0.5)), "{:?}", a.control);
        let (u, n) = (b.sd.unwrap(), 2.0_f64.powi(20));
        assert!((a.mean.unwrap() - b.mean.unwrap()).abs() < 5.0 * u / n.sqrt());
        assert!((a.sd.unwrap() / u - 1.0).abs() < 5.0 / n.sqrt());
    }
}
