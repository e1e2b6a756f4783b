//! Work on several threads, or on one where the feature `threads` is off: the same calls, in the same pieces, the same bits.
//!
//! Every caller cuts its work into pieces that do not depend on the number of threads, and adds their results in a
//! fixed order. A piece that takes no longer than handing it over is done where it is. Without the feature the pieces are
//! done one after another, and neither rayon nor faer's threads are built.

#[cfg(feature = "threads")]
pub use several::{alone, any, each, join, map, map_with, try_map};

#[cfg(not(feature = "threads"))]
pub use one::{alone, any, each, join, map, map_with, try_map};

#[cfg(feature = "threads")]
mod several {
    use rayon::prelude::*;

    pub use rayon::join;

    /// `f()` with everything that it calls on one thread; on the threads at hand where the system gives no other.
    pub fn alone<T: Send>(f: impl FnOnce() -> T + Send) -> T {
        match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
            Ok(pool) => pool.install(f),
            Err(_) => f(),
        }
    }

    /// `f(0), f(1), ...`; a thread takes at least `piece` of them at a time.
    pub fn map<T: Send>(count: usize, piece: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
        (0..count).into_par_iter().with_min_len(piece).map(&f).collect()
    }

    /// `f(memory, 0), f(memory, 1), ...`, each with memory that `start` makes and that is used again.
    pub fn map_with<M, T: Send>(
        count: usize,
        piece: usize,
        start: impl Fn() -> M + Sync + Send,
        f: impl Fn(&mut M, usize) -> T + Sync + Send,
    ) -> Vec<T> {
        (0..count).into_par_iter().with_min_len(piece).map_init(start, f).collect()
    }

    /// `f(0), f(1), ...`, or `None` where one of them is.
    pub fn try_map<T: Send>(count: usize, f: impl Fn(usize) -> Option<T> + Sync) -> Option<Vec<T>> {
        (0..count).into_par_iter().map(&f).collect()
    }

    /// Whether `f` is true of one of `0..count`; a thread takes at least `piece` of them at a time.
    pub fn any(count: usize, piece: usize, f: impl Fn(usize) -> bool + Sync) -> bool {
        (0..count).into_par_iter().with_min_len(piece).any(&f)
    }

    /// `f(k, items[k])` for every k.
    pub fn each<T: Send>(items: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
        items.par_iter_mut().enumerate().for_each(|(k, item)| f(k, item));
    }
}

/// Multiply-adds of either half from which on another thread is asked to take it: they take a few times as long as a thread that
/// sleeps needs to wake up.
const WORTH_WAKING: usize = 300_000;

/// [`join`] of two halves of so many multiply-adds each; of small ones one after the other.
pub fn join_if_long<A: Send, B: Send>(
    products: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if products < WORTH_WAKING { (a(), b()) } else { join(a, b) }
}

/// The same functions on the calling thread; they are compiled in every build, so that they cannot fall behind.
#[cfg_attr(
    feature = "threads",
    allow(dead_code, unreachable_pub, reason = "the functions of `several` are called instead")
)]
mod one {
    pub fn alone<T: Send>(f: impl FnOnce() -> T + Send) -> T {
        f()
    }

    pub fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
        (a(), b())
    }

    pub fn map<T: Send>(count: usize, _piece: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
        (0..count).map(f).collect()
    }

    pub fn map_with<M, T: Send>(
        count: usize,
        _piece: usize,
        start: impl Fn() -> M + Sync + Send,
        f: impl Fn(&mut M, usize) -> T + Sync + Send,
    ) -> Vec<T> {
        let mut memory = start();
        (0..count).map(|k| f(&mut memory, k)).collect()
    }

    pub fn try_map<T: Send>(count: usize, f: impl Fn(usize) -> Option<T> + Sync) -> Option<Vec<T>> {
        (0..count).map(f).collect()
    }

    pub fn any(count: usize, _piece: usize, f: impl Fn(usize) -> bool + Sync) -> bool {
        (0..count).any(f)
    }

    pub fn each<T: Send>(items: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
        items.iter_mut().enumerate().for_each(|(k, item)| f(k, item));
    }
}
