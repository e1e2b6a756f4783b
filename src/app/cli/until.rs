//! Work that ends at an interrupt or when its time is over, however long one step of it takes.
//!
//! The work is done by a thread of its own and is left behind when nobody waits for it any longer: the process is about to say
//! what it has, and to end. So no loop below has to ask, and none can be forgotten.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::interrupt;

/// How often an interrupt and the clock are looked at.
pub(super) const LOOK: Duration = Duration::from_millis(20);

/// What is nearly done when the time is over may still end.
const GRACE: Duration = Duration::from_millis(100);

/// How long work may take.
#[derive(Clone, Copy, Debug)]
pub(super) struct Until {
    deadline: Option<Instant>,
}

impl Until {
    /// The interrupt alone ends it.
    pub(super) fn interrupted() -> Until {
        Until { deadline: None }
    }

    /// So many seconds after `began`, where there is a limit.
    pub(super) fn seconds_after(began: Instant, seconds: Option<f64>) -> Until {
        let of = |seconds: f64| Duration::try_from_secs_f64(seconds).ok().and_then(|limit| began.checked_add(limit));
        Until { deadline: seconds.and_then(of) }
    }

    /// Whether nobody waits any longer.
    pub(super) fn is_over(self) -> bool {
        interrupt::asked() || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// What `work` gives; `None` where it is not done in time.
    pub(super) fn wait<T: Send + 'static>(self, work: impl FnOnce() -> T + Send + 'static) -> Option<T> {
        self.wait_and(|| true, work)
    }

    /// The same; `look` is called many times a second meanwhile, and its no ends the waiting, too.
    pub(super) fn wait_and<T: Send + 'static>(
        self,
        mut look: impl FnMut() -> bool,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Option<T> {
        let (send, receive) = channel();
        let worker = std::thread::spawn(move || {
            // whoever asked may have gone
            let _ = send.send(work());
        });
        let mut over: Option<Instant> = None;
        loop {
            match receive.recv_timeout(LOOK) {
                Ok(done) => return Some(done),
                Err(RecvTimeoutError::Timeout) => {}
                // the thread ended without an answer: its panic goes on here
                Err(RecvTimeoutError::Disconnected) => match worker.join() {
                    Err(panic) => std::panic::resume_unwind(panic),
                    Ok(()) => return None,
                },
            }
            let ends = !look() || self.is_over();
            if ends && over.get_or_insert_with(Instant::now).elapsed() >= GRACE {
                return None;
            }
        }
    }
}

/// What two threads share, one of which may have been left behind: nobody panics while he holds it.
pub(super) fn held<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn work_in_time_is_done_and_work_without_end_is_left() {
        assert_eq!(Until::interrupted().wait(|| 6 * 7), Some(42));
        let until = Until::seconds_after(Instant::now(), Some(0.0));
        assert_eq!(until.wait(|| std::thread::sleep(Duration::from_secs(3600))), None);
        assert!(until.is_over() && !Until::seconds_after(Instant::now(), None).is_over());
    }

    #[test]
    fn whoever_looks_ends_the_waiting_and_sees_what_was_shared() {
        let steps = Arc::new(Mutex::new(0));
        let (shared, mut looks) = (Arc::clone(&steps), 0);
        let look = || {
            looks += 1;
            *held(&steps) < 3
        };
        let endless = move || {
            *held(&shared) = 3;
            std::thread::sleep(Duration::from_secs(3600));
        };
        assert_eq!(Until::interrupted().wait_and(look, endless), None);
        assert!(looks > 1 && *held(&steps) == 3);
    }

    #[test]
    #[should_panic(expected = "a fault of the work")]
    fn a_fault_of_the_work_is_not_swallowed() {
        let _ = Until::interrupted().wait(|| panic!("a fault of the work"));
    }
}
