//! Orientations that contradict each other or the heights. The answer is a compromise with large residuals.

use super::HardCase;
use super::inputs::{Lcg, equal, normal_rows, options, sphere, sweep, with_heights};
use palpate_geometry::contact::Contacts;

fn twice() -> Contacts {
    let first = with_heights(&sweep(5), sphere(10.0));
    let both = |v: Vec<f64>| [v.clone(), v].concat();
    Contacts::from_positions(both(first.x), both(first.y), both(first.z))
}

/// `a` for the first 45 contacts, `b` for the second 45.
fn halves(a: f64, b: f64) -> Vec<f64> {
    [vec![a; 45], vec![b; 45]].concat()
}

pub(super) fn cases() -> Vec<HardCase> {
    let opposed = twice().with_slopes(halves(1.0, -1.0), halves(-1.0, 1.0));
    let leaning = twice().with_normals(halves(0.6, -0.6), vec![0.0; 90], vec![0.8; 90]);
    let lcg = &mut Lcg::new(180);
    let mut draw = |low: f64| (0..45).map(|_| low + lcg.uniform()).collect::<Vec<f64>>();
    let (nx, ny, nz) = (draw(-0.5), draw(-0.5), draw(0.25));
    let wild = with_heights(&sweep(5), sphere(10.0)).with_normals(nx, ny, nz);
    vec![
        HardCase::contacts("contradictory_slopes", "each place leans both ways", opposed, options(2, equal())),
        HardCase::contacts(
            "contradictory_normals",
            "each place has two normals 74 degrees apart",
            leaning,
            options(2, normal_rows(1.0, 15.0)),
        ),
        HardCase::contacts(
            "random_normals",
            "normals that say nothing, heights that do",
            wild,
            options(2, normal_rows(0.1, 15.0)),
        ),
    ]
}
