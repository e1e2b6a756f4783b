//! How long a piece of work takes still, said only where that is known.

use std::fmt::Write;
use std::time::Duration;

use indicatif::{HumanDuration, ProgressState};

/// Longest time whose count is worth saying: what is told of the first steps alone is far too long.
const COUNTED: Duration = Duration::from_secs(24 * 3600);

/// How long it takes still, behind `join`; in no more than a day.
pub(super) fn said_left(join: &str, left: Duration) -> String {
    if left > COUNTED { format!("{join}more than a day left") } else { format!("{join}{:#} left", HumanDuration(left)) }
}

/// Until so much of the work is done the rate is that of its beginning, and says nothing of its end.
const TELLING: f32 = 0.02;

/// The time left of a bar, once there is something to tell it from.
pub(super) fn time_left(state: &ProgressState, out: &mut dyn Write) {
    if state.fraction() >= TELLING {
        let _ = out.write_str(&said_left("", state.eta()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two days of the first steps are no forecast.
    #[test]
    fn nobody_is_told_to_wait_for_days() {
        assert_eq!(said_left(", ", Duration::from_secs(2 * 86400)), ", more than a day left");
        assert_eq!(said_left("", Duration::from_secs(840)), "14m left");
    }
}
