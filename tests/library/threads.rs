//! The bits of every answer are the same on one thread and on two.

#[path = "../../benches/workloads/mod.rs"]
#[allow(dead_code, reason = "the benches use the rest")]
mod workloads;

use palpate::montecarlo::FixedSites;
use palpate::plans::SlopePlan;
use palpate::recognition::{Recognition, RecognitionOptions};
use palpate::spline::CurvatureGrid;
use palpate::{Contacts, FitOptions, fit_contacts};
use palpate_numeric::bspline::linspace;
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

/// 200 contacts of a bump: matrices as large as those that faer cuts by the number of threads.
#[test]
fn a_recognition() -> Result<(), Fault> {
    let at = |r: usize| [(r % 20) as f64 * 0.4 - 3.8, (r / 20) as f64 * 0.8 - 3.6];
    let height = |[x, y]: [f64; 2]| 2.0 * (-(x * x + y * y) / 32.0).exp();
    let (x, y): (Vec<f64>, Vec<f64>) = (0..200).map(|r| (at(r)[0], at(r)[1])).unzip();
    let noise = |r: usize| 0.005 * ((r * 7919) as f64).sin();
    let z = (0..200).map(|r| height(at(r)) + noise(r)).collect();
    let slope = |r: usize, k: usize| height(at(r)) * at(r)[k] / 16.0 + noise(r + 200 * (k + 1));
    let [nx, ny] = [0, 1].map(|k| (0..200).map(|r| slope(r, k)).collect());
    let contacts = Contacts::from_positions(x, y, z).with_normals(nx, ny, vec![1.0; 200]);
    same(|| {
        let found = Recognition::of(&contacts, &RecognitionOptions::default())?;
        let mut answer: Vec<f64> = found.tried.iter().flat_map(|t| [t.weight, t.k1, t.k2, t.rms]).collect();
        for estimate in found.shape_index.into_iter().chain([found.curvedness]) {
            answer.extend([estimate.mean, estimate.u, estimate.interval[0], estimate.interval[1]]);
        }
        answer.extend(found.map.iter().map(|point| point.k1));
        Ok(answer)
    })
}
