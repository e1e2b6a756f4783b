//! Contacts of a random cubic: where they lie, how the surface bends, what noise they carry.
//!
//! ```text
//! x = ox + hx u,  y = oy + hy v,  z = oz + hz h(u, v),     zx = (hz/hx) h_u,  zy = (hz/hy) h_v       |u|, |v| <= 1
//! ```

use palpate::Contacts;
use palpate_laboratory::hard_cases::Lcg;

/// One of several values.
pub(super) fn pick<T: Copy>(lcg: &mut Lcg, choices: &[T]) -> T {
    choices[(lcg.uniform() * choices.len() as f64) as usize]
}

/// Half sides and origin of the patch.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub half: [f64; 2],
    pub origin: [f64; 3],
}

impl Place {
    /// Sizes from a micrometre to a kilometre, sides that differ, far from the origin.
    pub(super) fn draw(lcg: &mut Lcg) -> Place {
        let half = pick(lcg, &[4.0, 4.0, 1.0, 1e-6, 1e6]);
        let aspect = pick(lcg, &[1.0, 1.0, 1.0, 10.0, 1e3]);
        let offset = half * pick(lcg, &[0.0, 0.0, 1024.0, 1048576.0]);
        let height = half * pick(lcg, &[0.0, 0.0, 0.0, 1e3, 1e6]);
        let long = if lcg.uniform() < 0.5 { [half * aspect, half] } else { [half, half * aspect] };
        Place { half: long, origin: [offset, offset, height] }
    }

    /// `[x0, x1, y0, y1]`.
    pub(super) fn domain(&self) -> [f64; 4] {
        let ([hx, hy], [ox, oy, _]) = (self.half, self.origin);
        [ox - hx, ox + hx, oy - hy, oy + hy]
    }

    /// The unit of heights: slopes stay below some ones.
    pub(super) fn unit(&self) -> f64 {
        self.half[0].min(self.half[1])
    }
}

/// `count` places in the square |u|, |v| <= 1.
pub(super) fn sites(lcg: &mut Lcg, count: usize) -> Vec<[f64; 2]> {
    let crowding = pick(lcg, &[0, 0, 0, 1, 2]);
    let lanes = pick(lcg, &[0.0, 0.0, 0.0, 4.0, 6.0]);
    let hole = pick(lcg, &[0.0, 0.0, 0.0, 0.3, 0.6]);
    let clusters = pick(lcg, &[0, 0, 0, 3, 5]);
    let radius = pick(lcg, &[0.1, 1e-2, 1e-4, 1e-6]);
    let centres: Vec<[f64; 2]> = (0..clusters).map(|_| [0, 1].map(|_| 1.8 * lcg.uniform() - 0.9)).collect();
    let mut sites = Vec::with_capacity(count);
    while sites.len() < count {
        let mut u = lcg.uniform();
        (0..crowding).for_each(|_| u *= lcg.uniform());
        let u = 2.0 * if lanes > 0.0 { (u * lanes).floor() / (lanes - 1.0) } else { u } - 1.0;
        let mut site = [u, 2.0 * lcg.uniform() - 1.0];
        // half of the contacts stay where they were, or the clusters alone would determine little
        if clusters > 0 && lcg.uniform() < 0.5 {
            let centre = centres[(lcg.uniform() * clusters as f64) as usize];
            site = [0, 1].map(|k| centre[k] + radius * (2.0 * lcg.uniform() - 1.0));
        }
        if site[0].hypot(site[1]) >= hole {
            sites.push(site.map(|v| v.clamp(-1.0, 1.0)));
        }
    }
    sites
}

/// `a . (u, v, u^2, uv, v^2, u^3, u v^2)`.
pub(super) struct Surface {
    a: [f64; 7],
}

impl Surface {
    /// Any cubic, one close to a plane, or one close to an umbilic.
    pub(super) fn draw(lcg: &mut Lcg) -> Surface {
        let mut a = [0; 7].map(|_| 2.0 * lcg.uniform() - 1.0);
        let small = pick(lcg, &[1e-2, 1e-4, 1e-6, 1e-9, 1e-12]);
        match pick(lcg, &[0, 0, 0, 1, 2]) {
            1 => a[2..].iter_mut().for_each(|v| *v *= small),
            2 => {
                (a[0], a[1], a[4]) = (small * a[0], small * a[1], a[2] * (1.0 + small * a[4]));
                [3, 5, 6].into_iter().for_each(|k| a[k] *= small);
            }
            _ => {}
        }
        Surface { a }
    }

    /// `[h, h_u, h_v]`.
    fn at(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let a = &self.a;
        let height =
            a[0] * u + a[1] * v + a[2] * u * u + a[3] * u * v + a[4] * v * v + a[5] * u * u * u + a[6] * u * v * v;
        let slope_u = a[0] + 2.0 * a[2] * u + a[3] * v + 3.0 * a[5] * u * u + a[6] * v * v;
        let slope_v = a[1] + a[3] * u + 2.0 * a[4] * v + 2.0 * a[6] * u * v;
        [height, slope_u, slope_v]
    }
}

/// What a contact measures besides its place.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Feels {
    Heights,
    Slopes,
    Normals,
}

/// Contacts at these sites; `slips` is the share whose height and slope are wrong by far.
pub(super) fn touches(
    lcg: &mut Lcg,
    sites: &[[f64; 2]],
    place: &Place,
    feels: Feels,
    [noise, slips]: [f64; 2],
) -> Contacts {
    let surface = Surface::draw(lcg);
    let (unit, [hx, hy], [ox, oy, oz]) = (place.unit(), place.half, place.origin);
    let mut data = Contacts::default();
    let (mut zx, mut zy) = (Vec::new(), Vec::new());
    let [x0, x1, y0, y1] = place.domain();
    for &site in sites {
        let [h, hu, hv] = surface.at(site);
        let slip = if lcg.uniform() < slips { 20.0 * (noise + 1e-3) } else { noise };
        data.x.push((ox + hx * site[0]).clamp(x0, x1));
        data.y.push((oy + hy * site[1]).clamp(y0, y1));
        data.z.push(oz + unit * (h + slip * lcg.normal()));
        zx.push(unit / hx * (hu + slip * lcg.normal()));
        zy.push(unit / hy * (hv + slip * lcg.normal()));
    }
    match feels {
        Feels::Heights => data,
        Feels::Slopes => data.with_slopes(zx, zy),
        Feels::Normals => {
            let down = |slopes: &[f64]| slopes.iter().map(|s| -s).collect::<Vec<f64>>();
            let (nx, ny, nz) = (down(&zx), down(&zy), vec![1.0; zx.len()]);
            data.with_normals(nx, ny, nz)
        }
    }
}
