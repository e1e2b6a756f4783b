//! The functions of `src/numeric/threads.rs` by threads of the standard library, which are made and joined by the system's own calls: the
//! thread sanitizer knows those, whereas the hand-over between rayon's threads looks like a race to it.
//!
//! ```text
//! the same pieces, each on a thread of its own       what is looked for is a race between the pieces, not in rayon
//! ```

use std::thread::scope;

/// Threads at once.
const THREADS: usize = 4;

pub fn alone<T: Send>(f: impl FnOnce() -> T + Send) -> T {
    f()
}

pub fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    scope(|scope| {
        let a = scope.spawn(a);
        let b = b();
        (a.join().expect("no panic"), b)
    })
}

pub fn map<T: Send>(count: usize, piece: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
    map_with(count, piece, || (), |(), k| f(k))
}

pub fn map_with<M, T: Send>(
    count: usize,
    piece: usize,
    start: impl Fn() -> M + Sync + Send,
    f: impl Fn(&mut M, usize) -> T + Sync + Send,
) -> Vec<T> {
    let size = count.div_ceil(THREADS).max(piece);
    let part = |from: usize| {
        let mut memory = start();
        (from..(from + size).min(count)).map(|k| f(&mut memory, k)).collect::<Vec<T>>()
    };
    let part = &part;
    scope(|scope| {
        let parts: Vec<_> = (0..count).step_by(size).map(|from| scope.spawn(move || part(from))).collect();
        parts.into_iter().flat_map(|part| part.join().expect("no panic")).collect()
    })
}

pub fn try_map<T: Send>(count: usize, f: impl Fn(usize) -> Option<T> + Sync) -> Option<Vec<T>> {
    map(count, 1, f).into_iter().collect()
}

pub fn any(count: usize, piece: usize, f: impl Fn(usize) -> bool + Sync) -> bool {
    map(count, piece, f).contains(&true)
}

pub fn each<T: Send>(items: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
    let (size, f) = (items.len().div_ceil(THREADS).max(1), &f);
    scope(|scope| {
        let one = |(part, items): (usize, &mut [T])| {
            items.iter_mut().enumerate().for_each(|(k, item)| f(part * size + k, item));
        };
        let parts: Vec<_> = items.chunks_mut(size).enumerate().map(|part| scope.spawn(move || one(part))).collect();
        // joined one by one: the end of a scope alone is a hand-over that the sanitizer does not know
        parts.into_iter().for_each(|part| part.join().expect("no panic"));
    });
}
