//! Files of one run on their way into the output directory.

use std::sync::{Arc, Mutex};

use crate::io::Together;

/// Files on their way into the output directory; clones share them.
#[derive(Clone, Debug, Default)]
pub(super) struct Gathered(pub(super) Arc<Mutex<Option<Together>>>);
