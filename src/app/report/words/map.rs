//! S and R over the patch as characters, x to the right and y upwards, for a look without leaving the terminal.
//!
//! ```text
//! least ▁ ▂ ▃ ▄ ▅ ▆ ▇ █ largest        · not among the contacts
//! ```

use palpate_geometry::shape::ShapeMaps;

use super::super::table::significant;

/// From the least value to the largest.
const STEPS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// Most characters per side; of a finer grid every so many points are shown.
const MOST_CHARACTERS: usize = 24;

/// Values that differ by less than this fraction are one value.
const LEAST_DIFFERENCE: f64 = 0.01;

/// Both maps below each other; nothing where there is nothing to see.
pub(in crate::report) fn small_maps(maps: &ShapeMaps) -> String {
    let s = small_map("S", maps, |i, j| maps.shape_index_at(i, j));
    let r = small_map("R", maps, |i, j| maps.curvedness_at(i, j));
    [s, r].into_iter().flatten().collect::<Vec<_>>().join("\n")
}

fn small_map(name: &str, maps: &ShapeMaps, value: impl Fn(usize, usize) -> Option<f64>) -> Option<String> {
    let every = |count: usize| (0..count).step_by(count.div_ceil(MOST_CHARACTERS)).collect::<Vec<_>>();
    let (columns, rows) = (every(maps.grid.x.len()), every(maps.grid.y.len()));
    let at = |i, j| value(i, j).filter(|v| v.is_finite());
    let all = columns.iter().flat_map(|i| rows.iter().filter_map(|j| at(*i, *j)));
    let (lo, hi) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
    // without any value the ends are infinite, and there is no map either
    let differs = hi - lo > LEAST_DIFFERENCE * hi.abs().max(lo.abs());
    if !differs {
        return None;
    }
    let step = |v: f64| STEPS[(((v - lo) / (hi - lo) * STEPS.len() as f64) as usize).min(STEPS.len() - 1)];
    let line = |j: &usize| -> String {
        // twice, since a character is half as wide as high
        columns.iter().flat_map(|i| [at(*i, *j).map_or('·', step); 2]).collect()
    };
    let lines: Vec<String> = rows.iter().rev().map(line).collect();
    let [lo, hi] = [lo, hi].map(|v| significant(v, 3));
    Some(format!("{name} from {lo} ▁ to {hi} █ over the patch, x to the right, y upwards\n{}\n", lines.join("\n")))
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;
    use palpate_fitting::fit::{FitOptions, fit_contacts};
    use palpate_geometry::contact::Contacts;

    #[test]
    fn the_largest_value_stands_where_it_is() {
        let (x, y): (Vec<f64>, Vec<f64>) = (0..36).map(|k| ((k % 6) as f64, (k / 6) as f64)).unzip();
        let z = x.iter().zip(&y).map(|(x, y)| x * x * x * (1.0 + y)).collect();
        let fit = fit_contacts(&Contacts::from_positions(x, y, z), &FitOptions::default().with_degrees(3, 3)).unwrap();
        let mut maps = fit.shape().maps.clone();
        maps.supported = Array2::from_elem(maps.supported.dim(), true);
        maps.curvedness =
            Array2::from_shape_fn(maps.curvedness.dim(), |(i, j)| if (i, j) == (7, 7) { 2.0 } else { 1.0 });
        let text = small_map("R", &maps, |i, j| maps.curvedness_at(i, j)).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 9);
        // largest x and y: the upper right corner
        assert!(lines[1].ends_with("▁██") && !lines[2].contains('█'), "{text}");
        maps.curvedness.fill(1.0);
        assert_eq!(small_map("R", &maps, |i, j| maps.curvedness_at(i, j)), None);
    }
}
