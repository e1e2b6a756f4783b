//! The comparer of `benches/counts` fails where something grew: on made numbers and on a regression made on purpose.

#[path = "../benches/counts/compare.rs"]
mod compare;
#[path = "../benches/workloads/mod.rs"]
#[allow(dead_code, reason = "the benches use the rest")]
mod workloads;

use std::alloc::System;

use compare::{Counts, Growth, growths};
use palpate::plans::SlopePlan;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use workloads::{Fault, paper, paper_knots, pool};

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn one(name: &str, value: u64) -> Counts {
    Counts::from([(name.to_string(), value)])
}

/// One test: nothing else may allocate while the regression is counted.
#[test]
fn growth_is_caught() -> Result<(), Fault> {
    more_than_two_per_cent_is_growth();
    a_deliberate_regression_is_caught()
}

fn more_than_two_per_cent_is_growth() {
    assert!(growths(&one("a", 1000), &one("a", 1020)).is_empty());
    assert!(growths(&one("a", 1000), &one("a", 3)).is_empty());
    let grown = Growth { name: "a".into(), before: 1000, after: 1021 };
    assert_eq!(growths(&one("a", 1000), &one("a", 1021)), [grown]);
    assert_eq!(growths(&one("a", 0), &one("a", 1)).len(), 1);
    assert!(growths(&one("a", 1), &one("b", 100)).is_empty(), "a new count has no baseline yet");
    assert_eq!(growths(&one("a", u64::MAX / 2), &one("a", u64::MAX)).len(), 1);
}

/// The baseline's zero allocations of a repeated fit, against a fit that makes its plan anew.
fn a_deliberate_regression_is_caught() -> Result<(), Fault> {
    let columns = paper(false);
    let (kept, anew) = pool(1)?.install(|| -> Result<(u64, u64), Fault> {
        let mut plan = SlopePlan::new(paper_knots()?, [1.0, 2.0, 2.0])?;
        plan.fit(&columns.view())?;
        let region = Region::new(COUNTED);
        plan.fit(&columns.view())?;
        let kept = region.change().allocations as u64;
        let region = Region::new(COUNTED);
        SlopePlan::new(paper_knots()?, [1.0, 2.0, 2.0])?.fit(&columns.view())?;
        Ok((kept, region.change().allocations as u64))
    })?;
    let baseline: std::collections::BTreeMap<String, Counts> =
        serde_json::from_str(include_str!("../benches/counts/baseline.json"))?;
    let name = "paper_fit/w1 allocations";
    let of_any_compiler = baseline.values().next().ok_or("an empty baseline")?;
    assert!(growths(of_any_compiler, &one(name, kept)).is_empty());
    assert_eq!(growths(of_any_compiler, &one(name, anew)).len(), 1, "{anew} allocations pass");
    Ok(())
}
