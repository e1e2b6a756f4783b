//! Tests of the library through its public interface, in one binary: every binary links all dependencies anew.

mod binomial;
mod certainty;
mod coverage;
mod departures;
mod differential;
mod draws;
mod effects_together;
mod explore;
mod few_and_lines;
mod free_surfaces;
mod guide;
mod hard_cases;
mod objects;
#[cfg(feature = "cli")]
mod paper;
mod parametric;
mod parts;
mod place_errors;
mod properties;
mod random_problems;
mod robust;
mod rounded_numbers;
mod routes;
mod scene_effects;
#[cfg(feature = "cli")]
mod scene_surfaces;
#[cfg(feature = "cli")]
mod scene_tip;
mod shared_errors;
mod study;
mod threads;
