//! Adaptive fits of surfaces with known truth: noise alone, small features, slopes and normals, and bad input.

use super::*;
use palpate_geometry::contact::Orientation;
use palpate_geometry::curvature::Derivatives;
use palpate_geometry::surface::Surface;
use palpate_numeric::draws::Lcg;

/// Contacts of a surface with noise at the places that `place` draws.
fn touched_at(
    count: usize,
    noise: f64,
    seed: u64,
    truth: impl Fn(f64, f64) -> f64,
    place: impl Fn(&mut Lcg) -> [f64; 2],
) -> Contacts {
    let mut draw = Lcg::new(seed);
    let (mut x, mut y, mut z) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..count {
        let [u, v] = place(&mut draw);
        x.push(u);
        y.push(v);
        z.push(truth(u, v) + noise * draw.normal());
    }
    Contacts::from_positions(x, y, z)
}

fn anywhere(draw: &mut Lcg) -> [f64; 2] {
    [0, 1].map(|_| 2.0 * draw.uniform() - 1.0)
}

fn touched(count: usize, noise: f64, seed: u64, truth: impl Fn(f64, f64) -> f64) -> Contacts {
    touched_at(count, noise, seed, truth, anywhere)
}

fn fitted(contacts: &Contacts) -> AdaptiveFit {
    fit_adaptive(contacts, &AdaptiveOptions::default()).unwrap()
}

fn smooth(x: f64, y: f64) -> f64 {
    0.3 * (1.5 * x).sin() * (1.2 * y + 0.3).cos()
}

fn bump([x, y]: [f64; 2], [u, v]: [f64; 2], height: f64, radius: f64) -> f64 {
    height * (-((x - u).powi(2) + (y - v).powi(2)) / (radius * radius)).exp()
}

fn scratched(x: f64, y: f64) -> f64 {
    smooth(x, y) + bump([x, y], [0.31, -0.44], 0.05, 0.03)
}

/// Root mean square of the error over places that `inside` holds.
fn error(fit: &AdaptiveFit, truth: impl Fn(f64, f64) -> f64, inside: impl Fn(f64, f64) -> bool) -> f64 {
    let mut draw = Lcg::new(77);
    let (mut sum, mut count) = (0.0, 0.0);
    while count < 2000.0 {
        let [x, y] = anywhere(&mut draw);
        if inside(x, y) {
            sum += (fit.at(x, y).z - truth(x, y)).powi(2);
            count += 1.0;
        }
    }
    (sum / count).sqrt()
}

#[test]
fn noise_alone_splits_nothing() {
    for seed in 0..10 {
        let fit = fitted(&touched(20_000, 0.01, seed, smooth));
        assert_eq!(fit.report().rounds.len(), 1, "{:?}", fit.report().rounds);
        assert!((fit.height_noise() / 0.01 - 1.0).abs() < 0.02);
        // 121 functions at most, fewer where the roughness holds them
        assert!(fit.report().freedom.is_some_and(|freedom| (10.0..121.0).contains(&freedom)));
    }
}

#[test]
fn a_small_feature_is_followed_and_the_rest_left_alone() {
    let fit = fitted(&touched(200_000, 0.002, 3, scratched));
    assert!((fit.height_noise() / 0.002 - 1.0).abs() < 0.02);
    assert!(fit.report().backward_error.is_some_and(|error| error < 1e-12), "{:?}", fit.report().backward_error);
    assert!((fit.at(0.31, -0.44).z - scratched(0.31, -0.44)).abs() < 0.002);
    assert!(fit.unknowns() < 800, "{}", fit.unknowns());
    let far = fit.field().space().leaves().iter().filter(|cell| cell.level == 0).count();
    // about a cell of level 5 the grading alone takes a square of six cells of the base grid
    assert!(far >= 28, "{far} of 64 cells of the base grid are whole");
    // the top of the bump, a cap; its bending is flattened by a fifth where the knots stop at what heights tell from noise
    let top = fit.jet([0.31, -0.44]).principal().unwrap();
    let exact = 2.0 * 0.05 / 0.03_f64.powi(2);
    assert!(top.shape_index().unwrap() > 0.9);
    assert!((top.curvedness() / exact - 1.0).abs() < 0.3, "{} {exact}", top.curvedness());
    assert!(fit.point_sds([0.31, -0.44]).and_then(|sds| sds.curvedness).is_some_and(|sd| sd > 0.0 && sd < exact));
}

#[test]
fn slopes_and_normals_are_weighed_by_their_noise() {
    let slope = |x: f64, y: f64| {
        let h = 1e-5;
        [
            (scratched(x + h, y) - scratched(x - h, y)) / (2.0 * h),
            (scratched(x, y + h) - scratched(x, y - h)) / (2.0 * h),
        ]
    };
    let bare = touched(40_000, 0.002, 4, scratched);
    let mut draw = Lcg::new(5);
    let slopes: Vec<[f64; 2]> =
        (0..bare.len()).map(|r| slope(bare.x[r], bare.y[r]).map(|s| s + 0.02 * draw.normal())).collect();
    let (zx, zy) = slopes.iter().map(|s| (s[0], s[1])).unzip();
    // the same noise across the normal, tangent axis by tangent axis
    let normals: Vec<[f64; 3]> = (0..bare.len())
        .map(|r| {
            let [p, q] = slope(bare.x[r], bare.y[r]);
            let w = p.hypot(q).hypot(1.0);
            let first = [1.0, 0.0, p].map(|v| v / p.hypot(1.0));
            let n = [-p / w, -q / w, 1.0 / w];
            let second = palpate_numeric::vector::cross(n, first);
            let [a, b] = [0.02 * draw.normal(), 0.02 * draw.normal()];
            [0, 1, 2].map(|k| n[k] + a * first[k] + b * second[k])
        })
        .collect();
    let alone = error(&fitted(&bare), scratched, |_, _| true);
    for contacts in [bare.clone().with_slopes(zx, zy), bare.clone().with_normal_vectors(&normals)] {
        let fit = fitted(&contacts);
        assert!((fit.height_noise() / 0.002 - 1.0).abs() < 0.03, "{}", fit.height_noise());
        assert!((fit.slope_noise().unwrap() / 0.02 - 1.0).abs() < 0.03, "{:?}", fit.slope_noise());
        // rows of slopes are linear; those of normals are about the last step, and each step leaves a fiftieth of what the one before left
        let most = if matches!(contacts.orientation, Orientation::Slopes { .. }) { 1e-12 } else { 1e-6 };
        assert!(fit.report().backward_error.is_some_and(|error| error < most), "{:?}", fit.report().backward_error);
        let with = error(&fit, scratched, |_, _| true);
        assert!(with < 0.9 * alone, "{with} with them, {alone} without");
    }
}

/// Noise that grows a hundredfold across the domain: intervals hold at both ends.
#[test]
fn noise_may_differ_from_place_to_place() {
    let mut contacts = touched(200_000, 0.0, 19, smooth);
    let mut draw = Lcg::new(20);
    for r in 0..contacts.len() {
        contacts.z[r] += 0.002 * 10.0_f64.powf(contacts.x[r]) * draw.normal();
    }
    let fit = fitted(&contacts);
    let ends: [[f64; 2]; 2] = [[-0.9, -0.5], [0.5, 0.9]];
    for [from, to] in ends {
        let places = (0..2000).map(|_| [from + (to - from) * draw.uniform(), 1.9 * draw.uniform() - 0.95]);
        let held =
            |[x, y]: &[f64; 2]| (fit.at(*x, *y).z - smooth(*x, *y)).abs() < 1.96 * fit.height_sd(*x, *y).unwrap();
        let held = places.filter(held).count();
        assert!(held > 1700, "{held} of 2000 for x from {from} to {to}");
    }
    let [left, right] = [-0.7, 0.7].map(|x| fit.height_sd(x, 0.0).unwrap());
    assert!(right > 8.0 * left, "{left} {right}");
}

#[test]
fn declared_noise_is_taken_at_its_word() {
    let contacts = touched(20_000, 0.002, 17, smooth);
    let mut draw = Lcg::new(18);
    let [zx, zy] = [0, 1].map(|_| (0..20_000).map(|_| 100.0 * draw.normal()).collect());
    let contacts = contacts.with_slopes(zx, zy);
    let noise = RowVariances::Known { heights: 0.002, slopes: 100.0 };
    let fit = fit_adaptive(&contacts, &AdaptiveOptions { noise, ..AdaptiveOptions::default() }).unwrap();
    // slopes that say next to nothing leave the surface as it is without them
    assert!(error(&fit, smooth, |_, _| true) < 0.0004);
    assert!((fit.height_noise() - 0.002).abs() < 1e-15);
    assert_eq!(fit.slope_noise(), Some(100.0));
}

#[test]
fn half_of_the_domain_may_be_empty() {
    let half = |draw: &mut Lcg| [draw.uniform() - 1.0, 2.0 * draw.uniform() - 1.0];
    let options = AdaptiveOptions { domain: Some([[-1.0, 1.0], [-1.0, 1.0]]), ..AdaptiveOptions::default() };
    let fit = fit_adaptive(&touched_at(20_000, 0.002, 6, smooth, half), &options).unwrap();
    assert!(error(&fit, smooth, |x, _| x < -0.05) < 0.0006);
    // far from all contacts the uncertainty says so
    let [near, far] = [-0.5, 0.9].map(|x| fit.height_sd(x, 0.0).unwrap());
    assert!(far > 30.0 * near, "{near} {far}");
    assert!((fit.at(0.9, 0.0).z - smooth(0.9, 0.0)).abs() < 4.0 * far);
}

#[test]
fn density_may_vary_ten_thousandfold_and_contacts_may_lie_on_lines() {
    let corner = |draw: &mut Lcg| {
        if draw.uniform() < 0.96 { [0, 1].map(|_| 0.05 * draw.uniform()) } else { anywhere(draw) }
    };
    let fit = fitted(&touched_at(50_000, 0.002, 7, smooth, corner));
    assert!(error(&fit, smooth, |_, _| true) < 0.001);
    let lines = |draw: &mut Lcg| [((draw.uniform() * 41.0).floor() - 20.0) / 20.0, 2.0 * draw.uniform() - 1.0];
    let fit = fitted(&touched_at(50_000, 0.002, 8, scratched, lines));
    assert!(error(&fit, smooth, |x, y| (x - 0.31).hypot(y + 0.44) > 0.15) < 0.0007);
}

#[test]
fn outliers_are_left_out() {
    let mut contacts = touched(100_000, 0.002, 9, scratched);
    let clean = error(&fitted(&contacts), scratched, |_, _| true);
    let mut draw = Lcg::new(10);
    let mut strange = Vec::new();
    for r in 0..contacts.len() {
        if draw.uniform() < 0.05 {
            // all on one side, as multiple echoes are
            contacts.z[r] += 0.02 + 0.5 * draw.uniform();
            strange.push(r);
        }
    }
    let fit = fitted(&contacts);
    let left_out = &fit.report().outliers;
    let missed = strange.iter().filter(|r| left_out.binary_search(r).is_err()).count();
    assert!(missed < strange.len() / 100, "{missed} of {}", strange.len());
    assert!(left_out.len() < strange.len() + 60, "{} {}", left_out.len(), strange.len());
    assert!((fit.height_noise() / 0.002 - 1.0).abs() < 0.02, "{}", fit.height_noise());
    let found = error(&fit, scratched, |_, _| true);
    assert!(found < 1.25 * clean, "{found} with outliers, {clean} without");
}

#[test]
fn a_cliff_is_followed_as_far_as_contacts_tell() {
    let cliff = |x: f64, y: f64| smooth(x, y) + if x + 0.3 * y > 0.1 { 0.2 } else { 0.0 };
    let fit = fitted(&touched(60_000, 0.002, 11, cliff));
    let edge = |x: f64, y: f64| (x + 0.3 * y - 0.1).abs();
    let [near, far] = [error(&fit, cliff, |x, y| edge(x, y) > 0.05), error(&fit, cliff, |x, y| edge(x, y) > 0.2)];
    assert!(near < 0.004 && far < 0.001, "{near} {far}");
}

/// Coordinates of UTM: the same answer, moved.
#[test]
fn far_coordinates_cost_no_digits() {
    let here = touched(20_000, 0.002, 12, scratched);
    let scale = 1000.0;
    let [east, north] = [5.123_456e5, 9.876_543_2e6];
    let there = Contacts::from_positions(
        here.x.iter().map(|x| east + scale * x).collect(),
        here.y.iter().map(|y| north + scale * y).collect(),
        here.z.iter().map(|z| 400.0 + scale * z).collect(),
    );
    let (near, far) = (fitted(&here), fitted(&there));
    assert_eq!(near.unknowns(), far.unknowns());
    for [x, y] in [[0.2, 0.3], [0.31, -0.44], [-0.9, 0.8]] {
        let (a, b) = (near.at(x, y), far.at(east + scale * x, north + scale * y));
        assert!((400.0 + scale * a.z - b.z).abs() < 1e-6 && (a.zx - b.zx).abs() < 1e-6);
        let [u, v] = [near.height_sd(x, y), far.height_sd(east + scale * x, north + scale * y)].map(Option::unwrap);
        assert!((scale * u / v - 1.0).abs() < 1e-4, "{u} {v}");
    }
}

#[test]
fn one_and_two_threads_give_the_same_fit() {
    let contacts = touched(50_000, 0.002, 13, scratched);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fitted(&contacts))
    };
    let (one, two) = (run(1), run(2));
    assert_eq!(one.field().coefficients(), two.field().coefficients());
    assert_eq!(one.height_sd(0.3, 0.3), two.height_sd(0.3, 0.3));
}

#[test]
fn few_or_faulty_contacts_are_answered_or_refused() {
    let fit = fitted(&touched(12, 0.0, 14, |x, y| 1.0 + 0.2 * x - 0.1 * y));
    assert!((fit.at(0.1, 0.2).z - 1.0).abs() < 1e-6);
    let line = Contacts::from_positions(vec![0.0; 20], (0..20).map(f64::from).collect(), vec![0.0; 20]);
    assert!(matches!(fit_adaptive(&line, &AdaptiveOptions::default()), Err(HierarchyError::Flat { .. })));
    let mut bad = touched(20, 0.1, 15, smooth);
    bad.z[3] = f64::NAN;
    assert!(matches!(fit_adaptive(&bad, &AdaptiveOptions::default()), Err(HierarchyError::Contacts(_))));
    let options = AdaptiveOptions { degree: 1, ..AdaptiveOptions::default() };
    assert!(matches!(fit_adaptive(&touched(20, 0.1, 16, smooth), &options), Err(HierarchyError::Option { .. })));
}

/// The same cells, weights and coefficients without the factor of the whole, and standard uncertainties as far off as it is told.
#[test]
fn gradients_give_the_fit_of_the_factor() {
    let contacts = touched(100_000, 0.002, 22, scratched);
    let whole = fitted(&contacts);
    let options = AdaptiveOptions { most_factor_entries: 12_000, ..AdaptiveOptions::default() };
    let fit = fit_adaptive(&contacts, &options).unwrap();
    assert!(whole.report().factor_entries > 12_000, "{}", whole.report().factor_entries);
    assert_eq!(fit.report().rounds, whole.report().rounds);
    assert!(fit.report().backward_error.is_some_and(|error| error < 1e-12), "{:?}", fit.report().backward_error);
    assert!(fit.report().by_gradients && fit.report().condition.is_nan() && !whole.report().by_gradients);
    let told = fit.report().draws_error.unwrap();
    let freedom = |fit: &AdaptiveFit| fit.report().freedom.unwrap();
    assert!((freedom(&fit) / freedom(&whole) - 1.0).abs() < 0.02, "{} {}", freedom(&fit), freedom(&whole));
    let (mut squares, mut draw) = ([0.0; 2], Lcg::new(91));
    for _ in 0..2000 {
        let [x, y] = [0, 1].map(|_| 1.8 * draw.uniform() - 0.9);
        let of = |fit: &AdaptiveFit| {
            let sds = fit.point_sds([x, y]).unwrap();
            [sds.position, sds.curvedness.unwrap()]
        };
        let pairs = of(&fit).into_iter().zip(of(&whole));
        squares.iter_mut().zip(pairs).for_each(|(sum, (drawn, exact))| *sum += (drawn / exact - 1.0).powi(2));
    }
    let off = squares.map(|sum: f64| (sum / 2000.0).sqrt());
    // the lambdas of the last level are off by a tenth, too, which moves uncertainties by some per cent
    assert!(told < 0.02 && off.iter().all(|off| *off < told + 0.03), "{off:?} where {told} is told");
    let none = AdaptiveOptions { posterior_draws: 0, ..options };
    let bare = fit_adaptive(&contacts, &none).unwrap();
    assert!(bare.report().freedom.is_none() && bare.height_sd(0.0, 0.0).is_none());
    // the last lambdas come by traces alone: less than a tenth of a standard uncertainty
    for [x, y] in [[0.31, -0.44], [0.3, 0.3], [-0.9, 0.8]] {
        let off = (fit.at(x, y).z - whole.at(x, y).z).abs();
        assert!(off < 0.1 * whole.height_sd(x, y).unwrap(), "{off} at {x}, {y}");
    }
}

/// The level below what is told from noise: within two radii of a bump, intervals of R hold as often as they say. At its very top, where
/// R is largest, they still hold less often.
#[test]
fn one_halving_more_makes_room_for_what_noise_hides() {
    let second = |x: f64, y: f64| {
        let step = 1e-4;
        let z = |i: f64, j: f64| scratched(x + i * step, y + j * step);
        let (along, across) = ((z(1.0, 0.0) - z(-1.0, 0.0)) / 2e-4, (z(0.0, 1.0) - z(0.0, -1.0)) / 2e-4);
        let bent = |a: f64, b: f64| (a - 2.0 * z(0.0, 0.0) + b) / 1e-8;
        let mixed = (z(1.0, 1.0) - z(1.0, -1.0) - z(-1.0, 1.0) + z(-1.0, -1.0)) / 4e-8;
        let (xx, yy) = (bent(z(1.0, 0.0), z(-1.0, 0.0)), bent(z(0.0, 1.0), z(0.0, -1.0)));
        Derivatives::of_height(along, across, xx, mixed, yy).principal().unwrap().curvedness()
    };
    let (mut held, mut draw) = ([0, 0], Lcg::new(60));
    for seed in 0..20 {
        let contacts = touched(60_000, 0.002, 40 + seed, scratched);
        let places: Vec<[f64; 2]> = (0..50)
            .map(|_| {
                let (r, t) = (0.06 * draw.uniform().sqrt(), std::f64::consts::TAU * draw.uniform());
                [0.31 + r * t.cos(), -0.44 + r * t.sin()]
            })
            .collect();
        for last_halving in [false, true] {
            let fit = fit_adaptive(&contacts, &AdaptiveOptions { last_halving, ..AdaptiveOptions::default() }).unwrap();
            let holds = |[x, y]: &&[f64; 2]| {
                let found = fit.jet([*x, *y]).principal().unwrap().curvedness();
                let sd = fit.point_sds([*x, *y]).and_then(|sds| sds.curvedness).unwrap();
                (found - second(*x, *y)).abs() < 1.96 * sd
            };
            held[usize::from(last_halving)] += places.iter().filter(holds).count();
        }
    }
    // 950 of 1,000 are wanted
    assert!(held[1] > 930 && held[1] > held[0] + 50, "{held:?} of 1000");
}
