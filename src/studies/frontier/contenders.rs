//! How near a way is to a request, and which ways may be the pick once they are judged more often.
//!
//! ```text
//! error     what 95 of 100 runs keep of  max(error_S / asked, error_R / asked)  run by run          <= 1 meets
//! time      SPARE x time_hi / budget                                                               <= 1 meets
//! ```

use palpate_numeric::statistics::median;

use super::clock::Clocked;
use super::kept::kept;
use super::measured::Measured;
use super::preference::Preference;
use super::request::Request;

/// A budget is met with so much to spare: between two runs clocks drift by some per cent.
pub(super) const SPARE: f64 = 1.1;
/// Candidates that are judged more often: those near the pick, and no more than time allows.
const MOST_CONTENDERS: usize = 12;
/// Errors by which an estimate may be too large at first, for a candidate that may still be the pick.
const PLAUSIBLE: f64 = 1.25;

/// Those that may be the pick once they are judged more often: of errors the cheapest whose middle run keeps them, of a budget the most
/// accurate within it.
pub(super) fn contenders(measured: &[Measured], request: &Request) -> Vec<usize> {
    let preference = Preference::new(measured);
    let of_errors = request.error_s.is_some() || request.error_r.is_some();
    let in_time = |k: &usize| measured[*k].point.failed.is_none() && time_ratio(&measured[*k], request) <= 1.0;
    let mut able: Vec<usize> = (0..measured.len()).filter(in_time).collect();
    if of_errors {
        able.retain(|k| middle_ratio(&measured[*k], request) <= PLAUSIBLE);
        able.sort_by(|a, b| preference.quick(*a).total_cmp(&preference.quick(*b)).then(a.cmp(b)));
    } else {
        let error = |k: &usize| measured[*k].point.error.unwrap_or(f64::INFINITY);
        able.sort_by(|a, b| error(a).total_cmp(&error(b)).then(a.cmp(b)));
    }
    able.truncate(MOST_CONTENDERS);
    able
}

/// The errors that are kept over those that are asked for, the larger of both; 0 where none is asked for, `None` of too few replicates.
pub(super) fn error_ratio(m: &Measured, request: &Request) -> Option<f64> {
    let asked = [request.error_s, request.error_r];
    if asked == [None, None] {
        return Some(0.0);
    }
    kept(run_ratios(m, request), m.fixed)
}

/// The larger of both errors over what is asked for, run by run.
fn run_ratios(m: &Measured, request: &Request) -> Vec<f64> {
    let asked = [request.error_s, request.error_r];
    let ratio = |run: &[f64; 2]| {
        let each = [0, 1].map(|q| asked[q].map_or(0.0, |asked| run[q] / asked));
        if each.iter().any(|ratio| ratio.is_nan()) { f64::INFINITY } else { each[0].max(each[1]) }
    };
    m.runs.iter().map(ratio).collect()
}

/// That of the run in the middle.
fn middle_ratio(m: &Measured, request: &Request) -> f64 {
    median(run_ratios(m, request)).unwrap_or(f64::INFINITY)
}

pub(super) fn time_ratio(m: &Measured, request: &Request) -> f64 {
    let hi = m.point.seconds.map_or(f64::INFINITY, |time: Clocked| time.hi);
    request.budget.map_or(0.0, |budget| SPARE * hi / budget)
}
