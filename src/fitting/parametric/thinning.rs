//! Contacts that stand for all of many ones while the fit is still far from its minimum.
//!
//! ```text
//! boxes of (u, v) in rows to and fro, the contacts of a box in their order     every g/m-th of them, m of g
//! ```
//!
//! Most steps of a descent, and most estimates of its noise, only find the neighbourhood of the minimum; a few thousand
//! contacts lead there as well as a million. The last steps, the sds and the uncertainty are those of all contacts.

use super::cells::Cells;

/// Contacts for each coefficient, and least number of contacts, that stand for all: with a few hundred the fairness that is
/// estimated from them would vary by more than a tenth.
const FOR_EACH: usize = 30;
const LEAST_CONTACTS: usize = 1200;
/// Fewer than this many times as many contacts are not thinned: the time saved would be small.
const WORTH: usize = 3;

/// Numbers of the contacts that stand for all, ascending; `None` where there are too few to thin.
pub(super) fn thinned(places: &[[f64; 2]], cells: &Cells) -> Option<Vec<usize>> {
    let most = LEAST_CONTACTS.max(FOR_EACH * cells.shape().coefficients());
    if places.len() <= WORTH * most {
        return None;
    }
    let sides = (most as f64).sqrt().ceil();
    let domain = [0, 1].map(|k| cells.knots()[k].domain());
    let place = |p: [f64; 2], k: usize| {
        let [lo, hi] = domain[k];
        ((sides * (p[k] - lo) / (hi - lo)) as usize).min(sides as usize - 1)
    };
    let mut order: Vec<(usize, usize, usize)> = (places.iter().enumerate())
        .map(|(r, p)| {
            let (row, column) = (place(*p, 0), place(*p, 1));
            // to and fro, so that neighbours in the order are neighbours on the surface
            (row, if row % 2 == 0 { column } else { sides as usize - 1 - column }, r)
        })
        .collect();
    order.sort_unstable();
    let mut chosen: Vec<usize> = (0..most).map(|k| order[k * (order.len() - 1) / (most - 1)].2).collect();
    chosen.sort_unstable();
    Some(chosen)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::bspline::Knots;

    #[test]
    fn the_chosen_ones_are_spread_as_all_are() {
        let knots = || Knots::uniform(3, 1, 0.0, 1.0).unwrap();
        let cells = Cells::new([knots(), knots()]);
        // three quarters of the contacts lie in one half
        let at = |r: usize, step: f64| (r as f64 * step).fract();
        let places: Vec<[f64; 2]> = (0..20_000)
            .map(|r| [at(r, 0.754_877_666) * if r % 2 == 0 { 0.5 } else { 1.0 }, at(r, 0.569_840_291)])
            .collect();
        let chosen = thinned(&places, &cells).unwrap();
        assert_eq!(chosen.len(), LEAST_CONTACTS);
        let left = chosen.iter().filter(|r| places[**r][0] < 0.5).count() as f64 / LEAST_CONTACTS as f64;
        assert!((left - 0.75).abs() < 0.01, "{left}");
        assert!(chosen.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(thinned(&places[..WORTH * LEAST_CONTACTS], &cells), None);
    }
}
