//! The few ways that a newcomer is shown, and the one to take where nothing is asked for.
//!
//! ```text
//! row 1      the simplest of the quickest
//! row i + 1  of the ways that are certainly more accurate than row i, by a factor: the simplest of the quickest as accurate ones
//! and        what is recognised where no model is named, which is what everyone gets
//! take       of the ways as accurate as the best within noise: the simplest of the quickest; of a file what is recognised, if it is one
//! ```
//!
//! The factor is the least with which the rows are few. Errors of S and R are no part of what is known of a file, so that there the
//! recognised answer is taken among equals: it alone says how sure they are.

use super::measured::Measured;
use super::point::Point;
use super::preference::Preference;

/// Rows at most, and those of them that name a model.
const MOST_ROWS: usize = 5;
const MOST_NAMED: usize = 4;
/// Errors that differ by less are alike: the rms of a hundred replicates is known to some 10 %.
const ALIKE_ERRORS: f64 = 1.25;
/// Times that differ by less are alike: a machine that does other things besides errs by as much.
const ALIKE_TIMES: f64 = 1.6;
/// By so much the factor between rows grows until they are few.
const WIDER: f64 = 1.3;

/// What is shown first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shortlist {
    /// Places of the rows among the ways, the quickest first.
    pub rows: Vec<usize>,
    /// The place of the one to take.
    pub taken: Option<usize>,
    /// Why that one.
    pub why: &'static str,
}

/// The rows of a scene, or of a file whose truth is unknown. Ways that touch at other places than the scene does answer another question.
pub fn shortlist(ways: &[Measured], truth_known: bool) -> Shortlist {
    let preference = Preference::new(ways);
    let stands = |k: &usize| ways[*k].configuration.stations.is_none() && ends(&ways[*k].point).is_some();
    let standing: Vec<usize> = (0..ways.len()).filter(stands).collect();
    let Some((taken, why)) = recommended(ways, &standing, &preference, truth_known) else {
        return Shortlist::default();
    };
    let recognised = standing.iter().copied().find(|k| ways[*k].configuration.recognised);
    let mut factor = ALIKE_ERRORS;
    let mut rows = loop {
        let rows = stairs(ways, &standing, &preference, factor);
        if rows.iter().filter(|k| Some(**k) != recognised).count() <= MOST_NAMED {
            break rows;
        }
        factor *= WIDER;
    };
    for own in recognised.into_iter().chain([taken]).filter(|own| !rows.contains(own)).collect::<Vec<_>>() {
        if rows.len() >= MOST_ROWS {
            let kept = |k: &usize| *k == taken || Some(*k) == recognised;
            let away = |k: &usize| (error(ways, *k) / error(ways, own)).ln().abs();
            let nearest = rows.iter().filter(|k| !kept(k)).min_by(|a, b| away(a).total_cmp(&away(b))).copied();
            rows.retain(|k| Some(*k) != nearest);
        }
        rows.push(own);
    }
    rows.dedup();
    rows.sort_by(|a, b| preference.quick(*a).total_cmp(&preference.quick(*b)).then(a.cmp(b)));
    Shortlist { rows, taken: Some(taken), why }
}

/// How many times as long as its quickest round a call took in half of the rounds, the middle of all ways: 1 of a quiet machine.
pub fn clock_spread(points: &[Point]) -> Option<f64> {
    let ratio = |point: &Point| point.seconds.map(|time| time.median / time.least);
    let mut ratios: Vec<f64> = points.iter().filter_map(ratio).filter(|ratio| ratio.is_finite()).collect();
    ratios.sort_unstable_by(f64::total_cmp);
    ratios.get(ratios.len() / 2).copied()
}

/// Both ends of a point's error, where it has an answer and a time.
fn ends(point: &Point) -> Option<[f64; 2]> {
    point.error_interval.filter(|_| point.failed.is_none() && point.seconds.is_some() && point.error.is_some())
}

fn error(ways: &[Measured], k: usize) -> f64 {
    ways[k].point.error.unwrap_or(f64::INFINITY)
}

/// Those as accurate as the best of these: within its interval, or alike.
fn as_accurate(ways: &[Measured], of: &[usize]) -> Vec<usize> {
    let best = of.iter().copied().min_by(|a, b| error(ways, *a).total_cmp(&error(ways, *b)));
    let Some(best) = best else { return Vec::new() };
    let high = ends(&ways[best].point).map_or(f64::INFINITY, |[_, high]| high);
    let most = high.max(ALIKE_ERRORS * error(ways, best));
    of.iter().copied().filter(|k| error(ways, *k) <= most).collect()
}

/// The one to take, and why.
fn recommended(
    ways: &[Measured],
    standing: &[usize],
    preference: &Preference,
    truth_known: bool,
) -> Option<(usize, &'static str)> {
    let accurate = as_accurate(ways, standing);
    let recognised = accurate.iter().copied().find(|k| ways[*k].configuration.recognised);
    if let Some(recognised) = recognised.filter(|_| !truth_known) {
        return Some((recognised, "nothing foretells contacts better, and it says how sure S and R are"));
    }
    let taken = preference.taken(&accurate, ALIKE_TIMES)?;
    let why = match (accurate.len(), truth_known) {
        (1, true) => "no other way is as accurate",
        (_, true) => "the simplest of the quickest ways that are as accurate as any",
        (_, false) => "the simplest of the quickest ways that foretell contacts as well as any",
    };
    Some((taken, why))
}

/// Rows of which each is certainly more accurate than the one before, by this factor.
fn stairs(ways: &[Measured], standing: &[usize], preference: &Preference, factor: f64) -> Vec<usize> {
    let (mut rows, mut below) = (Vec::new(), [f64::INFINITY; 2]);
    loop {
        let better = |k: &usize| {
            let [lo, surely] = below;
            error(ways, *k) < lo && ends(&ways[*k].point).is_some_and(|[_, high]| high <= surely)
        };
        let better: Vec<usize> = standing.iter().copied().filter(better).collect();
        let least = better.iter().map(|k| preference.quick(*k)).fold(f64::INFINITY, f64::min);
        let quick: Vec<usize> = better.into_iter().filter(|k| preference.quick(*k) <= ALIKE_TIMES * least).collect();
        let Some(row) = preference.taken(&as_accurate(ways, &quick), ALIKE_TIMES) else { return rows };
        let [low, _] = ends(&ways[row].point).unwrap_or([0.0; 2]);
        below = [error(ways, row) / factor, low];
        rows.push(row);
    }
}

#[cfg(test)]
mod tests {
    use super::super::clock::Clocked;
    use super::super::configuration::Configuration;
    use super::*;
    use palpate_fitting::fit::{FitOptions, Objective, SlopeWeights};
    use palpate_numeric::draws::Lcg;

    fn way(degree: usize, weights: SlopeWeights, error: f64, seconds: f64) -> Measured {
        let objective = Objective::Slopes(weights);
        let options = FitOptions { degree: [degree; 2], objective, ..FitOptions::default() };
        let seconds = Clocked { median: 1.1 * seconds, lo: seconds, hi: 1.2 * seconds, least: seconds };
        let point = Point {
            error: Some(error),
            error_interval: Some([0.95 * error, 1.05 * error]),
            seconds: Some(seconds),
            ..Point::default()
        };
        let configuration = Configuration { options, stations: None, recognised: false };
        Measured { configuration, point, runs: Vec::new(), fixed: false }
    }

    fn recognised(error: f64, seconds: f64) -> Measured {
        let own = way(2, SlopeWeights::Auto, error, seconds);
        Measured { configuration: Configuration { recognised: true, ..own.configuration }, ..own }
    }

    /// Ways on six levels of error, three of them alike on each, and what is recognised.
    fn ways(jitter: &mut dyn FnMut() -> f64) -> Vec<Measured> {
        let presets = [SlopeWeights::Tangent, SlopeWeights::Position, SlopeWeights::Equal];
        let mut all = vec![recognised(2e-4, 12e-3 * jitter())];
        for degree in 2..8 {
            for (k, weights) in presets.into_iter().enumerate() {
                let error = 0.5_f64.powi(2 * degree as i32) * (1.0 + 0.05 * k as f64);
                all.push(way(degree, weights, error, 50e-6 * 2.5_f64.powi(degree as i32) * jitter()));
            }
        }
        all
    }

    #[test]
    fn rows_are_few_and_each_is_more_accurate_and_dearer() {
        let all = ways(&mut || 1.0);
        let found = shortlist(&all, true);
        assert!((3..=MOST_ROWS).contains(&found.rows.len()), "{found:?}");
        let named: Vec<usize> = found.rows.iter().copied().filter(|k| *k > 0).collect();
        assert!(named.windows(2).all(|pair| error(&all, pair[1]) < error(&all, pair[0]) / ALIKE_ERRORS), "{found:?}");
        // the first of the presets that are alike
        assert!(found.rows.contains(&0) && named.iter().all(|k| k % 3 == 1), "{found:?}");
        assert_eq!(found.taken, found.rows.last().copied());
    }

    #[test]
    fn a_noisy_clock_changes_no_row_and_no_pick() {
        let quiet = shortlist(&ways(&mut || 1.0), true);
        for run in 0..200 {
            let mut draws = Lcg::new(run);
            // the least of many rounds, up to a fifth longer
            let found = shortlist(&ways(&mut || 1.0 + 0.2 * draws.uniform()), true);
            assert_eq!(found, quiet, "run {run}");
        }
    }

    #[test]
    fn of_a_file_what_is_recognised_is_taken_among_equals_alone() {
        let at = |error: f64| [recognised(error, 12e-3), way(2, SlopeWeights::Equal, 0.05, 50e-6)];
        assert_eq!(shortlist(&at(0.052), false).taken, Some(0));
        assert_eq!(shortlist(&at(0.052), true).taken, Some(1));
        assert_eq!(shortlist(&at(0.3), false).taken, Some(1));
        // it is shown in any case
        assert_eq!(shortlist(&at(0.3), false).rows, [1, 0]);
        assert_eq!(shortlist(&[], false), Shortlist::default());
    }

    #[test]
    fn a_clock_that_is_quiet_has_no_spread() {
        let points: Vec<Point> = ways(&mut || 1.0).into_iter().map(|way| way.point).collect();
        assert!((clock_spread(&points).unwrap() - 1.1).abs() < 1e-12 && clock_spread(&[]).is_none());
    }
}
