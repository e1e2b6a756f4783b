//! 10,000 candidates ranked, beside refitting with each of them.

use std::hint::black_box;

use palpate::explore::TouchPlanner;
use palpate::fit::{Fit, NormalSigma, Objective};
use palpate::{Contacts, FitOptions, fit_contacts};
use palpate_world::scene::linspace;

use crate::objects::{HALF, object};

/// Rankings that are timed together: the system counts a thread's time in steps of some milliseconds.
const RANKINGS: usize = 400;

/// Refits that are timed; all 10,000 would take their multiple.
const REFITS: usize = 200;

fn fitted(contacts: &Contacts, degree: usize, segments: usize) -> Fit {
    let options = FitOptions::default()
        .with_degree(degree)
        .with_segments(segments, segments)
        .with_domain([-4.5, 4.5, -4.5, 4.5])
        .with_objective(Objective::Normals(NormalSigma::Known { z: 0.02, normal_deg: 1.7 }));
    fit_contacts(contacts, &options).expect("a fit")
}

/// Milliseconds that this thread has spent on a processor: a busy machine does not blur them.
fn spent() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split(' ').next().and_then(|word| word.parse::<f64>().ok());
    nanoseconds.expect("Linux tells the time on a processor in /proc/thread-self/schedstat") * 1e-6
}

pub(crate) fn print() {
    println!(
        "\n10,000 candidates ranked by the fall of u(S), u(R); refits with each ({REFITS} timed); processor time of one thread"
    );
    println!("{:<28} {:>12} {:>14} {:>10}", "spline", "ranked, ms", "refitted, ms", "the best");
    let axis = linspace(-HALF, HALF, 100);
    let candidates: Vec<[f64; 2]> = axis.iter().flat_map(|x| axis.iter().map(move |y| [*x, *y])).collect();
    let mut world = object(3);
    world.sweeps[0].fingers = linspace(-HALF, HALF, 6);
    world.sweeps[0].stations = linspace(-HALF, HALF, 6);
    let (contacts, _) = world.compile().expect("a world").simulate(1, 0);
    for (degree, segments) in [(2, 1), (3, 1), (3, 2)] {
        let fit = fitted(&contacts, degree, segments);
        let mut planner = TouchPlanner::new(&fit).expect("a planner");
        black_box(planner.next_touches(&candidates, 1).expect("a choice"));
        let before = spent();
        for _ in 0..RANKINGS {
            black_box(planner.next_touches(&candidates, 1).expect("a choice"));
        }
        let ranked = (spent() - before) / RANKINGS as f64;
        let best = planner.next_touches(&candidates, 1).expect("a choice")[0];
        let surface = fit.input_surface().expect("a surface");
        let clock = spent();
        let mut most: Option<(f64, usize)> = None;
        // a sample that holds the chosen candidate
        for k in (0..candidates.len()).step_by(candidates.len() / REFITS).chain([best]) {
            let here = surface.at(candidates[k][0], candidates[k][1]);
            let more = with(&contacts, [candidates[k][0], candidates[k][1], here.z], [-here.zx, -here.zy, 1.0]);
            let refit = fitted(&more, degree, segments);
            let u = |fit: &Fit| [fit.shape().shape_index.u.unwrap_or(0.0), fit.shape().curvedness.u.unwrap_or(0.0)];
            let (after, before) = (u(&refit), u(&fit));
            let left = (after[0] / before[0]).powi(2) + (after[1] / before[1]).powi(2);
            if most.is_none_or(|(least, _)| left < least) {
                most = Some((left, k));
            }
        }
        let refitted = (spent() - clock) * candidates.len() as f64 / (REFITS + 1) as f64;
        let same = if most.is_some_and(|(_, k)| k == best) { "the same" } else { "another" };
        let name = format!("degree {degree}, {segments} x {segments} segments");
        println!("{name:<28} {ranked:>12.2} {refitted:>14.0} {same:>10}");
    }
}

fn with(contacts: &Contacts, point: [f64; 3], normal: [f64; 3]) -> Contacts {
    let all = (0..contacts.len()).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]).chain([point]);
    let normals = (0..contacts.len()).filter_map(|r| contacts.unit_normal(r)).chain([normal]);
    Contacts::from_points(&all.collect::<Vec<_>>()).with_normal_vectors(&normals.collect::<Vec<_>>())
}
