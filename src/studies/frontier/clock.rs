//! Many calls timed side by side, so that whatever slows the machine for a while slows all of them.
//!
//! ```text
//! round:   every call in turn, a few times over;  a round's time of a call is the least of these
//! time:    median over the rounds;  its interval from medians of rounds drawn again (B. Efron, *Ann. Statist.* 7 (1979) 1)
//! ```
//!
//! What a timed call returns is handed on after the clock has stopped: accuracy and time are those of the same calls.

use std::time::{Duration, Instant};

use palpate_numeric::draws::Lcg;
use palpate_numeric::statistics::{Rank, median, quantile};
use palpate_numeric::work;

/// Calls of one kind in a row: the first finds the caches cold, which a robot that fits again and again does not meet.
const IN_A_ROW: usize = 3;
/// Seconds by which the least rounds may outlast the others' end, with one call of each kind: a time without an interval tells
/// little, but contacts by the million take seconds a call.
const ALLOWANCE: f64 = 3.0;
/// So many times the seconds for each call are spent on the least rounds at most.
const FOR_LEAST: f64 = 3.0;
/// Calls of each kind that are made however slow they are: one alone tells no error.
const LEAST_CALLS: u64 = 2;
/// Samples of the bootstrap; the ends of an interval of 95 % are then some 5 % of its width off.
const SAMPLES: usize = 200;

/// Median time of one call, with the interval that rounds drawn again give in 95 of 100 cases; seconds. NaN, and `null` in JSON, where no
/// round was made.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Clocked {
    /// Median over the rounds.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub median: f64,
    /// Lower end.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub lo: f64,
    /// Upper end.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub hi: f64,
    /// The quickest round, of this call or of one that does the same work: what it takes while nothing else runs, which changes least
    /// between two runs.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub least: f64,
}

/// How long rounds go on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Rounds in which every call is made that is not slow: fewer have no interval.
    pub least: usize,
    /// Rounds at most.
    pub most: usize,
    /// Seconds for all calls together, but for [`ALLOWANCE`].
    pub seconds: f64,
    /// Seconds for each call beyond the least rounds: slow calls are made less often.
    pub each: f64,
}

/// A call to be timed; it is told how many calls of it there were before.
pub(super) type Call<'a, R> = Box<dyn FnMut(u64) -> R + 'a>;

/// Asked before every call, while no clock runs, with the round and how many there are at most; its no ends the rounds.
pub type Watch<'a> = &'a (dyn Fn(usize, usize) -> bool + Sync);

/// What comes of the calls while they are timed.
pub(super) enum Heard<R> {
    /// What one returned, how many calls of it there were before, and the multiply-adds that it took on this thread.
    Answer(u64, R, u64),
    /// Its time in a round, seconds.
    Time(f64),
}

/// Times every call in rounds. `keep(k, number, result)` gets what the timed calls returned.
pub(super) fn rounds<R>(
    calls: &mut [Call<'_, R>],
    limits: Limits,
    watch: Watch<'_>,
    keep: impl FnMut(usize, u64, R),
) -> Vec<Clocked> {
    round_times(calls, limits, watch, keep).iter().map(|rounds| clocked(rounds)).collect()
}

/// The time of every call in every round, seconds.
pub(super) fn round_times<R>(
    calls: &mut [Call<'_, R>],
    limits: Limits,
    watch: Watch<'_>,
    mut keep: impl FnMut(usize, u64, R),
) -> Vec<Vec<f64>> {
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); calls.len()];
    heard_rounds(calls, limits, watch, |k, heard| match heard {
        Heard::Answer(number, result, _) => keep(k, number, result),
        Heard::Time(seconds) => times[k].push(seconds),
    });
    times
}

/// The same, told as it happens.
pub(super) fn heard_rounds<R>(
    calls: &mut [Call<'_, R>],
    limits: Limits,
    watch: Watch<'_>,
    mut hear: impl FnMut(usize, Heard<R>),
) {
    let began = Instant::now();
    let mut numbers = vec![0; calls.len()];
    let mut spent = vec![0.0; calls.len()];
    for round in 0..limits.most {
        for step in 0..calls.len() {
            let late = began.elapsed().as_secs_f64() - limits.seconds;
            if !watch(round, limits.most) || late > if round < limits.least { ALLOWANCE } else { 0.0 } {
                return;
            }
            // each round begins elsewhere, so that no call has always the same neighbour before it
            let k = (step + round * 7) % calls.len();
            // what is slow leaves the others their rounds, too
            let most_spent = if round >= limits.least { limits.each } else { FOR_LEAST * limits.each };
            if spent[k] > most_spent && numbers[k] >= LEAST_CALLS {
                continue;
            }
            let mut least = Duration::MAX;
            let in_a_row = if late > 0.0 || spent[k] > limits.each { 1 } else { IN_A_ROW };
            for repeat in 0..in_a_row {
                if repeat > 0 && spent[k] > limits.each {
                    break;
                }
                let clock = Instant::now();
                let (result, multiply_adds) = work::counted(|| calls[k](numbers[k]));
                let taken = clock.elapsed();
                hear(k, Heard::Answer(numbers[k], result, multiply_adds));
                numbers[k] += 1;
                least = least.min(taken);
                spent[k] += taken.as_secs_f64();
            }
            hear(k, Heard::Time(least.as_secs_f64()));
        }
    }
}

/// What a counter of instructions is told to look at: never inlined, so that it finds the name.
#[inline(never)]
pub fn counted_region<R>(call: &mut dyn FnMut() -> R) -> R {
    std::hint::black_box(call())
}

/// Median and bootstrap interval of some rounds.
pub(super) fn clocked(rounds: &[f64]) -> Clocked {
    if rounds.is_empty() {
        return Clocked { median: f64::NAN, lo: f64::NAN, hi: f64::NAN, least: f64::NAN };
    }
    let mut draws = Lcg::new(rounds.len() as u64);
    let mut drawn = vec![0.0; rounds.len()];
    let mut medians: Vec<f64> = (0..SAMPLES)
        .map(|_| {
            let mut below = |count: usize| ((draws.uniform() * count as f64) as usize).min(count - 1);
            drawn.iter_mut().for_each(|value| *value = rounds[below(rounds.len())]);
            median(&mut drawn).unwrap_or(f64::NAN)
        })
        .collect();
    let mut at = |share: f64| quantile(&mut medians, share, Rank::NearestStep).unwrap_or(f64::NAN);
    let least = rounds.iter().copied().fold(f64::INFINITY, f64::min);
    Clocked { median: median(rounds.to_vec()).unwrap_or(f64::NAN), lo: at(0.025), hi: at(0.975), least }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_lie_in_the_middle_and_their_intervals_around_them() {
        let rounds: Vec<f64> = (0..101).map(f64::from).collect();
        let found = clocked(&rounds);
        assert!(found.median == 50.0 && found.lo < 45.0 && found.hi > 55.0 && found.lo > 25.0, "{found:?}");
        assert!(clocked(&[]).median.is_nan());
    }

    #[test]
    fn every_result_of_a_timed_call_is_handed_on_once() {
        let mut calls: Vec<Call<'_, u64>> = vec![Box::new(|number| number), Box::new(|number| 100 + number)];
        let mut seen = [Vec::new(), Vec::new()];
        let limits = Limits { least: 2, most: 4, seconds: 9.0, each: 9.0 };
        let times = rounds(&mut calls, limits, &|_, most| most == 4, |k, number, result| {
            assert_eq!(result, 100 * k as u64 + number);
            seen[k].push(number);
        });
        assert!(times.iter().all(|time| time.lo <= time.median && time.median <= time.hi));
        assert!(seen.iter().all(|numbers| numbers.iter().copied().eq(0..numbers.len() as u64)));
    }

    #[test]
    fn whoever_watches_ends_the_rounds() {
        let mut calls: Vec<Call<'_, u64>> = vec![Box::new(|number| number)];
        let limits = Limits { least: 5, most: 9, seconds: 9.0, each: 9.0 };
        let times = round_times(&mut calls, limits, &|round, _| round < 2, |_, _, _| ());
        assert_eq!(times[0].len(), 2);
    }

    #[test]
    fn rounds_end_with_their_time_in_the_middle_of_one() {
        let slow = || -> Call<'static, ()> { Box::new(|_| std::thread::sleep(Duration::from_millis(700))) };
        let mut calls: Vec<Call<'_, ()>> = (0..8).map(|_| slow()).collect();
        let limits = Limits { least: 5, most: 9, seconds: 0.1, each: 9.0 };
        let times = round_times(&mut calls, limits, &|_, _| true, |_, _, ()| ());
        let made = times.iter().filter(|times| !times.is_empty()).count();
        assert!((1..8).contains(&made), "{made}");
    }
}
