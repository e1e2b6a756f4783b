//! Grid-mean S of spheres and diagonal cylinders against their radius, degrees 2, 3 and 4, tangent preset.
//! `cargo bench --bench hard_cases` prints it, and `tests/library/hard_cases.rs` holds the recorded one against it.

use palpate::Contacts;
use palpate::fit::{FitOptions, Objective, SlopeWeights, fit_contacts};

const RADII: [f64; 13] = [5.7, 6.0, 10.0, 20.0, 50.0, 100.0, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9];

/// Errors of mean S, one line a radius; truth is 1 and 1/2.
pub(crate) fn table() -> String {
    let mut out = String::from("error of grid-mean S, 3 fingers x 9 stations on the 8 x 8 patch, 8 x 8 grid\n");
    out += format!("{:>8} {:^32} {:^32}", "radius", "sphere, degree 2 3 4", "cylinder at 45 degrees, 2 3 4").trim_end();
    for radius in RADII {
        out += &format!("\n{radius:>8.4e}");
        for (surface, truth) in [(Surface::Sphere, 1.0), (Surface::Cylinder, 0.5)] {
            for degree in [2, 3, 4] {
                out += &match mean_shape_index(&surface.touched(radius), degree) {
                    Ok(Some(s)) => format!(" {:>10.2e}", s - truth),
                    Ok(None) => format!(" {:>10}", "plane"),
                    Err(_) => format!(" {:>10}", "refused"),
                };
            }
        }
    }
    out
}

enum Surface {
    Sphere,
    Cylinder,
}

impl Surface {
    fn touched(&self, radius: f64) -> Contacts {
        let mut data = Contacts::default();
        let (mut zx, mut zy) = (Vec::new(), Vec::new());
        for k in 0..27 {
            let (x, y) = (4.0 * (k / 9) as f64 - 4.0, (k % 9) as f64 - 4.0);
            let (d2, gx, gy) = match self {
                Surface::Sphere => (x * x + y * y, x, y),
                Surface::Cylinder => ((x - y) * (x - y) / 2.0, (x - y) / 2.0, (y - x) / 2.0),
            };
            let root = (radius * radius - d2).sqrt();
            data.x.push(x);
            data.y.push(y);
            data.z.push(-d2 / (radius + root));
            zx.push(-gx / root);
            zy.push(-gy / root);
        }
        data.with_slopes(zx, zy)
    }
}

fn mean_shape_index(contacts: &Contacts, degree: usize) -> Result<Option<f64>, palpate::fit::FitError> {
    let objective = Objective::Slopes(SlopeWeights::Tangent);
    let options =
        FitOptions::default().with_degree(degree).with_objective(objective).with_domain([-4.0, 4.0, -4.0, 4.0]);
    Ok(fit_contacts(contacts, &options)?.shape().shape_index.mean)
}
