//! Measuring on a thread of its own, so that Ctrl-C need not wait for a call that takes seconds.
//!
//! ```text
//! thread that measures   round, most ->  Told  -> ends      asked before every call
//! thread that waits      spinner, whoever watches, Ctrl-C   many times a second
//! ```

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use palpate_studies::frontier::Watch;

use super::failure::Failure;
use super::interrupt;
use super::until::Until;

/// What the two threads tell each other.
#[derive(Debug, Default)]
struct Told {
    round: AtomicUsize,
    most: AtomicUsize,
    ends: AtomicBool,
}

/// What `work` measures; `seen` is told how far it is, and its no ends it. `None` where it does not end in time.
pub(super) fn measured<T: Send + 'static>(
    until: Until,
    seen: &dyn Fn(usize, usize) -> bool,
    work: impl FnOnce(Watch<'_>) -> T + Send + 'static,
) -> Option<T> {
    let told = Arc::new(Told::default());
    let own = Arc::clone(&told);
    let look = || {
        let goes_on = seen(told.round.load(Ordering::Relaxed), told.most.load(Ordering::Relaxed)) && !until.is_over();
        told.ends.fetch_or(!goes_on, Ordering::Relaxed);
        goes_on
    };
    until.wait_and(look, move || {
        work(&|round, most| {
            own.round.store(round, Ordering::Relaxed);
            own.most.store(most, Ordering::Relaxed);
            !own.ends.load(Ordering::Relaxed)
        })
    })
}

/// What is said where Ctrl-C comes before there is anything to keep.
pub(super) fn nothing_yet() -> Failure {
    Failure::Interrupted("interrupted before the first way of fitting was timed; nothing is kept".into())
}

/// What a user should know of ways that were not reached; an error where none was.
pub(super) fn unreached(seconds: f64, done: usize, all: usize) -> Result<Option<String>, Failure> {
    match (done, interrupt::asked()) {
        (0, true) => Err(nothing_yet()),
        (0, false) => {
            let what = format!("--seconds {seconds} is over before the first way of fitting was timed: raise it");
            Err(Failure::Input(what))
        }
        (done, _) if done == all => Ok(None),
        (_, true) => Ok(Some(format!("{done} of {all} ways of fitting were timed before the interrupt came"))),
        (_, false) => Ok(Some(format!(
            "{done} of {all} ways of fitting were timed: --seconds {seconds} was over before the rest"
        ))),
    }
}
