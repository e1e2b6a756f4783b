//! Which fits have noise levels that are averaged over, which correlations are tried, and the small rules beside the posterior.

use crate::fit::noise::fingers::Fingers;
use crate::fit::noise::ratios::{Known, Ratios};
use crate::fit::noise::row_sums::DenseRows;
use crate::fit::noise::variance_ratio_posterior::by_brute_force::bowl;
use crate::fit::noise::variance_ratio_posterior::{Levels, STRONGER, TYPICAL, WEAKER, stride, student, units};
use crate::fit::{Fit, FitOptions, Objective, SlopeWeights, Smooth, fit_contacts};
use palpate_geometry::contact::{ContactWeights, Contacts};
use palpate_numeric::linalg::{RowWeights, SiteWeights, Sites};

fn fitted(contacts: &Contacts, degree: [usize; 2], segments: usize) -> Fit {
    let objective = Objective::Slopes(SlopeWeights::Tangent);
    let options = FitOptions { degree, segments: [segments; 2], ..FitOptions::default().with_objective(objective) };
    fit_contacts(contacts, &options).unwrap()
}

fn has_levels(fit: &Fit, fingers: Option<Fingers>, are_known: bool) -> bool {
    Levels::new(fit.equations(), fit.solution(), fingers, are_known).is_some()
}

fn alone(x: &[f64], y: &[f64]) -> Contacts {
    let z = x.iter().map(|x| 0.1 * (7.0 * x).sin()).collect();
    let slope = |k: f64| x.iter().zip(y).map(|(x, y)| 0.1 * (k * x + 3.0 * y).cos()).collect::<Vec<f64>>();
    Contacts::from_positions(x.to_vec(), y.to_vec(), z).with_slopes(slope(5.0), slope(9.0))
}

#[test]
fn levels_need_five_degrees_of_freedom_few_contacts_and_few_unknowns() {
    // three contacts have nine rows: five more than a bilinear patch has unknowns, three more than one of degrees 2 and 1
    let three = alone(&[-1.0, 1.0, 0.2], &[-1.0, 0.1, 1.0]);
    assert!(has_levels(&fitted(&three, [1, 1], 1), None, false));
    let seven = alone(&[-1.0, 1.0, 0.2, -0.4, 0.7, 0.1, -0.8], &[-1.0, 0.1, 1.0, 0.3, -0.8, -0.2, 0.9]);
    let bare = Contacts { orientation: palpate_geometry::contact::Orientation::None, ..seven.clone() };
    assert!(has_levels(&fitted(&seven, [2, 1], 1), None, false));
    assert!(!has_levels(&fitted(&three, [2, 1], 1), None, false));
    // one kind of rows without fingers, and sds that are known, leave nothing open
    assert!(!has_levels(&fitted(&bare, [1, 1], 1), None, false));
    assert!(!has_levels(&fitted(&seven, [1, 1], 1), None, true));
    let no_heights = ContactWeights { z: Some(vec![0.0; 7]), ..ContactWeights::default() };
    assert!(!has_levels(&fitted(&Contacts { weights: no_heights, ..seven }, [1, 1], 1), None, false));
    for (n, segments, has) in [(12, 8, true), (12, 9, false), (14, 1, true), (15, 1, false)] {
        let contacts = Contacts { finger: None, ..bowl(n, [0.01, 0.03], 0.0, 1) };
        assert_eq!(has_levels(&fitted(&contacts, [2, 2], segments), None, false), has, "{n} {segments}");
    }
    let contacts = bowl(6, [0.01, 0.03], 0.0, 1);
    let smooth = FitOptions { smooth: Smooth::Lambda(1e-3), ..FitOptions::default() };
    let smoothed = fit_contacts(&contacts, &smooth.with_objective(Objective::Slopes(SlopeWeights::Tangent))).unwrap();
    assert!(!has_levels(&smoothed, None, false));
}

/// Of many contacts only evident correlations are looked into, and none where that takes long.
#[test]
fn fingers_of_many_contacts_count_where_their_correlation_is_evident() {
    for (n, drift, segments, has) in [(15, 0.9, 1, true), (15, 0.0, 1, false), (45, 0.95, 8, false), (5, 0.0, 1, true)]
    {
        let contacts = bowl(n, [0.01, 0.03], drift, 2);
        let fit = fitted(&contacts, [2, 2], segments);
        assert_eq!(has_levels(&fit, Fingers::of(&contacts, None), true), has, "{n} {drift} {segments}");
    }
    // fingers without heights share nothing
    let contacts = bowl(5, [0.01, 0.03], 0.9, 2);
    let no_heights = ContactWeights { z: Some(vec![0.0; 25]), ..ContactWeights::default() };
    let fingers = Fingers::of(&contacts, None);
    assert!(!has_levels(&fitted(&Contacts { weights: no_heights, ..contacts }, [2, 2], 1), fingers, false));
}

/// The typical correlation first; the others only where it is not behind none by 2, and on either side as long as they are not
/// hopeless.
#[test]
fn the_correlations_that_are_tried_are_those_that_may_matter() {
    let (mut left_out, mut cut_short, mut whole) = (0, 0, 0);
    for (n, drift) in [(5, 0.0), (5, 0.9), (8, 0.9), (8, 0.6), (10, 0.95), (12, 0.99), (12, 0.0)] {
        for seed in 0..4 {
            let contacts = bowl(n, [0.01, 0.03], drift, seed);
            let fit = fitted(&contacts, [2, 2], 1);
            let (equations, fingers) = (fit.equations(), Fingers::of(&contacts, None).unwrap());
            let levels = Levels::new(equations, fit.solution(), Some(fingers.clone()), false).unwrap();
            let sites = contacts.len();
            let dense = DenseRows::new(equations, &equations.residuals(&fit.solution().coefficients));
            let rows = [sites as f64, 2.0 * sites as f64];
            let evidence = |correlations| {
                let sums = dense.sums(&fingers, correlations, units(&equations.row_weights, sites), rows);
                Ratios::new(&sums, levels.freedom, Known::Nothing, stride(sites)).unwrap().log_evidence
            };
            let white = evidence([0.0; 2]);
            let (mut expected, mut best) = (vec![[0.0; 2]], white);
            for of_slopes in [0.0, 1.0] {
                let typical = evidence([TYPICAL, of_slopes * TYPICAL]);
                expected.push([TYPICAL, of_slopes * TYPICAL]);
                if typical < white - 2.0 {
                    left_out += 1;
                    continue;
                }
                best = f64::max(best, typical);
                for side in [STRONGER, WEAKER] {
                    let tried = side.iter().scan((typical, false), |(last, ended), &rho| {
                        let here = evidence([rho, of_slopes * rho]);
                        let was = std::mem::replace(ended, *ended || (here < best - 6.0 && here < *last));
                        best = if *ended { best } else { best.max(here) };
                        *last = here;
                        (!was).then_some([rho, of_slopes * rho])
                    });
                    let tried: Vec<[f64; 2]> = tried.collect();
                    if tried.len() < side.len() {
                        cut_short += 1
                    } else {
                        whole += 1
                    }
                    expected.extend(tried);
                }
            }
            let mut found: Vec<[f64; 2]> = levels.sets.iter().map(|set| set.correlations).collect();
            // in which order they are tried is nobody's business but that of the first
            found.sort_by(|a, b| a.partial_cmp(b).unwrap());
            expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
            assert_eq!(found, expected, "{n} {drift} {seed}");
        }
    }
    assert!(left_out > 2 && cut_short > 2 && whole > 2, "{left_out} {cut_short} {whole}");
}

#[test]
fn steps_of_the_ratio_grow_with_the_sd_of_its_posterior() {
    assert_eq!([1, 9, 16, 50, 200, 2000].map(stride), [8, 7, 5, 3, 1, 1]);
    assert_eq!(stride(0), 8);
}

/// Means of squares of the rows that there are, the two slopes of a contact counted once.
#[test]
fn units_bring_the_weights_to_the_usual_ratio() {
    let of = |z, a, b, d| SiteWeights { z, a, b, d };
    let weights = RowWeights::PerSite(vec![of(1.0, 1.0, 0.5, 2.0), of(3.0, 2.0, 0.0, 1.0), of(0.0, 0.0, 0.0, 0.0)]);
    let [z, slope] = units(&weights, 3);
    // 1/5 over the square of 0.1, and 1/(5.125/2)
    assert!((z - 20.0).abs() < 1e-12 && (slope - 2.0 / 5.125).abs() < 1e-12, "{z} {slope}");
    assert_eq!(units(&RowWeights::Uniform(of(0.0, 1.0, 0.0, 1.0)), 4), [1.0 / (0.1 * 0.1), 1.0]);
}

/// A law of Student gives its own scale and degrees of freedom back, and data with fewer of them theirs.
#[test]
fn the_law_of_two_moments_is_that_of_student() {
    let moments = |u: f64, dof: f64| {
        let second = u * u * dof / (dof - 2.0);
        [second, 3.0 * second * second * (dof - 2.0) / (dof - 4.0)]
    };
    let [u, dof] = student(moments(0.3, 9.0), 40.0);
    assert!((u - 0.3).abs() < 1e-12 && (dof - 9.0).abs() < 1e-9, "{u} {dof}");
    let [u, dof] = student(moments(0.3, 9.0), 7.0);
    assert!((u * u * 7.0 / 5.0 - moments(0.3, 9.0)[0]).abs() < 1e-12 && dof == 7.0, "{u} {dof}");
    assert_eq!(student([0.25, 3.0 * 0.0625], f64::INFINITY), [0.5, f64::INFINITY]);
    // lighter tails than the normal law's
    assert_eq!(student([2.0, 8.0], 10.0), [1.6_f64.sqrt(), 10.0]);
    assert_eq!(student([0.0, 0.0], 10.0), [0.0, f64::INFINITY]);
}

/// A finger's name changes nothing where every finger touches once.
#[test]
fn fingers_of_single_touches_share_nothing() {
    let contacts = bowl(4, [0.01, 0.03], 0.0, 3);
    let named = Contacts { finger: Some((0..16).collect()), ..contacts };
    assert_eq!(Fingers::of(&named, None), None);
    assert_eq!(fitted(&named, [2, 2], 1).equations().sites.len(), 16);
}
