//! One posterior over the kinds that a patch knows and the primitives in space.
//!
//! ```text
//! p(h), b(h)      probabilities among the kinds of a patch, and among primitives in space, those that depart among them
//! c               planes, balls and bars, and what a patch calls a ring or a quadric: both know them
//! z(h)            b(h) sum p(c) / sum b(c), of what does not depart alone where that is less than half of it
//! w(h) = p(h)                 planes, balls and bars, and what a patch alone knows
//! w(h) = max(p(h), z(h))      cones, rings and quadrics: of two searches for the same surface the one that found more
//! P(h) = w(h) / sum w
//! ```
//!
//! A patch has no cones, and rings and quadrics by their departure from two constant curvatures, to first order. Where one of these does not depart
//! as a primitive in space, and is as likely there to within [`Tuning::alike`](crate::bodies::Tuning::alike), it is told as that primitive; where it
//! is more likely there by that, its numbers too are read from the primitive's posterior. What departs from every primitive is what a patch tells as
//! a displaced surface.

use super::answer::{BodyAnswer, BodyQuestion};
use super::own_axis::axis_of;
use crate::bodies::{self, BodyPosterior, BodySample};
use crate::primitives::placed::PartKind;
use crate::recognition::contacts::Observations;
use crate::recognition::{Hypothesis, Recognition, RecognitionOptions, Tried};

/// Primitives that a patch knows exactly.
const OF_PATCHES: [PartKind; 3] = [PartKind::Plane, PartKind::Sphere, PartKind::Cylinder];

/// Primitives that it does not, each with what it may call them.
const IN_SPACE: [(PartKind, &[Hypothesis]); 3] = [
    (PartKind::Cone, &[]),
    (PartKind::Torus, &[Hypothesis::Torus, Hypothesis::General]),
    (PartKind::Ellipsoid, &[Hypothesis::Quadric, Hypothesis::Paraboloid]),
];

/// A primitive in space that takes the place of what a patch calls it.
struct InSpace {
    kind: PartKind,
    names: &'static [Hypothesis],
    weight: f64,
    /// Whether a patch finds much less of it, so that its numbers are not those of this primitive.
    is_new: bool,
}

/// A patch that nothing speaks against, with the primitives in space among its kinds where it is not sure of its own. Of a few contacts it is sure
/// of a bar that is a cone, which it does not know: of many, its errors that neighbours share tell that something is left.
pub(super) fn beside_primitives(
    patch: Recognition,
    given: &Observations,
    touches: &[[f64; 2]],
    options: &RecognitionOptions,
) -> Recognition {
    let tuning = &options.tuning;
    let may_taper = patch.hypothesis == Hypothesis::Cylinder && given.points.len() <= tuning.taper_asked;
    let is_sure = patch.tried.first().is_none_or(|likeliest| likeliest.weight >= tuning.sure_of_patch);
    let is_in_space = matches!(patch.hypothesis, Hypothesis::Torus | Hypothesis::Quadric);
    if is_sure && !may_taper && !is_in_space {
        return patch;
    }
    let normals = given.normals.as_deref().unwrap_or_default();
    let Some(sample) = BodySample::new(&given.points, normals, given.rounding) else { return patch };
    let Some(posterior) = bodies::posterior_of_primitives(&sample, tuning) else { return patch };
    let body = BodyQuestion { sample: &sample, given, options, touches }.of(&posterior);
    if body.check_axes_of_normals().is_ok() { with_primitives_in_space(patch, &body) } else { patch }
}

/// A patch with the primitives in space among its kinds; where one of these is the likeliest of all, and a patch does not find it, the answer is read
/// from their posterior, and else the axis and sizes of what it is told as.
pub(super) fn with_primitives_in_space(mut patch: Recognition, body: &BodyAnswer) -> Recognition {
    let told = if body.explains_normals() { joined(&mut patch, body) } else { None };
    let answer = told.filter(|told| told.is_new).and_then(|told| read_from_primitives(&patch, told.kind, body));
    answer.unwrap_or_else(|| with_own_axis(patch, body))
}

/// Brings both lists of kinds into one, and says which primitive in space is then the likeliest of all.
fn joined(patch: &mut Recognition, body: &BodyAnswer) -> Option<InSpace> {
    let found = in_space(&patch.tried, body.posterior, body.options.tuning.alike);
    let known = body.tried_at(&patch.averaged);
    for InSpace { kind, names, weight, .. } in &found {
        let hypothesis = Hypothesis::from(*kind);
        patch.tried.retain(|tried| tried.hypothesis != hypothesis && !names.contains(&tried.hypothesis));
        let own = known.iter().find(|tried| tried.hypothesis == hypothesis);
        patch.tried.extend(own.map(|own| Tried { weight: *weight, ..*own }));
    }
    let all: f64 = patch.tried.iter().map(|tried| tried.weight).sum();
    patch.tried.iter_mut().for_each(|tried| tried.weight /= all);
    patch.tried.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    if let Some(own) = found.iter().find(|found| found.names.contains(&patch.hypothesis)) {
        patch.hypothesis = Hypothesis::from(own.kind);
    }
    let likeliest = patch.tried.first().map(|tried| tried.hypothesis);
    let told = found.into_iter().find(|found| Some(Hypothesis::from(found.kind)) == likeliest)?;
    patch.hypothesis = Hypothesis::from(told.kind);
    Some(told)
}

/// The answer that primitives give where they have the odds of a patch with which they were joined; `None` where it is another kind.
fn read_from_primitives(patch: &Recognition, told: PartKind, body: &BodyAnswer) -> Option<Recognition> {
    let wanted = |kind: PartKind| {
        let own = patch.tried.iter().find(|tried| tried.hypothesis == Hypothesis::from(kind));
        own.map_or(0.0, |own| own.weight)
    };
    let factor = |kind: PartKind| wanted(kind) / body.posterior.weight_of(kind).max(f64::MIN_POSITIVE);
    let posterior = body.posterior.reweighed(factor)?;
    let answer = BodyAnswer { posterior: &posterior, ..*body }.recognition().ok()?;
    let is_told = answer.hypothesis == Hypothesis::from(told);
    is_told.then(|| Recognition { tried: patch.tried.clone(), ..answer })
}

/// A patch with the axis and sizes of the primitive in space that it is told as.
fn with_own_axis(patch: Recognition, body: &BodyAnswer) -> Recognition {
    let told = IN_SPACE.iter().find(|(kind, _)| Hypothesis::from(*kind) == patch.hypothesis).map(|(kind, _)| *kind);
    let alone = told.and_then(|told| body.posterior.reweighed(|kind| f64::from(u8::from(kind == told))));
    let Some(posterior) = alone else { return without_axis_of_patch(patch) };
    let Some(likeliest) = posterior.likeliest(posterior.kind()) else { return without_axis_of_patch(patch) };
    let draws = bodies::drawn(&posterior, &body.options.tuning, body.options.seed);
    let own = body.told_by(&likeliest, &draws);
    let axis = axis_of(&likeliest);
    let axis_within_deg = axis.map(|axis| own.axis_within(axis));
    let notes = patch.notes.into_iter().chain(own.sizes()).collect();
    Recognition { axis, axis_within_deg, notes, ..patch }
}

/// A patch that is told as a ring or an egg without the way along it, which is not the axis of these: it knows neither that nor their sizes.
pub(super) fn without_axis_of_patch(patch: Recognition) -> Recognition {
    if IN_SPACE.iter().all(|(kind, _)| Hypothesis::from(*kind) != patch.hypothesis) {
        return patch;
    }
    Recognition { axis: None, axis_within_deg: None, ..patch }
}

/// The primitives in space that are told as such; none where no kind that both know tells one scale.
fn in_space(tried: &[Tried], posterior: &BodyPosterior, alike: f64) -> Vec<InSpace> {
    let of_patch = |own: &[Hypothesis]| {
        let own = tried.iter().filter(|tried| own.contains(&tried.hypothesis));
        own.map(|tried| tried.weight).sum::<f64>()
    };
    let exact = OF_PATCHES.map(|kind| [of_patch(&[Hypothesis::from(kind)]), posterior.weight_of(kind)]);
    let near = IN_SPACE.iter().filter(|(_, names)| !names.is_empty());
    let both = exact.into_iter().chain(near.map(|(kind, names)| [of_patch(names), posterior.weight_of(*kind)]));
    let [patch, body] = both.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
    let scale = patch / body;
    let one = |(kind, names): &(PartKind, &'static [Hypothesis])| {
        let [all, plain] = [posterior.weight_of(*kind), posterior.weight_of_plain(*kind)];
        let is_plain = plain > 0.5 * all;
        let (own, known) = (scale * if is_plain { all } else { plain }, of_patch(names));
        let is_told = own > known || is_plain && own >= known * (-alike).exp();
        let is_new = own * (-alike).exp() > known;
        (own > 0.0 && is_told).then_some(InSpace { kind: *kind, names, weight: own.max(known), is_new })
    };
    if scale.is_finite() { IN_SPACE.iter().filter_map(one).collect() } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use crate::recognition::{Hypothesis, Recognition, RecognitionOptions, Remark};
    use palpate_geometry::contact::Contacts;

    const COUNT: usize = 36;

    /// An error without a pattern.
    fn error(i: usize) -> f64 {
        (97.0 * (i as f64 + 1.0).powf(1.3)).sin()
    }

    /// A place of a disc that is evenly covered.
    fn on_disc(i: usize, radius: f64) -> [f64; 2] {
        let (sin, cos) = (2.4 * i as f64).sin_cos();
        let r = radius * (i as f64 / COUNT as f64).sqrt();
        [r * cos, r * sin]
    }

    fn recognised(point: impl Fn(usize) -> [f64; 3]) -> Recognition {
        let points: Vec<[f64; 3]> = (0..COUNT).map(point).collect();
        Recognition::of(&Contacts::from_points(&points), &RecognitionOptions::default()).unwrap()
    }

    fn probability(found: &Recognition, hypothesis: Hypothesis) -> f64 {
        found.tried.iter().filter(|tried| tried.hypothesis == hypothesis).map(|tried| tried.weight).sum()
    }

    #[test]
    fn a_cap_of_an_egg_is_a_quadric_and_no_paraboloid() {
        for [a, b, c] in [[9.0, 6.0, 5.0], [1.0, 0.7, 0.8]] {
            let found = recognised(|i| {
                let [u, v] = on_disc(i, 0.5);
                [a * u, b * v, c * ((1.0 - u * u - v * v).sqrt() + 0.009 * error(i))]
            });
            assert_eq!(found.hypothesis, Hypothesis::Quadric, "{:?}", found.tried);
            assert_eq!(probability(&found, Hypothesis::Paraboloid), 0.0);
            let all: f64 = found.tried.iter().map(|tried| tried.weight).sum();
            assert!((all - 1.0).abs() < 1e-9, "{all}");
        }
    }

    #[test]
    fn a_ring_has_its_own_axis_and_an_egg_its_longest_however_little_of_them_is_touched() {
        let ring = recognised(|i| {
            let [u, v] = on_disc(i, 0.5);
            let tube = 12.0 + 3.6e-3 * error(i);
            let rho = 40.0 + tube * v.cos();
            [rho * (0.5 * u).cos(), rho * (0.5 * u).sin(), tube * v.sin()]
        });
        assert_eq!(ring.hypothesis, Hypothesis::Torus, "{:?}", ring.tried);
        let [axis, within] = [ring.axis.unwrap()[2].abs().acos().to_degrees(), ring.axis_within_deg.unwrap()];
        assert!(axis <= within && within < 5.0, "off by {axis}, within {within}");
        assert!(ring.notes.iter().any(|note| matches!(note, Remark::RingIs { .. })), "{:?}", ring.notes);
        let egg = recognised(|i| {
            let [u, v] = on_disc(i, 0.5);
            [9.0 * u, 6.0 * v, 5.0 * ((1.0 - u * u - v * v).sqrt() + 1e-4 * error(i))]
        });
        let [axis, within] = [egg.axis.unwrap()[0].abs().acos().to_degrees(), egg.axis_within_deg.unwrap()];
        assert!(axis <= within && within < 5.0, "off by {axis}, within {within}");
        let told = egg.notes.iter().find_map(|note| match note {
            Remark::EllipsoidIs { half_axes } => Some(*half_axes),
            _ => None,
        });
        for ([_, lo, hi], truth) in told.unwrap().into_iter().zip([9.0, 6.0, 5.0]) {
            assert!(lo <= truth && truth <= hi, "{truth}: {lo} to {hi}");
        }
    }

    #[test]
    fn a_saddle_is_no_ring_though_no_other_primitive_comes_near() {
        let found = recognised(|i| {
            let [x, y] = on_disc(i, 2.0);
            [x, y, 0.1 * (x * x - y * y) + 0.003 * error(i)]
        });
        assert_eq!(found.hypothesis, Hypothesis::Paraboloid, "{:?}", found.tried);
        assert!(probability(&found, Hypothesis::Torus) < 0.2, "{:?}", found.tried);
    }

    #[test]
    fn a_narrow_strip_of_a_cone_is_a_cone_where_its_contacts_are_exact_and_may_be_a_bar_elsewhere() {
        let slope = 15.0_f64.to_radians().tan();
        let strip = |arc: f64, size: f64| {
            recognised(|i| {
                let (sin, cos) = (arc * ((0.618_033_988_7 * i as f64).fract() - 0.5)).sin_cos();
                let h = 1.0 + (i as f64 + 0.5) / COUNT as f64;
                let r = slope * (h + size * error(i));
                [r * cos, r * sin, h]
            })
        };
        for (arc, size, least) in [(0.8, 0.01, 0.9), (0.5, 0.003, 0.9), (0.5, 0.02, 0.1)] {
            let found = strip(arc, size);
            assert!(probability(&found, Hypothesis::Cone) > least, "{arc} {size}: {:?}", found.tried);
        }
    }
}
