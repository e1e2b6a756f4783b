//! The bits of every answer are the same on one thread and on two.

#[path = "../../benches/workloads/mod.rs"]
#[allow(dead_code, reason = "the benches use the rest")]
mod workloads;

use palpate::montecarlo::FixedSites;
use palpate::plans::SlopePlan;
use palpate::spline::CurvatureGrid;
use palpate::spline::linspace;
use palpate::{Contacts, FitOptions, fit_contacts};
use workloads::{Fault, paper, paper_knots, paper_points, pool, scattered, square_knots};

fn same(run: impl Fn() -> Result<Vec<f64>, Fault> + Sync) -> Result<(), Fault> {
    let bits = |threads| -> Result<Vec<u64>, Fault> {
        Ok(pool(threads)?.install(&run)?.into_iter().map(f64::to_bits).collect())
    };
    let alone = bits(1)?;
    assert!(!alone.is_empty());
    assert!(alone == bits(2)?, "two threads move a bit");
    Ok(())
}

#[test]
fn a_scattered_fit_and_its_maps() -> Result<(), Fault> {
    let (columns, knots) = (scattered(30_000), square_knots(3, 40, 0.0, 1.0)?);
    let points = linspace(0.0, 1.0, 130);
    same(|| {
        let mut answer = SlopePlan::new(knots.clone(), [1.0; 3])?.fit(&columns.view())?.to_vec();
        let (mut s, mut r) = (vec![0.0; 130 * 130], vec![0.0; 130 * 130]);
        CurvatureGrid::new(&knots, &points, &points).maps(&answer, &mut s, &mut r);
        answer.extend(s.into_iter().chain(r));
        Ok(answer)
    })
}

#[test]
fn the_public_fit_with_its_certificate() -> Result<(), Fault> {
    let [x, y, z, zx, zy] = scattered(20_000).0;
    let contacts = Contacts::from_positions(x, y, z).with_slopes(zx, zy);
    let options = FitOptions::default().with_degree(3).with_segments(20, 20);
    same(|| {
        let fit = fit_contacts(&contacts, &options)?;
        let mut answer = fit.solution().coefficients.clone();
        let shape = fit.shape();
        answer.extend([shape.shape_index.mean, shape.curvedness.mean].into_iter().flatten());
        answer.extend([fit.certificate().condition, fit.certificate().backward_error]);
        Ok(answer)
    })
}

#[test]
fn a_noise_study() -> Result<(), Fault> {
    let (columns, points) = (paper(true), paper_points());
    let sites = FixedSites::new(&paper_knots()?, &columns.view(), [1.0; 3], [0.02; 3], [&points, &points])?;
    same(|| {
        let (mut s, mut r) = (vec![0.0; 5000], vec![0.0; 5000]);
        sites.replicates(1, 0, &mut s, &mut r);
        Ok(s.into_iter().chain(r).collect())
    })
}
