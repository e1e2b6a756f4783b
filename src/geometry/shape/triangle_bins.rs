//! Triangles of the plane sorted into cells, so that a place is held against those that may hold it and no others.
//!
//! ```text
//! cells n x n over the extent of all corners, n about sqrt(triangles)       one place O(1), building O(triangles)
//! ```

/// A place that lies beyond a triangle by so small a share of the extent of all is still held against it: the rim of a triangle and
/// the rounding of periods are far smaller.
const SLACK: f64 = 1e-6;
/// Cells that a triangle lies in, on average, at most: beyond, as with long slivers, cells are made coarser.
const SPREAD: usize = 16;
/// Periods that the triangles may reach over. Corners of a file may lie anywhere, and every period is a place to look at.
const PERIODS: f64 = 8.0;

/// Which triangles lie in each cell.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TriangleBins {
    lo: [f64; 2],
    hi: [f64; 2],
    /// Cells in each direction.
    cells: usize,
    /// Where each cell's triangles begin in the list below, and where the last one's end.
    starts: Vec<u32>,
    triangles: Vec<u32>,
    period: [Option<f64>; 2],
}

impl TriangleBins {
    /// `None` where all triangles are to be looked at: few, of no extent, or over very many periods.
    pub(super) fn new(triangles: &[[[f64; 2]; 3]], period: [Option<f64>; 2]) -> Option<TriangleBins> {
        let corners = || triangles.iter().flatten();
        let lo = [0, 1].map(|k| corners().fold(f64::INFINITY, |least, p| least.min(p[k])));
        let hi = [0, 1].map(|k| corners().fold(f64::NEG_INFINITY, |most, p| most.max(p[k])));
        let width = [hi[0] - lo[0], hi[1] - lo[1]];
        let is_sound = (0..2).all(|k| {
            width[k] > 0.0 && width[k].is_finite() && period[k].is_none_or(|q| q > 0.0 && width[k] <= PERIODS * q)
        });
        if !is_sound {
            return None;
        }
        let mut bins = TriangleBins { lo, hi, cells: 0, starts: Vec::new(), triangles: Vec::new(), period };
        let mut cells = (triangles.len() as f64).sqrt().ceil() as usize;
        while cells > 1 {
            bins.cells = cells;
            let covered: usize = triangles.iter().map(|t| bins.cells_of(t).count()).sum();
            if covered <= SPREAD * triangles.len() {
                bins.fill(triangles);
                return Some(bins);
            }
            cells /= 2;
        }
        None
    }

    /// Sorts the triangles into the cells.
    fn fill(&mut self, triangles: &[[[f64; 2]; 3]]) {
        let mut lists = vec![Vec::new(); self.cells * self.cells];
        for (triangle, number) in triangles.iter().zip(0_u32..) {
            self.cells_of(triangle).for_each(|cell| lists[cell].push(number));
        }
        self.starts = vec![0];
        for list in lists {
            self.triangles.extend(list);
            self.starts.push(self.triangles.len() as u32);
        }
    }

    /// The cell of a coordinate in one direction, the outermost for what lies outside.
    fn cell(&self, k: usize, at: f64) -> usize {
        let share = (at - self.lo[k]) / (self.hi[k] - self.lo[k]);
        // a cast takes what is below 0 to 0
        ((share * self.cells as f64) as usize).min(self.cells - 1)
    }

    /// Cells that the triangle's box lies in.
    fn cells_of(&self, triangle: &[[f64; 2]; 3]) -> impl Iterator<Item = usize> + use<> {
        let ends = [0, 1].map(|k| {
            let slack = SLACK * (self.hi[k] - self.lo[k]);
            let of = |fold: fn(f64, f64) -> f64| fold(fold(triangle[0][k], triangle[1][k]), triangle[2][k]);
            [self.cell(k, of(f64::min) - slack), self.cell(k, of(f64::max) + slack)]
        });
        let cells = self.cells;
        (ends[0][0]..=ends[0][1]).flat_map(move |i| (ends[1][0]..=ends[1][1]).map(move |j| i * cells + j))
    }

    /// The places among the triangles that a coordinate may mean: itself, and where it is a period on.
    fn images(&self, k: usize, at: f64) -> impl Iterator<Item = f64> + Clone {
        let slack = SLACK * (self.hi[k] - self.lo[k]);
        let (first, last, period) = match self.period[k] {
            Some(q) => (((self.lo[k] - slack - at) / q).ceil(), ((self.hi[k] + slack - at) / q).floor(), q),
            None => (0.0, 0.0, 0.0),
        };
        let count = if last >= first { (last - first) as usize + 1 } else { 0 };
        (0..count).map(move |i| at + (first + i as f64) * period)
    }

    /// Numbers of the triangles that may hold the place or one that is periods on; some come more than once.
    pub(super) fn near(&self, at: [f64; 2]) -> impl Iterator<Item = usize> {
        let second = self.images(1, at[1]);
        self.images(0, at[0]).flat_map(move |u| second.clone().map(move |v| [u, v])).flat_map(|place| {
            let cell = self.cell(0, place[0]) * self.cells + self.cell(1, place[1]);
            self.triangles[self.starts[cell] as usize..self.starts[cell + 1] as usize].iter().map(|t| *t as usize)
        })
    }
}
