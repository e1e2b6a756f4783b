//! How far reading has come, for whoever waits: told to a watcher of this thread, once every megabyte.
//!
//! ```text
//! watched(watcher, || read_input(...))        watcher <- phase, bytes done, bytes in all where they are known
//! ```
//!
//! The watcher belongs to the thread and not to an argument of every reader: what is read does not depend on it.

use std::cell::{Cell, RefCell};
use std::io::{BufRead, Read};

/// Bytes between two messages: some ten milliseconds of parsing.
const STEP_BYTES: usize = 1 << 20;

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ReadPhase {
    /// Bytes come from the disk or the pipe.
    Fetching,
    /// They are unpacked.
    Unpacking,
    /// Numbers are made of them.
    Parsing,
}

/// How far it has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ReadProgress {
    pub phase: ReadPhase,
    /// Bytes.
    pub done: usize,
    /// Bytes in all; a pipe does not say.
    pub total: Option<usize>,
}

/// Who is told.
pub(crate) type Watcher = Box<dyn Fn(&ReadProgress)>;

thread_local! {
    static WATCHER: RefCell<Option<Watcher>> = const { RefCell::new(None) };
    /// The megabyte that was told last.
    static TOLD: Cell<usize> = const { Cell::new(usize::MAX) };
}

/// Reads while a watcher is told.
pub(crate) fn watched<T>(watcher: Watcher, read: impl FnOnce() -> T) -> T {
    struct Ends;
    impl Drop for Ends {
        fn drop(&mut self) {
            WATCHER.take();
        }
    }
    WATCHER.replace(Some(watcher));
    let _ends = Ends;
    read()
}

/// Tells the watcher, if there is one and another megabyte is done.
pub(super) fn tell(phase: ReadPhase, done: usize, total: Option<usize>) {
    let step = done / STEP_BYTES;
    if TOLD.replace(step) != step {
        WATCHER.with_borrow(|watcher| watcher.iter().for_each(|watcher| watcher(&ReadProgress { phase, done, total })));
    }
}

/// Tells how far a line of this text is from its beginning.
pub(super) fn tell_line(text: &str, line: &str) {
    let done = (line.as_ptr() as usize).saturating_sub(text.as_ptr() as usize);
    tell(ReadPhase::Parsing, done, Some(text.len()));
}

/// Everything that comes, in steps of which the watcher is told.
pub(super) fn fetch(mut from: impl Read, total: Option<usize>, bytes: &mut Vec<u8>) -> std::io::Result<()> {
    if let Some(total) = total {
        bytes.try_reserve_exact(total)?;
    }
    while from.by_ref().take(STEP_BYTES as u64).read_to_end(bytes)? > 0 {
        tell(ReadPhase::Fetching, bytes.len(), total);
    }
    Ok(())
}

/// The same up to so many bytes; whether that was all that comes.
pub(super) fn fetch_up_to(
    mut from: impl Read,
    total: Option<usize>,
    most: usize,
    bytes: &mut Vec<u8>,
) -> std::io::Result<bool> {
    while bytes.len() < most {
        let step = STEP_BYTES.min(most - bytes.len());
        if from.by_ref().take(step as u64).read_to_end(bytes)? == 0 {
            return Ok(true);
        }
        tell(ReadPhase::Fetching, bytes.len(), total);
    }
    Ok(false)
}

/// Bytes that tell how many of them were taken.
pub(super) struct Counted<'a> {
    rest: &'a [u8],
    total: usize,
    phase: ReadPhase,
}

impl<'a> Counted<'a> {
    pub(super) fn new(bytes: &'a [u8], phase: ReadPhase) -> Counted<'a> {
        Counted { rest: bytes, total: bytes.len(), phase }
    }

    /// What was not taken yet.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    fn tell(&self) {
        tell(self.phase, self.total - self.rest.len(), Some(self.total));
    }
}

impl Read for Counted<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.rest.read(buffer)?;
        self.tell();
        Ok(read)
    }
}

impl BufRead for Counted<'_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        Ok(self.rest)
    }

    fn consume(&mut self, amount: usize) {
        self.rest.consume(amount);
        self.tell();
    }
}

#[cfg(test)]
mod tests {
    use std::rc::Rc;

    use super::*;

    #[test]
    fn the_watcher_is_told_of_every_megabyte_and_of_nothing_afterwards() {
        let told = Rc::new(RefCell::new(Vec::new()));
        let listener = Rc::clone(&told);
        let bytes = vec![b' '; 5 * STEP_BYTES / 2];
        let mut fetched = Vec::new();
        let watcher: Watcher = Box::new(move |progress| listener.borrow_mut().push(*progress));
        watched(watcher, || fetch(&bytes[..], Some(bytes.len()), &mut fetched)).unwrap();
        let done: Vec<usize> = told.borrow().iter().map(|progress: &ReadProgress| progress.done / STEP_BYTES).collect();
        assert_eq!((fetched, done), (bytes.clone(), vec![1, 2]));
        tell(ReadPhase::Parsing, 9 * STEP_BYTES, None);
        assert_eq!(told.borrow().len(), 2);
        let mut counted = Counted::new(&bytes, ReadPhase::Unpacking);
        counted.consume(STEP_BYTES);
        assert_eq!(counted.rest().len(), bytes.len() - STEP_BYTES);
    }
}
