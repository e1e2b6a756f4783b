//! Bodies of no simple kind under touches that err by little: whole ones, and strips of one that bend farther than a patch may.

use palpate::Contacts;
use palpate::recognition::{Hypothesis, Recognition, RecognitionOptions};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// Sd of a place along each axis, and of a normal in each tangent direction.
const OFF: f64 = 3e-4;
const TILT: f64 = 5e-3;

/// A bent horn of this bend and radius of its tube in the middle, at shares of the way round and along it.
#[derive(Clone, Copy)]
struct Horn {
    bend: f64,
    tube: f64,
}

impl Horn {
    fn place(self, [round, along]: [f64; 2]) -> [f64; 3] {
        let (turned, by) = (1.1 * (2.0 * along - 1.0), 0.93 * (2.0 * along - 1.0));
        let tube = self.tube * (1.0 - by * by).sqrt();
        let (sin, cos) = round.sin_cos();
        let from_middle = self.bend + tube * cos;
        [from_middle * turned.cos(), from_middle * turned.sin(), 1.2 * tube * sin]
    }

    fn outwards(self, at: [f64; 2]) -> [f64; 3] {
        let step = |k: usize| {
            let moved = |by: f64| {
                let mut there = at;
                there[k] += by;
                self.place(there)
            };
            let (a, b) = (moved(1e-5), moved(-1e-5));
            [0, 1, 2].map(|i| a[i] - b[i])
        };
        let (u, v) = (step(0), step(1));
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let size = n.iter().map(|v| v * v).sum::<f64>().sqrt();
        n.map(|v| v / size)
    }

    /// So many touches over a part of the way round.
    fn touched(self, count: usize, arc: f64, seed: u64) -> Contacts {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let normal = Normal::new(0.0, 1.0).unwrap();
        let touches: Vec<([f64; 3], [f64; 3])> = (0..count)
            .map(|_| {
                let at = [arc * random.random::<f64>(), random.random::<f64>()];
                let (place, outwards) = (self.place(at), self.outwards(at));
                let off = |v: f64, by: f64, random: &mut ChaCha8Rng| v + by * normal.sample(random);
                let place = place.map(|v| off(v, OFF, &mut random));
                (place, outwards.map(|v| off(v, TILT, &mut random)))
            })
            .collect();
        let (places, normals): (Vec<[f64; 3]>, Vec<[f64; 3]>) = touches.into_iter().unzip();
        Contacts::from_points(&places).with_normal_vectors(&normals)
    }
}

const HORNS: [Horn; 3] =
    [Horn { bend: 1.2, tube: 0.3 }, Horn { bend: 1.5, tube: 0.25 }, Horn { bend: 1.8, tube: 0.33 }];

fn recognised(horn: Horn, count: usize, arc: f64, seed: u64) -> Recognition {
    let contacts = horn.touched(count, arc, seed);
    Recognition::of(&contacts, &RecognitionOptions::default()).unwrap_or_else(|e| panic!("{count}, {arc}, {seed}: {e}"))
}

/// What a surface does not know between sixty touches is far more than they err by, which was taken for a surface that predicts nothing.
#[test]
fn a_whole_body_touched_exactly_is_a_surface() {
    for (horn, seed) in HORNS.into_iter().zip(0..) {
        for count in [30, 60] {
            let found = recognised(horn, count, std::f64::consts::TAU, seed);
            assert_eq!(found.hypothesis, Hypothesis::Displaced, "{count}, {seed}");
        }
    }
}

/// They were balls and paraboloids whose neighbouring contacts share errors of a hundred times their own.
#[test]
fn a_strip_of_a_bent_body_is_shape_and_no_error_that_neighbours_share() {
    for (horn, seed) in HORNS.into_iter().zip(10..) {
        for count in [60, 200] {
            let found = recognised(horn, count, 1.0, seed);
            assert_eq!(found.hypothesis, Hypothesis::Displaced, "{count}, {seed}");
            let noise = found.noise;
            assert!((0.5 * OFF..2.0 * OFF).contains(&noise.sd_z), "{count}, {seed}: {noise:?}");
            assert!(noise.sd_correlated == 0.0, "{count}, {seed}: {noise:?}");
        }
    }
}

/// A bump on what is flat, turned about its own axis: at most 1 along z, some 0.4 wide.
fn bump(count: usize, seed: u64) -> Contacts {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, 1.0).unwrap();
    let touches: Vec<([f64; 3], [f64; 3])> = (0..count)
        .map(|_| {
            let [x, y] = [0, 1].map(|_| 2.0 * random.random::<f64>() - 1.0);
            let z = 0.4 * (-(x * x + y * y) / (2.0 * 0.4 * 0.4)).exp();
            let mut off = |v: f64, by: f64| v + by * normal.sample(&mut random);
            let slope = [x, y].map(|v| v * z / (0.4 * 0.4));
            ([x, y, z].map(|v| off(v, OFF)), [slope[0], slope[1], 1.0].map(|v| off(v, TILT)))
        })
        .collect();
    let (places, normals): (Vec<[f64; 3]>, Vec<[f64; 3]>) = touches.into_iter().unzip();
    Contacts::from_points(&places).with_normal_vectors(&normals)
}

/// Counted from a cylinder or a ball, both of which bend sharply near the top, it was a ridge there.
#[test]
fn a_bump_is_as_round_on_its_axis_as_it_is() {
    for seed in 0..6 {
        let found = Recognition::of(&bump(80, seed), &RecognitionOptions::default()).unwrap();
        let [u, v] = found.surface.chart_of([0.05, 0.05, 0.4]);
        let bends = found.surface.curvatures_at(u, v).unwrap();
        // -A / w^2 on the axis
        assert!(bends.iter().all(|k| (-k - 2.5).abs() < 0.8), "{seed}: {:?} {bends:?}", found.hypothesis);
    }
}

/// Touches all round a catenoid of waist 0.6, which bends alike both ways, with its normals.
fn catenoid(count: usize, seed: u64) -> Contacts {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, 1.0).unwrap();
    let touches: Vec<([f64; 3], [f64; 3])> = (0..count)
        .map(|_| {
            let (turn, h) = (std::f64::consts::TAU * random.random::<f64>(), 0.9 * random.random::<f64>() - 0.45);
            let (rho, slope) = (0.6 * (h / 0.6).cosh(), (h / 0.6).sinh());
            let mut off = |v: f64, by: f64| v + by * normal.sample(&mut random);
            let place = [rho * turn.cos(), rho * turn.sin(), h].map(|v| off(v, 0.008));
            (place, [turn.cos(), turn.sin(), -slope].map(|v| off(v, 0.05 * (1.0 + slope * slope).sqrt())))
        })
        .collect();
    let (places, normals): (Vec<[f64; 3]>, Vec<[f64; 3]>) = touches.into_iter().unzip();
    Contacts::from_points(&places).with_normal_vectors(&normals)
}

/// The inside of a ring lies within the noise of it, and its S is off by several of its own standard uncertainties.
#[test]
fn a_neck_may_have_another_section_than_a_ring() {
    let holds = |seed: &u64| {
        let found = Recognition::of(&catenoid(150, *seed), &RecognitionOptions::default()).unwrap();
        let s = found.shape_index.unwrap();
        s.mean.abs() <= 3.0 * s.u
    };
    let held = (0..12).filter(holds).count();
    assert!(held >= 9, "{held} of 12");
}
