//! Long work on threads of its own, while the calling thread stays Python's: it reports progress and hears Ctrl-C.
//!
//! ```text
//! calling thread   signals, progress(done, of)   <-  (done, of)  <-   worker, and its pool of `threads`
//!                  stop                          ->               ->  asked after every chunk
//! ```
//!
//! Python runs signal handlers on the main thread alone, so the work may not occupy it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

/// How long a press of Ctrl-C may go unheard: short for a person, long beside the microsecond that a look takes.
const LOOK: Duration = Duration::from_millis(20);

/// What the work tells, and whether it shall go on.
pub(crate) struct Teller<'a> {
    stop: &'a AtomicBool,
    to: Sender<(u64, u64)>,
}

impl Teller<'_> {
    /// `done` of `of` are done; whether to go on.
    pub(crate) fn tell(&self, done: u64, of: u64) -> bool {
        // nobody listens any more where the caller was interrupted
        let _ = self.to.send((done, of));
        self.goes_on()
    }

    /// Whether to go on, where there is nothing to tell.
    pub(crate) fn goes_on(&self) -> bool {
        !self.stop.load(Ordering::Relaxed)
    }
}

/// Does the work on so many threads, or on all that the process has; an exception of `progress`, or Ctrl-C, ends it.
pub(crate) fn attended<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Teller<'_>) -> T + Send,
) -> PyResult<T> {
    let pool = match threads {
        None => None,
        Some(count) if (1..=1024).contains(&count) => {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
            Some(pool.map_err(|error| PyValueError::new_err(format!("threads: {error}")))?)
        }
        Some(count) => return Err(PyValueError::new_err(format!("threads is {count}: 1 to 1024 wanted"))),
    };
    let progress = progress.map(|progress| progress.clone().unbind());
    let stop = AtomicBool::new(false);
    py.detach(|| {
        std::thread::scope(|scope| {
            let (to, from) = channel();
            let teller = Teller { stop: &stop, to };
            let worker = scope.spawn(move || match pool {
                Some(pool) => pool.install(|| work(&teller)),
                None => work(&teller),
            });
            let heard = listen(&from, progress.as_ref());
            if heard.is_err() {
                stop.store(true, Ordering::Relaxed);
            }
            let done = worker.join().map_err(|_| PyRuntimeError::new_err("palpate failed; please report it"));
            heard.and(done)
        })
    })
}

/// Listens until the worker has ended.
fn listen(from: &Receiver<(u64, u64)>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    loop {
        let message = match from.recv_timeout(LOOK) {
            Ok(first) => Some(from.try_iter().last().unwrap_or(first)),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        };
        Python::attach(|py| {
            py.check_signals()?;
            match (progress, message) {
                (Some(progress), Some(message)) => progress.call1(py, message).map(|_| ()),
                _ => Ok(()),
            }
        })?;
    }
}
