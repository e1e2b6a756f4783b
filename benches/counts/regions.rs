//! What is counted: one run of each workload, set-up outside, everything on one thread.

use std::hint::black_box;

use palpate::fit::{Fit, Objective, SlopeWeights};
use palpate::montecarlo::FixedSites;
use palpate::plans::{ImagePlan, SlopePlan};
use palpate::spline::CurvatureGrid;
use palpate::{Contacts, FitOptions, fit_contacts};
use palpate_numeric::bspline::linspace;

use crate::workloads::{Fault, bicubic, image, image_knots, paper, paper_knots, paper_points, scattered, square_knots};

/// One workload, ready to run as often as asked.
pub(crate) type Run = Box<dyn FnMut() -> Result<(), Fault> + Send>;

/// Names of all workloads.
pub(crate) const NAMES: [&str; 9] = [
    "paper_fit/w1",
    "contacts/fit",
    "contacts/fit_shape",
    "contacts/fit_shape_certificate",
    "scattered_fit/w2",
    "image_fit/cold",
    "image_fit/reused",
    "noise_study/1000",
    "curvature_map/200x200",
];

/// Fits the paper's contacts with slope rows and asks for something.
fn touched(asked: fn(&Fit)) -> Run {
    let [x, y, z, zx, zy] = paper(false).0;
    let contacts = Contacts::from_positions(x, y, z).with_slopes(zx, zy);
    let options = FitOptions::default().with_objective(Objective::Slopes(SlopeWeights::Tangent));
    Box::new(move || {
        let fit = fit_contacts(&contacts, &options)?;
        asked(&fit);
        Ok(())
    })
}

/// Sets the workload up; its first run fills the buffers.
pub(crate) fn prepare(name: &str) -> Result<Run, Fault> {
    let mut run: Run = match name {
        "paper_fit/w1" => {
            let (columns, points) = (paper(false), paper_points());
            let mut plan = SlopePlan::new(paper_knots()?, [1.0, 2.0, 2.0])?;
            let mut grid = CurvatureGrid::new(&paper_knots()?, &points, &points);
            let (mut s, mut r) = ([0.0; 64], [0.0; 64]);
            Box::new(move || {
                grid.maps(plan.fit(&columns.view())?, &mut s, &mut r);
                Ok(())
            })
        }
        // 36 contacts by the public call; what shape and certificate add is the difference of two rows
        "contacts/fit" => touched(|_| ()),
        "contacts/fit_shape" => touched(|fit| {
            black_box(fit.shape());
        }),
        "contacts/fit_shape_certificate" => touched(|fit| {
            black_box(fit.shape());
            black_box(fit.certificate());
        }),
        "scattered_fit/w2" => {
            let (columns, knots) = (scattered(200_000), square_knots(3, 64, 0.0, 1.0)?);
            let mut plan = SlopePlan::new(knots, [1.0; 3])?;
            Box::new(move || {
                plan.fit(&columns.view())?;
                Ok(())
            })
        }
        "image_fit/cold" => {
            let ([x, y], [z, zx, zy]) = image();
            let knots = image_knots()?;
            Box::new(move || {
                ImagePlan::new(knots.clone(), &x, &y, [1.0; 3])?.fit_frame(&z, &zx, &zy)?;
                Ok(())
            })
        }
        "image_fit/reused" => {
            let ([x, y], [z, zx, zy]) = image();
            let mut plan = ImagePlan::new(image_knots()?, &x, &y, [1.0; 3])?;
            Box::new(move || {
                plan.fit_frame(&z, &zx, &zy)?;
                Ok(())
            })
        }
        "noise_study/1000" => {
            let (columns, points, knots) = (paper(true), paper_points(), paper_knots()?);
            let sigma = [0.02, 0.05, 0.05];
            let sites = FixedSites::new(&knots, &columns.view(), [1.0, 2.0, 2.0], sigma, [&points, &points])?;
            let (mut s, mut r) = (vec![0.0; 1000], vec![0.0; 1000]);
            Box::new(move || {
                sites.replicates(2026, 0, &mut s, &mut r);
                Ok(())
            })
        }
        "curvature_map/200x200" => {
            let (knots, points) = (square_knots(3, 64, 0.0, 1.0)?, linspace(0.0, 1.0, 200));
            let c = bicubic(&knots);
            let mut grid = CurvatureGrid::new(&knots, &points, &points);
            let (mut s, mut r) = (vec![0.0; 40_000], vec![0.0; 40_000]);
            Box::new(move || {
                grid.maps(&c, &mut s, &mut r);
                Ok(())
            })
        }
        other => return Err(format!("no workload {other}").into()),
    };
    run()?;
    Ok(run)
}
