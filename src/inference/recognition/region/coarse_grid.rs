//! Some rows and columns of a fine map, at which every draw is taken, and what lies between them.
//!
//! ```text
//! rows i_0 < i_1 < ..., as evenly as whole numbers allow, the first and the last of the map among them; columns likewise
//! between four of these points the value is linear in both numbers
//! ```

/// Numbers of the chosen rows and columns of a map.
pub(crate) struct CoarseGrid {
    lines: [Vec<usize>; 2],
    columns: usize,
}

impl CoarseGrid {
    /// At most `most` rows and columns of a map of `n x m` points; all of them where it has no more.
    pub(crate) fn of([n, m]: [usize; 2], most: usize) -> CoarseGrid {
        let lines = |count: usize| {
            let kept = count.min(most);
            let steps = kept.saturating_sub(1).max(1);
            (0..kept).map(|k| (k * (count - 1) + steps / 2) / steps).collect()
        };
        CoarseGrid { lines: [lines(n), lines(m)], columns: m }
    }

    /// Numbers of the chosen points in the map, whose second direction runs fastest.
    pub(crate) fn numbers(&self) -> Vec<usize> {
        let [rows, columns] = &self.lines;
        rows.iter().flat_map(|i| columns.iter().map(move |j| i * self.columns + j)).collect()
    }

    /// Where the chosen rows and columns lie in the map, 0 to 1.
    pub(crate) fn shares(&self, [n, m]: [usize; 2]) -> [Vec<f64>; 2] {
        let [rows, columns] = &self.lines;
        [(rows, n), (columns, m)].map(|(lines, count)| {
            let steps = count.saturating_sub(1).max(1) as f64;
            lines.iter().map(|line| *line as f64 / steps).collect()
        })
    }

    /// Values at point `number` of the map, from those at the chosen points.
    pub(crate) fn between<const N: usize>(&self, chosen: &[[f64; N]], number: usize) -> [f64; N] {
        let [(i, s), (j, t)] = [(0, number / self.columns), (1, number % self.columns)].map(|(k, at)| self.cell(k, at));
        let width = self.lines[1].len();
        let at = |i: usize, j: usize| {
            let [i, j] = [i.min(self.lines[0].len() - 1), j.min(width - 1)];
            chosen.get(i * width + j).copied().unwrap_or([0.0; N])
        };
        let corners = [(at(i, j), (1.0 - s) * (1.0 - t)), (at(i, j + 1), (1.0 - s) * t), (at(i + 1, j), s * (1.0 - t))];
        let last = (at(i + 1, j + 1), s * t);
        // a corner without a share says nothing, not even that it is no number
        let shares = corners.into_iter().chain([last]).filter(|(_, share)| *share > 0.0);
        shares.fold([0.0; N], |sum, (value, share)| std::array::from_fn(|k| sum[k] + share * value[k]))
    }

    /// The chosen line at or before line `at`, and how far `at` lies towards the next, 0 to 1.
    fn cell(&self, direction: usize, at: usize) -> (usize, f64) {
        let lines = &self.lines[direction];
        let first = lines.partition_point(|line| *line <= at).saturating_sub(1);
        let gap = lines.get(first + 1).map_or(1, |next| next - lines[first]);
        (first, (at - lines[first]) as f64 / gap as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_map_is_taken_whole_and_a_fine_one_is_linear_between() {
        let small = CoarseGrid::of([3, 4], 16);
        assert_eq!(small.numbers(), (0..12).collect::<Vec<usize>>());
        for grid in [[24, 40], [2, 100], [17, 16]] {
            let coarse = CoarseGrid::of(grid, 16);
            let place = |number: usize| [(number / grid[1]) as f64, 3.0 - (number % grid[1]) as f64];
            let chosen: Vec<[f64; 2]> = coarse.numbers().into_iter().map(place).collect();
            assert!(chosen.len() <= 256 && coarse.numbers().contains(&(grid[0] * grid[1] - 1)));
            for number in 0..grid[0] * grid[1] {
                let [a, b] = coarse.between(&chosen, number);
                let [x, y] = place(number);
                assert!((a - x).abs() + (b - y).abs() < 1e-12, "{grid:?} {number}");
            }
        }
    }
}
