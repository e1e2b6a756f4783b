//! Patches that are far from the origin, tiny, huge or thin. The answer is that of the unscaled problem, as far as the
//! rounding of the data allows.

use super::HardCase;
use super::inputs::{FULL, Lcg, equal, normal_rows, options, sphere, sweep, tangent, with_normals, with_slopes};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::Contacts;

fn ball() -> Contacts {
    with_slopes(&sweep(5), sphere(10.0))
}

fn moved(mut contacts: Contacts, by: [f64; 3]) -> Contacts {
    contacts.x.iter_mut().for_each(|v| *v += by[0]);
    contacts.y.iter_mut().for_each(|v| *v += by[1]);
    contacts.z.iter_mut().for_each(|v| *v += by[2]);
    contacts
}

fn scaled(name: &'static str, by: f64) -> HardCase {
    let mut contacts = ball();
    for column in [&mut contacts.x, &mut contacts.y, &mut contacts.z] {
        column.iter_mut().for_each(|v| *v *= by);
    }
    let options = FitOptions { domain: Some(FULL.map(|v| v * by)), ..options(3, tangent()) };
    HardCase::contacts(name, "S of the unscaled patch, R scaled", contacts, options)
}

/// 60 scattered sites, x drawn before y.
fn scattered() -> Contacts {
    let lcg = &mut Lcg::new(108);
    let x: Vec<f64> = (0..60).map(|_| 8.0 * lcg.uniform() - 4.0).collect();
    let y: Vec<f64> = (0..60).map(|_| 8.0 * lcg.uniform() - 4.0).collect();
    let sites: Vec<[f64; 2]> = x.iter().zip(&y).map(|(&x, &y)| [x, y]).collect();
    with_slopes(&sites, sphere(10.0))
}

pub(super) fn cases() -> Vec<HardCase> {
    let far_domain = Some([1e8 - 4.0, 1e8 + 4.0, 1e8 - 4.0, 1e8 + 4.0]);
    let far = |objective| FitOptions { domain: far_domain, grid: [9, 9], ..options(3, objective) };
    let normals = with_normals(&sweep(5), sphere(10.0));
    let thin_sites: Vec<[f64; 2]> = sweep(5).iter().map(|s| [s[0], s[1] * 1e-6]).collect();
    let thin = FitOptions { domain: Some([-4.0, 4.0, -4.0 * 1e-6, 4.0 * 1e-6]), ..options(2, equal()) };
    let heights = ball();
    let heights = Contacts::from_positions(heights.x, heights.y, heights.z);
    let everywhere = [1e8, 1e8, 1e8];
    vec![
        HardCase::contacts("offset_1e8", "x, y and z 1e8 from the origin", moved(ball(), everywhere), far(equal())),
        HardCase::contacts(
            "offset_1e8_scattered",
            "sites rounded to 1.5e-8 by their offset",
            moved(scattered(), [1e8, 1e8, 0.0]),
            far(equal()),
        ),
        HardCase::contacts(
            "offset_1e8_normals",
            "normal rows 1e8 from the origin",
            moved(normals, everywhere),
            far(normal_rows(1.0, 15.0)),
        ),
        HardCase::contacts(
            "offset_1e8_heights",
            "heights alone, rounded to 1.5e-8 by their offset",
            moved(heights, [0.0, 0.0, 1e8]),
            options(2, equal()),
        ),
        scaled("scale_1e_minus_9", 1e-9),
        scaled("scale_1e9", 1e9),
        HardCase::contacts(
            "aspect_1e6",
            "a strip 1e6 times as long as wide",
            with_slopes(&thin_sites, sphere(10.0)),
            thin,
        ),
    ]
}
