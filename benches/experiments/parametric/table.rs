//! Without noise: the four cases at degrees 2 to 4 and one to three segments, then every angle of cylinders.

use palpate::fit::{NormalSigma, Objective, Smooth};

use crate::worlds::{self, Case, cylinder, sphere};

pub(crate) fn print() {
    println!("noise-free, sigma 0.02 and 0.03 rad declared, lambda 30; S and R r at the contacts");
    println!(
        "{:<26} {:>6} {:>4}   {:<26} {:<30} grid: S, R r, support",
        "case", "degree", "segs", "height field", "parametric"
    );
    for case in [sphere(5.7), sphere(6.0), cylinder(5.7, 45.0), cylinder(6.0, 45.0)] {
        for degree in 2..=4 {
            for segments in 1..=4 {
                line(&case, degree, segments);
            }
        }
    }
    println!("\nnoise 0.02 and 0.03 rad, several segments: worst of 10 replicates, lambda as given");
    for smooth in [Smooth::None, Smooth::Lambda(30.0), Smooth::Lambda(0.0)] {
        for segments in 1..=4 {
            runaways(segments, smooth);
        }
    }
    println!("\ncylinders at every angle, degree 3, one segment: worst |S - 0.5| and |R r - 0.7071|");
    for radius in [5.7, 6.0, 10.0] {
        let (mut worst_s, mut worst_r) = (0.0_f64, 0.0_f64);
        for angle in (0..=90).step_by(5) {
            let contacts = worlds::world(&cylinder(radius, f64::from(angle)), false).noise_free();
            match worlds::parametric(&contacts, &worlds::options(3, 1)) {
                Ok(fit) => {
                    let [s, _, r] = worlds::at_contacts(&fit, radius);
                    (worst_s, worst_r) = (worst_s.max((s - 0.5).abs()), worst_r.max((r - 0.5_f64.sqrt()).abs()));
                }
                Err(error) => println!("  r = {radius} at {angle}: {error}"),
            }
        }
        println!("  r = {radius:<4}  {worst_s:.5}  {worst_r:.5}");
    }
}

/// What a thin or an estimated fairness makes of the 5.7 ball: what is answered must be near it.
fn runaways(segments: usize, smooth: Smooth) {
    let world = worlds::world(&sphere(5.7), true);
    let auto = Objective::Normals(NormalSigma::Auto);
    let declared = worlds::options(3, segments);
    for (name, objective) in [("sigma declared", declared.objective), ("sigma auto", auto)] {
        let options = declared.clone().with_smooth(smooth).with_objective(objective);
        let (mut refused, mut raised, mut most, mut least_s, mut worst_r) = (0, 0, 0.0_f64, 1.0_f64, 0.0_f64);
        let clock = std::time::Instant::now();
        for replicate in 0..10 {
            match worlds::parametric(&world.simulate(worlds::SEED, replicate).0, &options) {
                Ok(fit) => {
                    let [s, _, r] = worlds::at_contacts(&fit, 5.7);
                    (least_s, worst_r) = (least_s.min(s), worst_r.max((r - 1.0).abs()));
                    most = most.max(fit.certificate().bending);
                    raised += usize::from(fit.certificate().fairness_raised > 0);
                }
                Err(_) => refused += 1,
            }
        }
        println!(
            "  {segments} segments, {smooth:?}, {name}: least S {least_s:.3}, worst R r off by {worst_r:.3}, bends {most:.2} at most; fairness raised in {raised}, refused {refused}; {:.1} ms a fit",
            100.0 * clock.elapsed().as_secs_f64()
        );
    }
}

fn line(case: &Case, degree: usize, segments: usize) {
    let contacts = worlds::world(case, false).noise_free();
    let options = worlds::options(degree, segments);
    let text = |[s, sd, r]: [f64; 3]| format!("{s:.4} +- {sd:.4}  {r:.4}");
    let height = match worlds::height(&contacts, &options) {
        Ok(fit) => text(worlds::height_at_contacts(&fit, &contacts, case.radius)),
        Err(_) => "refused".into(),
    };
    let clock = std::time::Instant::now();
    match worlds::parametric(&contacts, &options) {
        Ok(fit) => {
            let seconds = clock.elapsed().as_secs_f64();
            let own = text(worlds::at_contacts(&fit, case.radius));
            let shape = fit.shape();
            let (s, r) = (shape.shape_index.mean.unwrap_or(f64::NAN), shape.curvedness.mean.unwrap_or(f64::NAN));
            let c = fit.certificate();
            println!(
                "{:<26} {degree:>6} {segments:>4}   {height:<26} {own:<30} {s:.4} {:.4} {:.2}   {} steps, {} folds refused, fold-free {}, bends {:.2}, settled {}, {:.2} ms",
                case.name,
                r * case.radius,
                shape.support,
                c.iterations,
                c.folds_refused,
                c.fold_free,
                c.bending,
                c.settled,
                1e3 * seconds
            );
        }
        Err(error) => println!("{:<26} {degree:>6} {segments:>4}   {height:<26} {error}", case.name),
    }
}
