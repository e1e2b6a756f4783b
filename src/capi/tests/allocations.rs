//! The loop of a stream asks for no memory: every allocation of this process is counted.
//!
//! One test, in a binary of its own. The harness' own thread may still ask for memory once in a while: a loop that does so does it every time,
//! and the least of three counts is its own.

#![allow(unsafe_code)] // a test of functions that C calls

use std::alloc::System;

use palpate_capi::*;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

#[test]
fn a_stream_asks_for_no_memory_in_its_loop() {
    let estimate = PalpateEstimate { mean: 0.0, u: 0.0, lo: 0.0, hi: 0.0 };
    let mut shape = PalpateStreamShape { shape_index: estimate, curvedness: estimate, contacts: 0 };
    // SAFETY: every pointer names a value of this function, and handles are freed once
    unsafe {
        for (window, decay) in [(0, 1.0), (25, 1.0), (0, 0.95)] {
            let mut options = std::mem::MaybeUninit::uninit();
            assert_eq!(palpate_stream_defaults(options.as_mut_ptr()), PalpateStatus::Ok);
            let mut options = options.assume_init();
            (options.domain, options.window, options.decay) = ([-1.0, 1.0, -1.0, 1.0], window, decay);
            let mut stream = std::ptr::null_mut();
            assert_eq!(palpate_stream_new(&options, &mut stream), PalpateStatus::Ok);
            let mut push = |k: usize| {
                let (x, y) = ((k as f64 * 0.7548).fract() * 2.0 - 1.0, (k as f64 * 0.5698).fract() * 2.0 - 1.0);
                assert_eq!(palpate_stream_push(stream, x, y, 0.1 * x * x, 0.2 * x, 0.0), PalpateStatus::Ok);
                if k >= 20 {
                    assert_eq!(palpate_stream_shape(stream, &mut shape), PalpateStatus::Ok);
                }
            };
            (0..40).for_each(&mut push);
            let mut asked = |from: usize| {
                let region = Region::new(COUNTED);
                (from..from + 200).for_each(&mut push);
                region.change().allocations + region.change().reallocations
            };
            let least = [40, 240, 440].map(&mut asked).into_iter().min();
            assert_eq!(least, Some(0), "window {window}, decay {decay}");
            let region = Region::new(COUNTED);
            // a refusal has words, which need memory: the counter counts
            assert_eq!(palpate_stream_push(stream, 9.0, 0.0, 0.0, 0.0, 0.0), PalpateStatus::Input);
            assert!(region.change().allocations > 0);
            palpate_stream_free(stream);
        }
    }
}
