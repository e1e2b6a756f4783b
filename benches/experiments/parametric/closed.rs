//! Sweeps that go round, and the half ball touched to its rim.

use palpate::Contacts;

use crate::shapes;
use crate::worlds;

pub(crate) fn print() {
    println!("\nsweeps that go round, sigma declared, lambda 30; S and R over a 16 x 16 grid");
    let ring = shapes::ring_of_bar(5.0, 4, 12);
    tell("bar r = 5, 4 fingers x 12 stations, closed v", &ring, [false, true], |_| (0.5, 0.2 * 0.5_f64.sqrt()));
    let torus = shapes::torus(8.0, 3.0, 12, 12);
    tell("ring 8, tube 3, 12 x 12, closed u and v", &torus, [true, true], |p| {
        // k1 of the ring: -cos / (distance from the axis)
        let out = p[0].hypot(p[1]);
        let (k1, k2) = (-(out - 8.0) / 3.0 / out, -1.0 / 3.0);
        let s = -std::f64::consts::FRAC_2_PI * (k1 + k2).atan2((k1 - k2).abs());
        (s, ((k1 * k1 + k2 * k2) / 2.0_f64).sqrt())
    });
    let lanes = shapes::half_ball(5.0, 5, 9);
    tell("half ball r = 5 to the rim, 5 lanes x 9", &lanes, [false; 2], |_| (1.0, 0.2));
    let scattered = shapes::scattered_half_ball(5.0, 60);
    tell("half ball r = 5, 60 contacts without lanes", &scattered, [false; 2], |_| (1.0, 0.2));
}

fn tell(name: &str, contacts: &Contacts, closed: [bool; 2], truth: impl Fn([f64; 3]) -> (f64, f64)) {
    // closed directions take 12 segments where one is asked for
    let segments = if closed == [false; 2] { 2 } else { 1 };
    let options = worlds::options(3, segments).with_closed(closed).with_grid(16, 16);
    let fit = match worlds::parametric(contacts, &options) {
        Ok(fit) => fit,
        Err(error) => return println!("  {name}: {error}"),
    };
    let shape = fit.shape();
    let maps = &shape.maps;
    let (mut worst, mut seam) = ([0.0_f64; 2], 0.0_f64);
    for ((i, j), _) in maps.supported.indexed_iter().filter(|(_, s)| **s) {
        let (s, r) = truth(maps.points[[i, j]]);
        worst[0] = worst[0].max((maps.shape_index[[i, j]] - s).abs());
        worst[1] = worst[1].max((maps.curvedness[[i, j]] / r - 1.0).abs());
    }
    let surface = fit.surface();
    for (k, _) in closed.iter().enumerate().filter(|(_, c)| **c) {
        let [lo, hi] = surface.knots()[k].domain();
        let middle = surface.knots()[1 - k].domain().iter().sum::<f64>() / 2.0;
        let at = |t: f64| if k == 0 { surface.at(t, middle) } else { surface.at(middle, t) };
        let s = |t: f64| at(t).principal().and_then(|p| p.shape_index()).unwrap_or(f64::NAN);
        seam = seam.max((s(lo) - s(hi - 1e-9 * (hi - lo))).abs());
    }
    println!(
        "  {name}: mean S {:.4}, mean R {:.4}; worst |dS| {:.4}, worst dR/R {:.4}; across the seam S steps by {seam:.1e}; support {:.2}, {} steps, fold-free {}",
        shape.shape_index.mean.unwrap_or(f64::NAN),
        shape.curvedness.mean.unwrap_or(f64::NAN),
        worst[0],
        worst[1],
        shape.support,
        fit.certificate().iterations,
        fit.certificate().fold_free
    );
}
