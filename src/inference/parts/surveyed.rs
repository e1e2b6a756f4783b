//! What a cloud is cut by: the surfaces about its contacts, their noise, and what departures are let pass beside it.
//!
//! ```text
//! coarse^2 = noise^2 + let pass^2        noise: what neighbourhoods show, and wide ones where neighbours share errors
//! shared     normals of 20 neighbours scatter by more than `shared_turns` times those of 8, and both they and distances by more
//!            than is let pass
//! ```
//!
//! Normals with independent errors scatter alike about the surface through few neighbours and through many; those of planes through
//! neighbours, as scanners' programs write them, scatter the less the nearer their contacts are.

use super::cloud::Cloud;
use super::correlated_noise::wide_noise;
use super::evidence::Cells;
use super::local::{LocalShapes, Noise, noise_by_width};
use super::partition::Field;
use super::tuning::PartsTuning;

/// What is let pass, by the spacing of all contacts.
pub(super) struct LetPass {
    pub(super) noise: Noise,
    /// A departure that contacts do not resolve.
    unresolved: f64,
    /// Whether normals are those of planes through neighbours.
    estimated: bool,
}

impl LetPass {
    pub(super) fn new(cloud: &Cloud, tolerance: Option<f64>, estimated: bool, tuning: &PartsTuning) -> LetPass {
        let unresolved = tuning.unresolved * cloud.spacing;
        let unseen = unresolved.max(tuning.unseen);
        let distance = tolerance.map_or(unseen, |t| t / cloud.scale);
        let degrees = if estimated { tuning.blurred_deg } else { tuning.unseen_deg * (distance / unseen).max(1.0) };
        LetPass { noise: Noise { distance, normal: degrees.to_radians() }, unresolved, estimated }
    }
}

/// A cloud with what its neighbourhoods show.
pub(super) struct Surveyed {
    pub(super) cloud: Cloud,
    pub(super) shapes: LocalShapes,
    /// The noise that most neighbourhoods show.
    pub(super) noise: Noise,
    /// The least noise of a part.
    floor: Noise,
    /// The noise with what is let pass.
    coarse: Noise,
    pass: Noise,
    unresolved: f64,
    pub(super) cells: Cells,
    /// Whether measured normals show that neighbours share errors.
    pub(super) shared: bool,
    /// Whether normals are those of planes through neighbours.
    blurred: bool,
    /// What wide neighbourhoods show.
    wide: Noise,
    /// Some of very many contacts, by which they are cut.
    pub(super) spread: Option<Box<Surveyed>>,
}

impl Surveyed {
    pub(super) fn new(cloud: Cloud, pass: &LetPass, tuning: &PartsTuning) -> Surveyed {
        let [narrow, wide] = noise_by_width(&cloud, tuning);
        let shapes = LocalShapes::new(cloud.len(), wide, tuning);
        let least = Noise { distance: narrow.distance.min(wide.distance), normal: narrow.normal.min(wide.normal) };
        let LetPass { noise: let_pass, unresolved, estimated: blurred } = *pass;
        let turns_alike = !blurred && wide.normal > let_pass.normal.max(tuning.shared_turns * narrow.normal);
        let shared = turns_alike && least.distance > let_pass.distance;
        let noise = if shared { wide } else { least };
        let spread = if shared { None } else { cloud.spread(tuning.decided_on) };
        let spread = spread.map(|spread| Box::new(Surveyed::new(spread, pass, tuning)));
        // neighbourhoods that are as wide hold contacts enough among those
        let wide = match &spread {
            Some(spread) => spread.wide.at_least_as(&noise),
            None => wide_noise(&cloud, &shapes, &noise, tuning),
        };
        let coarse = wide.hypot(&let_pass);
        let floor = if blurred { Noise { normal: coarse.normal, ..wide } } else { wide };
        let cells = Cells::new(&cloud, tuning);
        let pass = let_pass;
        Surveyed { cloud, shapes, noise, floor, coarse, pass, unresolved, cells, shared, blurred, wide, spread }
    }

    pub(super) fn field<'a>(&'a self, tuning: &'a PartsTuning) -> Field<'a> {
        let Surveyed { cloud, shapes, floor, coarse, pass, unresolved, cells, shared, blurred, .. } = self;
        let (noise, coarse, pass, unresolved) = (*floor, *coarse, *pass, *unresolved);
        let (shared, blurred) = (*shared, *blurred);
        Field { cloud, shapes, noise, coarse, pass, unresolved, cells, shared, blurred, tuning }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::{PartKind, Parts, PartsOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::{Vector, unit};

    const SIDE: u32 = 50;

    /// A third of a pipe, its places off by 0.6 spacings: each by an error of its own, or as waves some 12 spacings long have it, in which
    /// case normals follow the waves.
    fn touched(shared: bool) -> (Vec<Vector>, Vec<Vector>) {
        let draws = EffectDraws::new(31, "waves");
        let waves: Vec<[f64; 3]> = (0..40)
            .map(|k| {
                let mut drawn = [0.0; 3];
                draws.gaussians(0, k, 3, &mut drawn);
                [0.5 * drawn[0], 0.5 * drawn[1], 10.0 * drawn[2]]
            })
            .collect();
        let contact = |k: u32| {
            let [u, h] = [f64::from(k % SIDE), f64::from(k / SIDE)];
            let mut own = [0.0; 3];
            draws.gaussians(1, u64::from(k), 3, &mut own);
            let of_waves = |of: fn(f64) -> f64, by: usize| -> f64 {
                let wave = |w: &[f64; 3]| of(w[0] * u + w[1] * h + w[2]) * if by < 2 { w[by] } else { 1.0 };
                waves.iter().map(wave).sum::<f64>() * 0.6 / 20.0_f64.sqrt()
            };
            let [height, along_u, along_h] = if shared {
                [of_waves(f64::sin, 2) + 0.2 * own[0], of_waves(f64::cos, 0), of_waves(f64::cos, 1)]
            } else {
                [0.6 * own[0], 0.2 * own[1], 0.2 * own[2]]
            };
            let (sin, cos) = ((u - 25.0) / 24.0).sin_cos();
            let radius = 24.0 + height;
            let [out, turn] = [[sin, 0.0, cos], [cos, 0.0, -sin]];
            let normal = [0, 1, 2].map(|a| out[a] - along_u * turn[a] - if a == 1 { along_h } else { 0.0 });
            ([radius * sin, h, radius * cos], unit(normal))
        };
        (0..SIDE * SIDE).map(contact).unzip()
    }

    /// The switch, and the parts.
    fn told(shared: bool) -> (bool, Vec<PartKind>) {
        let (points, normals) = touched(shared);
        let cloud = Cloud::new(&points, normals.clone()).unwrap();
        let tuning = PartsTuning::default();
        let switch = Surveyed::new(cloud.clone(), &LetPass::new(&cloud, None, false, &tuning), &tuning).shared;
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let found = Parts::of(&contacts, &PartsOptions::default()).unwrap();
        (switch, found.parts.iter().map(|part| part.kind).collect())
    }

    #[test]
    fn normals_that_follow_waves_of_errors_tell_that_neighbours_share_them() {
        assert_eq!(told(true), (true, vec![PartKind::Cylinder]));
        assert_eq!(told(false), (false, vec![PartKind::Cylinder]));
    }
}
