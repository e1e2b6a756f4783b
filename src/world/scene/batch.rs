//! Replicates of one scene side by side, on which the stages of a scene act one after the other.
//!
//! ```text
//! reading = contact * replicates + replicate        all replicates of one contact stand next to each other
//! ```
//!
//! This order makes the random numbers of one contact, over all replicates, one run of the generator.

use super::surface::SurfacePoint;
use palpate_numeric::draws::EffectDraws;

/// The readings of several replicates. Reading `contact * replicates + replicate` of every column belongs to that
/// contact in that replicate, the replicate being counted from 0 in this batch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactBatch {
    first_replicate: u64,
    replicates: usize,
    /// Measured points, input units.
    pub points: Vec<[f64; 3]>,
    /// Measured unit normals.
    pub normals: Vec<[f64; 3]>,
    /// Readings that were lost; empty when no effect loses any.
    pub lost: Vec<bool>,
    /// Size of the contact force; empty when no effect sets it.
    pub(crate) loads: Vec<f64>,
    /// Memory for draws, kept from one stage to the next.
    drawn: Vec<f64>,
}

impl ContactBatch {
    /// How many replicates the batch holds.
    pub fn replicates(&self) -> usize {
        self.replicates
    }

    /// Number of the first replicate.
    pub fn first_replicate(&self) -> u64 {
        self.first_replicate
    }

    /// Number of nominal contacts.
    pub fn contacts(&self) -> usize {
        self.points.len().checked_div(self.replicates).unwrap_or(0)
    }

    /// Whether the reading of `contact` was lost in one replicate, counted from 0 in this batch.
    pub fn is_lost(&self, contact: usize, replicate: usize) -> bool {
        self.lost.get(contact * self.replicates + replicate).copied().unwrap_or(false)
    }

    /// Fills the batch with what was touched, for replicates on which no stage has acted yet.
    pub(super) fn start(&mut self, touched: &[SurfacePoint], first_replicate: u64, replicates: usize) {
        self.first_replicate = first_replicate;
        self.replicates = replicates;
        self.lost.clear();
        self.loads.clear();
        self.points.clear();
        self.normals.clear();
        for touch in touched {
            self.points.extend(std::iter::repeat_n(touch.point, replicates));
            self.normals.extend(std::iter::repeat_n(touch.local.normal, replicates));
        }
    }

    /// Marks a reading as lost.
    pub fn lose(&mut self, reading: usize) {
        if self.lost.is_empty() {
            self.lost.resize(self.points.len(), false);
        }
        self.lost[reading] = true;
    }

    /// Calls `change(point, normal, draws)` for every reading, with `N` gaussians of its own.
    #[inline]
    pub fn for_each_with_gaussians<const N: usize>(
        &mut self,
        draws: &EffectDraws,
        change: impl FnMut(&mut [f64; 3], &mut [f64; 3], [f64; N]),
    ) {
        self.for_each(|contact, first, out| draws.gaussians(contact, first, N, out), change);
    }

    /// Calls `change(point, normal, draws)` for every reading, with `N` uniforms in (0, 1) of its own.
    #[inline]
    pub fn for_each_with_uniforms<const N: usize>(
        &mut self,
        draws: &EffectDraws,
        change: impl FnMut(&mut [f64; 3], &mut [f64; 3], [f64; N]),
    ) {
        self.for_each(|contact, first, out| draws.uniforms(contact, first, N, out), change);
    }

    #[inline]
    fn for_each<const N: usize>(
        &mut self,
        draw: impl Fn(u64, u64, &mut [f64]),
        mut change: impl FnMut(&mut [f64; 3], &mut [f64; 3], [f64; N]),
    ) {
        let mut drawn = std::mem::take(&mut self.drawn);
        drawn.resize(self.replicates * N, 0.0);
        for contact in 0..self.contacts() {
            draw(contact as u64, self.first_replicate, &mut drawn);
            let readings = contact * self.replicates..(contact + 1) * self.replicates;
            let rows = self.points[readings.clone()].iter_mut().zip(&mut self.normals[readings]);
            for ((point, normal), values) in rows.zip(drawn.chunks_exact(N)) {
                let mut own = [0.0; N];
                own.copy_from_slice(values);
                change(point, normal, own);
            }
        }
        self.drawn = drawn;
    }
}
