//! A height field for contacts that are one sheet and no simple shape, with as many segments as predict left-out
//! contacts.
//!
//! ```text
//! blocks       the contacts' box cut into 6 x 6; block (i, j) is in group (i + 2 j) mod 4
//!              one group is left out at a time
//! error(s)     root mean square of z - S_s(x, y) over the left-out contacts, S_s fitted to the others with s segments
//! s            the smallest whose error is within 5 % of the least: along the longer side, and as many of that length along
//!              the shorter
//! ```
//!
//! x, y and z are along axes that the caller gives, and z is measured across the patch.
//!
//! Whole blocks are left out, because errors of neighbouring contacts are alike. A single contact left out would be
//! predicted the better, the more closely the field follows its neighbours' errors. (D. R. Roberts et al., *Ecography*
//! 40 (2017) 913.) Where waves are shorter than blocks no field predicts these; then single contacts are left out, of which a field that
//! follows errors alone predicts none.

use crate::recognition::start::thinned;
use palpate_fitting::fit::{Fit, FitError, FitOptions, fit_contacts, fit_contacts_over};
use palpate_geometry::contact::{Contacts, Frame, Orientation};
use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::draws::evenly;
use palpate_numeric::vector::Vector;

/// Blocks each way, and the number of groups that are left out one after the other.
const BLOCKS: usize = 6;
const GROUPS: usize = 4;

/// Segments that are tried.
const SEGMENTS: [usize; 7] = [1, 2, 4, 8, 12, 16, 24];

/// Degree of the height field: its curvature is continuous.
const DEGREE: usize = 3;

/// A coarser field is taken when it predicts as well up to this factor.
const AS_GOOD: f64 = 1.05;

/// Once the error has risen by the first factor above the least, finer fields follow noise and are not tried. While the
/// least is above the second share of the relief, nothing has been predicted yet, and finer fields are tried all the
/// same.
const RISEN: f64 = 1.5;
const UNPREDICTED: f64 = 0.5;

/// The same where single contacts are left out: as fine as the waves ask for.
const FINE_SEGMENTS: [usize; 9] = [2, 4, 6, 8, 10, 12, 16, 24, 32];

/// Contacts for every unknown at least, where blocks and where single contacts are left out.
const PER_UNKNOWN: f64 = 3.0;
const PER_FINE_UNKNOWN: f64 = 1.3;

/// Contacts among which blocks are left out; more would take longer and choose the same.
const MOST_CONTACTS: usize = 10_000;

/// Difference of heights between contacts over nearly the same place, in units of the relief, above which they lie on several sheets: two
/// that go round a body differ by as much as the relief, and no field comes nearer to both.
const SHEETS: f64 = 0.7;

/// A height field, and how well it predicts.
#[derive(Clone, Debug)]
pub struct Flexible {
    /// The fit to all contacts.
    pub fit: Fit,
    /// Segments tried, with the root mean square error of contacts left out.
    pub tried: Vec<([usize; 2], f64)>,
    /// That error of the number taken.
    pub error: f64,
    /// Root mean square distance of the contacts, along z, from their best plane.
    pub relief: f64,
}

/// Chooses the segments and fits over these axes (rows x, y, z). `None` where there are too few contacts to leave any out, and where they
/// lie on several sheets.
pub fn flexible(contacts: &Contacts, axes: [Vector; 3], options: &FitOptions) -> Option<Result<Flexible, FitError>> {
    let frame = Frame { axes, ..Frame::IDENTITY };
    let point = |r: usize| [contacts.x[r], contacts.y[r], contacts.z[r]];
    let points: Vec<Vector> =
        (0..contacts.len()).map(|r| if frame.keeps_axes() { point(r) } else { frame.rotate(point(r)) }).collect();
    let chosen: Vec<u32> = thinned(&points, MOST_CONTACTS).into_iter().map(|i| i as u32).collect();
    let [x, y, z] = [0, 1, 2].map(|k| points.iter().map(|p| p[k]).collect());
    let few = Contacts { x, y, z, orientation: Orientation::None, ..contacts.clone() }.in_order(&chosen);
    let relief = relief(&points);
    if are_sheets(&few, relief) {
        return None;
    }
    let box_of = [extent(&few.x), extent(&few.y)];
    let predicted = |tried: &Vec<([usize; 2], f64)>| tried.iter().any(|t| t.1 < UNPREDICTED * relief);
    let mut tried = each_left_out(&few, box_of, relief, LeftOut::Blocks);
    if !predicted(&tried) {
        let fine = each_left_out(&few, box_of, relief, LeftOut::Contacts);
        if predicted(&fine) {
            tried = fine;
        }
    }
    let least = tried.iter().map(|t| t.1).min_by(f64::total_cmp)?;
    let &(segments, error) = tried.iter().find(|t| t.1 <= AS_GOOD * least)?;
    let mut options = options.clone();
    (options.degree, options.segments) = ([DEGREE; 2], segments);
    // a height field cannot take normals that point down; the positions are then fitted without normals
    let fit = fit_contacts_over(contacts, axes, &options).or_else(|_| {
        fit_contacts_over(&Contacts { orientation: Orientation::None, ..contacts.clone() }, axes, &options)
    });
    Some(fit.map(|fit| Flexible { fit, tried, error, relief }))
}

/// Whether contacts next to each other over x and y differ in height as those of several sheets do.
fn are_sheets(few: &Contacts, relief: f64) -> bool {
    let places: Vec<Vector> = few.x.iter().zip(&few.y).map(|(x, y)| [*x, *y, 0.0]).collect();
    let tree = Neighbours::new(&places);
    let apart = |i: usize| Some(few.z[i] - few.z[tree.nearest_other(i)?.1]);
    let squares: Vec<f64> = (0..few.len()).filter_map(apart).map(|dz| 0.5 * dz * dz).collect();
    squares.iter().sum::<f64>() > SHEETS * SHEETS * relief * relief * squares.len().max(1) as f64
}

/// What is left out at a time.
#[derive(Clone, Copy)]
enum LeftOut {
    Blocks,
    Contacts,
}

/// Segments with the error of contacts left out, up to where finer fields follow noise.
fn each_left_out(few: &Contacts, box_of: [[f64; 2]; 2], relief: f64, out: LeftOut) -> Vec<([usize; 2], f64)> {
    let mut tried: Vec<([usize; 2], f64)> = Vec::new();
    let (all, per_unknown) = match out {
        LeftOut::Blocks => (&SEGMENTS[..], PER_UNKNOWN),
        LeftOut::Contacts => (&FINE_SEGMENTS[..], PER_FINE_UNKNOWN),
    };
    for segments in all {
        let segments = alike(*segments, box_of);
        let unknowns = ((segments[0] + DEGREE) * (segments[1] + DEGREE)) as f64;
        if per_unknown * unknowns > (few.len() * (GROUPS - 1) / GROUPS) as f64 {
            break;
        }
        match left_out(few, segments, box_of, out) {
            Ok(error) if error.is_finite() => tried.push((segments, error)),
            _ => break,
        }
        let least = tried.iter().map(|t| t.1).fold(f64::INFINITY, f64::min);
        if least < UNPREDICTED * relief && tried.last().is_some_and(|t| t.1 > RISEN * least) {
            break;
        }
    }
    tried
}

/// This many segments along the longer side, and as many of that length as the shorter side takes.
fn alike(segments: usize, box_of: [[f64; 2]; 2]) -> [usize; 2] {
    let sides = box_of.map(|[lo, hi]| hi - lo);
    let longer = sides[0].max(sides[1]);
    sides.map(|side| ((segments as f64 * side / longer).ceil() as usize).clamp(1, segments))
}

fn extent(values: &[f64]) -> [f64; 2] {
    let lo = values.iter().copied().fold(f64::INFINITY, f64::min);
    [lo, values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

/// Root mean square error over all that is left out.
fn left_out(contacts: &Contacts, segments: [usize; 2], [x, y]: [[f64; 2]; 2], out: LeftOut) -> Result<f64, FitError> {
    let block = |v: f64, [lo, hi]: [f64; 2]| ((BLOCKS as f64 * (v - lo) / (hi - lo)) as usize).min(BLOCKS - 1);
    let group = |r: usize| match out {
        LeftOut::Blocks => (block(contacts.x[r], x) + 2 * block(contacts.y[r], y)) % GROUPS,
        // no rows of a lattice are left out together
        LeftOut::Contacts => (GROUPS as f64 * evenly(r)) as usize,
    };
    let mut options = FitOptions::default();
    (options.degree, options.segments) = ([DEGREE; 2], segments);
    options.domain = Some([x[0], x[1], y[0], y[1]]);
    let (mut sum, mut count) = (0.0, 0_usize);
    for number in 0..GROUPS {
        let kept: Vec<u32> = (0..contacts.len() as u32).filter(|&r| group(r as usize) != number).collect();
        let surface = fit_contacts(&contacts.in_order(&kept), &options)?.input_surface()?;
        for r in (0..contacts.len()).filter(|&r| group(r) == number) {
            sum += (contacts.z[r] - surface.at(contacts.x[r], contacts.y[r]).z).powi(2);
            count += 1;
        }
    }
    Ok((sum / count.max(1) as f64).sqrt())
}

fn relief(points: &[Vector]) -> f64 {
    let (plane, _) = palpate_geometry::shape::best_plane(points.iter().copied());
    let off = points.iter().map(|p| (p[2] - (plane[0] + plane[1] * p[0] + plane[2] * p[1])).powi(2));
    (off.sum::<f64>() / points.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_call_for_segments_and_are_predicted() {
        let points: Vec<Vector> = (0..1600)
            .map(|i| [(i % 40) as f64 * 0.2, (i / 40) as f64 * 0.2])
            .map(|[x, y]| [x, y, (2.0 * x).sin() + 0.01 * (37.0 * x + 91.0 * y).sin()])
            .collect();
        let found =
            flexible(&Contacts::from_points(&points), Frame::IDENTITY.axes, &FitOptions::default()).unwrap().unwrap();
        assert!(found.tried.len() > 3 && found.error < 0.2 * found.relief, "{:?} of {}", found.tried, found.relief);
        assert!(found.fit.options().segments[0] >= 8);
    }

    #[test]
    fn waves_shorter_than_blocks_are_predicted_from_their_neighbours() {
        let points: Vec<Vector> = (0..400)
            .map(|i| [(i % 20) as f64 * 0.5, (i / 20) as f64 * 0.5])
            .map(|[x, y]| [x, y, x.sin() + (1.3 * y).cos().powi(2)])
            .collect();
        let found =
            flexible(&Contacts::from_points(&points), Frame::IDENTITY.axes, &FitOptions::default()).unwrap().unwrap();
        assert!(found.error < 0.25 * found.relief, "{:?} of {}", found.tried, found.relief);
    }

    #[test]
    fn two_sheets_over_each_other_are_not_predicted() {
        let points: Vec<Vector> =
            (0..800).map(|i| [(i % 20) as f64, (i / 20) as f64, if i * 7 % 2 == 0 { 0.0 } else { 5.0 }]).collect();
        let found =
            flexible(&Contacts::from_points(&points), Frame::IDENTITY.axes, &FitOptions::default()).unwrap().unwrap();
        assert!(found.error > 0.5 * found.relief);
    }
}
