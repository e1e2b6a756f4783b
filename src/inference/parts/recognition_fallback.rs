//! What touches tell that are too few for a test of any primitive: the answer of the recognition, which knows of errors that
//! neighbours share.
//!
//! ```text
//! asked where no part of the cloud has cells enough for a test of its lack of fit (`exact.rs`)
//! P(class of the primitive | contacts) >= few_open P(likeliest class) the primitive stays; u(S), u(R), u(radius)/radius are at least
//! and its R in the interval of R                                      u(S), u(R), u(R)/R of the recognition
//! else                                                                a patch with S, R and u of the recognition
//! ```
//!
//! Twenty-nine touches of a ball by a tactile sensor whose slopes are wrong by 0.09 fit a blunt cone best, with a radius that is
//! off by 240 times its u (`benches/runs/scans.md`). A cloud with tested parts judges its small ones by the others (`lack_of_fit_uncertainty.rs`).

use super::cloud::Cloud;
use super::exact::Exact;
use super::free_form::FreeForm;
use super::hypothesis::sampled;
use super::result::PartUncertainty;
use super::tuning::PartsTuning;
use crate::primitives::placed::PartKind;
use crate::recognition::{Recognition, RecognitionOptions};
use palpate_geometry::contact::Contacts;
use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::neighbours::mean_of;
use palpate_numeric::threads;
use palpate_numeric::vector::norm;

/// What the recognition says of the members of one part.
#[derive(Clone, Debug)]
pub(super) struct Few {
    found: Recognition,
    measured: bool,
}

/// Of every part, where none of the cloud's primitives could be tested. `measured` says whether the normals are: those of planes through
/// neighbours tell nothing new.
pub(super) fn few(
    cloud: &Cloud,
    measured: bool,
    members: &[Vec<u32>],
    exact: &[Option<Exact>],
    tuning: &PartsTuning,
) -> Vec<Option<Few>> {
    let tested = exact.iter().flatten().any(|e| e.p.is_some());
    let asked = |k: usize| if tested { None } else { Few::of(cloud, measured, &members[k], tuning) };
    threads::map(exact.len(), 1, asked)
}

impl Few {
    /// `None` where the recognition refuses.
    fn of(cloud: &Cloud, measured: bool, members: &[u32], tuning: &PartsTuning) -> Option<Few> {
        let (points, normals) = sampled(cloud, members, usize::MAX);
        // all round there is no direction of the free side, and classes of both sides stay open
        let up = Some(mean_of(&normals)).filter(|mean| norm(*mean) > tuning.few_one_side);
        let options = RecognitionOptions { up, tuning: tuning.recognition.clone(), ..RecognitionOptions::default() };
        let contacts = Contacts::from_points(&points);
        let contacts = if measured { contacts.with_normal_vectors(&normals) } else { contacts };
        Recognition::of_rounded(&contacts, cloud.rounding_among(members), &options)
            .ok()
            .map(|found| Few { found, measured })
    }

    /// Whether a primitive of this kind, class and mean R, in the cloud's units, is hardly what the contacts show. The R of a
    /// cone or ring differs from place to place: one that was recognised as such is not contradicted by where means were taken.
    pub(super) fn contradicts(&self, kind: PartKind, class: ShapeClass, curvedness: f64, tuning: &PartsTuning) -> bool {
        let varies = matches!(kind, PartKind::Cone | PartKind::Torus);
        if varies && self.found.hypothesis.name() == kind.name() {
            return false;
        }
        let classes = &self.found.class_probability;
        let one = |class: ShapeClass| classes.iter().find(|(c, _)| *c == class).map_or(0.0, |(_, p)| *p);
        // planes through few neighbours do not tell the side
        let of = |class: ShapeClass| if self.measured { one(class) } else { one(class).max(one(class.mirrored())) };
        let [lo, hi] = self.found.curvedness.interval;
        let slack = tuning.few_same * curvedness;
        let bends_otherwise = class != ShapeClass::Plane && !(lo - slack..=hi + slack).contains(&curvedness);
        bends_otherwise || classes.first().is_some_and(|(_, most)| of(class) < tuning.few_open * most)
    }

    /// The class of the mean S, or plane.
    pub(super) fn class(&self) -> ShapeClass {
        self.found.class
    }

    /// S and R in place of a primitive's.
    pub(super) fn free_form(&self) -> FreeForm {
        let found = &self.found;
        FreeForm {
            shape_index: found.shape_index.map(|s| (s.mean, Some(s.u))),
            curvedness: (found.curvedness.mean, Some(found.curvedness.u)),
            misfit: found.tried.first().map_or(0.0, |likeliest| likeliest.rms),
        }
    }

    /// Lets u of a primitive that stays reach as far as the recognition's; sizes in the input's units.
    pub(super) fn widen(&self, cloud: &Cloud, kind: PartKind, radius: Option<f64>, u: &mut PartUncertainty) {
        let (s, r) = (self.found.shape_index, self.found.curvedness);
        u.curvedness = u.curvedness.map(|own| own.max(r.u / cloud.scale));
        u.shape_index = u.shape_index.map(|own| own.max(s.map_or(0.0, |s| s.u)));
        if r.mean > 0.0 && matches!(kind, PartKind::Sphere | PartKind::Cylinder | PartKind::Cone) {
            u.radius = u.radius.zip(radius).map(|(own, radius)| own.max(radius * r.u / r.mean));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::parts::{Part, PartKind, Parts, PartsOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::Vector;

    const RADIUS: f64 = 3.8;

    /// The part that 29 touches of a ball show whose normals lean outwards by `rim` radians more than the ball's.
    fn touched(rim: f64, seed: u64) -> Part {
        let draws = EffectDraws::new(seed, "few");
        let (mut points, mut normals) = (Vec::<Vector>::new(), Vec::<Vector>::new());
        for k in 0..29_u32 {
            let mut noise = [0.0; 3];
            draws.gaussians(1, u64::from(k), 3, &mut noise);
            let (angle, rho) = (2.399_963 * f64::from(k), 1.6 * ((f64::from(k) + 0.5) / 29.0).sqrt());
            let (s, c) = angle.sin_cos();
            let height = (RADIUS * RADIUS - rho * rho).sqrt();
            points.push([rho * c, rho * s, height - RADIUS + 0.005 * noise[0]]);
            let lean = rho / height + rim;
            normals.push([lean * c + 0.02 * noise[1], lean * s + 0.02 * noise[2], 1.0]);
        }
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        Parts::of(&contacts, &PartsOptions::default()).unwrap().parts.remove(0)
    }

    /// How many u the radius of a ball or cone, or else R, is off.
    fn off(part: &Part) -> f64 {
        let of_r = (part.curvedness - 1.0 / RADIUS).abs() / part.u.curvedness.unwrap();
        let of_radius = part.geometry.radius.zip(part.u.radius).map(|(r, u)| (r - RADIUS).abs() / u);
        of_radius.unwrap_or(of_r)
    }

    /// A blunt cone fits them best.
    #[test]
    fn touches_with_leaning_normals_are_no_cone_with_a_sure_radius() {
        for seed in 1..=3 {
            let part = touched(0.25, seed);
            assert!(part.rejected.is_none() && part.kind != PartKind::Cone, "{part:?}");
            assert!(off(&part) < 3.0, "off by {} u: {part:?}", off(&part));
        }
    }

    #[test]
    fn touches_of_a_ball_are_a_ball() {
        for seed in 1..=3 {
            let part = touched(0.0, seed);
            assert_eq!((part.kind, part.points), (PartKind::Sphere, 29));
            assert!(off(&part) < 3.0, "off by {} u: {part:?}", off(&part));
        }
    }

    /// The part that an even grid over a bar or ball of this radius shows, every number written with so many digits behind the point.
    fn written(is_ball: bool, radius: f64, sides: [u32; 2], digits: i32) -> Vec<Part> {
        let unit = 10.0_f64.powi(digits);
        let rounded = |v: Vector| v.map(|v| (v * unit).round() / unit);
        let at = |k: u32, count: u32| -4.0 + 8.0 * f64::from(k) / f64::from(count - 1);
        let places = (0..sides[0]).flat_map(|i| (0..sides[1]).map(move |j| [at(i, sides[0]), at(j, sides[1])]));
        let contact = |[x, y]: [f64; 2]| {
            let across = if is_ball { y } else { 0.0 };
            let height = (radius * radius - x * x - across * across).sqrt();
            (rounded([x, y, height - radius]), rounded([x, across, height].map(|v| v / radius)))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = places.map(contact).unzip();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        Parts::of(&contacts, &PartsOptions::default()).unwrap().parts
    }

    /// Rows of a bar hold the same roundings, which a surface of no kind follows to the last digit; and a few dozen roundings that come
    /// again and again tell a radius less well than as many errors of their own.
    #[test]
    fn numbers_of_few_digits_are_no_shape() {
        for radius in [6.0, 9.0, 12.5, 20.0] {
            for (sides, digits) in [([6, 4], 2), ([6, 4], 4), ([5, 5], 3), ([8, 8], 3), ([8, 8], 4)] {
                for (is_ball, kind) in [(false, PartKind::Cylinder), (true, PartKind::Sphere)] {
                    let parts = written(is_ball, radius, sides, digits);
                    assert!(parts.len() == 1 && parts[0].kind == kind, "{radius} {sides:?} {digits}: {parts:?}");
                    let (found, u) = (parts[0].geometry.radius.unwrap(), parts[0].u.radius.unwrap());
                    let off = (found - radius).abs() / u;
                    assert!(off < 3.0 && u < 0.05 * radius, "{radius} {sides:?} {digits}: {found} off by {off} u");
                }
            }
        }
    }
}
