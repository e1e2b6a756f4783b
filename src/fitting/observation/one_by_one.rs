//! Grids and groups of sites against the same sites, visited one by one.

use palpate_numeric::bspline::{Knots, linspace};
use palpate_numeric::linalg::{
    KEPT, RowWeights, SiteGroups, SiteRows, SiteWeights, Sites, StencilMatrix, Targets, apply_rows, assemble, descent,
    normal_rhs, residuals, visit_values,
};

use palpate_numeric::simd::{CellSites, SITES, SiteLanes};

use super::single_sites::Single;
use super::{GridSites, ScatteredSites};

#[test]
fn sums_along_rows_and_single_pixels_give_the_same_matrix() {
    for degree in [[2, 2], [3, 3], [2, 3], [4, 4], [5, 1]] {
        let knots = [Knots::uniform(degree[0], 4, 0.0, 1.0).unwrap(), Knots::uniform(degree[1], 3, -1.0, 1.0).unwrap()];
        let sites = GridSites::new(knots, &linspace(0.0, 1.0, 31), &linspace(-1.0, 1.0, 23));
        let weight = |r: usize, k: f64| if r.is_multiple_of(7) { 0.0 } else { 1.0 + (r as f64 * k).sin() };
        let of = |r: usize| SiteWeights { z: weight(r, 0.3), a: weight(r, 0.7), b: 0.0, d: weight(r, 1.1) };
        let weights = RowWeights::PerSite((0..sites.len()).map(of).collect());
        let (mut fast, mut slow) = (StencilMatrix::zeros(sites.shape()), StencilMatrix::zeros(sites.shape()));
        assemble(&sites, &weights, &mut fast);
        assemble(&Single(sites), &weights, &mut slow);
        let largest = slow.values().iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (a, b) in fast.values().iter().zip(slow.values()) {
            assert!((a - b).abs() < 1e-13 * largest, "{degree:?}");
        }
    }
}

/// Row by row and pixel by pixel: every product has the same bits, in the same order.
#[test]
fn rows_of_a_grid_have_the_bits_of_single_pixels() {
    for degree in [[1, 1], [2, 2], [3, 3], [2, 3], [4, 4], [6, 5]] {
        let knots = [Knots::uniform(degree[0], 5, 0.0, 1.0).unwrap(), Knots::uniform(degree[1], 2, -1.0, 1.0).unwrap()];
        let sites = GridSites::new(knots, &linspace(0.0, 1.0, 29), &linspace(-1.0, 1.0, 37));
        let single = Single(sites.clone());
        let value = |r: usize, k: f64| (r as f64 * k).sin();
        let c: Vec<f64> = (0..sites.shape().unknowns()).map(|u| value(u, 0.77)).collect();
        let targets: Targets = (0..sites.len()).map(|r| [value(r, 0.3), value(r, 0.5), value(r, 0.9)]).collect();
        let of = |r: usize| SiteWeights { z: value(r, 1.3), a: value(r, 1.7), b: value(r, 0.1), d: value(r, 2.1) };
        for weights in [RowWeights::Uniform(of(1)), RowWeights::PerSite((0..sites.len()).map(of).collect())] {
            let (mut fast, mut slow) = (Targets::new(), Targets::new());
            apply_rows(&sites, &weights, &c, &mut fast);
            apply_rows(&single, &weights, &c, &mut slow);
            assert_eq!(fast, slow, "{degree:?}");
            residuals(&sites, &weights, &targets, &c, &mut fast);
            residuals(&single, &weights, &targets, &c, &mut slow);
            assert_eq!(fast, slow, "{degree:?}");
            let (mut fast, mut slow) = (vec![0.0; c.len()], vec![0.0; c.len()]);
            descent(&sites, &weights, &targets, &c, &mut fast);
            descent(&single, &weights, &targets, &c, &mut slow);
            assert_eq!(fast, slow, "{degree:?}");
            normal_rhs(&sites, &weights, &targets, &mut fast);
            normal_rhs(&single, &weights, &targets, &mut slow);
            assert_eq!(fast, slow, "{degree:?}");
        }
        type Visit<'a> = &'a mut dyn FnMut(usize, [f64; 3]);
        let visited = |sites: &dyn Fn(Visit)| {
            let mut all = Vec::new();
            sites(&mut |r, values| all.push((r, values)));
            all
        };
        let fast = visited(&|f| visit_values(&sites, &c, f));
        assert_eq!(fast, visited(&|f| visit_values(&single, &c, f)));
    }
}

#[test]
fn groups_hold_every_site_in_order() {
    for count in [0, 1, 8, 37, KEPT + 3] {
        let knots = [Knots::uniform(2, 3, 0.0, 1.0).unwrap(), Knots::uniform(3, 2, 0.0, 1.0).unwrap()];
        // the first cells are left empty
        let place = |k: usize| [0.4 + 0.6 * (k as f64 * 0.618).fract(), (k as f64 * 0.414).fract()];
        let sites = ScatteredSites::new(knots, (0..count).map(place).collect());
        compare(&sites);
        compare(&Single(sites));
    }
}

/// Every site appears once, in the order of the plain visit and with its numbers, at the first visit and at the next.
fn compare(sites: &impl Sites) {
    let count = sites.len();
    let weights_of = |k: usize| SiteWeights { z: 1.0 + k as f64, a: 2.0, b: 3.0, d: 4.0 };
    let row_weights = RowWeights::PerSite((0..count).map(weights_of).collect());
    let targets: Vec<[f64; 3]> = (0..count).map(|k| [k as f64, -1.0, k as f64 + 0.5]).collect();
    let rows = SiteRows { sites, row_weights: &row_weights, targets: &targets };
    let mut expected = Vec::new();
    sites.visit(|s| expected.push((s.index, s.first, s.x.to_vec(), s.dx.to_vec(), s.y.to_vec(), s.dy.to_vec())));
    let mut groups = SiteGroups::new(sites);
    for _ in 0..2 {
        let mut found = Vec::new();
        groups.visit(&rows, |group| {
            let column = |rows: &[SiteLanes], l: usize| rows.iter().map(|row| row[l]).collect::<Vec<f64>>();
            let CellSites { x, y, weights } = group.sites;
            let live = (0..SITES).take_while(|l| weights[0][*l] != 0.0).count();
            for l in 0..live {
                let index = group.targets[0][l] as usize;
                let rows = (column(x[0], l), column(x[1], l), column(y[0], l), column(y[1], l));
                found.push((index, group.first, rows.0, rows.1, rows.2, rows.3));
                assert_eq!(column(weights, l), [1.0 + index as f64, 2.0, 3.0, 4.0]);
                assert_eq!(group.targets.map(|target| target[l]), targets[index]);
            }
            assert!((live..SITES).all(|l| column(weights, l) == [0.0; 4] && group.targets[0][l] == 0.0));
        });
        assert_eq!(found, expected);
    }
}
