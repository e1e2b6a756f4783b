//! The cells of the coverage table: one scene each, its study, its fits, and how wide an interval there could be.
//!
//! ```text
//! scene -> study -> fits of its replicates -> inside/asked -> beside the widths of an oracle
//! ```

pub(crate) mod cell;
pub(crate) mod family;
pub(crate) mod judged;
pub(crate) mod pooled;
