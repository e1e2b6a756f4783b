//! The same place touched twice: exactly, and one unit in the last place apart with another height.

use super::HardCase;
use super::inputs::{options, sphere, sweep, tangent, with_slopes};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::{Contacts, Orientation};

fn twice(first: &Contacts) -> Contacts {
    let both = |v: &Vec<f64>| [v.clone(), v.clone()].concat();
    let doubled = Contacts::from_positions(both(&first.x), both(&first.y), both(&first.z));
    match &first.orientation {
        Orientation::Slopes { zx, zy } => doubled.with_slopes(both(zx), both(zy)),
        _ => doubled,
    }
}

pub(super) fn cases() -> Vec<HardCase> {
    let first = with_slopes(&sweep(3), sphere(10.0));
    let exact = twice(&first);
    let mut apart = twice(&first);
    let g = first.len();
    for r in 0..g {
        apart.x[g + r] = first.x[r].next_up();
        apart.z[g + r] = first.z[r] + 0.001;
    }
    let wide = FitOptions { domain: Some([-4.0, 4.0_f64.next_up(), -4.0, 4.0]), ..options(3, tangent()) };
    vec![
        HardCase::contacts("duplicated_exactly", "every contact twice", exact, options(3, tangent())),
        HardCase::contacts("duplicated_one_ulp_apart", "x one ulp apart, z 0.001 apart", apart, wide),
    ]
}
