//! A counter of work: the multiply-adds of equations and of what is read off them, the same in every run and on every machine.
//!
//! ```text
//! rows of N contacts, w basis functions each    3 N w a product, 3 N w (w + 1) / 2 the normal matrix (per axis: w = p + 1)
//! Cholesky of n unknowns                        n^3 / 6; of half width b: n b^2 / 2;   a solution: two for each entry of the factor
//! QR of m rows                                  m n^2 (G. Golub and C. Van Loan, *Matrix Computations*, 5.2)
//! eigenproblem with vectors                     9 n^3 / 2 (the same, 8.3)
//! ```
//!
//! A count is made once a call, from its sizes, so that it costs nothing. Draws, sorting and elementary functions are not in it: it tells
//! how work grows, and that two runs did the same, not how long they took.

use std::cell::Cell;

thread_local! {
    static DONE: Cell<u64> = const { Cell::new(0) };
}

/// Counts so many multiply-adds, on this thread.
#[inline]
pub fn add(multiply_adds: usize) {
    DONE.with(|done| done.set(done.get().wrapping_add(multiply_adds as u64)));
}

/// What `call` returns, and the multiply-adds that this thread did in it: all of them under [`crate::threads::alone`].
pub fn counted<R>(call: impl FnOnce() -> R) -> (R, u64) {
    let before = DONE.with(Cell::get);
    let result = call();
    (result, DONE.with(Cell::get).wrapping_sub(before))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::product;
    use faer::Mat;

    #[test]
    fn what_is_counted_is_that_of_the_call() {
        let square = |n: usize| Mat::<f64>::identity(n, n);
        let of = |n: usize| counted(|| product(square(n).as_ref(), square(n).as_ref())).1;
        assert_eq!([of(10), of(20), of(10)], [1_000, 8_000, 1_000]);
        let (inner, outer) = counted(|| (of(10), of(10)));
        assert_eq!((inner, outer), ((1_000, 1_000), 2_000));
    }
}
