//! Sorts contacts into stripes of one x segment each, and within a stripe into cells, by two stable counting sorts.
//!
//! The first sort treats chunks independently, each small enough for the second-level cache. The contacts of a stripe are
//! then one run in every chunk, in their original order. The size of a chunk is fixed, so the order does not depend on
//! the number of threads.

use std::ops::Range;

use palpate_numeric::bspline::Knots;

/// Contacts sorted at once: 0.65 MB of records, which stay in a second-level cache of 1 MB from zeroing to filling.
const CHUNK: usize = 1 << 14;

/// Records by stripe, reusable. A record begins with x and y.
#[derive(Clone, Debug, Default)]
pub(super) struct Stripes {
    chunks: Vec<Chunk>,
    /// How many of them are in use.
    used: usize,
}

/// Up to [`CHUNK`] contacts. Each has its own memory, first touched where it is filled.
#[derive(Clone, Debug, Default)]
struct Chunk {
    records: Vec<f64>,
    /// Stripe s has the chunk's records `starts[s] .. starts[s + 1]`.
    starts: Vec<u32>,
    stripe_of: Vec<u32>,
}

/// What sorting the contacts of one stripe by cells leaves behind, reusable.
#[derive(Clone, Debug, Default)]
pub(super) struct CellOrder {
    /// Records' numbers, cell after cell.
    pub order: Vec<u32>,
    /// Where each cell starts in `order`.
    pub starts: Vec<u32>,
}

impl Stripes {
    /// Sorts `count` contacts; `x` gives an abscissa, `write` a whole record.
    pub(super) fn sort<const RECORD: usize>(
        &mut self,
        knots: &Knots,
        count: usize,
        x: impl Fn(usize) -> f64 + Sync,
        write: impl Fn(usize, &mut [f64]) + Sync,
    ) {
        self.used = count.div_ceil(CHUNK);
        if self.chunks.len() < self.used {
            self.chunks.resize_with(self.used, Chunk::default);
        }
        let one = |number: usize, chunk: &mut Chunk| {
            let range = number * CHUNK..count.min((number + 1) * CHUNK);
            chunk.sort::<RECORD>(knots, range, &x, &write);
        };
        each_chunk(0, &mut self.chunks[..self.used], &one);
    }

    /// Numbers of the records of one stripe: the chunk's and within it.
    fn runs(&self, stripe: usize) -> impl Iterator<Item = (usize, Range<usize>)> + Clone + '_ {
        self.chunks[..self.used]
            .iter()
            .enumerate()
            .map(move |(number, chunk)| (number, chunk.starts[stripe] as usize..chunk.starts[stripe + 1] as usize))
    }

    /// The record of that number.
    #[inline(always)]
    pub(super) fn record<const RECORD: usize>(&self, number: u32) -> &[f64; RECORD] {
        let (chunk, place) = (number as usize / CHUNK, number as usize % CHUNK);
        &self.chunks[chunk].records.as_chunks::<RECORD>().0[place]
    }

    /// Sorts one stripe's contacts into cells; `false` where it has none.
    pub(super) fn sort_cells<const RECORD: usize>(&self, stripe: usize, knots: &Knots, into: &mut CellOrder) -> bool {
        let count: usize = self.runs(stripe).map(|(_, run)| run.len()).sum();
        if count == 0 {
            return false;
        }
        let cells = knots.n_segments();
        into.starts.clear();
        into.starts.resize(cells + 1, 0);
        // the second half of `order` holds the cells
        if into.order.len() < 2 * count {
            into.order.resize(2 * count, 0);
        }
        let (order, cell_of) = into.order.split_at_mut(count);
        let mut places = cell_of.iter_mut();
        for (chunk, run) in self.runs(stripe) {
            let records = &self.chunks[chunk].records.as_chunks::<RECORD>().0[run];
            for (record, place) in records.iter().zip(&mut places) {
                let cell = knots.segment_of(record[1]);
                into.starts[cell + 1] += 1;
                *place = cell as u32;
            }
        }
        add_up(&mut into.starts);
        let mut cells_of = cell_of.iter();
        for (chunk, run) in self.runs(stripe) {
            for (number, &cell) in (chunk * CHUNK + run.start..chunk * CHUNK + run.end).zip(&mut cells_of) {
                let place = &mut into.starts[cell as usize];
                order[*place as usize] = number as u32;
                *place += 1;
            }
        }
        shift_back(&mut into.starts);
        true
    }
}

/// Halves the range of chunks until one is left.
fn each_chunk(first: usize, chunks: &mut [Chunk], one: &(impl Fn(usize, &mut Chunk) + Sync)) {
    match chunks {
        [] => {}
        [chunk] => one(first, chunk),
        chunks => {
            let half = chunks.len() / 2;
            let (a, b) = chunks.split_at_mut(half);
            palpate_numeric::threads::join(|| each_chunk(first, a, one), || each_chunk(first + half, b, one));
        }
    }
}

impl Chunk {
    fn sort<const RECORD: usize>(
        &mut self,
        knots: &Knots,
        range: Range<usize>,
        x: &impl Fn(usize) -> f64,
        write: &impl Fn(usize, &mut [f64]),
    ) {
        let Chunk { records, starts, stripe_of } = self;
        starts.clear();
        starts.resize(knots.n_segments() + 1, 0);
        stripe_of.clear();
        stripe_of.extend(range.clone().map(|r| {
            let stripe = knots.segment_of(x(r)) as u32;
            starts[stripe as usize + 1] += 1;
            stripe
        }));
        add_up(starts);
        records.resize(range.len() * RECORD, 0.0);
        for (r, &stripe) in range.zip(stripe_of.iter()) {
            let place = &mut starts[stripe as usize];
            write(r, &mut records[*place as usize * RECORD..][..RECORD]);
            *place += 1;
        }
        shift_back(starts);
    }
}

/// Makes starts of counts that are stored one place late.
fn add_up(counts: &mut [u32]) {
    for k in 1..counts.len() {
        counts[k] += counts[k - 1];
    }
}

/// Undoes the shift of every start by one place.
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
                    let found: Vec<usize> = numbers.iter().map(|&n| stripes.record::<3>(n)[2] as usize).collect();
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
