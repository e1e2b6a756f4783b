//! Uncertainties held to their definition: all rows E written out, a dense factor of `E'E`, and closed forms of the laws.

use super::*;
use crate::fit::describe::shape_over_grid;
use crate::fit::{Fit, FitOptions, NormalSigma, Objective, SlopeWeights, fit_contacts};
use palpate_geometry::contact::Contacts;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::linalg::dot;

type Row = Vec<f64>;

/// The rows of a fit by sites, heights and two of slopes each.
fn rows_of(fit: &Fit) -> Vec<[Row; 3]> {
    let equations = fit.equations();
    let unknowns = equations.unknowns();
    let bare = equations.residuals(&vec![0.0; unknowns]);
    let columns: Vec<Targets> = (0..unknowns)
        .map(|j| equations.residuals(&(0..unknowns).map(|k| f64::from(u8::from(k == j))).collect::<Vec<f64>>()))
        .collect();
    (0..bare.len()).map(|r| [0, 1, 2].map(|k| columns.iter().map(|c| bare[r][k] - c[r][k]).collect())).collect()
}

/// `(E'E)^-1 g` by elimination.
fn solved_by(rows: &[[Row; 3]], g: &[f64]) -> Vec<f64> {
    let n = g.len();
    let mut a = vec![vec![0.0; n + 1]; n];
    for row in rows.iter().flatten() {
        for i in 0..n {
            (0..n).for_each(|j| a[i][j] += row[i] * row[j]);
        }
    }
    (0..n).for_each(|i| a[i][n] = g[i]);
    for k in 0..n {
        let pivot = a[k].clone();
        for row in a.iter_mut().skip(k + 1) {
            let factor = row[k] / pivot[k];
            (k..=n).for_each(|j| row[j] -= factor * pivot[j]);
        }
    }
    let mut out = vec![0.0; n];
    for k in (0..n).rev() {
        out[k] = (a[k][n] - (k + 1..n).map(|j| a[k][j] * out[j]).sum::<f64>()) / a[k][k];
    }
    out
}

/// A surface `z = (px^2 + qy^2)/2` touched 6 x 6 times over [-size, size]^2, with slopes.
fn touched(p: f64, q: f64, sds: [f64; 2], size: f64, seed: u64) -> Contacts {
    let mut errors = vec![0.0; 108];
    for (block, part) in errors.chunks_mut(36).enumerate() {
        EffectDraws::new(seed, "dense").gaussians(0, block as u64, 36, part);
    }
    let place = |k: usize| size * (0.4 * k as f64 - 1.0);
    let (x, y): (Vec<f64>, Vec<f64>) = (0..36).map(|r| (place(r % 6), place(r / 6))).unzip();
    let z = (0..36).map(|r| 0.5 * (p * x[r] * x[r] + q * y[r] * y[r]) + sds[0] * errors[r]).collect();
    let zx = (0..36).map(|r| p * x[r] + sds[1] * errors[36 + r]).collect();
    let zy = (0..36).map(|r| q * y[r] + sds[1] * errors[72 + r]).collect();
    Contacts::from_positions(x, y, z).with_slopes(zx, zy)
}

fn with_normals(contacts: Contacts) -> Contacts {
    let palpate_geometry::contact::Orientation::Slopes { zx, zy } = contacts.orientation.clone() else {
        panic!("no slopes")
    };
    let normals: Vec<[f64; 3]> = zx.iter().zip(&zy).map(|(a, b)| [-a, -b, 1.0]).collect();
    contacts.with_normal_vectors(&normals)
}

fn fitted(contacts: &Contacts, objective: Objective) -> Fit {
    fit_contacts(contacts, &FitOptions::default().with_objective(objective)).unwrap()
}

fn declared(sds: [f64; 2]) -> Objective {
    Objective::Normals(NormalSigma::Known { z: sds[0], normal_deg: sds[1].to_degrees() })
}

fn gradient(unknowns: usize, from: f64) -> Vec<f64> {
    (0..unknowns).map(|k| from + (3.0 * k as f64).sin()).collect()
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-8 * expected.abs(), "{found} instead of {expected}");
}

const TANGENT: Objective = Objective::Slopes(SlopeWeights::Tangent);

/// `|E_b (E'E)^-1 g|^2` of heights and of slopes.
fn shares(rows: &[[Row; 3]], g: &[f64]) -> [f64; 2] {
    let v = solved_by(rows, g);
    rows.iter().fold([0.0; 2], |sum, [z, p, q]| {
        [sum[0] + dot(z, &v).powi(2), sum[1] + dot(p, &v).powi(2) + dot(q, &v).powi(2)]
    })
}

#[test]
fn declared_noise_spreads_by_the_dense_inverse() {
    let fit = fitted(&with_normals(touched(0.3, 0.1, [0.01, 0.03], 1.0, 1)), declared([0.01, 0.03]));
    let (rows, g) = (rows_of(&fit), gradient(9, 0.3));
    near(standard_uncertainty(&fit.solved, &g).powi(2), dot(&g, &solved_by(&rows, &g)));
    let [heights, normals] = shares(&rows, &g);
    let part = of_mean(&fit.solved, &g, [2.0, 3.0]).unwrap();
    near(part.u * part.u, 4.0 * heights + 9.0 * normals);
    assert_eq!((part.dof, above_declared(&fit.solved)), (f64::INFINITY, [1.0; 2]));
    // sds that are declared too small are enlarged, those too large are not made smaller
    let small = fitted(&with_normals(touched(0.3, 0.1, [0.01, 0.03], 1.0, 1)), declared([0.004, 0.09]));
    let [heights, normals] = above_declared(&small.solved);
    assert!((1.8..3.2).contains(&heights) && normals == 1.0, "{heights} {normals}");
}

#[test]
fn the_covariance_of_two_functionals_is_that_of_the_dense_inverse() {
    let fit = fitted(&with_normals(touched(0.3, 0.1, [0.01, 0.03], 1.0, 1)), declared([0.01, 0.03]));
    let (rows, g, h) = (rows_of(&fit), gradient(9, 0.3), gradient(9, -0.5));
    let expected = dot(&h, &solved_by(&rows, &g));
    let found = covariance(&fit.solved, [&g, &h]).unwrap();
    assert!((found - expected).abs() < 1e-9 * expected.abs().max(dot(&g, &solved_by(&rows, &g))), "{found} {expected}");
    near(covariance(&fit.solved, [&g, &g]).unwrap(), dot(&g, &solved_by(&rows, &g)));
    assert_eq!(covariance(&fit.solved, [&g, &[0.0; 9]]), None);
    assert_eq!(covariance(&fit.solved, [&[0.0; 9], &g]), None);
    // by the rows, and by matrices that were assembled of them
    let equations = &fit.solved.fitted.equations;
    for equations in [equations, &equations.clone().assembled_once()] {
        let found = noise_at_point(&fit.solved, equations, &g, [1.0; 2]).unwrap();
        near(found * found, dot(&g, &solved_by(&rows, &g)));
    }
}

/// Weights that are not inverse sds: variances of the residuals in their place, and degrees of freedom of both together.
#[test]
fn weighted_rows_spread_by_the_variances_of_their_residuals() {
    let fit = fitted(&touched(0.3, 0.1, [0.02, 0.01], 1.0, 2), TANGENT);
    let (rows, g) = (rows_of(&fit), gradient(9, 0.3));
    let residuals = fit.equations().residuals(&fit.solution().coefficients);
    let unit = |u: usize| (0..9).map(|k| f64::from(u8::from(k == u))).collect::<Vec<f64>>();
    let mut of_heights = 36.0;
    for u in 0..9 {
        let v = solved_by(&rows, &unit(u));
        of_heights -= rows.iter().map(|row| row[0][u] * dot(&row[0], &v)).sum::<f64>();
    }
    let dof = [of_heights, 108.0 - 9.0 - of_heights];
    let squares = residuals.iter().fold([0.0; 2], |s, r| [s[0] + r[0] * r[0], s[1] + r[1] * r[1] + r[2] * r[2]]);
    let shares = shares(&rows, &g);
    let parts = [0, 1].map(|b| squares[b] / dof[b] * shares[b]);
    let part = of_mean(&fit.solved, &g, [1.0; 2]).unwrap();
    near(part.u * part.u, parts[0] + parts[1]);
    let total = parts[0] + parts[1];
    near(part.dof, total * total / (parts[0] * parts[0] / dof[0] + parts[1] * parts[1] / dof[1]));
}

#[test]
fn two_variances_have_the_degrees_of_freedom_of_satterthwaite() {
    near(degrees_of_freedom([3.0, 1.0], [9.0, 2.0]), 16.0 / (1.0 + 0.5));
    near(degrees_of_freedom([3.0, 0.0], [9.0, 0.0]), 9.0);
    near(degrees_of_freedom([3e-200, 1e-200], [9.0, 2.0]), 16.0 / 1.5);
    near(degrees_of_freedom([3.0, 1.0], [9.0, f64::INFINITY]), 16.0);
    assert_eq!(degrees_of_freedom([0.0, 0.0], [9.0, 2.0]), f64::INFINITY);
}

/// Errors in place are shared by the rows of a contact.
#[test]
fn errors_in_place_count_by_the_covariance_of_a_contacts_rows() {
    let contacts = touched(0.8, -0.5, [0.01, 0.03], 1.0, 3);
    // declared sds make all variances of rows 1, weights that are no inverse sds do not
    for (objective, contacts) in [(TANGENT, contacts.clone()), (declared([0.01, 0.03]), with_normals(contacts.clone()))]
    {
        let options = FitOptions::default().with_objective(objective).with_sigma_xy(0.05);
        let fit = fit_contacts(&contacts, &options).unwrap();
        let (rows, g) = (rows_of(&fit), gradient(9, 0.3));
        let v = solved_by(&rows, &g);
        let all = &fit.solved.fitted.moved.as_ref().unwrap().covariances;
        let mean = |of: &dyn Fn(&[f64; 6]) -> f64, count: f64| all.iter().map(of).sum::<f64>() / count;
        let means = [mean(&|c| c[0], 36.0), mean(&|c| c[3] + c[5], 72.0)];
        let (mut shared, mut apart) = (0.0, 0.0);
        for (row, c) in rows.iter().zip(all) {
            let e = [0, 1, 2].map(|k| dot(&row[k], &v));
            let full = [[c[0], c[1], c[2]], [c[1], c[3], c[4]], [c[2], c[4], c[5]]];
            for i in 0..3 {
                (0..3).for_each(|j| shared += e[i] * full[i][j] * e[j]);
                apart += means[usize::from(i > 0)] * e[i] * e[i];
            }
        }
        let factor = in_place(&fit.solved, &g);
        near(factor * factor, shared / apart);
        assert!((factor - 1.0).abs() > 0.01, "{factor}");
        let above = [1.5, 1.0];
        near(
            of_mean(&fit.solved, &g, above).unwrap().u,
            factor * with_rows_apart(&fit.solved, &fit.solved.fitted.equations, &g, above).unwrap().u,
        );
        assert_eq!(in_place(&fit.solved, &[0.0; 9]), 1.0);
        assert_eq!(in_place(&fitted(&contacts, objective).solved, &g), 1.0);
    }
}

/// From the noise levels where sds were estimated, beside them where fingers may share errors, and from the residuals else.
#[test]
fn the_uncertainty_comes_from_what_is_known_of_the_noise() {
    let contacts = touched(0.3, 0.1, [0.01, 0.03], 1.0, 4);
    let (g, ones) = (gradient(9, 0.3), [1.0; 2]);
    let auto = Objective::Slopes(SlopeWeights::Auto);
    let estimated = fitted(&contacts, auto);
    let part = of_mean(&estimated.solved, &g, ones).unwrap();
    assert_eq!([part.u, part.dof], estimated.solved.levels().unwrap().uncertainty(&g));
    let own = noise_part(&estimated.solved, &estimated.solved.fitted.equations, &g, ones);
    assert!(own.u != part.u);
    // a robust loss bends the law of the residuals
    let options = FitOptions::default().with_objective(auto).with_robust(Robust::Huber);
    let robust = fit_contacts(&contacts, &options).unwrap();
    let [found, own] = [
        of_mean(&robust.solved, &g, ones).unwrap(),
        noise_part(&robust.solved, &robust.solved.fitted.equations, &g, ones),
    ];
    assert_eq!([found.u, found.dof], [own.u, own.dof]);
    // named fingers widen a fit with weights and one with declared sds, by the larger of two factors
    let named = Contacts { finger: Some((0..36).map(|r| r / 6).collect()), ..contacts.clone() };
    for (fit, above) in
        [(fitted(&named, TANGENT), [1.0, 1.0]), (fitted(&with_normals(named), declared([0.01, 0.03])), [1.2, 1.7])]
    {
        let levels = fit.solved.levels().unwrap();
        assert!(levels.probability_shared() > 0.0);
        let own = noise_part(&fit.solved, &fit.solved.fitted.equations, &g, above);
        let expected = levels.beside_independent(&g, [own.u, own.dof], above[0].max(above[1]));
        let part = of_mean(&fit.solved, &g, above).unwrap();
        assert_eq!([part.u, part.dof], expected);
    }
    // nine heights on nine unknowns tell no noise, unless it was declared
    let nine: Vec<u32> = [0, 2, 5, 12, 14, 17, 30, 32, 35].to_vec();
    let bare =
        Contacts { orientation: palpate_geometry::contact::Orientation::None, ..contacts.clone() }.in_order(&nine);
    let few = fitted(&bare, TANGENT);
    assert_eq!(few.equations().count(), few.solution().rank);
    assert!(of_mean(&few.solved, &g, ones).is_none());
    let few = fitted(
        &with_normals(contacts).in_order(&nine[..3].iter().copied().chain([14, 30, 35]).collect::<Vec<u32>>()),
        declared([0.01, 0.03]),
    );
    assert!(of_mean(&few.solved, &g, ones).is_some());
}

/// Of declared noise by chi-square, of estimated noise by F, both of two degrees of freedom and so in closed form.
#[test]
fn equal_curvatures_are_rejected_by_the_law_of_two_differences() {
    let (mut equal, mut apart, mut correlation) = (0, 0, 0.0);
    for (k, objective) in [declared([0.01, 0.03]), TANGENT].into_iter().enumerate() {
        for seed in 0..24 {
            let difference = 0.0015 * f64::from(seed as u32);
            // on a triangle the two differences correlate
            let kept: Vec<u32> = (0..36).filter(|r| r % 6 + 3 * (r / 6) < 12).collect();
            let contacts = touched(0.3 + difference, 0.3 - difference, [0.01, 0.03], 1.0, seed).in_order(&kept);
            let fit = fitted(&if k == 0 { with_normals(contacts) } else { contacts }, objective);
            let middle = [0, 1].map(|k| {
                let [lo, hi] = fit.solved.patch.knots[k].domain();
                lo + 0.5 * (hi - lo)
            });
            let [(p, by_p), (q, by_q)] = umbilic_gradients(&fit.solved.surface, middle[0], middle[1]);
            let rows = rows_of(&fit);
            let noise = fit.noise();
            let [vp, vq] = [&by_p, &by_q].map(|g| solved_by(&rows, g));
            let (mut pp, mut qq, mut pq) = (0.0, 0.0, 0.0);
            for row in &rows {
                for b in 0..3 {
                    let variance = noise.row_variances[usize::from(b > 0)];
                    let [a, c] = [&vp, &vq].map(|v| dot(&row[b], v));
                    (pp, qq, pq) = (pp + variance * a * a, qq + variance * c * c, pq + variance * a * c);
                }
            }
            correlation = f64::max(correlation, (pq * pq / (pp * qq)).sqrt());
            let t = (p * p * qq - 2.0 * p * q * pq + q * q * pp) / (pp * qq - pq * pq);
            let chance = if k == 0 {
                (-0.5 * t).exp()
            } else {
                let dofs = [&by_p, &by_q].map(|g| of_mean(&fit.solved, g, [1.0; 2]).unwrap().dof);
                let dof = dofs[0].min(dofs[1]);
                (1.0 + t / dof).powf(-0.5 * dof)
            };
            assert_eq!(may_be_umbilic(&fit.solved, [1.0; 2]), chance > 0.05, "{seed}: {chance}");
            if chance > 0.05 { equal += 1 } else { apart += 1 }
        }
    }
    assert!(equal > 10 && apart > 10 && correlation > 0.1, "{equal} {apart} {correlation}");
}

/// Input units, bounds of S, and the end that S has to reach.
#[test]
fn means_have_uncertainties_in_input_units() {
    let under = |objective: Objective, contacts: Contacts, mean: Option<f64>| {
        let fit = fitted(&contacts, objective);
        let maps = shape_over_grid(&fit.solved);
        let found = Uncertainties::new(&fit.solved, &maps, mean);
        let means = mean_gradients(&fit.solved.surface, &maps, &GridGradients::new(&fit.solved.surface, &maps.rows));
        let [s, r] = [&means.shape_index, &means.curvedness].map(|g| of_mean(&fit.solved, g, [1.0; 2]).unwrap().u);
        near(found.of_shape_index.unwrap().u, s.min(1.0));
        near(found.of_curvedness.unwrap().u, r / fit.frame().scale);
        (found.end_of_shape_index, s, fit.frame().scale)
    };
    let of = |contacts: Contacts, mean: Option<f64>| under(TANGENT, contacts, mean);
    let ball = || touched(0.1, 0.1, [0.003, 0.003], 3.0, 1);
    let (end, _, scale) = of(ball(), Some(0.9));
    assert_eq!(end, Some(1.0));
    assert!((scale - 3.0).abs() < 1e-9, "{scale}");
    assert_eq!(of(ball(), Some(-0.7)).0, Some(-1.0));
    assert_eq!([of(ball(), Some(0.6)).0, of(ball(), Some(0.5)).0, of(ball(), None).0], [None; 3]);
    assert_eq!(of(touched(0.1, 0.04, [0.001, 0.001], 3.0, 1), Some(0.9)).0, None);
    // under errors that are declared this large S may be anything, and its uncertainty is no more than all of it
    let (_, s, _) = under(declared([3.0, 1.0]), with_normals(touched(0.02, -0.02, [0.003, 0.003], 3.0, 1)), None);
    assert!(s > 1.0, "{s}");
}
