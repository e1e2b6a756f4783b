//! Ctrl-C: at once as a rule; a verb that can keep what it has is asked to come to an end, and only a second Ctrl-C ends it.

use std::sync::atomic::{AtomicU8, Ordering};

/// Ctrl-C ends the process.
const AT_ONCE: u8 = 0;
/// Ctrl-C asks the verb to come to an end.
const GENTLY: u8 = 1;
/// It was asked.
const ASKED: u8 = 2;

static STATE: AtomicU8 = AtomicU8::new(AT_ONCE);

/// From now on the first Ctrl-C only asks; whoever calls this looks at [`asked`] now and then.
pub(super) fn gently() {
    // an interrupt that came before stays asked
    let _ = STATE.compare_exchange(AT_ONCE, GENTLY, Ordering::SeqCst, Ordering::SeqCst);
}

/// What was computed is there: Ctrl-C ends the process again, unless it came before.
pub(super) fn at_once() {
    let _ = STATE.compare_exchange(GENTLY, AT_ONCE, Ordering::SeqCst, Ordering::SeqCst);
}

/// Whether the verb was asked to come to an end.
pub(super) fn asked() -> bool {
    STATE.load(Ordering::SeqCst) == ASKED
}

/// Ctrl-C came. `true`: the verb will end by itself.
pub(super) fn caught() -> bool {
    STATE.compare_exchange(GENTLY, ASKED, Ordering::SeqCst, Ordering::SeqCst).is_ok()
}
