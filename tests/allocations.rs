//! Repeated fits ask for no memory: every allocation of this process is counted, on whatever thread it happens.
//!
//! One test, in a binary of its own, so that nothing else allocates meanwhile.

#[path = "../benches/workloads/mod.rs"]
#[allow(dead_code, reason = "the benches use the rest")]
mod workloads;

use std::alloc::System;

use palpate::explore::TouchPlanner;
use palpate::fit::{Objective, SlopeWeights};
use palpate::parts::{PartsOptions, PointShapes};
use palpate::plans::{ImagePlan, SlopePlan, TouchStream};
use palpate::spline::CurvatureGrid;
use palpate::{Contacts, FitOptions, fit_contacts};
use palpate_numeric::bspline::linspace;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use workloads::{Fault, image, image_knots, paper, paper_knots, paper_points, pool, scattered, square_knots};

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Allocations and reallocations of the second and third of three runs.
fn repeated(mut run: impl FnMut() -> Result<(), Fault>) -> Result<usize, Fault> {
    run()?;
    let region = Region::new(COUNTED);
    run()?;
    run()?;
    let change = region.change();
    Ok(change.allocations + change.reallocations)
}

#[test]
fn what_was_planned_allocates_nothing() -> Result<(), Fault> {
    let counts = repeated(|| {
        std::hint::black_box(vec![0_u8; 100]);
        Ok(())
    })?;
    assert!(counts >= 2, "the counter does not count");
    pool(1)?.install(|| {
        for (columns, knots, points) in [
            (paper(false), paper_knots()?, paper_points()),
            (scattered(20_000), square_knots(3, 24, 0.0, 1.0)?, linspace(0.0, 1.0, 100)),
        ] {
            let mut plan = SlopePlan::new(knots.clone(), [1.0, 2.0, 2.0])?;
            let mut grid = CurvatureGrid::new(&knots, &points, &points);
            let count = points.len() * points.len();
            let (mut s, mut r) = (vec![0.0; count], vec![0.0; count]);
            let found = repeated(|| {
                grid.maps(plan.fit(&columns.view())?, &mut s, &mut r);
                Ok(())
            })?;
            assert_eq!(found, 0, "{} contacts: fit and maps", columns.0[0].len());
        }
        let ([x, y], [z, zx, zy]) = image();
        let mut plan = ImagePlan::new(image_knots()?, &x, &y, [1.0; 3])?;
        let found = repeated(|| {
            plan.fit_frame(&z, &zx, &zy)?;
            Ok(())
        })?;
        assert_eq!(found, 0, "a frame of a stream");
        let (columns, points) = (paper(false), paper_points());
        let mut stream = TouchStream::new(paper_knots()?, [0.02, 0.05, 0.05], [&points, &points])?;
        let [x, y, z, zx, zy] = &columns.0;
        let found = repeated(|| {
            (0..36).try_for_each(|r| stream.push([x[r], y[r]], z[r], [zx[r], zy[r]]))?;
            stream.shape()?;
            Ok(())
        })?;
        assert_eq!(found, 0, "touch by touch");
        let contacts = Contacts::from_positions(x.clone(), y.clone(), z.clone()).with_slopes(zx.clone(), zy.clone());
        let fit =
            fit_contacts(&contacts, &FitOptions::default().with_objective(Objective::Slopes(SlopeWeights::Auto)))?;
        let mut planner = TouchPlanner::new(&fit)?;
        let candidates: Vec<[f64; 2]> = points.iter().flat_map(|x| points.iter().map(|y| [*x, *y])).collect();
        let found = repeated(|| {
            planner.next_touches(&candidates, 3)?;
            Ok(())
        })?;
        assert_eq!(found, 0, "planned touches");
        shapes_at_points()
    })
}

/// Shape at every point of a ball: bytes and calls grow with the points and not faster.
fn shapes_at_points() -> Result<(), Fault> {
    let [few, many] = [2_000, 8_000].map(|count| {
        let golden = 2.399_963_229_728_653;
        let normals: Vec<[f64; 3]> = (0..count)
            .map(|k| {
                let z = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
                let (rho, angle) = ((1.0 - z * z).sqrt(), golden * k as f64);
                [rho * angle.cos(), rho * angle.sin(), z]
            })
            .collect();
        let contacts = Contacts::from_points(&normals).with_normal_vectors(&normals);
        let options = PartsOptions::default();
        // noise and size are asked of some 1000 points, which both clouds have
        let region = Region::new(COUNTED);
        let found = PointShapes::of(&contacts, &options).map(|found| found.neighbours);
        let change = region.change();
        (found, change.bytes_allocated as f64, change.allocations as f64)
    });
    assert_eq!(few.0, many.0, "neighbourhoods differ");
    assert!(many.1 < 4.4 * few.1, "bytes: {} of 2,000 points, {} of 8,000", few.1, many.1);
    assert!(many.2 < 4.4 * few.2, "allocations: {} of 2,000 points, {} of 8,000", few.2, many.2);
    Ok(())
}
