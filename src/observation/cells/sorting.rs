//! Contacts into stripes of one x segment each, and within a stripe into cells: two stable counting sorts.
//!
//! The first is done chunk by chunk, each small enough for the second-level cache and none knowing of the others: the
//! contacts of a stripe are then one run in every chunk, in the order in which they came. The chunks' size is fixed, so
//! the order does not depend on the number of threads.

use std::ops::Range;

use crate::bspline::Knots;

/// Contacts sorted at once: 1.3 MB of records.
const CHUNK: usize = 1 << 15;

/// Records by stripe, reusable. A record begins with x and y.
#[derive(Debug, Default)]
pub(super) struct Stripes {
    records: Vec<f64>,
    /// Chunk c's contacts of stripe s are its `starts[c (stripes + 1) + s] .. starts[c (stripes + 1) + s + 1]`.
    starts: Vec<u32>,
    stripe_of: Vec<u32>,
    count: usize,
    stripes: usize,
}

/// What sorting the contacts of one stripe by cells leaves behind, reusable.
#[derive(Debug, Default)]
pub(super) struct CellOrder {
    /// Records' numbers, cell after cell.
    pub order: Vec<u32>,
    /// Where each cell starts in `order`.
    pub starts: Vec<u32>,
}

impl Stripes {
    /// Sorts `count` contacts; `x` gives an abscissa, `write` a whole record.
    pub fn sort<const RECORD: usize>(
        &mut self,
        knots: &Knots,
        count: usize,
        x: impl Fn(usize) -> f64 + Sync,
        write: impl Fn(usize, &mut [f64]) + Sync,
    ) {
        (self.count, self.stripes) = (count, knots.n_segments());
        let chunks = count.div_ceil(CHUNK);
        if self.records.len() < count * RECORD {
            self.records.resize(count * RECORD, 0.0);
        }
        if self.stripe_of.len() < count {
            self.stripe_of.resize(count, 0);
        }
        self.starts.clear();
        self.starts.resize(chunks * (self.stripes + 1), 0);
        let one = |chunk: usize, records: &mut [f64], stripe_of: &mut [u32], starts: &mut [u32]| {
            let range = chunk * CHUNK..count.min((chunk + 1) * CHUNK);
            sort_chunk::<RECORD>(knots, range, &x, &write, records, stripe_of, starts);
        };
        let records = &mut self.records[..count * RECORD];
        each_chunk(0..chunks, RECORD, records, &mut self.stripe_of[..count], &mut self.starts, &one);
    }

    /// Runs of records of one stripe, each as a range of records' numbers.
    fn runs(&self, stripe: usize) -> impl Iterator<Item = Range<usize>> + Clone + '_ {
        self.starts.chunks_exact(self.stripes + 1).enumerate().map(move |(chunk, starts)| {
            chunk * CHUNK + starts[stripe] as usize..chunk * CHUNK + starts[stripe + 1] as usize
        })
    }

    /// All records, by their numbers.
    pub fn records<const RECORD: usize>(&self) -> &[[f64; RECORD]] {
        &self.records.as_chunks::<RECORD>().0[..self.count]
    }

    /// Sorts one stripe's contacts into cells; `false` where it has none.
    pub fn sort_cells<const RECORD: usize>(&self, stripe: usize, knots: &Knots, into: &mut CellOrder) -> bool {
        let count: usize = self.runs(stripe).map(|run| run.len()).sum();
        if count == 0 {
            return false;
        }
        let (cells, records) = (knots.n_segments(), self.records::<RECORD>());
        into.starts.clear();
        into.starts.resize(cells + 1, 0);
        // the second half of `order` remembers the cells
        if into.order.len() < 2 * count {
            into.order.resize(2 * count, 0);
        }
        let (order, cell_of) = into.order.split_at_mut(count);
        let mut places = cell_of.iter_mut();
        for record in self.runs(stripe).flat_map(|run| &records[run]) {
            let cell = knots.segment_of(record[1]);
            into.starts[cell + 1] += 1;
            if let Some(place) = places.next() {
                *place = cell as u32;
            }
        }
        add_up(&mut into.starts);
        let numbers = self.runs(stripe).flatten();
        for (&cell, number) in cell_of.iter().zip(numbers) {
            let place = &mut into.starts[cell as usize];
            order[*place as usize] = number as u32;
            *place += 1;
        }
        shift_back(&mut into.starts);
        true
    }
}

/// Halves the range of chunks until one is left.
fn each_chunk(
    chunks: Range<usize>,
    record: usize,
    records: &mut [f64],
    stripe_of: &mut [u32],
    starts: &mut [u32],
    one: &(impl Fn(usize, &mut [f64], &mut [u32], &mut [u32]) + Sync),
) {
    match chunks.len() {
        0 => {}
        1 => one(chunks.start, records, stripe_of, starts),
        length => {
            let half = length / 2;
            let (records_a, records_b) = records.split_at_mut(half * CHUNK * record);
            let (stripe_a, stripe_b) = stripe_of.split_at_mut(half * CHUNK);
            let (starts_a, starts_b) = starts.split_at_mut(starts.len() / length * half);
            let middle = chunks.start + half;
            rayon::join(
                || each_chunk(chunks.start..middle, record, records_a, stripe_a, starts_a, one),
                || each_chunk(middle..chunks.end, record, records_b, stripe_b, starts_b, one),
            );
        }
    }
}

fn sort_chunk<const RECORD: usize>(
    knots: &Knots,
    range: Range<usize>,
    x: &impl Fn(usize) -> f64,
    write: &impl Fn(usize, &mut [f64]),
    records: &mut [f64],
    stripe_of: &mut [u32],
    starts: &mut [u32],
) {
    for (r, stripe) in range.clone().zip(stripe_of.iter_mut()) {
        *stripe = knots.segment_of(x(r)) as u32;
        starts[*stripe as usize + 1] += 1;
    }
    add_up(starts);
    for (r, &stripe) in range.zip(stripe_of.iter()) {
        let place = &mut starts[stripe as usize];
        write(r, &mut records[*place as usize * RECORD..][..RECORD]);
        *place += 1;
    }
    shift_back(starts);
}

/// Counts, each one place late, to starts.
fn add_up(counts: &mut [u32]) {
    for k in 1..counts.len() {
        counts[k] += counts[k - 1];
    }
}

/// Every start has moved to the next one's place: back again.
fn shift_back(starts: &mut [u32]) {
    let last = starts.len() - 1;
    starts.copy_within(0..last, 1);
    starts[0] = 0;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_contact_stands_once_in_its_cell_in_the_order_it_came() {
        let knots = [Knots::uniform(2, 5, 0.0, 1.0).unwrap(), Knots::uniform(2, 7, 0.0, 1.0).unwrap()];
        for count in [0, 1, 100, CHUNK + 3, 3 * CHUNK] {
            let at = |r: usize| [(r as f64 * 0.754_877_666).fract(), (r as f64 * 0.569_840_291).fract()];
            let mut stripes = Stripes::default();
            let write = |r: usize, record: &mut [f64]| record.copy_from_slice(&[at(r)[0], at(r)[1], r as f64]);
            for _ in 0..2 {
                stripes.sort::<3>(&knots[0], count, |r| at(r)[0], write);
            }
            let (mut seen, mut order) = (0, CellOrder::default());
            for stripe in 0..5 {
                if !stripes.sort_cells::<3>(stripe, &knots[1], &mut order) {
                    continue;
                }
                for cell in 0..7 {
                    let numbers = &order.order[order.starts[cell] as usize..order.starts[cell + 1] as usize];
                    let found: Vec<usize> =
                        numbers.iter().map(|&n| stripes.records::<3>()[n as usize][2] as usize).collect();
                    assert!(found.is_sorted());
                    for &r in &found {
                        assert_eq!([knots[0].segment_of(at(r)[0]), knots[1].segment_of(at(r)[1])], [stripe, cell]);
                    }
                    seen += found.len();
                }
            }
            assert_eq!(seen, count);
        }
    }
}
