//! What contacts show of a member, in standard deviations, beside the true surface, and the means of S and R.
//!
//! ```text
//! residual = (z - z0)/sd_z, (n - n0)/sd_n over all places          derivatives: differences of members moved by a step
//! ```

use super::member::Member;

/// Step of the differences.
const STEP_OF_DIFFERENCES: f64 = 1e-5;

/// Rigid motions: three rotations, three shifts.
pub(crate) const MOTIONS: usize = 6;

/// Places each way that S and R are averaged over.
const AVERAGED: usize = 8;

/// S (0) or R (1) that a member must have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held {
    pub(crate) quantity: usize,
    pub(crate) value: f64,
    /// What is let pass.
    pub(crate) within: f64,
}

/// Of the residual, a column for each number, and of S and R.
pub(crate) type Derivatives = (Vec<Vec<f64>>, Vec<[f64; 2]>);

pub(crate) struct View {
    places: Vec<[f64; 2]>,
    grid: Vec<[f64; 2]>,
    sd: [f64; 2],
    /// Heights of the true surface over places and grid, where members are sought.
    near: [Vec<f64>; 2],
    truth: Vec<f64>,
    /// Mean height.
    pub(crate) middle: f64,
}

impl View {
    pub(crate) fn new(truth: &Member, places: Vec<[f64; 2]>, sd: [f64; 2]) -> View {
        let axis = palpate_world::scene::linspace(-4.0, 4.0, AVERAGED);
        let grid: Vec<[f64; 2]> = axis.iter().flat_map(|x| axis.iter().map(move |y| [*x, *y])).collect();
        let heights = |list: &[[f64; 2]]| -> Vec<f64> {
            list.iter().map(|p| truth.seen(*p, 0.0).map_or(0.0, |seen| seen.z)).collect()
        };
        let near = [heights(&places), heights(&grid)];
        let middle = near[0].iter().sum::<f64>() / places.len() as f64;
        let mut view = View { places, grid, sd, near, truth: Vec::new(), middle };
        view.truth = view.sight(truth).expect("the true surface lies under the whole patch");
        view
    }

    fn sight(&self, member: &Member) -> Option<Vec<f64>> {
        let body = member.kind.body(&member.sizes);
        let mut sight = Vec::with_capacity(4 * self.places.len());
        for (place, near) in self.places.iter().zip(&self.near[0]) {
            let seen = member.seen_of(&body, *place, *near)?;
            sight.push(seen.z / self.sd[0]);
            sight.extend(seen.normal.map(|n| n / self.sd[1]));
        }
        Some(sight)
    }

    /// Means of S and R.
    pub(crate) fn shape(&self, member: &Member) -> Option<[f64; 2]> {
        let body = member.kind.body(&member.sizes);
        let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
        for (place, near) in self.grid.iter().zip(&self.near[1]) {
            let seen = member.seen_of(&body, *place, *near)?;
            for q in 0..2 {
                sums[q] += seen.shape[q].unwrap_or(0.0);
                counts[q] += f64::from(u8::from(seen.shape[q].is_some()));
            }
        }
        Some([sums[0] / f64::max(counts[0], 1.0), sums[1] / counts[1]])
    }

    /// Sight less truth, and how far a held value is missed.
    pub(crate) fn residual(&self, member: &Member, held: Option<Held>) -> Option<Vec<f64>> {
        let mut residual = self.sight(member)?;
        residual.iter_mut().zip(&self.truth).for_each(|(own, truth)| *own -= truth);
        if let Some(held) = held {
            residual.push((self.shape(member)?[held.quantity] - held.value) / held.within);
        }
        residual.iter().all(|v| v.is_finite()).then_some(residual)
    }

    /// Distance from the true surface, in noise.
    pub(crate) fn distance(&self, member: &Member) -> Option<f64> {
        Some(self.residual(member, None)?.iter().map(|v| v * v).sum::<f64>().sqrt())
    }

    /// Derivatives of the residual by sizes, rotations and shifts, and those of S and R.
    pub(crate) fn derivatives(&self, member: &Member, held: Option<Held>) -> Option<Derivatives> {
        let (mut columns, mut slopes) = (Vec::new(), Vec::new());
        for number in 0..member.sizes.len() + MOTIONS {
            let [ahead, behind] = [STEP_OF_DIFFERENCES, -STEP_OF_DIFFERENCES].map(|step| stepped(member, number, step));
            let (a, b) = (self.sight(&ahead)?, self.sight(&behind)?);
            let mut column: Vec<f64> = a.iter().zip(&b).map(|(a, b)| (a - b) / (2.0 * STEP_OF_DIFFERENCES)).collect();
            let (a, b) = (self.shape(&ahead)?, self.shape(&behind)?);
            let slope = [0, 1].map(|q| (a[q] - b[q]) / (2.0 * STEP_OF_DIFFERENCES));
            column.extend(held.map(|held| slope[held.quantity] / held.within));
            columns.push(column);
            slopes.push(slope);
        }
        Some((columns, slopes))
    }

    /// Whether a scene's fingers would touch the member where it was seen, and nothing above it.
    pub(crate) fn is_touched(&self, member: &Member) -> bool {
        let surface = member.surface();
        self.places.iter().zip(&self.near[0]).all(|(place, near)| {
            let seen = member.seen(*place, *near).map(|seen| seen.z);
            seen.zip(surface.height(place[0], place[1])).is_some_and(|(seen, touched)| (seen - touched).abs() < 1e-6)
        })
    }
}

fn stepped(member: &Member, number: usize, step: f64) -> Member {
    let sizes = member.sizes.len();
    if number < sizes {
        let mut moved = member.clone();
        moved.sizes[number] += step;
        return moved;
    }
    let one = |k: usize| if number - sizes == k { step } else { 0.0 };
    member.moved([0, 1, 2].map(one), [3, 4, 5].map(one))
}
