//! One noisy contact set in a hundred attitudes: S and R must not know.

use crate::shapes;
use crate::worlds::{self, SEED, sphere};

pub(crate) fn print() {
    let (contacts, _) = worlds::world(&sphere(5.7), true).simulate(SEED, 0);
    let mut scattered = contacts.clone();
    (scattered.finger, scattered.station) = (None, None);
    for (name, contacts) in [("lanes", contacts), ("scattered", scattered)] {
        let shape = |angle: f64, axis| {
            let fit =
                worlds::parametric(&shapes::turned(&contacts, axis, angle), &worlds::options(3, 1)).expect("a fit");
            let shape = fit.shape();
            [shape.shape_index.mean.expect("S"), shape.curvedness.mean.expect("R") * 5.7]
        };
        let first = shape(0.0, [0.0, 0.0, 1.0]);
        let mut worst = [0.0_f64; 2];
        for k in 0..100 {
            let t = f64::from(k);
            let found = shape(0.1 + 0.06 * t, [(1.3 * t).sin(), (0.7 * t + 1.0).cos(), (2.1 * t + 0.5).sin()]);
            (0..2).for_each(|i| worst[i] = worst[i].max((found[i] - first[i]).abs()));
        }
        println!("\n100 rotations, {name}: S moves by {:.1e}, R r by {:.1e}", worst[0], worst[1]);
    }
}
