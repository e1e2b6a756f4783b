//! Which of many contacts a map shows, and how large their dots may be without hiding it.
//!
//! ```text
//! cells of about span / sqrt(most) over the map; of each cell the contact nearest to its middle
//! radius    at most a part of the distance that half of the dots keep from their fourth neighbour
//! ```
//!
//! Every so many-th contact would do for contacts without an order. Those of grids and of fingers have one, and would stand
//! in stripes.

/// The neighbour that is looked at: on a lattice as far away as the first, and not the same place touched again.
const NEIGHBOUR: usize = 4;
/// Part of the distance between neighbours that a dot's radius may take.
const PART: f64 = 0.24;
/// Radius of the smallest dot that is still seen, pixels.
const SMALLEST: f64 = 0.6;
/// Dots whose distances are looked at: some pairs of these cost nothing.
const SAMPLE: usize = 300;

/// Numbers of at most `most` of the places, spread evenly over all of them; all where there are no more. Places without a
/// number are left out.
pub(super) fn evenly(places: &[[f64; 2]], most: usize) -> Vec<usize> {
    let finite: Vec<usize> = (0..places.len()).filter(|k| places[*k].iter().all(|v| v.is_finite())).collect();
    if finite.len() <= most {
        return finite;
    }
    let ends = [0, 1].map(|axis| {
        let of = finite.iter().map(|k| places[*k][axis]);
        of.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)])
    });
    let spans = ends.map(|[lo, hi]| hi - lo);
    // square cells, and no more of them than dots
    let widest = spans[0].max(spans[1]);
    let mut side = (spans[0] * spans[1] / most.max(1) as f64).sqrt().max(widest / most.max(1) as f64);
    let cells = |side: f64| spans.map(|span| ((span / side).floor() as usize).max(1));
    while side > 0.0 && cells(side).iter().product::<usize>() > most {
        side *= 1.01;
    }
    let counts = if side > 0.0 { cells(side) } else { [1, 1] };
    let share = |k: usize, axis: usize| {
        let span = spans[axis];
        if span > 0.0 { (places[k][axis] - ends[axis][0]) / span * counts[axis] as f64 } else { 0.5 }
    };
    let mut nearest: Vec<Option<(f64, usize)>> = vec![None; counts[0] * counts[1]];
    for k in finite {
        let at = [0, 1].map(|axis| share(k, axis));
        let cell = [0, 1].map(|axis| (at[axis] as usize).min(counts[axis] - 1));
        let away = (at[0] - cell[0] as f64 - 0.5).hypot(at[1] - cell[1] as f64 - 0.5);
        let best = &mut nearest[cell[0] * counts[1] + cell[1]];
        if best.is_none_or(|(least, _)| away < least) {
            *best = Some((away, k));
        }
    }
    let mut chosen: Vec<usize> = nearest.into_iter().flatten().map(|(_, k)| k).collect();
    chosen.sort_unstable();
    chosen
}

/// Radius of dots at these pixels: `largest`, or less where they stand so near that they would hide what lies below.
pub(super) fn radius(dots: &[[f64; 2]], largest: f64) -> f64 {
    let step = dots.len().div_ceil(SAMPLE).max(1);
    let nearest = |from: &[f64; 2]| {
        let mut away: Vec<f64> = dots.iter().map(|to| (to[0] - from[0]).hypot(to[1] - from[1])).collect();
        // the dot itself is the nearest of all
        if away.len() <= NEIGHBOUR {
            return f64::INFINITY;
        }
        *away.select_nth_unstable_by(NEIGHBOUR, f64::total_cmp).1
    };
    let mut all: Vec<f64> = dots.iter().step_by(step).map(nearest).collect();
    all.sort_by(f64::total_cmp);
    let middle = all.get(all.len() / 2).copied().unwrap_or(f64::INFINITY);
    (PART * middle).clamp(SMALLEST.min(largest), largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_grid_rows_and_columns_are_taken_alike() {
        let places: Vec<[f64; 2]> = (0..60 * 40).map(|k| [(k / 40) as f64, (k % 40) as f64]).collect();
        let chosen = evenly(&places, 600);
        assert!((300..=600).contains(&chosen.len()), "{}", chosen.len());
        // no two neighbours are closer, and no gap wider, than even dots have them
        for k in &chosen {
            let away = |l: &&usize| (places[**l][0] - places[*k][0]).hypot(places[**l][1] - places[*k][1]);
            let nearest = chosen.iter().filter(|l| *l != k).map(|l| away(&l)).fold(f64::INFINITY, f64::min);
            assert!((1.0..=3.0).contains(&nearest), "{nearest}");
        }
        assert_eq!(evenly(&places[..50], 600).len(), 50);
        assert_eq!(evenly(&[[f64::NAN, 0.0], [1.0, 2.0]], 1), [1]);
        assert_eq!(evenly(&[[1.0, 2.0]; 9], 3).len(), 1);
        assert!(evenly(&[[0.0, 1.0], [1.0, 1.0], [2.0, 1.0], [3.0, 1.0]], 2).len() <= 2);
    }

    #[test]
    fn dots_that_stand_near_each_other_are_small() {
        let lattice = |apart: f64| -> Vec<[f64; 2]> {
            (0..100).map(|k| [apart * f64::from(k % 10), apart * f64::from(k / 10)]).collect()
        };
        assert_eq!(radius(&lattice(20.0), 1.7), 1.7);
        assert!((radius(&lattice(4.0), 1.7) - 0.96).abs() < 1e-9);
        assert_eq!(radius(&lattice(0.1), 1.7), SMALLEST);
        // two touches of every place, a hair apart, are as large as one
        let twice: Vec<[f64; 2]> = lattice(20.0).into_iter().flat_map(|[x, y]| [[x, y], [x + 0.3, y]]).collect();
        assert_eq!(radius(&twice, 1.7), 1.7);
        assert_eq!((radius(&[], 1.7), radius(&[[1.0, 1.0]], 1.7)), (1.7, 1.7));
    }
}
