//! What S and R of a primitive leave open, where the contacts may show another surface.
//!
//! ```text
//! u^2 = u_sizes^2 + (S_rich - S)^2 + u(S_rich)^2                R alike; S_rich, R_rich: of a quartic field (`free_form.rs`)
//! asked where    the data reject the primitive, or that half of the cloud's primitives are true,
//!                or |S_rich - S| > clear_u u(S_rich), or R so, and the field leaves no more than the primitive but by chance
//! half true      P(Bin(k, p_m) >= m) of the k primitives that could be tested, with p_m the m-th smallest of their p, m = ceil(k / 2)
//! ```
//!
//! A smooth surface of changing curvature is cut into pieces, each as large as a ball or a ring follows it within the noise. Over
//! a piece of half width a, a departure d of fourth order goes with curvatures that are wrong by some 30 d / a^2: a tenth of R
//! may hide below the noise, and the sizes' own u says nothing of it. The test of lack of fit overlooks it as well, and pieces
//! of a few dozen contacts cannot be tested at all; they are judged by the rest of the cloud. S and R stay the primitive's: to take
//! the field's would read a scanner's waves as shape.

use super::cloud::{Cloud, DIGITS};
use super::exact::Exact;
use super::free_form::rich_form;
use super::result::PartUncertainty;
use super::tuning::PartsTuning;
use statrs::distribution::{Beta, ContinuousCDF};

/// Whether the data reject this primitive by more than the digits of a file; `None` where it could not be tested.
pub(super) fn is_rejected(exact: &Exact, tuning: &PartsTuning) -> Option<bool> {
    exact.p.map(|p| p < tuning.rejected && exact.departure > DIGITS)
}

/// Whether the data reject that half of the cloud's primitives are true: it is then no body of primitives.
pub(super) fn is_free_form(exact: &[Option<Exact>], tuning: &PartsTuning) -> bool {
    let of = |exact: &Exact| exact.p.map(|p| if exact.departure > DIGITS { p } else { 1.0 });
    is_half_rejected(exact.iter().flatten().filter_map(of).collect(), tuning)
}

/// Whether the median of these p is too small for chance. Were half of what they test true, it would be no smaller than that of as many
/// uniform draws, which follows a beta distribution.
fn is_half_rejected(mut tested: Vec<f64>, tuning: &PartsTuning) -> bool {
    tested.sort_by(f64::total_cmp);
    let half = tested.len().div_ceil(2);
    let Some(median) = half.checked_sub(1).map(|at| tested[at]) else { return false };
    Beta::new(half as f64, (tested.len() - half + 1) as f64).is_ok_and(|chance| chance.cdf(median) < tuning.rejected)
}

/// Lets u of a primitive's S and R (cloud's units; S `None` on a plane) reach to those of a rich field.
pub(super) fn reach(
    cloud: &Cloud,
    members: &[u32],
    exact: Option<&Exact>,
    (s, r): (Option<f64>, f64),
    is_doubted: bool,
    tuning: &PartsTuning,
    u: &mut PartUncertainty,
) {
    let Some(rich) = rich_form(cloud, members, tuning) else { return };
    let of_s = s.zip(rich.shape_index).map(|(s, (rich, own))| (rich - s, own.unwrap_or(0.0)));
    let of_r = (rich.curvedness.0 - r, rich.curvedness.1.unwrap_or(0.0));
    let clear = |(off, own): (f64, f64)| own > 0.0 && off.abs() > tuning.clear_u * own;
    // the root mean square of n residuals scatters by a share of 1 / sqrt(2 n)
    let chance = 1.0 + tuning.clear_u / (2.0 * members.len() as f64).sqrt();
    let follows = exact.is_some_and(|e| rich.misfit <= chance * e.noise.distance);
    if !is_doubted && !(follows && (clear(of_r) || of_s.is_some_and(clear))) {
        return;
    }
    let wider = |u: Option<f64>, (off, own): (f64, f64)| Some(u.unwrap_or(0.0).hypot(off).hypot(own));
    if let Some(of_s) = of_s {
        u.shape_index = wider(u.shape_index, of_s);
    }
    u.curvedness = wider(u.curvedness.map(|u| u * cloud.scale), of_r).map(|u| u / cloud.scale);
}

#[cfg(test)]
mod tests {
    use super::is_half_rejected;
    use crate::parts::{PartKind, Parts, PartsOptions, PartsTuning};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::Vector;

    /// A dish `z = -(a rho^2 + b rho^4)` with b, and one with b = 0 that is nearly a ball.
    const A: f64 = 0.02;

    /// Contacts of the dish and its mean R.
    fn dish(b: f64) -> (Contacts, f64) {
        let draws = EffectDraws::new(3, "doubt");
        let (mut points, mut normals, mut sum) = (Vec::<Vector>::new(), Vec::<Vector>::new(), 0.0);
        for k in 0..400_u64 {
            let mut noise = [0.0; 3];
            draws.gaussians(1, k, 3, &mut noise);
            let [x, y] = [k % 20, k / 20].map(|i| 0.5 * (i as f64 - 9.5));
            let rho = x.hypot(y);
            let (slope, bend) = (2.0 * A + 4.0 * b * rho * rho, 2.0 * A + 12.0 * b * rho * rho);
            let steep = (1.0 + (slope * rho).powi(2)).sqrt();
            let [meridian, parallel] = [bend / steep.powi(3), slope / steep];
            sum += (0.5 * (meridian * meridian + parallel * parallel)).sqrt();
            points.push([x, y, 0.01 * noise[0] - A * rho * rho - b * rho.powi(4)]);
            normals.push([slope * x + 0.01 * noise[1], slope * y + 0.01 * noise[2], 1.0]);
        }
        (Contacts::from_points(&points).with_normal_vectors(&normals), sum / 400.0)
    }

    /// Off by many times what the radius' own u says, and yet within 2 u.
    #[test]
    fn a_dish_that_is_no_ball_says_how_little_a_ball_tells_of_it() {
        let (contacts, truth) = dish(1.5e-4);
        let found = Parts::of(&contacts, &PartsOptions::default().with_tolerance(0.2)).unwrap();
        let part = &found.parts[0];
        assert_eq!((found.parts.len(), part.kind), (1, PartKind::Sphere));
        let (off, u) = ((part.curvedness - truth).abs(), part.u.curvedness.unwrap());
        let radius = part.geometry.radius.unwrap();
        let of_radius = part.u.radius.unwrap() / (radius * radius);
        assert!(off > 4.0 * of_radius && off < 2.0 * u, "off by {off}, u {u}, of the radius {of_radius}");
        assert!(part.u.shape_index.is_some());
    }

    /// A paraboloid is a ball but for a few hundredths of R over this patch.
    #[test]
    fn what_is_nearly_a_ball_is_hardly_doubted() {
        let (contacts, truth) = dish(0.0);
        let found = Parts::of(&contacts, &PartsOptions::default().with_tolerance(0.2)).unwrap();
        let part = &found.parts[0];
        assert!((part.curvedness / truth - 1.0).abs() < 0.05, "{} {truth}", part.curvedness);
        assert!(part.u.curvedness.unwrap() < 0.1 * truth, "{} of {truth}", part.u.curvedness.unwrap());
    }

    /// Of true primitives one cloud in a hundred is doubted, however many parts it has. Parts that are each a little off are no body of
    /// primitives, though none of them is rejected alone; a body of which most parts are true is one.
    #[test]
    fn half_of_the_parts_decide_together() {
        let (draws, tuning) = (EffectDraws::new(9, "median"), PartsTuning::default());
        let rejected = |parts: usize| {
            let of = |cloud: u64| {
                let mut p = vec![0.0; parts];
                draws.uniforms(cloud, 0, parts, &mut p);
                is_half_rejected(p, &tuning)
            };
            (0..4000).filter(|cloud| of(*cloud)).count()
        };
        let counts = [1, 2, 3, 8, 31].map(rejected);
        assert!(counts.iter().all(|count| (15..70).contains(count)), "{counts:?} of 4000");
        assert!(is_half_rejected(vec![0.03, 0.02, 0.04, 0.05, 0.6, 0.012, 0.3], &tuning));
        assert!(!is_half_rejected(vec![1e-30, 1e-9, 1e-20, 0.4, 0.3, 0.8, 0.6], &tuning));
        assert!(!is_half_rejected(Vec::new(), &tuning));
    }
}
