//! S and R at every point of a whole object, without cutting it: each point's jet, with its uncertainty.
//!
//! ```text
//! u(k)^2 = q' cov(c_xx, c_xy, c_yy) q, q along the principal direction        cov grows where the misfit exceeds the noise
//! u(S)^2, u(R)^2 by the delta method + what equal curvatures (S) and flatness (R) add at second order
//! ```
//!
//! Points are taken along a curve through space. Where neighbourhoods are wide beside the distances of points, the jet of one is nearly as
//! good at those next to it, and serves them; which these are depends on the places alone.

use std::ops::Range;

use super::cloud::{FEWEST_POINTS, framed};
use super::error::PartsError;
use super::jet::{Jet, JetDerivatives, Law};
use super::jet_neighbourhood::{Near, Neighbourhood, Touched};
use super::options::PartsOptions;
use super::ordered_contacts::{OrderedContacts, in_input_order};
use super::scale_selection::{asked, law};
use super::sided_normals::{normals, told_side};
use super::tuning::PartsTuning;

use palpate_geometry::contact::Contacts;
use palpate_geometry::curvature::{Derivatives, Principal};
use palpate_geometry::neighbours::{NeighbourLists, Neighbours};
use palpate_numeric::statistics::upper_median;
use palpate_numeric::threads;
use palpate_numeric::vector::Vector;

/// Points along the curve whose jets may serve each other.
const BLOCK: usize = 512;

/// Shape at each input point, in the order and unit of the input; what a point's neighbours leave open is not a number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointShapes {
    /// Unit normals of the surface through the neighbours.
    pub normals: Vec<[f64; 3]>,
    /// Larger principal curvature.
    pub k1: Vec<f64>,
    /// Smaller principal curvature.
    pub k2: Vec<f64>,
    /// Shape index S.
    pub shape_index: Vec<f64>,
    /// Curvedness R.
    pub curvedness: Vec<f64>,
    /// Standard uncertainty of S: noise, and bend beyond second order.
    pub u_shape_index: Vec<f64>,
    /// The same of R.
    pub u_curvedness: Vec<f64>,
    /// Neighbours that each surface was fitted to.
    pub neighbours: usize,
    /// Median distance between neighbouring points.
    pub spacing: f64,
    /// Standard deviation of points along the normal, as neighbourhoods show it.
    pub noise: f64,
    /// Standard deviation of normals in each tangent direction, degrees; `None` where they were estimated.
    pub normal_noise_deg: Option<f64>,
    /// What a user should know.
    pub notes: Vec<String>,
}

/// What one point gets: normal, k1, k2, S, R, u(S), u(R).
type PointShape = (Vector, [f64; 6]);

impl PointShapes {
    /// Shape index and curvedness at every contact, from the surface through its neighbours: also on bodies that no height field holds.
    ///
    /// ```
    /// # use palpate_inference::facade as palpate;
    /// use palpate::Contacts;
    /// use palpate::parts::{PartsOptions, PointShapes};
    ///
    /// // all round a ball of radius 5
    /// let at = |k: usize| ((k as f64 + 0.5) / 200.0 - 1.0, 2.4 * k as f64);
    /// let normals: Vec<[f64; 3]> = (0..400).map(at).map(|(z, a)| [a.cos(), a.sin(), 0.0].map(|v| v * (1.0 - z * z).sqrt())).zip((0..400).map(at))
    ///     .map(|([x, y, _], (z, _))| [x, y, z]).collect();
    /// let points: Vec<[f64; 3]> = normals.iter().map(|n| n.map(|v| 5.0 * v)).collect();
    /// let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
    /// let shapes = PointShapes::of(&contacts, &PartsOptions::default())?;
    /// assert!(shapes.curvedness.iter().all(|r| (r - 0.2).abs() < 0.002));
    /// # Ok::<(), palpate::parts::PartsError>(())
    /// ```
    ///
    /// # Errors
    /// When the contacts are faulty, too few, in one place, or their normals are none.
    pub fn of(contacts: &Contacts, options: &PartsOptions) -> Result<PointShapes, PartsError> {
        shape_at_points(contacts, options)
    }
}

fn shape_at_points(contacts: &Contacts, options: &PartsOptions) -> Result<PointShapes, PartsError> {
    options.check()?;
    contacts.check()?;
    if contacts.len() < FEWEST_POINTS + 1 {
        return Err(PartsError::TooFew { contacts: contacts.len(), needed: FEWEST_POINTS + 1 });
    }
    let mut notes = Vec::new();
    let OrderedContacts { places, normals: given, numbers } = OrderedContacts::new(contacts);
    let measured = given.is_some();
    let sided = normals(&places, given, &NeighbourLists::new(&places), options, &mut notes)?;
    if let Some(why) = sided.estimated {
        told_side(why, &sided.normals, options.viewpoint, &mut notes);
    }
    let normals = sided.normals;
    let (points, _, scale) = framed(&places).ok_or(PartsError::NoExtent)?;
    let tree = Neighbours::new(&points);
    let touched = Touched { points: &points, normals: &normals, tree: &tree, measured };
    let asked = asked(&touched, options.tuning.jet_asked);
    let nearest = asked.iter().filter_map(|&i| tree.nearest_other(i)).map(|(distance, _)| distance);
    let spacing = upper_median(nearest.collect::<Vec<f64>>()).unwrap_or(0.0);
    let law = law(&touched, &asked, spacing, &options.tuning).filter(|_| spacing > 0.0).ok_or(PartsError::NoExtent)?;
    let blocks = threads::map(points.len().div_ceil(BLOCK), 1, |b| {
        in_block(&touched, b * BLOCK..points.len().min((b + 1) * BLOCK), &law, &options.tuning)
    });
    let all: Vec<PointShape> = blocks.into_iter().flatten().collect();
    let mut shapes = gathered(&in_input_order(&numbers, &all), scale);
    let open = shapes.curvedness.iter().filter(|r| r.is_nan()).count();
    if open > 0 {
        notes.push(format!("{open} of {} points have too few neighbours on their side for a curvature", points.len()));
    }
    shapes.notes = notes;
    (shapes.neighbours, shapes.spacing, shapes.noise) = (law.size, spacing * scale, law.noise.distance * scale);
    shapes.normal_noise_deg = measured.then(|| law.noise.normal.to_degrees());
    Ok(shapes)
}

/// Points next to each other along the curve, of which one jet may serve several.
fn in_block(touched: &Touched, points: Range<usize>, law: &Law, tuning: &PartsTuning) -> Vec<PointShape> {
    let mut known: Vec<Option<PointShape>> = vec![None; points.len()];
    for i in points.clone() {
        if known[i - points.start].is_some() {
            continue;
        }
        let open = (touched.normals[i], [f64::NAN; 6]);
        let near = Neighbourhood::of(touched, i, law.size);
        let Some((near, jet)) = near.and_then(|near| near.jet(law).map(|jet| (near, jet))) else {
            known[i - points.start] = Some(open);
            continue;
        };
        known[i - points.start] = Some(shape(&jet, [0.0; 2], law).unwrap_or(open));
        for one in near.near.iter().filter(|one| points.contains(&(one.number as usize))) {
            let place = &mut known[one.number as usize - points.start];
            if place.is_none() && serves(&jet, one, tuning) {
                *place = shape(&jet, one.place, law);
            }
        }
    }
    known.into_iter().flatten().collect()
}

/// Whether the jet of another point holds at this neighbour of it: near its middle, and where what it leaves out is little beside noise.
fn serves(jet: &Jet, near: &Near, tuning: &PartsTuning) -> bool {
    let [x, y] = near.place;
    let more = jet.left_out(near.place).powi(2) - jet.left_out([0.0; 2]).powi(2);
    let is_near = x.hypot(y) <= tuning.jet_serves && near.share >= tuning.jet_serves_weight;
    is_near && more <= tuning.jet_serves_misfit * jet.variance_of_second()
}

/// What a jet says of a place in its axes; `None` where curvatures are no numbers.
fn shape(jet: &Jet, place: [f64; 2], law: &Law) -> Option<PointShape> {
    let at = jet.at(place);
    let ([zx, zy], [xx, xy, yy]) = (at.slopes, at.second);
    let principal = Derivatives::of_height(zx, zy, xx, xy, yy).principal()?;
    let [u_s, u_r] = uncertainties(&at, &principal, growth(jet, law));
    let normal = [0, 1, 2].map(|k| (0..3).map(|a| jet.axes[a][k] * principal.normal[a]).sum::<f64>());
    let s = principal.shape_index().unwrap_or(f64::NAN);
    Some((normal, [principal.k1, principal.k2, s, principal.curvedness(), u_s, u_r]))
}

/// Of S and of R.
fn uncertainties(at: &JetDerivatives, principal: &Principal, growth: f64) -> [f64; 2] {
    let (one, two) = (principal.direction1, principal.direction2);
    let along = |a: Vector, b: Vector| [a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[1] * b[1]];
    let (first, across, second) = (along(one, one), along(one, two), along(two, two));
    let variance = |p: f64, q: f64, r: f64| {
        let row: [f64; 3] = std::array::from_fn(|k| p * first[k] + q * across[k] + r * second[k]);
        let sum = (0..3).map(|i| row[i] * (0..3).map(|j| at.covariance[i][j] * row[j]).sum::<f64>()).sum::<f64>();
        let open = at.left_out * at.left_out * (p * p + q * q / 2.0 + r * r);
        growth * sum.max(0.0) + open
    };
    let (k1, k2) = (principal.k1, principal.k2);
    let square = (k1 * k1 + k2 * k2).max(f64::MIN_POSITIVE);
    // the difference of nearly equal curvatures is their distance in two components, of which the delta method sees one
    let twist = variance(0.0, 2.0, 0.0);
    let gap = principal.difference * principal.difference;
    let unequal = if twist > 0.0 { twist * twist / (gap + twist) } else { 0.0 };
    let in_s = std::f64::consts::FRAC_2_PI / square;
    let by_gap = in_s * 0.5 * (k1 + k2);
    let s = variance(in_s * k2, 0.0, -in_s * k1) + by_gap * by_gap * unequal;
    // R is the length of three components; where it is no longer than their noise, all of them count
    let noise = 0.5 * (variance(1.0, 0.0, 0.0) + variance(0.0, 0.0, 1.0)) + variance(0.0, 1.0, 0.0);
    let r = 0.5 * variance(k1 / square.sqrt(), 0.0, k2 / square.sqrt());
    let flat = if noise > 0.0 { noise * noise / (0.5 * square + noise) } else { 0.0 };
    [s.sqrt(), (r + flat).sqrt()]
}

/// The share of the misfit that chance does not explain, at least 1.
fn growth(jet: &Jet, law: &Law) -> f64 {
    let noise = [law.noise.distance, law.noise.normal];
    let ratio = |k: usize| {
        let chance = 1.0 + 2.0 * (2.0 / jet.freedom[k]).sqrt();
        jet.variance[k] / (noise[k] * noise[k] * chance)
    };
    ratio(0).max(ratio(1)).max(1.0)
}

fn gathered(all: &[PointShape], scale: f64) -> PointShapes {
    let column = |k: usize, unit: f64| all.iter().map(|(_, values)| values[k] * unit).collect::<Vec<f64>>();
    let per_length = 1.0 / scale;
    PointShapes {
        normals: all.iter().map(|(normal, _)| *normal).collect(),
        k1: column(0, per_length),
        k2: column(1, per_length),
        shape_index: column(2, 1.0),
        curvedness: column(3, per_length),
        u_shape_index: column(4, 1.0),
        u_curvedness: column(5, per_length),
        ..PointShapes::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a ring of radii 3 and 1 off by `noise` across it, and the true R.
    fn ring(noise: f64) -> (Contacts, Vec<f64>) {
        let mut state = 1u64;
        let mut draw = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut at = |k: usize| {
            let (u, v) = (((k % 180) as f64 + 0.3 * draw()) / 180.0, ((k / 180) as f64 + 0.3 * draw()) / 60.0);
            let [(sin, cos), (up, out)] = [u, v].map(|turns| (std::f64::consts::TAU * turns).sin_cos());
            let off = 1.0 + noise * (0..3).map(|_| 2.0 * draw() - 1.0).sum::<f64>();
            let curvatures = [1.0, out / (3.0 + out)];
            let r = (curvatures.iter().map(|k| k * k).sum::<f64>() / 2.0).sqrt();
            ([(3.0 + off * out) * cos, (3.0 + off * out) * sin, off * up], r)
        };
        let (points, truth): (Vec<Vector>, Vec<f64>) = (0..10_800).map(&mut at).unzip();
        (Contacts::from_points(&points), truth)
    }

    fn shapes(contacts: &Contacts, jet_serves: f64) -> PointShapes {
        let tuning = PartsTuning { jet_serves, ..PartsTuning::default() };
        PointShapes::of(contacts, &PartsOptions { tuning, ..PartsOptions::default() }).unwrap()
    }

    #[test]
    fn a_jet_serves_its_neighbours_where_noise_is_all_that_it_errs_by() {
        let (contacts, truth) = ring(0.015);
        let rms = |found: &PointShapes| {
            let squares = found.curvedness.iter().zip(&truth).map(|(r, truth)| (r - truth).powi(2));
            (squares.sum::<f64>() / truth.len() as f64).sqrt()
        };
        let [own, served] = [0.0, PartsTuning::default().jet_serves].map(|serves| shapes(&contacts, serves));
        let of_another = own.curvedness.iter().zip(&served.curvedness).filter(|(a, b)| a != b).count();
        assert!(5 * of_another > truth.len(), "{of_another}");
        assert!(rms(&served) < 1.05 * rms(&own), "{} for {}", rms(&served), rms(&own));
        let held =
            (0..truth.len()).filter(|i| (served.curvedness[*i] - truth[*i]).abs() < 2.0 * served.u_curvedness[*i]);
        assert!(held.count() as f64 > 0.93 * truth.len() as f64);
        // without noise what a jet leaves out is more than what it errs by, and points far from its middle have their own
        let (exact, _) = ring(0.0);
        let [own, served] = [0.0, PartsTuning::default().jet_serves].map(|serves| shapes(&exact, serves));
        assert_eq!(own.curvedness, served.curvedness);
    }
}
