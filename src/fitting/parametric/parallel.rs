//! Loops over contacts, Gauss points and cells, on all threads where there are many; the digits do not depend on the
//! number of threads.
//!
//! Sums run over blocks of fixed size and add the blocks in their order.

use palpate_numeric::threads;

/// Items of one block. Fewer items, at 100 ns each, cost less than starting a thread.
const BLOCK: usize = 2048;
/// Cells that are computed in parallel before they are added to the matrix in their order.
const CELLS: usize = 128;

/// `sum_k f(k)`; `None` where one of the terms is.
pub(super) fn sum<const N: usize>(count: usize, f: impl Fn(usize) -> Option<[f64; N]> + Sync) -> Option<[f64; N]> {
    let add = |a: [f64; N], b: [f64; N]| std::array::from_fn(|k| a[k] + b[k]);
    let block =
        |b: usize| (b * BLOCK..((b + 1) * BLOCK).min(count)).try_fold([0.0; N], |sum, k| f(k).map(|v| add(sum, v)));
    if count <= BLOCK {
        return block(0);
    }
    let blocks = threads::try_map(count.div_ceil(BLOCK), block)?;
    Some(blocks.into_iter().fold([0.0; N], add))
}

/// `f(0), f(1), ..` as a vector.
pub(super) fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
    if count <= BLOCK {
        return (0..count).map(f).collect();
    }
    threads::map(count, BLOCK / 4, f)
}

/// Whether `f` is true for any of `0 .. count`.
pub(super) fn any(count: usize, f: impl Fn(usize) -> bool + Sync) -> bool {
    if count <= BLOCK { (0..count).any(f) } else { threads::any(count, BLOCK / 4, f) }
}

/// Calls `make` for every item, each with a work space of its own, then `take` for each item in order.
pub(super) fn in_order<W: Send>(
    count: usize,
    new: impl Fn() -> W + Sync,
    make: impl Fn(usize, &mut W) + Sync,
    mut take: impl FnMut(usize, &W),
) {
    if count < CELLS {
        let mut work = new();
        for k in 0..count {
            make(k, &mut work);
            take(k, &work);
        }
        return;
    }
    let mut works: Vec<W> = (0..CELLS).map(|_| new()).collect();
    for from in (0..count).step_by(CELLS) {
        let to = (from + CELLS).min(count);
        threads::each(&mut works[..to - from], |k, work| make(from + k, work));
        works[..to - from].iter().enumerate().for_each(|(k, work)| take(from + k, work));
    }
}
