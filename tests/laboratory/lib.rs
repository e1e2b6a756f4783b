//! The laboratory: what tests and benches hold `palpate` against. It is no part of the product.
//!
//! ```text
//! bodies         whole and partial bodies in random pose, touched at random
//! hard_cases     difficult inputs, whose references of 80 digits stand in tests/golden
//! coverage       surfaces on which intervals are judged, and how narrow an interval could be there
//! ```

pub mod bodies;
pub mod coverage;
pub mod hard_cases;
