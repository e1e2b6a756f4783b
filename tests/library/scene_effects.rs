//! The law of every effect over 10^6 draws against its closed form, in sigma of the estimate.
use palpate::scene::{Effect, Simulator, Surface, Sweep, World};
use palpate_world::scene::{ContactBatch, linspace};

const DRAWS: usize = 1_000_000;
const LANES: usize = 10_000;
/// Five sigma: a false alarm once in 1.7 million comparisons, and the seed is fixed.
const SIGMAS: f64 = 5.0;

/// Mean of a statistic with the error of that mean.
#[derive(Default)]
struct Mean {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Mean {
    fn push(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.squares += value * value;
    }

    fn expect(&self, what: &str, expected: f64) {
        let mean = self.sum / self.count;
        let variance = (self.squares / self.count - mean * mean).max(0.0);
        let error = (variance / self.count).sqrt();
        let sigmas = (mean - expected) / error;
        println!("  {what}: {mean:.6e}, closed form {expected:.6e}, {sigmas:+.2} sigma");
        assert!(error > 0.0 && sigmas.abs() < SIGMAS, "{what}: {mean} is {sigmas} sigma from {expected}");
    }
}

fn sphere() -> Surface {
    Surface::sphere(6.0)
}

fn plane() -> Surface {
    Surface::plane()
}

fn one_site(tip_radius: f64) -> Sweep {
    Sweep::new(vec![2.0], vec![1.0]).with_tip_radius(tip_radius)
}

fn compiled(surface: Surface, sweep: Sweep, effect: Effect) -> Simulator {
    World::new(surface, sweep).with(effect).compile().unwrap()
}

/// Calls `visit(truth point, truth normal, points, normals)` for each of 10^6 replicates of all contacts.
fn replicate(simulator: &Simulator, mut visit: impl FnMut(&[[f64; 3]], &[[f64; 3]], &[bool])) {
    let mut block = ContactBatch::default();
    let contacts = simulator.sites().len();
    let (mut points, mut normals) = (vec![[0.0; 3]; contacts], vec![[0.0; 3]; contacts]);
    let mut lost = vec![false; contacts];
    for first in (0..DRAWS).step_by(LANES) {
        simulator.simulate_batch(42, first as u64, LANES, &mut block);
        for lane in 0..LANES {
            for contact in 0..contacts {
                points[contact] = block.points[contact * LANES + lane];
                normals[contact] = block.normals[contact * LANES + lane];
                lost[contact] = block.is_lost(contact, lane);
            }
            visit(&points, &normals, &lost);
        }
    }
}

fn touch(simulator: &Simulator) -> ([f64; 3], [f64; 3]) {
    let touch = simulator.sites()[0].touch;
    (touch.point, touch.local.normal)
}

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|v| v / length)
}

/// Any two unit tangents.
fn tangents(n: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let first = unit(cross(n, [0.3, -0.5, 0.8]));
    (first, cross(n, first))
}

pub(crate) fn assert_close(what: &str, a: [f64; 3], b: [f64; 3], tolerance: f64) {
    assert!(minus(a, b).iter().all(|d| d.abs() <= tolerance), "{what}: {a:?} {b:?}");
}

/// Names each law after its effect and makes it a test.
macro_rules! laws {
    ($($name:ident),* $(,)?) => {
        pub(crate) const LAWS: &[&str] = &[$(stringify!($name)),*];
        mod law {
            $(#[test] fn $name() { super::$name(); })*
        }
    };
}

laws![
    tip_radius_error,
    indentation,
    friction,
    force_noise,
    position_noise,
    normal_noise,
    slope_gain,
    encoder,
    misalignment,
    latency,
    finger_noise,
    slip,
    dropout,
    row_noise,
];

/// Deterministic: P - e n in every replicate.
fn tip_radius_error() {
    let simulator = compiled(sphere(), one_site(1.0), Effect::tip_radius_error(0.2));
    let (point, normal) = touch(&simulator);
    let expected = [0, 1, 2].map(|k| point[k] - 0.2 * normal[k]);
    replicate(&simulator, |points, normals, _| {
        assert_close("point", points[0], expected, 1e-15);
        assert_eq!(normals[0], normal);
    });
}

/// First and second moment of the depth under a uniform overshoot.
fn indentation() {
    let (modulus, threshold, overshoot) = (50.0, 0.5, 1.5);
    let simulator = compiled(sphere(), one_site(1.0), Effect::indentation(modulus, threshold, overshoot));
    let (point, normal) = touch(&simulator);
    // ball of radius 1 on a ball of radius 6
    let unit_depth = (9.0 / (16.0 * modulus * modulus) * (1.0 + 1.0 / 6.0_f64)).cbrt();
    let (a, b): (f64, f64) = (threshold, threshold + overshoot);
    let moment = |n: f64| {
        let power = 2.0 * n / 3.0 + 1.0;
        unit_depth.powf(n) * (b.powf(power) - a.powf(power)) / (power * (b - a))
    };
    let (mut depth, mut square) = (Mean::default(), Mean::default());
    replicate(&simulator, |points, normals, _| {
        let shift = minus(point, points[0]);
        let along = dot(shift, normal);
        assert_close("into the surface", shift, normal.map(|n| along * n), 1e-14);
        assert_eq!(normals[0], normal);
        depth.push(along);
        square.push(along * along);
    });
    depth.expect("depth", moment(1.0));
    square.expect("depth squared", moment(2.0));
}

/// tan(tilt) = mu + sigma N against the sliding; the contact swings about the tip's centre.
fn friction() {
    let (mu, sigma, tip) = (0.3, 0.05, 1.0);
    let simulator = compiled(sphere(), one_site(tip), Effect::friction(mu, sigma));
    let (point, normal) = touch(&simulator);
    let sliding = minus([0.0, 1.0, 0.0], normal.map(|n| normal[1] * n));
    let (sliding, side) = (unit(sliding), cross(normal, unit(sliding)));
    let (mut tilt, mut variance) = (Mean::default(), Mean::default());
    replicate(&simulator, |points, normals, _| {
        let tangent = -dot(normals[0], sliding) / dot(normals[0], normal);
        assert!(dot(normals[0], side).abs() < 1e-15);
        let swung = minus(point, minus(normals[0], normal).map(|d| tip * d));
        assert_close("swing", points[0], swung, 1e-14);
        tilt.push(tangent);
        variance.push((tangent - mu).powi(2));
    });
    tilt.expect("tan tilt", mu);
    variance.expect("variance", sigma * sigma);
}

/// Bias, noise, random walk, and quantisation (Sheppard's q^2/12), in the tangent plane.
fn force_noise() {
    let (sigma, drift, load) = (0.01, 0.004, 2.0);
    let bias = [0.02, -0.01, 0.0];
    let sweep = Sweep::new(vec![0.0], vec![-1.0, 0.0, 1.0]);
    let simulator = compiled(
        plane(),
        sweep,
        Effect::force_noise(sigma).with_force_bias(bias).with_force_drift(drift).with_force(load),
    );
    let mut means: [Mean; 2] = Default::default();
    let mut variances: [Mean; 3] = Default::default();
    let (mut shared, mut lengths) = (Mean::default(), Mean::default());
    replicate(&simulator, |points, normals, _| {
        // f_x / f_z = (b_x + W + sigma N) / (F + ...): the quotient's own terms are 1e-4 of each moment
        let tilt = |i: usize, k: usize| normals[i][k] / normals[i][2];
        means[0].push(tilt(0, 0));
        means[1].push(tilt(0, 1));
        for (i, variance) in variances.iter_mut().enumerate() {
            variance.push((tilt(i, 0) - bias[0] / load).powi(2));
        }
        shared.push((tilt(0, 1) - bias[1] / load) * (tilt(2, 1) - bias[1] / load));
        lengths.push(dot(normals[0], normals[0]) + 1e-12 * tilt(0, 0));
        assert_eq!(points[1], [0.0, 0.0, 0.0]);
    });
    means[0].expect("mean x", bias[0] / load);
    means[1].expect("mean y", bias[1] / load);
    for (i, variance) in variances.iter().enumerate() {
        let steps = (i + 1) as f64;
        variance.expect("variance", (sigma * sigma + steps * drift * drift) / (load * load));
    }
    shared.expect("covariance of stations 0 and 2", drift * drift / (load * load));
    assert!((lengths.sum / lengths.count - 1.0).abs() < 1e-12);

    let quantum = 0.02;
    let noise = Effect::force_noise(quantum).with_force_steps(quantum);
    let simulator = compiled(plane(), Sweep::new(vec![0.0], vec![0.0]), noise);
    let mut variance = Mean::default();
    replicate(&simulator, |_, normals, _| {
        let size = normals[0][2].recip();
        // sideways force over the vertical one; the latter's error enters at second order, 3 sigma^2 = 1.2e-3 of it
        variance.push((normals[0][0] * size).powi(2));
    });
    let second_order = 1.0 + 3.0 * quantum * quantum;
    variance.expect("variance with quantisation", (quantum * quantum * (1.0 + 1.0 / 12.0)) * second_order);

    let quantised = Effect::force_noise(0.0).with_force_steps(0.3);
    let simulator = compiled(sphere(), one_site(0.0), quantised);
    let (_, normal) = touch(&simulator);
    let mut block = ContactBatch::default();
    simulator.simulate_batch(1, 0, 1, &mut block);
    assert_close("rounded force", block.normals[0], unit(normal.map(|n| (n / 0.3).round() * 0.3)), 1e-15);
}

/// Mean 0 and all six covariances.
fn position_noise() {
    let covariance = [[0.04, 0.01, -0.02], [0.01, 0.09, 0.03], [-0.02, 0.03, 0.05]];
    let simulator = compiled(sphere(), one_site(0.0), Effect::position_covariance(covariance));
    expect_covariance(&simulator, covariance);
    let simulator = compiled(sphere(), one_site(0.0), Effect::position_noise([0.1, 0.2, 0.3]));
    expect_covariance(&simulator, [[0.01, 0.0, 0.0], [0.0, 0.04, 0.0], [0.0, 0.0, 0.09]]);
}

fn expect_covariance(simulator: &Simulator, covariance: [[f64; 3]; 3]) {
    let (point, normal) = touch(simulator);
    let mut means: [Mean; 3] = Default::default();
    let mut products: [[Mean; 3]; 3] = Default::default();
    replicate(simulator, |points, normals, _| {
        let shift = minus(points[0], point);
        assert_eq!(normals[0], normal);
        for i in 0..3 {
            means[i].push(shift[i]);
            for j in 0..=i {
                products[i][j].push(shift[i] * shift[j]);
            }
        }
    });
    for i in 0..3 {
        means[i].expect("mean", 0.0);
        for j in 0..=i {
            products[i][j].expect("covariance", covariance[i][j]);
        }
    }
}

/// von Mises-Fisher: E cos = coth k - 1/k, E cos^2 = 1 - 2 E cos / k, azimuth uniform; rms angle sqrt 2 sigma when small.
fn normal_noise() {
    for sigma_deg in [25.0_f64, 0.5] {
        let simulator = compiled(sphere(), one_site(1.0), Effect::normal_noise(sigma_deg));
        let (point, normal) = touch(&simulator);
        let kappa = sigma_deg.to_radians().powi(-2);
        let mean_cos = 1.0 / kappa.tanh() - 1.0 / kappa;
        let (e1, e2) = tangents(normal);
        let (mut fall, mut square) = (Mean::default(), Mean::default());
        let mut azimuth: [Mean; 4] = Default::default();
        replicate(&simulator, |points, normals, _| {
            assert_eq!(points[0], point);
            let difference = minus(normals[0], normal);
            // 1 - cos = |difference|^2 / 2, without cancellation
            let drop = 0.5 * dot(difference, difference);
            fall.push(drop);
            square.push((1.0 - drop).powi(2) - 1.0);
            let (a, b) = (dot(difference, e1), dot(difference, e2));
            for (mean, value) in azimuth.iter_mut().zip([a, b, a * b, a * a - b * b]) {
                mean.push(value);
            }
        });
        fall.expect("1 - cos", 1.0 - mean_cos);
        square.expect("cos^2 - 1", -2.0 * mean_cos / kappa);
        azimuth.iter().for_each(|mean| mean.expect("isotropy", 0.0));
        if sigma_deg < 1.0 {
            // E angle^2 = 2 sigma^2, to sigma^2 of itself
            let rms = (2.0 * fall.sum / fall.count).sqrt();
            assert!((rms / (2.0_f64.sqrt() * sigma_deg.to_radians()) - 1.0).abs() < 0.003);
        }
    }
}

/// Deterministic: every normal by one rotation, the points where they were.
#[test]
fn a_sensor_that_sits_askew_turns_every_normal_alike() {
    for tilt in [[20.0, 0.0, 0.0], [0.0, -35.0, 0.0], [1e-9, 0.0, 0.0]] {
        let simulator = compiled(sphere(), one_site(1.0), Effect::normal_noise(0.0).with_normal_tilt(tilt));
        let turned = compiled(sphere(), one_site(1.0), Effect::misalignment(tilt, [0.0; 3]));
        let (mut one, mut other) = (ContactBatch::default(), ContactBatch::default());
        simulator.simulate_batch(42, 0, LANES, &mut one);
        turned.simulate_batch(42, 0, LANES, &mut other);
        assert!(one.points.iter().all(|point| *point == touch(&simulator).0));
        one.normals.iter().zip(&other.normals).for_each(|(n, m)| assert_close("normal", *n, *m, 1e-15));
    }
    let misplaced = World::new(sphere(), one_site(1.0)).with(Effect::dropout(0.1).with_normal_tilt([1.0, 0.0, 0.0]));
    assert!(misplaced.compile().unwrap_err().to_string().contains("belongs to normal_noise"));
}

/// One joint: exact trigonometric moments; three joints: sigma^2 J J' from the geometry of the default arm.
fn encoder() {
    let (length, sigma_deg) = (10.0, 8.0_f64);
    let sigma = sigma_deg.to_radians();
    let base = [-8.0, 1.0, 0.0];
    let one_link = |theta_deg: f64| [[length, 0.0, 0.0, theta_deg]];
    let simulator = compiled(plane(), one_site(0.0), Effect::encoder(0.0, sigma_deg).with_arm(base, &one_link(0.0)));
    let (mut x, mut y, mut y2) = (Mean::default(), Mean::default(), Mean::default());
    replicate(&simulator, |points, normals, _| {
        let shift = minus(points[0], [2.0, 1.0, 0.0]);
        assert!(shift[2].abs() < 1e-14 && normals[0][2] == 1.0);
        x.push(shift[0]);
        y.push(shift[1]);
        y2.push(shift[1] * shift[1]);
    });
    x.expect("mean along the link", length * ((-0.5 * sigma * sigma).exp() - 1.0));
    y.expect("mean across", 0.0);
    y2.expect("variance across", length * length * 0.5 * (1.0 - (-2.0 * sigma * sigma).exp()));

    // the joint stands at -33 degrees from encoder zero; steps of 10 read -30
    let coarse = Effect::encoder(10.0, 0.0).with_arm(base, &one_link(33.0));
    let simulator = compiled(plane(), one_site(0.0), coarse);
    let mut block = ContactBatch::default();
    simulator.simulate_batch(1, 0, 1, &mut block);
    let turned = 3.0_f64.to_radians();
    let expected = [-8.0 + length * turned.cos(), 1.0 + length * turned.sin(), 0.0];
    assert_close("coarse encoder", block.points[0], expected, 1e-12);

    three_joints();
}

fn three_joints() {
    let sigma_deg = 0.01_f64;
    let sigma = sigma_deg.to_radians();
    let sweep = Sweep::new(vec![-4.0, 4.0], vec![-4.0, 4.0]);
    let simulator = compiled(plane(), sweep, Effect::encoder(0.0, sigma_deg));
    let mut products: [[Mean; 3]; 3] = Default::default();
    replicate(&simulator, |points, _, _| {
        let shift = minus(points[3], [4.0, 4.0, 0.0]);
        for i in 0..3 {
            for j in 0..=i {
                products[i][j].push(shift[i] * shift[j]);
            }
        }
    });
    // patch of side 8: base (-32, 0, 0), shoulder 16 above it, two links of 24
    let (target, shoulder, link) = ([4.0, 4.0, 0.0], [-32.0, 0.0, 16.0], 24.0_f64);
    let reach = minus(target, shoulder);
    let out = reach[0].hypot(reach[1]);
    let (radial, distance) = ([reach[0] / out, reach[1] / out, 0.0], dot(reach, reach).sqrt());
    let half = (0.5 * distance / link).acos();
    let slope = reach[2].atan2(out);
    let axis = [radial[1], -radial[0], 0.0];
    let consistent = [half, -half].into_iter().any(|bend| {
        let (sin, cos) = (slope + bend).sin_cos();
        let elbow = [0, 1, 2].map(|k| shoulder[k] + link * (cos * radial[k] + sin * [0.0, 0.0, 1.0][k]));
        let columns = [cross([0.0, 0.0, 1.0], reach), cross(axis, reach), cross(axis, minus(target, elbow))];
        let expected = |i: usize, j: usize| sigma * sigma * columns.iter().map(|c| c[i] * c[j]).sum::<f64>();
        let close = |i: usize, j: usize| {
            let mean = &products[i][j];
            let value = mean.sum / mean.count;
            let error = ((mean.squares / mean.count - value * value) / mean.count).sqrt();
            ((value - expected(i, j)) / error).abs() < SIGMAS
        };
        (0..3).all(|i| (0..=i).all(|j| close(i, j)))
    });
    assert!(consistent, "covariance of the arm's tip is sigma^2 J J' for neither elbow");
}

/// Deterministic: the slopes -nx/nz and -ny/nz by the factor, the point where it was.
fn slope_gain() {
    for relative in [0.3, -0.2, 1e-9] {
        let simulator = compiled(sphere(), one_site(1.0), Effect::slope_gain(relative));
        let (point, normal) = touch(&simulator);
        replicate(&simulator, |points, normals, _| {
            assert_eq!(points[0], point);
            let slope = |n: [f64; 3], k: usize| -n[k] / n[2];
            let steeper = [0, 1, 2].map(|k| if k < 2 { slope(normals[0], k) } else { dot(normals[0], normals[0]) });
            let expected = [0, 1, 2].map(|k| if k < 2 { (1.0 + relative) * slope(normal, k) } else { 1.0 });
            assert_close("slopes and length", steeper, expected, 1e-15);
        });
    }
}

/// Deterministic: the rotation by an independent axis-angle formula, and the shift.
fn misalignment() {
    let translation = [0.1, -0.2, 0.3];
    for (axis, degrees) in [(0, 20.0), (1, -35.0), (2, 90.0)] {
        let mut rotation_deg = [0.0; 3];
        rotation_deg[axis] = degrees;
        let simulator = compiled(sphere(), one_site(0.0), Effect::misalignment(rotation_deg, translation));
        let (point, normal) = touch(&simulator);
        let mut about = [0.0; 3];
        about[axis] = 1.0;
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let rotated = |v: [f64; 3]| {
            let (c, d) = (cross(about, v), dot(about, v));
            [0, 1, 2].map(|k| cos * v[k] + sin * c[k] + (1.0 - cos) * d * about[k])
        };
        let expected = rotated(point);
        replicate(&simulator, |points, normals, _| {
            assert_close("point", points[0], [0, 1, 2].map(|k| expected[k] + translation[k]), 1e-14);
            assert_close("normal", normals[0], rotated(normal), 1e-14);
        });
    }
}

/// Lag uniform: mean and variance along the lane; on a curved surface the point stays on it.
fn latency() {
    let (distance, jitter) = (0.3, 0.2);
    let simulator = compiled(plane(), one_site(0.0), Effect::latency(distance, jitter));
    let (mut mean, mut variance) = (Mean::default(), Mean::default());
    replicate(&simulator, |points, _, _| {
        let shift = minus(points[0], [2.0, 1.0, 0.0]);
        assert!(shift[0] == 0.0 && shift[2] == 0.0);
        mean.push(shift[1]);
        variance.push((shift[1] + distance).powi(2));
    });
    mean.expect("shift", -distance);
    variance.expect("variance", jitter * jitter / 3.0);
    let simulator = compiled(sphere(), one_site(0.5), Effect::latency(distance, jitter));
    let surface = sphere();
    let (contacts, _) = simulator.simulate(1, 2);
    assert!((surface.height(contacts.x[0], contacts.y[0]).unwrap() - contacts.z[0]).abs() < 1e-12);
}

/// Covariance sigma^2 exp(-|s - s'|/length), uneven stations, position and normal; fingers independent.
fn finger_noise() {
    let (sigma, sigma_deg, length) = ([0.1, 0.2, 0.3], 0.2_f64, 2.0);
    let stations = [-3.0, -2.5, 0.5];
    let sweep = Sweep::new(vec![-1.0, 1.0], stations.to_vec());
    let simulator = compiled(plane(), sweep, Effect::finger_noise(sigma, sigma_deg, length));
    let mut z: [[Mean; 6]; 6] = Default::default();
    let mut tilt: [[Mean; 6]; 6] = Default::default();
    replicate(&simulator, |points, normals, _| {
        for i in 0..6 {
            for j in 0..=i {
                z[i][j].push(points[i][2] * points[j][2]);
                tilt[i][j].push(normals[i][0] * normals[j][0]);
            }
        }
    });
    for i in 0..6 {
        for j in 0..=i {
            let apart = f64::abs(stations[i % 3] - stations[j % 3]);
            let correlation = if i / 3 == j / 3 { (-apart / length).exp() } else { 0.0 };
            z[i][j].expect("covariance of z", 0.09 * correlation);
            tilt[i][j].expect("covariance of nx", sigma_deg.to_radians().powi(2) * correlation);
        }
    }
}

/// How often, how far, in no direction.
fn slip() {
    let (probability, size) = (0.05, 0.8);
    let simulator = compiled(sphere(), one_site(0.0), Effect::slip(probability, size));
    let (point, normal) = touch(&simulator);
    let mut often = Mean::default();
    let mut means: [Mean; 3] = Default::default();
    let mut squares: [Mean; 3] = Default::default();
    replicate(&simulator, |points, normals, _| {
        let shift = minus(points[0], point);
        let far = dot(shift, shift).sqrt();
        assert!(far == 0.0 || (far - size).abs() < 1e-14);
        assert_eq!(normals[0], normal);
        often.push(f64::from(far > 0.0));
        for k in 0..3 {
            means[k].push(shift[k]);
            squares[k].push(shift[k] * shift[k]);
        }
    });
    often.expect("frequency", probability);
    means.iter().for_each(|mean| mean.expect("mean", 0.0));
    squares.iter().for_each(|mean| mean.expect("variance", probability * size * size / 3.0));
}

/// Binomial: mean and variance of the number kept.
fn dropout() {
    let probability = 0.3;
    let sweep = Sweep::new(vec![-4.0, 0.0, 4.0], linspace(-4.0, 4.0, 4));
    let simulator = compiled(plane(), sweep, Effect::dropout(probability));
    let (mut kept, mut variance) = (Mean::default(), Mean::default());
    replicate(&simulator, |_, _, lost| {
        let count = lost.iter().filter(|lost| !**lost).count() as f64;
        kept.push(count);
        variance.push((count - 12.0 * 0.7).powi(2));
    });
    kept.expect("kept", 12.0 * 0.7);
    variance.expect("variance", 12.0 * 0.7 * 0.3);
    let (contacts, truth) = simulator.simulate(42, 7);
    assert!(contacts.len() < 12 && contacts.len() == truth.points.len());
    for (r, point) in truth.points.iter().enumerate() {
        assert_eq!([contacts.x[r], contacts.y[r]], [point.point[0], point.point[1]]);
    }
}

/// Independent errors of z, zx, zy on a slanting place.
fn row_noise() {
    let (sigma_z, sigma_slope) = (0.02, 0.05);
    let simulator = compiled(sphere(), one_site(0.0), Effect::row_noise(sigma_z, sigma_slope));
    let (point, normal) = touch(&simulator);
    let mut means: [Mean; 3] = Default::default();
    let mut products: [[Mean; 3]; 3] = Default::default();
    replicate(&simulator, |points, normals, _| {
        assert_eq!(points[0][..2], point[..2]);
        let slope = |n: [f64; 3], k: usize| -n[k] / n[2];
        let error =
            [points[0][2] - point[2], slope(normals[0], 0) - slope(normal, 0), slope(normals[0], 1) - slope(normal, 1)];
        for i in 0..3 {
            means[i].push(error[i]);
            for j in 0..=i {
                products[i][j].push(error[i] * error[j]);
            }
        }
    });
    let sd = [sigma_z, sigma_slope, sigma_slope];
    for i in 0..3 {
        means[i].expect("mean", 0.0);
        for j in 0..=i {
            products[i][j].expect("covariance", if i == j { sd[i] * sd[i] } else { 0.0 });
        }
    }
}
